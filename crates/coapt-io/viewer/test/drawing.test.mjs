// What is drawn flat, without a browser.

import assert from "node:assert/strict";
import { test } from "node:test";
import { QUANTITIES, colourAt, niceAbove, range, vertexColours } from "../src/colours.js";
import { decodeGeometry, floats, integers } from "../src/decode.js";
import { cut } from "../src/section.js";

const PLANE = { origin: [0, 0, 0], normal: [1, 0, 0], right: [0, 1, 0], up: [0, 0, 1] };

test("a plane cuts a triangle where it should", () => {
  const positions = [-1, 0, 0, 1, 0, 0, 1, 2, 0];
  const [{ from, to, leaflet }] = cut(positions, [0, 1, 2], [7], PLANE, 0);
  assert.deepEqual([from, to].sort(), [[0, 0], [1, 0]]);
  assert.equal(leaflet, 7);
  assert.deepEqual(cut(positions, [0, 1, 2], [7], PLANE, 1.5), []);
});

test("the section of a closed surface is closed, also through its vertices", () => {
  // An octahedron: every point of the cut belongs to two segments.
  const positions = [1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1];
  const faces = [0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5];
  for (const offset of [0, 0.3, -0.5]) {
    const ends = new Map();
    for (const { from, to } of cut(positions, faces, new Array(8).fill(0), PLANE, offset)) {
      for (const end of [from, to]) {
        const key = end.map((part) => part.toFixed(9)).join();
        ends.set(key, (ends.get(key) ?? 0) + 1);
      }
    }
    assert.equal(ends.size, 4);
    for (const count of ends.values()) assert.equal(count % 2, 0);
  }
});

test("colours run from one end of a map to the other and stop there", () => {
  assert.deepEqual(colourAt("cividis", 0), colourAt("cividis", -3));
  assert.deepEqual(colourAt("cividis", 1), colourAt("cividis", 9));
  assert.deepEqual(colourAt("viridis", NaN), colourAt("viridis", 0));
  const [low, middle, high] = [0, 0.5, 1].map((share) => colourAt("cividis", share).reduce((sum, part) => sum + part));
  // Readable in grey: brightness grows.
  assert.ok(low < middle && middle < high);
  assert.equal(vertexColours("gap_mm", new Float32Array(4), [0, 6]).length, 12);
});

test("ranges hold all values and are round", () => {
  assert.equal(niceAbove(2.3), 3);
  assert.equal(niceAbove(0.05), 0.05);
  assert.equal(niceAbove(0), 1);
  assert.deepEqual(range("annulus_distance_mm", [{ annulus_distance_mm: [-4, 2] }]), [-5, 5]);
  assert.deepEqual(range("gap_mm", []), [QUANTITIES.gap_mm.bottom, QUANTITIES.gap_mm.top]);
});

test("numbers come back as they were written", () => {
  const code = (array) => Buffer.from(array.buffer).toString("base64");
  const numbers = new Float32Array([1.5, -2.25, 1e-7]);
  assert.deepEqual(floats(code(numbers)), numbers);
  assert.deepEqual(integers(code(new Uint32Array([7, 2 ** 31]))), new Uint32Array([7, 2 ** 31]));
  const empty = code(new Float32Array(0));
  const geometry = decodeGeometry({ faces: empty, face_leaflet: empty, closed: empty, open: empty, fields: {}, chords: null, rings: [] });
  assert.equal(geometry.chords, null);
});

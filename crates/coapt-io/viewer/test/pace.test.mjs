// How finely a valve is drawn while it moves, on machines whose frames take given times: no clock is looked at.

import assert from "node:assert/strict";
import { test } from "node:test";
import { LEVELS, SMOOTH_MS, beginMotion, createPace, noteFrame } from "../src/pace.js";

const SCREEN_MS = 1000 / 60;

// The levels of the frames of a motion; `costs_ms`: what drawing at each level takes.
function motion(pace, costs_ms, frames = 60) {
  beginMotion(pace);
  return Array.from({ length: frames }, () => {
    // Screens show whole frames.
    noteFrame(pace, Math.ceil(costs_ms[pace.level] / SCREEN_MS - 1e-9) * SCREEN_MS);
    return pace.level;
  });
}

// Without a graphics card, as measured: 10,000 triangles, before.
const SLOW_MS = [131, 60, 40, 25, 15];

test("where frames come in time nothing is coarser than at rest", () => {
  const levels = motion(createPace(), LEVELS.map(() => 10));
  assert.ok(levels.every((level) => level === 0), levels.join());
});

test("on a slow machine a motion becomes smooth within ten frames, and stays as it is", () => {
  const levels = motion(createPace(), SLOW_MS);
  assert.ok(SLOW_MS[levels[9]] <= SMOOTH_MS, levels.join());
  assert.ok(levels.slice(10).every((level) => level === levels[9]), levels.join());
  // No coarser than need be.
  assert.ok(SLOW_MS[levels[9] - 1] > SMOOTH_MS, levels.join());
});

test("what was learned holds for the next motion, and is tried again once in a while", () => {
  const pace = createPace();
  motion(pace, SLOW_MS);
  const { level } = pace;
  const next = motion(pace, SLOW_MS);
  assert.ok(next.every((other) => other === level), next.join());
  // The machine has become a fast one.
  const fast = LEVELS.map(() => 10);
  for (let number = 0; number < 30 && pace.level > 0; number += 1) motion(pace, fast);
  assert.equal(pace.level, 0);
});

test("within a motion nothing becomes finer again: it would flicker", () => {
  const pace = createPace();
  let levels = motion(pace, LEVELS.map(() => 200), 8);
  assert.ok(levels.at(-1) > 0);
  for (let frame = 0; frame < 100; frame += 1) noteFrame(pace, SCREEN_MS);
  assert.equal(pace.level, levels.at(-1));
});

test("one long frame is no slow machine, frames without drawing are no fast one", () => {
  const pace = createPace();
  beginMotion(pace);
  // A hiccup shorter than what four frames may take together.
  for (const frame_ms of [16, 80, 16, 16]) noteFrame(pace, frame_ms);
  assert.equal(pace.level, 0);
  motion(pace, SLOW_MS);
  const { level } = pace;
  beginMotion(pace);
  pace.slow_ms.fill(0);
  for (let frame = 0; frame < 100; frame += 1) noteFrame(pace, SCREEN_MS, frame % 4 === 0);
  assert.equal(pace.level, level);
});

test("the slowest machine comes to the coarsest level and no farther", () => {
  const levels = motion(createPace(), LEVELS.map(() => 5000));
  assert.equal(levels.at(-1), LEVELS.length - 1);
});

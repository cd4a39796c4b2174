// The valve in three dimensions: one canvas with one or two views of one camera.
//
// Scenes are in the valve's frame: x to the right of a surgeon who looks from the atrium with the aorta on top, y to the anterior
// annulus, z to the atrium.

import * as three from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { SLACK_COLOUR, colourAt } from "./colours.js";
import { LEVELS, beginMotion, createPace, noteFrame } from "./pace.js";

// Directions from which the valve is seen; a hair off the pole keeps "up" defined.
export const DIRECTIONS = {
  atrium: [0, -1e-3, 1],
  ventricle: [0, -1e-3, -1],
  front: [0, 1, 0.15],
  // As a long-axis view: the aorta to the right.
  side: [1, 0, 0.1],
};

const FIELD_OF_VIEW_DEG = 24;

export function createView(canvas) {
  const renderer = rendererOrWords(canvas);
  const camera = new three.PerspectiveCamera(FIELD_OF_VIEW_DEG, 1, 1, 2000);
  camera.up.set(0, 0, 1);
  const controls = new OrbitControls(camera, canvas);
  const view = { renderer, quick: null, camera, controls, canvas, panes: [], distance: 150, asked: false, looping: false, motion: null, pace: createPace() };
  // Between its start and its end somebody turns the valve; else the camera was set.
  let held = false;
  controls.addEventListener("start", () => (held = true));
  controls.addEventListener("end", () => (held = false));
  controls.addEventListener("change", () => requestDraw(view, held));
  new ResizeObserver(() => requestDraw(view)).observe(canvas);
  canvas.addEventListener("keydown", (event) => turnByKey(view, event));
  lookFrom(view, "atrium");
  return view;
}

// What draws on the canvas; nothing where the browser has no WebGL or keeps it off, which is told in the canvas' place.
function rendererOrWords(canvas) {
  try {
    return createRenderer(canvas, { antialias: true, preserveDrawingBuffer: true });
  } catch {
    const words = document.createElement("p");
    words.className = "no-webgl";
    words.textContent = "This browser draws nothing in three dimensions: WebGL is missing or off. All else is here.";
    canvas.before(words);
    return null;
  }
}

function createRenderer(canvas, options) {
  const renderer = new three.WebGLRenderer({ canvas, ...options });
  renderer.setScissorTest(true);
  return renderer;
}

// A second canvas over the first, without smooth edges, which a canvas has for ever or never; made where it is needed first.
function quickRenderer(view) {
  if (!view.quick) {
    const canvas = document.createElement("canvas");
    canvas.setAttribute("aria-hidden", "true");
    Object.assign(canvas.style, { position: "absolute", pointerEvents: "none", border: "0" });
    view.canvas.after(canvas);
    // Nothing shines through, so that what lies below need not be put together with it.
    const context = canvas.getContext("webgl2", { alpha: false, antialias: false });
    view.quick = createRenderer(canvas, { context });
  }
  return view.quick;
}

export function dispose({ renderer, quick, controls }) {
  controls.dispose();
  renderer?.dispose();
  quick?.dispose();
  quick?.domElement.remove();
}

// A pane's valve: meshes whose numbers `showValve` replaces. `frame`: centre and axes in the patient's coordinates.
export function createValve(frame) {
  const scene = new three.Scene();
  scene.background = new three.Color(0xf7f7f5);
  scene.add(new three.HemisphereLight(0xffffff, 0x8a8a96, 2.2));
  const patient = new three.Group();
  patient.matrixAutoUpdate = false;
  patient.matrix.copy(toValveFrame(frame));
  patient.matrixWorldNeedsUpdate = true;
  scene.add(patient);
  const material = new three.MeshPhongMaterial({ vertexColors: true, side: three.DoubleSide, shininess: 18, specular: 0x222222 });
  const leaflets = new three.Mesh(new three.BufferGeometry(), material);
  const edges = new three.LineSegments(new three.BufferGeometry(), new three.LineBasicMaterial({ color: 0x222222, transparent: true, opacity: 0.28 }));
  const chords = new three.LineSegments(new three.BufferGeometry(), new three.LineBasicMaterial({ vertexColors: true }));
  const rings = new three.Group();
  // Follows the camera, so that what is looked at is lit.
  const lamp = new three.DirectionalLight(0xffffff, 1.6);
  scene.add(lamp, lamp.target);
  patient.add(leaflets, edges, chords, rings);
  return { scene, patient, leaflets, edges, chords, rings, lamp };
}

function toValveFrame({ centre_mm, to_atrium, to_anterior }) {
  const z = new three.Vector3(...to_atrium);
  const y = new three.Vector3(...to_anterior);
  const x = new three.Vector3().crossVectors(y, z);
  const axes = new three.Matrix4().makeBasis(x, y, z).transpose();
  return axes.multiply(new three.Matrix4().makeTranslation(...centre_mm.map((part) => -part)));
}

// Gives a valve a mesh, once for each state. `rings`: points of curves, shape `[point, 3]` each.
export function setMesh(valve, { faces, rings }) {
  const geometry = new three.BufferGeometry();
  geometry.setIndex(new three.BufferAttribute(faces, 1));
  valve.leaflets.geometry.dispose();
  valve.leaflets.geometry = geometry;
  valve.edges.geometry.dispose();
  valve.edges.geometry = new three.BufferGeometry();
  valve.edges.geometry.setIndex(new three.BufferAttribute(uniqueEdges(faces), 1));
  valve.chords.geometry.dispose();
  valve.chords.geometry = new three.BufferGeometry();
  valve.rings.children.forEach((tube) => tube.geometry.dispose());
  valve.rings.clear();
  for (const points of rings) valve.rings.add(ringTube(points));
}

const RING_RADIUS_MM = 0.6;

// Pieces of a ring's tube at most: shorter ones than a third of its thickness are not seen, and cost more than the leaflets.
const RING_PIECES = 256;

export function ringTube(points) {
  const list = [];
  for (let at = 0; at < points.length; at += 3) list.push(new three.Vector3(points[at], points[at + 1], points[at + 2]));
  const closed = list.length > 2 && list[0].distanceTo(list.at(-1)) < 1e-6;
  if (closed) list.pop();
  const curve = new three.CatmullRomCurve3(list, closed);
  const geometry = new three.TubeGeometry(curve, Math.min(4 * list.length, RING_PIECES), RING_RADIUS_MM, 8, closed);
  return new three.Mesh(geometry, new three.MeshPhongMaterial({ color: 0x3f7d5a }));
}

export function uniqueEdges(faces) {
  const seen = new Set();
  const edges = [];
  for (let face = 0; face < faces.length; face += 3) {
    for (let corner = 0; corner < 3; corner += 1) {
      const [a, b] = [faces[face + corner], faces[face + ((corner + 1) % 3)]];
      const key = Math.min(a, b) * 2 ** 26 + Math.max(a, b);
      if (seen.has(key)) continue;
      seen.add(key);
      edges.push(a, b);
    }
  }
  return new Uint32Array(edges);
}

// Moves and colours a valve: positions and colours of vertices, those of the points of chords, all of shape `[point, 3]`.
export function setShape(valve, positions, colours, chords) {
  const geometry = valve.leaflets.geometry;
  attribute(geometry, "position", positions);
  attribute(geometry, "color", colours);
  attribute(geometry, "normal", vertexNormals(positions, geometry.index.array));
  geometry.computeBoundingSphere();
  attribute(valve.edges.geometry, "position", positions);
  if (chords) {
    attribute(valve.chords.geometry, "position", chords.positions);
    attribute(valve.chords.geometry, "color", chords.colours);
  }
  valve.chords.visible = Boolean(chords);
}

// Unit normals of vertices, those of the faces around them weighted by area, shape `[vertex, 3]`: as three.js has them, in a sixth of
// the time, which each frame of a film takes.
export function vertexNormals(positions, faces) {
  const normals = new Float32Array(positions.length);
  const add = (vertex, x, y, z) => {
    normals[vertex] += x;
    normals[vertex + 1] += y;
    normals[vertex + 2] += z;
  };
  for (let face = 0; face < faces.length; face += 3) {
    const a = 3 * faces[face];
    const b = 3 * faces[face + 1];
    const c = 3 * faces[face + 2];
    const ux = positions[c] - positions[b];
    const uy = positions[c + 1] - positions[b + 1];
    const uz = positions[c + 2] - positions[b + 2];
    const vx = positions[a] - positions[b];
    const vy = positions[a + 1] - positions[b + 1];
    const vz = positions[a + 2] - positions[b + 2];
    const x = uy * vz - uz * vy;
    const y = uz * vx - ux * vz;
    const z = ux * vy - uy * vx;
    add(a, x, y, z);
    add(b, x, y, z);
    add(c, x, y, z);
  }
  for (let vertex = 0; vertex < normals.length; vertex += 3) {
    const length = Math.sqrt(normals[vertex] ** 2 + normals[vertex + 1] ** 2 + normals[vertex + 2] ** 2) || 1;
    normals[vertex] /= length;
    normals[vertex + 1] /= length;
    normals[vertex + 2] /= length;
  }
  return normals;
}

function attribute(geometry, name, values) {
  const old = geometry.getAttribute(name);
  if (old && old.array.length === values.length) {
    old.array.set(values);
    old.needsUpdate = true;
  } else geometry.setAttribute(name, new three.BufferAttribute(new Float32Array(values), 3));
}

// Lines do not share colours as vertices do: a chord's two ends are points of their own.
export function chordLines({ ends, force_n }, points, largest_n) {
  const positions = new Float32Array(ends.length * 3);
  const colours = new Float32Array(ends.length * 3);
  ends.forEach((point, end) => {
    positions.set(points.subarray(3 * point, 3 * point + 3), 3 * end);
    const force = force_n[Math.floor(end / 2)];
    colours.set(force > 0 ? colourAt("viridis", force / largest_n) : SLACK_COLOUR, 3 * end);
  });
  return { positions, colours };
}

// While a valve closes, tensions are not known: all its chords look slack. `ends`: shape `[chord, 2, 3]`.
export function plainChordLines(ends) {
  const colours = new Float32Array(ends.length);
  for (let at = 0; at < ends.length; at += 3) colours.set(SLACK_COLOUR, at);
  return { positions: ends, colours };
}

export function lookFrom(view, name) {
  const direction = new three.Vector3(...DIRECTIONS[name]).normalize();
  view.camera.position.copy(view.controls.target).addScaledVector(direction, view.distance);
  view.controls.update();
  requestDraw(view);
}

// Puts the camera so far away that a sphere about the centre of the annulus fits, a little below it as the leaflets are.
export function fit(view, radius_mm) {
  view.distance = (radius_mm * 1.1) / Math.sin((FIELD_OF_VIEW_DEG / 2) * (Math.PI / 180));
  view.controls.minDistance = view.distance / 8;
  view.controls.maxDistance = view.distance * 3;
}

const TURN = Math.PI / 24;

function turnByKey(view, event) {
  const turns = { ArrowLeft: [-TURN, 0], ArrowRight: [TURN, 0], ArrowUp: [0, -TURN], ArrowDown: [0, TURN] };
  const closer = { "+": 0.9, "=": 0.9, "-": 1 / 0.9 };
  const away = view.camera.position.clone().sub(view.controls.target);
  if (event.key in turns) {
    const place = new three.Spherical().setFromVector3(new three.Vector3(away.x, away.z, -away.y));
    place.theta += turns[event.key][0];
    place.phi = Math.min(Math.max(place.phi + turns[event.key][1], 1e-3), Math.PI - 1e-3);
    const turned = new three.Vector3().setFromSpherical(place);
    away.set(turned.x, -turned.z, turned.y);
  } else if (event.key in closer) away.multiplyScalar(closer[event.key]);
  else return;
  event.preventDefault();
  view.camera.position.copy(view.controls.target).add(away);
  view.controls.update();
  // A key that is held turns on and on.
  requestDraw(view, event.repeat);
}

// Frames without a new one, after which what moved counts as at rest: a fifth of a second on most screens.
const RESTS_AFTER = 12;

// Draws with the next frame. `moves`: the next drawing will follow at once; then each is as fine as stays smooth, and the last one,
// at rest, as fine as the screen.
export function requestDraw(view, moves = false) {
  if (moves && !view.motion) {
    beginMotion(view.pace);
    view.motion = { idle: 0, drew: false, last_ms: null };
  }
  view.asked = true;
  if (view.looping) return;
  view.looping = true;
  requestAnimationFrame((now_ms) => nextFrame(view, now_ms));
}

function nextFrame(view, now_ms) {
  const { motion } = view;
  if (motion) {
    if (motion.last_ms !== null) noteFrame(view.pace, now_ms - motion.last_ms, motion.drew);
    Object.assign(motion, { last_ms: now_ms, drew: view.asked, idle: view.asked ? 0 : motion.idle + 1 });
    if (motion.idle > RESTS_AFTER) {
      view.motion = null;
      view.asked = true;
    }
  }
  if (view.asked) draw(view, LEVELS[view.motion ? view.pace.level : 0]);
  view.asked = false;
  view.looping = view.motion !== null;
  if (view.looping) requestAnimationFrame((now_ms) => nextFrame(view, now_ms));
}

// Panes stand side by side. `level`: how finely.
export function draw(view, level = LEVELS[0]) {
  const { clientWidth: width, clientHeight: height } = view.canvas;
  if (!view.renderer || !width || !height || !view.panes.length) return;
  const renderer = level.smoothEdges ? view.renderer : quickRenderer(view);
  setResolution(renderer, width, height, window.devicePixelRatio * level.share);
  const paneWidth = Math.floor(width / view.panes.length);
  view.camera.aspect = paneWidth / height;
  // A tall narrow pane shows as much across as a wide one does upwards.
  view.camera.zoom = Math.min(1, 0.9 * view.camera.aspect);
  view.camera.updateProjectionMatrix();
  view.panes.forEach((valve, number) => {
    valve.lamp.position.copy(view.camera.position);
    renderer.setViewport(number * paneWidth, 0, paneWidth, height);
    renderer.setScissor(number * paneWidth, 0, paneWidth, height);
    renderer.render(valve.scene, view.camera);
  });
  showQuick(view, !level.smoothEdges);
}

function showQuick({ canvas, quick }, shown) {
  if (!quick) return;
  const { style } = quick.domElement;
  style.display = shown ? "block" : "none";
  style.width = `${canvas.clientWidth}px`;
  style.height = `${canvas.clientHeight}px`;
  style.left = `${canvas.offsetLeft + canvas.clientLeft}px`;
  style.top = `${canvas.offsetTop + canvas.clientTop}px`;
}

const size = new three.Vector2();

// A canvas whose size is set begins anew, even where it stays the same.
function setResolution(renderer, width, height, ratio) {
  renderer.getSize(size);
  if (size.x === width && size.y === height && renderer.getPixelRatio() === ratio) return;
  renderer.setPixelRatio(ratio);
  renderer.setSize(width, height, false);
}

// Which pane and which vertex lies under a point of the canvas [CSS pixels from its corner]; none beside the leaflets.
export function vertexAt(view, x, y) {
  const { clientWidth: width, clientHeight: height } = view.canvas;
  const paneWidth = Math.floor(width / view.panes.length);
  const number = Math.min(Math.floor(x / paneWidth), view.panes.length - 1);
  const pointer = new three.Vector2((2 * (x - number * paneWidth)) / paneWidth - 1, 1 - (2 * y) / height);
  const ray = new three.Raycaster();
  ray.setFromCamera(pointer, view.camera);
  const valve = view.panes[number];
  const [hit] = ray.intersectObject(valve.leaflets, false);
  if (!hit) return null;
  const at = valve.patient.worldToLocal(hit.point.clone());
  const positions = valve.leaflets.geometry.getAttribute("position");
  const corners = [hit.face.a, hit.face.b, hit.face.c];
  const apart = (vertex) => new three.Vector3().fromBufferAttribute(positions, vertex).distanceToSquared(at);
  return { pane: number, vertex: corners.reduce((best, vertex) => (apart(vertex) < apart(best) ? vertex : best)) };
}

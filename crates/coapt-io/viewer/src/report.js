// The page of a report: what its controls do. The page itself, with all tables, is written by the program.

import { QUANTITIES, leafletColours, leafletLegend, legend, niceAbove, range, shortNumber, vertexColours } from "./colours.js";
import { decodeFrame, decodeGeometry } from "./decode.js";
import { drawCurves, drawForces, drawSection, drawUnrolled, markFrame } from "./drawings.js";
import { DIRECTIONS, chordLines, createValve, createView, draw, fit, lookFrom, plainChordLines, requestDraw, setMesh, setShape, vertexAt } from "./valve3d.js";

const find = (id) => document.getElementById(id);
const data = JSON.parse(find("data").textContent);
const states = data.states.map((state) => ({ ...state, geometry: decodeGeometry(state.geometry), shapes: new Map() }));
const largestForce = niceAbove(Math.max(0, ...states.flatMap(({ geometry }) => [...(geometry.chords?.force_n ?? [])])));

// What the reader has chosen. `shown`: before, after or both; `after`: which state counts as after; `frame`: how far the valve is closed.
const choice = { shown: data.after ? "after" : "before", after: data.after, quantity: "gap_mm", frame: 0, section_mm: 0, edges: false, chordae: true };
const view = createView(find("view"));
const loaded = new WeakMap();

function shownStates() {
  if (choice.shown === "both") return [0, choice.after];
  return [choice.shown === "after" ? choice.after : 0];
}

// Without a recording there is only open and closed.
function frameCount() {
  return Math.max(...shownStates().map((number) => states[number].geometry.film?.pressures_mmhg.length ?? 1));
}

// Positions, fields and chord points of a state at the chosen frame: 0 is the open valve, the last the closed one.
function shape(state) {
  const last = frameCount();
  const { geometry } = state;
  const { chords, film } = geometry;
  if (choice.frame === 0) return made(state, "open", () => ({ positions: geometry.open, fields: {}, chords: chords?.open ? plainChordLines(endsOf(chords, chords.open)) : null, open: true }));
  if (choice.frame < last && film) {
    const number = choice.frame - 1;
    return made(state, number, () => {
      const frame = decodeFrame(film, number, geometry, data.frame);
      return { ...frame, chords: plainChordLines(frame.chordEnds) };
    });
  }
  return made(state, "closed", () => ({ positions: geometry.closed, fields: geometry.fields, chords: chords ? chordLines(chords, chords.closed, largestForce) : null }));
}

// Shapes that were shown are kept: each is decoded once.
function made({ shapes }, name, make) {
  if (!shapes.has(name)) shapes.set(name, make());
  return shapes.get(name);
}

function endsOf({ ends }, points) {
  return Float32Array.from({ length: 3 * ends.length }, (_, part) => points[3 * ends[Math.floor(part / 3)] + (part % 3)]);
}

function coloursOf({ geometry }, { fields }, limits) {
  if (choice.quantity === "leaflet") return leafletColours(geometry, geometry.open.length / 3);
  const values = fields[choice.quantity];
  // Grey where it is not known: in the open valve.
  return values ? vertexColours(choice.quantity, values, limits) : new Float32Array(geometry.open.length).fill(0.75);
}

const ranges = new Map();

function limits() {
  const { quantity } = choice;
  if (quantity === "leaflet") return null;
  if (!ranges.has(quantity)) ranges.set(quantity, range(quantity, states.map(({ geometry }) => geometry.fields)));
  return ranges.get(quantity);
}

// Does a part of the page anew only where what it shows is no longer what it showed: a film has many frames.
const drawn = new Map();
function onChange(part, shows, act) {
  const key = JSON.stringify(shows);
  if (drawn.get(part) === key) return;
  drawn.set(part, key);
  act();
}

// `moves`: more will follow at once.
function refresh(moves) {
  choice.frame = Math.min(choice.frame, frameCount());
  const numbers = shownStates();
  const between = limits();
  onChange("valve", [numbers, choice.frame, choice.quantity, choice.chordae, choice.edges], () => {
    refreshValve(numbers, between);
    requestDraw(view, moves);
  });
  onChange("titles", numbers, () => refreshTitles(numbers));
  onChange("pose", [numbers, choice.frame], () => refreshPose(numbers));
  onChange("legend", choice.quantity, () => refreshLegend(between));
  onChange("forces", numbers.at(-1), () => refreshForces(numbers.at(-1)));
  refreshSection(numbers.at(-1));
  refreshMap(numbers.at(-1), between);
  const filmed = numbers.map((number) => states[number]).filter(({ geometry }) => geometry.film);
  onChange("curves", numbers, () => drawCurves(find("curves"), filmed));
  markFrame(find("curves"), filmed, choice.frame - 1);
  onChange("table", choice.after, refreshTable);
}

function refreshValve(numbers, between) {
  while (view.panes.length < numbers.length) view.panes.push(createValve(data.frame));
  view.panes.length = numbers.length;
  numbers.forEach((number, pane) => {
    const state = states[number];
    const valve = view.panes[pane];
    if (loaded.get(valve) !== number) setMesh(valve, state.geometry);
    loaded.set(valve, number);
    const now = shape(state);
    const colours = coloursOf(state, now, between);
    setShape(valve, now.positions, colours, choice.chordae ? now.chords : null);
    valve.edges.visible = choice.edges;
    // A ring lies where the annulus goes to, not where it is in the open valve.
    valve.rings.visible = !now.open;
  });
}

function refreshTitles(numbers) {
  find("titles").replaceChildren(
    ...numbers.map((number) => {
      const title = document.createElement("span");
      title.textContent = `${states[number].name}: ${states[number].certified ? "certified" : "NOT CERTIFIED"}`;
      title.className = states[number].certified ? "certified" : "uncertified";
      return title;
    }),
  );
}

function refreshPose(numbers) {
  find("view").setAttribute("aria-label", `Valve in three dimensions: ${numbers.map((number) => states[number].name).join(" and ")}, ${poseWords()}. Arrow keys turn it, plus and minus move nearer and away.`);
  find("pose").max = frameCount();
  find("pose").value = choice.frame;
  find("pose-value").textContent = poseWords();
}

function poseWords() {
  if (choice.frame === 0) return "open, as given";
  if (choice.frame >= frameCount()) return `closed at ${shortNumber(data.pressure_mmhg)} mmHg`;
  const film = shownStates().map((number) => states[number].geometry.film).find(Boolean);
  const number = choice.frame - 1;
  return `${shortNumber(film.pressures_mmhg[number])} mmHg${film.certified[number] ? "" : " (did not come to rest)"}`;
}

function refreshLegend(between) {
  const { gradient, ticks, title } = between ? legend(choice.quantity, between) : leafletLegend();
  find("legend-bar").style.background = gradient;
  find("legend-title").textContent = title;
  find("legend-ticks").replaceChildren(...ticks.map(span));
}

function span(text) {
  const made = document.createElement("span");
  made.textContent = text;
  return made;
}

function refreshSection(number) {
  onChange("section", [number, choice.frame, choice.section_mm], () => {
    const state = states[number];
    const now = shape(state);
    const shapes = [{ positions: state.geometry.open, faint: true }, { positions: now.positions }];
    drawSection(find("section"), state.geometry, now.open ? shapes.slice(1) : shapes, data.frame, choice.section_mm, data.reach_mm);
    find("section-value").textContent = sectionWords();
    find("section-caption").textContent = state.name;
  });
}

const RESTS_MS = 60;
let unrolling = null;

function refreshMap(number, between) {
  onChange("map", [number, choice.frame, choice.quantity], () => {
    const state = states[number];
    const { geometry } = state;
    const unroll = () => drawUnrolled(find("unrolled"), geometry, geometry.fields.along, geometry.fields.from_margin_mm, coloursOf(state, shape(state), between));
    // The slowest picture: it waits until a slider rests, so that the valve itself follows at once.
    clearTimeout(unrolling);
    unrolling = setTimeout(unroll, RESTS_MS);
    find("unrolled-caption").textContent = state.name;
  });
}

function refreshForces(number) {
  const { name, geometry, chord_groups } = states[number];
  find("forces-block").hidden = !geometry.chords;
  if (geometry.chords) drawForces(find("forces"), geometry.chords, chord_groups, largestForce);
  find("forces-caption").textContent = name;
}

function sectionWords() {
  if (choice.section_mm === 0) return "through the middle (A2-P2)";
  return `${shortNumber(Math.abs(choice.section_mm))} mm to the ${choice.section_mm < 0 ? "anterolateral" : "posteromedial"} side`;
}

// Numbers of the table's second and third column, for the state that counts as after.
function refreshTable() {
  if (!data.after) return;
  const { name, certified } = states[choice.after];
  // From a shape that is not certified, or to one, nothing has changed.
  const isTold = certified && states[0].certified;
  find("after-heading").textContent = name;
  find("after-doubt").hidden = certified;
  data.rows.forEach(({ digits, values }, row) => {
    const [before, after] = [values[0], values[choice.after]];
    find(`after-${row}`).textContent = number(after, digits);
    find(`after-${row}`).classList.toggle("doubted", !certified);
    find(`change-${row}`).textContent = before === null || after === null || !isTold ? "" : number(after - before, digits, true);
  });
  document.querySelectorAll("tr[data-state]").forEach((line) => line.setAttribute("aria-selected", Number(line.dataset.state) === choice.after));
  document.querySelectorAll("[data-details]").forEach((block) => (block.hidden = ![0, choice.after].includes(Number(block.dataset.details))));
}

function number(value, digits, signed = false) {
  if (value === null) return "–";
  const text = Math.abs(value).toFixed(digits);
  if (Number(text) === 0) return text;
  if (value < 0) return `−${text}`;
  return signed ? `+${text}` : text;
}

// --- controls

function pressed(group, chosen) {
  document.querySelectorAll(`[data-${group}]`).forEach((button) => button.setAttribute("aria-pressed", button.dataset[group] === chosen));
}

function onClick(group, action) {
  document.querySelectorAll(`[data-${group}]`).forEach((button) => button.addEventListener("click", () => action(button.dataset[group])));
}

function choose(changes, moves = false) {
  Object.assign(choice, changes);
  pressed("shown", choice.shown);
  refresh(moves);
}

onClick("shown", (shown) => choose({ shown }));
onClick("direction", (name) => lookFrom(view, name));
for (const [name, { label }] of Object.entries(QUANTITIES)) {
  if (name === "leaflet" || states.every(({ geometry }) => name in geometry.fields)) find("quantity").add(new Option(label, name));
}
find("quantity").addEventListener("change", ({ target }) => choose({ quantity: target.value }));
find("edges").addEventListener("change", ({ target }) => choose({ edges: target.checked }));
find("chordae").addEventListener("change", ({ target }) => choose({ chordae: target.checked }));
find("pose").addEventListener("input", ({ target }) => choose({ frame: Number(target.value) }, true));
find("section-offset").addEventListener("input", ({ target }) => choose({ section_mm: Number(target.value) }));
find("after")?.addEventListener("change", ({ target }) => chooseAfter(Number(target.value)));
document.querySelectorAll("tr[data-state]").forEach((line) => {
  line.addEventListener("click", () => chooseAfter(Number(line.dataset.state)));
  line.addEventListener("keydown", (event) => {
    if (event.key !== "Enter" && event.key !== " ") return;
    event.preventDefault();
    chooseAfter(Number(line.dataset.state));
  });
});

function chooseAfter(after) {
  if (find("after")) find("after").value = after;
  choose({ after, shown: choice.shown === "before" ? "after" : choice.shown });
}

const FRAME_MS = 60;
let playing = null;

find("play").addEventListener("click", () => {
  if (playing) return stop();
  if (choice.frame >= frameCount()) choose({ frame: 0 });
  find("play").textContent = "Pause";
  playing = setInterval(() => {
    choose({ frame: choice.frame + 1 }, true);
    if (choice.frame >= frameCount()) stop();
  }, FRAME_MS);
});

function stop() {
  clearInterval(playing);
  playing = null;
  find("play").textContent = "Close the valve";
}

// A finger points by touching, a mouse by moving; whoever turns the valve asks nothing, and looking for the vertex takes as long as drawing.
find("view").addEventListener("pointerdown", probe);
find("view").addEventListener("pointermove", (event) => (event.buttons ? find("probe").replaceChildren() : probe(event)));

function probe({ offsetX, offsetY }) {
  const hit = vertexAt(view, offsetX, offsetY);
  find("probe").textContent = hit ? probeWords(hit) : "";
}

function probeWords({ pane, vertex }) {
  const state = states[shownStates()[pane]];
  const value = shape(state).fields[choice.quantity]?.[vertex];
  if (value === undefined || choice.quantity === "leaflet") return "";
  const { label, unit, factor = 1, ends } = QUANTITIES[choice.quantity];
  return ends ? ends[Math.round(value)] : `${label}: ${shortNumber(value * factor)} ${unit}`;
}

// On paper the drawing takes the size that the page then has.
window.addEventListener("beforeprint", () => draw(view));
window.addEventListener("afterprint", () => requestDraw(view));

find("curves-block").hidden = !states.some(({ geometry }) => geometry.film);
find("section-offset").max = Math.floor(data.reach_mm);
find("section-offset").min = -Math.floor(data.reach_mm);
view.controls.target.set(0, 0, -0.3 * data.reach_mm);
// Open leaflets reach farther down than they do across.
fit(view, 0.85 * data.reach_mm);
lookFrom(view, Object.keys(DIRECTIONS)[0]);
choose({ frame: frameCount() });

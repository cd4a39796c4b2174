// The panel of the Python package, as an anywidget: sliders here, closures there.
//
// `asked` goes to Python, `answer` comes back with its `id`. While one question is open the latest of the others waits, so that a
// slider never runs ahead of the solver by more than one closure.

import { QUANTITIES, leafletColours, leafletLegend, legend, niceAbove, range, vertexColours } from "./colours.js";
import { chordLines, createValve, createView, dispose, fit, lookFrom, requestDraw, setMesh, setShape } from "./valve3d.js";

const STYLE = `
.coapt-panel { display: grid; grid-template-columns: minmax(0, 3fr) minmax(16rem, 2fr); gap: 0.8rem; font: 13px/1.4 system-ui, sans-serif; }
.coapt-panel > div { position: relative; }
.coapt-panel canvas { width: 100%; height: 420px; border: 1px solid #d5d5d0; display: block; touch-action: none; }
.coapt-panel fieldset { border: 1px solid #d5d5d0; margin: 0 0 0.5rem; padding: 0.3rem 0.6rem; }
.coapt-panel label { display: grid; grid-template-columns: 7.5rem 1fr 4.5rem; gap: 0.4rem; align-items: center; }
.coapt-panel table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
.coapt-panel td, .coapt-panel th { text-align: right; padding: 0 0.3rem; border-bottom: 1px solid #ececea; }
.coapt-panel td:first-child, .coapt-panel th:first-child { text-align: left; }
.coapt-panel .fault { color: #a32020; white-space: pre-wrap; }
.coapt-panel .certified { color: #1d6b45; }
.coapt-panel .uncertified { color: #a32020; font-weight: 700; }
.coapt-panel .legend { height: 0.7rem; border: 1px solid #d5d5d0; }
.coapt-panel .ticks { display: flex; justify-content: space-between; }
`;

const SITES = [["", "none"], ["A1P1", "A1-P1"], ["A2P2", "A2-P2"], ["A3P3", "A3-P3"]];

// Within what rings take: half of the size to all of it.
const AP_SHARES = ["0.55", "0.60", "0.65", "0.70", "0.75", "0.80", "0.85"];

function make(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

function choice(key, words, options) {
  const select = make("select", { name: key }, ...options.map(([value, text]) => new Option(text, value)));
  return make("label", {}, words, select, make("output"));
}

function slider(key, words, { low, high, step, start, unit }) {
  const input = make("input", { type: "range", name: key, min: low, max: high, step, value: start });
  const output = make("output", { value: `${start} ${unit}` });
  input.addEventListener("input", () => (output.value = `${input.value} ${unit}`));
  input.addEventListener("keydown", (event) => moveByKey(input, event));
  return make("label", {}, words, input, output);
}

// JupyterLab keeps arrow keys from what is no field of text.
function moveByKey(input, event) {
  const steps = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
  if (!steps) return;
  event.preventDefault();
  if (steps > 0) input.stepUp();
  else input.stepDown();
  input.dispatchEvent(new Event("input", { bubbles: true }));
}

function controls(model) {
  const families = model.get("ring_families").map((family) => [family, family]);
  const group = (title, ...rows) => make("fieldset", {}, make("legend", { textContent: title }), ...rows);
  const ranges = model.get("ranges");
  return make(
    "form",
    {},
    group(
      "Ring",
      choice("ring_family", "family", [["", "none"], ...families]),
      slider("ring_size_mm", "size", ranges.ring_size_mm),
      choice("ring_ap_share", "anteroposterior", [["", "its family's"], ...AP_SHARES.map((share) => [share, `${share} of the size`])]),
    ),
    group(
      "Clip",
      choice("clip_site", "site", [...SITES, ["position", "by position"]]),
      slider("clip_position", "position", ranges.clip_position),
    ),
    group(
      "Neochordae",
      choice("neochord_leaflet", "leaflet", [["", "none"], ...model.get("leaflets").map((name) => [name, name])]),
      slider("neochord_position", "position", ranges.neochord_position),
      slider("neochord_length_mm", "length", ranges.neochord_length_mm),
    ),
    make("label", {}, "colour", make("select", { name: "colour" }, ...["gap_mm", "strain", "leaflet"].map((name) => new Option(QUANTITIES[name].label, name))), make("output")),
  );
}

// Numbers as numbers, words as words; the colour is nobody's business but the picture's.
function asked(form, id) {
  const values = { id };
  for (const { name, type, value } of form.elements) if (name && name !== "colour") values[name] = type === "range" ? Number(value) : value;
  return values;
}

function numbers(view, Type) {
  return new Type(view.buffer.slice(view.byteOffset, view.byteOffset + view.byteLength));
}

function decode(answer) {
  return {
    faces: numbers(answer.faces, Uint32Array),
    faceLeaflet: numbers(answer.face_leaflet, Uint32Array),
    positions: numbers(answer.positions, Float32Array),
    fields: { gap_mm: numbers(answer.gap_mm, Float32Array), strain: numbers(answer.strain, Float32Array) },
    chords: answer.chord_ends.byteLength
      ? { ends: numbers(answer.chord_ends, Uint32Array), force_n: numbers(answer.chord_forces_n, Float32Array), points: numbers(answer.chord_points, Float32Array) }
      : null,
    rings: answer.ring ? [numbers(answer.ring, Float32Array)] : [],
  };
}

function show(view, valve, geometry, colour) {
  setMesh(valve, geometry);
  const limits = colour === "leaflet" ? null : range(colour, [geometry.fields]);
  const colours = limits ? vertexColours(colour, geometry.fields[colour], limits) : leafletColours(geometry, geometry.positions.length / 3);
  const { chords } = geometry;
  setShape(valve, geometry.positions, colours, chords && chordLines(chords, chords.points, niceAbove(Math.max(...chords.force_n))));
  valve.edges.visible = false;
  requestDraw(view);
  return limits;
}

function table(rows) {
  const cell = (value, digits, sign) => (value === null ? "–" : `${sign && value > 0 && Number(value.toFixed(digits)) !== 0 ? "+" : ""}${(value + 0).toFixed(digits)}`.replace("-", "−"));
  const head = make("tr", {}, ...["", "before", "now", "change"].map((textContent) => make("th", { textContent })));
  const lines = rows.map(({ name, unit, digits, before, after }) => {
    const change = before === null || after === null ? null : after - before;
    const texts = [unit ? `${name} [${unit}]` : name, cell(before, digits), cell(after, digits), cell(change, digits, true)];
    return make("tr", {}, ...texts.map((textContent) => make("td", { textContent })));
  });
  return make("table", {}, head, ...lines);
}

function render({ model, el }) {
  const form = controls(model);
  const canvas = make("canvas", { tabIndex: 0 });
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", "The closed valve; arrow keys turn it");
  const bar = make("div", { className: "legend" });
  const ticks = make("div", { className: "ticks" });
  const verdict = make("p");
  const faults = make("p", { className: "fault" });
  const measures = make("div");
  const notice = make("p", {}, make("em", { textContent: model.get("notice") }));
  verdict.setAttribute("aria-live", "polite");
  const panel = make("div", { className: "coapt-panel" }, make("div", {}, canvas, bar, ticks, verdict, faults, notice), make("div", {}, form, measures));
  // Else JupyterLab would walk through the notebook by the same keys.
  panel.dataset.lmSuppressShortcuts = "true";
  el.append(make("style", { textContent: STYLE }), panel);

  const view = createView(canvas);
  const valve = createValve(model.get("frame"));
  view.panes.push(valve);
  view.controls.target.set(0, 0, -0.3 * model.get("reach_mm"));
  fit(view, 0.85 * model.get("reach_mm"));
  lookFrom(view, "atrium");

  let geometry = null;
  let open = 0;
  let waiting = false;
  let count = 0;

  const draw = () => {
    if (!geometry) return;
    const colour = form.elements.colour.value;
    const limits = show(view, valve, geometry, colour);
    const told = limits ? legend(colour, limits) : leafletLegend();
    bar.style.background = told.gradient;
    ticks.replaceChildren(...told.ticks.map((textContent) => make("span", { textContent })));
  };

  const ask = () => {
    if (open) {
      waiting = true;
      return;
    }
    count += 1;
    open = count;
    model.set("asked", asked(form, open));
    model.save_changes();
  };

  const take = () => {
    const answer = model.get("answer");
    if (answer.id === open) open = 0;
    faults.textContent = answer.faults.join("\n");
    if (answer.faces) {
      geometry = decode(answer);
      verdict.textContent = answer.verdict;
      verdict.className = answer.certified ? "certified" : "uncertified";
      measures.replaceChildren(table(answer.rows));
      draw();
    }
    if (waiting && !open) {
      waiting = false;
      ask();
    }
  };

  form.addEventListener("submit", (event) => event.preventDefault());
  form.addEventListener("input", ({ target }) => (target.name === "colour" ? draw() : ask()));
  model.on("change:answer", take);
  take();
  return () => {
    model.off("change:answer", take);
    dispose(view);
  };
}

export default { render };

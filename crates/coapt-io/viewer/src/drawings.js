// What is drawn flat: the section, the leaflets unrolled, the forces of the chordae.

import { LEAFLET_COLOURS, SLACK_COLOUR, colourAt, css, niceAbove, shortNumber } from "./colours.js";
import { cut } from "./section.js";
import { begin, element } from "./svg.js";

const MARGIN = 14;

// A section along the axis from the anterior to the posterior annulus, the atrium on top and the aorta on the right as in a
// transoesophageal long-axis view. `shapes`: `{ positions, faint }`, drawn in their order.
export function drawSection(svg, { faces, faceLeaflet }, shapes, frame, offset_mm, reach_mm) {
  const { centre_mm, to_atrium, to_anterior } = frame;
  // x = y × z of the valve's frame: to the posteromedial side.
  const normal = cross(to_anterior, to_atrium);
  const plane = { origin: centre_mm, normal, right: to_anterior, up: to_atrium };
  const [width, height] = [420, 300];
  begin(svg, width, height, `Section ${shortNumber(Math.abs(offset_mm))} mm from the middle of the valve, atrium on top, aorta to the right`);
  const scale = (width - 2 * MARGIN) / (2 * reach_mm);
  const across = (right) => width / 2 + right * scale;
  const down = (up) => height * 0.3 - up * scale;
  svg.append(element("line", { x1: MARGIN, x2: width - MARGIN, y1: down(0), y2: down(0), class: "plane" }));
  for (const { positions, faint } of shapes) {
    // One element for each leaflet, not for each segment: it is drawn anew with each frame of a film.
    const lines = new Map();
    for (const { from, to, leaflet } of cut(positions, faces, faceLeaflet, plane, offset_mm)) {
      const line = `M${across(from[0]).toFixed(2)} ${down(from[1]).toFixed(2)}L${across(to[0]).toFixed(2)} ${down(to[1]).toFixed(2)}`;
      lines.set(leaflet, (lines.get(leaflet) ?? "") + line);
    }
    for (const [leaflet, d] of lines) {
      const stroke = css(LEAFLET_COLOURS[leaflet % LEAFLET_COLOURS.length]);
      svg.append(element("path", { d, stroke, "stroke-width": faint ? 1 : 2.5, opacity: faint ? 0.35 : 1, "stroke-linecap": "round", fill: "none" }));
    }
  }
  const bar = 10 * scale;
  svg.append(element("line", { x1: MARGIN, x2: MARGIN + bar, y1: height - MARGIN, y2: height - MARGIN, class: "bar" }));
  svg.append(element("text", { x: MARGIN + bar + 5, y: height - MARGIN + 4 }, "10 mm"));
  svg.append(element("text", { x: MARGIN, y: 16 }, "posterior"));
  svg.append(element("text", { x: width - MARGIN, y: 16, "text-anchor": "end" }, "anterior (aorta)"));
  svg.append(element("text", { x: width / 2, y: 16, "text-anchor": "middle" }, "atrium"));
}

function cross(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

// The leaflets unrolled along the line from the anterolateral to the posteromedial commissure, the anterior one above its free margin
// and the others below theirs, like a book laid open. `along` runs from 0 to 1; `fromMargin` in mm.
export function drawUnrolled(canvas, { faces, faceLeaflet }, along, fromMargin, colours) {
  const width = canvas.clientWidth || 600;
  const height = width / 2;
  const density = window.devicePixelRatio || 1;
  canvas.width = width * density;
  canvas.height = height * density;
  // Drawn by the processor: thousands of small triangles are what graphics cards' canvases are slow at.
  const pen = canvas.getContext("2d", { willReadFrequently: true });
  pen.scale(density, density);
  pen.clearRect(0, 0, width, height);
  const deepest = fromMargin.reduce((most, value) => (Number.isFinite(value) ? Math.max(most, value) : most), 1);
  const scale = (height / 2 - MARGIN) / deepest;
  const at = (vertex, side) => [MARGIN + along[vertex] * (width - 2 * MARGIN), height / 2 - side * (2 + fromMargin[vertex] * scale)];
  for (let face = 0; face < faceLeaflet.length; face += 1) {
    const corners = [0, 1, 2].map((corner) => faces[3 * face + corner]);
    if (corners.some((vertex) => !Number.isFinite(along[vertex]) || !Number.isFinite(fromMargin[vertex]))) continue;
    const side = faceLeaflet[face] === 0 ? 1 : -1;
    const colour = css([0, 1, 2].map((channel) => corners.reduce((sum, vertex) => sum + colours[3 * vertex + channel] / 3, 0)));
    pen.beginPath();
    for (const vertex of corners) pen.lineTo(...at(vertex, side));
    pen.closePath();
    pen.fillStyle = colour;
    pen.strokeStyle = colour;
    pen.fill();
    pen.stroke();
  }
  pen.fillStyle = "#222";
  pen.font = "13px system-ui, sans-serif";
  const words = (text, x, y, align) => {
    pen.textAlign = align;
    pen.fillText(text, x, y);
  };
  words("anterior leaflet", MARGIN, 14, "left");
  words("posterior leaflet", MARGIN, height - 5, "left");
  words("anterolateral", 2, height / 2 - 6, "left");
  words("posteromedial", width - 2, height / 2 - 6, "right");
  return deepest;
}

// Forces of the chordae: a row for each group, a stroke for each chord, slack ones grey at 0.
export function drawForces(svg, chords, groupNames, largest_n) {
  const groups = [...new Set(chords.group)].sort((a, b) => a - b);
  const [width, left, row] = [840, 230, 22];
  const height = 34 + row * groups.length;
  begin(svg, width, height, "Tension of each chord, by group");
  const across = (force) => left + (force / largest_n) * (width - left - 60);
  groups.forEach((group, line) => {
    const y = 8 + row * line;
    const of = [...chords.force_n].filter((_, chord) => chords.group[chord] === group);
    svg.append(element("text", { x: left - 8, y: y + 13, "text-anchor": "end" }, groupNames[group] ?? `group ${group + 1}`));
    svg.append(element("line", { x1: left, x2: width - 60, y1: y + row / 2, y2: y + row / 2, class: "plane" }));
    for (const force of of) {
      const colour = css(force > 0 ? colourAt("viridis", force / largest_n) : SLACK_COLOUR);
      svg.append(element("line", { x1: across(force), x2: across(force), y1: y + 3, y2: y + row - 3, stroke: colour, "stroke-width": 2.5 }));
    }
  });
  for (const share of [0, 0.25, 0.5, 0.75, 1]) {
    svg.append(element("text", { x: across(share * largest_n), y: height - 8, "text-anchor": "middle" }, shortNumber(share * largest_n)));
  }
}

const CURVES = [
  { key: "orifice_area_mm2", label: "orifice [mm²]", dash: "" },
  { key: "coaptation_area_mm2", label: "contact [mm²]", dash: "5 4" },
];
// Where a pressure stands in the drawing of curves, between none and the highest.
function atPressure(pressure, peak) {
  return 60 + Math.cbrt(pressure / peak) * 580;
}

const STATE_COLOURS = ["#8f4500", "#0b4f8a"];

// Orifice and contact while valves close, against pressure; `markFrame` puts a line at the frame that is shown. Pressure is drawn by
// its cube root, as films are made, so that frames are evenly spaced.
export function drawCurves(svg, states) {
  const [width, height, below] = [840, 240, 40];
  begin(svg, width, height, "Orifice and contact area while the valve closes, against pressure");
  if (!states.length) return;
  const known = states.flatMap(({ geometry: { film } }) => CURVES.flatMap(({ key }) => film[key].filter((value) => value !== null)));
  const most = niceAbove(Math.max(1e-9, ...known));
  const peak = Math.max(...states[0].geometry.film.pressures_mmhg);
  const across = (pressure) => atPressure(pressure, peak);
  const up = (value) => height - below - (value / most) * (height - below - 14);
  svg.append(element("line", { x1: across(0), x2: across(peak), y1: up(0), y2: up(0), stroke: "#9a9a94" }));
  for (const share of [0, 0.5, 1]) svg.append(element("text", { x: across(0) - 6, y: up(share * most) + 4, "text-anchor": "end" }, shortNumber(share * most)));
  for (const share of [0, 0.01, 0.1, 0.5, 1]) svg.append(element("text", { x: across(share * peak), y: height - below + 16, "text-anchor": "middle" }, shortNumber(share * peak)));
  svg.append(element("text", { x: (across(0) + across(peak)) / 2, y: height - 6, "text-anchor": "middle" }, "pressure [mmHg]"));
  states.forEach(({ name, geometry: { film } }, number) => {
    CURVES.forEach(({ key, label, dash }, line) => {
      const points = film[key].flatMap((value, at) => (value === null || !film.certified[at] ? [] : [`${across(film.pressures_mmhg[at])},${up(value)}`]));
      const colour = STATE_COLOURS[number % STATE_COLOURS.length];
      svg.append(element("polyline", { points: points.join(" "), fill: "none", stroke: colour, "stroke-width": 2, "stroke-dasharray": dash }));
      const y = 24 + 18 * (number * CURVES.length + line);
      svg.append(element("line", { x1: width - 190, x2: width - 160, y1: y - 4, y2: y - 4, stroke: colour, "stroke-width": 2, "stroke-dasharray": dash }));
      svg.append(element("text", { x: width - 154, y }, `${name}: ${label}`));
    });
  });
  svg.append(element("line", { y1: 8, y2: up(0), stroke: "#222", "stroke-width": 1, class: "frame" }));
}

// Moves the line of curves to a frame; none where the frame is not one of the film's.
export function markFrame(svg, states, frame) {
  const line = svg.querySelector(".frame");
  if (!line) return;
  const pressures = states[0].geometry.film.pressures_mmhg;
  line.toggleAttribute("hidden", pressures[frame] === undefined);
  if (pressures[frame] === undefined) return;
  const at = atPressure(pressures[frame], Math.max(...pressures));
  line.setAttribute("x1", at);
  line.setAttribute("x2", at);
}

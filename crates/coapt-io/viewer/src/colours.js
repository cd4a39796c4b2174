// Colour maps that the colour-blind can read, and what is coloured with them.

import cividis from "./cividis.json" with { type: "json" };

// Cividis (Nunez et al. 2018; the program's pictures read the same file), viridis (van der Walt and Smith 2015): nine stops of each. Blue to orange is ours: dark ends, light middle.
const STOPS = {
  cividis,
  viridis: ["440154", "472d7b", "3b528b", "2c728e", "21918c", "28ae80", "5ec962", "addc30", "fde725"],
  "blue-orange": ["0b4f8a", "2f7fbf", "7db3dd", "c4dcef", "f5f3ee", "fbd9ae", "f3ab5a", "d1751c", "8f4500"],
};

const parse = (hex) => [0, 2, 4].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255);
const TABLES = Object.fromEntries(Object.entries(STOPS).map(([name, stops]) => [name, stops.map(parse)]));

// Red, green and blue, each from 0 to 1, of a share from 0 to 1 of a map.
export function colourAt(map, share) {
  return putColour([0, 0, 0], 0, TABLES[map], share);
}

// Writes a colour to its place in many: thousands for each frame of a film.
function putColour(colours, place, table, share) {
  const at = Math.min(Math.max(Number.isFinite(share) ? share : 0, 0), 1) * (table.length - 1);
  const low = Math.min(Math.floor(at), table.length - 2);
  const [from, to] = [table[low], table[low + 1]];
  for (let channel = 0; channel < 3; channel += 1) colours[place + channel] = from[channel] + (to[channel] - from[channel]) * (at - low);
  return colours;
}

export function css([red, green, blue]) {
  return `rgb(${[red, green, blue].map((part) => Math.round(part * 255)).join(",")})`;
}

export const LEAFLET_COLOURS = ["c05a4a", "4a7fb0", "6f9a4f", "9a6fb0"].map(parse);
export const SLACK_COLOUR = parse("9a9a9a");

// What a valve can be coloured by. `top`: values beyond it look alike; none where the data say how far to go.
export const QUANTITIES = {
  gap_mm: { label: "distance to the other leaflet", unit: "mm", map: "cividis", bottom: 0, top: 6 },
  contact: { label: "contact with the other leaflet", unit: "", map: "cividis", bottom: 0, top: 1, ends: ["free", "in contact"] },
  strain: { label: "mean strain of the edges", unit: "%", factor: 100, map: "viridis", bottom: 0 },
  displacement_mm: { label: "way from the open valve", unit: "mm", map: "viridis", bottom: 0 },
  annulus_distance_mm: { label: "height above the annular plane", unit: "mm", map: "blue-orange", symmetric: true },
  leaflet: { label: "leaflet", unit: "" },
};

// The values between which a quantity's colours run, the same for all states, so that equal colours are equal values.
export function range(name, fieldsOfStates) {
  const quantity = QUANTITIES[name];
  if (quantity.top !== undefined) return [quantity.bottom, quantity.top];
  let reach = 0;
  for (const fields of fieldsOfStates) for (const value of fields[name] ?? []) if (Number.isFinite(value)) reach = Math.max(reach, Math.abs(value));
  reach = niceAbove(reach);
  return quantity.symmetric ? [-reach, reach] : [quantity.bottom, reach];
}

// The next of 1, 2, 3, 5, 8 times a power of ten.
export function niceAbove(value) {
  if (!(value > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  const step = [1, 2, 3, 5, 8, 10].find((step) => step * power >= value * (1 - 1e-9));
  return step * power;
}

// Colours of vertices, shape `[vertex, 3]`.
export function vertexColours(name, values, [low, high]) {
  const { map } = QUANTITIES[name];
  const colours = new Float32Array(values.length * 3);
  for (let vertex = 0; vertex < values.length; vertex += 1) putColour(colours, 3 * vertex, TABLES[map], (values[vertex] - low) / (high - low));
  return colours;
}

// Colours of vertices by the leaflet that they belong to, shape `[vertex, 3]`.
export function leafletColours({ faces, faceLeaflet }, vertexCount) {
  const colours = new Float32Array(3 * vertexCount);
  faceLeaflet.forEach((leaflet, face) => {
    for (let corner = 0; corner < 3; corner += 1) colours.set(LEAFLET_COLOURS[leaflet % LEAFLET_COLOURS.length], 3 * faces[3 * face + corner]);
  });
  return colours;
}

export function leafletLegend() {
  const gradient = `linear-gradient(to right, ${css(LEAFLET_COLOURS[0])} 50%, ${css(LEAFLET_COLOURS[1])} 50%)`;
  return { gradient, ticks: ["anterior", "posterior"], title: "leaflet" };
}

// A legend as CSS and the words at its ticks.
export function legend(name, [low, high]) {
  const quantity = QUANTITIES[name];
  const shares = [0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1];
  const gradient = `linear-gradient(to right, ${shares.map((share) => css(colourAt(quantity.map, share))).join(", ")})`;
  const number = (share) => shortNumber((low + (high - low) * share) * (quantity.factor ?? 1));
  const ticks = quantity.ends ?? [number(0), number(0.5), number(1) + (quantity.top !== undefined ? " or more" : "")];
  return { gradient, ticks, title: quantity.unit ? `${quantity.label} [${quantity.unit}]` : quantity.label };
}

export function shortNumber(value) {
  return String(Number(value.toPrecision(3))).replace("-", "−");
}

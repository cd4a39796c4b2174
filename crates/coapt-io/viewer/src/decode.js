// Arrays of the page's data: little-endian numbers in base64.

function bytes(base64) {
  return Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
}

export function floats(base64) {
  return new Float32Array(bytes(base64).buffer);
}

export function integers(base64) {
  return new Uint32Array(bytes(base64).buffer);
}

function shorts(base64) {
  return new Uint16Array(bytes(base64).buffer);
}

// The geometry of a state with its arrays decoded. Positions and lengths in mm, shapes `[vertex, 3]`, `[face, 3]`, `[chord, 2]`.
export function decodeGeometry(coded) {
  const fields = {};
  for (const [name, values] of Object.entries(coded.fields)) fields[name] = floats(values);
  return {
    faces: integers(coded.faces),
    faceLeaflet: integers(coded.face_leaflet),
    closed: floats(coded.closed),
    open: floats(coded.open),
    fields,
    chords: coded.chords && {
      ends: integers(coded.chords.ends),
      group: integers(coded.chords.group),
      closed: floats(coded.chords.closed),
      open: coded.chords.open && floats(coded.chords.open),
      force_n: floats(coded.chords.force_n),
    },
    rings: coded.rings.map(floats),
    film: coded.film,
  };
}

// A frame of a film: positions of leaflet vertices and of both ends of each chord [mm], and what is known at the vertices.
export function decodeFrame(film, number, { open }, { centre_mm, to_atrium }) {
  const place = (steps) => Float32Array.from(steps, (step, part) => film.low_mm[part % 3] + step * film.step_mm);
  const positions = place(shorts(film.positions[number]));
  const count = positions.length / 3;
  const ofVertex = (value) => Float32Array.from({ length: count }, (_, vertex) => value(positions.subarray(3 * vertex, 3 * vertex + 3), vertex));
  return {
    positions,
    chordEnds: place(shorts(film.chords[number])),
    fields: {
      gap_mm: Float32Array.from(bytes(film.gap[number]), (step) => step * film.gap_step_mm),
      strain: Float32Array.from(bytes(film.strain[number]), (step) => step * film.strain_step),
      contact: Float32Array.from(bytes(film.contact[number])),
      displacement_mm: ofVertex((at, vertex) => Math.hypot(...at.map((part, axis) => part - open[3 * vertex + axis]))),
      annulus_distance_mm: ofVertex((at) => at.reduce((sum, part, axis) => sum + (part - centre_mm[axis]) * to_atrium[axis], 0)),
    },
  };
}

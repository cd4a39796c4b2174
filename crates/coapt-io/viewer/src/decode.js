// Arrays of the page's data: little-endian numbers in base64.

function bytes(base64) {
  const letters = atob(base64);
  const made = new Uint8Array(letters.length);
  for (let at = 0; at < made.length; at += 1) made[at] = letters.charCodeAt(at);
  return made;
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
  const place = (steps) => {
    const made = new Float32Array(steps.length);
    for (let part = 0; part < made.length; part += 1) made[part] = film.low_mm[part % 3] + steps[part] * film.step_mm;
    return made;
  };
  const scaled = (steps, step) => {
    const made = new Float32Array(steps.length);
    for (let at = 0; at < made.length; at += 1) made[at] = steps[at] * step;
    return made;
  };
  const positions = place(shorts(film.positions[number]));
  const count = positions.length / 3;
  const displacement_mm = new Float32Array(count);
  const annulus_distance_mm = new Float32Array(count);
  for (let vertex = 0; vertex < count; vertex += 1) {
    let [moved, height] = [0, 0];
    for (let axis = 0; axis < 3; axis += 1) {
      const at = positions[3 * vertex + axis];
      moved += (at - open[3 * vertex + axis]) ** 2;
      height += (at - centre_mm[axis]) * to_atrium[axis];
    }
    displacement_mm[vertex] = Math.sqrt(moved);
    annulus_distance_mm[vertex] = height;
  }
  return {
    positions,
    chordEnds: place(shorts(film.chords[number])),
    fields: {
      gap_mm: scaled(bytes(film.gap[number]), film.gap_step_mm),
      strain: scaled(bytes(film.strain[number]), film.strain_step),
      contact: scaled(bytes(film.contact[number]), 1),
      displacement_mm,
      annulus_distance_mm,
    },
  };
}

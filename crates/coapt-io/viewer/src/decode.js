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

// The geometry of a state with its arrays decoded. Positions and lengths in mm, shapes `[vertex, 3]`, `[face, 3]`, `[chord, 2]`.
export function decodeGeometry(coded) {
  const fields = {};
  for (const [name, values] of Object.entries(coded.fields)) fields[name] = floats(values);
  const film = coded.film && {
    pressures_mmhg: coded.film.pressures_mmhg,
    certified: coded.film.certified,
    frames: coded.film.frames.map((frame) => {
      const decoded = { positions: floats(frame.positions), fields: {}, chords: frame.chords && floats(frame.chords) };
      for (const [name, values] of Object.entries(frame.fields)) decoded.fields[name] = floats(values);
      return decoded;
    }),
  };
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
    film,
  };
}

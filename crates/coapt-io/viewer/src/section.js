// Where a plane cuts a surface: what an echo section shows.

// Segments of the cut through triangles, each `{ from, to, leaflet }` in coordinates of the plane: `[to the right, up]` in mm.
// The plane holds `origin + offset * normal`; `right` and `up` lie in it.
export function cut(positions, faces, faceLeaflet, { origin, normal, right, up }, offset) {
  const at = (vertex) => [0, 1, 2].map((axis) => positions[3 * vertex + axis] - origin[axis]);
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const segments = [];
  for (let face = 0; face < faces.length / 3; face += 1) {
    const corners = [0, 1, 2].map((corner) => at(faces[3 * face + corner]));
    const heights = corners.map((corner) => dot(corner, normal) - offset);
    const ends = [];
    for (let corner = 0; corner < 3; corner += 1) {
      const next = (corner + 1) % 3;
      // A vertex in the plane counts as above: each edge is cut once or not at all.
      if (heights[corner] >= 0 === heights[next] >= 0) continue;
      const share = heights[corner] / (heights[corner] - heights[next]);
      const point = corners[corner].map((from, axis) => from + (corners[next][axis] - from) * share);
      ends.push([dot(point, right), dot(point, up)]);
    }
    if (ends.length === 2) segments.push({ from: ends[0], to: ends[1], leaflet: faceLeaflet[face] });
  }
  return segments;
}

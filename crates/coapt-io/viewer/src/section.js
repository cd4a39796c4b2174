// Where a plane cuts a surface: what an echo section shows.

// Segments of the cut through triangles, each `{ from, to, leaflet }` in coordinates of the plane: `[to the right, up]` in mm.
// The plane holds `origin + offset * normal`; `right` and `up` lie in it.
export function cut(positions, faces, faceLeaflet, { origin, normal, right, up }, offset) {
  const dot = (x, y, z, axis) => x * axis[0] + y * axis[1] + z * axis[2];
  const heights = new Float64Array(positions.length / 3);
  for (let vertex = 0; vertex < heights.length; vertex += 1) {
    const at = 3 * vertex;
    heights[vertex] = dot(positions[at] - origin[0], positions[at + 1] - origin[1], positions[at + 2] - origin[2], normal) - offset;
  }
  // A vertex in the plane counts as above: each edge is cut once or not at all.
  const isCut = (one, other) => heights[one] >= 0 !== heights[other] >= 0;
  const point = (one, other) => {
    const share = heights[one] / (heights[one] - heights[other]);
    const [x, y, z] = [0, 1, 2].map((axis) => {
      const from = positions[3 * one + axis];
      return from + (positions[3 * other + axis] - from) * share - origin[axis];
    });
    return [dot(x, y, z, right), dot(x, y, z, up)];
  };
  const segments = [];
  for (let face = 0; face < faces.length / 3; face += 1) {
    const [a, b, c] = [faces[3 * face], faces[3 * face + 1], faces[3 * face + 2]];
    // Most are not: nothing is made for them.
    if (!isCut(a, b) && !isCut(b, c)) continue;
    const edges = [[a, b], [b, c], [c, a]].filter(([one, other]) => isCut(one, other));
    if (edges.length === 2) segments.push({ from: point(...edges[0]), to: point(...edges[1]), leaflet: faceLeaflet[face] });
  }
  return segments;
}

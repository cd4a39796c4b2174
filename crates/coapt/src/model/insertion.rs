//! Where a chord inserts in a leaflet, and which tissue shares its pull.
//!
//! An insertion is a patch of fixed size in millimetres, so that refining the mesh changes neither where a chord pulls
//! nor on how much tissue.

use crate::Vec3;
use crate::energy::chord::WeightedVertices;

use super::Model;
use super::surface::Surface;
use crate::scene::default_insertion_radius_mm;

/// Weights are integrated over pieces of triangles this much smaller than the patch's radius [1]. Fewer, and weights
/// begin to depend on the mesh.
const PIECES_PER_RADIUS: f64 = 8.0;
/// But a triangle has no more pieces along an edge: in one so much larger than the patch, a few pieces are the patch.
const MOST_PIECES: f64 = 64.0;

/// The point of a leaflet nearest to a chord point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Foot {
    pub(crate) distance_mm: f64,
    face: usize,
    /// Weights of the face's corners [1].
    weights: [f64; 3],
}

/// A chord's place in a leaflet.
#[derive(Clone, Debug)]
pub(crate) struct Insertion {
    /// The point itself [mm].
    pub(crate) at_mm: Vec3,
    /// The vertices that share the pull.
    pub(crate) vertices: WeightedVertices,
}

/// The nearest point of the leaflets within reach; of equals, the one in the first face.
pub(crate) fn foot(leaflet: &Surface, point: Vec3, reach_mm: f64) -> Option<Foot> {
    let mut best: Option<Foot> = None;
    let mut bound = reach_mm;
    for face in 0..leaflet.faces.len() {
        let corners = leaflet.corners(face);
        let [a, b, c] = corners;
        let outside = (a.inf(&b).inf(&c) - point).sup(&(point - a.sup(&b).sup(&c)));
        if outside.max() > bound {
            continue;
        }
        let weights = nearest_weights(point, corners);
        let distance_mm = (a * weights[0] + b * weights[1] + c * weights[2] - point).norm();
        if distance_mm <= reach_mm && best.is_none_or(|best| distance_mm < best.distance_mm) {
            bound = distance_mm;
            best = Some(Foot {
                distance_mm,
                face,
                weights,
            });
        }
    }
    best
}

/// The insertion at the place of one leaflet of a model that is nearest to a point of the open valve, if it is in reach.
pub(crate) fn insertion_near(model: &Model, leaflet: u32, point: Vec3, reach_mm: f64) -> Option<Insertion> {
    let of_leaflet = |&face: &usize| model.face_leaflet[face] == leaflet;
    let faces = (0..model.faces.len())
        .filter(of_leaflet)
        .map(|face| model.faces[face]);
    let surface = Surface {
        points: model.rest_mm[..model.leaflet_vertex_count].to_vec(),
        faces: faces.collect(),
        ..Surface::default()
    };
    let foot = foot(&surface, point, reach_mm)?;
    Some(Spread::new(&surface).insertion(&foot, default_insertion_radius_mm()))
}

/// Weights of a triangle's corners at its point nearest to another (Ericson 2005, Real-Time Collision Detection, 5.1.5).
fn nearest_weights(p: Vec3, [a, b, c]: [Vec3; 3]) -> [f64; 3] {
    let (ab, ac) = (b - a, c - a);
    let along = |from: Vec3| (ab.dot(&(p - from)), ac.dot(&(p - from)));
    let ((d1, d2), (d3, d4), (d5, d6)) = (along(a), along(b), along(c));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let t = d1 / (d1 - d3);
        return [1.0 - t, t, 0.0];
    }
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let t = d2 / (d2 - d6);
        return [1.0 - t, 0.0, t];
    }
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - t, t];
    }
    let sum = va + vb + vc;
    [va / sum, vb / sum, vc / sum]
}

/// Spreads insertions over the tissue around them.
pub(crate) struct Spread<'a> {
    leaflet: &'a Surface,
    faces_at: Vec<Vec<u32>>,
}

impl<'a> Spread<'a> {
    pub(crate) fn new(leaflet: &'a Surface) -> Self {
        let mut faces_at = vec![Vec::new(); leaflet.points.len()];
        for (index, face) in leaflet.faces.iter().enumerate() {
            face.iter().for_each(|&v| faces_at[v as usize].push(index as u32));
        }
        Self { leaflet, faces_at }
    }

    /// The insertion at a foot. Each vertex has as weight the integral of its hat function times 1 − (r / R)² over the
    /// tissue that hangs together within the radius R: a point load as the mesh would see it, made R wide.
    pub(crate) fn insertion(&self, foot: &Foot, radius_mm: f64) -> Insertion {
        let face = self.leaflet.faces[foot.face];
        let corners = self.leaflet.corners(foot.face);
        let at_mm = (0..3).map(|k| corners[k] * foot.weights[k]).sum();
        let mut vertices = WeightedVertices::new();
        if radius_mm > 0.0 {
            for near in self.connected(foot.face, at_mm, radius_mm) {
                self.integrate(near as usize, at_mm, radius_mm, &mut vertices);
            }
        }
        let total: f64 = vertices.iter().map(|(_, weight)| weight).sum();
        if total > 0.0 {
            vertices.iter_mut().for_each(|(_, weight)| *weight /= total);
        } else {
            let corners = face.into_iter().zip(foot.weights);
            vertices = corners.filter(|&(_, weight)| weight > 0.0).collect();
        }
        Insertion { at_mm, vertices }
    }

    /// The faces within reach of a place that hang together with the one there, in ascending order.
    fn connected(&self, face: usize, at_mm: Vec3, radius_mm: f64) -> Vec<u32> {
        let mut found = vec![face as u32];
        let mut next = 0;
        while let Some(&face) = found.get(next) {
            next += 1;
            for &vertex in &self.leaflet.faces[face as usize] {
                for &other in &self.faces_at[vertex as usize] {
                    let [a, b, c] = self.leaflet.corners(other as usize);
                    let [u, v, w] = nearest_weights(at_mm, [a, b, c]);
                    let near = (a * u + b * v + c * w - at_mm).norm() < radius_mm;
                    if near && !found.contains(&other) {
                        found.push(other);
                    }
                }
            }
        }
        found.sort_unstable();
        found
    }

    /// Adds what one face contributes, summed over equal pieces of it.
    fn integrate(&self, face: usize, at_mm: Vec3, radius_mm: f64, vertices: &mut WeightedVertices) {
        let [a, b, c] = self.leaflet.corners(face);
        let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        let pieces = (PIECES_PER_RADIUS * longest / radius_mm)
            .ceil()
            .clamp(2.0, MOST_PIECES) as u32;
        let piece_area = (b - a).cross(&(c - a)).norm() / f64::from(pieces * pieces);
        let mut sums = [0.0; 3];
        for [u, v] in piece_centres(pieces) {
            let weights = [1.0 - u - v, u, v];
            let place = a * weights[0] + b * weights[1] + c * weights[2];
            let share = 1.0 - (place - at_mm).norm_squared() / (radius_mm * radius_mm);
            if share > 0.0 {
                (0..3).for_each(|k| sums[k] += share * piece_area * weights[k]);
            }
        }
        for (vertex, sum) in self.leaflet.faces[face].into_iter().zip(sums) {
            match vertices.iter_mut().find(|(known, _)| *known == vertex) {
                _ if sum == 0.0 => {}
                Some((_, weight)) => *weight += sum,
                None => vertices.push((vertex, sum)),
            }
        }
    }
}

/// Centres of the equal triangles that a triangle falls into with so many along each edge, as weights of its second and
/// third corner.
fn piece_centres(pieces: u32) -> impl Iterator<Item = [f64; 2]> {
    let at = move |i: u32, third: f64| (f64::from(i) + third / 3.0) / f64::from(pieces);
    (0..pieces).flat_map(move |i| {
        (0..pieces - i).flat_map(move |j| {
            let upright = std::iter::once([at(i, 1.0), at(j, 1.0)]);
            let turned = (i + j + 1 < pieces).then_some([at(i, 2.0), at(j, 2.0)]);
            upright.chain(turned)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square sheet of side 8 mm, so many steps along each side.
    fn sheet(steps: u32) -> Surface {
        let row = steps + 1;
        let at = |k: u32| 8.0 * f64::from(k) / f64::from(steps);
        let points = (0..row * row)
            .map(|v| Vec3::new(at(v % row), at(v / row), 0.0))
            .collect();
        let cells = (0..steps * steps).map(|c| c / steps * row + c % steps);
        let faces: Vec<[u32; 3]> = cells
            .flat_map(|v| [[v, v + 1, v + row], [v + 1, v + row + 1, v + row]])
            .collect();
        Surface {
            points,
            face_leaflet: vec![0; faces.len()],
            faces,
            ..Surface::default()
        }
    }

    fn insertion(leaflet: &Surface, at: Vec3, radius_mm: f64) -> Insertion {
        let foot = foot(leaflet, at, 1.0).expect("within reach");
        Spread::new(leaflet).insertion(&foot, radius_mm)
    }

    fn mean(leaflet: &Surface, insertion: &Insertion, of: impl Fn(Vec3) -> f64) -> f64 {
        let vertices = insertion.vertices.iter();
        vertices
            .map(|&(v, weight)| weight * of(leaflet.points[v as usize]))
            .sum()
    }

    /// Without a radius the pull goes to the foot of the perpendicular alone; exact but for rounding.
    #[test]
    fn a_point_is_the_mean_of_its_triangle() {
        let leaflet = sheet(4);
        for at in [[3.3, 4.1], [4.0, 4.0], [0.0, 2.7], [7.9, 7.9]] {
            let foot = Vec3::new(at[0], at[1], 0.0);
            let found = insertion(&leaflet, foot + Vec3::z() * 0.4, 0.0);
            assert!(found.vertices.len() <= 3 && (found.at_mm - foot).norm() < 1e-12);
            for axis in 0..2 {
                assert!((mean(&leaflet, &found, |p| p[axis]) - foot[axis]).abs() < 1e-12);
            }
        }
        assert!(foot(&leaflet, Vec3::new(-1.1, 4.0, 0.0), 1.0).is_none());
    }

    /// The weights add up to one and their centre does not depend on the mesh: inside it is the insertion, at a margin
    /// 16/15 R/π from it, which is where 1 − (r / R)² over half a disc has its centre. 1 % of R for pieces of R/8.
    #[test]
    fn a_patch_has_the_same_centre_on_every_mesh() {
        for steps in [3, 4, 8, 13, 20] {
            let leaflet = sheet(steps);
            let inside = insertion(&leaflet, Vec3::new(3.7, 4.2, 0.0), 1.5);
            let margin = insertion(&leaflet, Vec3::new(3.7, 0.0, 0.0), 1.5);
            for (found, y) in [
                (&inside, 4.2),
                (&margin, 16.0 / 15.0 * 1.5 / std::f64::consts::PI),
            ] {
                assert!((mean(&leaflet, found, |_| 1.0) - 1.0).abs() < 1e-12);
                assert!((mean(&leaflet, found, |p| p.x) - 3.7).abs() < 0.015, "{steps}");
                assert!((mean(&leaflet, found, |p| p.y) - y).abs() < 0.015, "{steps}");
            }
        }
    }

    /// Tissue across a cut, near in space but not joined within the radius, takes no share.
    #[test]
    fn a_patch_does_not_jump_across_a_cleft() {
        let mut leaflet = sheet(8);
        let count = leaflet.points.len() as u32;
        let twin: Vec<Vec3> = leaflet
            .points
            .iter()
            .map(|p| p + Vec3::new(8.01, 0.0, 0.0))
            .collect();
        let faces: Vec<[u32; 3]> = leaflet.faces.iter().map(|f| f.map(|v| v + count)).collect();
        leaflet.points.extend(twin);
        leaflet.faces.extend(faces);
        let found = insertion(&leaflet, Vec3::new(7.5, 4.0, 0.0), 1.5);
        assert!(found.vertices.iter().all(|&(v, _)| v < count));
    }
}

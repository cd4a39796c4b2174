//! A surface that can be asked for its nearest point.

use rayon::prelude::*;

use super::distance::triangle_area;
use super::plane::vector_area;
use super::tree::{Tree, tree};
use crate::Vec3;
use crate::contact::nearest::point_triangle;

/// A surface in some position, with areas and a tree.
pub(crate) struct IndexedSurface<'a> {
    /// Triangles.
    pub(crate) faces: &'a [[u32; 3]],
    /// Where its points are [mm], shape `[point]`.
    pub(crate) points_mm: Vec<Vec3>,
    /// Whether a face uses the point, shape `[point]`.
    pub(crate) used: Vec<bool>,
    /// A third of the area of the faces about each point [mm²], shape `[point]`.
    pub(crate) point_area_mm2: Vec<f64>,
    /// Shape `[face]`.
    pub(crate) face_area_mm2: Vec<f64>,
    /// Shape `[face]`.
    pub(crate) centroids_mm: Vec<Vec3>,
    face_tree: Tree,
}

/// The nearest point of a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Foot {
    /// The face that it lies on.
    pub(crate) face: usize,
    /// Its weights on the corners of the face [1]; exactly zero off a corner.
    pub(crate) weights: [f64; 3],
    /// Where it is [mm].
    pub(crate) place: Vec3,
    /// How far away [mm].
    pub(crate) distance_mm: f64,
}

/// Points that are searched for one after the other, so that each search starts from what the last one found. A fixed
/// number: the answer must not depend on how many threads there are, not even between faces equally near.
const IN_TURN: usize = 256;

impl<'a> IndexedSurface<'a> {
    /// A surface of sound faces, with its points at these places, shape `[point]`.
    pub(crate) fn new(faces: &'a [[u32; 3]], points_mm: Vec<Vec3>) -> Self {
        let corners = |face: usize| faces[face].map(|v| points_mm[v as usize]);
        let mut used = vec![false; points_mm.len()];
        let mut point_area_mm2 = vec![0.0; points_mm.len()];
        let face_area_mm2: Vec<f64> = (0..faces.len()).map(|f| triangle_area(corners(f))).collect();
        for (face, area) in faces.iter().zip(&face_area_mm2) {
            for &v in face {
                used[v as usize] = true;
                point_area_mm2[v as usize] += area / 3.0;
            }
        }
        let centroid = |face| corners(face).iter().sum::<Vec3>() / 3.0;
        let centroids_mm: Vec<Vec3> = (0..faces.len()).map(centroid).collect();
        let face_tree = tree((0..faces.len() as u32).collect(), corners);
        Self {
            faces,
            points_mm,
            used,
            point_area_mm2,
            face_area_mm2,
            centroids_mm,
            face_tree,
        }
    }

    /// The corners of a face.
    pub(crate) fn corners(&self, face: usize) -> [Vec3; 3] {
        self.faces[face].map(|v| self.points_mm[v as usize])
    }

    /// Mean length of the sides of all faces [mm].
    pub(crate) fn mean_edge_mm(&self) -> f64 {
        let around = |face| {
            let [a, b, c] = self.corners(face);
            (b - a).norm() + (c - b).norm() + (a - c).norm()
        };
        (0..self.faces.len()).map(around).sum::<f64>() / (3 * self.faces.len()) as f64
    }

    /// Middle of the surface, by area [mm].
    pub(crate) fn middle_mm(&self) -> Vec3 {
        let parts = self.centroids_mm.iter().zip(&self.face_area_mm2);
        parts.map(|(centroid, area)| centroid * *area).sum::<Vec3>() / self.face_area_mm2.iter().sum::<f64>()
    }

    /// Sum of the area vectors of all faces [mm²]: where the surface looks on the whole.
    pub(crate) fn looks_mm2(&self) -> Vec3 {
        (0..self.faces.len())
            .map(|face| vector_area(&self.corners(face)))
            .sum()
    }

    /// The lowest and the highest corner of the box about the surface [mm].
    pub(crate) fn bounds_mm(&self) -> [Vec3; 2] {
        let used = self.points_mm.iter().zip(&self.used).filter(|part| *part.1);
        let empty = [Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)];
        used.fold(empty, |[low, high], (p, _)| [low.inf(p), high.sup(p)])
    }

    /// The nearest point of this surface, which has faces, to each place.
    pub(crate) fn feet(&self, places: &[Vec3]) -> Vec<Foot> {
        let nearest = |place: Vec3, limit: f64| {
            let nearer = |face: usize, best: f64| {
                Some(self.foot(place, face).distance_mm).filter(|&distance| distance < best)
            };
            let found = self.face_tree.nearest_face(place, limit, nearer);
            found.map(|(face, _)| self.foot(place, face))
        };
        in_turn(places, |place, limit| {
            let found = nearest(place, limit);
            // Far from the origin rounding may cut the limit short.
            let found = found.or_else(|| nearest(place, f64::INFINITY));
            let foot = found.unwrap_or_else(|| self.foot(place, 0));
            (foot, foot.distance_mm)
        })
    }

    /// The distance of each place to the nearest centroid of a face [mm].
    pub(crate) fn to_centroids(&self, places: &[Vec3]) -> Vec<f64> {
        let all = (0..self.faces.len() as u32).collect();
        let centroid_tree = tree(all, |face| [self.centroids_mm[face]; 3]);
        let nearest = |place: Vec3, limit: f64| {
            centroid_tree.nearest(place, limit, |face, best| {
                Some((place - self.centroids_mm[face]).norm()).filter(|&distance| distance < best)
            })
        };
        in_turn(places, |place, limit| {
            let found = nearest(place, limit).or_else(|| nearest(place, f64::INFINITY));
            let distance = found.unwrap_or_else(|| (place - self.centroids_mm[0]).norm());
            (distance, distance)
        })
    }

    fn foot(&self, place: Vec3, face: usize) -> Foot {
        let [a, b, c] = self.corners(face);
        let nearest = point_triangle(&place, &a, &b, &c);
        let [_, u, v, w] = nearest.weights;
        Foot {
            face,
            weights: [-u, -v, -w],
            place: place - nearest.separation_mm,
            distance_mm: nearest.separation_mm.norm(),
        }
    }
}

/// Searches for each place, no farther than the distance of the last one and the way from there.
fn in_turn<T: Send>(places: &[Vec3], search: impl Fn(Vec3, f64) -> (T, f64) + Sync) -> Vec<T> {
    let chunk = |places: &[Vec3]| -> Vec<T> {
        let mut last: Option<(Vec3, f64)> = None;
        let one = |&place: &Vec3| {
            // A hair more for rounding.
            let limit = last.map_or(f64::INFINITY, |(before, distance)| {
                (distance + (place - before).norm()) * (1.0 + 1e-9) + 1e-12
            });
            let (found, distance) = search(place, limit);
            last = Some((place, distance));
            found
        };
        places.iter().map(one).collect()
    };
    let chunks: Vec<Vec<T>> = places.par_chunks(IN_TURN).map(chunk).collect();
    chunks.into_iter().flatten().collect()
}

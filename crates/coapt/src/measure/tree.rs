//! The nearest triangle to a point: a tree of bounding boxes over some faces.

use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};
use parry3d_f64::query::PointQuery;

use crate::Vec3;

/// A tree of boxes, each leaf of it a place in `faces`: parry wants leaves to be numbered without gaps.
pub(super) struct Tree {
    boxes: Bvh,
    faces: Vec<u32>,
}

/// Builds the tree over some faces with these corners. Clustered instead of binned, trees take longer to build
/// and are no faster to ask: measuring the healthy valve costs 15 % more.
pub(super) fn tree(faces: Vec<u32>, corners: impl Fn(usize) -> [Vec3; 3]) -> Tree {
    let box_of = |&f: &u32| Aabb::from_points(corners(f as usize).map(Vector::from));
    let boxes: Vec<Aabb> = faces.iter().map(box_of).collect();
    Tree {
        boxes: Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes),
        faces,
    }
}

impl Tree {
    /// Distance from a point to the nearest face, if one is nearer than the limit. `nearer(face, best)` gives the
    /// distance to a face where that counts and is below the best so far.
    pub(super) fn nearest(
        &self,
        p: Vec3,
        limit: f64,
        nearer: impl Fn(usize, f64) -> Option<f64>,
    ) -> Option<f64> {
        self.nearest_face(p, limit, nearer).map(|(_, distance)| distance)
    }

    /// The same, with the face that is nearest.
    pub(super) fn nearest_face(
        &self,
        p: Vec3,
        limit: f64,
        nearer: impl Fn(usize, f64) -> Option<f64>,
    ) -> Option<(usize, f64)> {
        let point = Vector::from(p);
        let found = self.boxes.find_best(
            limit,
            |node, _| node.aabb().distance_to_local_point(point, true),
            |leaf, best| nearer(self.faces[leaf as usize] as usize, best),
        );
        found.map(|(leaf, distance)| (self.faces[leaf as usize] as usize, distance))
    }
}

#[cfg(test)]
mod tests {
    use super::super::distance::point_triangle;
    use super::super::surface::surface;
    use super::super::test_models::model_of;
    use super::*;

    /// Every query agrees to the bit with trying all faces, with and without a filter and a limit.
    #[test]
    fn agrees_with_brute_force() {
        // A reproducible scatter of small triangles and points.
        let mut seed = 12345u64;
        let mut random = move || {
            seed = seed
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (seed >> 33) as f64 / f64::from(1u32 << 31)
        };
        let mut point = move || Vec3::new(random(), random(), random()) * 10.0;
        let points: Vec<Vec3> = (0..300)
            .flat_map(|_| {
                let p = point();
                [p, p + point() / 10.0, p + point() / 10.0]
            })
            .collect();
        let faces: Vec<[u32; 3]> = (0..300).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let model = model_of(points, faces, vec![0; 300], vec![], vec![]);
        let s = surface(&model, &model.rest_mm);
        let t = tree((0..300).collect(), |f| s.corners(f));
        let mut hits = 0;
        for k in 0..200 {
            let (p, limit) = (point(), if k % 2 == 0 { 1.0 } else { f64::INFINITY });
            let accept = |f: usize| k % 3 != 0 || f & 1 == 0;
            let all = (0..300)
                .filter(|&f| accept(f))
                .map(|f| point_triangle(p, s.corners(f)));
            let brute = Some(all.fold(f64::INFINITY, f64::min)).filter(|&d| d < limit);
            let nearer = |f: usize, best: f64| {
                Some(point_triangle(p, s.corners(f))).filter(|&d| d < best && accept(f))
            };
            assert_eq!(t.nearest(p, limit, nearer), brute);
            hits += usize::from(brute.is_some());
        }
        assert!(hits > 100 && hits < 200, "both answers must occur: {hits}");
    }

    /// Leaflets of one face and of two, not the first ones, and faces that no plane parts in halves: all in one place,
    /// or each eight times as far out as the next, over all magnitudes that a number has.
    #[test]
    fn odd_leaflets() {
        let p = Vec3::z();
        for ratio in [1.0, 0.125] {
            let corners = |i: i32| {
                let far = 1e6 * f64::powi(ratio, i);
                [Vec3::zeros(), Vec3::x(), Vec3::y()].map(|corner| (corner + Vec3::repeat(1.0)) * far)
            };
            let points = (0..400).flat_map(corners).collect();
            let faces = (0..400).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            let model = model_of(points, faces, vec![0; 400], vec![], vec![]);
            let s = surface(&model, &model.rest_mm);
            let distance = |f: usize| point_triangle(p, s.corners(f));
            for faces in [7..8, 7..9, 0..400] {
                let t = tree(faces.clone().collect(), |f| s.corners(f));
                let found = t.nearest(p, f64::INFINITY, |f, best| {
                    Some(distance(f)).filter(|&d| d < best)
                });
                assert_eq!(found, faces.map(|f| distance(f as usize)).reduce(f64::min));
            }
        }
    }

    /// A tree of nothing finds nothing.
    #[test]
    fn empty() {
        let model = model_of(vec![], vec![], vec![], vec![], vec![]);
        let s = surface(&model, &[]);
        assert_eq!(
            tree(vec![], |f| s.corners(f)).nearest(Vec3::zeros(), 1.0, |_, _| Some(0.0)),
            None
        );
    }
}

//! The nearest triangle to a point: a tree of bounding boxes over the faces of one leaflet.

use super::surface::Surface;
use crate::Vec3;

/// A tree of boxes; children of inner nodes are adjacent.
pub(super) struct Tree {
    nodes: Vec<Node>,
    faces: Vec<u32>,
}

struct Node {
    low: Vec3,
    high: Vec3,
    /// A leaf's first place in `faces`, or an inner node's first child.
    first: u32,
    /// Faces in a leaf, zero for an inner node.
    count: u32,
}

/// Faces in a leaf: few enough to stop descending soon, enough to keep the tree small.
const LEAF: usize = 4;

/// Builds the tree over some faces in their measured position.
pub(super) fn tree(surface: &Surface, mut faces: Vec<u32>) -> Tree {
    let mut nodes = Vec::new();
    if !faces.is_empty() {
        nodes.push(Node {
            low: Vec3::zeros(),
            high: Vec3::zeros(),
            first: 0,
            count: 0,
        });
        let mut open = vec![(0, 0, faces.len())];
        while let Some((node, start, end)) = open.pop() {
            let (low, high) = bounds(surface, &faces[start..end]);
            let (mut first, mut count) = (start as u32, (end - start) as u32);
            if end - start > LEAF {
                let middle = start + (end - start) / 2;
                split(surface, &mut faces[start..end], (high - low).imax());
                (first, count) = (nodes.len() as u32, 0);
                for (child, range) in [(nodes.len(), (start, middle)), (nodes.len() + 1, (middle, end))] {
                    nodes.push(Node {
                        low,
                        high,
                        first: 0,
                        count: 0,
                    });
                    open.push((child, range.0, range.1));
                }
            }
            nodes[node] = Node {
                low,
                high,
                first,
                count,
            };
        }
    }
    Tree { nodes, faces }
}

fn bounds(surface: &Surface, faces: &[u32]) -> (Vec3, Vec3) {
    let (low, high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    faces
        .iter()
        .flat_map(|&f| surface.corners(f as usize))
        .fold((low, high), |(low, high), p| (low.inf(&p), high.sup(&p)))
}

/// Orders faces about their median along one axis.
fn split(surface: &Surface, faces: &mut [u32], axis: usize) {
    let centre = |f: u32| surface.corners(f as usize).iter().map(|p| p[axis]).sum::<f64>();
    let middle = faces.len() / 2;
    faces.select_nth_unstable_by(middle, |&a, &b| centre(a).total_cmp(&centre(b)).then(a.cmp(&b)));
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
        let (mut best, mut found) = (limit, false);
        let mut open = Vec::with_capacity(64);
        open.extend(self.nodes.first().map(|n| (n.distance(p), 0)));
        while let Some((distance, index)) = open.pop() {
            let node: &Node = &self.nodes[index];
            if distance >= best {
                continue;
            }
            let first = node.first as usize;
            for &f in &self.faces[first.min(self.faces.len())..][..node.count as usize] {
                if let Some(d) = nearer(f as usize, best) {
                    (best, found) = (d, true);
                }
            }
            if node.count == 0 {
                let (left, right) = (self.nodes[first].distance(p), self.nodes[first + 1].distance(p));
                // The nearer child goes last, so that it is opened first.
                let [near, far] = if left <= right {
                    [(left, first), (right, first + 1)]
                } else {
                    [(right, first + 1), (left, first)]
                };
                open.push(far);
                open.push(near);
            }
        }
        found.then_some(best)
    }
}

impl Node {
    /// Distance from a point to the box, zero inside.
    fn distance(&self, p: Vec3) -> f64 {
        (self.low - p).sup(&(p - self.high)).sup(&Vec3::zeros()).norm()
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
        let t = tree(&s, (0..300).collect());
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

    /// A tree of nothing finds nothing.
    #[test]
    fn empty() {
        let model = model_of(vec![], vec![], vec![], vec![], vec![]);
        let s = surface(&model, &[]);
        assert_eq!(
            tree(&s, vec![]).nearest(Vec3::zeros(), 1.0, |_, _| Some(0.0)),
            None
        );
    }
}

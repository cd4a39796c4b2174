//! Which pairs of parts may touch during a step.
//!
//! Parts are points and triangles, edges and edges. There are two lists, because what bounds the approach of parts that are
//! not listed differs. Parts whose faces share a vertex come nearer by no more than the ends of mesh edges move against
//! each other, which is little while the valve swings. For all others, found by sweep and prune, the bound is how far
//! vertices move at all; where that is much they are found for the step alone, each box grown by its own part's motion.

use super::broad::{Box3, SweepAndPrune, keep};
use super::listing::Listing;
use super::pairs::{Pair, PairKind, Place, approach_squared_mm2, are_beyond, nearest_at, pair_at_rest};
use crate::Vec3;

/// The pairs that may touch, kept from step to step.
#[derive(Clone, Debug, Default)]
pub struct PairList {
    /// Parts of faces that share a vertex.
    neighbours: Listing,
    /// All others.
    apart: Listing,
    search: Search,
}

/// Lists that outlast a step are made for this part of the thickness [1]. Larger, and they grow long; smaller, and they
/// are made too often.
const LASTING_BUDGET: f64 = 0.2;
/// The list of neighbours is made for so many steps like the present one [1].
const NEIGHBOUR_AHEAD: f64 = 2.0;
/// Edges between the vertices of two neighbouring parts, at most: to the vertex that their faces share, and on.
const NEIGHBOUR_EDGES: f64 = 2.0;

impl PairList {
    /// Gathers the pairs that may touch while the vertices go from `positions_mm` along their steps, all at the same
    /// rate. Lists that do not reach so far are made anew.
    pub fn gather(&mut self, place: &Place, step_mm: &[Vec3], found: &mut Vec<Pair>) {
        found.clear();
        self.gather_neighbours(place, step_mm, found);
        self.gather_apart(place, step_mm, found);
    }

    fn gather_neighbours(&mut self, place: &Place, step_mm: &[Vec3], found: &mut Vec<Pair>) {
        let listing = &mut self.neighbours;
        let stretch_mm = |motion_mm: &[Vec3]| stretch_mm(&place.surface.edges, motion_mm);
        let mut moved_mm = listing.follow(place, step_mm, stretch_mm);
        if moved_mm > listing.budget_mm {
            let budget_mm = (LASTING_BUDGET * place.thickness_mm).max(NEIGHBOUR_AHEAD * stretch_mm(step_mm));
            listing.begin(place.positions_mm, budget_mm);
            for &parts in &place.surface.neighbour_pairs {
                listing.list(place, parts, true, NEIGHBOUR_EDGES * budget_mm);
            }
            moved_mm = listing.follow(place, step_mm, stretch_mm);
        }
        listing.gather(place, step_mm, NEIGHBOUR_EDGES * moved_mm, found);
    }

    fn gather_apart(&mut self, place: &Place, step_mm: &[Vec3], found: &mut Vec<Pair>) {
        let budget_mm = LASTING_BUDGET * place.thickness_mm;
        let listing = &mut self.apart;
        let mut moved_mm = listing.follow(place, step_mm, longest_mm);
        if moved_mm > listing.budget_mm {
            if 2.0 * longest_mm(step_mm) > budget_mm {
                listing.end();
                self.search.during(place, step_mm, found);
                return;
            }
            listing.begin(place.positions_mm, budget_mm);
            let most_mm = 2.0 * budget_mm;
            self.search.within(
                place,
                |_| budget_mm,
                |_, _| most_mm,
                |parts, are_near_at_rest| listing.list(place, parts, are_near_at_rest, most_mm),
            );
            moved_mm = listing.follow(place, step_mm, longest_mm);
        }
        listing.gather(place, step_mm, 2.0 * moved_mm, found);
    }
}

/// Finds parts near each other; keeps its room from call to call.
#[derive(Clone, Debug, Default)]
struct Search {
    sweep: SweepAndPrune,
    edge_boxes: Vec<Box3>,
    point_boxes: Vec<Box3>,
    face_boxes: Vec<Box3>,
}

impl Search {
    /// Finds the pairs that may touch during a step.
    fn during(&mut self, place: &Place, step_mm: &[Vec3], found: &mut Vec<Pair>) {
        // What all vertices do together brings none nearer.
        let mean_mm = step_mm.iter().sum::<Vec3>() / step_mm.len().max(1) as f64;
        let motion_mm = |vertex: u32| (step_mm[vertex as usize] - mean_mm).norm();
        let approach_mm =
            |kind: PairKind, vertices: &[u32; 4]| approach_squared_mm2(kind, vertices, step_mm).sqrt();
        self.within(place, motion_mm, approach_mm, |parts, are_near_at_rest| {
            let (kind, vertices, area_mm2) = parts;
            if are_near_at_rest {
                let pair = pair_at_rest(place, kind, vertices, area_mm2);
                if may_touch(&pair, place.positions_mm, step_mm) {
                    found.push(pair);
                }
            } else {
                found.push(place.pair_of_strangers(kind, vertices, area_mm2));
            }
        });
    }

    /// Visits all pairs that may be within the thickness after each vertex has moved so far and the two parts have come
    /// nearer by so much [mm], those whose faces share a vertex left out: kind, vertices, area [mm²], and whether their
    /// faces are near at rest.
    fn within(
        &mut self,
        place: &Place,
        motion_mm: impl Fn(u32) -> f64,
        approach_mm: impl Fn(PairKind, &[u32; 4]) -> f64,
        mut visit: impl FnMut((PairKind, [u32; 4], f64), bool),
    ) {
        self.box_parts(place, motion_mm);
        let surface = place.surface;
        let is_in_reach = |kind: PairKind, vertices: &[u32; 4], faces: [u32; 2]| {
            let reach_mm = place.farthest_mm(faces) + approach_mm(kind, vertices);
            // Nineteen of twenty whose boxes overlap are not in reach, and most of them are told by less than closest points.
            !are_beyond(kind, vertices, place.positions_mm, reach_mm)
                && nearest_at(kind, vertices, place.positions_mm)
                    .separation_mm
                    .norm_squared()
                    <= reach_mm * reach_mm
        };
        let near = self.sweep.between(&self.point_boxes, &self.face_boxes);
        keep(near, |pair| surface.are_apart(surface.faces_of_point(pair)));
        keep(near, |pair| {
            let vertices = surface.point_and_face(pair);
            is_in_reach(PairKind::PointTriangle, &vertices, surface.faces_of_point(pair))
        });
        for &pair in &*near {
            let vertices = surface.point_and_face(pair);
            let parts = (
                PairKind::PointTriangle,
                vertices,
                surface.point_area_mm2(vertices[0]),
            );
            visit(parts, place.are_near_at_rest(surface.faces_of_point(pair)));
        }
        let near = self.sweep.among(&self.edge_boxes);
        keep(near, |pair| surface.are_apart(surface.faces_of_edges(pair)));
        keep(near, |pair| {
            let vertices = surface.ends(pair);
            is_in_reach(PairKind::EdgeEdge, &vertices, surface.faces_of_edges(pair))
        });
        for &pair in &*near {
            let parts = (
                PairKind::EdgeEdge,
                surface.ends(pair),
                surface.edge_pair_area_mm2(pair),
            );
            visit(parts, place.are_near_at_rest(surface.faces_of_edges(pair)));
        }
    }

    /// Puts each part in a box that holds all that it may touch half-way.
    fn box_parts(&mut self, place: &Place, motion_mm: impl Fn(u32) -> f64) {
        let at = |vertex: u32| place.positions_mm[vertex as usize];
        let half_mm = 0.5 * place.thickness_mm;
        let &Place { surface, .. } = place;
        let point_boxes = surface
            .points
            .iter()
            .map(|&vertex| Box3::around([at(vertex)], half_mm + motion_mm(vertex)));
        self.point_boxes.clear();
        self.point_boxes.extend(point_boxes);
        let edge_boxes = surface.edges.iter().map(|edge| {
            let [a, b] = edge.map(&motion_mm);
            Box3::around(edge.map(at), half_mm + a.max(b))
        });
        self.edge_boxes.clear();
        self.edge_boxes.extend(edge_boxes);
        let face_boxes = surface.faces.iter().map(|face| {
            let [a, b, c] = face.map(&motion_mm);
            Box3::around(face.map(at), half_mm + a.max(b).max(c))
        });
        self.face_boxes.clear();
        self.face_boxes.extend(face_boxes);
    }
}

/// Whether a pair may touch during a step of which all its vertices go the same part.
#[inline]
pub(super) fn may_touch(pair: &Pair, positions_mm: &[Vec3], step_mm: &[Vec3]) -> bool {
    let squared = pair.nearest(positions_mm).separation_mm.norm_squared();
    let approach_squared = approach_squared_mm2(pair.kind, &pair.vertices, step_mm);
    squared <= (pair.activation_mm + approach_squared.sqrt()).powi(2)
}

/// The longest of some motions [mm].
pub fn longest_mm(motion_mm: &[Vec3]) -> f64 {
    motion_mm
        .iter()
        .map(Vec3::norm_squared)
        .fold(0.0, f64::max)
        .sqrt()
}

/// The most that the ends of an edge move against each other [mm].
fn stretch_mm(edges: &[[u32; 2]], motion_mm: &[Vec3]) -> f64 {
    let against = |&[a, b]: &[u32; 2]| (motion_mm[a as usize] - motion_mm[b as usize]).norm_squared();
    edges.iter().map(against).fold(0.0, f64::max).sqrt()
}

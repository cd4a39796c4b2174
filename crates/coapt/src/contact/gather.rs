//! Which pairs of parts may touch during a step.
//!
//! Parts are points and triangles, edges and edges. There are two lists, because what bounds the approach of parts that are
//! not listed differs. Parts whose faces share a vertex come nearer by no more than corners of each face move against that
//! vertex, which is little while the valve swings. For all others, found by sweep and prune, the bound is how far
//! vertices move at all; where that is much they are found for the step alone, each box grown by its own part's motion.

use super::broad::{Box3, SweepAndPrune};
use super::listing::Listing;
use super::pairs::{Pair, PairKind, Parts, Place, approach_squared_mm2};
use super::reach::Batch;
use crate::Vec3;

/// The pairs that may touch, kept from step to step.
#[derive(Clone, Debug, Default)]
pub struct PairList {
    /// Parts of faces that share a vertex.
    neighbours: Listing,
    /// The most that corners of a face have moved against each other since those were listed [mm], shape `[face]`.
    stretch_mm: Vec<f64>,
    /// All others.
    apart: Listing,
    search: Search,
}

/// Lists that outlast a step are made for this part of the thickness [1]. Larger, and they grow long; smaller, and they
/// are made too often.
const LASTING_BUDGET: f64 = 0.2;
/// The list of neighbours is made for so many steps like the present one [1].
const NEIGHBOUR_AHEAD: f64 = 2.0;

impl PairList {
    /// Gathers the pairs that may touch while the vertices go from `positions_mm` along their steps, all at the same
    /// rate. Lists that do not reach so far are made anew.
    pub fn gather(&mut self, place: &Place, step_mm: &[Vec3], found: &mut Vec<Pair>) {
        found.clear();
        self.gather_neighbours(place, step_mm, found);
        self.gather_apart(place, step_mm, found);
    }

    fn gather_neighbours(&mut self, place: &Place, step_mm: &[Vec3], found: &mut Vec<Pair>) {
        let (listing, stretch_mm) = (&mut self.neighbours, &mut self.stretch_mm);
        let faces = &place.surface.faces;
        stretch_mm.clear();
        stretch_mm.resize(faces.len(), 0.0);
        let moved_mm = listing.follow(place, step_mm, |motion_mm| stretch(faces, motion_mm, stretch_mm));
        if moved_mm > listing.budget_mm {
            stretch_mm.fill(0.0);
            let ahead_mm = NEIGHBOUR_AHEAD * stretch(faces, step_mm, stretch_mm);
            let budget_mm = (LASTING_BUDGET * place.thickness_mm).max(ahead_mm);
            listing.begin(place.positions_mm, budget_mm);
            for parts in &place.surface.neighbour_pairs {
                listing.list(place, parts, 2.0 * budget_mm);
            }
            // From here on they have moved by the step alone.
            listing.follow(place, step_mm, |_| 0.0);
        }
        // To the vertex that their faces share, and on.
        let most_mm = |[one, other]: [u32; 2]| stretch_mm[one as usize] + stretch_mm[other as usize];
        listing.gather(place, step_mm, most_mm, found);
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
            let motion_mm = &mut self.search.motion_mm;
            motion_mm.clear();
            motion_mm.resize(place.positions_mm.len(), budget_mm);
            self.search.within(place, (most_mm, None), |parts| {
                listing.list(place, &parts, most_mm)
            });
            moved_mm = listing.follow(place, step_mm, longest_mm);
        }
        listing.gather(place, step_mm, |_| 2.0 * moved_mm, found);
    }
}

/// Finds parts near each other; keeps its room from call to call.
#[derive(Clone, Debug, Default)]
struct Search {
    /// How far each vertex may move [mm], shape `[vertex]`.
    motion_mm: Vec<f64>,
    sweep: SweepAndPrune,
    edge_boxes: Vec<Box3>,
    point_boxes: Vec<Box3>,
    face_boxes: Vec<Box3>,
    batch: Box<Batch>,
}

impl Search {
    /// Finds the pairs that may touch during a step.
    fn during(&mut self, place: &Place, step_mm: &[Vec3], found: &mut Vec<Pair>) {
        // What all vertices do together brings none nearer.
        let mean_mm = step_mm.iter().sum::<Vec3>() / step_mm.len().max(1) as f64;
        self.motion_mm.clear();
        self.motion_mm
            .extend(step_mm.iter().map(|step| (step - mean_mm).norm()));
        self.within(place, (0.0, Some(step_mm)), |parts| {
            if place.are_near_at_rest(parts.faces) {
                let pair = place.pair_at_rest(&parts);
                if may_touch(&pair, place.positions_mm, step_mm) {
                    found.push(pair);
                }
            } else {
                found.push(place.pair_of_strangers(&parts));
            }
        });
    }

    /// Visits pairs of parts, those whose faces share a vertex left out. All are
    /// among them that may be within the thickness after each vertex has moved by `self.motion_mm` and the two parts have come nearer
    /// by so much [mm] and by what a step brings; nine of ten others are not.
    fn within(
        &mut self,
        place: &Place,
        (nearer_mm, step_mm): (f64, Option<&[Vec3]>),
        mut visit: impl FnMut(Parts),
    ) {
        self.box_parts(place);
        let surface = place.surface;
        let reach = |vertices: [u32; 4], faces: [u32; 2]| {
            surface
                .are_apart(faces)
                .then(|| (vertices, place.farthest_mm(faces) + nearer_mm))
        };
        let near = self.sweep.between(
            [&self.point_boxes, &self.face_boxes],
            [&surface.point_patches, &surface.face_patches],
        );
        self.batch.thin_out(
            near,
            PairKind::PointTriangle,
            place.positions_mm,
            step_mm,
            |pair| reach(surface.point_and_face(pair), surface.faces_of_point(pair)),
        );
        for &pair in &*near {
            let vertices = surface.point_and_face(pair);
            visit(Parts {
                kind: PairKind::PointTriangle,
                vertices,
                area_mm2: surface.point_area_mm2(vertices[0]),
                faces: surface.faces_of_point(pair),
            });
        }
        let near = self.sweep.among(&self.edge_boxes, &surface.edge_patches);
        self.batch
            .thin_out(near, PairKind::EdgeEdge, place.positions_mm, step_mm, |pair| {
                reach(surface.ends(pair), surface.faces_of_edges(pair))
            });
        for &pair in &*near {
            visit(Parts {
                kind: PairKind::EdgeEdge,
                vertices: surface.ends(pair),
                area_mm2: surface.edge_pair_area_mm2(pair),
                faces: surface.faces_of_edges(pair),
            });
        }
    }

    /// Puts each part in a box that holds all that it may touch half-way.
    fn box_parts(&mut self, place: &Place) {
        let at = |vertex: u32| place.positions_mm[vertex as usize];
        let motions_mm = &self.motion_mm;
        let motion_mm = |vertex: u32| motions_mm[vertex as usize];
        let half_mm = 0.5 * place.thickness_mm;
        let &Place { surface, .. } = place;
        let point_boxes = surface
            .points
            .iter()
            .map(|&vertex| Box3::around([at(vertex)], half_mm + motion_mm(vertex)));
        self.point_boxes.clear();
        self.point_boxes.extend(point_boxes);
        let edge_boxes = surface.edges.iter().map(|edge| {
            let [a, b] = edge.map(motion_mm);
            Box3::around(edge.map(at), half_mm + a.max(b))
        });
        self.edge_boxes.clear();
        self.edge_boxes.extend(edge_boxes);
        let face_boxes = surface.faces.iter().map(|face| {
            let [a, b, c] = face.map(motion_mm);
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

/// Raises what of each face is the most that its corners move against each other [mm], shape `[face]`, and tells the largest for these
/// motions.
fn stretch(faces: &[[u32; 3]], motion_mm: &[Vec3], stretch_mm: &mut [f64]) -> f64 {
    let mut largest_squared = 0.0_f64;
    for (&face, stretch_mm) in faces.iter().zip(stretch_mm) {
        let [a, b, c] = face.map(|vertex| motion_mm[vertex as usize]);
        let squared = (a - b)
            .norm_squared()
            .max((b - c).norm_squared())
            .max((c - a).norm_squared());
        largest_squared = largest_squared.max(squared);
        *stretch_mm = stretch_mm.max(squared.sqrt());
    }
    largest_squared.sqrt()
}

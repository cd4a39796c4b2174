//! Which pairs of parts may touch during a step.
//!
//! Parts (points and triangles, edges and edges) are listed by the pairs of faces that they belong to, each such group
//! with its slack: how much nearer its faces may come before one of its pairs touches. While the faces have come nearer
//! by less than that, nobody looks at the pairs; so contact costs next to nothing while the parts are apart.
//!
//! There are two lists, because what bounds the approach of two faces that are not listed differs. Faces that share a
//! vertex come nearer by no more than the ends of mesh edges move against each other, which is little while the valve
//! swings. For all others, found by sweep and prune, the bound is how far vertices move at all.

use super::broad::SweepAndPrune;
use super::pairs::{Pair, PairKind, Place, corners, nearest_of, pair_at_rest, unseen};
use crate::Vec3;

/// The pairs that may touch, kept from step to step.
#[derive(Clone, Debug, Default)]
pub struct PairList {
    /// Parts of faces that share a vertex.
    neighbours: Listing,
    /// All others.
    apart: Listing,
    sweep: SweepAndPrune,
    edge_boxes: Vec<Box3>,
    face_boxes: Vec<Box3>,
    face_motions: Vec<FaceMotion>,
}

/// Groups of pairs, and how the faces have moved since they were listed.
#[derive(Clone, Debug, Default)]
struct Listing {
    groups: Vec<Group>,
    pairs: Vec<Pair>,
    listed_at_mm: Vec<Vec3>,
    /// How far vertices (ends of edges against each other) may move before the list must be made anew [mm].
    budget_mm: f64,
    /// Motion of the vertices since then, at the beginning and at the end of a step.
    start_mm: Vec<Vec3>,
    end_mm: Vec<Vec3>,
    faces_at_start: Vec<FaceMotion>,
    faces_at_end: Vec<FaceMotion>,
}

/// The pairs that two faces stand for.
#[derive(Clone, Copy, Debug)]
struct Group {
    faces: [u32; 2],
    /// Where its pairs begin and end.
    pairs: [u32; 2],
    /// The least distance less activation distance of its pairs when listed [mm].
    slack_mm: f64,
}

/// How a face has moved: the mean over its vertices, and how far one of them is off that.
#[derive(Clone, Copy, Debug)]
struct FaceMotion {
    mean_mm: Vec3,
    spread_mm: f64,
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
        let lasting_mm = LASTING_BUDGET * place.thickness_mm;
        if self.apart.follow(place, step_mm, longest_mm) > self.apart.budget_mm {
            let longest_mm = longest_mm(step_mm);
            if 2.0 * longest_mm <= lasting_mm {
                self.list_apart(place, None, lasting_mm);
            } else {
                self.list_apart(place, Some(step_mm), longest_mm);
            }
            self.apart.follow(place, step_mm, |_| 0.0);
        }
        let stretch_mm = |motion_mm: &[Vec3]| stretch_mm(&place.surface.edges, motion_mm);
        if self.neighbours.follow(place, step_mm, stretch_mm) > self.neighbours.budget_mm {
            self.list_neighbours(place, lasting_mm.max(NEIGHBOUR_AHEAD * stretch_mm(step_mm)));
            self.neighbours.follow(place, step_mm, stretch_mm);
        }
        found.clear();
        self.neighbours.gather(place, step_mm, found);
        self.apart.gather(place, step_mm, found);
    }

    /// Lists what may touch until the vertices have moved by `budget_mm`; or, given a step, during that step alone, for
    /// which fewer come in question since faces that go the same way do not come nearer.
    fn list_apart(&mut self, place: &Place, step_mm: Option<&[Vec3]>, budget_mm: f64) {
        let &Place {
            surface,
            positions_mm,
            ..
        } = place;
        let faces = &surface.faces;
        self.edge_boxes.clear();
        let ends = surface
            .edges
            .iter()
            .map(|edge| edge.map(|vertex| positions_mm[vertex as usize]));
        self.edge_boxes.extend(ends.map(|[a, b]| Box3 {
            low: a.inf(&b),
            high: a.sup(&b),
        }));
        self.face_boxes.clear();
        let corners = faces
            .iter()
            .map(|face| face.map(|vertex| positions_mm[vertex as usize]));
        self.face_boxes.extend(corners.map(Box3::around));
        self.face_motions.clear();
        if let Some(step_mm) = step_mm {
            face_motions(faces, step_mm, &mut self.face_motions);
            // What all faces do together brings none nearer.
            let mean_mm = self
                .face_motions
                .iter()
                .map(|motion| motion.mean_mm)
                .sum::<Vec3>()
                / faces.len().max(1) as f64;
            self.face_motions
                .iter_mut()
                .for_each(|motion| motion.mean_mm -= mean_mm);
        }
        let apart = &mut self.apart;
        apart.begin(positions_mm, if step_mm.is_some() { 0.0 } else { budget_mm });
        let margin_mm = |face: u32| {
            let motion = self.face_motions.get(face as usize);
            0.5 * place.thickness_mm + motion.map_or(budget_mm, FaceMotion::longest_mm)
        };
        self.sweep.grown_overlaps(faces, positions_mm, margin_mm, |f, g| {
            if share_vertex(&faces[f as usize], &faces[g as usize]) {
                return;
            }
            let approach_mm = match self.face_motions.as_slice() {
                [] => 2.0 * budget_mm,
                motions => motions[f as usize].approach_mm(&motions[g as usize]),
            };
            let boxes = [f, g].map(|face| &self.face_boxes[face as usize]);
            let are_neighbours = place.are_near_at_rest(f, g);
            let activation_mm = if are_neighbours {
                place.longest_of_neighbours_mm()
            } else {
                place.thickness_mm
            };
            if boxes[0].gap_mm(boxes[1]) <= activation_mm + approach_mm {
                let door = Door {
                    place,
                    face_boxes: &self.face_boxes,
                    edge_boxes: &self.edge_boxes,
                    are_neighbours,
                    activation_mm,
                    slack_mm: approach_mm,
                };
                door.list_faces(f, g, apart);
            }
        });
    }

    fn list_neighbours(&mut self, place: &Place, budget_mm: f64) {
        let listing = &mut self.neighbours;
        listing.begin(place.positions_mm, budget_mm);
        let most_mm = NEIGHBOUR_EDGES * budget_mm;
        for group in &place.surface.neighbours {
            let (start, mut slack_mm) = (listing.pairs.len(), f64::INFINITY);
            let [first, end] = group.pairs.map(|index| index as usize);
            for &parts in &place.surface.neighbour_pairs[first..end] {
                slack_mm = slack_mm.min(listing.list(place, parts, true, most_mm));
            }
            listing.close_group(group.faces, start, slack_mm);
        }
    }
}

impl Listing {
    fn begin(&mut self, positions_mm: &[Vec3], budget_mm: f64) {
        self.groups.clear();
        self.pairs.clear();
        self.budget_mm = budget_mm;
        self.listed_at_mm.clear();
        self.listed_at_mm.extend_from_slice(positions_mm);
    }

    /// Lists a pair if it has no more than some slack; returns its slack, or infinity. Where the pair begins to touch is
    /// found when it is first looked at; until then it counts as if it touched at the full thickness.
    #[inline]
    fn list(
        &mut self,
        place: &Place,
        (kind, vertices, area_mm2): (PairKind, [u32; 4], f64),
        are_neighbours: bool,
        most_mm: f64,
    ) -> f64 {
        let activation_mm = match are_neighbours {
            true => place.longest_of_neighbours_mm(),
            false => place.thickness_mm,
        };
        let limit_mm = activation_mm + most_mm;
        let nearest = nearest_of(kind, &corners(&vertices, place.positions_mm));
        let squared = nearest.separation_mm.norm_squared();
        if squared > limit_mm * limit_mm {
            return f64::INFINITY;
        }
        self.pairs.push(match are_neighbours {
            true => unseen(kind, vertices, area_mm2),
            false => place.pair_of_strangers(kind, vertices, area_mm2),
        });
        squared.sqrt() - activation_mm
    }

    /// Makes a group of the pairs listed since it began.
    fn close_group(&mut self, faces: [u32; 2], start: usize, slack_mm: f64) {
        if self.pairs.len() > start {
            self.groups.push(Group {
                faces,
                pairs: [start as u32, self.pairs.len() as u32],
                slack_mm,
            });
        }
    }

    /// Notes how the vertices have moved since the pairs were listed, at the beginning and at the end of a step;
    /// returns the larger of both by some measure [mm], infinite if there is no list yet.
    fn follow(&mut self, place: &Place, step_mm: &[Vec3], measure_mm: impl Fn(&[Vec3]) -> f64) -> f64 {
        if self.listed_at_mm.len() != place.positions_mm.len() {
            return f64::INFINITY;
        }
        let moved = place.positions_mm.iter().zip(&self.listed_at_mm);
        self.start_mm.clear();
        self.start_mm.extend(moved.map(|(here, then)| here - then));
        self.end_mm.clear();
        let ends = self.start_mm.iter().zip(step_mm);
        self.end_mm.extend(ends.map(|(start, step)| start + step));
        measure_mm(&self.start_mm).max(measure_mm(&self.end_mm))
    }

    fn gather(&mut self, place: &Place, step_mm: &[Vec3], found: &mut Vec<Pair>) {
        face_motions(&place.surface.faces, &self.start_mm, &mut self.faces_at_start);
        face_motions(&place.surface.faces, &self.end_mm, &mut self.faces_at_end);
        for &Group {
            faces,
            pairs,
            slack_mm,
        } in &self.groups
        {
            let [f, g] = faces.map(|face| face as usize);
            let comes_near = |motions: &[FaceMotion]| motions[f].is_bridged(&motions[g], slack_mm);
            if comes_near(&self.faces_at_end) || comes_near(&self.faces_at_start) {
                for pair in &mut self.pairs[pairs[0] as usize..pairs[1] as usize] {
                    if pair.activation_mm == 0.0 {
                        *pair = pair_at_rest(place, pair.kind, pair.vertices, pair.area_mm2);
                    }
                    if may_touch(pair, place.positions_mm, step_mm) {
                        found.push(*pair);
                    }
                }
            }
        }
    }
}

impl FaceMotion {
    /// How far its vertices move, at most [mm].
    #[inline]
    fn longest_mm(&self) -> f64 {
        self.mean_mm.norm() + self.spread_mm
    }

    /// How much nearer two faces with these motions come, at most [mm].
    #[inline]
    fn approach_mm(&self, other: &Self) -> f64 {
        (self.mean_mm - other.mean_mm).norm() + self.spread_mm + other.spread_mm
    }

    /// Whether two faces with these motions may have come so much nearer.
    #[inline]
    fn is_bridged(&self, other: &Self, slack_mm: f64) -> bool {
        let left = slack_mm - self.spread_mm - other.spread_mm;
        left <= 0.0 || (self.mean_mm - other.mean_mm).norm_squared() >= left * left
    }
}

fn face_motions(faces: &[[u32; 3]], motion_mm: &[Vec3], motions: &mut Vec<FaceMotion>) {
    motions.clear();
    motions.extend(faces.iter().map(|face| {
        let [a, b, c] = face.map(|vertex| motion_mm[vertex as usize]);
        let mean_mm = (a + b + c) / 3.0;
        let off = |motion: Vec3| (motion - mean_mm).norm_squared();
        FaceMotion {
            mean_mm,
            spread_mm: off(a).max(off(b)).max(off(c)).sqrt(),
        }
    }));
}

/// Whether a pair may touch during a step of which all its vertices go the same part.
#[inline]
fn may_touch(pair: &Pair, positions_mm: &[Vec3], step_mm: &[Vec3]) -> bool {
    let squared = pair.nearest(positions_mm).separation_mm.norm_squared();
    let limit_mm = pair.activation_mm + approach_squared(pair, step_mm).sqrt();
    squared <= limit_mm * limit_mm
}

/// What decides whether pairs are listed.
struct Door<'a> {
    place: &'a Place<'a>,
    face_boxes: &'a [Box3],
    edge_boxes: &'a [Box3],
    /// Whether the faces are near at rest.
    are_neighbours: bool,
    /// Contact begins at this distance, or at a smaller one [mm].
    activation_mm: f64,
    /// Pairs with more slack than this stay out [mm].
    slack_mm: f64,
}

impl Door<'_> {
    /// Lists the pairs of parts that two faces stand for.
    fn list_faces(&self, f: u32, g: u32, apart: &mut Listing) {
        let &Place {
            surface,
            positions_mm,
            ..
        } = self.place;
        let reach_mm = self.activation_mm + self.slack_mm;
        let start = apart.pairs.len();
        let mut slack_mm = f64::INFINITY;
        for (one, other) in [(f, g), (g, f)] {
            for &vertex in surface.owned_vertices(one) {
                let face = surface.faces[other as usize];
                let face_box = &self.face_boxes[other as usize];
                let point = positions_mm[vertex as usize];
                if face_box.gap_mm(&Box3 {
                    low: point,
                    high: point,
                }) <= reach_mm
                {
                    let vertices = [vertex, face[0], face[1], face[2]];
                    let area = surface.point_area_mm2(vertex);
                    slack_mm = slack_mm.min(self.list(PairKind::PointTriangle, vertices, area, apart));
                }
            }
        }
        for &first in surface.owned_edges(f) {
            let edge_box = &self.edge_boxes[first as usize];
            for &second in surface.owned_edges(g) {
                if edge_box.gap_mm(&self.edge_boxes[second as usize]) <= reach_mm {
                    let ([a, b], [c, d]) = (surface.edges[first as usize], surface.edges[second as usize]);
                    let area = surface.edge_pair_area_mm2(first, second);
                    slack_mm = slack_mm.min(self.list(PairKind::EdgeEdge, [a, b, c, d], area, apart));
                }
            }
        }
        apart.close_group([f, g], start, slack_mm);
    }

    #[inline]
    fn list(&self, kind: PairKind, vertices: [u32; 4], area_mm2: f64, apart: &mut Listing) -> f64 {
        apart.list(
            self.place,
            (kind, vertices, area_mm2),
            self.are_neighbours,
            self.slack_mm,
        )
    }
}

/// The square of how much nearer the parts of a pair come by these motions, at most [mm²].
///
/// Closest points are averages of their part's vertices: the largest difference between the motions of a vertex of one
/// part and one of the other.
fn approach_squared(pair: &Pair, motion_mm: &[Vec3]) -> f64 {
    let m = corners(&pair.vertices, motion_mm);
    let against = |i: usize, j: usize| (m[i] - m[j]).norm_squared();
    match pair.kind {
        PairKind::PointTriangle => against(0, 1).max(against(0, 2)).max(against(0, 3)),
        PairKind::EdgeEdge => against(0, 2)
            .max(against(0, 3))
            .max(against(1, 2).max(against(1, 3))),
    }
}

fn share_vertex(one: &[u32; 3], other: &[u32; 3]) -> bool {
    one.iter().any(|vertex| other.contains(vertex))
}

#[derive(Clone, Copy, Debug)]
struct Box3 {
    low: Vec3,
    high: Vec3,
}

impl Box3 {
    #[inline]
    fn around([a, b, c]: [Vec3; 3]) -> Self {
        Self {
            low: a.inf(&b).inf(&c),
            high: a.sup(&b).sup(&c),
        }
    }

    /// The gap to another box along the axis where it is widest; not positive where the boxes meet [mm].
    #[inline]
    fn gap_mm(&self, other: &Self) -> f64 {
        let gap = (self.low - other.high).sup(&(other.low - self.high));
        gap.x.max(gap.y).max(gap.z)
    }
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

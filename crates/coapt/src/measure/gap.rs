//! How far each leaflet vertex is from the surface that it could seal against.

use super::distance::{point_box, point_segment, point_triangle};
use super::surface::{Surface, leaflet_bit, surface};
use super::tree::{Tree, tree};
use super::ways::ways_from_annulus;
use crate::Vec3;
use crate::model::Model;

/// Gaps are not followed beyond this distance [mm], and read as this where there is nothing nearer. Our choice: no
/// measure looks beyond a few millimetres.
pub const GAP_CAP_MM: f64 = 10.0;

/// What counts as touching beyond the contact thickness [mm]: leaflets are read as sealed at 0.1 mm more (our
/// choice, a tenth of the default thickness and below any imaging resolution)...
const TOLERANCE_MM: f64 = 0.1;

/// ...and at 2 % of the local edge length more (our choice): chords of curved sheets of radius `r` that touch stand
/// apart by their sagitta, `h²/8r`, which is `0.02 h` at `r = 6 h`.
const TOLERANCE_EDGES: f64 = 0.02;

/// Points of two leaflets that were connected over less than this many contact thresholds of tissue, about where the
/// leaflets join, say nothing of touching: there a sheet lying open is as near to itself.
const JOIN_THRESHOLDS: f64 = 2.0;

/// The same for points of one leaflet: it touches itself when points at least this many thresholds apart in the open
/// valve have come within one, which takes a fold and not only a bend.
const FOLD_THRESHOLDS: f64 = 4.0;

/// And they must have come at least this many times nearer than they were, so that flat tissue has no gap to itself.
const FOLD_RATIO: f64 = 2.0;

/// Gaps per vertex; of leaflet vertices only the entries mean something, all others are [`GAP_CAP_MM`].
pub(super) struct Gaps {
    /// Distance to the nearest face of another leaflet, or, in a valve given as one leaflet, of a distant part of
    /// itself [mm].
    pub(super) facing_mm: Vec<f64>,
    /// Distance to the nearest face of a distant part of the same leaflet [mm].
    pub(super) own_mm: Vec<f64>,
    /// The same, to parts that lie beside it along the annulus rather than above or below it [mm].
    pub(super) beside_mm: Vec<f64>,
    /// Gap below which a vertex is in contact [mm].
    pub(super) threshold_mm: Vec<f64>,
}

/// Distance of each leaflet vertex to the nearest leaflet face that is not its own neighbourhood [mm], shape
/// `[vertex]`; at most [`GAP_CAP_MM`], which is also the value of vertices that belong to no leaflet.
///
/// Faces of another leaflet count always. Faces of the same leaflet count when they were more than four contact
/// thresholds away in the open valve and have come at least twice as near, so that flat or bent tissue is never near
/// itself; they are followed only to two edge lengths. Near the seam where two leaflets join (within two thresholds of it in the open valve) a vertex
/// is as near to the other leaflet as it always was; it gets the mean gap of its neighbours farther along, so that
/// leaflets that meet right up to a commissure seal there too.
pub fn gap_mm(model: &Model, positions_mm: &[Vec3]) -> Vec<f64> {
    let positions_mm = super::usable_positions(model, positions_mm);
    let g = gaps(model, &surface(model, positions_mm));
    g.facing_mm
        .iter()
        .zip(&g.own_mm)
        .map(|(a, b)| a.min(*b))
        .collect()
}

/// Whether each leaflet vertex is in contact with a surface that it could seal against, shape `[vertex]`: the points
/// that the coaptation area is made of.
pub fn in_contact(model: &Model, positions_mm: &[Vec3]) -> Vec<bool> {
    let positions_mm = super::usable_positions(model, positions_mm);
    let g = gaps(model, &surface(model, positions_mm));
    g.facing_mm
        .iter()
        .zip(&g.threshold_mm)
        .map(|(gap, threshold)| gap <= threshold)
        .collect()
}

/// Gap below which tissue with edges of this length is in contact [mm].
pub(super) fn threshold_mm(model: &Model, edge_mm: f64) -> f64 {
    model.contact.thickness_mm + TOLERANCE_MM + TOLERANCE_EDGES * edge_mm
}

/// The gaps of all vertices.
pub(super) fn gaps(model: &Model, s: &Surface) -> Gaps {
    let count = s.vertex_leaflets.len();
    let threshold: Vec<f64> = s
        .vertex_edge_mm
        .iter()
        .map(|&edge| threshold_mm(model, edge))
        .collect();
    let trees = leaflet_trees(s);
    let ways = ways_from_annulus(model, s);
    let mut own_mm = vec![GAP_CAP_MM; count];
    let mut beside_mm = own_mm.clone();
    let mut facing_mm = own_mm.clone();
    for v in (0..count).filter(|&v| s.vertex_leaflets[v] != 0) {
        for (leaflet, tree) in trees.iter().enumerate() {
            if s.vertex_leaflets[v] & leaflet_bit(leaflet as u32) == 0 {
                facing_mm[v] = facing_mm[v].min(facing_gap(s, tree, v, facing_mm[v]));
                continue;
            }
            own_mm[v] = own_mm[v].min(own_gap(s, tree, v, threshold[v], |_| true));
            if own_mm[v] < GAP_CAP_MM {
                let beside = own_gap(s, tree, v, threshold[v], |f| {
                    ways.beside(v, s.faces[f][0] as usize)
                });
                beside_mm[v] = beside_mm[v].min(beside);
            }
        }
    }
    if s.face_leaflet.iter().all(|leaflet| leaflet == &s.face_leaflet[0]) {
        facing_mm.clone_from(&own_mm);
        beside_mm.clone_from(&own_mm);
    } else {
        bridge_seams(s, &mut facing_mm, &threshold);
    }
    Gaps {
        facing_mm,
        own_mm,
        beside_mm,
        threshold_mm: threshold,
    }
}

fn leaflet_trees(s: &Surface) -> Vec<Tree> {
    let count = s.face_leaflet.iter().max().map_or(0, |&last| last as usize + 1);
    let mut faces = vec![Vec::new(); count];
    for (f, &leaflet) in s.face_leaflet.iter().enumerate() {
        faces[leaflet as usize].push(f as u32);
    }
    faces
        .into_iter()
        .map(|f| tree(f, |face| s.corners(face)))
        .collect()
}

fn facing_gap(s: &Surface, tree: &Tree, v: usize, limit: f64) -> f64 {
    let p = s.positions_mm[v];
    let nearer = |f: usize, best: f64| Some(point_triangle(p, s.corners(f))).filter(|&d| d < best);
    tree.nearest(p, limit, nearer).unwrap_or(GAP_CAP_MM)
}

/// Followed to two mean edges beyond the threshold: what is next to tissue in contact is hardly farther.
fn own_gap(s: &Surface, tree: &Tree, v: usize, threshold: f64, counts: impl Fn(usize) -> bool) -> f64 {
    let (p, rest, near) = (s.positions_mm[v], s.rest_mm[v], FOLD_THRESHOLDS * threshold);
    let limit = (threshold + 2.0 * s.mean_edge_mm).min(GAP_CAP_MM);
    let nearer = |f: usize, best: f64| {
        // Bounds dismiss most faces: of the distance they had, a corner's; of the one they have, that to their box.
        let had = (s.rest_mm[s.faces[f][0] as usize] - rest).norm_squared();
        if had <= near * near || !counts(f) {
            return None;
        }
        let (corners, best) = (s.corners(f), best.min(had.sqrt() / FOLD_RATIO));
        if point_box(p, corners) >= best {
            return None;
        }
        let d = point_triangle(p, corners);
        let folded = d < best && point_triangle(rest, s.rest_corners(f)) > near.max(FOLD_RATIO * d);
        folded.then_some(d)
    };
    tree.nearest(p, limit, nearer).unwrap_or(GAP_CAP_MM)
}

/// Replaces the gaps of vertices at seams by the mean of their neighbours', from the outside in.
fn bridge_seams(s: &Surface, gap: &mut [f64], threshold: &[f64]) {
    let mut known = near_seams(s, threshold);
    known.iter_mut().for_each(|near| *near = !*near);
    loop {
        let layer: Vec<(usize, f64)> = (0..gap.len())
            .filter(|&v| !known[v])
            .filter_map(|v| {
                let values = s
                    .neighbours(v)
                    .iter()
                    .filter(|&&n| known[n as usize])
                    .map(|&n| gap[n as usize]);
                let (sum, count) = values.fold((0.0, 0), |(sum, count), g| (sum + g, count + 1));
                (count > 0).then(|| (v, sum / f64::from(count)))
            })
            .collect();
        if layer.is_empty() {
            break;
        }
        for (v, mean) in layer {
            gap[v] = mean;
            known[v] = true;
        }
    }
    for (g, _) in gap.iter_mut().zip(&known).filter(|(_, known)| !**known) {
        *g = GAP_CAP_MM;
    }
}

/// Which vertices lie on a seam or, in the open valve, too near to one to tell touching from joining.
fn near_seams(s: &Surface, threshold: &[f64]) -> Vec<bool> {
    let rest = |v: u32| s.rest_mm[v as usize];
    let mut near: Vec<bool> = s.vertex_leaflets.iter().map(|set| set.count_ones() > 1).collect();
    // Leaflets may join in a point without a common edge: then the point is its own seam.
    let points = (0..near.len() as u32)
        .filter(|&v| near[v as usize])
        .map(|v| [rest(v); 2]);
    let edges = s
        .edges
        .iter()
        .zip(&s.edge_leaflets)
        .filter(|(_, set)| set.count_ones() > 1);
    let seams: Vec<[Vec3; 2]> = points.chain(edges.map(|(ends, _)| ends.map(rest))).collect();
    for v in (0..near.len()).filter(|&v| s.vertex_leaflets[v].count_ones() == 1) {
        let (p, radius) = (s.rest_mm[v], JOIN_THRESHOLDS * threshold[v]);
        near[v] = seams.iter().any(|&seam| {
            let [a, b] = seam;
            a.x.min(b.x) - radius < p.x && p.x < a.x.max(b.x) + radius && point_segment(p, seam) < radius
        });
    }
    near
}

#[cfg(test)]
mod tests {
    use super::super::test_models::{commissure_valve, fold_state, sheet, two_strips};
    use super::*;

    /// Two parallel strips: the gap is their distance, exactly.
    #[test]
    fn parallel_strips() {
        let model = two_strips(10, 5, 0.4);
        assert!(
            gap_mm(&model, &model.rest_mm)
                .iter()
                .all(|g| (g - 0.4).abs() < 1e-12)
        );
    }

    /// An open flat sheet, coarse or much finer than the contact thickness, of one leaflet or of two joined by a
    /// seam, never touches itself; nor does it when bent to a half cylinder of 3 mm radius.
    #[test]
    fn open_tissue_does_not_touch_itself() {
        for n in [6, 80] {
            for leaflets in [1, 2] {
                let model = sheet(n, 8.0, leaflets);
                let threshold = threshold_mm(&model, 8.0 * 2f64.sqrt() / n as f64);
                assert!(
                    gap_mm(&model, &model.rest_mm)
                        .iter()
                        .all(|&g| g > 1.5 * threshold),
                    "{n} {leaflets}"
                );
                let bend = |p: &Vec3| Vec3::new(3.0 * (p.x / 3.0).sin(), p.y, 3.0 * (p.x / 3.0).cos());
                let bent: Vec<Vec3> = model.rest_mm.iter().map(bend).collect();
                assert!(
                    gap_mm(&model, &bent).iter().all(|&g| g > 1.2 * threshold),
                    "{n} {leaflets}"
                );
            }
        }
    }

    /// A sheet folded flat onto itself touches, whether the fold is within one leaflet or along a seam of two.
    /// Only within one leaflet a strip about the fold stays out: two thresholds of about 0.7 mm each way.
    #[test]
    fn folded_tissue_touches() {
        for leaflets in [1, 2] {
            let model = sheet(40, 16.0, leaflets);
            let fold = |p: &Vec3| Vec3::new((p.x - 8.0).abs(), p.y, if p.x < 8.0 { 0.0 } else { 0.4 });
            let folded: Vec<Vec3> = model.rest_mm.iter().map(fold).collect();
            let gaps = gap_mm(&model, &folded);
            for (p, g) in model
                .rest_mm
                .iter()
                .zip(&gaps)
                .filter(|(p, _)| leaflets == 2 || (p.x - 8.0).abs() > 1.6)
            {
                assert!((g - 0.4).abs() < 0.01, "{leaflets} {p} {g}");
            }
        }
    }

    /// Where two leaflets meet up to their commissure, vertices of the commissure are sealed as well; in the open
    /// valve they are not.
    #[test]
    fn commissures_seal_when_the_leaflets_do() {
        for n in [8, 32] {
            let model = commissure_valve(n, n / 2);
            let closed = gap_mm(&model, &fold_state(&model, 0.4));
            let open = gap_mm(&model, &model.rest_mm);
            let lowest = model.rest_mm.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
            for v in (0..closed.len()).filter(|&v| model.rest_mm[v].z < lowest + 1e-9) {
                assert!(closed[v] < 0.6, "{n} {v} {}", closed[v]);
            }
            let widest = open.iter().copied().fold(0.0, f64::max);
            let narrowest = open.iter().copied().fold(f64::INFINITY, f64::min);
            assert!(widest > 5.0 && narrowest > 0.7, "{n} {narrowest} {widest}");
        }
    }
}

//! A gap in a leaflet sewn up: facing places of its two edges, from its bottom to the margin.

use std::collections::BTreeMap;

use super::sutures::{Stitch, held_gap_mm};
use crate::Vec3;
use crate::energy::chord::WeightedVertices;
use crate::mesh::polyline;
use crate::model::Model;
use crate::scene::Fault;

/// Distance between stitches along the edges, at most [mm]. A running suture's are 2 mm apart, and between them edges of usual meshes
/// bulge apart by more than contact; so close that they do not is our choice.
const SPACING_MM: f64 = 1.0;

/// Stitches over a gap whose edges run through these vertices of the margin, with whether each is a corner. The bottom is the
/// only corner, or else the middle. Places that are no farther apart than they would be drawn get no stitch.
///
/// # Errors
/// The vertices are no single stretch of a margin.
pub(super) fn seam(model: &Model, edge: &[(u32, bool)]) -> Result<Vec<Stitch>, Fault> {
    let corner_of: BTreeMap<u32, bool> = edge.iter().copied().collect();
    let run = run(model, &corner_of).ok_or_else(|| {
        let message = "leaves edges that are no single stretch of the margin; expected a piece that lies at the margin, away from \
                       earlier cuts";
        Fault::of_shape("resect", message)
    })?;
    let points: Vec<Vec3> = run.iter().map(|&v| model.rest_mm[v as usize]).collect();
    let arcs = polyline::arc_lengths(&points, false);
    let length_mm = arcs[arcs.len() - 1];
    let corners: Vec<usize> = (0..run.len()).filter(|&i| corner_of[&run[i]]).collect();
    let bottom_mm = match corners[..] {
        [only] => arcs[only],
        _ => 0.5 * length_mm,
    };
    let sides_mm = [bottom_mm, length_mm - bottom_mm];
    let steps = (sides_mm[0].max(sides_mm[1]) / SPACING_MM).ceil().max(1.0);
    let gap_mm = held_gap_mm(model);
    let mut stitches = Vec::new();
    for step in 1..=steps as u32 {
        let part = f64::from(step) / steps;
        let ends_mm = [bottom_mm - part * sides_mm[0], bottom_mm + part * sides_mm[1]];
        let [a, b] = ends_mm.map(|arc| polyline::point_at_arc(&points, false, &arcs, arc));
        if (b - a).norm() > gap_mm {
            stitches.push(Stitch {
                ends: ends_mm.map(|arc| place(&run, &arcs, arc)),
                length_mm: gap_mm,
            });
        }
    }
    Ok(stitches)
}

/// The vertices in the order of the margin on which they lie side by side.
fn run(model: &Model, edge: &BTreeMap<u32, bool>) -> Option<Vec<u32>> {
    let is_edge = |v: &u32| edge.contains_key(v);
    let margin = model
        .margins
        .iter()
        .find(|margin| margin.vertices.iter().any(is_edge))?;
    let count = margin.vertices.len();
    let at = |i: usize| margin.vertices[i % count];
    let before =
        (0..count).find(|&i| !is_edge(&at(i)) && is_edge(&at(i + 1)) && (margin.closed || i + 1 < count))?;
    let run: Vec<u32> = (before + 1..before + count).map(at).take_while(is_edge).collect();
    (run.len() == edge.len() && run.len() > 2).then_some(run)
}

/// A place of a polyline of vertices.
fn place(vertices: &[u32], arcs: &[f64], arc_mm: f64) -> WeightedVertices {
    let after = arcs.partition_point(|&arc| arc < arc_mm).clamp(1, arcs.len() - 1);
    let share = ((arc_mm - arcs[after - 1]) / (arcs[after] - arcs[after - 1])).clamp(0.0, 1.0);
    let shares = [(vertices[after - 1], 1.0 - share), (vertices[after], share)];
    // A rounding's worth of a vertex is none.
    shares.into_iter().filter(|(_, share)| *share > 1e-9).collect()
}

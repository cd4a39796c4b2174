//! Border points that lie next to each other without being one: the seams of a surface that was not welded.

use super::surface::Surface;
use crate::mesh::point_grid::PointGrid;
use crate::mesh::topology::Edges;

/// Points nearer than this part of the mean edge may be meant to be one (our choice): a tenth is no length at which anybody
/// draws a gap.
const NEAR: f64 = 0.1;

/// What to do about points of the border that nearly meet, in words that go on after a fault; nothing if there are none.
pub(super) fn advice(surface: &Surface, edges: &Edges) -> String {
    let length = |&[a, b]: &[u32; 2]| (surface.points[a as usize] - surface.points[b as usize]).norm();
    let mean = edges.ends.iter().map(length).sum::<f64>() / edges.len().max(1) as f64;
    let mut border: Vec<u32> = (0..edges.len())
        .filter(|&edge| edges.faces_of(edge).len() == 1)
        .flat_map(|edge| edges.ends[edge])
        .collect();
    border.sort_unstable();
    border.dedup();
    let mut grid = PointGrid::new(NEAR * mean);
    let (mut count, mut farthest) = (0, 0.0_f64);
    for vertex in border {
        let at = surface.points[vertex as usize];
        let is_joined = |other: u32| {
            edges
                .ends
                .binary_search(&[other.min(vertex), other.max(vertex)])
                .is_ok()
        };
        let near = grid.within(at).into_iter().find(|&(other, _)| !is_joined(other));
        if let Some((_, distance)) = near {
            count += 1;
            farthest = farthest.max(distance);
        }
        grid.insert(vertex, at);
    }
    if count == 0 {
        return String::new();
    }
    format!(
        "; {count} points of the border lie within {farthest:.3} mm of another: if they are one, set \
         `weld.tolerance_mm` above that"
    )
}

//! Which vertices may go, and whereto: not at all, along a line, or anywhere.

use crate::Vec3;
use crate::mesh::topology::Edges;
use crate::model::Model;

/// Where a vertex lies on the leaflets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Place {
    /// Within a leaflet.
    Inner,
    /// On the annulus, a free margin or the border of two leaflets, between these two vertices of the same line.
    Line([u32; 2]),
    /// Where lines meet, end or turn sharply, or prescribed elsewhere than on the annulus: stays.
    Corner,
}

/// A line that turns by more than this keeps the vertex [cosine of 60 degrees]. Our choice: a patch keeps its
/// right angles, while an annulus is still thinned to a dozen vertices, which turn by 30 degrees each.
const SHARP_TURN_COSINE: f64 = 0.5;

/// What kind of line an edge belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Annulus,
    Margin,
    LeafletBorder,
}

/// The place of each leaflet vertex.
pub(super) fn places(model: &Model, edges: &Edges) -> Vec<Place> {
    let count = model.leaflet_vertex_count;
    let mut held = vec![false; model.rest_mm.len()];
    model
        .prescribed
        .iter()
        .for_each(|p| held[p.vertex as usize] = true);
    let mut lines: Vec<Lines> = vec![Lines::default(); count];
    for edge in 0..edges.len() {
        let [a, b] = edges.ends[edge];
        let kind = match *edges.faces_of(edge) {
            [f, g] if model.face_leaflet[f as usize] == model.face_leaflet[g as usize] => continue,
            [_] if held[a as usize] && held[b as usize] => Kind::Annulus,
            [_] => Kind::Margin,
            _ => Kind::LeafletBorder,
        };
        lines[a as usize].push(b, kind);
        lines[b as usize].push(a, kind);
    }
    let place = |vertex: usize| lines[vertex].place(vertex, held[vertex], &model.rest_mm);
    (0..count).map(place).collect()
}

/// The line edges at a vertex.
#[derive(Clone, Copy, Debug, Default)]
struct Lines {
    count: u32,
    first: Option<(u32, Kind)>,
    last: Option<(u32, Kind)>,
}

impl Lines {
    fn push(&mut self, neighbour: u32, kind: Kind) {
        self.count += 1;
        self.first = self.first.or(Some((neighbour, kind)));
        self.last = Some((neighbour, kind));
    }

    fn place(&self, vertex: usize, held: bool, points: &[Vec3]) -> Place {
        match (self.count, self.first, self.last) {
            (0, ..) if !held => Place::Inner,
            (2, Some((a, kind)), Some((b, other))) if kind == other && held == (kind == Kind::Annulus) => {
                let before = points[vertex] - points[a as usize];
                let after = points[b as usize] - points[vertex];
                if before.dot(&after) < SHARP_TURN_COSINE * before.norm() * after.norm() {
                    return Place::Corner;
                }
                Place::Line([a, b])
            }
            _ => Place::Corner,
        }
    }
}

//! A coarser model of the same valve, for solvers that go from coarse to fine.
//!
//! ```text
//! Model --places, thin--> fewer faces --elasticity--> springs, membranes, hinges --> Model
//!                                    \--locate--> Prolongation --/ (chords follow their insertions)
//! ```
//!
//! Works on any leaflets that `Model::build` accepts, and again on its own result.

mod assemble;
mod place;
mod prolongation;
mod sheet;
#[cfg(test)]
mod tests;
mod thin;

pub use prolongation::Prolongation;

use self::thin::{NONE, Thinning};
use crate::energy::chord::WeightedVertices;
use crate::mesh::topology::{self, Edges};
use crate::model::Model;
use crate::model::elasticity::{Sheet, elasticity};

/// A coarser model and the way back.
#[derive(Clone, Debug)]
pub struct Coarse {
    /// The coarser model. All that the equilibrium depends on is there; annulus, margins, papillary tips and
    /// landmarks name valid vertices, landmarks those nearest along the annulus.
    pub model: Model,
    /// From its positions to those of the finer model.
    pub prolongation: Prolongation,
}

/// Insertions of chords count as this much less crowded than other vertices [1]. With 1 and with 16 the closed
/// valves of the five presets at 650 faces, coarsened once, lie 13 and 44 % farther from the fine ones than
/// with 3: moved chords pull elsewhere, and a mesh that keeps them all is uneven. From 2 to 4 there is no
/// difference to speak of.
const INSERTION_RELUCTANCE: f32 = 3.0;
/// Nothing coarser than this part of the vertices is worth a level of its own [1].
const WORTHWHILE: f64 = 0.7;

/// Makes a model with about `vertex_target` leaflet vertices; a quarter of the present number makes edges twice
/// as long.
///
/// Leaflet vertices of the coarse model are some of the fine one's, in the same order; then come all chord
/// nodes and tips. Annulus, margins and borders of leaflets are thinned along themselves. Prescribed vertices
/// keep their targets. Where a chord's insertion is gone, the chord goes to the nearest vertex left, its rest
/// length changed as its open length. Springs, membranes and hinges are those that `Model::build` would give.
///
/// Nothing where too few vertices can go to be worth it, or where springs, membranes and hinges are not those of the
/// leaflets' tissues: whoever made others knows what a coarse mesh of them is.
pub fn coarsen(model: &Model, vertex_target: usize) -> Option<Coarse> {
    let count = model.leaflet_vertex_count;
    let edges = topology::edges(&model.faces);
    if vertex_target as f64 > WORTHWHILE * count as f64 || !is_of_its_tissues(model, &edges) {
        return None;
    }
    let reluctance = reluctance(model);
    let places = place::places(model, &edges);
    let mut thinning = Thinning::new(&model.rest_mm, &model.faces, places, &reluctance);
    if thinning.run(vertex_target) as f64 > WORTHWHILE * count as f64 {
        return None;
    }
    let numbers = numbers(model, &thinning.pulled_into);
    let prolongation = prolongation(model, &thinning, &numbers);
    Some(Coarse {
        model: assemble::assemble(model, &thinning, &numbers, &prolongation),
        prolongation,
    })
}

fn is_of_its_tissues(model: &Model, edges: &Edges) -> bool {
    let made = elasticity(&Sheet::of(model), edges);
    let (springs, membranes, hinges) = (&model.springs, &model.membranes, &model.hinges);
    made.springs.ends == springs.ends
        && are_close(&made.springs.rest_length_mm, &springs.rest_length_mm)
        && are_close(&made.springs.transition_length_mm, &springs.transition_length_mm)
        && are_close(&made.springs.soft_n_per_mm, &springs.soft_n_per_mm)
        && are_close(&made.springs.stiff_n_per_mm, &springs.stiff_n_per_mm)
        && are_close(&made.springs.compression_n_per_mm, &springs.compression_n_per_mm)
        && (&made.membranes.corners, &made.membranes.tissue) == (&membranes.corners, &membranes.tissue)
        && made.membranes.tissues == membranes.tissues
        && are_close(&made.membranes.volume_mm3, &membranes.volume_mm3)
        && made.hinges.vertices == hinges.vertices
        && are_close(&made.hinges.stiffness_n_per_mm, &hinges.stiffness_n_per_mm)
}

/// Equal but for rounding: a valve that was turned has other last digits than one built where it stands.
fn are_close(made: &[f64], found: &[f64]) -> bool {
    let close = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-6 * b.abs();
    made.len() == found.len() && made.iter().zip(found).all(close)
}

fn reluctance(model: &Model) -> Vec<f32> {
    let mut reluctance = vec![1.0; model.leaflet_vertex_count];
    let heaviest = |point: &WeightedVertices| point.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1));
    for (vertex, _) in model.chords.points.iter().filter_map(heaviest) {
        if let Some(slot) = reluctance.get_mut(vertex as usize) {
            *slot = INSERTION_RELUCTANCE;
        }
    }
    reluctance
}

/// The coarse number of each fine vertex that is kept, else [`NONE`].
fn numbers(model: &Model, pulled_into: &[u32]) -> Vec<u32> {
    let mut count = 0;
    let is_kept = |vertex: usize| {
        pulled_into
            .get(vertex)
            .is_none_or(|&into| into as usize == vertex)
    };
    let mut number = |vertex: usize| {
        if is_kept(vertex) {
            count += 1;
            count - 1
        } else {
            NONE
        }
    };
    (0..model.rest_mm.len()).map(&mut number).collect()
}

fn prolongation(model: &Model, thinning: &Thinning, numbers: &[u32]) -> Prolongation {
    let left = thinning.faces.iter().filter(|face| face[0] != NONE);
    let faces: Vec<[u32; 3]> = left.map(|face| face.map(|v| numbers[v as usize])).collect();
    let all = model.rest_mm.iter().zip(numbers);
    let points: Vec<_> = all.filter(|(_, n)| **n != NONE).map(|(p, _)| *p).collect();
    let sheet = sheet::Sheet::new(&faces, &points);
    let place = |vertex: usize| {
        if numbers[vertex] != NONE {
            return ([numbers[vertex]; 3], [1.0, 0.0, 0.0]);
        }
        let mut last = vertex;
        while numbers[last] == NONE {
            last = thinning.pulled_into[last] as usize;
        }
        sheet.locate(model.rest_mm[vertex], numbers[last])
    };
    let (corners, weights) = (0..numbers.len()).map(place).unzip();
    Prolongation {
        corners,
        weights,
        faces,
    }
}

//! How far a result can be trusted.

use super::Status;
use crate::Vec3;
use crate::contact::crossing::{Crossing, crossings};
use crate::contact::pairs::Pair;
use crate::contact::surface::Surface;
use crate::mesh::topology;
use crate::model::Model;

/// The facts that decide whether a closed shape may be believed.
#[derive(Clone, Debug, PartialEq)]
pub struct Certificate {
    /// Largest force left on a free vertex over the reference force, `load::reference_force_n` [1].
    pub residual: f64,
    /// Whether a small push is answered by a return: the symmetric part of the tangent is positive definite, or,
    /// failing that, no eigenvalue of the whole tangent has a negative real part, but for rounding of the zeros that slack
    /// chordae have; see [`super::stability`].
    pub stable: bool,
    /// Edges that pass through faces, by exact arithmetic. Must be empty.
    pub crossings: Vec<Crossing>,
    /// How far the mid-surfaces of two parts in contact are nearer than their contact distance, at most [mm].
    pub max_penetration_mm: f64,
    /// Where that is [mm]; absent without contact.
    pub max_penetration_at_mm: Option<Vec3>,
    /// How far the visible surface lies from that of an infinitely fine mesh, root mean square, by a bound that held for
    /// nine of ten closures [mm].
    pub discretisation_mm: f64,
}

impl Certificate {
    /// Whether the result may be used: converged, stable, nothing crosses.
    pub fn is_certified(&self, status: Status) -> bool {
        status == Status::Converged && self.stable && self.crossings.is_empty()
    }
}

/// Gathers the facts about a state.
pub fn certify(
    model: &Model,
    surface: &Surface,
    pairs: &[Pair],
    positions_mm: &[Vec3],
    residual: f64,
    stable: bool,
) -> Certificate {
    let deepest = deepest_contact(pairs, positions_mm);
    Certificate {
        residual,
        stable,
        crossings: crossings(surface, positions_mm),
        max_penetration_mm: deepest.map_or(0.0, |(depth, _)| depth),
        max_penetration_at_mm: deepest.map(|(_, place)| place),
        discretisation_mm: discretisation_mm(model, surface, positions_mm),
    }
}

fn deepest_contact(pairs: &[Pair], positions_mm: &[Vec3]) -> Option<(f64, Vec3)> {
    let mut deepest: Option<(f64, Vec3)> = None;
    for pair in pairs {
        let depth = pair.activation_mm - pair.nearest(positions_mm).separation_mm.norm();
        if depth > deepest.map_or(0.0, |(depth, _)| depth) {
            deepest = Some((depth, positions_mm[pair.vertices[0] as usize]));
        }
    }
    deepest
}

/// Bound on the error of the visible surface over how far the faces cut its curvature, both root mean square [1], and over
/// the mean edge length [1]. Fitted on the five presets at about 650 and 2600 triangles against 10,400: together they
/// cover nine of the ten errors, which they overestimate by 1.1 to 3.7; the tenth, of the flail valve at 2600, is 1.5 times
/// the bound. Bends alone do not tell everything: from 650 to 2600 they fall to a quarter, errors to a quarter to two
/// thirds.
const ERROR_PER_SAGITTA: f64 = 4.0;
const ERROR_PER_EDGE: f64 = 0.02;

/// An arc that turns by θ over h stands θ h / 8 off its chord. At each edge between two faces, θ is the angle between
/// them and h how wide they are together over two; folds weigh as what they are, the sharpest bends.
fn discretisation_mm(model: &Model, surface: &Surface, positions_mm: &[Vec3]) -> f64 {
    let edges = topology::edges(&model.faces);
    let at = |vertex: u32| positions_mm[vertex as usize];
    let normal = |face: u32| {
        let [a, b, c] = model.faces[face as usize].map(at);
        (b - a).cross(&(c - a))
    };
    let (mut moment, mut total) = (0.0, 0.0);
    for (edge, &[a, b]) in edges.ends.iter().enumerate() {
        if let &[one, other] = edges.faces_of(edge) {
            let (one, other) = (normal(one), normal(other));
            let area = 0.5 * (one.norm() + other.norm());
            let width = area / (at(b) - at(a)).norm().max(f64::MIN_POSITIVE);
            moment += area * (one.angle(&other) * width / 8.0).powi(2);
            total += area;
        }
    }
    if total == 0.0 {
        return 0.0;
    }
    ERROR_PER_SAGITTA * (moment / total).sqrt() + ERROR_PER_EDGE * surface.mean_edge_mm
}

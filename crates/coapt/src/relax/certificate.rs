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
    /// Largest force left on a free vertex over the mean nodal pressure force [1].
    pub residual: f64,
    /// Whether a small push is answered by a return: the symmetric part of the tangent is positive definite, or,
    /// failing that, every eigenvalue of the whole tangent has a positive real part; see [`super::stability`].
    pub stable: bool,
    /// Edges that pass through faces, by exact arithmetic. Must be empty.
    pub crossings: Vec<Crossing>,
    /// How far the mid-surfaces of two parts in contact are nearer than their contact distance, at most [mm].
    pub max_penetration_mm: f64,
    /// Where that is [mm]; absent without contact.
    pub max_penetration_at_mm: Option<Vec3>,
    /// Expected distance of the visible surface from that of an infinitely fine mesh, root mean square [mm].
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
        discretisation_mm: discretisation_mm(model, positions_mm),
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

/// Expected error of the visible surface over how far the faces cut its curvature, both root mean square [1]. Measured
/// at about 650 against 2600 triangles: 1.2 (dilated), 1.4 (healthy), 1.7 (Barlow, restricted) and 2.3 (flail); the finer
/// mesh has a quarter of the error left, if it falls with the square of the edge. 3 covers all five, the flail within
/// 3 %.
const ERROR_PER_SAGITTA: f64 = 3.0;

/// An arc that turns by θ over h stands θ h / 8 off its chord. At each edge between two faces, θ is the angle between
/// them and h how wide they are together over two; folds weigh as what they are, the sharpest bends.
fn discretisation_mm(model: &Model, positions_mm: &[Vec3]) -> f64 {
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
    if total > 0.0 {
        ERROR_PER_SAGITTA * (moment / total).sqrt()
    } else {
        0.0
    }
}

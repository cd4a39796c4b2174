//! The total force on every vertex, its tangent and the solver's merit function.

use crate::Vec3;
use crate::contact::pairs::Pair;
use crate::contact::touch::{Touch, touches};
use crate::contact::{penalty, surface::face_area_mm2};
use crate::energy::{BlockSink, Curvature, bending, bilinear_spring, chord, dead_load, membrane, pressure};
use crate::mesh::topology;
use crate::model::Model;

/// Gradient of all energies, minus the pressure force [N], shape `[vertex]`. Zero on free vertices in
/// equilibrium; on prescribed ones, the force that the support must supply.
pub fn gradient(model: &Model, pairs: &[Pair], positions_mm: &[Vec3]) -> Vec<Vec3> {
    let mut gradient = vec![Vec3::zeros(); positions_mm.len()];
    gradient_into(model, &touches(pairs, positions_mm), positions_mm, &mut gradient);
    gradient
}

/// As [`gradient`], given the pairs that touch, into a vector that is there already.
pub fn gradient_into(model: &Model, touches: &[Touch], positions_mm: &[Vec3], gradient: &mut [Vec3]) {
    gradient.fill(Vec3::zeros());
    bilinear_spring::add_gradient(&model.springs, positions_mm, gradient);
    membrane::add_gradient(&model.membranes, positions_mm, gradient);
    bending::add_gradient(&model.hinges, positions_mm, gradient);
    chord::add_gradient(&model.chords, positions_mm, gradient);
    penalty::add_gradient(touches, model.contact.stiffness_mpa, positions_mm, gradient);
    pressure::add_gradient(&model.faces, model.pressure_mpa, positions_mm, gradient);
    dead_load::add_gradient(&model.dead_loads_n, gradient);
}

/// Hands out the blocks of the tangent that are always there. The exact one includes the symmetric part of the
/// pressure's; the projected one leaves pressure out, because that part is indefinite. Otherwise the blocks come in the
/// same order for all positions.
pub fn add_elastic_tangent(
    model: &Model,
    positions_mm: &[Vec3],
    curvature: Curvature,
    sink: &mut impl BlockSink,
) {
    add_constant_tangent(model, sink);
    add_varying_tangent(model, positions_mm, curvature, sink);
}

/// The part of [`add_elastic_tangent`] that is the same for all positions, multiples of the identity: bending.
pub fn add_constant_tangent(model: &Model, sink: &mut impl BlockSink) {
    bending::add_hessian(&model.hinges, sink);
}

/// The rest of [`add_elastic_tangent`].
pub fn add_varying_tangent(
    model: &Model,
    positions_mm: &[Vec3],
    curvature: Curvature,
    sink: &mut impl BlockSink,
) {
    bilinear_spring::add_hessian(&model.springs, positions_mm, sink);
    membrane::add_hessian(&model.membranes, positions_mm, sink);
    chord::add_hessian(&model.chords, positions_mm, sink);
    if curvature == Curvature::Exact {
        pressure::add_symmetric_tangent(&model.faces, model.pressure_mpa, positions_mm, sink);
    }
}

/// Hands out the blocks of the tangent between parts in contact.
pub fn add_contact_tangent(
    model: &Model,
    touches: &[Touch],
    positions_mm: &[Vec3],
    curvature: Curvature,
    sink: &mut impl BlockSink,
) {
    penalty::add_hessian(
        touches,
        model.contact.stiffness_mpa,
        positions_mm,
        curvature,
        sink,
    );
}

/// A function whose gradient at the point it was made for is the true one, pressure included, so that a line
/// search has something to descend: elastic and contact energy, the potential −p·V, and a linear term for what
/// the potential gets wrong at free margins. It holds for one step and is made anew for the next.
#[derive(Clone, Debug)]
pub struct Merit {
    apex_mm: Vec3,
    linear_n: Vec<Vec3>,
    origin_mm: Vec<Vec3>,
}

impl Merit {
    /// The merit function around a point.
    pub fn new(model: &Model, positions_mm: &[Vec3]) -> Self {
        let apex_mm = positions_mm.iter().sum::<Vec3>() / positions_mm.len().max(1) as f64;
        let mut true_n = vec![Vec3::zeros(); positions_mm.len()];
        let mut potential_n = true_n.clone();
        pressure::add_gradient(&model.faces, model.pressure_mpa, positions_mm, &mut true_n);
        let faces = &model.faces;
        pressure::add_potential_gradient(faces, model.pressure_mpa, apex_mm, positions_mm, &mut potential_n);
        let linear_n = true_n
            .iter()
            .zip(&potential_n)
            .map(|(force, potential)| force - potential)
            .collect();
        Self {
            apex_mm,
            linear_n,
            origin_mm: positions_mm.to_vec(),
        }
    }

    /// Its value [N·mm].
    pub fn value(&self, model: &Model, touches: &[Touch], positions_mm: &[Vec3]) -> f64 {
        let moved = positions_mm.iter().zip(&self.origin_mm);
        let linear: f64 = moved
            .zip(&self.linear_n)
            .map(|((x, x0), force)| force.dot(&(x - x0)))
            .sum();
        elastic_energy_mj(model, positions_mm)
            + penalty::energy(touches, model.contact.stiffness_mpa, positions_mm)
            + pressure::potential(&model.faces, model.pressure_mpa, self.apex_mm, positions_mm)
            + dead_load::energy(&model.dead_loads_n, positions_mm)
            + linear
    }
}

/// Energy that leaflets and chordae store, stretched and bent [mJ = N·mm]. Neither in it are contact, a penalty of the method, nor
/// pressure, which has no energy at a free margin.
pub fn elastic_energy_mj(model: &Model, positions_mm: &[Vec3]) -> f64 {
    tissue_energy(model, positions_mm)
        + bending::energy(&model.hinges, positions_mm)
        + chord::energy(&model.chords, positions_mm)
}

/// Energy of springs and membranes [N·mm].
fn tissue_energy(model: &Model, positions_mm: &[Vec3]) -> f64 {
    bilinear_spring::energy(&model.springs, positions_mm) + membrane::energy(&model.membranes, positions_mm)
}

/// The force that residuals are measured by: the mean pressure force per leaflet vertex on the unloaded area, or, where that is more,
/// as under little pressure or in stiff tissue, what a strain of 1e-3 in all directions gives along a mean edge [N].
///
/// Springs k of length L store U = Σ ½ k L² ε² at a strain ε and pull with k L ε; their mean pull, weighted by length, is
/// 2 U / (ε Σ L), and that is taken for membranes too.
pub fn reference_force_n(model: &Model) -> f64 {
    let area: f64 = model
        .faces
        .iter()
        .map(|face| face_area_mm2(face, &model.rest_mm))
        .sum();
    let of_pressure = model.pressure_mpa * area / model.leaflet_vertex_count.max(1) as f64;
    of_pressure.max(force_of_strain_n(model))
}

const REFERENCE_STRAIN: f64 = 1e-3;

fn force_of_strain_n(model: &Model) -> f64 {
    let stretched: Vec<Vec3> = model
        .rest_mm
        .iter()
        .map(|place| place * (1.0 + REFERENCE_STRAIN))
        .collect();
    let edges = topology::edges(&model.faces).ends;
    let length = |&[a, b]: &[u32; 2]| (model.rest_mm[a as usize] - model.rest_mm[b as usize]).norm();
    let total_mm: f64 = edges.iter().map(length).sum();
    if total_mm > 0.0 {
        2.0 * tissue_energy(model, &stretched) / (REFERENCE_STRAIN * total_mm)
    } else {
        0.0
    }
}

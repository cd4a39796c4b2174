//! The total force on every vertex, its tangent and the solver's merit function.

use crate::contact::{pairs::Pair, penalty, surface::face_area_mm2};
use crate::energy::{BlockSink, Curvature, bilinear_spring, chord, pressure};
use crate::model::Model;
use crate::{Mat3, Vec3};

/// Gradient of all energies, minus the pressure force [N], shape `[vertex]`. Zero on free vertices in
/// equilibrium; on prescribed ones, the force that the support must supply.
pub fn gradient(model: &Model, pairs: &[Pair], positions_mm: &[Vec3]) -> Vec<Vec3> {
    let mut gradient = vec![Vec3::zeros(); positions_mm.len()];
    add_internal_gradient(model, pairs, positions_mm, &mut gradient);
    pressure::add_gradient(&model.faces, model.pressure_mpa, positions_mm, &mut gradient);
    gradient
}

fn add_internal_gradient(model: &Model, pairs: &[Pair], positions_mm: &[Vec3], gradient: &mut [Vec3]) {
    bilinear_spring::add_gradient(&model.springs, positions_mm, gradient);
    chord::add_gradient(&model.chords, positions_mm, gradient);
    penalty::add_gradient(pairs, model.contact.stiffness_mpa, positions_mm, gradient);
}

/// Hands out the blocks of the tangent. The exact one includes the symmetric part of the pressure's; the
/// projected one leaves pressure out, because that part is indefinite.
pub fn add_tangent(
    model: &Model,
    pairs: &[Pair],
    positions_mm: &[Vec3],
    curvature: Curvature,
    sink: &mut impl BlockSink,
) {
    bilinear_spring::add_hessian(&model.springs, positions_mm, curvature, sink);
    chord::add_hessian(&model.chords, positions_mm, curvature, sink);
    penalty::add_hessian(pairs, model.contact.stiffness_mpa, positions_mm, curvature, sink);
    if curvature == Curvature::Exact {
        pressure::add_symmetric_tangent(&model.faces, model.pressure_mpa, positions_mm, sink);
    }
}

/// Counts blocks instead of using them: the places of the tangent without contact.
pub fn tangent_places(model: &Model) -> Vec<[u32; 2]> {
    let mut places: Vec<[u32; 2]> = model.springs.ends.clone();
    places.extend(&model.chords.ends);
    places
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
    pub fn value(&self, model: &Model, pairs: &[Pair], positions_mm: &[Vec3]) -> f64 {
        let moved = positions_mm.iter().zip(&self.origin_mm);
        let linear: f64 = moved
            .zip(&self.linear_n)
            .map(|((x, x0), force)| force.dot(&(x - x0)))
            .sum();
        bilinear_spring::energy(&model.springs, positions_mm)
            + chord::energy(&model.chords, positions_mm)
            + penalty::energy(pairs, model.contact.stiffness_mpa, positions_mm)
            + pressure::potential(&model.faces, model.pressure_mpa, self.apex_mm, positions_mm)
            + linear
    }
}

/// The force that residuals are measured by: the mean pressure force per leaflet vertex on the unloaded area,
/// or, without pressure, what a strain of 1e-3 gives in a mean spring [N].
pub fn reference_force_n(model: &Model) -> f64 {
    let area: f64 = model
        .faces
        .iter()
        .map(|face| face_area_mm2(face, &model.rest_mm))
        .sum();
    let springs = &model.springs;
    let spring_force: f64 = springs
        .soft_n_per_mm
        .iter()
        .zip(&springs.rest_length_mm)
        .map(|(k, l)| k * l)
        .sum();
    let of_pressure = model.pressure_mpa * area / model.leaflet_vertex_count.max(1) as f64;
    of_pressure.max(1e-3 * spring_force / springs.ends.len().max(1) as f64)
}

/// Keeps only what free vertices see of the tangent: blocks between free vertices go to `matrix`, columns of
/// prescribed vertices times their motion are taken from the right-hand side.
pub struct FreeSink<'a, M: FnMut(u32, u32, &Mat3)> {
    /// Free index of each vertex, or [`PRESCRIBED`].
    pub free_index: &'a [u32],
    /// Motion of prescribed vertices in this step [mm], shape `[vertex]`.
    pub motion_mm: &'a [Vec3],
    /// Right-hand side [N], shape `[free]`.
    pub right_n: &'a mut [Vec3],
    /// Takes a block between free indices.
    pub matrix: M,
}

/// Marks a vertex without a free index.
pub const PRESCRIBED: u32 = u32::MAX;

impl<M: FnMut(u32, u32, &Mat3)> BlockSink for FreeSink<'_, M> {
    fn add(&mut self, row: u32, column: u32, block: &Mat3) {
        let (i, j) = (self.free_index[row as usize], self.free_index[column as usize]);
        match (i == PRESCRIBED, j == PRESCRIBED) {
            (false, false) => (self.matrix)(i, j, block),
            (false, true) => self.right_n[i as usize] -= block * self.motion_mm[column as usize],
            (true, false) => self.right_n[j as usize] -= block.tr_mul(&self.motion_mm[row as usize]),
            (true, true) => {}
        }
    }
}

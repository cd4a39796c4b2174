//! What several tests need.

pub mod hard;
pub mod told;

use coapt::Vec3;
use coapt::energy::pressure;
use coapt::mesh::parametric::{Preset, ValveParameters, generate};
use coapt::model::Model;
use coapt::relax::{Equilibrium, relax};
use coapt::state::State;

/// A small reproducible random generator (splitmix64), so that a failing test fails again.
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    /// Uniform in [-1, 1).
    pub fn signed(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        (z >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Uniform in the cube [-1, 1)³.
    pub fn vector(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }
}

/// A preset as a model with about so many faces, its free points moved by up to `jitter_mm`.
///
/// # Panics
/// When the preset cannot be built, which fails the test that asked for it.
pub fn preset_model(preset: Preset, face_count: u32, jitter_mm: f64, jitter_seed: u64) -> Model {
    let mut parameters = ValveParameters::preset(preset);
    parameters.face_count_target = face_count;
    parameters.jitter_mm = jitter_mm;
    parameters.jitter_seed = jitter_seed;
    let scene = generate(&parameters).expect("presets are right");
    Model::build(&scene).expect("presets build").model
}

/// Closes a valve from its open state.
pub fn close(model: &Model) -> Equilibrium {
    relax(model, &State::open(model))
}

/// Supports carry what pressure exerts, forces and torques: Σ r = Σ f and Σ x × r = Σ x × f, because everything internal
/// cancels.
///
/// What is left is the sum of the free vertices' residuals, each at most 1e-6 of the reference force, at an arm that
/// is no longer than the valve is wide.
///
/// # Panics
/// When they do not, which fails the test that asked.
pub fn assert_balanced(name: &str, model: &Model, equilibrium: &Equilibrium) {
    let positions = &equilibrium.state.positions_mm;
    let mut load = vec![Vec3::zeros(); positions.len()];
    pressure::add_gradient(&model.faces, model.pressure_mpa, positions, &mut load);
    let left = |(reaction, gradient): (&Vec3, &Vec3)| reaction + gradient;
    let left: Vec<Vec3> = equilibrium.reactions_n.iter().zip(&load).map(left).collect();
    let centre = positions.iter().sum::<Vec3>() / positions.len() as f64;
    let arms: Vec<Vec3> = positions.iter().map(|x| x - centre).collect();
    let scale_n: f64 = load.iter().map(|force| force.norm()).sum();
    let longest_mm = arms.iter().map(|arm| arm.norm()).fold(0.0, f64::max);
    let imbalance = left.iter().sum::<Vec3>().norm() / scale_n;
    assert!(imbalance <= 1e-6, "{name}: {imbalance:e}");
    let torque: Vec3 = arms.iter().zip(&left).map(|(arm, force)| arm.cross(force)).sum();
    let imbalance = torque.norm() / (scale_n * longest_mm);
    assert!(imbalance <= 1e-6, "{name}: {imbalance:e} of torque");
}

//! What several tests need.

pub mod told;

use coapt::Vec3;
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

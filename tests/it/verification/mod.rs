//! Verification: shapes whose equilibrium is known in closed form, or from an ordinary differential equation that is
//! solved here beside them. Nothing is compared with figures that were copied: what a test needs it computes, and where
//! `../shared/oracles` is present the same numbers are held against those of another program.
//!
//! Every test prints what it measured (`cargo test --test it verification -- --nocapture`); `COAPT_VERIFICATION=1` adds finer
//! meshes.

mod bileaflet;
pub(crate) mod circular;
mod classics;
pub(crate) mod frames;
mod laws;
mod mylar;
mod patch;
mod patch_membranes;
mod references;
mod sphere_membranes;
mod spheres;
pub(crate) mod squeezed_tube;
mod strips;

use coapt::Vec3;
use coapt::model::Model;
use coapt::relax::{Equilibrium, Status, relax};
use coapt::state::State;

/// Relaxes from given positions; anything but convergence fails the test that asked.
fn settled(name: &str, model: &Model, start_mm: Vec<Vec3>) -> Equilibrium {
    let equilibrium = relax(
        model,
        &State {
            positions_mm: start_mm,
        },
    );
    assert_eq!(
        equilibrium.status,
        Status::Converged,
        "{name}: residual {:e} after {} iterations",
        equilibrium.certificate.residual,
        equilibrium.history.len()
    );
    equilibrium
}

/// Prints a measured figure, for the documents.
#[allow(clippy::print_stderr, reason = "measured figures are what the run is for")]
fn report(line: &str) {
    eprintln!("{line}");
}

/// Whether finer meshes are wanted.
fn full() -> bool {
    std::env::var_os("COAPT_VERIFICATION").is_some()
}

/// What another program found, from `../shared/oracles`; nothing where that folder is absent.
fn oracle(file: &str) -> Option<serde_json::Value> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/oracles/");
    let Ok(text) = std::fs::read_to_string(format!("{folder}{file}")) else {
        report("skipped: ../shared not present");
        return None;
    };
    Some(serde_json::from_str(&text).expect("oracles are JSON"))
}

/// How far a value is from another, as a part of that [1].
fn error(found: f64, expected: f64) -> f64 {
    (found - expected).abs() / expected.abs()
}

/// Order of convergence [1] between two sizes: the slope of the error in a logarithmic plot.
fn order(sizes: [f64; 2], errors: [f64; 2]) -> f64 {
    (errors[0] / errors[1]).ln() / (sizes[0] / sizes[1]).ln()
}

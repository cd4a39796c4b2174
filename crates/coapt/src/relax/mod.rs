//! The equilibrium: [`relax`] finds it, [`Certificate`] says how far it can be trusted.

pub mod block_matrix;
pub mod certificate;
pub mod cholesky;
pub mod krylov;
pub mod load;
pub mod newton;
pub mod stability;
mod system;

use crate::Vec3;
use crate::model::Model;
use crate::state::State;
pub use certificate::Certificate;

/// Where the solver came to rest, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibrium {
    /// The closed valve.
    pub state: State,
    /// Why the solver stopped.
    pub status: Status,
    /// How far the result can be trusted.
    pub certificate: Certificate,
    /// Force of the valve on each support [N], shape `[vertex]`; zero at free vertices.
    pub reactions_n: Vec<Vec3>,
    /// What happened, iteration by iteration.
    pub history: Vec<Iteration>,
}

/// Why the solver stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// The residual is within the tolerance and the prescribed vertices are in place.
    Converged,
    /// The iteration limit came first.
    IterationLimit,
    /// No step made progress any more.
    Stalled,
    /// Leaflets cross, or touch, before anything has moved: there is no way to tell which side is which.
    TangledStart,
}

/// One solver iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Iteration {
    /// Residual before the step [1].
    pub residual: f64,
    /// Longest step of a vertex [mm].
    pub step_mm: f64,
    /// Added stiffness per area [MPa/mm].
    pub damping: f64,
    /// Part of the step taken after the line search [1].
    pub fraction: f64,
    /// Whether the exact tangent was used.
    pub exact: bool,
}

/// Relaxes a valve from a state until forces balance.
pub fn relax(model: &Model, start: &State) -> Equilibrium {
    newton::relax(model, start)
}

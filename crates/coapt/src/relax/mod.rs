//! The equilibrium: [`relax`] finds it, [`Certificate`] says how far it can be trusted.

pub mod block_matrix;
pub mod certificate;
pub mod cholesky;
mod circles;
mod elastic;
mod escape;
pub mod krylov;
mod levels;
mod line_search;
pub mod load;
mod load_steps;
mod newton;
pub mod response;
mod soft_chordae;
pub mod stability;
mod start;
mod system;
mod watch;

use std::ops::ControlFlow;

pub(crate) use load_steps::PATIENCE;
use load_steps::raise_pressure;

use crate::Vec3;
use crate::model::Model;
use crate::scene::Fault;
use crate::state::State;
pub use certificate::Certificate;
use certificate::certify;
use newton::Newton;
use rayon::prelude::*;
use watch::Log;
pub use watch::Moment;

/// Where the solver came to rest, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibrium {
    /// The closed valve.
    pub state: State,
    /// Why the solver stopped.
    pub status: Status,
    /// How far the result can be trusted.
    pub certificate: Certificate,
    /// What was done about a start that crossed or touched itself, or was inside out.
    pub untangled: Option<Untangled>,
    /// Force of the valve on each support [N], shape `[vertex]`; zero at free vertices.
    pub reactions_n: Vec<Vec3>,
    /// What happened, iteration by iteration.
    pub history: Vec<Iteration>,
}

/// A start in which surfaces crossed or touched, or closed ones were inside out, and how far from it the solver began instead:
/// as near to it as one comes from the open valve without anything passing through anything.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Untangled {
    /// Places where surfaces crossed or touched, and closed surfaces that were inside out.
    pub places: usize,
    /// How far a vertex began from where it was to begin, at most [mm].
    pub farthest_mm: f64,
}

/// Why the solver stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// The residual is within the tolerance and the prescribed vertices are in place.
    Converged,
    /// The iteration limit came first.
    IterationLimit,
    /// No step made progress any more.
    Stalled,
    /// The valve grew far beyond its size: tissue or chordae do not bear the load, and there is no balance that looks like a valve.
    /// Positions are as far as it had come, and whether they are stable was not asked.
    Burst,
    /// Leaflets cross, or touch, in the open valve: there is no way to tell which side is which. No model that was built of a
    /// scene does.
    TangledStart,
    /// The watcher said stop. Positions are as far as the valve itself had come, open where a coarser one was still being
    /// closed; whether they are stable was not asked, and the certificate says no.
    Interrupted,
}

/// One solver iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Iteration {
    /// Residual before the step [1].
    pub residual: f64,
    /// Longest step of a vertex [mm].
    pub step_mm: f64,
    /// Added stiffness per area with which the tangent was factorised [MPa/mm].
    pub damping: f64,
    /// Part of the step taken after the line search [1].
    pub fraction: f64,
    /// Whether the exact tangent was used.
    pub exact: bool,
    /// Faces of the mesh that it worked on: the valve's own or a coarser one's.
    pub faces: usize,
}

/// Relaxes a valve from a state until forces balance. An open valve is closed on coarser meshes first
/// ([`Settings::coarse_to_fine`](crate::scene::Settings)).
pub fn relax(model: &Model, start: &State) -> Equilibrium {
    relax_and_log(model, start, Log::default())
}

/// The same with somebody looking on, who is shown every iteration, those on coarser meshes and with softer chordae too, and
/// stops the closure by answering `Break`: then the status is [`Status::Interrupted`]. Looking on changes no bit of the
/// result. An iteration takes some ms at 1,000 faces and about a second at 100,000.
pub fn relax_watched(
    model: &Model,
    start: &State,
    mut watch: impl FnMut(&Moment) -> ControlFlow<()>,
) -> Equilibrium {
    relax_and_log(model, start, Log::watched(&mut watch))
}

fn relax_and_log(model: &Model, start: &State, mut log: Log) -> Equilibrium {
    let mut newton = Newton::new(model);
    let Some((mut positions, untangled)) = start::begin(&mut newton, start) else {
        return conclude(&mut newton, start.positions_mm.clone(), Status::TangledStart, log);
    };
    newton.evaluate(&positions);
    let at_rest = newton.residual(&newton.gradient) <= model.settings.residual_tolerance;
    if model.settings.coarse_to_fine && positions == model.rest_mm && !at_rest {
        positions = levels::begin(&mut newton, &mut log).unwrap_or(positions);
        soft_chordae::stiffen(model, &mut positions, &mut log);
    }
    let begins_anew = log.iterations_left(model) >= 2 * PATIENCE;
    newton.iteration_limit = match begins_anew {
        true => PATIENCE,
        false => log.iterations_left(model),
    };
    let mut status = newton.iterate(&mut positions, &mut log);
    if is_lost(status) && begins_anew && newton.residual(&newton.gradient).is_finite() {
        (newton, status) = begin_anew(model, &mut positions, &mut log);
    }
    Equilibrium {
        untangled,
        ..conclude(&mut newton, positions, status, log)
    }
}

fn is_lost(status: Status) -> bool {
    matches!(status, Status::IterationLimit | Status::Stalled)
}

/// The last resorts: from little pressure to all of it, and from where that ended with the exact tangent, however far the balance.
fn begin_anew<'a>(model: &'a Model, positions: &mut Vec<Vec3>, log: &mut Log) -> (Newton<'a>, Status) {
    raise_pressure(model, positions, log);
    let mut newton = Newton::new(model);
    let left = log.iterations_left(model);
    // Half of what is left, at most PATIENCE, is kept for the other resort.
    newton.iteration_limit = left - left.div_ceil(2).min(PATIENCE);
    let mut status = newton.iterate(positions, log);
    if is_lost(status) {
        newton = Newton::new(model);
        newton.leaves_rounds = true;
        newton.iteration_limit = log.iterations_left(model);
        status = newton.iterate(positions, log);
    }
    (newton, status)
}

/// Closes many open valves, on as many threads as there are; the results are those of [`relax`], in the same order.
pub fn relax_all(models: &[Model]) -> Vec<Equilibrium> {
    let close = |model: &Model| relax(model, &State::open(model));
    models.par_iter().map(close).collect()
}

/// A closed valve whose supports are moved bit by bit, as by a slider: each closure begins where the last one ended, with
/// what the solver has learnt and room for its matrices.
pub struct Interactive<'a> {
    newton: Newton<'a>,
    positions_mm: Vec<Vec3>,
}

impl<'a> Interactive<'a> {
    /// Goes on from a closed valve.
    pub fn new(model: &'a Model, closed: &Equilibrium) -> Self {
        Self {
            newton: Newton::new(model),
            positions_mm: closed.state.positions_mm.clone(),
        }
    }

    /// Moves the prescribed vertices, those of [`Model::prescribed`] in its order, to new places [mm] and closes the valve
    /// again.
    ///
    /// # Errors
    /// Not one target for each prescribed vertex, or one that is not a number; the valve is then left as it was.
    pub fn close(&mut self, targets_mm: &[Vec3]) -> Result<Equilibrium, Fault> {
        self.close_and_log(targets_mm, Log::default())
    }

    /// The same with somebody looking on, as in [`relax_watched`]. After an interruption the next closure goes on from
    /// where this one came to.
    ///
    /// # Errors
    /// As [`Interactive::close`].
    pub fn close_watched(
        &mut self,
        targets_mm: &[Vec3],
        mut watch: impl FnMut(&Moment) -> ControlFlow<()>,
    ) -> Result<Equilibrium, Fault> {
        self.close_and_log(targets_mm, Log::watched(&mut watch))
    }

    fn close_and_log(&mut self, targets_mm: &[Vec3], mut log: Log) -> Result<Equilibrium, Fault> {
        let prescribed = &mut self.newton.prescribed;
        if targets_mm.len() != prescribed.len() {
            let message = format!(
                "are {}; expected one for each of the {} prescribed vertices",
                targets_mm.len(),
                prescribed.len()
            );
            return Err(Fault::error("targets", message));
        }
        let is_lost = |target_mm: &Vec3| !target_mm.iter().all(|coordinate| coordinate.is_finite());
        if let Some(lost) = targets_mm.iter().position(is_lost) {
            let message = format!(
                "is {:?}; expected finite coordinates",
                targets_mm[lost].as_slice()
            );
            return Err(Fault::error(format!("targets[{lost}]"), message));
        }
        for (prescribed, target_mm) in prescribed.iter_mut().zip(targets_mm) {
            prescribed.target_mm = *target_mm;
        }
        let status = self.newton.iterate(&mut self.positions_mm, &mut log);
        Ok(conclude(&mut self.newton, self.positions_mm.clone(), status, log))
    }
}

fn conclude(newton: &mut Newton, positions: Vec<Vec3>, status: Status, log: Log) -> Equilibrium {
    let model = newton.model;
    newton.evaluate(&positions);
    let residual = newton.residual(&newton.gradient);
    let stable = newton.stable.take();
    // Who has said stop does not wait for a factorisation more, and what has burst is no balance.
    let may_be_stable = residual.is_finite() && !matches!(status, Status::Interrupted | Status::Burst);
    let stable = stable.unwrap_or_else(|| may_be_stable && newton.is_stable(&positions));
    let certificate = certify(model, &newton.surface, &newton.near, &positions, residual, stable);
    let mut reactions_n = vec![Vec3::zeros(); positions.len()];
    for prescribed in &newton.prescribed {
        // The valve pulls on its support with minus the gradient.
        reactions_n[prescribed.vertex as usize] = -newton.gradient[prescribed.vertex as usize];
    }
    Equilibrium {
        state: State {
            positions_mm: positions,
        },
        status,
        certificate,
        untangled: None,
        reactions_n,
        history: log.history,
    }
}

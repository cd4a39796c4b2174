//! Closures with other chord lengths, counted, and what came of each.

use rayon::prelude::*;

use super::misfit::{Misfit, misfit};
use super::{FitWatch, Progress, Target, Trial, Tried};
use crate::model::Model;
use crate::relax::{Equilibrium, Moment, Status, relax_watched};
use crate::state::State;

/// A closure that converged.
#[derive(Clone, Debug)]
pub(super) struct Closed {
    /// Factors, shape `[chord group]`.
    pub(super) scale: Vec<f64>,
    /// Where it came to rest.
    pub(super) equilibrium: Equilibrium,
    /// Its distance from the target.
    pub(super) misfit: Misfit,
}

/// The valve, the target, and all closures so far.
pub(super) struct Closures<'a> {
    pub(super) model: &'a Model,
    target: &'a Target,
    watch: FitWatch<'a>,
    /// The watcher has said stop: no closure is made any more.
    pub(super) interrupted: bool,
    /// Those that converged.
    pub(super) converged: Vec<Closed>,
    /// All of them.
    pub(super) history: Vec<Trial>,
}

impl<'a> Closures<'a> {
    pub(super) fn new(model: &'a Model, target: &'a Target, watch: FitWatch<'a>) -> Self {
        Self {
            model,
            target,
            watch,
            interrupted: false,
            converged: Vec::new(),
            history: Vec::new(),
        }
    }

    /// Closes the valve with each of these factors, side by side, from its open state or from a closed one; nothing where it
    /// did not converge, and everywhere after an interruption.
    pub(super) fn close_all(&mut self, scales: Vec<Vec<f64>>, from: Option<&State>) -> Vec<Option<Closed>> {
        if self.interrupted {
            return vec![None; scales.len()];
        }
        let open = State::open(self.model);
        let start = from.unwrap_or(&open);
        let look = |moment: &Moment| (self.watch)(&Progress::Iterated(moment));
        // Iterations alone are asked whether to stop.
        let _ = (self.watch)(&Progress::Begun(scales.len()));
        let close = |scale: Vec<f64>| {
            let equilibrium = relax_watched(&scaled(self.model, &scale), start, look);
            let _ = (self.watch)(&Progress::Closed);
            let misfit = misfit(
                self.model,
                &equilibrium.state.positions_mm,
                &self.target.points_mm,
            );
            Closed {
                scale,
                equilibrium,
                misfit,
            }
        };
        let closed: Vec<Closed> = scales.into_par_iter().map(close).collect();
        closed
            .into_iter()
            .map(|closed| self.note(closed, from.is_some()))
            .collect()
    }

    fn note(&mut self, closed: Closed, warm: bool) -> Option<Closed> {
        let converged = closed.equilibrium.status == Status::Converged;
        self.interrupted |= closed.equilibrium.status == Status::Interrupted;
        self.history.push(Trial {
            scale: closed.scale.clone(),
            warm,
            iterations: closed.equilibrium.history.len(),
            rms_mm: converged.then(|| closed.misfit.of_all().rms_mm),
        });
        self.converged.extend(converged.then(|| closed.clone()));
        converged.then_some(closed)
    }

    /// A closure as it is told.
    pub(super) fn tried(&self, closed: &Closed) -> Tried {
        Tried {
            model: scaled(self.model, &closed.scale),
            all_points: closed.misfit.of_all(),
            visible_points: closed.misfit.of_visible(),
            equilibrium: closed.equilibrium.clone(),
        }
    }
}

/// The valve with the rest lengths of each chord group multiplied.
fn scaled(model: &Model, scale: &[f64]) -> Model {
    Model {
        chords: model.chords.scaled(scale),
        ..model.clone()
    }
}

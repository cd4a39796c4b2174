//! How far to go along a step.
//!
//! The search asks forces, not energies: pressure on a free margin has no energy, and the force at the end of the step is
//! what the next iteration begins with.

use super::load::{self, Merit};
use super::newton::{Newton, advance};
use crate::Vec3;
use crate::contact::touch::touches_into;

/// Which steps are good enough.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Acceptance {
    /// All: supports move, and forces rise with them.
    Any,
    /// Those along which the force does not turn round, or that lower the residual or the merit function.
    Progress,
    /// Those along which the force hardly turns round.
    Strict,
}

/// A step is good if the force along it has not turned round by more than this part of what it was [1].
const OVERSHOOT: f64 = 0.5;
const STRICT_OVERSHOOT: f64 = 0.05;
/// The search gives up after so many trials.
const TRIALS: u32 = 8;

impl Newton<'_> {
    /// Goes along the step until it is good enough, and moves there; returns the part taken [1], zero where the search gave
    /// up.
    pub(super) fn search(&mut self, positions: &mut Vec<Vec3>, residual: f64, acceptance: Acceptance) -> f64 {
        let slope = self.slope(&self.gradient);
        let mut fall_from = None;
        let mut fraction = 1.0;
        for _ in 0..TRIALS {
            let there = self.try_part(positions, fraction);
            let turns_less_than = |part: f64| slope < 0.0 && there <= -part * slope;
            let is_good = match acceptance {
                Acceptance::Any => true,
                Acceptance::Strict => turns_less_than(STRICT_OVERSHOOT),
                Acceptance::Progress => {
                    turns_less_than(OVERSHOOT)
                        || self.residual(&self.trial_gradient) < residual
                        || self.falls(&mut fall_from, positions)
                }
            };
            if is_good {
                std::mem::swap(positions, &mut self.trial);
                std::mem::swap(&mut self.touches, &mut self.trial_touches);
                std::mem::swap(&mut self.gradient, &mut self.trial_gradient);
                return fraction;
            }
            // Where the force along the step would vanish if it changed evenly.
            fraction *= (slope / (slope - there)).clamp(0.25, 0.6);
        }
        0.0
    }

    /// Computes the force after a part of the step; returns the slope along it there.
    fn try_part(&mut self, positions: &[Vec3], fraction: f64) -> f64 {
        self.trial.copy_from_slice(positions);
        advance(&mut self.trial, &self.step, fraction);
        touches_into(&self.near, &self.trial, &mut self.trial_touches);
        let (touches, gradient) = (&self.trial_touches, &mut self.trial_gradient);
        load::gradient_into(self.model, touches, &self.trial, gradient);
        self.slope(&self.trial_gradient)
    }

    /// Whether the merit function is lower at the trial than where the valve now is.
    fn falls(&self, fall_from: &mut Option<(Merit, f64)>, positions: &[Vec3]) -> bool {
        let (merit, before) = fall_from.get_or_insert_with(|| {
            let merit = Merit::new(self.model, positions);
            let before = merit.value(self.model, &self.touches, positions);
            (merit, before)
        });
        merit.value(self.model, &self.trial_touches, &self.trial) < *before
    }

    /// Slope along the step: minus the work of the force on the free vertices [N·mm].
    fn slope(&self, gradient: &[Vec3]) -> f64 {
        let free = self.system.free.iter();
        free.map(|&vertex| gradient[vertex as usize].dot(&self.step[vertex as usize]))
            .sum()
    }
}

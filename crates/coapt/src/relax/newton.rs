//! Damped Newton iterations that never let anything pass through anything.
//!
//! Each iteration solves (K + μ A) d = −g for the step d: K the tangent, A the area around each vertex, μ a
//! damping that falls while steps succeed and rises when they fail. Every vertex then goes as far along its step
//! as contact allows, and the step is halved until the merit function falls. Near the equilibrium K is the
//! exact tangent and a few products with the true, unsymmetric one sharpen the step.

use super::certificate::certify;
use super::load::{self, Merit};
use super::system::System;
use super::{Equilibrium, Iteration, Status, stability};
use crate::Vec3;
use crate::contact::crossing::crossings;
use crate::contact::pairs::{Pair, PairList, largest_distance};
use crate::contact::step_bound;
use crate::contact::surface::Surface;
use crate::energy::Curvature;
use crate::model::Model;
use crate::state::State;

/// Longest step of a vertex, as a part of the valve's size [1]. Larger steps overshoot while the soft branch of
/// the springs still rules; smaller ones only cost iterations.
const STEP_LIMIT: f64 = 0.01;
/// Longest step of a vertex in mean edge lengths [1]: fine meshes pay for long steps with long pair lists.
const STEP_LIMIT_EDGES: f64 = 0.5;
/// The exact tangent is tried from this residual on: farther out it is indefinite nearly always.
const EXACT_BELOW: f64 = 0.3;
/// Relative residual of a Newton step [1]: Newton squares its error at best, and far away it cannot use more.
const NEWTON_TOLERANCE: f64 = 1e-4;
/// Relative residual of the solutions that eigenvalues are found from [1].
const EIGEN_TOLERANCE: f64 = 1e-9;
/// The exact tangent is tried with this many dampings, each so many times the last.
const EXACT_TRIES: u32 = 4;
const DAMPING_RISE: f64 = 8.0;
/// The damping never falls below this part of its first value [1].
const LEAST_DAMPING: f64 = 1e-7;
/// So often the solver leaves an unstable balance of forces before it reports one.
const ESCAPE_LIMIT: u32 = 30;
/// How far it then pushes, as a part of the longest step [1].
const ESCAPE_STEP: f64 = 0.5;
/// Inverse iterations that find the direction; a rough one will do.
const INVERSE_ITERATIONS: u32 = 8;
/// A line search gives up after so many halvings.
const HALVINGS: u32 = 12;
/// Steps in a row without progress before the solver says so.
const STALL_LIMIT: u32 = 60;

/// Length of the pair list's budget in steps [1]. More, and lists grow long; fewer, and they are made too often.
const BUDGET_STEPS: f64 = 1.5;

struct Solver<'a> {
    model: &'a Model,
    surface: Surface,
    pairs: PairList,
    /// The pairs that may touch where the valve now is.
    near: Vec<Pair>,
    system: System<'a>,
    reference_force_n: f64,
    step_limit_mm: f64,
    least_damping: f64,
}

/// Relaxes from `start`.
pub(super) fn relax(model: &Model, start: &State) -> Equilibrium {
    let mut solver = Solver::new(model);
    let mut positions = start.positions_mm.clone();
    let mut history = Vec::new();
    let status = if crossings(&solver.surface, &positions).is_empty() {
        solver.iterate(&mut positions, &mut history)
    } else {
        Status::TangledStart
    };
    solver.finish(positions, status, history)
}

impl<'a> Solver<'a> {
    fn new(model: &'a Model) -> Self {
        let surface = Surface::new(&model.faces, &model.rest_mm);
        let edges = &model.springs.rest_length_mm;
        let mean_edge = edges.iter().sum::<f64>() / edges.len().max(1) as f64;
        let step_limit_mm = (STEP_LIMIT * diagonal_mm(&model.rest_mm)).min(STEP_LIMIT_EDGES * mean_edge);
        // At this damping pressure alone moves a vertex by the step limit.
        let damping = model.pressure_mpa.max(1e-12) / step_limit_mm;
        Self {
            model,
            system: System::new(model, &surface, damping),
            surface,
            pairs: PairList::default(),
            near: Vec::new(),
            reference_force_n: load::reference_force_n(model),
            step_limit_mm,
            least_damping: LEAST_DAMPING * damping,
        }
    }

    fn iterate(&mut self, positions: &mut Vec<Vec3>, history: &mut Vec<Iteration>) -> Status {
        let (mut failures, mut escapes) = (0, 0);
        self.cover(positions, 0.0);
        self.near = self.pairs.touching(positions, positions);
        for _ in 0..self.model.settings.iteration_limit {
            let motion = self.boundary_motion(positions);
            let moving = motion.iter().any(|step| *step != Vec3::zeros());
            let gradient = load::gradient(self.model, &self.near, positions);
            let residual = self.residual(&gradient);
            if residual <= self.model.settings.residual_tolerance && !moving {
                if escapes == ESCAPE_LIMIT || !self.escape(positions) {
                    return Status::Converged;
                }
                escapes += 1;
                continue;
            }
            let (mut step, exact) = self.newton_step(positions, &gradient, &motion, residual);
            let longest = self.limit(&mut step);
            self.cover(positions, longest);
            step_bound::shorten(&self.pairs.meeting(positions, &step), positions, &mut step);
            let mut end = positions.clone();
            advance(&mut end, &step, 1.0);
            self.near = self.pairs.touching(positions, &end);
            let fraction = if moving {
                *positions = end;
                1.0
            } else {
                self.search(positions, &step, residual)
            };
            history.push(Iteration {
                residual,
                step_mm: longest,
                damping: self.system.damping,
                fraction,
                exact,
            });
            self.adapt_damping(fraction);
            failures = if fraction == 0.0 { failures + 1 } else { 0 };
            if failures > STALL_LIMIT {
                return Status::Stalled;
            }
        }
        Status::IterationLimit
    }

    /// How prescribed vertices go on towards their targets in this step [mm], shape `[vertex]`.
    fn boundary_motion(&self, positions: &[Vec3]) -> Vec<Vec3> {
        let mut motion = vec![Vec3::zeros(); positions.len()];
        for prescribed in &self.model.prescribed {
            let vertex = prescribed.vertex as usize;
            let way = prescribed.target_mm - positions[vertex];
            motion[vertex] = clipped(way, 0.25 * self.step_limit_mm);
        }
        motion
    }

    fn residual(&self, gradient: &[Vec3]) -> f64 {
        let squared = self
            .system
            .free
            .iter()
            .map(|&vertex| gradient[vertex as usize].norm_squared());
        squared.fold(0.0, f64::max).sqrt() / self.reference_force_n
    }

    /// Makes sure that every pair which may touch during a step of this length is listed.
    fn cover(&mut self, positions: &[Vec3], step_mm: f64) {
        if !self.pairs.covers(positions, step_mm) {
            let thickness = self.model.contact.thickness_mm;
            // Room for this step and the next ones, which are likely no longer.
            let budget = (BUDGET_STEPS * step_mm).max(0.1 * thickness);
            self.pairs
                .rebuild(&self.surface, &self.model.rest_mm, positions, thickness, budget);
        }
    }

    /// The step that the tangent suggests, prescribed vertices included, and whether it was the exact tangent.
    fn newton_step(
        &mut self,
        positions: &[Vec3],
        gradient: &[Vec3],
        motion: &[Vec3],
        residual: f64,
    ) -> (Vec<Vec3>, bool) {
        if residual < EXACT_BELOW {
            let right = self
                .system
                .assemble(&self.near, positions, gradient, motion, Curvature::Exact);
            for _ in 0..EXACT_TRIES {
                if let Some(factor) = self.system.factorise() {
                    let solution =
                        self.system
                            .solve_unsymmetric(&factor, positions, &right, NEWTON_TOLERANCE);
                    return (self.system.scatter(&solution, motion), true);
                }
                self.system.damping = (self.system.damping * DAMPING_RISE).max(self.least_damping);
            }
        }
        let right = self
            .system
            .assemble(&self.near, positions, gradient, motion, Curvature::Projected);
        for _ in 0..40 {
            if let Some(factor) = self.system.factorise() {
                return (
                    self.system.scatter(&self.system.solve(&factor, &right), motion),
                    false,
                );
            }
            self.system.damping *= 10.0;
        }
        (motion.to_vec(), false)
    }

    /// Shortens over-long steps vertex by vertex; returns the longest that is left [mm].
    fn limit(&self, step: &mut [Vec3]) -> f64 {
        let mut longest = 0.0_f64;
        for step in step.iter_mut() {
            *step = clipped(*step, self.step_limit_mm);
            longest = longest.max(step.norm());
        }
        longest
    }

    /// Takes as much of the step as lowers the merit function, or the residual; returns the part taken [1].
    fn search(&self, positions: &mut Vec<Vec3>, step: &[Vec3], residual: f64) -> f64 {
        let merit = Merit::new(self.model, positions);
        let before = merit.value(self.model, &self.near, positions);
        let mut fraction = 1.0;
        for _ in 0..HALVINGS {
            let mut trial = positions.clone();
            advance(&mut trial, step, fraction);
            let falls = merit.value(self.model, &self.near, &trial) < before;
            if falls || self.residual(&load::gradient(self.model, &self.near, &trial)) < residual {
                *positions = trial;
                return fraction;
            }
            fraction *= 0.5;
        }
        0.0
    }

    fn adapt_damping(&mut self, fraction: f64) {
        if fraction == 1.0 {
            self.system.damping = (self.system.damping * 0.5).max(self.least_damping);
        } else if fraction < 0.3 {
            self.system.damping *= 4.0;
        }
    }

    fn finish(mut self, positions: Vec<Vec3>, status: Status, history: Vec<Iteration>) -> Equilibrium {
        self.cover(&positions, 0.0);
        self.near = self.pairs.touching(&positions, &positions);
        let gradient = load::gradient(self.model, &self.near, &positions);
        let residual = self.residual(&gradient);
        let stable = self.is_stable(&positions);
        let certificate = certify(
            self.model,
            &self.surface,
            &self.near,
            &positions,
            residual,
            stable,
        );
        let mut reactions_n = vec![Vec3::zeros(); positions.len()];
        for prescribed in &self.model.prescribed {
            // The valve pulls on its support with minus the gradient.
            reactions_n[prescribed.vertex as usize] = -gradient[prescribed.vertex as usize];
        }
        Equilibrium {
            state: State {
                positions_mm: positions,
            },
            status,
            certificate,
            reactions_n,
            history,
        }
    }

    /// Whether the valve stays where it is when pushed a little; see [`super::stability`].
    fn is_stable(&mut self, positions: &[Vec3]) -> bool {
        if self.system.free.is_empty() {
            return true;
        }
        let Some(factor) = self
            .system
            .factorise_shifted(&self.near, positions, self.least_damping)
        else {
            return false;
        };
        if self.system.damping == self.least_damping {
            return true;
        }
        let solve = |right: &[Vec3]| {
            self.system
                .solve_unsymmetric(&factor, positions, right, EIGEN_TOLERANCE)
        };
        let start = (0..self.system.free.len()).map(pseudo_random).collect();
        stability::least_real_part(solve, &self.system.weight_mm2, self.system.damping, start) > 0.0
    }

    /// Leaves a balance of forces that the slightest push would upset: moves a little along the direction in
    /// which the tangent is most negative. False where there is no such direction.
    fn escape(&mut self, positions: &mut [Vec3]) -> bool {
        if self.is_stable(positions) {
            return false;
        }
        let Some(factor) = self
            .system
            .factorise_shifted(&self.near, positions, self.least_damping)
        else {
            return false;
        };
        let mut direction: Vec<Vec3> = (0..self.system.free.len()).map(pseudo_random).collect();
        for _ in 0..INVERSE_ITERATIONS {
            direction = self.system.solve(&factor, &direction);
            let longest = direction.iter().map(|x| x.norm()).fold(0.0, f64::max);
            direction.iter_mut().for_each(|x| *x /= longest);
        }
        let curvature: f64 = direction
            .iter()
            .zip(self.system.matrix.multiply(&direction))
            .map(|(x, kx)| x.dot(&kx))
            .sum();
        if curvature >= 0.0 {
            return false;
        }
        let push = ESCAPE_STEP * self.step_limit_mm;
        self.cover(positions, push);
        let merit = Merit::new(self.model, positions);
        let ways = [push, -push].map(|push| {
            let along: Vec<Vec3> = direction.iter().map(|x| x * push).collect();
            let mut step = self.system.scatter(&along, &vec![Vec3::zeros(); positions.len()]);
            step_bound::shorten(&self.pairs.meeting(positions, &step), positions, &mut step);
            advance(&mut step, positions, 1.0);
            (
                merit.value(self.model, &self.pairs.touching(positions, &step), &step),
                step,
            )
        });
        let [there, back] = ways;
        let (_, end) = if there.0 <= back.0 { there } else { back };
        positions.copy_from_slice(&end);
        self.near = self.pairs.touching(positions, positions);
        true
    }
}

/// A fixed vector without any symmetry that could hide a direction.
fn pseudo_random(index: usize) -> Vec3 {
    let x = index as f64;
    Vec3::new(
        (12.9898 * x + 1.0).sin(),
        (78.233 * x + 2.0).sin(),
        (37.719 * x + 3.0).sin(),
    )
}

fn advance(positions: &mut [Vec3], step: &[Vec3], fraction: f64) {
    for (position, step) in positions.iter_mut().zip(step) {
        *position += step * fraction;
    }
}

fn clipped(vector: Vec3, longest: f64) -> Vec3 {
    let length = vector.norm();
    if length > longest {
        vector * (longest / length)
    } else {
        vector
    }
}

/// About the diagonal of a square around the valve: √2 times how far the farthest vertex lies from the first.
fn diagonal_mm(positions: &[Vec3]) -> f64 {
    let first = positions.first().copied().unwrap_or_default();
    2.0 * largest_distance(positions, &vec![first; positions.len()]) / 2.0_f64.sqrt()
}

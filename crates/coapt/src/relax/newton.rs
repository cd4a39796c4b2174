//! Damped Newton iterations that never let anything pass through anything.
//!
//! Each iteration solves (K + μ A) d = −g for the step d: K the tangent, A the area around each vertex, μ a
//! damping that falls while steps succeed and rises when they fail. Every vertex then goes as far along its step
//! as contact allows, and the step is shortened until the force no longer points back along it. Near the equilibrium K
//! is the exact tangent and a few products with the true, unsymmetric one sharpen the step.

use super::circles::goes_in_circles;
use super::elastic::Moved;
use super::line_search::Acceptance;
use super::load;
use super::system::System;
use super::watch::Log;
use super::{Iteration, Status};
use crate::Vec3;
use crate::contact::gather::PairList;
use crate::contact::pairs::{Pair, Place, rigid_fraction};
use crate::contact::step_bound::{Allowance, bound_steps};
use crate::contact::surface::Surface;
use crate::contact::touch::{Touch, touches_into};
use crate::energy::Curvature;
use crate::model::{Model, Prescribed};

/// Longest step of a vertex, as a part of the valve's radius [1]. Larger steps overshoot while the soft branch of
/// the springs still rules; smaller ones only cost iterations. It was tuned as 0.01 of a diagonal measured from the first vertex,
/// 2.5 to 2.7 radii of the presets.
const STEP_LIMIT: f64 = 0.026;
/// Longest step of a vertex in mean edge lengths [1]: fine meshes pay for long steps with long pair lists.
const STEP_LIMIT_EDGES: f64 = 0.5;
/// The exact tangent is tried from this residual on: farther out it is indefinite nearly always.
const EXACT_BELOW: f64 = 0.3;
/// And after a step shorter than this part of the longest allowed [1] that no damping shortened: a large residual is then that of
/// something stiff, and the balance is near. Stiff ties of a clip in an unloaded valve kept the projected tangent going round at
/// residuals of 40 and steps of a hundredth of a millimetre until [`ROUND`] told; begun with the exact one it came to rest in seven.
/// At 0.05 and 0.2 as many iterations.
const NEAR: f64 = 0.1;
/// A damping below this part of the first one shortens no step [1], our choice.
const UNBRAKED: f64 = 0.1;
/// And where the projected one crawls, since it is far too stiff along the way: the residual stays above this part of the
/// last [1] for so many steps.
const CRAWLING: f64 = 0.9;
const CRAWL_LIMIT: u32 = 4;
/// Or where it goes round: a two-cycle without pressure in the tangent changes the residual by half a per cent to and fro [1];
/// a rise by more is the way of a valve that is still closing.
const GOING_ROUND: f64 = 1.02;
/// Or the least residual of so many steps stays so near that of as many before. A sheet squeezed between four walls went round
/// in two or three steps with residuals 20 % apart that fell by a part of a thousand in a round. Our choice: several such
/// rounds; the more, the more steps are lost before the exact tangent is tried. Without pressure alone: valves whose flaps
/// swing go round on their way, and one more of ten with chordae three times as long, two more of ten Barlow valves without
/// marginal chordae did not come to rest.
const ROUND: usize = 12;
/// Relative residual of a Newton step [1]: Newton squares its error at best, and far away it cannot use more.
const NEWTON_TOLERANCE: f64 = 1e-2;
/// Below this residual the damping that the factorisation may need is left out of the step itself; far out it is a brake
/// that steps must have. Where a valve has a mode of hardly any stiffness, or one that follower pressure holds though the
/// symmetric part does not, steps damped for the sake of the factor approach the balance as slowly as 1/k². When it was tuned,
/// Barlow valves under rings of 28, 30 and 34 mm took 147, 348 and 137 iterations to 1e-6 (250, more than 2000 and 167
/// without), at 1e-3 162, 394 and 156; always left out, the dilated valve took 41 instead of 22.
const UNDAMPED_BELOW: f64 = 1e-2;
/// The exact tangent is tried with this many dampings, each so many times the last.
const EXACT_TRIES: u32 = 8;
const DAMPING_RISE: f64 = 4.0;
/// The damping never falls below this part of its first value [1].
const LEAST_DAMPING: f64 = 1e-7;
/// Unstable balances that are left, at most.
const ESCAPE_LIMIT: u32 = 30;
/// After this many exact steps that did not bring the residual below [`LOWER`] times its least only strictly good steps are
/// taken: at a kink of the springs' law full steps may lead to and fro for ever, each acceptable by itself. The healthy valve's
/// residual went 9.0, 9.3, 9.0e-3 eight times while any lower one counted and four idle steps were waited for.
const IDLE_LIMIT: u32 = 1;
const LOWER: f64 = 0.9;
/// Steps of a walk to a given shape: at the longest step a valve's radius.
const WALK_STEPS: u32 = 40;
/// A valve whose tissue bears the load does not come to so many radii from its middle [1], our choice: shapes with a known balance, caps
/// blown up to a stretch of four among them, stay within. Without a bound, valves too weak for their pressure grew to metres, and
/// their surfaces crossed.
const BURST_RADII: f64 = 5.0;
/// Steps in a row without progress before the solver says so.
const STALL_LIMIT: u32 = 60;

/// One valve on its way to equilibrium, with all that is kept from iteration to iteration.
pub(super) struct Newton<'a> {
    pub(super) model: &'a Model,
    pub(super) surface: Surface,
    pairs: PairList,
    /// The pairs that may touch where the valve now is.
    pub(super) near: Vec<Pair>,
    /// Those that do.
    pub(super) touches: Vec<Touch>,
    pub(super) trial_touches: Vec<Touch>,
    pub(super) system: System<'a>,
    /// Where the prescribed vertices go: as in the model, or as an edit has moved them.
    pub(super) prescribed: Vec<Prescribed>,
    reference_force_n: f64,
    /// Middle of the unloaded valve, and where it counts as burst, from there.
    middle_mm: Vec3,
    burst_mm: f64,
    pub(super) step_limit_mm: f64,
    pub(super) least_damping: f64,
    /// So often the solver leaves an unstable balance of forces before it reports one.
    pub(super) escape_limit: u32,
    /// So many iterations are made at most.
    pub(super) iteration_limit: u32,
    /// Whether the balance that it came to lasts, where it has looked.
    pub(super) stable: Option<bool>,
    /// The longest step of a vertex in the last iteration [mm].
    longest_mm: f64,
    crawled: u32,
    /// Whether the residual comes back to where it was within [`ROUND`] steps; under pressure it is not asked.
    goes_round: bool,
    /// Whether that is looked for under pressure too, once all else has failed: stiff ties of a clip in a wide valve went to and
    /// fro at residuals of 1.6 to 3.9 for two thousand steps of the projected tangent, which is too stiff along the way, and came
    /// to rest in nine of the exact one. Why not sooner: see [`ROUND`].
    pub(super) leaves_rounds: bool,
    first_damping: f64,
    damping: f64,
    exact_damping: f64,
    /// The first of the dampings tried that made the last exact tangent positive definite.
    pub(super) factor_damping: f64,
    /// Minus the force on each vertex where the valve now is [N], shape `[vertex]`.
    pub(super) gradient: Vec<Vec3>,
    pub(super) trial_gradient: Vec<Vec3>,
    pub(super) trial: Vec<Vec3>,
    pub(super) step: Vec<Vec3>,
    /// How prescribed vertices go on towards their targets [mm], shape `[vertex]`.
    motion: Vec<Vec3>,
    /// Right-hand side, then solution, shape `[free]`.
    pub(super) right: Vec<Vec3>,
    allowances: Vec<Allowance>,
}

impl<'a> Newton<'a> {
    pub(super) fn new(model: &'a Model) -> Self {
        let surface = Surface::new(&model.faces, &model.rest_mm);
        let scale = model.settings.step_scale;
        let middle_mm = middle_mm(&model.rest_mm);
        let radius_mm = farthest_mm(&model.rest_mm, middle_mm);
        let targets = model.prescribed.iter().map(|held| held.target_mm);
        let held_mm = farthest_mm(&targets.collect::<Vec<_>>(), middle_mm);
        let step_limit_mm = scale * (STEP_LIMIT * radius_mm).min(STEP_LIMIT_EDGES * surface.mean_edge_mm);
        let reference_force_n = load::reference_force_n(model);
        // At this damping pressure alone moves a vertex by the step limit.
        let damping = load_mpa(model, &surface, reference_force_n) / step_limit_mm;
        let system = System::new(model, &surface);
        let zeros = vec![Vec3::zeros(); model.rest_mm.len()];
        Self {
            model,
            surface,
            pairs: PairList::default(),
            near: Vec::new(),
            touches: Vec::new(),
            trial_touches: Vec::new(),
            reference_force_n,
            middle_mm,
            burst_mm: BURST_RADII * radius_mm.max(held_mm),
            step_limit_mm,
            least_damping: LEAST_DAMPING * damping,
            escape_limit: ESCAPE_LIMIT,
            iteration_limit: model.settings.iteration_limit,
            stable: None,
            longest_mm: f64::INFINITY,
            crawled: 0,
            goes_round: false,
            leaves_rounds: false,
            first_damping: damping,
            damping,
            exact_damping: 1e-3 * damping,
            factor_damping: 0.0,
            gradient: zeros.clone(),
            trial_gradient: zeros.clone(),
            trial: zeros.clone(),
            step: zeros.clone(),
            motion: zeros,
            right: vec![Vec3::zeros(); system.free.len()],
            prescribed: model.prescribed.clone(),
            allowances: Vec::new(),
            system,
        }
    }

    /// Iterates until forces balance, or the watcher says stop or has said so before; `positions` are where it came to.
    pub(super) fn iterate(&mut self, positions: &mut Vec<Vec3>, log: &mut Log) -> Status {
        if log.interrupted {
            return Status::Interrupted;
        }
        let (mut failures, mut escapes) = (0, 0);
        let (mut least_residual, mut idle) = (f64::INFINITY, 0);
        let mut residuals = Vec::new();
        self.stable = None;
        self.longest_mm = f64::INFINITY;
        self.evaluate(positions);
        for _ in 0..self.iteration_limit {
            let moving = self.boundary_motion(positions);
            let residual = self.residual(&self.gradient);
            if !residual.is_finite() {
                return Status::Stalled;
            }
            if residual <= self.model.settings.residual_tolerance && !moving {
                if escapes == self.escape_limit || !self.escape(positions) {
                    return Status::Converged;
                }
                escapes += 1;
                continue;
            }
            idle = if residual < LOWER * least_residual {
                0
            } else {
                idle + 1
            };
            least_residual = least_residual.min(residual);
            residuals.push(residual);
            self.crawled = if crawls(&residuals, 1) {
                self.crawled + 1
            } else {
                0
            };
            self.goes_round =
                (self.model.pressure_mpa == 0.0 || self.leaves_rounds) && crawls(&residuals, ROUND);
            let Some(exact) = self.newton_step(positions, residual, moving) else {
                return Status::Stalled;
            };
            self.longest_mm = self.limit_step();
            self.bound_step(positions);
            let strict = goes_in_circles(&residuals) || exact && idle > IDLE_LIMIT;
            let acceptance = match (moving, strict) {
                (true, _) => Acceptance::Any,
                (false, true) => Acceptance::Strict,
                (false, false) => Acceptance::Progress,
            };
            let fraction = self.search(positions, residual, acceptance);
            let iteration = self.made(residual, fraction, exact);
            if log.note(iteration, self.model, positions).is_break() {
                return Status::Interrupted;
            }
            if farthest_mm(positions, self.middle_mm) > self.burst_mm {
                return Status::Burst;
            }
            self.adapt_damping(exact, fraction);
            failures = if fraction == 0.0 { failures + 1 } else { 0 };
            if failures > STALL_LIMIT {
                return Status::Stalled;
            }
        }
        Status::IterationLimit
    }

    /// The iteration that was just made.
    fn made(&self, residual: f64, fraction: f64, exact: bool) -> Iteration {
        Iteration {
            residual,
            step_mm: self.longest_mm,
            damping: self.system.damping,
            fraction,
            exact,
            faces: self.model.faces.len(),
        }
    }

    /// Gathers the pairs in reach and computes the force at a place.
    pub(super) fn evaluate(&mut self, positions: &[Vec3]) {
        self.step.fill(Vec3::zeros());
        if self.model.contact.is_on() {
            let place = place(self.model, &self.surface, positions);
            self.pairs.gather(&place, &self.step, &mut self.near);
        }
        touches_into(&self.near, positions, &mut self.touches);
        load::gradient_into(self.model, &self.touches, positions, &mut self.gradient);
    }

    /// Largest force on a free vertex over the [reference force](load::reference_force_n) [1].
    pub(super) fn residual(&self, gradient: &[Vec3]) -> f64 {
        let free = self.system.free.iter();
        let squared = free.map(|&vertex| gradient[vertex as usize].norm_squared());
        // What is not a number must not get lost.
        let larger = |one: f64, other: f64| if one > other || one.is_nan() { one } else { other };
        let largest_n = squared.fold(0.0, larger).sqrt();
        // No force at all is a balance, even where there is nothing to count it in.
        if largest_n == 0.0 {
            return 0.0;
        }
        largest_n / self.reference_force_n
    }

    /// Bounds the step, vertex by vertex, so that nothing passes through anything; gathers the pairs along it.
    pub(super) fn bound_step(&mut self, positions: &[Vec3]) {
        if !self.model.contact.is_on() {
            return;
        }
        let place = place(self.model, &self.surface, positions);
        let (step, near) = (&mut self.step, &mut self.near);
        bound_steps(&mut self.pairs, &place, step, near, &mut self.allowances);
    }

    /// Goes towards a shape as far as contact lets each vertex, without asking for forces.
    pub(super) fn walk(&mut self, positions: &mut [Vec3], shape: &[Vec3]) {
        for _ in 0..WALK_STEPS {
            for ((step, goal), here) in self.step.iter_mut().zip(shape).zip(&*positions) {
                *step = goal - here;
            }
            self.limit_step();
            self.bound_step(positions);
            advance(positions, &self.step, 1.0);
        }
    }

    /// Finds how prescribed vertices go on towards their targets in this step; false if they are there.
    fn boundary_motion(&mut self, positions: &[Vec3]) -> bool {
        let mut moving = false;
        for prescribed in &self.prescribed {
            let vertex = prescribed.vertex as usize;
            let way = prescribed.target_mm - positions[vertex];
            self.motion[vertex] = clipped(way, self.step_limit_mm);
            moving |= way != Vec3::zeros();
        }
        moving
    }

    /// Finds the step that the tangent suggests, prescribed vertices included; whether it was the exact tangent. Nothing where the
    /// tangent is not of numbers.
    fn newton_step(&mut self, positions: &[Vec3], residual: f64, moving: bool) -> Option<bool> {
        let is_near =
            self.longest_mm < NEAR * self.step_limit_mm && self.damping < UNBRAKED * self.first_damping;
        if residual < EXACT_BELOW || is_near || self.crawled > CRAWL_LIMIT || self.goes_round {
            self.assemble(positions, Curvature::Exact, moving);
            if let Some(damping) = self.factorise_exact() {
                if residual > UNDAMPED_BELOW {
                    self.exact_damping = damping;
                }
                let right = &mut self.right;
                self.system
                    .solve_unsymmetric(positions, self.exact_damping, right, NEWTON_TOLERANCE);
                self.scatter();
                return Some(true);
            }
        }
        self.assemble(positions, Curvature::Projected, moving);
        let last = self.damping;
        while !self.system.factorise(self.damping) {
            self.damping *= 10.0;
            if !self.damping.is_finite() {
                self.damping = last;
                return None;
            }
        }
        self.system.solve(&mut self.right);
        self.scatter();
        Some(false)
    }

    /// Factorises the exact tangent with the first damping that makes it positive definite, from the present one upwards or
    /// from just below what the last tangent needed, which steps without damping do not tell: that damping, if any of those
    /// tried does.
    fn factorise_exact(&mut self) -> Option<f64> {
        let mut damping = self.exact_damping.max(self.factor_damping / DAMPING_RISE);
        for _ in 0..EXACT_TRIES {
            if self.system.factorise(damping) {
                self.factor_damping = damping;
                return Some(damping);
            }
            damping *= DAMPING_RISE;
        }
        // The next iteration goes on from here.
        self.factor_damping = damping;
        None
    }

    fn assemble(&mut self, positions: &[Vec3], curvature: Curvature, moving: bool) {
        self.take_force();
        let moved = moving.then_some(Moved {
            motion_mm: &self.motion,
            right_n: &mut self.right,
        });
        self.system
            .assemble(&self.near, &self.touches, positions, curvature, moved);
    }

    /// Makes the force on the free vertices the right-hand side.
    fn take_force(&mut self) {
        for (right, &vertex) in self.right.iter_mut().zip(&self.system.free) {
            *right = -self.gradient[vertex as usize];
        }
    }

    /// The step over all vertices: the solution at free ones, the motion at prescribed ones.
    fn scatter(&mut self) {
        self.step.copy_from_slice(&self.motion);
        for (&vertex, value) in self.system.free.iter().zip(&self.right) {
            self.step[vertex as usize] = *value;
        }
    }

    /// Shortens over-long steps vertex by vertex; returns the longest that is left [mm].
    fn limit_step(&mut self) -> f64 {
        let mut longest = 0.0_f64;
        for step in &mut self.step {
            *step = clipped(*step, self.step_limit_mm);
            longest = longest.max(step.norm());
        }
        longest
    }

    fn adapt_damping(&mut self, exact: bool, fraction: f64) {
        let (damping, fall) = match exact {
            true => (&mut self.exact_damping, 1.0 / DAMPING_RISE),
            false => (&mut self.damping, 0.5),
        };
        if fraction == 1.0 {
            *damping = (*damping * fall).max(self.least_damping);
        } else if fraction < 0.3 {
            *damping *= if exact { 8.0 } else { 4.0 };
        }
    }
}

/// Whether the least residual of the last `count` steps is hardly less or more than that of as many before.
fn crawls(residuals: &[f64], count: usize) -> bool {
    let Some(before) = residuals.len().checked_sub(2 * count) else {
        return false;
    };
    let (before, after) = residuals[before..].split_at(count);
    let [before, after] = [before, after].map(|part| part.iter().copied().fold(f64::INFINITY, f64::min));
    (CRAWLING * before..GOING_ROUND * before).contains(&after)
}

/// Pressure or, without any, what residuals are counted in over the mean area around a vertex [MPa]; not zero.
///
/// Dampings are parts of it. Far less where there is no pressure, and rounding would look like an unstable balance: chains
/// that went slack kept links compressed by 1e-12 N.
fn load_mpa(model: &Model, surface: &Surface, reference_force_n: f64) -> f64 {
    if model.pressure_mpa > 0.0 {
        return model.pressure_mpa;
    }
    let mean_area_mm2 =
        surface.vertex_area_mm2.iter().sum::<f64>() / model.leaflet_vertex_count.max(1) as f64;
    (reference_force_n / mean_area_mm2).max(1e-12)
}

fn place<'a>(model: &'a Model, surface: &'a Surface, positions: &'a [Vec3]) -> Place<'a> {
    Place {
        surface,
        rest_mm: &model.rest_mm,
        positions_mm: positions,
        thickness_mm: model.contact.thickness_mm,
        rigid_fraction: rigid_fraction(surface, model.contact.thickness_mm),
        kept_fraction: 0.0,
    }
}

pub(super) fn advance(positions: &mut [Vec3], step: &[Vec3], fraction: f64) {
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

/// The middle of all vertices: whichever comes first.
fn middle_mm(positions: &[Vec3]) -> Vec3 {
    positions.iter().sum::<Vec3>() / positions.len().max(1) as f64
}

fn farthest_mm(positions: &[Vec3], from_mm: Vec3) -> f64 {
    let squared = positions
        .iter()
        .map(|position| (position - from_mm).norm_squared());
    squared.fold(0.0, f64::max).sqrt()
}

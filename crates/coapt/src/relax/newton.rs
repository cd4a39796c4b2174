//! Damped Newton iterations that never let anything pass through anything.
//!
//! Each iteration solves (K + μ A) d = −g for the step d: K the tangent, A the area around each vertex, μ a
//! damping that falls while steps succeed and rises when they fail. Every vertex then goes as far along its step
//! as contact allows, and the step is halved until the merit function falls. Near the equilibrium K is the
//! exact tangent and a few products with the true, unsymmetric one sharpen the step.

use super::block_matrix::BlockMatrix;
use super::certificate::certify;
use super::cholesky::{Factor, Symbolic};
use super::krylov;
use super::load::{self, FreeSink, Merit, PRESCRIBED};
use super::{Equilibrium, Iteration, Status, stability};
use crate::Vec3;
use crate::contact::crossing::crossings;
use crate::contact::pairs::{Pair, PairList, largest_distance};
use crate::contact::step_bound;
use crate::contact::surface::Surface;
use crate::energy::{Curvature, pressure};
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
/// Shifts that make the tangent definite are sought in steps of this factor [1].
const SHIFT_RISE: f64 = 2.0;
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
    rim: Vec<[u32; 2]>,
    free: Vec<u32>,
    free_index: Vec<u32>,
    weight_mm2: Vec<f64>,
    matrix: BlockMatrix,
    symbolic: Symbolic,
    reference_force_n: f64,
    step_limit_mm: f64,
    damping: f64,
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
        let (free, free_index) = free_vertices(model);
        let mean_area =
            surface.vertex_area_mm2.iter().sum::<f64>() / model.leaflet_vertex_count.max(1) as f64;
        let weight_mm2 = free
            .iter()
            .map(|&vertex| match surface.vertex_area_mm2[vertex as usize] {
                // Chord nodes have no area of their own.
                0.0 => mean_area,
                area => area,
            })
            .collect();
        let size = bounding_diagonal(&model.rest_mm);
        let edges = &model.springs.rest_length_mm;
        let mean_edge = edges.iter().sum::<f64>() / edges.len().max(1) as f64;
        let mut solver = Self {
            model,
            surface,
            pairs: PairList::default(),
            near: Vec::new(),
            rim: pressure::rim(&model.faces),
            free,
            free_index,
            weight_mm2,
            matrix: BlockMatrix::default(),
            symbolic: Symbolic::default(),
            reference_force_n: load::reference_force_n(model),
            step_limit_mm: (STEP_LIMIT * size).min(STEP_LIMIT_EDGES * mean_edge),
            damping: 0.0,
            least_damping: 0.0,
        };
        // At this damping pressure alone moves a vertex by the step limit.
        solver.damping = model.pressure_mpa.max(1e-12) / solver.step_limit_mm;
        solver.least_damping = LEAST_DAMPING * solver.damping;
        solver
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
                if escapes == ESCAPE_LIMIT || !self.escape(positions, &gradient) {
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
                damping: self.damping,
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
            let right = self.assemble(positions, gradient, motion, Curvature::Exact);
            for _ in 0..EXACT_TRIES {
                if let Some(factor) = self.factorise() {
                    let solution = self.solve_unsymmetric(&factor, positions, &right, NEWTON_TOLERANCE);
                    return (self.scatter(&solution, motion), true);
                }
                self.damping = (self.damping * DAMPING_RISE).max(self.least_damping);
            }
        }
        let right = self.assemble(positions, gradient, motion, Curvature::Projected);
        for _ in 0..40 {
            if let Some(factor) = self.factorise() {
                return (self.scatter(&self.symbolic.solve(&factor, &right), motion), false);
            }
            self.damping *= 10.0;
        }
        (motion.to_vec(), false)
    }

    /// Solves with the true tangent: the factorised symmetric one plus what pressure on the free margin adds.
    fn solve_unsymmetric(
        &self,
        factor: &Factor,
        positions: &[Vec3],
        right: &[Vec3],
        tolerance: f64,
    ) -> Vec<Vec3> {
        let shift = |index: usize| self.damping * self.weight_mm2[index];
        let multiply = |vector: &[Vec3]| {
            let mut product = self.matrix.multiply(vector);
            for (index, (product, value)) in product.iter_mut().zip(vector).enumerate() {
                *product += value * shift(index);
            }
            let direction = self.scatter(vector, &vec![Vec3::zeros(); positions.len()]);
            let mut turned = vec![Vec3::zeros(); positions.len()];
            let pressure = self.model.pressure_mpa;
            pressure::add_antisymmetric_product(&self.rim, pressure, positions, &direction, &mut turned);
            for (product, &vertex) in product.iter_mut().zip(&self.free) {
                *product += turned[vertex as usize];
            }
            product
        };
        krylov::solve(
            multiply,
            |vector| self.symbolic.solve(factor, vector),
            right,
            tolerance,
        )
    }

    fn factorise(&self) -> Option<Factor> {
        let shift: Vec<f64> = self
            .weight_mm2
            .iter()
            .map(|weight| self.damping * weight)
            .collect();
        self.symbolic.factor(&self.matrix, &shift).ok()
    }

    /// Fills the matrix and returns the right-hand side; grows the pattern where contact needs new places.
    fn assemble(
        &mut self,
        positions: &[Vec3],
        gradient: &[Vec3],
        motion: &[Vec3],
        curvature: Curvature,
    ) -> Vec<Vec3> {
        loop {
            let mut right: Vec<Vec3> = self
                .free
                .iter()
                .map(|&vertex| -gradient[vertex as usize])
                .collect();
            let mut complete = self.matrix.column_starts.len() > 1 || self.free.is_empty();
            if complete {
                self.matrix.clear();
                let matrix = &mut self.matrix;
                let mut sink = FreeSink {
                    free_index: &self.free_index,
                    motion_mm: motion,
                    right_n: &mut right,
                    matrix: |row, column, block: &crate::Mat3| complete &= matrix.add(row, column, block),
                };
                load::add_tangent(self.model, &self.near, positions, curvature, &mut sink);
            }
            if complete {
                return right;
            }
            self.grow_pattern(positions);
        }
    }

    fn grow_pattern(&mut self, positions: &[Vec3]) {
        let mut places = load::tangent_places(self.model);
        for pair in &self.near {
            // A little beyond the activation distance, so that the pattern lasts for some steps.
            if pair.nearest(positions).separation_mm.norm() < 1.2 * pair.activation_mm {
                let v = pair.vertices;
                for i in 0..4 {
                    places.extend((i + 1..4).map(|j| [v[i], v[j]]));
                }
            }
        }
        let free = |place: [u32; 2]| {
            let [i, j] = place.map(|vertex| self.free_index[vertex as usize]);
            (i != PRESCRIBED && j != PRESCRIBED).then_some([i, j])
        };
        let places = places.into_iter().filter_map(free).collect();
        self.matrix = BlockMatrix::with_pattern(self.free.len(), places);
        self.symbolic = Symbolic::new(&self.matrix);
    }

    fn scatter(&self, solution: &[Vec3], motion: &[Vec3]) -> Vec<Vec3> {
        let mut step = motion.to_vec();
        for (&vertex, value) in self.free.iter().zip(solution) {
            step[vertex as usize] = *value;
        }
        step
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
            self.damping = (self.damping * 0.5).max(self.least_damping);
        } else if fraction < 0.3 {
            self.damping *= 4.0;
        }
    }

    fn finish(mut self, positions: Vec<Vec3>, status: Status, history: Vec<Iteration>) -> Equilibrium {
        self.cover(&positions, 0.0);
        self.near = self.pairs.touching(&positions, &positions);
        let gradient = load::gradient(self.model, &self.near, &positions);
        let residual = self.residual(&gradient);
        let stable = self.is_stable(&positions, &gradient);
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
    fn is_stable(&mut self, positions: &[Vec3], gradient: &[Vec3]) -> bool {
        if self.free.is_empty() {
            return true;
        }
        let Some(factor) = self.factorise_shifted(positions, gradient) else {
            return false;
        };
        if self.damping == self.least_damping {
            return true;
        }
        let solve = |right: &[Vec3]| self.solve_unsymmetric(&factor, positions, right, EIGEN_TOLERANCE);
        let start = (0..self.free.len()).map(pseudo_random).collect();
        stability::least_real_part(solve, &self.weight_mm2, self.damping, start) > 0.0
    }

    /// The exact tangent, factorised with the least damping that makes its symmetric part positive definite; that
    /// damping stays set. Slack chord nodes have no stiffness at all: the least damping, far below any tissue's,
    /// keeps them from counting.
    fn factorise_shifted(&mut self, positions: &[Vec3], gradient: &[Vec3]) -> Option<Factor> {
        self.assemble(
            positions,
            gradient,
            &vec![Vec3::zeros(); positions.len()],
            Curvature::Exact,
        );
        self.damping = self.least_damping;
        (0..60).find_map(|_| {
            let factor = self.factorise();
            if factor.is_none() {
                self.damping *= SHIFT_RISE;
            }
            factor
        })
    }

    /// Leaves a balance of forces that the slightest push would upset: moves a little along the direction in
    /// which the tangent is most negative. False where there is no such direction.
    fn escape(&mut self, positions: &mut [Vec3], gradient: &[Vec3]) -> bool {
        if self.is_stable(positions, gradient) {
            return false;
        }
        let Some(factor) = self.factorise_shifted(positions, gradient) else {
            return false;
        };
        let mut direction: Vec<Vec3> = (0..self.free.len()).map(pseudo_random).collect();
        for _ in 0..INVERSE_ITERATIONS {
            direction = self.symbolic.solve(&factor, &direction);
            let longest = direction.iter().map(|x| x.norm()).fold(0.0, f64::max);
            direction.iter_mut().for_each(|x| *x /= longest);
        }
        let curvature: f64 = direction
            .iter()
            .zip(self.matrix.multiply(&direction))
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
            let mut step = self.scatter(&along, &vec![Vec3::zeros(); positions.len()]);
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

fn free_vertices(model: &Model) -> (Vec<u32>, Vec<u32>) {
    let mut free_index = vec![0; model.rest_mm.len()];
    for prescribed in &model.prescribed {
        free_index[prescribed.vertex as usize] = PRESCRIBED;
    }
    let mut free = Vec::new();
    for (vertex, index) in free_index.iter_mut().enumerate() {
        if *index != PRESCRIBED {
            *index = free.len() as u32;
            free.push(vertex as u32);
        }
    }
    (free, free_index)
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

fn bounding_diagonal(positions: &[Vec3]) -> f64 {
    let Some(first) = positions.first() else {
        return 1.0;
    };
    2.0 * largest_distance(positions, &vec![*first; positions.len()]) / 2.0_f64.sqrt()
}

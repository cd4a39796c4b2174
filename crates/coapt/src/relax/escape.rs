//! Balances of forces that do not last: finding out, and leaving them.

use super::load::Merit;
use super::newton::{Newton, advance};
use super::stability;
use crate::Vec3;
use crate::contact::touch::touches;
use crate::energy::Curvature;

/// Shifts that make the tangent definite are sought in steps of this factor [1].
const SHIFT_RISE: f64 = 2.0;
/// How far it then pushes, as a part of the longest step [1].
const ESCAPE_STEP: f64 = 0.25;
/// Inverse iterations that find the direction; a rough one will do.
const INVERSE_ITERATIONS: u32 = 8;

impl Newton<'_> {
    /// Whether the valve stays where it is when pushed a little; where that cannot be found out it does not count as staying.
    pub(super) fn is_stable(&mut self, positions: &[Vec3]) -> bool {
        self.stability(positions).unwrap_or(false)
    }

    /// The same, see [`super::stability`]; nothing where the tangent is not of numbers. Else it is left factorised with the first of some
    /// rising dampings that makes its symmetric part positive definite.
    fn stability(&mut self, positions: &[Vec3]) -> Option<bool> {
        if self.system.free.is_empty() {
            return Some(true);
        }
        self.system
            .assemble(&self.near, &self.touches, positions, Curvature::Exact, None);
        // Slack chord nodes have no stiffness at all: the least damping, far below any tissue's, keeps them from
        // counting.
        if self.system.factorise(self.least_damping) {
            return Some(true);
        }
        let shift = self.factorise_with_least_shift()?;
        // Eigenvalues of zero stand in the way of others, and take no part: K + σM keeps the weight of what has them.
        let mut weight_mm2 = self.system.weight_mm2.clone();
        for (weight, stiffness) in weight_mm2.iter_mut().zip(self.system.own_stiffness()) {
            if stiffness <= self.least_damping * *weight {
                *weight = 0.0;
            }
        }
        let system = &mut self.system;
        let solve = |right: &mut [Vec3]| {
            let effort = system.solve_unsymmetric(positions, system.damping, right, stability::TOLERANCE);
            effort.left <= stability::TOLERANCE
        };
        let start = (0..weight_mm2.len()).map(pseudo_random).collect();
        // What has hardly any stiffness has eigenvalues of zero, less what the solution leaves of the shift.
        let zero = self.least_damping + stability::TOLERANCE * shift;
        let least = stability::least_real_part(solve, &weight_mm2, shift, start);
        Some(least.is_some_and(|least| least > -zero))
    }

    /// Factorises the tangent with the first of some rising dampings, from twice the least one, that makes its symmetric part positive
    /// definite; nothing where none does, the tangent not being of numbers. It is sought from where the last steps found it, upwards or
    /// downwards.
    fn factorise_with_least_shift(&mut self) -> Option<f64> {
        let first = SHIFT_RISE * self.least_damping;
        let rises = (self.factor_damping / first).log(SHIFT_RISE).ceil().max(0.0);
        let mut shift = first * SHIFT_RISE.powf(rises);
        while shift > first && self.system.factorise(shift / SHIFT_RISE) {
            shift /= SHIFT_RISE;
        }
        while !self.system.factorise(shift) {
            shift *= SHIFT_RISE;
            if !shift.is_finite() {
                return None;
            }
        }
        Some(shift)
    }

    /// Leaves a balance of forces that the slightest push would upset: moves a little along the direction in
    /// which the tangent is most negative. False where there is no such direction; then it notes whether the balance lasts.
    pub(super) fn escape(&mut self, positions: &mut Vec<Vec3>) -> bool {
        let stability = self.stability(positions);
        self.stable = Some(stability == Some(true));
        if stability != Some(false) {
            return false;
        }
        let mut direction: Vec<Vec3> = (0..self.system.free.len()).map(pseudo_random).collect();
        for _ in 0..INVERSE_ITERATIONS {
            self.system.solve(&mut direction);
            let longest = direction.iter().map(|x| x.norm()).fold(0.0, f64::max);
            direction.iter_mut().for_each(|x| *x /= longest);
        }
        let leads_away = self.system.curvature(&direction, &mut self.right) < 0.0;
        if !leads_away {
            return false;
        }
        let merit = Merit::new(self.model, positions);
        let ways = [1.0, -1.0].map(|way| self.pushed(positions, &direction, way, &merit));
        let [(there, end_there), (back, end_back)] = ways;
        *positions = if there <= back { end_there } else { end_back };
        self.stable = None;
        self.evaluate(positions);
        true
    }

    /// Where a push along a direction leads, and the merit there.
    fn pushed(
        &mut self,
        positions: &[Vec3],
        direction: &[Vec3],
        way: f64,
        merit: &Merit,
    ) -> (f64, Vec<Vec3>) {
        let push = way * ESCAPE_STEP * self.step_limit_mm;
        self.step.fill(Vec3::zeros());
        for (&vertex, value) in self.system.free.iter().zip(direction) {
            self.step[vertex as usize] = value * push;
        }
        self.bound_step(positions);
        let mut end = positions.to_vec();
        advance(&mut end, &self.step, 1.0);
        (merit.value(self.model, &touches(&self.near, &end), &end), end)
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

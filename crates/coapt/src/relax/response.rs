//! How a closed shape answers to a small change of its model, without closing it again.
//!
//! At a balance f(x, p) = 0 for every p, so that K dx/dp = ∂f/∂p with f the force on the free vertices, K = −∂f/∂x the true
//! tangent there, and prescribed vertices moving as their targets do. One factorisation gives the rate of every vertex with any
//! number of parameters. Where a chord becomes taut, a pair comes to touch or a spring passes its knee, rates jump, and a finite
//! change sees the mean of both sides.

use super::elastic::Moved;
use super::newton::Newton;
use super::{Status, load};
use crate::Vec3;
use crate::energy::{Curvature, pressure};
use crate::model::Model;
use crate::relax::Equilibrium;
use crate::scene::Fault;

/// Error of the rates, as a part of their size in the norm of forces [1]: far below what a finite difference can show.
const TOLERANCE: f64 = 1e-8;
/// Chordae with less tension than this many times the largest force left on a vertex count as slack [1], our choice.
const SLACK_TOLERANCES: f64 = 10.0;
/// Solutions begin anew this often at most; presets need one or two beginnings.
const RESTARTS: usize = 20;

/// Two models on either side of the one that was closed, which differ in one parameter.
#[derive(Clone, Copy, Debug)]
pub struct Change<'a> {
    /// The model with half the width less of the parameter.
    pub less: &'a Model,
    /// The model with half the width more.
    pub more: &'a Model,
    /// The difference of the parameter between the two, in its unit. A millionth of its size is right: by a thousandth, chordae
    /// that are barely taut would go slack.
    pub width: f64,
}

/// A closed valve whose tangent is factorised.
pub struct Response<'a> {
    newton: Newton<'a>,
    positions_mm: &'a [Vec3],
}

impl<'a> Response<'a> {
    /// Factorises the tangent of a closed valve.
    ///
    /// # Errors
    /// A closure that did not converge, or whose shape is not stable: it would not follow a change smoothly.
    pub fn new(model: &'a Model, closed: &'a Equilibrium) -> Result<Self, Fault> {
        let positions_mm = &closed.state.positions_mm;
        let mut newton = Newton::new(model);
        newton.evaluate(positions_mm);
        // Whether it is stable is found with the factorisation that rates need.
        if closed.status != Status::Converged || !newton.is_stable(positions_mm) {
            let message = "is not in a stable balance; expected one, which alone follows a small change";
            return Err(Fault::error("closure", message));
        }
        Ok(Self { newton, positions_mm })
    }

    /// How fast every vertex moves with the parameter [mm per unit of it], shape `[vertex]`.
    ///
    /// # Errors
    /// Models of another number of vertices or chordae, with other faces, other vertices prescribed or contact of another thickness;
    /// rates that the solver does not find.
    pub fn shape_rate(&mut self, change: &Change) -> Result<Vec<Vec3>, Fault> {
        self.check(change)?;
        let positions = self.positions_mm;
        let mut rate = vec![Vec3::zeros(); positions.len()];
        for (less, more) in change.less.prescribed.iter().zip(&change.more.prescribed) {
            rate[less.vertex as usize] = (more.target_mm - less.target_mm) / change.width;
        }
        let force_rate = self.force_rate(change, &rate);
        let newton = &mut self.newton;
        let free = newton.system.free.clone();
        let mut right: Vec<Vec3> = free.iter().map(|&vertex| force_rate[vertex as usize]).collect();
        let moved = Moved {
            motion_mm: &rate,
            right_n: &mut right,
        };
        newton.system.assemble(
            &newton.near,
            &newton.touches,
            positions,
            Curvature::Exact,
            Some(moved),
        );
        let solution = self.solve(right)?;
        for (&vertex, value) in free.iter().zip(&solution) {
            rate[vertex as usize] = *value;
        }
        Ok(rate)
    }

    /// How the force on every vertex would change were the free ones to stay [N per unit], shape `[vertex]`; but for the symmetric
    /// tangent times the motion of the supports, which the assembly takes in.
    fn force_rate(&self, change: &Change, support_rate_mm: &[Vec3]) -> Vec<Vec3> {
        let (model, positions) = (self.newton.model, self.positions_mm);
        let slack = self.slack_chords();
        let gradient = |model: &Model| {
            let mut gradient = vec![Vec3::zeros(); positions.len()];
            load::gradient_into(
                &without(model, &slack),
                &self.newton.touches,
                positions,
                &mut gradient,
            );
            gradient
        };
        let mut turned = vec![Vec3::zeros(); positions.len()];
        let rim = pressure::rim(&model.faces);
        pressure::add_antisymmetric_product(
            &rim,
            model.pressure_mpa,
            positions,
            support_rate_mm,
            &mut turned,
        );
        let gradients = gradient(change.less).into_iter().zip(gradient(change.more));
        let forces = gradients.map(|(less, more)| (less - more) / change.width);
        forces.zip(turned).map(|(force, turned)| force - turned).collect()
    }

    /// Chordae that carry nothing. A branching between such ones came to rest just where they went slack: a change would pull at
    /// it, with no stiffness to answer, while in truth it gives way.
    fn slack_chords(&self) -> Vec<usize> {
        let model = self.newton.model;
        let least_n = SLACK_TOLERANCES * model.settings.residual_tolerance * load::reference_force_n(model);
        let tensions_n = model.chords.tensions_n(self.positions_mm);
        (0..tensions_n.len())
            .filter(|&chord| tensions_n[chord] <= least_n)
            .collect()
    }

    /// Solves with the true tangent, until what is left is [`TOLERANCE`] of the right-hand side.
    fn solve(&mut self, right: Vec<Vec3>) -> Result<Vec<Vec3>, Fault> {
        let system = &mut self.newton.system;
        let norm = |vector: &[Vec3]| vector.iter().map(Vec3::norm_squared).sum::<f64>().sqrt();
        let wanted = TOLERANCE * norm(&right);
        let (mut left, mut product) = (right.clone(), right.clone());
        let mut solution = vec![Vec3::zeros(); right.len()];
        for _ in 0..RESTARTS {
            if norm(&left) <= wanted {
                break;
            }
            system.solve_unsymmetric(self.positions_mm, 0.0, &mut left, TOLERANCE);
            solution
                .iter_mut()
                .zip(&left)
                .for_each(|(sum, step)| *sum += step);
            system.multiply_unsymmetric(self.positions_mm, &solution, &mut product);
            for ((left, right), product) in left.iter_mut().zip(&right).zip(&product) {
                *left = right - product;
            }
        }
        if norm(&left) <= wanted {
            return Ok(solution);
        }
        let message = format!(
            "leaves {:.0e} of the change unbalanced, expected {TOLERANCE:.0e}",
            norm(&left) / norm(&right)
        );
        Err(Fault::error("rates", message))
    }

    fn check(&self, change: &Change) -> Result<(), Fault> {
        let here = self.newton.model;
        let held = |model: &Model| {
            model
                .prescribed
                .iter()
                .map(|held| held.vertex)
                .collect::<Vec<_>>()
        };
        for model in [change.less, change.more] {
            let same = |kept: bool, what: &str| match kept {
                true => Ok(()),
                false => Err(Fault::error(
                    "parameter",
                    format!("changes {what}; rates are those of a valve that keeps that"),
                )),
            };
            let vertices = model.rest_mm.len() == here.rest_mm.len() && held(model) == held(here);
            same(vertices, "which vertices there are or which are held")?;
            same(model.faces == here.faces, "the triangles")?;
            same(
                model.chords.ends.len() == here.chords.ends.len(),
                "how many chordae there are",
            )?;
            // Where pairs begin to touch is that of the closed valve.
            let thickness_mm = [model, here].map(|model| model.contact.thickness_mm);
            same(thickness_mm[0] == thickness_mm[1], "the thickness of contact")?;
        }
        if !(change.width > 0.0 && change.width.is_finite()) {
            let message = format!("is {}; expected a positive number", change.width);
            return Err(Fault::error("width", message));
        }
        Ok(())
    }
}

/// The same model with some chordae so thin that they carry nothing.
fn without(model: &Model, chords: &[usize]) -> Model {
    let mut model = model.clone();
    chords
        .iter()
        .for_each(|&chord| model.chords.area_mm2[chord] = 0.0);
    model
}

//! A closure by explicit time steps, as mass-spring valves have been closed before (paper 003): what the solver's speed
//! is measured against. It has no certificate and nothing keeps leaflets from passing through each other.
//!
//! Forces, pair lists and tolerance are those of the library, so that a ratio of times compares the two ways to
//! equilibrium and nothing else. The time integration is as good as a simple one gets:
//!
//! * semi-implicit Euler steps with FIRE damping (Bitzek et al. 2006, Guénolé et al. 2020). Kinetic damping came to
//!   rest only below half the limit of stability, and then took a third to twice as many steps more;
//! * a mass for each vertex that puts it at the limit of stability at a time step of 1 (only the equilibrium matters),
//!   refreshed as springs stiffen and contacts come and go;
//! * pairs are listed anew only when a vertex has moved by more than the list allows for, as the solver does it when its
//!   steps have become short.

use coapt::contact::crossing::crossings;
use coapt::contact::gather::PairList;
use coapt::contact::pairs::Pair;
use coapt::contact::surface::Surface;
use coapt::contact::touch::{Touch, touches_into};
use coapt::energy::Curvature;
use coapt::model::Model;
use coapt::relax::load;
use coapt::state::State;
use coapt::{Mat3, Vec3};

use crate::place;

/// How an explicit closure ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Explicit {
    /// Where it ended.
    pub state: State,
    /// Time steps, each with one evaluation of all forces.
    pub steps: u32,
    /// Largest force left on a free vertex over the reference force [1], as the library defines it.
    pub residual: f64,
    /// Edges that pass through faces.
    pub crossings: usize,
}

/// Steps until masses are computed anew. Every step is no steadier and costs as much again as the forces; every thirty,
/// springs pass their transition between and are too stiff for the masses at their ends: half as many steps more.
const REFRESH: u32 = 10;
/// Largest time step, as a part of the limit of stability [1]. Five presets take the fewest steps in all between 0.6
/// and 0.7; at 0.9, contacts that stiffen between two refreshes shake twice as long.
const LARGEST_STEP: f64 = 0.7;
/// First time step [1].
const FIRST_STEP: f64 = 0.1;
/// No vertex moves farther in a step than this [mm]. Half or twice as far took no fewer steps; much farther, leaflets
/// could pass through each other where they first meet.
const FARTHEST_MM: f64 = 0.1;
/// Prescribed vertices go to their targets in steps of this length [mm].
const FARTHEST_HELD_MM: f64 = 0.1;

/// FIRE: steps with positive power before the time step grows, growth, decay, first share of steering, its decay.
const PATIENCE: u32 = 5;
const GROWTH: f64 = 1.1;
const DECAY: f64 = 0.5;
const STEERING: f64 = 0.1;
const STEERING_DECAY: f64 = 0.99;

/// Residual at which the baseline is taken to be closed [1]: positions are then good to some hundredths of a
/// millimetre.
pub const TOLERANCE: f64 = 1e-3;
/// Steps after which it gives up: eight times what the slowest of the five presets takes.
pub const STEP_LIMIT: u32 = 30_000;

/// Closes a valve until the residual is below a tolerance, or for so many steps.
pub fn close_explicitly(model: &Model, start: &State, tolerance: f64, step_limit: u32) -> Explicit {
    let surface = Surface::new(&model.faces, &model.rest_mm);
    let mut run = Run::new(model, &surface, start);
    let mut steps = 0;
    let mut residual = f64::INFINITY;
    while steps < step_limit {
        steps += 1;
        let held = run.move_held();
        run.evaluate();
        residual = run.residual();
        if residual <= tolerance && !held {
            break;
        }
        if steps % REFRESH == 1 {
            run.refresh_masses();
        }
        run.step();
    }
    Explicit {
        steps,
        residual,
        crossings: crossings(&surface, &run.positions_mm).len(),
        state: State {
            positions_mm: run.positions_mm,
        },
    }
}

/// Stops the bench if the baseline did not come to rest, or leaflets passed through each other: then it is no measure of anything.
///
/// # Panics
/// If so.
pub fn assert_closed(explicit: &Explicit) {
    let Explicit {
        residual, crossings, ..
    } = explicit;
    assert!(
        *residual <= TOLERANCE && *crossings == 0,
        "not in balance: residual {residual:e}, {crossings} crossings"
    );
}

struct Run<'a> {
    model: &'a Model,
    surface: &'a Surface,
    list: PairList,
    /// The pairs that may touch where the valve now is.
    near: Vec<Pair>,
    touches: Vec<Touch>,
    /// Minus the force on each vertex there [N].
    gradient: Vec<Vec3>,
    /// No step: pairs are asked for at a place.
    at_rest: Vec<Vec3>,
    /// Free vertices.
    free: Vec<usize>,
    positions_mm: Vec<Vec3>,
    /// Velocity, with time in units of the limit of stability [mm].
    velocity_mm: Vec<Vec3>,
    /// Mass in the same units [N/mm].
    mass: Vec<f64>,
    time_step: f64,
    steering: f64,
    downhill: u32,
    reference_force_n: f64,
}

impl<'a> Run<'a> {
    fn new(model: &'a Model, surface: &'a Surface, start: &State) -> Self {
        let count = start.positions_mm.len();
        let held = |vertex: &usize| {
            model
                .prescribed
                .iter()
                .any(|held| held.vertex as usize == *vertex)
        };
        Self {
            model,
            surface,
            list: PairList::default(),
            near: Vec::new(),
            touches: Vec::new(),
            gradient: vec![Vec3::zeros(); count],
            at_rest: vec![Vec3::zeros(); count],
            free: (0..count).filter(|vertex| !held(vertex)).collect(),
            positions_mm: start.positions_mm.clone(),
            velocity_mm: vec![Vec3::zeros(); count],
            mass: Vec::new(),
            time_step: FIRST_STEP,
            steering: STEERING,
            downhill: 0,
            reference_force_n: load::reference_force_n(model),
        }
    }

    /// Moves prescribed vertices on towards their targets; whether any is still on its way.
    fn move_held(&mut self) -> bool {
        let mut moved = false;
        for prescribed in &self.model.prescribed {
            let place = &mut self.positions_mm[prescribed.vertex as usize];
            let way = prescribed.target_mm - *place;
            moved |= way != Vec3::zeros();
            *place += way.cap_magnitude(FARTHEST_HELD_MM);
            if way.norm() <= FARTHEST_HELD_MM {
                *place = prescribed.target_mm;
            }
        }
        moved
    }

    /// Gathers the pairs in reach and computes the forces.
    fn evaluate(&mut self) {
        let place = place(self.model, self.surface, &self.positions_mm);
        self.list.gather(&place, &self.at_rest, &mut self.near);
        touches_into(&self.near, &self.positions_mm, &mut self.touches);
        load::gradient_into(self.model, &self.touches, &self.positions_mm, &mut self.gradient);
    }

    fn residual(&self) -> f64 {
        let forces = self.free.iter().map(|&vertex| self.gradient[vertex].norm());
        // What is not a number must not get lost, as it does in `f64::max`.
        let larger = |one: f64, other: f64| if one > other || one.is_nan() { one } else { other };
        forces.fold(0.0, larger) / self.reference_force_n
    }

    /// A quarter of the sum of stiffnesses in each row of the tangent: by Gershgorin's theorem no frequency is then
    /// above 2, the limit at a time step of 1. Vertices without stiffness, on slack chords, get a tenth of the mean.
    fn refresh_masses(&mut self) {
        let mut rows = vec![0.0; self.positions_mm.len()];
        let mut add = |row: u32, column: u32, block: &Mat3| {
            let stiffness = block.norm();
            rows[row as usize] += stiffness;
            if row != column {
                rows[column as usize] += stiffness;
            }
        };
        let (model, positions_mm) = (self.model, &self.positions_mm);
        load::add_elastic_tangent(model, positions_mm, Curvature::Projected, &mut add);
        load::add_contact_tangent(model, &self.touches, positions_mm, Curvature::Projected, &mut add);
        let least = 0.1 * rows.iter().sum::<f64>() / rows.len() as f64;
        self.mass = rows.iter().map(|row| 0.25 * row.max(least)).collect();
    }

    /// One step of FIRE.
    fn step(&mut self) {
        let (mut power, mut speed, mut force) = (0.0, 0.0, 0.0);
        for &vertex in &self.free {
            let (v, g, mass) = (self.velocity_mm[vertex], self.gradient[vertex], self.mass[vertex]);
            power -= v.dot(&g);
            speed += v.norm_squared() * mass;
            force += g.norm_squared() / mass;
        }
        self.adapt(power);
        // With the velocities of a step uphill, steering goes as well.
        let speed = if power < 0.0 { 0.0 } else { speed };
        let turn = self.steering * (speed / force.max(f64::MIN_POSITIVE)).sqrt();
        for &vertex in &self.free {
            let velocity = &mut self.velocity_mm[vertex];
            *velocity *= 1.0 - self.steering;
            *velocity -= self.gradient[vertex] * ((turn + self.time_step) / self.mass[vertex]);
            *velocity = velocity.cap_magnitude(FARTHEST_MM / self.time_step);
            self.positions_mm[vertex] += *velocity * self.time_step;
        }
    }

    /// Longer steps and less steering while the valve moves downhill, a halt and shorter steps where it does not.
    fn adapt(&mut self, power: f64) {
        if power < 0.0 {
            self.downhill = 0;
            self.time_step *= DECAY;
            self.steering = STEERING;
            self.velocity_mm.fill(Vec3::zeros());
            return;
        }
        self.downhill += 1;
        if self.downhill > PATIENCE {
            self.time_step = (self.time_step * GROWTH).min(LARGEST_STEP);
            self.steering *= STEERING_DECAY;
        }
    }
}

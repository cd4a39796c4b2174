//! A closing valve, frame by frame: the balances under pressures from none to all of it.
//!
//! It is quasi-static, a row of shapes in each of which forces balance, and tells nothing of time: blood and tissue have no mass
//! here. Annulus and papillary tips stand where they are in systole in every frame, and a ring is sewn on. The first frame is
//! thus the balance without pressure, not the open valve of the scene: where supports have moved or chordae are taut it lies up
//! to some millimetres elsewhere (dilated preset: 6.4 mm; healthy: 1.2 mm).
//!
//! The film is made backwards, by unloading the closed valve, and shown forwards. Where several shapes are stable a ramp upwards
//! may end in another one than the closure that was reported, which began at the open valve under full pressure; the film would
//! then end in a jump that no pressure makes. Measured on the five presets (650 triangles, 60 frames), as they are and under a
//! ring of 32 mm, distances those of the leaflet vertex that is farthest off:
//!
//! | | upwards | backwards |
//! |---|---|---|
//! | distance of its last frame from the closure | none in six, 0.5, 0.6, 1.1 and 5.5 mm | none, it is where it begins |
//! | distance of its first frame from the balance of the open valve without pressure | none, it is where it begins | below 1e-4 mm in all |
//! | frames that do not converge | 7 of 600 | 0 of 600 |
//! | iterations, all ten | 10,703 | 5,632 |
//!
//! Frames may still be far apart: a leaflet that snaps under a growing pressure passes from one balance to another, and there is
//! none between them.

use std::ops::ControlFlow;

use crate::Vec3;
use crate::model::Model;
use crate::relax::{Equilibrium, Moment, PATIENCE, Status, relax_watched};
use crate::state::State;

/// Frames of a film unless somebody asks for others. Our choice: two seconds at thirty a second.
pub const FRAMES: usize = 60;

/// Pressure of a frame is that of the closed valve times the third power of its place in the film, from 0 to 1.
///
/// Our choice: most of the way is made under a few mmHg, and motion is to be spread evenly over the frames. With the first power 9
/// to 46 % of it fall between the first two of 60. The measure was (Σ m)² / (n Σ m²) of the largest motion m of a vertex in each of
/// the n frames, but for the four largest, which are snaps; it is 1 where all are equal. Mean of the ten valves: 0.55 with power
/// 2, 0.59 with 2.5 and with 3, 0.57 with 4.
const PRESSURE_EXPONENT: i32 = 3;

/// A valve closing.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// From the one without pressure to the closed valve. A film that its watcher stopped has the last frames only, those that were
    /// found by then, and the first of these is [`Status::Interrupted`].
    pub frames: Vec<Frame>,
    /// How far the leaflet vertex is that lies farthest from where the open valve comes to rest without pressure, in the first
    /// frame [mm]: large where several shapes are stable and the valve does not open as it is drawn. None where that balance was not found.
    pub open_gap_mm: Option<f64>,
}

/// One balance.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Transvalvular pressure [MPa].
    pub pressure_mpa: f64,
    /// Where the valve came to rest under it. Not converging is a status here as everywhere.
    pub equilibrium: Equilibrium,
}

impl Frame {
    /// Whether the frame may be shown as a balance: converged, stable, nothing crosses.
    pub fn is_certified(&self) -> bool {
        self.equilibrium.certificate.is_certified(self.equilibrium.status)
    }
}

/// Films how a valve closes, in so many frames, two at least; the last is `closed` itself, bit for bit.
pub fn film(model: &Model, closed: &Equilibrium, frames: usize) -> Film {
    film_watched(model, closed, frames, |_| ControlFlow::Continue(()))
}

/// The same with somebody looking on, as in [`relax_watched`]; a film of 60 frames takes some ten times as long as the closure.
pub fn film_watched(
    model: &Model,
    closed: &Equilibrium,
    frames: usize,
    mut watch: impl FnMut(&Moment) -> ControlFlow<()>,
) -> Film {
    let last = frames.max(2) - 1;
    let mut backwards = vec![Frame {
        pressure_mpa: model.pressure_mpa,
        equilibrium: closed.clone(),
    }];
    for number in (0..last).rev() {
        let after = &backwards[backwards.len() - 1].equilibrium;
        if after.status == Status::Interrupted {
            break;
        }
        let lighter = under(model, number as f64 / last as f64);
        let equilibrium = relax_watched(&lighter, &after.state, &mut watch);
        backwards.push(Frame {
            pressure_mpa: lighter.pressure_mpa,
            equilibrium,
        });
    }
    backwards.reverse();
    let open_gap_mm = open_gap_mm(model, &backwards[0], &mut watch);
    Film {
        frames: backwards,
        open_gap_mm,
    }
}

/// The valve under the pressure of a place in the film. No frame begins anew at the open valve: it belongs to its neighbours.
fn under(model: &Model, place: f64) -> Model {
    let mut lighter = model.clone();
    lighter.pressure_mpa *= place.powi(PRESSURE_EXPONENT);
    lighter.settings.iteration_limit = model.settings.iteration_limit.min(PATIENCE);
    lighter
}

fn open_gap_mm(
    model: &Model,
    first: &Frame,
    watch: &mut impl FnMut(&Moment) -> ControlFlow<()>,
) -> Option<f64> {
    if !first.is_certified() {
        return None;
    }
    let unloaded = under(model, 0.0);
    let open = relax_watched(&unloaded, &State::open(model), watch);
    let found = open.certificate.is_certified(open.status);
    found.then(|| farthest_mm(model, &first.equilibrium.state, &open.state))
}

/// Of leaflet vertices: where slack chordae branch says nothing.
fn farthest_mm(model: &Model, one: &State, other: &State) -> f64 {
    let pairs = one.positions_mm.iter().zip(&other.positions_mm);
    let distance = |(here, there): (&Vec3, &Vec3)| (here - there).norm();
    pairs
        .take(model.leaflet_vertex_count)
        .map(distance)
        .fold(0.0, f64::max)
}

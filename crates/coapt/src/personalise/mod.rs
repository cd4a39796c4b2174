//! A valve made to a patient's measure: how long its chordae must be for it to close to a shape that was imaged.
//!
//! Imaging hardly shows chordae, and no other unknown decides as much about the closed shape. Paper 002 multiplies
//! nominal lengths by one factor and takes the one with the least error of the closed shape. So does this, with one factor
//! for all chordae or one for each of their groups, and tells how well the target decides each factor.
//!
//! **Which distance.** From each target point to the nearest place of the model's surface, with a sign: positive on the
//! atrial side. From target points, because an image shows what it shows: tissue of the model that nobody saw must not count.
//! With a sign, because scatter then averages out; distances without one are never less than what scatter makes them. These
//! distances are nearly linear in the factor for all chordae, some 10 mm per unit from 0.7 to 1.45 in all presets, so that
//! least squares need few closures. Large ones count less (Huber), for a closed state may differ in a fold.
//!
//! **Which points.** All that are given. Below the line of closure hardly anything decides where leaflets hang, but to leave
//! out what the model hides is worse: at the border of what is visible, points that scatter upwards stay and those that
//! scatter downwards go, and factors come out 0.4 to 1.2 % too large. A target that ends at the line of closure does as well as
//! a whole one.
//!
//! **Search.** One factor for all is tried over the whole range first, in closures from the open valve that run side by
//! side: there might be several minima, and far from the answer chordae may be slack and change nothing. From the best,
//! Gauss-Newton with sensitivities by regression over closures nearby. Those begin where the last one ended,
//! which takes a third of the iterations of a closure from the open valve; where the search stands is always such a closure,
//! as anybody will make who closes the valve that is found. [`crate::relax::Interactive`] would save its set-up, which is
//! less than the noise of timing (12 to 55 ms in both ways).
//!
//! The error after a fit says how well the model can be made to look like the target, not how well it predicts: both errors
//! are always told.

mod closures;
mod fit;
mod misfit;
mod parameters;
mod regression;

use std::ops::ControlFlow;

use serde::{Deserialize, Serialize};

use crate::Vec3;
use crate::model::{ChordKind, Model};
use crate::relax::{Equilibrium, Moment};
use crate::repair::{self, Repaired};
use crate::scene::{Fault, Readable, Repair, Ring};

pub use misfit::TargetDistance;

/// A closed valve as imaged or computed elsewhere, in the frame of the model and with its annulus where the model's is when
/// closed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Target {
    /// Points of the leaflets' closed mid-surface [mm], shape `[point]`: a part of it will do. Each counts the same.
    pub points_mm: Vec<Vec3>,
}

/// What is fitted, and within which limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitSettings {
    /// One factor for each group of chordae instead of one for all.
    pub per_group: bool,
    /// Least and largest factor [1].
    pub scale_range: [f64; 2],
    /// Steps of each search at most.
    pub iteration_limit: u32,
}

impl Default for FitSettings {
    fn default() -> Self {
        // Elongated chordae reach 1.4 times, rheumatic ones 0.7 times the usual length. One factor takes two or three steps,
        // one for each group up to a dozen.
        Self {
            per_group: false,
            scale_range: [0.7, 1.5],
            iteration_limit: 20,
        }
    }
}

/// Chordae fitted to a target.
#[derive(Clone, Debug)]
pub struct ChordFit {
    /// Whether there is a result, and which doubts it leaves.
    pub status: FitStatus,
    /// The factors of the patient's own chordae, shape `[group]`, all one without a result. Sutures and neochordae keep their
    /// lengths.
    pub groups: Vec<GroupScale>,
    /// The valve as given, closed; nothing where that closure did not converge.
    pub untuned: Option<Tried>,
    /// The valve with fitted chordae, closed from its open state; nothing without a result.
    pub tuned: Option<Tried>,
    /// Closures computed in all.
    pub closures: usize,
    /// Closures that did not converge; none of them was used.
    pub unconverged: usize,
    /// Factors tried with what came of them, in their order.
    pub history: Vec<Trial>,
}

/// How a fit ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FitStatus {
    /// The best factors lie within their range.
    Fitted,
    /// A factor lies at an end of its range: a better one may lie beyond.
    AtBound,
    /// Steps were still being made at the iteration limit.
    IterationLimit,
    /// Closures that the fit would have to stand on did not converge: there is no result.
    NotConverged,
    /// The watcher said stop: there is no result.
    Interrupted,
}

/// The factor of one chord group.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GroupScale {
    /// Name of the group.
    pub name: String,
    /// Fitted rest length over the model's own [1].
    pub scale: f64,
    /// Within these, the misfit differs from its least by less than the scatter of the target's points explains, with
    /// 95 % probability, the other factors being free [1]. It knows of scatter and of the search alone: what the
    /// model gets wrong, or an annulus in the wrong place, comes on top. Without limit to one side, it ends with the range.
    pub interval_95: [f64; 2],
    /// Whether the interval is narrower than a tenth: else the target does not decide this factor, as where the chordae are
    /// slack, and it stays near the common one.
    pub identified: bool,
}

/// A closed valve and its distance from the target.
#[derive(Clone, Debug)]
pub struct Tried {
    /// The valve.
    pub model: Model,
    /// Where it came to rest.
    pub equilibrium: Equilibrium,
    /// From all points of the target.
    pub all_points: TargetDistance,
    /// From the points whose nearest place on this closed valve is visible from the atrium.
    pub visible_points: TargetDistance,
}

impl Tried {
    /// Whether the closed valve can be trusted.
    pub fn certified(&self) -> bool {
        self.equilibrium.certificate.is_certified(self.equilibrium.status)
    }
}

/// One closure of the search.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// Factors, shape `[chord group]`; one for sutures and neochordae.
    pub scale: Vec<f64>,
    /// Whether it began at another closed state instead of the open one.
    pub warm: bool,
    /// Iterations of the solver.
    pub iterations: usize,
    /// Root mean square of the distances of the target's points [mm]; nothing where it did not converge.
    pub rms_mm: Option<f64>,
}

/// Fewest points that a fit is made to: below that, scatter decides (our choice).
pub const FEWEST_POINTS: usize = 20;

/// Looks on at closures that run side by side; as in [`crate::relax::relax_watched`].
pub type Watch<'a> = &'a (dyn Fn(&Moment) -> ControlFlow<()> + Sync);

/// What a watcher of a fit is shown.
#[derive(Clone, Copy, Debug)]
pub enum Progress<'a> {
    /// So many closures more begin side by side. How many there will be in all, the search finds out as it goes.
    Begun(usize),
    /// A closure made an iteration.
    Iterated(&'a Moment<'a>),
    /// A closure came to its end.
    Closed,
}

/// Looks on at a fit, and stops it by answering `Break`.
pub type FitWatch<'a> = &'a (dyn Fn(&Progress) -> ControlFlow<()> + Sync);

/// Fits the rest lengths of the chordae so that the valve closes to the target.
///
/// # Errors
/// Every fault of model, target and settings that leaves nothing to fit.
pub fn fit_chord_lengths(
    model: &Model,
    target: &Target,
    settings: &FitSettings,
) -> Result<ChordFit, Vec<Fault>> {
    fit_chord_lengths_watched(model, target, settings, &|_| ControlFlow::Continue(()))
}

/// The same with somebody looking on, who is shown the iterations of all closures and stops the fit by answering `Break` to one; to
/// the others that run beside, too. Then there is no result but [`FitStatus::Interrupted`] and the history.
///
/// # Errors
/// As [`fit_chord_lengths`].
pub fn fit_chord_lengths_watched(
    model: &Model,
    target: &Target,
    settings: &FitSettings,
    watch: FitWatch,
) -> Result<ChordFit, Vec<Fault>> {
    let faults = faults(model, target, settings);
    if !faults.is_empty() {
        return Err(faults);
    }
    Ok(fit::fit(model, target, settings, watch))
}

/// Nothing farther from the closed annulus than this belongs to the valve [mm]; more likely it is in other units or another
/// frame (our choice).
const FARTHEST_MM: f64 = 200.0;

fn faults(model: &Model, target: &Target, settings: &FitSettings) -> Vec<Fault> {
    let mut faults = Vec::new();
    let native = |&group: &u32| model.chord_groups[group as usize].kind == ChordKind::Chorda;
    if !model.chords.group.iter().any(native) {
        faults.push(Fault::error(
            "chordae",
            "the valve has none: nothing can be fitted",
        ));
    }
    let points = &target.points_mm;
    if points.len() < FEWEST_POINTS {
        let message = format!("has {} points, expected {FEWEST_POINTS} at least", points.len());
        faults.push(Fault::error("target", message));
    }
    let centre =
        model.prescribed.iter().map(|p| p.target_mm).sum::<Vec3>() / model.prescribed.len().max(1) as f64;
    // What is not finite is nowhere near.
    let near = |p: &Vec3| (p - centre).norm() <= FARTHEST_MM;
    if let Some(number) = points.iter().position(|p| !near(p)) {
        let p = points[number];
        let message = format!(
            "is ({}, {}, {}) mm, more than {FARTHEST_MM} mm from the supports of the valve; expected a target in mm and in the \
             frame of the scene",
            Readable(p.x),
            Readable(p.y),
            Readable(p.z)
        );
        faults.push(Fault::error(format!("target point {number}"), message));
    }
    let [least, most] = settings.scale_range;
    if !(least >= 0.1 && least < most && most <= 10.0) {
        let message = format!(
            "is {} to {}, expected an ascending range within 0.1 to 10",
            Readable(least),
            Readable(most)
        );
        faults.push(Fault::error("scale range", message));
    }
    faults
}

/// The valve with its annulus moving, on closing, to a closed curve [mm] where it lies: in proportion to arc length between
/// the places nearest to its own trigones and middles. For scenes that do not say how the annulus moves.
///
/// # Errors
/// As of an annuloplasty along that curve, which this is.
pub fn annulus_closing_to(model: &Model, curve_mm: &[Vec3]) -> Result<Repaired, Vec<Fault>> {
    let ring = Ring {
        curve_mm: Some(curve_mm.iter().map(|&p| p.into()).collect()),
        closed: Some(true),
        placed: true,
        ..Ring::default()
    };
    let told = |fault: Fault| Fault {
        place: fault
            .place
            .replacen("ring.curve_mm", "annulus curve", 1)
            .replacen("ring", "annulus curve", 1),
        ..fault
    };
    match repair::apply(model, &Repair::Ring(ring)) {
        Ok(mut repaired) => {
            repaired.warnings = repaired.warnings.into_iter().map(told).collect();
            Ok(repaired)
        }
        Err(faults) => Err(faults.into_iter().map(told).collect()),
    }
}

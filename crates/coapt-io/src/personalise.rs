//! Chord lengths fitted to a closed surface: what they are fitted to, the scene that comes of it, and what is told.

use std::fmt::Write as _;

use coapt::Vec3;
use coapt::personalise::{ChordFit, FitStatus, GroupScale, Target, TargetDistance, Trial, Tried};
use coapt::scene::{Fault, Scene};
use serde::{Deserialize, Serialize};
use serde_json::json;

use crate::escape::escaped;
use crate::mesh::PolyData;
use crate::report::NOTICE;

/// The points of a surface that its triangles use; `name` is what faults call it.
///
/// # Errors
/// No triangles, or one with a point that is not there.
pub fn target_of(name: &str, mesh: &PolyData) -> Result<Target, Fault> {
    if mesh.triangles.is_empty() {
        let message = "has no triangles; expected the surface of the closed leaflets";
        return Err(Fault::error(name, message));
    }
    let count = mesh.points.len();
    let mut used = vec![false; count];
    for &point in mesh.triangles.iter().flatten() {
        let Some(used) = used.get_mut(point as usize) else {
            let message =
                format!("has a triangle with point {point}; expected one of its {count} points, from 0");
            return Err(Fault::error(name, message));
        };
        *used = true;
    }
    let points = mesh.points.iter().zip(used).filter(|(_, used)| *used);
    Ok(Target {
        points_mm: points.map(|(&point, _)| Vec3::from(point)).collect(),
    })
}

/// A scene with the fitted factors.
pub fn fitted_scene(mut scene: Scene, fit: &ChordFit) -> Scene {
    for (group, fitted) in scene.chordae.iter_mut().zip(&fit.groups) {
        group.rest_length_scale *= fitted.scale;
    }
    scene
}

/// What is told of a fit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FitReport {
    /// Name of the case.
    pub case: String,
    /// Whether each group of chordae had a factor of its own.
    pub per_group: bool,
    /// What the surface is called.
    pub target: String,
    /// How the fit ended.
    pub status: FitStatus,
    /// The factors, shape `[group]`.
    pub groups: Vec<GroupScale>,
    /// The valve as given, closed; nothing where that did not converge.
    pub untuned: Option<State>,
    /// The valve with the fitted lengths, closed; nothing without a result.
    pub tuned: Option<State>,
    /// Closures computed in all.
    pub closures: usize,
    /// Closures that did not converge.
    pub unconverged: usize,
    /// Factors tried with what came of them, in their order.
    pub history: Vec<Trial>,
    /// Wall-clock time [ms].
    pub wall_ms: f64,
    /// Repairs of the input, guesses and doubts.
    pub warnings: Vec<String>,
}

/// A closed valve of a fit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Whether it can be trusted.
    pub certified: bool,
    /// From all points of the surface to it.
    pub all_points: TargetDistance,
    /// From the points over its visible tissue.
    pub visible_points: TargetDistance,
}

impl From<&Tried> for State {
    fn from(tried: &Tried) -> Self {
        Self {
            certified: tried.certified(),
            all_points: tried.all_points,
            visible_points: tried.visible_points,
        }
    }
}

/// Stands under every pair of errors.
const CAUTION: &str = "the fitted error is of the shape that the chordae were fitted to: it says how well the model can be \
                       made to look like it, not how well it predicts";

/// A fitted valve farther from its target than this is doubted [mm], root mean square over visible tissue, our choice: fitted valves are
/// published at 0.55 to 0.75 mm (paper 003), and a target on a ring of 30 mm, fitted with the dilated annulus, is left 1.7 mm off.
const DOUBTED_FROM_MM: f64 = 1.2;

type Row = (&'static str, fn(&TargetDistance) -> f64);

const ROWS: [Row; 5] = [
    ("root mean square", |d| d.rms_mm),
    ("mean", |d| d.mean_mm),
    ("mean, positive on the atrial side", |d| d.mean_signed_mm),
    ("95 % of the points", |d| d.p95_mm),
    ("largest", |d| d.max_mm),
];

impl FitReport {
    /// Puts together what is told of the fit of a case to a surface of a name.
    pub fn new(
        case: &str,
        target: &str,
        per_group: bool,
        fit: &ChordFit,
        wall_ms: f64,
        mut warnings: Vec<String>,
    ) -> Self {
        let left_mm = fit
            .tuned
            .as_ref()
            .map_or(0.0, |tuned| tuned.visible_points.rms_mm);
        if left_mm > DOUBTED_FROM_MM {
            warnings.push(format!(
                "the fitted valve is still {left_mm:.1} mm (root mean square) from the target: more than chordae explain, so that their \
                 factors are in doubt. Does its annulus lie where the target's does, in the same frame?"
            ));
        }
        Self {
            case: case.to_owned(),
            per_group,
            target: target.to_owned(),
            status: fit.status,
            groups: fit.groups.clone(),
            untuned: fit.untuned.as_ref().map(State::from),
            tuned: fit.tuned.as_ref().map(State::from),
            closures: fit.closures,
            unconverged: fit.unconverged,
            history: fit.history.clone(),
            wall_ms,
            warnings,
        }
    }

    /// Whether there is a result, with every factor within its range, of a certified closure.
    pub fn certified(&self) -> bool {
        self.status == FitStatus::Fitted && self.tuned.is_some_and(|tuned| tuned.certified)
    }

    /// As one JSON object, what `personalise.json` holds.
    pub fn json(&self) -> String {
        let whole = json!({
            "schema": "coapt-personalise/1", "version": env!("CARGO_PKG_VERSION"), "notice": NOTICE,
            "case": self.case, "target": self.target, "per_group": self.per_group, "status": self.status,
            "chord_groups": self.groups, "untuned": self.untuned, "tuned": self.tuned, "caution": CAUTION,
            "closures": self.closures, "unconverged": self.unconverged, "wall_ms": self.wall_ms,
            "history": self.history, "warnings": self.warnings,
        });
        format!("{whole:#}\n")
    }

    /// As a table for people.
    pub fn text(&self) -> String {
        let both = [self.untuned, self.tuned];
        let mut text = format!(
            "{}: chordae fitted to {}\n",
            escaped(&self.case),
            escaped(&self.target)
        );
        text += &format!("{}\n\n{}\n", status(self.status), self.factors());
        text += &distances("all points", both, |state| state.all_points);
        text += &distances("points over visible tissue", both, |state| state.visible_points);
        let certified = both.map(|state| match state.map(|state| state.certified) {
            Some(true) => "yes".into(),
            Some(false) => "NO".into(),
            None => "-".into(),
        });
        text += &row("closure certified", certified);
        let _ = writeln!(
            text,
            "{} closures, {} of them not converged and not used; {:.0} ms\n{CAUTION}",
            self.closures, self.unconverged, self.wall_ms
        );
        for warning in &self.warnings {
            let _ = writeln!(text, "warning: {}", escaped(warning));
        }
        text + NOTICE + "\n"
    }

    /// The factors, a line for each group or one for all.
    fn factors(&self) -> String {
        let heads = ["fitted", "95 % interval"];
        let mut text = format!(
            "{:<40}{:>10}{:>18}\n",
            "rest length, times that of the scene", heads[0], heads[1]
        );
        let shown = if self.per_group { self.groups.len() } else { 1 };
        for group in self.groups.iter().take(shown) {
            let name = if self.per_group {
                &escaped(&group.name)
            } else {
                "all chordae"
            };
            let interval = format!("{:.3} to {:.3}", group.interval_95[0], group.interval_95[1]);
            let doubt = if group.identified {
                ""
            } else {
                "  not decided by the target"
            };
            let _ = writeln!(text, "  {name:<38}{:>10.4}{interval:>18}{doubt}", group.scale);
        }
        text
    }
}

fn status(status: FitStatus) -> &'static str {
    match status {
        FitStatus::Fitted => "FITTED",
        FitStatus::AtBound => "AT A BOUND: a factor lies at an end of its range, a better one may lie beyond",
        FitStatus::IterationLimit => "NOT FINISHED: the search was still moving at its limit",
        FitStatus::NotConverged => "NO RESULT: closures that the fit would stand on did not converge",
        FitStatus::Interrupted => "NO RESULT: the fit was interrupted",
    }
}

/// Distances before and after, a line for each statistic.
fn distances(part: &str, both: [Option<State>; 2], of: fn(State) -> TargetDistance) -> String {
    let of = both.map(|state| state.map(of));
    let cells = |cell: &dyn Fn(TargetDistance) -> String| of.map(|of| of.map_or("-".into(), cell));
    let mut text = row(
        &format!("distance [mm], {part}"),
        ["as given", "fitted"].map(String::from),
    );
    for (name, value) in ROWS {
        text += &row(&format!("  {name}"), cells(&|of| format!("{:.3}", value(&of))));
    }
    text + &row("  points", cells(&|of| of.points.to_string())) + "\n"
}

fn row(name: &str, [given, fitted]: [String; 2]) -> String {
    format!("{name:<44}{given:>10}{fitted:>10}\n")
}

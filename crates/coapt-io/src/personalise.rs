//! Chord lengths fitted to a closed surface: what they are fitted to, the scene that comes of it, and what is told.

use std::fmt::Write as _;

use coapt::Vec3;
use coapt::personalise::{ChordFit, FitStatus, Target, TargetDistance, Tried};
use coapt::scene::{Fault, Scene};
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
#[derive(Clone, Debug)]
pub struct FitReport<'a> {
    /// Name of the case.
    pub case: &'a str,
    /// Whether each group of chordae had a factor of its own.
    pub per_group: bool,
    /// What the surface is called.
    pub target: &'a str,
    /// What was found.
    pub fit: &'a ChordFit,
    /// Wall-clock time [ms].
    pub wall_ms: f64,
    /// Repairs of the input, guesses and doubts.
    pub warnings: Vec<String>,
}

/// Stands under every pair of errors.
const CAUTION: &str = "the fitted error is of the shape that the chordae were fitted to: it says how well the model can be \
                       made to look like it, not how well it predicts";

type Row = (&'static str, fn(&TargetDistance) -> f64);

const ROWS: [Row; 5] = [
    ("root mean square", |d| d.rms_mm),
    ("mean", |d| d.mean_mm),
    ("mean, positive on the atrial side", |d| d.mean_signed_mm),
    ("95 % of the points", |d| d.p95_mm),
    ("largest", |d| d.max_mm),
];

impl FitReport<'_> {
    /// As one JSON object, what `personalise.json` holds.
    pub fn json(&self) -> String {
        let state = |tried: &Option<Tried>| {
            tried.as_ref().map(|tried| {
                json!({
                    "certified": tried.certified(),
                    "all_points": tried.all_points,
                    "visible_points": tried.visible_points,
                })
            })
        };
        let fit = self.fit;
        let whole = json!({
            "schema": "coapt-personalise/1", "version": env!("CARGO_PKG_VERSION"), "notice": NOTICE,
            "case": self.case, "target": self.target, "per_group": self.per_group, "status": fit.status,
            "chord_groups": fit.groups,
            "untuned": state(&fit.untuned), "tuned": state(&fit.tuned), "caution": CAUTION,
            "closures": fit.closures, "unconverged": fit.unconverged, "wall_ms": self.wall_ms,
            "history": fit.history, "warnings": self.warnings,
        });
        format!("{whole:#}\n")
    }

    /// As a table for people.
    pub fn text(&self) -> String {
        let fit = self.fit;
        let both = [&fit.untuned, &fit.tuned];
        let mut text = format!(
            "{}: chordae fitted to {}\n",
            escaped(self.case),
            escaped(self.target)
        );
        text += &format!("{}\n\n{}\n", status(fit.status), self.factors());
        text += &distances("all points", both, |tried| tried.all_points);
        text += &distances("points over visible tissue", both, |tried| tried.visible_points);
        let certified = both.map(|tried| match tried.as_ref().map(Tried::certified) {
            Some(true) => "yes".into(),
            Some(false) => "NO".into(),
            None => "-".into(),
        });
        text += &row("closure certified", certified);
        let _ = writeln!(
            text,
            "{} closures, {} of them not converged and not used; {:.0} ms\n{CAUTION}",
            fit.closures, fit.unconverged, self.wall_ms
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
        let shown = if self.per_group { self.fit.groups.len() } else { 1 };
        for group in self.fit.groups.iter().take(shown) {
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
fn distances(part: &str, both: [&Option<Tried>; 2], of: fn(&Tried) -> TargetDistance) -> String {
    let of = both.map(|tried| tried.as_ref().map(of));
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

//! `coapt personalise`: fits the lengths of the chordae so that the valve closes to an imaged shape, and reports the error
//! before and after.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::{Args, value_parser};
use coapt::Vec3;
use coapt::model::{Built, Model};
use coapt::personalise::{
    ChordFit, FitSettings, FitStatus, Target, TargetDistance, Tried, annulus_closing_to,
    fit_chord_lengths_watched,
};
use coapt::scene::{Fault, Scene};
use coapt_io::atomic::{Batch, make_folder};
use coapt_io::escape::escaped;
use coapt_io::mesh::{read_curve, read_mesh};
use coapt_io::report::{Closure, NOTICE, Report, stage_results};
use coapt_io::scene::{sentence, stage_scene};
use serde_json::json;

use crate::case::{self, SizeLimit, Source};
use crate::closure::{Format, on_threads, timed};
use crate::interrupt::watching;
use crate::output::{Failure, Verdict, print, say};

/// What `coapt personalise` understands.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// A scene file, a folder with a scene.toml, or a preset
    scene: PathBuf,
    /// The closed leaflets as imaged or computed elsewhere: a surface file (.vtk, .vtp, .ply, .stl, .obj), in mm and in the
    /// frame of the scene; what was seen of them is enough
    target: PathBuf,
    /// One factor for each group of chordae instead of one for all
    #[arg(long)]
    per_group: bool,
    /// The closed annulus, for a scene that does not say how it moves: Slicer markups JSON or a polyline
    #[arg(long, value_name = "CURVE")]
    annulus: Option<PathBuf>,
    /// Folder for the fitted scene, its closed surfaces (.vtp) and personalise.json, made if need be
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// How the report is printed
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    /// How many threads to use; the result does not depend on it [default: one per core]
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    #[command(flatten)]
    limit: SizeLimit,
}

/// Runs the verb.
pub(crate) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    let mut case = case::open(Some(&arguments.scene), arguments.limit)?;
    let mut built = case::build(&case)?;
    let target = read_target(&arguments.target, &mut built.warnings)?;
    if let Some(path) = &arguments.annulus {
        built.model = with_annulus(&built.model, path, &mut built.warnings)?;
        move_annulus(&mut case.scene, &built.model);
    }
    let settings = FitSettings {
        per_group: arguments.per_group,
        ..FitSettings::default()
    };
    if let Some(folder) = &arguments.out {
        refuse_own_folder(folder, &case.source)?;
    }
    let (fit, wall_ms) = on_threads(arguments.threads, || {
        let start = Instant::now();
        let fit = watching("the fit", |watch| {
            fit_chord_lengths_watched(&built.model, &target, &settings, watch)
        });
        let fit = fit.map_err(|faults| in_files(arguments, faults))?;
        Ok((fit, start.elapsed().as_secs_f64() * 1e3))
    })?;
    let told = Told {
        case: &built.model.name,
        per_group: arguments.per_group,
        target: arguments.target.display().to_string(),
        fit: &fit,
        wall_ms,
        warnings: built.warnings.iter().map(sentence).collect(),
    };
    if let Some(folder) = &arguments.out {
        write(folder, case.scene, &told, &built)?;
    }
    print(&match arguments.format {
        Format::Text => told.text(),
        Format::Json => told.json(),
    })?;
    if let (Some(folder), true) = (&arguments.out, fit.tuned.is_some()) {
        say(&format!("the fitted scene is in {}", folder.display()));
    }
    let certified = fit.tuned.as_ref().is_some_and(Tried::certified);
    Ok(match fit.status == FitStatus::Fitted && certified {
        true => Verdict::Done,
        false => Verdict::Uncertified,
    })
}

/// The fitted scene must not take the place of the one that it was fitted from.
fn refuse_own_folder(folder: &Path, source: &Source) -> Result<(), Failure> {
    let Source::File(scene_file, _) = source else {
        return Ok(());
    };
    let same = match (
        folder.join("scene.toml").canonicalize(),
        scene_file.canonicalize(),
    ) {
        (Ok(written), Ok(read)) => written == read,
        _ => false,
    };
    if !same {
        return Ok(());
    }
    let message = format!(
        "is the folder of the scene itself, {}, which would be overwritten; expected another",
        scene_file.display()
    );
    Err(vec![Fault::error("--out", message)].into())
}

/// The points of a surface that its triangles use.
fn read_target(path: &Path, warnings: &mut Vec<Fault>) -> Result<Target, Failure> {
    let (mesh, more) = read_mesh(path)?;
    warnings.extend(more);
    if mesh.triangles.is_empty() {
        let message = "has no triangles; expected the surface of the closed leaflets";
        return Err(vec![Fault::error(path.display().to_string(), message)].into());
    }
    if mesh.space.is_none() {
        warnings.push(Fault::warning(
            path.display().to_string(),
            "no SPACE mark: taken as LPS",
        ));
    }
    let mut used = vec![false; mesh.points.len()];
    mesh.triangles
        .iter()
        .flatten()
        .for_each(|&point| used[point as usize] = true);
    let points = mesh.points.iter().zip(used).filter(|(_, used)| *used);
    Ok(Target {
        points_mm: points.map(|(&point, _)| Vec3::from(point)).collect(),
    })
}

/// Faults of the library, with the file that they speak of.
fn in_files(arguments: &Arguments, faults: Vec<Fault>) -> Failure {
    let named = |fault: Fault| match fault.place.strip_prefix("target") {
        Some(rest) => Fault {
            place: format!("{}{rest}", arguments.target.display()),
            ..fault
        },
        None => Fault {
            place: format!("{} {}", arguments.scene.display(), fault.place),
            ..fault
        },
    };
    faults.into_iter().map(named).collect::<Vec<Fault>>().into()
}

fn with_annulus(model: &Model, path: &Path, warnings: &mut Vec<Fault>) -> Result<Model, Failure> {
    let (curve, more) = read_curve(path)?;
    warnings.extend(more);
    let points: Vec<Vec3> = curve.points_mm.iter().map(|&point| point.into()).collect();
    let named = |fault: Fault| Fault {
        place: fault
            .place
            .replacen("annulus curve", &path.display().to_string(), 1),
        ..fault
    };
    let moved = annulus_closing_to(model, &points)
        .map_err(|faults| -> Vec<Fault> { faults.into_iter().map(named).collect() })?;
    warnings.extend(moved.warnings.into_iter().map(named));
    Ok(moved.model)
}

/// Writes the motion of a model's annulus into the scene that it was built of: a leaflet point is an annulus vertex where it
/// lies on one.
fn move_annulus(scene: &mut Scene, model: &Model) {
    let motion = |point: &[f64; 3]| {
        let point = Vec3::from(*point);
        let of = |&vertex: &u32| {
            let rest_mm = model.rest_mm[vertex as usize];
            let found = model
                .prescribed
                .binary_search_by_key(&vertex, |prescribed| prescribed.vertex);
            let target_mm = found.map_or(rest_mm, |found| model.prescribed[found].target_mm);
            ((rest_mm - point).norm() <= scene.weld.tolerance_mm).then(|| (target_mm - rest_mm).into())
        };
        model.annulus.iter().find_map(of).unwrap_or([0.0; 3])
    };
    let motions: Vec<Option<Vec<[f64; 3]>>> = scene
        .leaflets
        .iter()
        .map(|leaflet| {
            leaflet
                .mesh
                .as_ref()
                .map(|mesh| mesh.points_mm.iter().map(motion).collect())
        })
        .collect();
    for (leaflet, motion) in scene.leaflets.iter_mut().zip(motions) {
        if let Some(mesh) = &mut leaflet.mesh {
            mesh.annulus_displacement_mm = motion;
        }
    }
}

/// The scene with the fitted factors, the closed valve and the report; without a result the report alone.
fn write(folder: &Path, scene: Scene, told: &Told, built: &Built) -> Result<(), Failure> {
    // Closed once more, for the time that one closure takes; it is the fit's, to the last bit.
    let closed = |tuned: &Tried| Closure {
        before: timed("the fitted valve", tuned.model.clone()),
        after: None,
        repairs: Vec::new(),
        warnings: built.warnings.clone(),
        untangled: built.untangled.clone(),
        chordae_left_out: built.chordae_left_out.clone(),
    };
    let closure = told.fit.tuned.as_ref().map(closed);
    let mut batch = Batch::default();
    stage(&mut batch, folder, scene, told, closure.as_ref())
        .and_then(|()| batch.finish_listed(folder))
        .map_err(Failure::Outside)
}

fn stage(
    batch: &mut Batch,
    folder: &Path,
    mut scene: Scene,
    told: &Told,
    closure: Option<&Closure>,
) -> Result<(), Fault> {
    make_folder(folder)?;
    batch.write(&folder.join("personalise.json"), told.json().as_bytes())?;
    let Some(closure) = closure else {
        return Ok(());
    };
    for (group, fitted) in scene.chordae.iter_mut().zip(&told.fit.groups) {
        group.rest_length_scale *= fitted.scale;
    }
    stage_scene(batch, folder, &scene)?;
    stage_results(batch, folder, closure, &Report::new(closure))
}

/// What is told of a fit.
struct Told<'a> {
    case: &'a str,
    per_group: bool,
    target: String,
    fit: &'a ChordFit,
    wall_ms: f64,
    warnings: Vec<String>,
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

impl Told<'_> {
    fn json(&self) -> String {
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
            "case": self.case, "target": self.target, "status": fit.status, "chord_groups": fit.groups,
            "untuned": state(&fit.untuned), "tuned": state(&fit.tuned), "caution": CAUTION,
            "closures": fit.closures, "unconverged": fit.unconverged, "wall_ms": self.wall_ms,
            "history": fit.history, "warnings": self.warnings,
        });
        format!("{whole:#}\n")
    }

    fn text(&self) -> String {
        let fit = self.fit;
        let both = [&fit.untuned, &fit.tuned];
        let mut text = format!(
            "{}: chordae fitted to {}\n",
            escaped(self.case),
            escaped(&self.target)
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

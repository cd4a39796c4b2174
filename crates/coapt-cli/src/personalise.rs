//! `coapt personalise`: fits the lengths of the chordae so that the valve closes to an imaged shape, and reports the error
//! before and after.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use coapt::Vec3;
use coapt::model::{Built, Model};
use coapt::personalise::{
    ChordFit, FitSettings, Progress, Target, Tried, annulus_closing_to, fit_chord_lengths_watched,
};
use coapt::scene::{Fault, Scene};
use coapt_io::atomic::{Batch, make_folder};
use coapt_io::mesh::{read_curve, read_mesh};
use coapt_io::personalise::{FitReport, fitted_scene, target_of};
use coapt_io::report::{Closure, Report, stage_results};
use coapt_io::scene::{sentence, stage_scene};

use crate::case::{self, SizeLimit, Source};
use crate::closure::{Format, on_threads, timed};
use crate::interrupt::watching;
use crate::output::{Failure, Verdict, print, say};
use crate::whole_number::{THREADS_ALLOWED, whole_number};

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
    #[arg(long, value_name = "N", value_parser = whole_number(THREADS_ALLOWED), allow_negative_numbers = true)]
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
            let look = |progress: &Progress| match progress {
                Progress::Iterated(moment) => watch(moment),
                Progress::Begun(_) | Progress::Closed => ControlFlow::Continue(()),
            };
            fit_chord_lengths_watched(&built.model, &target, &settings, &look)
        });
        let fit = fit.map_err(|faults| in_files(arguments, faults))?;
        Ok((fit, start.elapsed().as_secs_f64() * 1e3))
    })?;
    let target_name = arguments.target.display().to_string();
    let told = FitReport::new(
        &built.model.name,
        &target_name,
        arguments.per_group,
        &fit,
        wall_ms,
        built.warnings.iter().map(sentence).collect(),
    );
    if let Some(folder) = &arguments.out {
        write(folder, case.scene, &fit, &told, &built)?;
    }
    print(&match arguments.format {
        Format::Text => told.text(),
        Format::Json => told.json(),
    })?;
    if let (Some(folder), true) = (&arguments.out, fit.tuned.is_some()) {
        say(&format!("the fitted scene is in {}", folder.display()));
    }
    Ok(match told.certified() {
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

fn read_target(path: &Path, warnings: &mut Vec<Fault>) -> Result<Target, Failure> {
    let name = path.display().to_string();
    let (mesh, more) = read_mesh(path)?;
    warnings.extend(more);
    let target = target_of(&name, &mesh).map_err(|fault| vec![fault])?;
    if mesh.space.is_none() {
        warnings.push(Fault::warning(name, "no SPACE mark: taken as LPS"));
    }
    Ok(target)
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
fn write(
    folder: &Path,
    scene: Scene,
    fit: &ChordFit,
    told: &FitReport,
    built: &Built,
) -> Result<(), Failure> {
    // Closed once more, for the time that one closure takes; it is the fit's, to the last bit.
    let closed = |tuned: &Tried| Closure {
        before: timed("the fitted valve", tuned.model.clone()),
        after: None,
        repairs: Vec::new(),
        warnings: built.warnings.clone(),
        untangled: built.untangled.clone(),
        chordae_left_out: built.chordae_left_out.clone(),
    };
    let closure = fit.tuned.as_ref().map(closed);
    let mut batch = Batch::default();
    stage(
        &mut batch,
        folder,
        &fitted_scene(scene, fit),
        told,
        closure.as_ref(),
    )
    .and_then(|()| batch.finish_listed(folder))
    .map_err(Failure::Outside)
}

fn stage(
    batch: &mut Batch,
    folder: &Path,
    scene: &Scene,
    told: &FitReport,
    closure: Option<&Closure>,
) -> Result<(), Fault> {
    make_folder(folder)?;
    batch.write(&folder.join("personalise.json"), told.json().as_bytes())?;
    let Some(closure) = closure else {
        return Ok(());
    };
    stage_scene(batch, folder, scene)?;
    stage_results(batch, folder, closure, &Report::new(closure))
}

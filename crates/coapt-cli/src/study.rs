//! `coapt study`: closes one valve at many settings, or under every tissue law, and sets error against time.

mod laws;

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use coapt::model::Model;
use coapt::relax::Equilibrium;
use coapt::scene::Fault;
use coapt_io::atomic::make_folder;
use coapt_io::study::{
    self, FACES, FACES_ALLOWED, REPEATS_ALLOWED, Sizes, Tried, carry_out, expect_no_sizes, text, write_study,
};

use crate::case::{self, Case, SizeLimit, Source};
use crate::closure::on_threads;
use crate::interrupt::close_watched;
use crate::output::{Failure, Verdict, print, say};
use crate::whole_number::{THREADS_ALLOWED, whole_number};

/// What `coapt study` understands.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// A preset, a scene file, or a folder with a scene.toml [default: healthy]
    scene: Option<PathBuf>,
    /// Study tissue laws instead: one tissue told in each law, at the scene's residual and contact thickness
    #[arg(long, conflicts_with_all = ["tolerance", "thickness"])]
    laws: bool,
    /// Mesh sizes of a preset, in triangles [default: 160,320,650,1300,2600; of laws 650]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = whole_number(FACES_ALLOWED), allow_negative_numbers = true)]
    faces: Vec<u32>,
    /// Mesh size of the reference, in triangles [default: four times the finest mesh; a scene has but its own]
    #[arg(long, value_name = "N", value_parser = whole_number(FACES_ALLOWED), allow_negative_numbers = true)]
    reference_faces: Option<u32>,
    /// Residuals to stop at, each tried on every mesh
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = tolerance, allow_negative_numbers = true,
          default_value = "1e-1,1e-2,1e-3,1e-4,1e-5,1e-6")]
    tolerance: Vec<f64>,
    /// Contact thicknesses in mm, each tried on the mesh of about 650 triangles at the scene's residual
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = thickness, allow_negative_numbers = true, default_value = "0.3,0.5,0.8")]
    thickness: Vec<f64>,
    /// Closures of each setting, of which the median time counts
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = whole_number(REPEATS_ALLOWED), allow_negative_numbers = true)]
    repeats: u16,
    /// Folder for study.csv, study.json and study.svg (of laws laws.csv and laws.json), made if need be; results of an
    /// earlier run are replaced
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// How many threads to use; the shapes do not depend on it, the times do [default: one per core]
    #[arg(long, value_name = "N", value_parser = whole_number(THREADS_ALLOWED), allow_negative_numbers = true)]
    threads: Option<u16>,
    #[command(flatten)]
    limit: SizeLimit,
}

fn tolerance(word: &str) -> Result<f64, String> {
    study::tolerance(number(word))
}

fn thickness(word: &str) -> Result<f64, String> {
    study::thickness_mm(number(word))
}

/// A word that is no number is as wrong as a number outside of every range.
fn number(word: &str) -> f64 {
    word.trim().parse().unwrap_or(f64::NAN)
}

/// Runs the verb.
pub(crate) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    if arguments.laws {
        return laws::run(arguments);
    }
    let (models, finest) = models(arguments)?;
    // Before minutes of work, not after.
    prepare(&arguments.out)?;
    let tried = Tried {
        tolerances: arguments.tolerance.clone(),
        thicknesses_mm: arguments.thickness.clone(),
        repeats: arguments.repeats,
    };
    let study = || Ok(carry_out(&models, &finest, &tried, &timed, &say));
    let Some(study) = on_threads(arguments.threads, study)? else {
        say("error: no reference: the finest mesh did not close to a certified state at any residual");
        return Ok(Verdict::Uncertified);
    };
    write_study(&arguments.out, &study).map_err(Failure::Outside)?;
    print(&text(&study))?;
    say(&format!("results are in {}", arguments.out.display()));
    // Settings that fail are what a study is to find; only where all fail is there nothing to trust.
    Ok(match study.rows.iter().any(|row| row.certified) {
        true => Verdict::Done,
        false => Verdict::Uncertified,
    })
}

/// Closes a valve from its open state and takes the time [ms].
fn timed(what: &str, model: &Model) -> (Equilibrium, f64) {
    let start = Instant::now();
    let closed = close_watched(what, model);
    (closed, start.elapsed().as_secs_f64() * 1e3)
}

/// Makes the folder of results, to know before the work that it can be made.
pub(crate) fn prepare(folder: &Path) -> Result<(), Failure> {
    let place = folder.display().to_string();
    if folder.exists() && !folder.is_dir() {
        return Err(vec![Fault::error(place, "is a file; expected a folder to write to")].into());
    }
    make_folder(folder).map_err(Failure::Outside)
}

/// The valve at every mesh size, coarsest first, and the one of the reference.
fn models(arguments: &Arguments) -> Result<(Vec<Model>, Model), Failure> {
    let (cases, finest) = cases(arguments, &FACES)?;
    let build = |case: &Case| -> Result<Model, Failure> { Ok(case::build(case)?.model) };
    let models = cases.iter().map(build).collect::<Result<Vec<_>, _>>()?;
    let finest = match finest {
        Some(finest) => build(&finest)?,
        None => models[0].clone(),
    };
    Ok((models, finest))
}

/// The scene at every mesh size, coarsest first, and that of the reference; a scene that is no preset has its own mesh and no
/// reference.
fn cases(arguments: &Arguments, usual_faces: &[u32]) -> Result<(Vec<Case>, Option<Case>), Failure> {
    let case = case::open(arguments.scene.as_deref(), arguments.limit)?;
    let faces: Option<Vec<i64>> = match &arguments.faces[..] {
        [] => None,
        faces => Some(faces.iter().copied().map(i64::from).collect()),
    };
    let (faces, reference_faces) = (faces.as_deref(), arguments.reference_faces.map(i64::from));
    let Source::Preset(preset) = case.source else {
        expect_no_sizes(faces, reference_faces).map_err(of_options)?;
        return Ok((vec![case], None));
    };
    let sizes = Sizes::asked(faces, reference_faces, usual_faces).map_err(of_options)?;
    let of_size = |faces: u32| -> Result<Case, Failure> { Ok(case::preset(preset, faces, arguments.limit)?) };
    let cases = sizes
        .faces
        .into_iter()
        .map(of_size)
        .collect::<Result<Vec<_>, _>>()?;
    Ok((cases, Some(of_size(sizes.reference_faces)?)))
}

/// Faults of what was asked for, whose places are keys, called by the options of those keys.
fn of_options(mut faults: Vec<Fault>) -> Vec<Fault> {
    for fault in &mut faults {
        fault.place = format!("--{}", fault.place.replace('_', "-"));
    }
    faults
}

//! `coapt closure`: closes a valve, before and after a plan, and reports.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::{Args, ValueEnum};
use coapt::model::{Built, Model};
use coapt::plan::{Applied, apply_all};
use coapt::repair::parse_ring_spec;
use coapt::scene::{Fault, Repair};
use coapt_io::picture::{Quantity, check_name, write_closure_picture};
use coapt_io::plan::in_plan;
use coapt_io::record::Source;
use coapt_io::report::{Closed, Closure, Report, text, write_results};
use coapt_io::scene::{alternative_from_text, located, read_text, sentence};

use crate::case::{self, SizeLimit};
use crate::film::{FilmArguments, Scenery, is_no_folder, make_folder_of};
use crate::interrupt::close_watched;
use crate::output::{Failure, Verdict, print, say};
use crate::whole_number::{THREADS_ALLOWED, whole_number};

/// What `coapt closure` understands.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// A scene file, a folder with a scene.toml, or a preset: healthy, dilated, flail, barlow, restricted
    /// [default: healthy]
    scene: Option<PathBuf>,
    /// A plan file; the valve is closed again after its repairs
    #[arg(long, value_name = "FILE", conflicts_with = "ring")]
    plan: Option<PathBuf>,
    /// An annuloplasty ring as FAMILY:SIZE, such as physio-like:30 (size: inner transverse diameter in mm); families
    /// classic-like, physio-like, saddle, reduced-ap, posterior-band; a plan of one repair
    #[arg(long, value_name = "SPEC")]
    ring: Option<String>,
    /// Folder for report.json and the surfaces (.vtp), made if need be; results of an earlier closure are replaced
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Also draw the closed valve, before and after, from the atrium and from the side: a PNG file
    #[arg(long, value_name = "FILE.png")]
    picture: Option<PathBuf>,
    /// What the picture is coloured by
    #[arg(long, value_enum, default_value_t = Colour::Gap, requires = "picture")]
    colour: Colour,
    /// How the report is printed
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    /// How many threads to use; the result does not depend on it [default: one per core]
    #[arg(long, value_name = "N", value_parser = whole_number(THREADS_ALLOWED), allow_negative_numbers = true)]
    threads: Option<u16>,
    #[command(flatten)]
    film: FilmArguments,
    #[command(flatten)]
    limit: SizeLimit,
}

/// How a report is printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// A table for people.
    Text,
    /// One JSON object.
    Json,
}

/// What a picture is coloured by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Colour {
    /// Distance to the other leaflet.
    Gap,
    /// Mean strain of the edges at a point.
    Strain,
    /// Way from the open valve.
    Displacement,
    /// Which leaflet it is.
    Leaflet,
}

impl From<Colour> for Quantity {
    fn from(colour: Colour) -> Self {
        match colour {
            Colour::Gap => Self::Gap,
            Colour::Strain => Self::Strain,
            Colour::Displacement => Self::Displacement,
            Colour::Leaflet => Self::Leaflet,
        }
    }
}

/// Runs the verb.
pub(crate) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    let case = case::open(arguments.scene.as_deref(), arguments.limit)?;
    let plan = match (&arguments.plan, &arguments.ring) {
        (Some(path), _) => Some(read_plan(path)?),
        (None, Some(spec)) => Some(ring_plan(spec)?),
        (None, None) => None,
    };
    let built = case::build(&case)?;
    arguments.film.prepare()?;
    if let Some(path) = &arguments.picture {
        is_no_folder("--picture", path)?;
        check_name("--picture", path).map_err(|fault| vec![fault])?;
        make_folder_of(path)?;
    }
    let (closure, report, films) = on_threads(arguments.threads, || {
        let closure = close(built, plan.as_ref())?;
        let report = Report::new(&closure);
        let (before, after) = scenery(&closure);
        let films = arguments.film.shoot(before, after);
        Ok((closure, report, films))
    })?;
    if let Some(folder) = &arguments.out {
        write_results(folder, &closure, &report).map_err(Failure::Outside)?;
    }
    if let Some(path) = &arguments.picture {
        write_closure_picture(path, &closure, arguments.colour.into()).map_err(Failure::Outside)?;
    }
    let source = Source {
        scene: &case.scene,
        repairs_before: &[],
        repairs: plan.as_ref().map_or(&[], |plan| &plan.repairs),
    };
    let (before, after) = scenery(&closure);
    arguments.film.write(source, films.as_ref(), before, after)?;
    print(&match arguments.format {
        Format::Text => text(&report),
        Format::Json => report.json().map_err(Failure::Outside)?,
    })?;
    if let Some(folder) = &arguments.out {
        say(&format!("results are in {}", folder.display()));
    }
    Ok(match report.certified() {
        true => Verdict::Done,
        false => Verdict::Uncertified,
    })
}

/// What of a closure is filmed.
fn scenery(closure: &Closure) -> (Scenery<'_>, Option<Scenery<'_>>) {
    let after = closure.after.as_ref();
    (
        Scenery::new(&closure.before, &[]),
        after.map(|after| Scenery::new(after, &closure.repairs)),
    )
}

/// Repairs and where they stand, to name lines in their plan.
struct Planned {
    repairs: Vec<Repair>,
    file: Option<PlanText>,
    warnings: Vec<Fault>,
}

struct PlanText {
    path: PathBuf,
    text: String,
    /// The key of each repair, shape `[repair]`.
    keys: Vec<String>,
}

fn read_plan(path: &Path) -> Result<Planned, Failure> {
    let text = read_text(path).map_err(|fault| vec![fault])?;
    let (mut plan, warnings) = alternative_from_text(path, &text)?;
    let repairs = plan.alternatives.remove(0).repairs;
    Ok(Planned {
        repairs,
        file: Some(PlanText {
            path: path.to_owned(),
            text,
            keys: plan.keys.remove(0),
        }),
        warnings,
    })
}

fn ring_plan(spec: &str) -> Result<Planned, Failure> {
    let ring = parse_ring_spec(spec).map_err(|fault| {
        vec![Fault {
            place: "--ring".into(),
            ..fault
        }]
    })?;
    Ok(Planned {
        repairs: vec![Repair::Ring(ring)],
        file: None,
        warnings: Vec::new(),
    })
}

impl Planned {
    /// A fault of one repair (`ring.size_mm`), with the line of the plan that it speaks of.
    fn located(&self, number: usize, fault: &Fault) -> Fault {
        let Some(PlanText { path, text, keys }) = &self.file else {
            // There is but one ring, which the option names already.
            let message = match fault.place.strip_prefix("ring") {
                Some("") => fault.message.clone(),
                _ => sentence(fault),
            };
            return Fault {
                place: "--ring".into(),
                message,
                ..fault.clone()
            };
        };
        let fault = in_plan(&keys[number], fault);
        located(&path.display().to_string(), text, &fault)
    }
}

/// Closes a valve, and once more from the open state after the repairs.
fn close(built: Built, planned: Option<&Planned>) -> Result<Closure, Failure> {
    let Built {
        model,
        mut warnings,
        untangled,
        chordae_left_out,
    } = built;
    let Some(planned) = planned else {
        return Ok(Closure {
            before: timed("the valve", model),
            after: None,
            repairs: Vec::new(),
            warnings,
            untangled,
            chordae_left_out,
        });
    };
    warnings.extend(planned.warnings.iter().cloned());
    // All repairs before any closing: a wrong plan is told at once.
    let Applied {
        model: repaired_model,
        reports: repairs,
        warnings: doubts,
    } = apply_all(&model, &planned.repairs).map_err(|refusal| -> Vec<Fault> {
        let told = refusal.faults.iter();
        told.map(|fault| planned.located(refusal.repair, fault)).collect()
    })?;
    warnings.extend(
        doubts
            .iter()
            .map(|(number, fault)| planned.located(*number, fault)),
    );
    let (before, after) = rayon::join(
        || timed("before repair", model),
        || timed("after repair", repaired_model),
    );
    Ok(Closure {
        before,
        after: Some(after),
        repairs,
        warnings,
        untangled,
        chordae_left_out,
    })
}

/// Closes a valve from its open state and takes the time; `what` is what an interruption calls it.
pub(crate) fn timed(what: &str, model: Model) -> Closed {
    let start = Instant::now();
    let equilibrium = close_watched(what, &model);
    let wall_ms = start.elapsed().as_secs_f64() * 1e3;
    Closed {
        model,
        equilibrium,
        wall_ms,
    }
}

/// Runs on a pool of so many threads, or as the machine has it.
pub(crate) fn on_threads<T: Send>(
    threads: Option<u16>,
    work: impl FnOnce() -> Result<T, Failure> + Send,
) -> Result<T, Failure> {
    let Some(threads) = threads else { return work() };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(usize::from(threads))
        .build();
    match pool {
        Ok(pool) => pool.install(work),
        Err(error) => Err(Failure::Outside(Fault::error("--threads", error.to_string()))),
    }
}

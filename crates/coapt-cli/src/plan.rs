//! `coapt plan`: compares many surgical alternatives in one table.

use std::io::IsTerminal;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use clap::{Args, value_parser};
use coapt::model::{Built, Model, size};
use coapt::plan::{Comparison, Progress, Settings, compare_watched};
use coapt::scene::Fault;
use coapt_io::plan::{PlanFile, PlanReport, in_plan, prepare_shapes, text, write_plan};
use coapt_io::scene::{ALTERNATIVE_LIMIT, Alternatives, alternatives_from_text, located, read_text};

use crate::case::{self, SizeLimit};
use crate::closure::{Format, on_threads};
use crate::interrupt::{note_closed, watching};
use crate::output::{Failure, Verdict, count_line, print, say};
use crate::study::prepare;

/// What `coapt plan` understands.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// A scene file, a folder with a scene.toml, or a preset: healthy, dilated, flail, barlow, restricted
    scene: PathBuf,
    /// A plan file: repairs that every alternative begins with as `[[repair]]`, alternatives as `[[alternative]]` with
    /// `[[alternative.repair]]`; a list such as `size_mm = [26, 28]` or a range such as `size_mm = { from = 26, to = 32, step = 2 }`
    /// stands for several values
    plan: PathBuf,
    /// Folder for plan.json and the tables (.csv), made if need be; results of an earlier run are replaced
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Also write the closed leaflets of every alternative, to shapes/ in that folder
    #[arg(long, requires = "out")]
    shapes: bool,
    /// How the comparison is printed
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    /// Refuse plans of more alternatives, before any is made
    #[arg(long, value_name = "N", default_value_t = ALTERNATIVE_LIMIT, value_parser = value_parser!(u64).range(1..))]
    max_alternatives: u64,
    /// How many threads to use; the result does not depend on it [default: one per core]
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    #[command(flatten)]
    limit: SizeLimit,
}

/// Runs the verb.
pub(crate) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    let case = case::open(Some(&arguments.scene), arguments.limit)?;
    let plan_text = read_text(&arguments.plan).map_err(|fault| vec![fault])?;
    let (plan, mut warnings) = read(&arguments.plan, &plan_text, arguments.max_alternatives)?;
    let Built {
        model,
        warnings: more,
        ..
    } = case::build(&case)?;
    warnings.splice(..0, more);
    // Before minutes of work, not after.
    if let Some(folder) = &arguments.out {
        prepare(folder)?;
        if arguments.shapes {
            prepare_shapes(folder).map_err(Failure::Outside)?;
        }
    }
    let begun = Instant::now();
    let settings = Settings {
        criteria: plan.criteria.clone(),
        keep_positions: arguments.shapes,
    };
    let comparison = on_threads(arguments.threads, || Ok(compare(&model, &plan, &settings)))?;
    let took = begun.elapsed();
    let name = arguments.plan.display().to_string();
    let file = PlanFile {
        name: &name,
        text: &plan_text,
    };
    let report = PlanReport::new(&model, file, &plan, &comparison, &warnings);
    if report.all_refused() {
        return Err(all_faults(file, &plan, &comparison).into());
    }
    if let Some(folder) = &arguments.out {
        write_plan(folder, &report, &model, &plan, &comparison).map_err(Failure::Outside)?;
    }
    print(&match arguments.format {
        Format::Text => text(&report),
        Format::Json => report.json().map_err(Failure::Outside)?,
    })?;
    say(&format!(
        "{} closures in {:.1} s",
        plan.alternatives.len() + 1,
        took.as_secs_f64()
    ));
    if let Some(folder) = &arguments.out {
        say(&format!("results are in {}", folder.display()));
    }
    Ok(match report.certified() {
        true => Verdict::Done,
        false => Verdict::Uncertified,
    })
}

fn read(path: &Path, text: &str, limit: u64) -> Result<(Alternatives, Vec<Fault>), Vec<Fault>> {
    let (plan, warnings) = alternatives_from_text(path, text, limit)?;
    if plan
        .alternatives
        .iter()
        .all(|alternative| alternative.repairs.is_empty())
    {
        let message = "the plan has no repair; expected at least one [[repair]] or [[alternative.repair]]";
        return Err(vec![Fault::error(path.display().to_string(), message)]);
    }
    Ok((plan, warnings))
}

/// Closes all, and tells of it.
fn compare(model: &Model, plan: &Alternatives, settings: &Settings) -> Comparison {
    if let Some(notice) = size::notice(model.faces.len()) {
        say(&format!("each closure: {notice} ..."));
    }
    let counter = Counter::new(plan.alternatives.len() + 1);
    watching("the alternatives", |watch| {
        compare_watched(model, &plan.alternatives, settings, &|progress| match progress {
            Progress::Iterated(moment) => watch(moment),
            Progress::Closed => {
                note_closed();
                counter.step();
                ControlFlow::Continue(())
            }
            Progress::Refused => {
                counter.step();
                ControlFlow::Continue(())
            }
        })
    })
}

/// Why none could be carried out; the same fault of several alternatives once.
fn all_faults(file: PlanFile, plan: &Alternatives, comparison: &Comparison) -> Vec<Fault> {
    let mut faults: Vec<Fault> = Vec::new();
    for row in &comparison.rows {
        let Err(refusal) = &row.result else { continue };
        let key = &plan.keys[row.alternative][refusal.repair];
        for fault in &refusal.faults {
            let fault = located(file.name, file.text, &in_plan(key, fault));
            if faults.len() == MOST_FAULTS {
                faults.push(Fault::error(file.name, "and more like these"));
                return faults;
            }
            if !faults.contains(&fault) {
                faults.push(fault);
            }
        }
    }
    faults
}

/// As many as of any other file.
const MOST_FAULTS: usize = 20;

/// How often the count is shown: more often nobody can read.
const SHOW_EVERY: Duration = Duration::from_millis(100);

/// A line that counts, for who sits before a terminal.
struct Counter {
    all: usize,
    begun: Instant,
    /// How many are done, and when that was last shown; none where nobody looks.
    shown: Option<Mutex<(usize, Instant)>>,
}

impl Counter {
    fn new(all: usize) -> Self {
        let begun = Instant::now();
        let is_seen = std::io::stderr().is_terminal();
        Self {
            all,
            begun,
            shown: is_seen.then(|| Mutex::new((0, begun))),
        }
    }

    fn step(&self) {
        let Some(Ok(mut shown)) = self.shown.as_ref().map(Mutex::lock) else {
            return;
        };
        shown.0 += 1;
        let (done, last) = *shown;
        if last.elapsed() < SHOW_EVERY {
            return;
        }
        shown.1 = Instant::now();
        let left = self.begun.elapsed().as_secs_f64() * (self.all - done.min(self.all)) as f64 / done as f64;
        count_line(&format!("{done} of {} closed, about {left:.0} s left", self.all));
    }
}

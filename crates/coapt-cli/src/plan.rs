//! `coapt plan`: compares many surgical alternatives in one table.

use std::io::IsTerminal;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use clap::{Args, value_parser};
use coapt::model::{Built, Model, size};
use coapt::personalise::Watch;
use coapt::plan::{Comparison, Progress, Row, Sampling, Settings, Summaries, compare_watched, summaries};
use coapt::scene::Fault;
use coapt_io::plan::{
    PlanFile, PlanReport, SearchReport, found, in_plan, prepare_shapes, rates_of, text, write_plan,
};
use coapt_io::scene::{
    ALTERNATIVE_LIMIT, Alternatives, SAMPLE_LIMIT, Search, alternatives_from_text, located, read_text,
};
use rayon::prelude::*;

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
    /// Begin alternatives that differ from an earlier one in their last repair alone at its closed shape: to look through many, in a
    /// fraction of the time; where they come to rest may depend a little on it
    #[arg(long)]
    warm: bool,
    /// Also relax every valve without pressure, for the orifice that it opens to; as `diastole = true` in the plan
    #[arg(long)]
    diastole: bool,
    /// Also tell how fast the criteria change with the numbers in the repairs and the length of the chordae; as
    /// `sensitivities = true` in the plan
    #[arg(long)]
    sensitivities: bool,
    /// Also close so many valves that an image could not tell from the given one, before and after the best alternatives; as
    /// `samples` of `[uncertainty]` in the plan
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=i64::from(SAMPLE_LIMIT)))]
    samples: Option<u32>,
    /// Which such valves: the same seed gives the same ones [default: 1]
    #[arg(long, value_name = "S")]
    seed: Option<u64>,
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
    let (mut plan, mut warnings) = read(&arguments.plan, &plan_text, arguments.max_alternatives)?;
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
    ask(arguments, &mut plan)?;
    let name = arguments.plan.display().to_string();
    let file = PlanFile {
        name: &name,
        text: &plan_text,
    };
    let (report, comparison) = on_threads(arguments.threads, || {
        work(arguments, &model, file, &plan, &warnings)
    })?;
    if let Some(folder) = &arguments.out {
        write_plan(folder, &report, &model, &plan, &comparison).map_err(Failure::Outside)?;
    }
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

/// What the command line asks for beside the plan.
fn ask(arguments: &Arguments, plan: &mut Alternatives) -> Result<(), Failure> {
    let asked = &mut plan.asked;
    asked.diastole |= arguments.diastole;
    asked.sensitivities |= arguments.sensitivities;
    if let Some(samples) = arguments.samples {
        asked.sampling.get_or_insert_default().samples = samples;
    }
    match (arguments.seed, &mut asked.sampling) {
        (Some(seed), Some(sampling)) => sampling.seed = seed,
        (Some(_), None) => {
            let message =
                "is given without an ensemble; expected --samples beside it, or [uncertainty] in the plan";
            return Err(vec![Fault::error("--seed", message)].into());
        }
        (None, _) => {}
    }
    Ok(())
}

/// Does all that is asked for.
fn work(
    arguments: &Arguments,
    model: &Model,
    file: PlanFile,
    plan: &Alternatives,
    warnings: &[Fault],
) -> Result<(PlanReport, Comparison), Failure> {
    let asked = &plan.asked;
    let settings = Settings {
        criteria: plan.ranked_by(),
        keep_positions: arguments.shapes || asked.sensitivities,
        diastole: asked.diastole,
        warm: arguments.warm,
    };
    // First: it may be refused.
    let found = match &asked.search {
        Some(sought) => Some(search(model, file, sought)?),
        None => None,
    };
    let count = plan.alternatives.len() + 1;
    let mut comparison = timed(&format!("{count} closures"), || compare(model, plan, &settings));
    let mut report = PlanReport::new(model, file, plan, &comparison, warnings);
    if report.all_refused() {
        return Err(all_faults(file, plan, &comparison).into());
    }
    report.search = found;
    if let Some(sampling) = &asked.sampling {
        report = report.with_ensembles(&sample(model, plan, &comparison, sampling));
    }
    if asked.sensitivities {
        report = rated(report, model, plan, &comparison);
        if !arguments.shapes {
            forget_shapes(&mut comparison);
        }
    }
    Ok((report, comparison))
}

/// Does something and says how long it took.
fn timed<T>(what: &str, work: impl FnOnce() -> T) -> T {
    let begun = Instant::now();
    let done = work();
    say(&format!("{what} in {:.1} s", begun.elapsed().as_secs_f64()));
    done
}

fn search(model: &Model, file: PlanFile, sought: &Search) -> Result<SearchReport, Vec<Fault>> {
    let told = |faults: Vec<Fault>| {
        let located = |fault: &Fault| located(file.name, file.text, fault);
        faults.iter().map(located).collect::<Vec<_>>()
    };
    timed("search", || {
        watching("the search", |watch| found(model, sought, watch)).map_err(told)
    })
}

fn sample(model: &Model, plan: &Alternatives, comparison: &Comparison, sampling: &Sampling) -> Summaries {
    let count = sampling.samples as usize * (sampling.count(comparison) + 1);
    let counter = Counter::new(count);
    timed(&format!("{count} samples"), || {
        watching("the samples", |watch| {
            summaries(model, &plan.alternatives, comparison, sampling, &|progress| {
                counted(progress, &counter, watch)
            })
        })
    })
}

/// The report with rates of each row.
fn rated(report: PlanReport, model: &Model, plan: &Alternatives, comparison: &Comparison) -> PlanReport {
    let of = |row: &Row| {
        let outcome = row.result.as_ref().ok()?;
        let repairs = &plan.alternatives[row.alternative].repairs;
        Some(rates_of(model, repairs, outcome))
    };
    let before = rates_of(model, &[], &comparison.before);
    let rows: Vec<_> = comparison.rows.par_iter().map(of).collect();
    report.with_rates(&before, &rows)
}

/// Shapes that were kept for rates alone are not written.
fn forget_shapes(comparison: &mut Comparison) {
    let outcomes = comparison
        .rows
        .iter_mut()
        .filter_map(|row| row.result.as_mut().ok());
    for outcome in outcomes.chain([&mut comparison.before]) {
        outcome.positions_mm.clear();
    }
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
        compare_watched(model, &plan.alternatives, settings, &|progress| {
            counted(progress, &counter, watch)
        })
    })
}

/// Notes what closes, for the line that counts and for an interruption.
fn counted(progress: &Progress, counter: &Counter, watch: Watch) -> ControlFlow<()> {
    match progress {
        Progress::Iterated(moment) => return watch(moment),
        Progress::Closed => note_closed(),
        Progress::Refused => {}
    }
    counter.step();
    ControlFlow::Continue(())
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

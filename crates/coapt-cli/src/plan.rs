//! `coapt plan`: compares many surgical alternatives in one table.

use std::io::IsTerminal;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use clap::Args;
use coapt::model::{Built, Model, size};
use coapt::personalise::Watch;
use coapt::plan::{self, Applied, Comparison, Progress, apply_all};
use coapt::scene::{Fault, Repair, Scene};
use coapt_io::plan::{PlanFile, Shapes, Stage, carry_out, filmed, prepare_shapes, text, write_plan};
use coapt_io::record::Source;
use coapt_io::report::Closed;
use coapt_io::scene::{ALTERNATIVE_LIMIT, Alternatives, SAMPLE_LIMIT, alternatives_from_text, read_text};

use crate::case::{self, SizeLimit};
use crate::closure::{self, Format, on_threads};
use crate::film::{FilmArguments, Films, Scenery};
use crate::interrupt::{note_closed, watching};
use crate::output::{Failure, Verdict, count_line, print, say};
use crate::study::prepare;
use crate::whole_number::{THREADS_ALLOWED, whole_number};

/// What `coapt plan` understands.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// A scene file, a folder with a scene.toml, or a preset: healthy, dilated, flail, barlow, restricted
    scene: PathBuf,
    /// A plan file: repairs that every alternative begins with as `[[repair]]`, alternatives as `[[alternative]]` with
    /// `[[alternative.repair]]`; a list such as `size_mm = [26, 28]` or a range such as `size_mm = { from = 26, to = 32, step = 2 }`
    /// stands for several values
    plan: PathBuf,
    /// Folder for plan.json and the tables (.csv), made if need be; results of an earlier plan are replaced
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Also write the closed leaflets of every alternative, to shapes/ in that folder
    #[arg(long, requires = "out")]
    shapes: bool,
    /// Begin alternatives that differ from an earlier one in their last repair alone at its closed shape: to look through many, in half
    /// of the time or less; where they come to rest may depend a little on it; as `warm = true` in the plan
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
    #[arg(long, value_name = "N", value_parser = whole_number(1..=SAMPLE_LIMIT), allow_negative_numbers = true)]
    samples: Option<u32>,
    /// Which such valves: the same seed gives the same ones [default: 1]
    #[arg(long, value_name = "S", value_parser = whole_number(0..=u64::MAX), allow_negative_numbers = true)]
    seed: Option<u64>,
    /// How the comparison is printed
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    /// Refuse plans of more alternatives, before any is made
    #[arg(long, value_name = "N", default_value_t = ALTERNATIVE_LIMIT, value_parser = whole_number(1..=u64::MAX), allow_negative_numbers = true)]
    max_alternatives: u64,
    /// How many threads to use; the result does not depend on it [default: one per core]
    #[arg(long, value_name = "N", value_parser = whole_number(THREADS_ALLOWED), allow_negative_numbers = true)]
    threads: Option<u16>,
    #[command(flatten)]
    film: FilmArguments,
    #[command(flatten)]
    limit: SizeLimit,
}

/// Runs the verb.
pub(crate) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    let case = case::open(Some(&arguments.scene), arguments.limit)?;
    let plan_text = read_text(&arguments.plan).map_err(|fault| vec![fault])?;
    let (mut alternatives, mut warnings) =
        alternatives_from_text(&arguments.plan, &plan_text, arguments.max_alternatives)?;
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
    arguments.film.prepare()?;
    ask(arguments, &mut alternatives)?;
    let name = arguments.plan.display().to_string();
    let file = PlanFile {
        name: &name,
        text: &plan_text,
    };
    let (report, comparison, best) = on_threads(arguments.threads, || {
        let on_stage = |stage, work: &mut dyn FnMut(plan::Watch)| staged(&model, stage, work);
        let (report, comparison) = carry_out(
            &model,
            file,
            &mut alternatives,
            arguments.shapes,
            &warnings,
            &on_stage,
        )?;
        let asked = arguments.film.is_asked_for();
        let best = asked.then(|| Best::film(&arguments.film, &model, &alternatives, &comparison));
        Ok((report, comparison, best))
    })?;
    if let Some(folder) = &arguments.out {
        write_plan(folder, &report, &model, &Shapes::from(comparison)).map_err(Failure::Outside)?;
    }
    if let Some(best) = &best {
        best.write(&arguments.film, &case.scene)?;
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

/// What of a comparison is filmed: the valve as it is and after the alternative that ranks first. Both are closed again, as the comparison
/// closed them; it keeps shapes at most.
struct Best {
    before: Closed,
    after: Option<(Closed, Applied)>,
    repairs: Vec<Repair>,
    films: Option<Films>,
}

impl Best {
    fn film(film: &FilmArguments, model: &Model, plan: &Alternatives, comparison: &Comparison) -> Self {
        let first = filmed(plan, comparison);
        match first {
            Some(alternative) => say(&format!(
                "filming the valve as it is and after `{}` ...",
                alternative.name
            )),
            None => say("no alternative is certified: filming the valve as it is ..."),
        }
        let repairs = first.map_or(Vec::new(), |alternative| alternative.repairs.clone());
        // An alternative may be to do nothing.
        let applied = match repairs.is_empty() {
            true => None,
            false => apply_all(model, &repairs).ok(),
        };
        let (before, after) = rayon::join(
            || closure::timed("before repair", model.clone()),
            || applied.map(|applied| (closure::timed("after repair", applied.model.clone()), applied)),
        );
        let mut best = Self {
            before,
            after,
            repairs,
            films: None,
        };
        let (before, after) = best.scenery();
        best.films = film.shoot(before, after);
        best
    }

    fn scenery(&self) -> (Scenery<'_>, Option<Scenery<'_>>) {
        let after = self.after.as_ref();
        (
            Scenery::new(&self.before, &[]),
            after.map(|(closed, applied)| Scenery::new(closed, &applied.reports)),
        )
    }

    fn write(&self, film: &FilmArguments, scene: &Scene) -> Result<(), Failure> {
        let source = Source {
            scene,
            repairs_before: &[],
            repairs: &self.repairs,
        };
        let (before, after) = self.scenery();
        film.write(source, self.films.as_ref(), before, after)
    }
}

/// What the command line asks for beside the plan.
fn ask(arguments: &Arguments, plan: &mut Alternatives) -> Result<(), Failure> {
    let asked = &mut plan.asked;
    asked.diastole |= arguments.diastole;
    asked.sensitivities |= arguments.sensitivities;
    asked.warm |= arguments.warm;
    if asked.warm && arguments.film.is_asked_for() {
        let message = "is asked for beside `warm`; expected alternatives that begin at the open valve, from which a film can be made again";
        return Err(vec![Fault::error("a film", message)].into());
    }
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

/// Does something and says how long it took.
fn timed<T>(what: &str, work: impl FnOnce() -> T) -> T {
    let begun = Instant::now();
    let done = work();
    say(&format!("{what} in {:.1} s", begun.elapsed().as_secs_f64()));
    done
}

/// Does a stage of the plan, counted, timed, and told where it is interrupted.
fn staged(model: &Model, stage: Stage, work: &mut dyn FnMut(plan::Watch)) {
    let (what, closures, name) = match stage {
        Stage::Search => ("search".to_owned(), None, "the search"),
        Stage::Alternatives(count) => (format!("{count} closures"), Some(count), "the alternatives"),
        Stage::Samples(count) => (format!("{count} samples"), Some(count), "the samples"),
    };
    timed(&what, || {
        if let (Stage::Alternatives(_), Some(notice)) = (stage, size::notice(model.faces.len())) {
            say(&format!("each closure: {notice} ..."));
        }
        let counter = closures.map(Counter::new);
        watching(name, |watch| {
            work(&|progress| match &counter {
                Some(counter) => counted(progress, counter, watch),
                None => iterated(progress, watch),
            });
        });
    });
}

/// Notes how far a closure of the search is.
fn iterated(progress: &Progress, watch: Watch) -> ControlFlow<()> {
    match progress {
        Progress::Iterated(moment) => watch(moment),
        Progress::Closed | Progress::Refused => ControlFlow::Continue(()),
    }
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

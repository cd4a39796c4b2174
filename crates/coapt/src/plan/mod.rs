//! Many surgical alternatives for one valve, each closed from its open state, ranked by stated criteria.

mod criteria;
mod diastole;
pub mod ensemble;
mod ranking;
mod rates;
mod sampling;
mod warm;

use std::ops::ControlFlow;

use rayon::prelude::*;

pub use criteria::{COAPTATION_TARGET_MM, Criterion, DIASTOLIC_TARGET_MM2, largest_strain};
pub use diastole::Diastole;
pub use rates::{CHORD_SCALE, Number, Rates, rates};
pub use sampling::{Sampling, Summaries, Summary, summaries};

use crate::Vec3;
use crate::measure::flow::regurgitant_volume_ml;
use crate::measure::{Measures, SlackNeochord, measure, measure_with_passage, slack_neochordae};
use crate::model::Model;
use crate::relax::{Certificate, Moment, Status, relax_watched};
use crate::repair::{self, Report};
use crate::scene::{Fault, MMHG_MPA, Repair};
use crate::state::State;

/// One way to repair a valve.
#[derive(Clone, Debug, PartialEq)]
pub struct Alternative {
    /// What it is called in reports.
    pub name: String,
    /// Its repairs, in the order in which they are applied.
    pub repairs: Vec<Repair>,
}

impl Alternative {
    /// Whether nothing is done but to tear or cut chordae: what if, and no repair. Who cuts strut chordae against tethering does so
    /// beside a ring or a patch.
    pub fn only_takes_chordae(&self) -> bool {
        let takes = |repair: &Repair| matches!(repair, Repair::Rupture(_) | Repair::CutChord(_));
        !self.repairs.is_empty() && self.repairs.iter().all(takes)
    }

    /// Whether the leaflets are joined edge to edge, which leaves less to be flowed through.
    pub fn joins_edges(&self) -> bool {
        self.repairs.iter().any(joins_edges)
    }
}

fn joins_edges(repair: &Repair) -> bool {
    matches!(repair, Repair::Clip(_) | Repair::Alfieri(_))
}

/// How alternatives are compared.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// What ranks them, the most important first.
    pub criteria: Vec<Criterion>,
    /// Whether the closed shapes are kept: of thousands of large valves they fill the memory.
    pub keep_positions: bool,
    /// Whether each valve is also relaxed without pressure: that takes 0.1 to 0.7 times the time of a closure (the presets, and a
    /// dilated valve after twelve rings).
    pub diastole: bool,
    /// Whether the [narrowest passage](crate::measure::passage_mm2) is measured too.
    pub passage: bool,
    /// Whether alternatives that differ from an earlier one in their last repair alone begin at its closed shape: see [`compare`].
    pub warm: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            criteria: Criterion::DEFAULT.to_vec(),
            keep_positions: false,
            diastole: false,
            passage: true,
            warm: false,
        }
    }
}

/// The valve as it is, and what the alternatives make of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Without any repair.
    pub before: Outcome,
    /// First those that are ranked, the best first; then certified ones that [only take chordae
    /// away](Alternative::only_takes_chordae), in the order that they would have; then those that closed without a certificate; then
    /// those that could not be carried out; each of the last two in the order of the alternatives.
    pub rows: Vec<Row>,
}

/// What came of one alternative.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Which one, from 0.
    pub alternative: usize,
    /// Its place, from 1; alternatives that no criterion tells apart share one, and the places after it stay empty. None
    /// without a certificate, nor where it is no repair.
    pub rank: Option<usize>,
    /// Whether it [only takes chordae away](Alternative::only_takes_chordae).
    pub only_takes_chordae: bool,
    /// The closed valve, or why it could not be repaired.
    pub result: Result<Outcome, Refusal>,
}

/// A valve closed after its repairs.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Why the solver stopped.
    pub status: Status,
    /// How far the result can be trusted.
    pub certificate: Certificate,
    /// Solver iterations.
    pub iterations: usize,
    /// The alternative at whose closed shape it began, and at whose opened one its open valve did, from 0; none where it began open.
    pub begun_at: Option<usize>,
    /// What it measures.
    pub measures: Measures,
    /// What that orifice would let back in a beat at the valve's pressure, from a sharp to a rounded one [mL]; see
    /// [`regurgitant_volume_ml`].
    pub regurgitant_volume_ml: [f64; 2],
    /// The same valve without pressure; none unless it was asked for.
    pub diastole: Option<Diastole>,
    /// What the repairs did, in their order.
    pub repairs: Vec<Report>,
    /// Neochordae that hold nothing back, or of which some strands do not.
    pub slack_neochordae: Vec<SlackNeochord>,
    /// Doubts about the repairs, each with the number of its repair from 0.
    pub warnings: Vec<(usize, Fault)>,
    /// Where the vertices came to rest [mm], shape `[vertex]`; empty unless they were asked for.
    pub positions_mm: Vec<Vec3>,
}

impl Outcome {
    /// Whether the result may be used: converged, stable, nothing crosses.
    pub fn is_certified(&self) -> bool {
        self.certificate.is_certified(self.status)
    }

    fn forget_positions(&mut self) {
        self.positions_mm = Vec::new();
        if let Some(diastole) = &mut self.diastole {
            diastole.positions_mm = Vec::new();
        }
    }
}

/// Why an alternative could not be carried out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// The number of the repair that could not be applied, from 0.
    pub repair: usize,
    /// What is wrong with it, with the key in the repair.
    pub faults: Vec<Fault>,
}

/// What a watcher is shown.
#[derive(Clone, Copy, Debug)]
pub enum Progress<'a> {
    /// A closure made an iteration.
    Iterated(&'a Moment<'a>),
    /// A closure came to its end.
    Closed,
    /// An alternative could not be carried out.
    Refused,
}

/// Looks on at closures that run side by side, and stops them by answering `Break`: what is not closed by then ends
/// as [`Status::Interrupted`].
pub type Watch<'a> = &'a (dyn Fn(&Progress) -> ControlFlow<()> + Sync);

/// Closes a valve as it is and after each alternative, on as many threads as there are, and ranks the alternatives.
///
/// Each closure begins at the open valve: beginning at the closed valve before the repair, the answer would depend on the road. On
/// dilated valves of 650 faces after rings, the visible surface then lay up to 0.08 mm (root mean square) elsewhere and the
/// coaptation length up to 0.5 mm, on valves with much tissue to spare up to 1.5 mm and 1.4 mm, each certified; and moving the
/// annulus under closed leaflets took as long. If the settings say `warm`, alternatives begin at the closed shapes of others that
/// differ in their last repair alone, which is less far, and quick.
///
/// The result is the same, to the last bit, at any number of threads.
pub fn compare(model: &Model, alternatives: &[Alternative], settings: &Settings) -> Comparison {
    compare_watched(model, alternatives, settings, &|_| ControlFlow::Continue(()))
}

/// The same with somebody looking on, which changes no bit of the result.
pub fn compare_watched(
    model: &Model,
    alternatives: &[Alternative],
    settings: &Settings,
    watch: Watch,
) -> Comparison {
    let all = || -> Vec<Row> {
        let attempt = |(number, alternative): (usize, &Alternative)| Row {
            alternative: number,
            rank: None,
            only_takes_chordae: alternative.only_takes_chordae(),
            result: attempted(model, alternative, settings, watch),
        };
        if settings.warm {
            return warm::rows(model, alternatives, settings, watch);
        }
        // One at a time: closures take from a tenth to tens of times the mean.
        let rows = alternatives.par_iter().enumerate().with_max_len(1);
        rows.map(attempt).collect()
    };
    let untouched = || Applied {
        model: model.clone(),
        reports: Vec::new(),
        warnings: Vec::new(),
    };
    let (before, mut rows) = rayon::join(|| closed(untouched(), Start::default(), settings, watch), all);
    ranking::rank(&mut rows, &settings.criteria);
    Comparison { before, rows }
}

/// The model after some repairs, what they did, and doubts with the number of their repair.
#[derive(Clone, Debug)]
pub struct Applied {
    /// The new model.
    pub model: Model,
    /// What was done, in figures, shape `[repair]`.
    pub reports: Vec<Report>,
    /// Guesses and doubts, each with the number of its repair from 0.
    pub warnings: Vec<(usize, Fault)>,
}

/// Applies repairs, one after the other.
///
/// # Errors
/// Which repair cannot be carried out, and why.
pub fn apply_all(model: &Model, repairs: &[Repair]) -> Result<Applied, Refusal> {
    let mut applied = Applied {
        model: model.clone(),
        reports: Vec::new(),
        warnings: Vec::new(),
    };
    for (number, deed) in repairs.iter().enumerate() {
        refuse_second_ring(&repairs[..number], deed).map_err(|fault| Refusal {
            repair: number,
            faults: vec![fault],
        })?;
        let repaired = repair::apply(&applied.model, deed).map_err(|faults| Refusal {
            repair: number,
            faults,
        })?;
        applied.model = repaired.model;
        applied.reports.push(repaired.report);
        applied
            .warnings
            .extend(repaired.warnings.into_iter().map(|fault| (number, fault)));
    }
    Ok(applied)
}

/// What is wrong with repairs in themselves, whatever the valve's shape, each with the number of its repair from 0. What cannot be
/// carried out is passed over, so that what is wrong behind it is told as well; behind one that this valve's shape does not allow
/// nothing is, since it may build on it.
pub fn wrong_input(model: &Model, repairs: &[Repair]) -> Vec<(usize, Fault)> {
    let mut model = model.clone();
    let mut wrong = Vec::new();
    for (number, deed) in repairs.iter().enumerate() {
        let faults = match refuse_second_ring(&repairs[..number], deed) {
            Err(fault) => vec![fault],
            Ok(()) => match repair::apply(&model, deed) {
                Ok(repaired) => {
                    model = repaired.model;
                    continue;
                }
                Err(faults) => faults,
            },
        };
        let of_input = faults.into_iter().filter(|fault| !fault.of_shape);
        let before = wrong.len();
        wrong.extend(of_input.map(|fault| (number, fault)));
        if wrong.len() == before {
            break;
        }
    }
    wrong
}

/// A ring draws the annulus onto itself, whatever drew it elsewhere before: of two, only the last would show.
///
/// # Errors
/// If the repair is a ring and there was one before.
pub fn refuse_second_ring(before: &[Repair], deed: &Repair) -> Result<(), Fault> {
    let is_ring = |repair: &Repair| matches!(repair, Repair::Ring(_));
    match before.iter().position(is_ring) {
        Some(first) if is_ring(deed) => Err(Fault::error(
            "ring",
            format!(
                "it would be sewn where repair[{first}] has sewn a ring; expected one ring, and others as alternatives"
            ),
        )),
        _ => Ok(()),
    }
}

fn attempted(
    model: &Model,
    alternative: &Alternative,
    settings: &Settings,
    watch: Watch,
) -> Result<Outcome, Refusal> {
    let result = apply_all(model, &alternative.repairs)
        .map(|applied| closed(applied, Start::default(), settings, watch));
    if result.is_err() {
        // There is no closure to be stopped.
        let _ = watch(&Progress::Refused);
    }
    result
}

/// Where a valve begins to close, and to open without pressure; at its open state where nothing is said.
#[derive(Clone, Copy, Debug, Default)]
struct Start<'a> {
    closed: Option<&'a State>,
    opened: Option<&'a State>,
}

/// Closes a valve, and opens it where that is asked for. A start of another number of vertices is none.
fn closed(applied: Applied, start: Start, settings: &Settings, watch: Watch) -> Outcome {
    let model = &applied.model;
    let look = |moment: &Moment| watch(&Progress::Iterated(moment));
    let own = State::open(model);
    let equilibrium = match start.closed {
        Some(start) if start.positions_mm.len() == model.rest_mm.len() => relax_watched(model, start, look),
        _ => relax_watched(model, &own, look),
    };
    let positions_mm = equilibrium.state.positions_mm;
    let measure = match settings.passage {
        true => measure_with_passage,
        false => measure,
    };
    let measures = measure(model, &positions_mm, &equilibrium.reactions_n);
    let diastole = settings
        .diastole
        .then(|| diastole::diastole(model, start.opened.unwrap_or(&own), look));
    let mut outcome = Outcome {
        status: equilibrium.status,
        certificate: equilibrium.certificate,
        iterations: equilibrium.history.len(),
        begun_at: None,
        regurgitant_volume_ml: regurgitant_volume_ml(
            measures.orifice.area_mm2,
            model.pressure_mpa / MMHG_MPA,
        ),
        measures,
        diastole,
        slack_neochordae: slack_neochordae(model, &applied.reports, &positions_mm),
        repairs: applied.reports,
        warnings: applied.warnings,
        positions_mm,
    };
    if !settings.keep_positions {
        outcome.forget_positions();
    }
    // What is closed is closed.
    let _ = watch(&Progress::Closed);
    outcome
}

#[cfg(test)]
mod tests;

//! A comparison of surgical alternatives: its results, as tables for people and machines.
//!
//! | file | holds |
//! |---|---|
//! | `plan.json` | everything |
//! | `plan.csv` | a line per alternative, a column per measure |
//! | `plan_long.csv`, `plan_units.csv` | a line per measure of a certified closure, in the long layout of `SlicerHeart`'s batch export, with its table of units |
//! | `shapes/NUMBER_NAME.vtp`, `..._chords.vtp`, `..._ring.vtp` | the closed leaflets of each alternative, its chords and its ring, where asked for |

pub(crate) mod below;
mod carry_out;
mod files;
mod long;
mod more;
pub(crate) mod search;
mod table;
pub(crate) mod text;
pub(crate) mod words;

use std::borrow::Cow;
use std::collections::BTreeMap;

use coapt::Vec3;
use coapt::measure::{Measures, SlackNeochord, ValveFrame, valve_frame};
use coapt::model::Model;
use coapt::plan::{Alternative, Comparison, Criterion, Outcome};
use coapt::relax::Status;
use coapt::repair::{Report, RingExtent};
use coapt::scene::{Contact, Fault, MMHG_MPA, Repair, Settings};
use serde::{Deserialize, Serialize};

use crate::report::{MeshSize, NOTICE, RepairReport, repair_report};
use crate::scene::{Alternatives, locate, sentence};

pub use carry_out::{OnStage, Stage, carry_out, filmed};
pub use files::{Shapes, prepare_shapes, write_plan};
pub use long::{long_csv, units_csv};
pub use more::{Open, Rate, RatesFound, Sampled, Sensitivities, rates_of};
pub use search::{SearchReport, found, measured};
pub use table::csv;
pub use text::text;

/// The layout of `plan.json`.
pub const PLAN_SCHEMA: &str = "coapt-plan/1";

/// Everything that is told of a comparison. Units are in the names.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlanReport {
    /// [`PLAN_SCHEMA`].
    pub schema: Cow<'static, str>,
    /// Version of the program.
    pub version: Cow<'static, str>,
    /// [`NOTICE`].
    pub notice: Cow<'static, str>,
    /// Name of the case.
    pub case: String,
    /// Name of the plan; empty where it has none.
    pub plan: String,
    /// Transvalvular pressure [mmHg].
    pub pressure_mmhg: f64,
    /// Size of the model before any repair.
    pub mesh: MeshSize,
    /// How the equilibrium was sought.
    pub settings: Settings,
    /// How leaflets touch.
    pub contact: Contact,
    /// Which way is which in the valve closed before any repair; absent where the annulus has no plane.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame: Option<ValveFrame>,
    /// What ranks, the most important first.
    pub ranking: Vec<Ranking>,
    /// The valve without any repair.
    pub before: Closed,
    /// Ranked ones first, the best first; then certified ones that are no repair; then what closed without a certificate; then what
    /// could not be carried out.
    pub alternatives: Vec<Row>,
    /// What was sought and found; absent where nothing was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub search: Option<SearchReport>,
    /// Published anatomic limits for repairs of this plan that the valve as it is can be held against. They are information: nothing
    /// follows from them here.
    pub anatomic_limits: Vec<AnatomicLimit>,
    /// Repairs of the input, guesses and doubts.
    pub warnings: Vec<String>,
}

/// A published limit of the anatomy for some repair.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AnatomicLimit {
    /// For which repair it was published.
    pub repair: Cow<'static, str>,
    /// Path of the measure in `before`.
    pub measure: Cow<'static, str>,
    /// Its value there.
    pub value: f64,
    /// The least that was asked for, in the unit of the measure.
    pub at_least: f64,
    /// Where.
    pub source: Cow<'static, str>,
}

/// The limits whose measures mean what ours do: coaptation length at A2-P2. Not among them: coaptation depth, flail gap and width,
/// which are taken in echo sections that our measures do not cut, and the mitral valve area, which is that of an open valve in flow.
fn anatomic_limits(plan: &Alternatives, before: &Outcome) -> Vec<AnatomicLimit> {
    // A shape without a certificate has no figures to be held against anything.
    if !before.is_certified() || !plan.alternatives.iter().any(Alternative::joins_edges) {
        return Vec::new();
    }
    vec![AnatomicLimit {
        repair: "edge-to-edge".into(),
        measure: "coaptation.length_a2p2_mm".into(),
        value: before.measures.coaptation.length_a2p2_mm,
        at_least: 2.0,
        source: "EACVI".into(),
    }]
}

/// A criterion and how fine it tells.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ranking {
    /// Which one.
    pub criterion: Criterion,
    /// Values are compared in bins so wide, in `unit`.
    pub bin: f64,
    /// Unit of the bin: that of the value, or `halvings`.
    pub unit: Cow<'static, str>,
}

/// One alternative.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Its place; shared by those that no criterion tells apart; absent without a certificate, nor where it is no repair.
    pub rank: Option<usize>,
    /// Whether nothing is done but to tear or cut chordae: what if, and no repair.
    pub only_takes_chordae: bool,
    /// Whether its repairs are those that the search found: an alternative of the plan, or one made for the answer, which comes after all
    /// of the plan in their order.
    pub found_by_search: bool,
    /// Its number in the order of the plan, from 1.
    pub number: usize,
    /// What it is called.
    pub name: String,
    /// What is done.
    pub repairs: Vec<Repair>,
    /// Why it could not be carried out; empty if it could.
    pub faults: Vec<String>,
    /// Doubts about the repairs.
    pub warnings: Vec<String>,
    /// The closed valve; absent if it could not be carried out.
    #[serde(flatten)]
    pub closed: Option<Closed>,
}

/// A closed state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Closed {
    /// How far it can be trusted.
    pub solve: Trust,
    /// What it measures.
    #[serde(flatten)]
    pub measures: Measures,
    /// What its anatomic orifice would let back in a beat, from a sharp to a rounded one [mL]: an estimate.
    pub regurgitant_volume_ml: [f64; 2],
    /// How large the ring is where it lies, along its own axes; absent without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ring_laid: Option<RingExtent>,
    /// What each repair did, as in `result.json`, shape `[repair]`.
    #[serde(default)]
    pub carried_out: Vec<RepairReport>,
    /// Neochordae that hold nothing back, or of which some strands do not, each with the number of its repair from 0; of a certified
    /// shape only. With nothing but such a neochord, the row is the valve as it was.
    #[serde(default)]
    pub slack_neochordae: Vec<SlackNeochord>,
    /// The same valve without pressure; absent where it was not asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub diastole: Option<Open>,
    /// What an ensemble of valves like it came to; absent where there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uncertainty: Option<Sampled>,
    /// Rates of change; absent where they were not asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensitivities: Option<Sensitivities>,
}

impl Closed {
    /// The value of a criterion, in its unit; none where it is not known.
    pub fn value(&self, criterion: Criterion) -> Option<f64> {
        match criterion {
            Criterion::DiastolicOrifice => self.diastole.as_ref()?.area_mm2,
            _ => criterion.value(&self.measures, None),
        }
    }
}

impl Row {
    /// Whether the leaflets of a closed valve are joined edge to edge.
    pub(crate) fn joins_edges(&self) -> bool {
        let joins = |repair: &Repair| matches!(repair, Repair::Clip(_) | Repair::Alfieri(_));
        self.closed.is_some() && self.repairs.iter().any(joins)
    }
}

/// How far a closed state can be trusted. No times: the same plan gives the same bytes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trust {
    /// Whether the result may be used: converged, stable, nothing crosses.
    pub certified: bool,
    /// Why the solver stopped.
    pub status: Status,
    /// Largest force left on a free vertex over [`reference_force_n`](coapt::relax::load::reference_force_n) [1].
    pub residual: f64,
    /// Solver iterations.
    pub iterations: usize,
    /// Whether a small push is answered by a small motion.
    pub stable: bool,
    /// Edges that pass through faces.
    pub crossings: usize,
    /// How far mid-surfaces in contact are nearer than the contact distance, at most [mm].
    pub max_penetration_mm: f64,
    /// Bound on the distance from an infinitely fine mesh, root mean square, estimated [mm].
    pub discretisation_mm: f64,
    /// The number of the alternative at whose closed shape it began; absent where it began open.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub begun_at: Option<usize>,
}

/// A plan in its file, to name lines in it.
#[derive(Clone, Copy, Debug)]
pub struct PlanFile<'a> {
    /// As it is called in messages.
    pub name: &'a str,
    /// What stands in it.
    pub text: &'a str,
}

impl PlanReport {
    /// Puts together what is told of a comparison.
    pub fn new(
        model: &Model,
        file: PlanFile,
        plan: &Alternatives,
        comparison: &Comparison,
        warnings: &[Fault],
    ) -> Self {
        let mut lines = Lines::new(file);
        let rows = comparison.rows.iter().map(|row| self::row(row, plan, &mut lines));
        let criteria = plan.ranked_by();
        Self {
            schema: PLAN_SCHEMA.into(),
            version: env!("CARGO_PKG_VERSION").into(),
            notice: NOTICE.into(),
            case: model.name.clone(),
            plan: plan.name.clone(),
            pressure_mmhg: model.pressure_mpa / MMHG_MPA,
            mesh: MeshSize {
                vertices: model.rest_mm.len(),
                faces: model.faces.len(),
                chords: model.chords.ends.len(),
            },
            settings: model.settings,
            contact: model.contact,
            frame: closed_frame(model),
            ranking: criteria.into_iter().map(ranking).collect(),
            before: closed(&comparison.before),
            alternatives: rows.collect(),
            search: None,
            anatomic_limits: anatomic_limits(plan, &comparison.before),
            warnings: warnings.iter().map(sentence).collect(),
        }
    }

    /// Whether all that was computed may be used; of ensembles and searches, which tell what is not, nothing is asked.
    pub fn certified(&self) -> bool {
        let rows = self.alternatives.iter().filter_map(|row| row.closed.as_ref());
        let is_open = |closed: &Closed| closed.diastole.as_ref().is_none_or(|open| open.certified);
        rows.chain([&self.before])
            .all(|closed| closed.solve.certified && is_open(closed))
    }

    /// As one JSON object, indented, with a line break at its end.
    ///
    /// # Errors
    /// None that the types allow; numbers that are not finite would be written as `null`.
    pub fn json(&self) -> Result<String, Fault> {
        let text = serde_json::to_string_pretty(self);
        text.map(|text| text + "\n")
            .map_err(|error| Fault::error("report", error.to_string()))
    }
}

/// The frame of the closed valve: its annulus is held, so that no closed shape need be kept to know it.
fn closed_frame(model: &Model) -> Option<ValveFrame> {
    let vertices = 0..model.rest_mm.len() as u32;
    let held: Vec<Vec3> = vertices.map(|vertex| model.target_mm(vertex)).collect();
    valve_frame(model, &held)
}

fn ranking(criterion: Criterion) -> Ranking {
    let (bin, unit) = criterion.bin_width();
    Ranking {
        criterion,
        bin,
        unit: unit.into(),
    }
}

fn row(row: &coapt::plan::Row, plan: &Alternatives, lines: &mut Lines) -> Row {
    let alternative = &plan.alternatives[row.alternative];
    let keys = &plan.keys[row.alternative];
    let (faults, warnings) = match &row.result {
        Ok(outcome) => {
            let told = outcome.warnings.iter();
            (
                Vec::new(),
                told.map(|(number, fault)| lines.told(&keys[*number], fault))
                    .collect(),
            )
        }
        Err(refusal) => {
            let key = &keys[refusal.repair];
            let told = refusal.faults.iter();
            (told.map(|fault| lines.told(key, fault)).collect(), Vec::new())
        }
    };
    Row {
        rank: row.rank,
        only_takes_chordae: row.only_takes_chordae,
        found_by_search: plan.found_by_search == Some(row.alternative),
        number: row.alternative + 1,
        name: alternative.name.clone(),
        repairs: alternative.repairs.clone(),
        faults,
        warnings,
        closed: row.result.as_ref().ok().map(closed),
    }
}

fn closed(outcome: &Outcome) -> Closed {
    let certificate = &outcome.certificate;
    Closed {
        solve: Trust {
            certified: outcome.is_certified(),
            status: outcome.status,
            residual: certificate.residual,
            iterations: outcome.iterations,
            stable: certificate.stable,
            crossings: certificate.crossings.len(),
            max_penetration_mm: certificate.max_penetration_mm,
            discretisation_mm: certificate.discretisation_mm,
            begun_at: outcome.begun_at.map(|number| number + 1),
        },
        measures: outcome.measures.clone(),
        ring_laid: outcome.repairs.iter().find_map(laid),
        carried_out: outcome.repairs.iter().map(repair_report).collect(),
        slack_neochordae: match outcome.is_certified() {
            true => outcome.slack_neochordae.clone(),
            false => Vec::new(),
        },
        regurgitant_volume_ml: outcome.regurgitant_volume_ml,
        diastole: outcome.diastole.as_ref().map(Open::new),
        uncertainty: None,
        sensitivities: None,
    }
}

fn laid(report: &Report) -> Option<RingExtent> {
    match report {
        Report::Ring(ring) => Some(ring.laid),
        _ => None,
    }
}

/// A fault of a repair, whose place begins with its kind (`ring.size_mm`), with the key in the plan
/// (`alternative[0].repair[1].size_mm`).
pub fn in_plan(key: &str, fault: &Fault) -> Fault {
    let rest = fault.place.find(['.', ' ']).map_or("", |at| &fault.place[at..]);
    Fault {
        place: format!("{key}{rest}"),
        ..fault.clone()
    }
}

/// Lines of keys, each sought once: thousands of alternatives speak of the same.
struct Lines<'a> {
    file: PlanFile<'a>,
    known: BTreeMap<String, Option<usize>>,
}

impl<'a> Lines<'a> {
    fn new(file: PlanFile<'a>) -> Self {
        Self {
            file,
            known: BTreeMap::new(),
        }
    }

    /// `plan.toml:12: alternative[0].repair[0].size_mm is 3 mm; expected ...`
    fn told(&mut self, key: &str, fault: &Fault) -> String {
        let fault = in_plan(key, fault);
        let PlanFile { name, text } = self.file;
        let line = self
            .known
            .entry(fault.place.clone())
            .or_insert_with_key(|place| locate(text, place));
        match line {
            Some(line) => format!("{name}:{line}: {}", sentence(&fault)),
            None => format!("{name}: {}", sentence(&fault)),
        }
    }
}

#[cfg(test)]
pub(crate) mod tests;

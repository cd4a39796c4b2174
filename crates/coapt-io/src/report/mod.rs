//! What a closure found: as one object for machines, as a table for people, as surfaces for pictures.

mod repairs;
mod rows;
mod surfaces;
mod text;

use coapt::measure::{self, Measures, SlackNeochord, ValveFrame, slack_neochordae, valve_frame};
use coapt::model::{LeftOut, Model, Untangled};
use coapt::relax::{Equilibrium, Status};
use coapt::repair;
use coapt::scene::{Contact, Fault, MMHG_MPA, Settings};
use serde::{Deserialize, Serialize};

pub(crate) use repairs::{extent_words, repair_line, repair_report, slack_line, slack_mark};

pub use repairs::{RepairReport, RingFigures};
pub use rows::{TableRow, rows, rows_of};
pub(crate) use surfaces::{chords, loaded_chords, ring_curves, stage_closed_chords, stage_closed_surface};
pub use surfaces::{closed_surface, stage_results, write_closed_surface, write_results};
pub use text::text;
pub(crate) use text::{
    GRASP, NOT_CERTIFIED, WIDTH, is_zero, left_out_line, line, number, orifice_doubt, reasons,
    untangled_line, wrapped,
};

/// The layout of the JSON report.
pub const REPORT_SCHEMA: &str = "coapt-report/1";

/// Stands in every report.
pub const NOTICE: &str = "research use, not a medical device";

/// A closed valve, and how long closing it took.
#[derive(Clone, Debug)]
pub struct Closed {
    /// The valve.
    pub model: Model,
    /// Where it came to rest.
    pub equilibrium: Equilibrium,
    /// Wall-clock time of the relaxation [ms].
    pub wall_ms: f64,
}

/// A valve closed, and closed again after a plan.
#[derive(Clone, Debug)]
pub struct Closure {
    /// Without the plan.
    pub before: Closed,
    /// With it.
    pub after: Option<Closed>,
    /// What the repairs did, in their order.
    pub repairs: Vec<repair::Report>,
    /// Repairs of the input, guesses and doubts, in the order in which they came up.
    pub warnings: Vec<Fault>,
    /// What crossed in the open valve as given and was drawn apart.
    pub untangled: Option<Untangled>,
    /// Chordae that were given and are not in the model, by group.
    pub chordae_left_out: Vec<LeftOut>,
}

/// The JSON report. Units are in the names; see the measures for their definitions.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// [`REPORT_SCHEMA`].
    pub schema: &'static str,
    /// Version of the program.
    pub version: &'static str,
    /// [`NOTICE`].
    pub notice: &'static str,
    /// Name of the case.
    pub case: String,
    /// Transvalvular pressure [mmHg].
    pub pressure_mmhg: f64,
    /// Size of the model.
    pub mesh: MeshSize,
    /// How the equilibrium was sought.
    pub settings: Settings,
    /// How leaflets touch.
    pub contact: Contact,
    /// Which way is which in the valve closed without the plan; absent where the annulus has no plane.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame: Option<ValveFrame>,
    /// What crossed in the open valve as given and was drawn apart; absent where nothing did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub untangled: Option<UntangledReport>,
    /// Chordae that were given, reach nothing and are not in the model, by group; absent where none are.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub chordae_left_out: Vec<LeftOutReport>,
    /// Without the plan.
    pub before: Outcome,
    /// With the plan; absent without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub after: Option<Outcome>,
    /// What the repairs did, in their order.
    pub repairs: Vec<RepairReport>,
    /// Neochordae of the plan that hold nothing back in the valve closed with it, or of which some strands do not; of a certified shape only.
    pub slack_neochordae: Vec<SlackNeochord>,
    /// Repairs of the input, guesses and doubts.
    pub warnings: Vec<String>,
}

/// Size of the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MeshSize {
    /// Vertices: leaflets, chord nodes, papillary tips.
    pub vertices: usize,
    /// Triangles.
    pub faces: usize,
    /// Chord segments.
    pub chords: usize,
}

/// What crossed in the open valve as given and was drawn apart before it was closed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct UntangledReport {
    /// At how many places surfaces crossed or touched.
    pub places: usize,
    /// Where, the first five points at most [mm], LPS.
    pub first_at_mm: Vec<[f64; 3]>,
    /// How many points were moved.
    pub moved_points: usize,
    /// How far the one was moved that was moved farthest [mm].
    pub farthest_mm: f64,
}

/// Chord segments of a group that reach neither tip nor leaflet, or hang on such: the valve was closed without them.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LeftOutReport {
    /// Name of the group.
    pub group: String,
    /// How many of its segments.
    pub segments: usize,
}

/// One closed state.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// How it was found and how far it can be trusted.
    pub solve: Solve,
    /// Names of what `group` of `chords.vtp` numbers.
    pub chord_groups: Vec<String>,
    /// What it measures.
    #[serde(flatten)]
    pub measures: Measures,
}

/// How a closed state was found and how far it can be trusted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Solve {
    /// Whether the result may be used: converged, stable, nothing crosses.
    pub certified: bool,
    /// Why the solver stopped.
    pub status: Status,
    /// Largest force left on a free vertex over [`reference_force_n`](coapt::relax::load::reference_force_n) [1].
    pub residual: f64,
    /// Solver iterations.
    pub iterations: usize,
    /// Wall-clock time [ms].
    pub wall_ms: f64,
    /// Whether a small push is answered by a small motion.
    pub stable: bool,
    /// Edges that pass through faces.
    pub crossings: usize,
    /// How far mid-surfaces in contact are nearer than the contact distance, at most [mm].
    pub max_penetration_mm: f64,
    /// Where that is [mm]; absent without contact.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_penetration_at_mm: Option<[f64; 3]>,
    /// Bound on the distance from an infinitely fine mesh, root mean square, estimated [mm].
    pub discretisation_mm: f64,
}

impl Report {
    /// Measures both states of a closure.
    pub fn new(closure: &Closure) -> Self {
        let model = &closure.before.model;
        Self {
            schema: REPORT_SCHEMA,
            version: env!("CARGO_PKG_VERSION"),
            notice: NOTICE,
            case: model.name.clone(),
            pressure_mmhg: model.pressure_mpa / MMHG_MPA,
            mesh: MeshSize {
                vertices: model.rest_mm.len(),
                faces: model.faces.len(),
                chords: model.chords.ends.len(),
            },
            settings: model.settings,
            contact: model.contact,
            frame: valve_frame(model, &closure.before.equilibrium.state.positions_mm),
            untangled: closure.untangled.as_ref().map(untangled_report),
            chordae_left_out: closure.chordae_left_out.iter().map(left_out_report).collect(),
            before: outcome(&closure.before),
            after: closure.after.as_ref().map(outcome),
            repairs: closure.repairs.iter().map(repair_report).collect(),
            slack_neochordae: closure
                .after
                .as_ref()
                .map(|after| slack(after, &closure.repairs))
                .unwrap_or_default(),
            warnings: closure.warnings.iter().map(warning).collect(),
        }
    }

    /// Whether all that was computed may be used.
    pub fn certified(&self) -> bool {
        self.before.solve.certified && self.after.as_ref().is_none_or(|after| after.solve.certified)
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

fn warning(fault: &Fault) -> String {
    crate::scene::sentence(fault)
}

fn outcome(closed: &Closed) -> Outcome {
    let equilibrium = &closed.equilibrium;
    let certificate = &equilibrium.certificate;
    Outcome {
        solve: Solve {
            certified: certificate.is_certified(equilibrium.status),
            status: equilibrium.status,
            residual: certificate.residual,
            iterations: equilibrium.history.len(),
            wall_ms: closed.wall_ms,
            stable: certificate.stable,
            crossings: certificate.crossings.len(),
            max_penetration_mm: certificate.max_penetration_mm,
            max_penetration_at_mm: certificate.max_penetration_at_mm.map(Into::into),
            discretisation_mm: certificate.discretisation_mm,
        },
        chord_groups: group_names(&closed.model),
        measures: measure::measure_with_passage(
            &closed.model,
            &equilibrium.state.positions_mm,
            &equilibrium.reactions_n,
        ),
    }
}

fn slack(closed: &Closed, repairs: &[repair::Report]) -> Vec<SlackNeochord> {
    let equilibrium = &closed.equilibrium;
    match equilibrium.certificate.is_certified(equilibrium.status) {
        true => slack_neochordae(&closed.model, repairs, &equilibrium.state.positions_mm),
        false => Vec::new(),
    }
}

fn group_names(model: &Model) -> Vec<String> {
    let groups = model.chord_groups.iter();
    groups.map(|group| group.name.clone()).collect()
}

fn left_out_report(left_out: &LeftOut) -> LeftOutReport {
    LeftOutReport {
        group: left_out.group.clone(),
        segments: left_out.segments,
    }
}

fn untangled_report(untangled: &Untangled) -> UntangledReport {
    UntangledReport {
        places: untangled.places,
        first_at_mm: untangled.first_at_mm.clone(),
        moved_points: untangled.moved_points,
        farthest_mm: untangled.farthest_mm,
    }
}

#[cfg(test)]
pub(crate) mod tests;

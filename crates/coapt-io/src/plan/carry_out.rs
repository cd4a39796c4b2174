//! Carrying a plan out: the search, the alternatives, the ensembles, the rates, each where it is asked for.

use coapt::model::Model;
use coapt::plan::{Comparison, Progress, Row, Settings, Watch, compare_watched, summaries};
use coapt::scene::Fault;
use rayon::prelude::*;

use super::{PlanFile, PlanReport, found, in_plan, rates_of};
use crate::scene::{Alternatives, located};

/// What of a plan is being done; all closures of a stage run side by side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// The gentlest value that reaches a goal is sought.
    Search,
    /// The valve as it is and after each alternative: so many closures.
    Alternatives(usize),
    /// So many valves of ensembles.
    Samples(usize),
}

/// Called with each stage and its work, which it must do once, looking on as it likes.
pub type OnStage<'a> = &'a dyn Fn(Stage, &mut dyn FnMut(Watch));

/// Does all that a plan asks for. `keep_shapes`: whether the comparison holds closed shapes.
///
/// # Errors
/// A search that cannot be made; why no alternative can be carried out, the same fault of several alternatives once.
pub fn carry_out(
    model: &Model,
    file: PlanFile,
    plan: &Alternatives,
    keep_shapes: bool,
    warnings: &[Fault],
    on_stage: OnStage,
) -> Result<(PlanReport, Comparison), Vec<Fault>> {
    let asked = &plan.asked;
    // First: it may be refused.
    let search = match &asked.search {
        Some(sought) => {
            let work = |watch: Watch| found(model, sought, &|moment| watch(&Progress::Iterated(moment)));
            let told = |faults: Vec<Fault>| -> Vec<Fault> {
                let located = |fault| located(file.name, file.text, fault);
                faults.iter().map(located).collect()
            };
            staged(on_stage, Stage::Search, work).transpose().map_err(told)?
        }
        None => None,
    };
    let settings = Settings {
        criteria: plan.ranked_by(),
        keep_positions: keep_shapes || asked.sensitivities,
        diastole: asked.diastole,
        warm: asked.warm,
    };
    let closures = Stage::Alternatives(plan.alternatives.len() + 1);
    let work = |watch: Watch| compare_watched(model, &plan.alternatives, &settings, watch);
    let Some(mut comparison) = staged(on_stage, closures, work) else {
        return Err(vec![Fault::error(file.name, "was not carried out")]);
    };
    let mut report = PlanReport::new(model, file, plan, &comparison, warnings);
    if report.all_refused() {
        return Err(all_faults(file, plan, &comparison));
    }
    report.search = search;
    if let Some(sampling) = &asked.sampling {
        let samples = Stage::Samples(sampling.samples as usize * (sampling.count(&comparison) + 1));
        let work = |watch: Watch| summaries(model, &plan.alternatives, &comparison, sampling, watch);
        if let Some(summaries) = staged(on_stage, samples, work) {
            report = report.with_ensembles(&summaries);
        }
    }
    if asked.sensitivities {
        report = rated(report, model, plan, &comparison);
        if !keep_shapes {
            forget_shapes(&mut comparison);
        }
    }
    Ok((report, comparison))
}

/// What the work of a stage made.
fn staged<T>(on_stage: OnStage, stage: Stage, work: impl Fn(Watch) -> T) -> Option<T> {
    let mut made = None;
    on_stage(stage, &mut |watch| made = Some(work(watch)));
    made
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

/// Shapes that were kept for rates alone are given to nobody.
fn forget_shapes(comparison: &mut Comparison) {
    let outcomes = comparison
        .rows
        .iter_mut()
        .filter_map(|row| row.result.as_mut().ok());
    for outcome in outcomes.chain([&mut comparison.before]) {
        outcome.positions_mm.clear();
    }
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

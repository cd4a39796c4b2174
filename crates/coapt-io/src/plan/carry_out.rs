//! Carrying a plan out: the search, the alternatives, the ensembles, the rates, each where it is asked for.

use coapt::model::Model;
use coapt::plan::{
    Alternative, Comparison, Progress, Refusal, Row, Settings, Watch, apply_all, compare_watched, summaries,
    wrong_input,
};
use coapt::scene::Fault;
use rayon::prelude::*;

use super::search::{check, shown};
use super::{PlanFile, PlanReport, SearchReport, found, in_plan, rates_of};
use crate::scene::{Alternatives, Search, located};

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

/// Does all that a plan asks for. `keep_shapes`: whether the comparison holds closed shapes. The answer of a search becomes an alternative
/// of the plan, unless one of them is it, to be closed and ranked with the others.
///
/// # Errors
/// What is wrong with alternatives in themselves, of all of them, before anything is closed; a search that cannot be made; why this
/// valve's shape allows no alternative. The same fault of several alternatives is told once.
pub fn carry_out(
    model: &Model,
    file: PlanFile,
    plan: &mut Alternatives,
    keep_shapes: bool,
    warnings: &[Fault],
    on_stage: OnStage,
) -> Result<(PlanReport, Comparison), Vec<Fault>> {
    let wrong = wrong_inputs(model, file, plan);
    if !wrong.is_empty() {
        return Err(wrong);
    }
    // Before anything is announced.
    let refusals = refusals(model, plan);
    if refusals.len() == plan.alternatives.len() {
        return Err(all_faults(file, plan, &refusals));
    }
    let asked = plan.asked.clone();
    // First: it may be refused.
    let search = match &asked.search {
        Some(sought) => {
            let work = |watch: Watch| found(model, sought, &|moment| watch(&Progress::Iterated(moment)));
            let told = |faults: Vec<Fault>| -> Vec<Fault> {
                let located = |fault| located(file.name, file.text, fault);
                faults.iter().map(located).collect()
            };
            check(model, sought).map_err(told)?;
            staged(on_stage, Stage::Search, work).transpose().map_err(told)?
        }
        None => None,
    };
    if let (Some(sought), Some(found)) = (&asked.search, &search) {
        add_answer(plan, sought, found);
    }
    let plan = &*plan;
    let settings = Settings {
        criteria: plan.ranked_by(),
        keep_positions: keep_shapes || asked.sensitivities,
        passage: true,
        diastole: asked.diastole,
        warm: asked.warm,
    };
    let closures = Stage::Alternatives(plan.alternatives.len() + 1);
    let work = |watch: Watch| compare_watched(model, &plan.alternatives, &settings, watch);
    let Some(mut comparison) = staged(on_stage, closures, work) else {
        return Err(vec![Fault::error(file.name, "was not carried out")]);
    };
    let mut report = PlanReport::new(model, file, plan, &comparison, warnings);
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

/// Makes the answer of a search an alternative, or marks the one that does the same.
fn add_answer(plan: &mut Alternatives, sought: &Search, found: &SearchReport) {
    let Some(answer) = &found.answer else {
        return;
    };
    let does_it = |alternative: &Alternative| alternative.repairs == found.repairs;
    plan.found_by_search = plan.alternatives.iter().position(does_it);
    if plan.found_by_search.is_none() {
        plan.found_by_search = Some(plan.alternatives.len());
        let kind = serde_json::to_value(&sought.repairs[sought.repair]).unwrap_or_default();
        let kind = kind["kind"].as_str().unwrap_or("repair").to_owned();
        plan.alternatives.push(Alternative {
            name: format!("search: {kind} {} {}", sought.key, shown(answer.value)),
            repairs: found.repairs.clone(),
        });
        plan.keys.push(sought.places.clone());
    }
}

/// The alternative that is filmed, beside the valve as it is: the one that ranks first. None where nothing has a rank.
pub fn filmed<'a>(plan: &'a Alternatives, comparison: &Comparison) -> Option<&'a Alternative> {
    // Rows are sorted: what has a rank comes first.
    let first = comparison.rows.first().filter(|row| row.rank.is_some())?;
    plan.alternatives.get(first.alternative)
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

/// What is wrong with alternatives in themselves.
fn wrong_inputs(model: &Model, file: PlanFile, plan: &Alternatives) -> Vec<Fault> {
    let repairs = plan
        .alternatives
        .par_iter()
        .map(|alternative| &alternative.repairs);
    let wrong: Vec<_> = repairs.map(|repairs| wrong_input(model, repairs)).collect();
    let keyed = wrong.iter().zip(&plan.keys).flat_map(|(wrong, keys)| {
        let of = wrong.iter();
        of.map(|(number, fault)| (keys[*number].as_str(), fault))
    });
    told_once(file, keyed)
}

/// Why alternatives cannot be carried out, each with its number, up to the first that can.
fn refusals(model: &Model, plan: &Alternatives) -> Vec<(usize, Refusal)> {
    let numbered = plan.alternatives.iter().enumerate();
    let refusals = numbered.map_while(|(number, alternative)| {
        let refusal = apply_all(model, &alternative.repairs).err()?;
        Some((number, refusal))
    });
    refusals.collect()
}

/// Why none can be carried out.
fn all_faults(file: PlanFile, plan: &Alternatives, refusals: &[(usize, Refusal)]) -> Vec<Fault> {
    let refused = refusals
        .iter()
        .map(|(number, refusal)| (&plan.keys[*number][refusal.repair], refusal));
    let keyed = refused.flat_map(|(key, refusal)| {
        let faults = refusal.faults.iter();
        faults.map(move |fault| (key.as_str(), fault))
    });
    told_once(file, keyed)
}

/// Faults with the keys of their repairs, each with its line and told once.
fn told_once<'a>(file: PlanFile, faults: impl Iterator<Item = (&'a str, &'a Fault)>) -> Vec<Fault> {
    let mut told: Vec<Fault> = Vec::new();
    for (key, fault) in faults {
        let fault = in_plan(key, fault);
        if told.contains(&fault) {
            continue;
        }
        if told.len() == MOST_FAULTS {
            told.push(Fault::error(file.name, "and more like these"));
            break;
        }
        told.push(fault);
    }
    let line = |fault: &Fault| match fault.place == file.name {
        true => fault.clone(),
        false => located(file.name, file.text, fault),
    };
    told.iter().map(line).collect()
}

/// As many as of any other file.
const MOST_FAULTS: usize = 20;

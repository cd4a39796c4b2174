//! How fast the measures of an alternative change with the numbers in its repairs.

use super::{Criterion, Outcome, apply_all};
use crate::model::{ChordGroup, ChordKind, Model};
use crate::relax::Equilibrium;
use crate::scene::{Fault, Repair};
use crate::sensitivity::{Parameter, sensitivity};
use crate::state::State;

/// A number in the repairs of an alternative.
pub struct Number<'a> {
    /// What it is called.
    pub key: String,
    /// Its value in the alternative.
    pub value: f64,
    /// A change that would matter, in its unit.
    pub scale: f64,
    /// The repairs with another value.
    pub repairs_at: &'a (dyn Fn(f64) -> Result<Vec<Repair>, Vec<Fault>> + Sync),
}

/// Rates with one number.
#[derive(Clone, Debug, PartialEq)]
pub struct Rates {
    /// Which number, or [`CHORD_SCALE`].
    pub key: String,
    /// Its value.
    pub value: f64,
    /// How fast each criterion of the closed valve changes, in its unit per unit of the number; or why there are no rates: the shape is
    /// in no stable balance, the number changes which vertices there are.
    pub rates: Result<Vec<(Criterion, f64)>, Vec<Fault>>,
}

/// The length of all chordae after the repairs, as a part of it [1].
pub const CHORD_SCALE: &str = "chord_scale";
/// A change of chord lengths that matters [1]: a hundredth, 0.2 mm.
const CHORD_CHANGE: f64 = 0.01;

/// Rates of the criteria with each number, and with the length of all chordae, of an alternative closed to `outcome`, which must have
/// kept its positions.
///
/// # Errors
/// Repairs that cannot be carried out.
pub fn rates(
    model: &Model,
    repairs: &[Repair],
    outcome: &Outcome,
    numbers: &[Number],
) -> Result<Vec<Rates>, Vec<Fault>> {
    let repaired = |repairs: &[Repair]| -> Result<Model, Vec<Fault>> {
        let applied = apply_all(model, repairs).map_err(|refusal| refusal.faults)?;
        Ok(applied.model)
    };
    let here = repaired(repairs)?;
    let closed = equilibrium(outcome);
    let with = |key: &str, parameter: &Parameter| Rates {
        key: key.to_owned(),
        value: parameter.value,
        rates: criteria_rates(&here, &closed, parameter),
    };
    let of_number = |number: &Number| {
        let parameter = Parameter {
            model_at: &|value| repaired(&(number.repairs_at)(value)?),
            value: number.value,
            scale: number.scale,
        };
        with(&number.key, &parameter)
    };
    let mut all: Vec<Rates> = numbers.iter().map(of_number).collect();
    let chords = Parameter {
        model_at: &|scale| Ok(scaled(&here, scale)),
        value: 1.0,
        scale: CHORD_CHANGE,
    };
    all.push(with(CHORD_SCALE, &chords));
    Ok(all)
}

/// What is kept of a closure, as far as rates need it.
fn equilibrium(outcome: &Outcome) -> Equilibrium {
    Equilibrium {
        state: State {
            positions_mm: outcome.positions_mm.clone(),
        },
        status: outcome.status,
        certificate: outcome.certificate.clone(),
        untangled: None,
        reactions_n: Vec::new(),
        history: Vec::new(),
    }
}

fn criteria_rates(
    model: &Model,
    closed: &Equilibrium,
    parameter: &Parameter,
) -> Result<Vec<(Criterion, f64)>, Vec<Fault>> {
    let found = sensitivity(model, closed, parameter)?;
    let rate = |criterion: Criterion| {
        criterion.value(&found.more, None)?;
        let rate = found.rate(|measures| criterion.value(measures, None).unwrap_or_default());
        Some((criterion, rate))
    };
    Ok(Criterion::ALL.into_iter().filter_map(rate).collect())
}

/// The valve with all chordae so many times as long; sutures are none.
fn scaled(model: &Model, scale: f64) -> Model {
    let factor = |group: &ChordGroup| match group.kind {
        ChordKind::Suture => 1.0,
        ChordKind::Chorda | ChordKind::Neochorda => scale,
    };
    let factors: Vec<f64> = model.chord_groups.iter().map(factor).collect();
    Model {
        chords: model.chords.scaled(&factors),
        ..model.clone()
    }
}

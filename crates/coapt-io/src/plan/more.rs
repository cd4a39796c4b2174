//! What is told of a closed valve beside its measures: the open valve, an ensemble, rates.

use std::collections::BTreeMap;

use coapt::measure::flow::HARDLY_OPENS_MM2;
use coapt::model::Model;
use coapt::plan::ensemble::{Interval, Probability};
use coapt::plan::{Diastole, Number, Outcome, Rates, Summaries, Summary, rates};
use coapt::relax::Status;
use coapt::scene::{Fault, Repair};
use serde::{Deserialize, Serialize};

use super::PlanReport;
use crate::scene::{number_keys, sentence, with_number};

/// The valve that no pressure closes nor any flow opens: blood passes through more, under less of a gradient.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Open {
    /// Whether the result may be used.
    pub certified: bool,
    /// Why the solver stopped.
    pub status: Status,
    /// Whether a small push is answered by a small motion.
    pub stable: bool,
    /// Edges that pass through faces.
    pub crossings: usize,
    /// Solver iterations.
    pub iterations: usize,
    /// Anatomic orifice [mm²]; absent without a certificate, as all that follows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub area_mm2: Option<f64>,
    /// Its openings, the largest first [mm²].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub openings_mm2: Option<Vec<f64>>,
    /// Whether the orifice is smaller than the 50 mm² from which a gradient is told ([`HARDLY_OPENS_MM2`]).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hardly_opens: Option<bool>,
    /// Mean gradient of a heart at rest through that orifice [mmHg]: an upper estimate; absent where the valve hardly opens.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_gradient_mmhg: Option<f64>,
}

impl Open {
    /// As told.
    pub(super) fn new(diastole: &Diastole) -> Self {
        let orifice = diastole.orifice.as_ref();
        Self {
            certified: diastole.is_certified(),
            status: diastole.status,
            stable: diastole.certificate.stable,
            crossings: diastole.certificate.crossings.len(),
            iterations: diastole.iterations,
            area_mm2: orifice.map(|orifice| orifice.area_mm2),
            hardly_opens: orifice.map(|orifice| orifice.area_mm2 < HARDLY_OPENS_MM2),
            openings_mm2: orifice.map(|orifice| orifice.openings_mm2.clone()),
            mean_gradient_mmhg: diastole.mean_gradient_mmhg,
        }
    }
}

/// What an ensemble came to. Figures are those of the certified samples.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sampled {
    /// Valves in it.
    pub samples: usize,
    /// Those that closed with a certificate.
    pub certified: usize,
    /// Those of them whose margins and narrowest passage tell otherwise of what is open.
    #[serde(default)]
    pub in_doubt: usize,
    /// Those whose repairs could not be carried out.
    pub refused: usize,
    /// Part of the certified ones that seal, with the interval (Wilson's, 95 %) that so few leave for its probability [1].
    pub sealed: Option<Probability>,
    /// Median and 5 to 95 % of each criterion, in its unit.
    #[serde(flatten)]
    pub intervals: BTreeMap<String, Interval>,
}

impl Sampled {
    fn new(summary: &Summary) -> Self {
        let intervals = summary.intervals.iter();
        Self {
            samples: summary.samples,
            certified: summary.certified,
            in_doubt: summary.in_doubt,
            refused: summary.refused,
            sealed: summary.sealed,
            intervals: intervals
                .map(|(criterion, interval)| (criterion.name().to_owned(), *interval))
                .collect(),
        }
    }
}

/// Rates of a closed valve by what changes: `repair[0].size_mm`, or `chord_scale`, the length of all chordae as a part of it.
pub type Sensitivities = BTreeMap<String, Rate>;

/// Rates with one number, or why there are none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rate {
    /// Its value here.
    pub value: f64,
    /// How fast each criterion changes, in its unit per unit of the number.
    #[serde(flatten)]
    pub per_unit: BTreeMap<String, f64>,
    /// Why there are none; absent where there are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub missing: Option<String>,
}

/// What [`rates_of`] finds.
pub type RatesFound = Result<Vec<Rates>, Vec<Fault>>;

/// Rates of an alternative with every number in its repairs and with the length of its chordae; its outcome must have kept its
/// positions.
///
/// # Errors
/// As [`rates`].
pub fn rates_of(model: &Model, repairs: &[Repair], outcome: &Outcome) -> RatesFound {
    let keys = repairs.iter().enumerate().flat_map(|(place, repair)| {
        let keys = number_keys(repair).into_iter();
        keys.map(move |(key, value)| (place, key, value))
    });
    let keys: Vec<(usize, String, f64)> = keys.collect();
    let with: Vec<_> = keys
        .iter()
        .map(|(place, key, _)| {
            move |number: f64| -> Result<Vec<Repair>, Vec<Fault>> {
                let mut changed = repairs.to_vec();
                changed[*place] = with_number(&repairs[*place], key, number)
                    .map_err(|message| vec![Fault::error(key, message)])?;
                Ok(changed)
            }
        })
        .collect();
    let numbers: Vec<Number> = keys
        .iter()
        .zip(&with)
        .map(|((place, key, value), repairs_at)| Number {
            key: format!("repair[{place}].{key}"),
            value: *value,
            scale: change_that_matters(key, *value),
            repairs_at,
        })
        .collect();
    rates(model, repairs, outcome, &numbers)
}

/// A change of a number that a surgeon would notice, our choice: a millimetre, a degree, else three parts in a hundred.
fn change_that_matters(key: &str, value: f64) -> f64 {
    match key.ends_with("_mm") || key.ends_with("_deg") || value == 0.0 {
        true => 1.0,
        false => 0.03 * value.abs(),
    }
}

impl PlanReport {
    /// The report with ensembles of the valve before and of its first rows.
    #[must_use]
    pub fn with_ensembles(mut self, summaries: &Summaries) -> Self {
        self.before.uncertainty = Some(Sampled::new(&summaries.before));
        for (row, summary) in self.alternatives.iter_mut().zip(&summaries.rows) {
            if let Some(closed) = &mut row.closed {
                closed.uncertainty = Some(Sampled::new(summary));
            }
        }
        self
    }

    /// The report with the rates of the valve before and of its rows, in their order; none where a row could not be carried out.
    #[must_use]
    pub fn with_rates(mut self, before: &RatesFound, rows: &[Option<RatesFound>]) -> Self {
        self.before.sensitivities = told(before);
        for (row, found) in self.alternatives.iter_mut().zip(rows) {
            if let Some(closed) = &mut row.closed {
                closed.sensitivities = found.as_ref().and_then(told);
            }
        }
        self
    }
}

fn told(found: &RatesFound) -> Option<Sensitivities> {
    let rate = |rates: &Rates| Rate {
        value: rates.value,
        per_unit: match &rates.rates {
            Ok(rates) => rates
                .iter()
                .map(|(criterion, rate)| (criterion.name().to_owned(), *rate))
                .collect(),
            Err(_) => BTreeMap::new(),
        },
        missing: match &rates.rates {
            Ok(_) => None,
            Err(faults) => Some(faults.iter().map(sentence).collect::<Vec<_>>().join("; ")),
        },
    };
    let found = found.as_ref().ok()?;
    Some(found.iter().map(|it| (it.key.clone(), rate(it))).collect())
}

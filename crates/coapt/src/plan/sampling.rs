//! What is not known, carried into a comparison: ensembles of the valve before and of the best alternatives.

use std::ops::ControlFlow;

use super::ensemble::{Ensemble, Interval, Probability, Uncertainty, ensemble};
use super::{Alternative, Comparison, Criterion, Progress, Start, Watch, apply_all, closed};
use crate::model::Model;
use crate::scene::Repair;
use crate::state::State;

/// How many valves stand for one, and of which alternatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Valves of an ensemble.
    pub samples: u32,
    /// Which ensemble: the same seed gives the same valves.
    pub seed: u64,
    /// So many alternatives, the best ones.
    pub alternatives: usize,
    /// What is not known.
    pub uncertainty: Uncertainty,
}

impl Default for Sampling {
    /// Our choice: 200 samples tell a probability of a half to 7 % and one of 95 % to 4 %, and one closure in a hundred does not count;
    /// five alternatives are as many as are looked at closely.
    fn default() -> Self {
        Self {
            samples: 200,
            seed: 1,
            alternatives: 5,
            uncertainty: Uncertainty::default(),
        }
    }
}

/// What an ensemble came to.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Valves in it.
    pub samples: usize,
    /// Those that closed with a certificate: all figures are theirs.
    pub certified: usize,
    /// Those of them whose margins and narrowest passage tell otherwise of what is open.
    pub in_doubt: usize,
    /// Those whose repairs could not be carried out.
    pub refused: usize,
    /// How probable it is that the valve seals; none without a certified sample.
    pub sealed: Option<Probability>,
    /// Criteria of closed valves, all of them, each with its median and an interval; none without a certified sample.
    pub intervals: Vec<(Criterion, Interval)>,
}

impl Summary {
    /// Of an ensemble.
    pub fn new(ensemble: &Ensemble) -> Self {
        let interval = |criterion: Criterion| {
            let value = |measures: &_| criterion.value(measures, None).unwrap_or_default();
            let interval = ensemble.interval(value)?;
            Some((criterion, interval))
        };
        let closed = Criterion::ALL
            .into_iter()
            .filter(|criterion| *criterion != Criterion::DiastolicOrifice);
        Self {
            samples: ensemble.samples.len(),
            certified: ensemble.certified().count(),
            in_doubt: ensemble.in_doubt(),
            refused: ensemble.samples.iter().filter(|sample| sample.is_err()).count(),
            sealed: ensemble.probability_sealed(),
            intervals: closed.filter_map(interval).collect(),
        }
    }
}

/// Ensembles of a comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct Summaries {
    /// The valve as it is.
    pub before: Summary,
    /// The best rows in their order, as many as were asked for; what is not ranked has none.
    pub rows: Vec<Summary>,
}

impl Sampling {
    /// Rows of a comparison that get an ensemble: the first so many.
    pub fn count(&self, comparison: &Comparison) -> usize {
        let ranked = comparison.rows.iter().take_while(|row| row.rank.is_some());
        ranked.count().min(self.alternatives)
    }
}

/// Closes an ensemble of the valve before and one of each of the best alternatives, all on the same valves. The watcher is told of
/// each sample as of an alternative.
pub fn summaries(
    model: &Model,
    alternatives: &[Alternative],
    comparison: &Comparison,
    sampling: &Sampling,
    watch: Watch,
) -> Summaries {
    let best = &comparison.rows[..sampling.count(comparison)];
    let of = |repairs: &[Repair]| summary(model, repairs, sampling, watch);
    Summaries {
        before: of(&[]),
        rows: best
            .iter()
            .map(|row| of(&alternatives[row.alternative].repairs))
            .collect(),
    }
}

fn summary(model: &Model, repairs: &[Repair], sampling: &Sampling, watch: Watch) -> Summary {
    let number = (sampling.samples, sampling.seed);
    let start = middle(model, repairs, watch);
    let uncertainty = &sampling.uncertainty;
    Summary::new(&ensemble(
        model,
        repairs,
        uncertainty,
        number,
        start.as_ref(),
        watch,
    ))
}

/// The closed valve that samples vary around; none where it has no certificate.
pub(super) fn middle(model: &Model, repairs: &[Repair], watch: Watch) -> Option<State> {
    let settings = super::Settings {
        keep_positions: true,
        passage: false,
        ..super::Settings::default()
    };
    // It was closed and told of before.
    let look = |progress: &Progress| match progress {
        Progress::Iterated(_) => watch(progress),
        _ => ControlFlow::Continue(()),
    };
    let outcome = closed(
        apply_all(model, repairs).ok()?,
        Start::default(),
        &settings,
        &look,
    );
    outcome.is_certified().then_some(State {
        positions_mm: outcome.positions_mm,
    })
}

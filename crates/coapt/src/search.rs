//! The gentlest repair that reaches a goal: which ring gives 8 mm of coaptation with the smallest reduction?

use std::ops::ControlFlow;

use rayon::prelude::*;

use crate::measure::{Measures, measure};
use crate::model::Model;
use crate::relax::{Equilibrium, Moment, relax_watched};
use crate::scene::Fault;
use crate::sensitivity::{Parameter, sensitivity};
use crate::state::State;

/// Values tried first, evenly from the gentlest to the most drastic: a goal that is reached and lost again between two of them is
/// not seen. Our choice: steps of 1 mm where ring sizes from 36 to 24 mm are searched.
const FIRST_TRIED: u32 = 13;
/// A guess stays this part of the tolerance [1] away from either end of the bracket: from an end that lies at the goal the next
/// guess then steps over the goal, and the bracket is as short as wanted.
const LEAST_STEP: f64 = 0.9;
/// Every so many guesses the bracket is halved, whatever the rates say.
const HALVED_EVERY: usize = 3;

/// What is sought.
#[derive(Clone, Copy, Debug)]
pub struct Goal<F> {
    /// The value of the parameter that changes the valve least, in the parameter's unit.
    pub gentlest: f64,
    /// The value that changes it most.
    pub most_drastic: f64,
    /// How exactly the answer is wanted, in the same unit.
    pub tolerance: f64,
    /// The measure that matters.
    pub measure: F,
    /// The least that it should be, in its unit.
    pub at_least: f64,
}

/// A value that was tried.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Tried {
    /// The value of the parameter.
    pub value: f64,
    /// The measure there.
    pub measured: f64,
    /// Whether the closure was certified. What is not reaches no goal.
    pub certified: bool,
}

/// What a search found.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Found {
    /// The gentlest value found that reaches the goal; none where no value tried does.
    pub answer: Option<Tried>,
    /// All values tried, in the order of the parameter from gentlest to most drastic.
    pub tried: Vec<Tried>,
}

impl Found {
    /// The gentlest value beyond the answer, among those tried, that does not reach the goal of at least so much.
    pub fn lost_again(&self, at_least: f64) -> Option<Tried> {
        let answer = self.answer?;
        let beyond = self.tried.iter().skip_while(|tried| tried.value != answer.value);
        let reaches = |tried: &Tried| tried.certified && tried.measured >= at_least;
        beyond.copied().find(|tried| !reaches(tried))
    }
}

/// A value of the parameter and the valve closed with it.
struct Attempt {
    value: f64,
    model: Model,
    closed: Equilibrium,
    measured: f64,
}

impl Attempt {
    fn certified(&self) -> bool {
        self.closed.certificate.is_certified(self.closed.status)
    }

    fn tried(&self) -> Tried {
        Tried {
            value: self.value,
            measured: self.measured,
            certified: self.certified(),
        }
    }
}

/// Finds the gentlest value of a parameter whose closed valve reaches a goal. Every closure begins at the open valve, so that the
/// answer does not depend on the order of the search.
///
/// Values over the whole range are tried first; between the first that reaches the goal and the one before it, rates of change with
/// the parameter say where to look on.
///
/// # Errors
/// A range or tolerance that is none; the faults of the first value for which there is no model.
pub fn search<F: Fn(&Measures) -> f64 + Sync>(
    goal: &Goal<F>,
    model_at: impl Fn(f64) -> Result<Model, Vec<Fault>> + Sync,
) -> Result<Found, Vec<Fault>> {
    search_watched(goal, model_at, &|_| ControlFlow::Continue(()))
}

/// The same with somebody looking on at the closures, some of which run side by side; a closure that he stops reaches no goal.
///
/// # Errors
/// As [`search`].
pub fn search_watched<F: Fn(&Measures) -> f64 + Sync>(
    goal: &Goal<F>,
    model_at: impl Fn(f64) -> Result<Model, Vec<Fault>> + Sync,
    watch: &(dyn Fn(&Moment) -> ControlFlow<()> + Sync),
) -> Result<Found, Vec<Fault>> {
    check(goal).map_err(|fault| vec![fault])?;
    let attempt = |value: f64| {
        let model = model_at(value)?;
        let closed = relax_watched(&model, &State::open(&model), watch);
        let measured = (goal.measure)(&measure(&model, &closed.state.positions_mm, &closed.reactions_n));
        Ok::<_, Vec<Fault>>(Attempt {
            value,
            model,
            closed,
            measured,
        })
    };
    let reaches = |attempt: &Attempt| attempt.certified() && attempt.measured >= goal.at_least;
    let part = |step: u32| f64::from(step) / f64::from(FIRST_TRIED - 1);
    let value = |step: u32| goal.gentlest + part(step) * (goal.most_drastic - goal.gentlest);
    let first = (0..FIRST_TRIED).into_par_iter().map(|step| attempt(value(step)));
    let first: Vec<Result<Attempt, Vec<Fault>>> = first.collect();
    // One after the other: of several faults the first is told, whichever thread was faster.
    let mut first: Vec<Attempt> = first.into_iter().collect::<Result<_, _>>()?;
    let mut tried: Vec<Tried> = first.iter().map(Attempt::tried).collect();
    let mut answer = None;
    if let Some(index) = first.iter().position(reaches) {
        let mut good = first.swap_remove(index);
        // The one before it is where it was.
        let mut poor = index.checked_sub(1).map(|before| first.swap_remove(before));
        while let Some(short) = &poor
            && (good.value - short.value).abs() > goal.tolerance
        {
            let value = guess(goal, &model_at, [short, &good], tried.len());
            // A tolerance below what numbers can tell apart.
            if value == short.value || value == good.value {
                break;
            }
            let next = attempt(value)?;
            tried.push(next.tried());
            if reaches(&next) {
                good = next;
            } else {
                poor = Some(next);
            }
        }
        answer = Some(good.tried());
    }
    let way = (goal.most_drastic - goal.gentlest).signum();
    tried.sort_by(|a, b| (way * a.value).total_cmp(&(way * b.value)));
    Ok(Found { answer, tried })
}

fn check<F>(goal: &Goal<F>) -> Result<(), Fault> {
    let numbers = [goal.gentlest, goal.most_drastic, goal.tolerance, goal.at_least];
    if !numbers.iter().all(|number| number.is_finite()) || goal.gentlest == goal.most_drastic {
        let message = format!(
            "goes from {} to {}, for at least {}; expected two different numbers, and a number",
            goal.gentlest, goal.most_drastic, goal.at_least
        );
        return Err(Fault::error("range", message));
    }
    if goal.tolerance <= 0.0 {
        return Err(Fault::error(
            "tolerance",
            format!("is {}; expected more than 0", goal.tolerance),
        ));
    }
    Ok(())
}

/// Where between two values the goal is just reached, by the rate of change at the one that is nearer to it.
fn guess<F: Fn(&Measures) -> f64>(
    goal: &Goal<F>,
    model_at: &(dyn Fn(f64) -> Result<Model, Vec<Fault>> + Sync),
    [short, good]: [&Attempt; 2],
    count: usize,
) -> f64 {
    let middle = f64::midpoint(short.value, good.value);
    if count.is_multiple_of(HALVED_EVERY) {
        return middle;
    }
    let missing = |attempt: &Attempt| goal.at_least - attempt.measured;
    let from = match missing(short).abs() < missing(good).abs() && short.certified() {
        true => short,
        false => good,
    };
    let parameter = Parameter {
        model_at,
        value: from.value,
        scale: (goal.most_drastic - goal.gentlest).abs(),
    };
    let step = match sensitivity(&from.model, &from.closed, &parameter) {
        Ok(rates) => missing(from) / rates.rate(&goal.measure),
        // A shape that is not stable has no rates.
        Err(_) => f64::NAN,
    };
    if !step.is_finite() {
        return middle;
    }
    let kept = (LEAST_STEP * goal.tolerance).min(0.5 * (good.value - short.value).abs());
    let (low, high) = (
        short.value.min(good.value) + kept,
        short.value.max(good.value) - kept,
    );
    (from.value + step).clamp(low, high.max(low))
}

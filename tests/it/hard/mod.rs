//! The gallery of hard cases: valves and sheets that solvers like to fail on. Each is closed from ten slightly different
//! starts; each time it must be certified, or end with the status that the case says and why. `docs/hard-cases.md` is the
//! table of them; with `COAPT_WRITE_TABLES` in the environment the test writes it anew.

mod bodies;
mod determinism;
mod table;
mod valves;

use std::time::Instant;

use coapt::Vec3;
use coapt::contact::surface::Surface;
use coapt::contact::tangle::inside_out;
use coapt::model::Model;
use coapt::relax::{Equilibrium, Iteration, Status, relax};
use coapt::scene::Fault;
use coapt::state::State;
use coapt_tests::Random;
use rayon::prelude::*;

/// Starts of each case.
pub(super) const STARTS: u64 = 10;
/// Points are moved by up to this part of an edge [1].
pub(super) const JITTER: f64 = 1e-3;

/// Makes a model and where it begins, or the faults with which it is refused.
type Make = Box<dyn Fn(&mut Jitter) -> Result<(Model, State), Vec<Fault>> + Send + Sync>;

/// A case of the gallery.
pub(super) struct HardCase {
    /// Name in the table.
    pub(super) name: String,
    /// What is hard about it, for the table.
    pub(super) what: &'static str,
    /// Makes the model and where it begins, or the faults with which it is refused.
    pub(super) make: Make,
    /// How it must end.
    pub(super) end: End,
}

/// How a case must end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum End {
    /// With a certificate, to the default residual.
    Certified,
    /// Without one, with one of these statuses, since there is no balance to be found or the method ends there; and why.
    Uncertified(&'static [Status], &'static str),
    /// Refused with a fault that says these words.
    Refused(&'static str),
}

/// Moves points a little, another way for each start; start 0 not at all.
pub(super) struct Jitter {
    random: Random,
    scale: f64,
}

impl Jitter {
    pub(super) fn of_start(start: u64) -> Self {
        let scale = if start == 0 { 0.0 } else { JITTER };
        Self {
            random: Random(start),
            scale,
        }
    }

    /// A point moved by up to [`JITTER`] edges in each direction.
    pub(super) fn moved(&mut self, point: Vec3, edge_mm: f64) -> Vec3 {
        point + self.random.vector() * (self.scale * edge_mm)
    }
}

fn cases() -> Vec<HardCase> {
    valves::cases().into_iter().chain(bodies::cases()).collect()
}

/// How a start of a case ended.
struct Outcome {
    /// None where the model was refused.
    equilibrium: Option<Equilibrium>,
    wall_ms: f64,
    /// What is wrong with it, if anything is.
    complaint: Option<String>,
}

fn run(case: &HardCase, start: u64) -> Outcome {
    let begun = Instant::now();
    let made = (case.make)(&mut Jitter::of_start(start));
    let ended = made.map(|(model, state)| {
        let equilibrium = relax(&model, &state);
        let is_within = equilibrium.certificate.residual <= model.settings.residual_tolerance;
        let is_turned = is_inside_out(&model, &equilibrium.state);
        let is_sane = is_sane(&equilibrium, model.settings.iteration_limit);
        (equilibrium, [is_within, is_sane], is_turned)
    });
    let wall_ms = 1e3 * begun.elapsed().as_secs_f64();
    let complaint = match (&ended, case.end) {
        (Err(faults), End::Refused(words)) => {
            let told = faults.iter().any(|fault| fault.message.contains(words));
            (!told).then(|| format!("{faults:?} instead of `{words}`"))
        }
        (Err(faults), _) => Some(format!("refused: {faults:?}")),
        (Ok((equilibrium, _, true)), _) => Some(format!("inside out: {}", words(equilibrium))),
        (Ok((equilibrium, [is_within, is_sane], false)), end) => {
            let status = equilibrium.status;
            let is_right = match end {
                End::Certified => *is_within && equilibrium.certificate.is_certified(status),
                End::Uncertified(statuses, _) => statuses.contains(&status),
                End::Refused(_) => false,
            };
            (!is_right || !is_sane).then(|| words(equilibrium))
        }
    };
    Outcome {
        equilibrium: ended.ok().map(|(equilibrium, ..)| equilibrium),
        wall_ms,
        complaint: complaint.map(|words| format!("{}, start {start}: {words}", case.name)),
    }
}

fn words(end: &Equilibrium) -> String {
    format!(
        "{:?}, residual {:.1e}, stable {}, {} crossings, {} iterations",
        end.status,
        end.certificate.residual,
        end.certificate.stable,
        end.certificate.crossings.len(),
        end.history.len()
    )
}

/// Whether a body came to where it could have come only through itself, which no crossing tells of afterwards.
fn is_inside_out(model: &Model, end: &State) -> bool {
    let surface = Surface::new(&model.faces, &model.rest_mm);
    model.contact.is_on() && !inside_out(&surface, &model.rest_mm, &end.positions_mm).is_empty()
}

/// Whether all that is told of a closure are numbers, nothing crosses and no mesh took more iterations than were allowed, whatever its
/// status: no case begins crossed that is not drawn apart or refused before.
fn is_sane(end: &Equilibrium, iteration_limit: u32) -> bool {
    let finite = |vectors: &[Vec3]| vectors.iter().all(|v| v.iter().all(|x| x.is_finite()));
    let sound = |iteration: &Iteration| {
        iteration.residual.is_finite()
            && iteration.step_mm.is_finite()
            && (0.0..=1.0).contains(&iteration.fraction)
    };
    finite(&end.state.positions_mm)
        && finite(&end.reactions_n)
        && end.certificate.residual.is_finite()
        && end.certificate.max_penetration_mm.is_finite()
        && end.certificate.crossings.is_empty()
        && end.history.iter().all(sound)
        && most_on_one_mesh(end) <= iteration_limit as usize
}

/// Iterations on the mesh that took the most, begun anew or not.
fn most_on_one_mesh(end: &Equilibrium) -> usize {
    let on = |faces: usize| end.history.iter().filter(|made| made.faces == faces).count();
    end.history.iter().map(|made| on(made.faces)).max().unwrap_or(0)
}

#[test]
fn every_hard_case_ends_as_it_says() {
    let cases = cases();
    let starts: Vec<(usize, u64)> = (0..cases.len())
        .flat_map(|case| (0..STARTS).map(move |start| (case, start)))
        .collect();
    let outcomes: Vec<Outcome> = starts
        .par_iter()
        .map(|&(case, start)| run(&cases[case], start))
        .collect();
    let of_cases: Vec<&[Outcome]> = outcomes.chunks(STARTS as usize).collect();
    table::write_or_compare(&cases, &of_cases);
    let complaints: Vec<&str> = outcomes
        .iter()
        .filter_map(|outcome| outcome.complaint.as_deref())
        .collect();
    assert!(
        complaints.is_empty(),
        "{} of {}:\n{}",
        complaints.len(),
        outcomes.len(),
        complaints.join("\n")
    );
}

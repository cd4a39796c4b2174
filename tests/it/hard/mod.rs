//! The gallery of hard cases: valves and sheets that solvers like to fail on. Each is closed from ten slightly different
//! starts; each time it must be certified, or end with the status that the case says and why. `docs/hard-cases.md` is the
//! table of them, written by this test.

mod bodies;

use coapt::Vec3;
use coapt::model::Model;
use coapt::relax::{Equilibrium, Status, relax};
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
    /// Without one, since there is no balance to be found, with one of these statuses; why stands in the case.
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
    bodies::cases()
}

/// What is wrong with how a start ended, if anything is.
fn complaint(case: &HardCase, start: u64) -> Option<String> {
    let name = format!("{}, start {start}", case.name);
    let (model, state) = match ((case.make)(&mut Jitter::of_start(start)), case.end) {
        (Ok(made), _) => made,
        (Err(faults), End::Refused(words)) => {
            let told = faults.iter().any(|fault| fault.message.contains(words));
            return (!told).then(|| format!("{name}: {faults:?} instead of `{words}`"));
        }
        (Err(faults), _) => return Some(format!("{name}: refused: {faults:?}")),
    };
    let end = relax(&model, &state);
    let certificate = &end.certificate;
    let is_right = match case.end {
        End::Certified => {
            certificate.is_certified(end.status) && certificate.residual <= model.settings.residual_tolerance
        }
        End::Uncertified(statuses, _) => statuses.contains(&end.status),
        End::Refused(_) => false,
    };
    // Nothing began crossed: a case that does is drawn apart or refused while its model is made.
    (!is_right || !is_sane(&end) || !certificate.crossings.is_empty()).then(|| {
        format!(
            "{name}: {:?}, residual {:.1e}, stable {}, {} crossings, {} iterations",
            end.status,
            certificate.residual,
            certificate.stable,
            certificate.crossings.len(),
            end.history.len()
        )
    })
}

/// Whether all that is told of a closure are numbers, whatever its status.
fn is_sane(end: &Equilibrium) -> bool {
    let finite = |vectors: &[Vec3]| vectors.iter().all(|v| v.iter().all(|x| x.is_finite()));
    let sound = |iteration: &coapt::relax::Iteration| {
        iteration.residual.is_finite()
            && iteration.step_mm.is_finite()
            && (0.0..=1.0).contains(&iteration.fraction)
    };
    finite(&end.state.positions_mm)
        && finite(&end.reactions_n)
        && end.certificate.residual.is_finite()
        && end.certificate.max_penetration_mm.is_finite()
        && end.history.iter().all(sound)
}

#[test]
fn every_hard_case_ends_as_it_says() {
    let cases = cases();
    let starts: Vec<(&HardCase, u64)> = cases
        .iter()
        .flat_map(|case| (0..STARTS).map(move |start| (case, start)))
        .collect();
    let complaints: Vec<String> = starts
        .par_iter()
        .filter_map(|&(case, start)| complaint(case, start))
        .collect();
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

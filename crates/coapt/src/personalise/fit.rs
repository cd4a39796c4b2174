//! The search for the factors: a scan of one for all, then Gauss-Newton on sensitivities from regression.

use super::closures::{Closed, Closures};
use super::parameters::Parameters;
use super::regression::{Regression, regress};
use super::{ChordFit, FitSettings, FitStatus, FitWatch, GroupScale, Target};
use crate::model::{ChordGroup, ChordKind, Model};

/// Distance between the factors of the scan [1]: half the reach over which distances of all presets are linear in the factor
/// to a tenth. A scan four times as fine finds the same valley.
const SCAN_STEP: f64 = 0.2;

/// Changes of the factors from which sensitivities are had, from wide to narrow [1]. From 0.01, leaflets that slip are as
/// large as what is measured, and one factor for each group comes out up to 5 % wrong; beyond 0.15, slack chordae at one end
/// are taken for taut ones.
const RADII: [f64; 2] = [0.06, 0.03];
const RADII_PER_GROUP: [f64; 3] = [0.12, 0.06, 0.03];

/// Factors are tried so far to either side of the result [1]: where that changes the misfit by less than leaflets that slip
/// do, they are not decided to that side.
const PROBE: f64 = 0.1;

/// Rise of the misfit, as part of itself, that leaflets which slip cause now and then [1]: 1 to 2 % measured.
const SLIP: f64 = 0.04;

/// What leaflets that slip, and where the search ends, leave of a factor [1]: without any scatter one factor for all comes out
/// 0.0004 to 0.0009 wrong, one for each group up to 0.007. Added to intervals as an independent error.
const RESOLUTION: f64 = 0.005;

/// A wider interval does not count as decided [1]: a tenth of a chord, 2 mm, is what a fit is there to find.
const WIDEST_IDENTIFIED: f64 = 0.1;

/// Factors this near an end of their range are at it [1].
const AT_BOUND: f64 = 1e-3;

/// Fits a valve that has chordae to a target that has points.
pub(super) fn fit(model: &Model, target: &Target, settings: &FitSettings, watch: FitWatch) -> ChordFit {
    let mut closures = Closures::new(model, target, watch);
    let (untuned, best) = scan(&mut closures, settings);
    let found = best.and_then(|best| refine(&mut closures, best, settings));
    let (status, groups, tuned) = match found {
        _ if closures.interrupted => (FitStatus::Interrupted, unfitted(model, settings), None),
        Some((status, groups, closed)) => (status, groups, Some(closures.tried(&closed))),
        None => (FitStatus::NotConverged, unfitted(model, settings), None),
    };
    ChordFit {
        status,
        groups,
        untuned: untuned.map(|closed| closures.tried(&closed)),
        tuned,
        closures: closures.history.len(),
        unconverged: closures.history.len() - closures.converged.len(),
        history: closures.history,
    }
}

fn unfitted(model: &Model, settings: &FitSettings) -> Vec<GroupScale> {
    let group = |group: &ChordGroup| GroupScale {
        name: group.name.clone(),
        scale: 1.0,
        interval_95: settings.scale_range,
        identified: false,
    };
    let native = model
        .chord_groups
        .iter()
        .filter(|group| group.kind == ChordKind::Chorda);
    native.map(group).collect()
}

/// The valve as given, and the best of one factor for all.
fn scan(closures: &mut Closures, settings: &FitSettings) -> (Option<Closed>, Option<Closed>) {
    let [least, most] = settings.scale_range;
    let count = ((most - least) / SCAN_STEP).ceil();
    let factors = (0..=count as u32).map(|k| least + (most - least) * f64::from(k) / count);
    let one_for_all = Parameters::new(&closures.model.chord_groups, false);
    let none_changed = vec![1.0; closures.model.chord_groups.len()];
    let all_times = |factor: f64| one_for_all.one_moved(&none_changed, 0, factor - 1.0);
    let scales = std::iter::once(1.0).chain(factors);
    let mut closed = closures.close_all(scales.map(all_times).collect(), None);
    let in_range = |closed: &&Closed| (least..=most).contains(&one_for_all.value(0, &closed.scale));
    let error = |closed: &Closed| closed.misfit.of_all().mean_mm;
    let best = closed.iter().flatten().filter(in_range);
    let best = best.min_by(|a, b| error(a).total_cmp(&error(b))).cloned();
    (closed.swap_remove(0), best)
}

/// From the best common factor to the result.
fn refine(
    closures: &mut Closures,
    best: Closed,
    settings: &FitSettings,
) -> Option<(FitStatus, Vec<GroupScale>, Closed)> {
    let chord_groups = &closures.model.chord_groups;
    let mut parameters = Parameters::new(chord_groups, false);
    let (mut closed, mut regression, mut arrived) = descend(closures, best, &parameters, &RADII, settings)?;
    if settings.per_group {
        parameters = Parameters::new(chord_groups, true);
        (closed, regression, arrived) = descend(closures, closed, &parameters, &RADII_PER_GROUP, settings)?;
    }
    let intervals = intervals(closures, &closed, &parameters, &regression, settings);
    let fitted = |(group, parameter): (usize, &Option<usize>)| {
        let interval_95 = intervals[(*parameter)?];
        Some(GroupScale {
            name: chord_groups[group].name.clone(),
            scale: closed.scale[group],
            interval_95,
            identified: interval_95[1] - interval_95[0] < WIDEST_IDENTIFIED,
        })
    };
    let of_group = parameters.of_group.iter().enumerate();
    let groups: Vec<GroupScale> = of_group.filter_map(fitted).collect();
    let at_bound = |group: &GroupScale| {
        let to = |end: &f64| (group.scale - end).abs() < AT_BOUND;
        settings.scale_range.iter().any(to)
    };
    let status = match arrived {
        _ if groups.iter().any(at_bound) => FitStatus::AtBound,
        true => FitStatus::Fitted,
        false => FitStatus::IterationLimit,
    };
    Some((status, groups, closed))
}

/// Gauss-Newton from a closed state, with sensitivities from ever narrower surroundings: its end, the last regression, and
/// whether it came to rest. Nothing where too few closures converge.
fn descend(
    closures: &mut Closures,
    mut here: Closed,
    parameters: &Parameters,
    radii: &[f64],
    settings: &FitSettings,
) -> Option<(Closed, Regression, bool)> {
    let (mut steps, mut last) = (0, None);
    for &radius in radii {
        loop {
            let around = parameters.around(&here.scale, radius, settings.scale_range);
            let samples = closures.close_all(around, Some(&here.equilibrium.state));
            let regression = regress(closures, &here, parameters, radius)?;
            let cost = |closed: &Closed| regression.cost_mm2(closed);
            let least = |tried: Vec<Closed>| tried.into_iter().min_by(|a, b| cost(a).total_cmp(&cost(b)));
            // Warm closures only show where to go: where it stands is always reached from the open valve.
            let step = |part| regression.step(&here, parameters, 2.0 * radius, part, settings);
            let mut next = if parameters.count > 1 {
                vec![step(1.0), step(0.5)]
            } else {
                vec![step(1.0)]
            };
            let better =
                least(samples.into_iter().flatten().collect()).filter(|sample| cost(sample) < cost(&here));
            next.extend(better.map(|sample| sample.scale));
            let mut tried: Vec<Closed> = closures.close_all(next, None).into_iter().flatten().collect();
            tried.push(here.clone());
            let best = least(tried)?;
            let way = best
                .scale
                .iter()
                .zip(&here.scale)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f64::max);
            here = best;
            last = Some(regression);
            steps += 1;
            if steps >= settings.iteration_limit {
                return Some((here, last?, false));
            }
            if way < 0.5 * radius {
                break;
            }
        }
    }
    Some((here, last?, true))
}

/// The intervals of 95 %: from the curvature of the misfit, and to the end of the range where a probe finds it flat, or did
/// not converge and so tells nothing.
fn intervals(
    closures: &mut Closures,
    closed: &Closed,
    parameters: &Parameters,
    regression: &Regression,
    settings: &FitSettings,
) -> Vec<[f64; 2]> {
    let probes = (0..parameters.count)
        .flat_map(|k| [-PROBE, PROBE].map(|by| parameters.one_moved(&closed.scale, k, by)));
    let probed = closures.close_all(probes.collect(), None);
    let rises = |probe: &Option<Closed>| {
        let told =
            |probe: &Closed| probe.misfit.of_all().rms_mm > (1.0 + SLIP) * closed.misfit.of_all().rms_mm;
        probe.as_ref().is_some_and(told)
    };
    let reaches = regression.reaches(settings);
    let [least, most] = settings.scale_range;
    let interval = |k: usize| {
        let scale = parameters.value(k, &closed.scale);
        [
            if rises(&probed[2 * k]) {
                (scale - reaches[0][k].hypot(RESOLUTION)).max(least)
            } else {
                least
            },
            if rises(&probed[2 * k + 1]) {
                (scale + reaches[1][k].hypot(RESOLUTION)).min(most)
            } else {
                most
            },
        ]
    };
    (0..parameters.count).map(interval).collect()
}

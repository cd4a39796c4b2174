//! Lines below the row of a closed valve: the ring as it lies, how long neochordae are and which are slack, the open valve, what flows back, an ensemble, rates.

use std::collections::BTreeMap;

use coapt::measure::coaptation::FOLDS_FROM_MM2;
use coapt::measure::flow::HARDLY_OPENS_MM2;
use coapt::plan::Criterion;
use coapt::plan::ensemble::SEALED_BELOW_MM2;

use super::words::{Words, words};
use super::{Closed, Open, Rate, Sampled, Sensitivities};
use crate::report::{
    NOT_CERTIFIED, RepairReport, extent_words, number, orifice_doubt, reasons, repair_line, slack_line,
    slack_mark,
};

/// All lines of a closed valve; `before` is the valve as it is, for one after repair.
pub(crate) fn lines(closed: &Closed, before: Option<&Closed>) -> Vec<String> {
    let mut lines = Vec::new();
    if closed.solve.certified && closed.measures.orifice.area_mm2 >= SEALED_BELOW_MM2 {
        let [sharp, rounded] = closed.regurgitant_volume_ml;
        lines.push(format!(
            "lets back {} to {} mL a beat, by estimate, if the pressure held",
            number(sharp, 0),
            number(rounded, 0)
        ));
    }
    let doubt = closed
        .solve
        .certified
        .then(|| orifice_doubt(&closed.measures.orifice))
        .flatten();
    lines.extend(doubt.map(|doubt| format!("orifice {doubt}")));
    lines.extend(before.and_then(|before| of_folds(closed, before)));
    lines.extend(
        closed
            .ring_laid
            .as_ref()
            .map(|laid| format!("ring as laid: {}", extent_words(laid))),
    );
    lines.extend(closed.carried_out.iter().filter_map(of_chosen_length));
    let slack = closed.slack_neochordae.iter();
    lines.extend(slack.map(|slack| format!("{}: {}", slack_mark(slack), slack_line(slack))));
    let open_before = before.and_then(|before| before.diastole.as_ref());
    lines.extend(closed.diastole.as_ref().map(|open| of_open(open, open_before)));
    lines.extend(closed.uncertainty.as_ref().map(of_sampled).unwrap_or_default());
    lines.extend(closed.sensitivities.as_ref().map(of_rates).unwrap_or_default());
    lines
}

/// Whether a repair leaves tissue in excess, which folds; coaptation, longer for it, does not tell.
fn of_folds(closed: &Closed, before: &Closed) -> Option<String> {
    let [now_mm2, before_mm2] =
        [closed, before].map(|closed| closed.measures.coaptation.self_contact_area_mm2);
    (closed.solve.certified && now_mm2 - before_mm2 >= FOLDS_FROM_MM2).then(|| {
        format!(
            "FOLDS: a leaflet touches itself over {} mm², {} before: more tissue than this leaves room for",
            number(now_mm2, 0),
            number(before_mm2, 0)
        )
    })
}

/// How long the strands of a neochord are whose length nobody gave: what is to be cut to.
fn of_chosen_length(carried_out: &RepairReport) -> Option<String> {
    match carried_out {
        RepairReport::Neochord(neochord) if neochord.depth_mm.is_some() => Some(repair_line(carried_out)),
        _ => None,
    }
}

/// What stands beside a valve that seals by hardly opening, whatever its rank.
pub(crate) const HARDLY_OPENS: &str = "HARDLY OPENS";

fn of_open(open: &Open, before: Option<&Open>) -> String {
    let (Some(openings), Some(area_mm2)) = (&open.openings_mm2, open.area_mm2) else {
        let reasons = reasons(open.status, open.stable, open.crossings);
        return format!("open valve {NOT_CERTIFIED}: {reasons}");
    };
    let areas: Vec<String> = openings.iter().map(|area_mm2| number(*area_mm2, 0)).collect();
    let openings = match &areas[..] {
        [] => "no opening".to_owned(),
        [_] => "1 opening".to_owned(),
        _ => format!("{} openings of {} mm²", areas.len(), areas.join(", ")),
    };
    let gradient = match (open.hardly_opens, open.mean_gradient_mmhg) {
        (Some(true), _) => format!(
            "; {HARDLY_OPENS}: through {} mm², under {HARDLY_OPENS_MM2}, no gradient is told",
            number(area_mm2, 0)
        ),
        (_, Some(mmhg)) => format!("; mean gradient at most {} mmHg", number(mmhg, 1)),
        (_, None) => String::new(),
    };
    let left = match before.and_then(|before| before.area_mm2) {
        Some(before_mm2) if before_mm2 > 0.0 => {
            format!(
                "; {} % of what opened before",
                number(100.0 * area_mm2 / before_mm2, 0)
            )
        }
        _ => String::new(),
    };
    format!("open without pressure: {openings}{left}{gradient}")
}

/// What a surgeon reads: how often it seals, then medians and where nine of ten lie.
fn of_sampled(sampled: &Sampled) -> Vec<String> {
    let Sampled {
        samples,
        certified,
        in_doubt,
        refused,
        ..
    } = sampled;
    let mut lines = Vec::new();
    let percent = |part: f64| number(100.0 * part, 0);
    let Some(sealed) = sampled.sealed else {
        return vec![format!(
            "none of {samples} valves like this one closed with a certificate"
        )];
    };
    lines.push(format!(
        "seals in {} % of {certified} valves like this one ({} to {} %)",
        percent(sealed.estimate),
        percent(sealed.low),
        percent(sealed.high)
    ));
    let ranges = Criterion::ALL.into_iter().filter_map(|criterion| {
        let interval = sampled.intervals.get(criterion.name())?;
        let Words {
            title,
            unit,
            factor,
            digits,
            ..
        } = words(criterion);
        let at = |value: f64| number(factor * value, digits.min(1));
        Some(format!(
            "{title} {} ({} to {}) {unit}",
            at(interval.median),
            at(interval.low),
            at(interval.high)
        ))
    });
    let ranges: Vec<String> = ranges.collect();
    lines.push(format!("median (nine of ten): {}", ranges.join(", ")));
    if *in_doubt > 0 {
        lines.push(format!(
            "of {certified} valves {in_doubt} leave their orifice in doubt: more can pass between the surfaces than margins bound, or far less"
        ));
    }
    let lost = samples - certified - refused;
    if lost + refused > 0 {
        lines.push(format!(
            "of {samples} valves {lost} closed without a certificate and {refused} could not be repaired: they are not counted"
        ));
    }
    lines
}

fn of_rates(sensitivities: &Sensitivities) -> Vec<String> {
    sensitivities
        .iter()
        .map(|(key, rate)| of_rate(key, rate))
        .collect()
}

fn of_rate(key: &str, rate: &Rate) -> String {
    let (per, step) = match key {
        coapt::plan::CHORD_SCALE => ("per 1 % of length of all chordae".to_owned(), 0.01),
        _ => match unit_of(key) {
            Some((name, unit)) => (format!("per {unit} of {name}"), 1.0),
            None => (format!("per 0.1 of {key}"), 0.1),
        },
    };
    match &rate.missing {
        Some(missing) => format!("{per}: no rates, {missing}"),
        None => format!("{per}: {}", changes(&rate.per_unit, step)),
    }
}

/// `repair[0].size_mm` is `repair[0].size` in mm.
fn unit_of(key: &str) -> Option<(&str, &'static str)> {
    let units = [("_mm", "mm"), ("_deg", "degree"), ("_n", "N")];
    units
        .into_iter()
        .find_map(|(end, unit)| Some((key.strip_suffix(end)?, unit)))
}

fn changes(per_unit: &BTreeMap<String, f64>, step: f64) -> String {
    let told = Criterion::ALL.into_iter().filter_map(|criterion| {
        let Words {
            title,
            unit,
            factor,
            rate_digits,
            ..
        } = words(criterion);
        let change = number(factor * step * per_unit.get(criterion.name())?, rate_digits);
        let sign = match change.starts_with('-') || change.chars().all(|it| matches!(it, '0' | '.')) {
            true => "",
            false => "+",
        };
        Some(format!("{title} {sign}{change} {unit}"))
    });
    told.collect::<Vec<_>>().join(", ")
}

//! Neochordae that hold nothing back.

use serde::{Deserialize, Serialize};

use super::chord_forces;
use crate::Vec3;
use crate::model::{ChordKind, Model};
use crate::repair::Report;

/// A strand that bears less than this in the closed valve is slack [N]. Our choice: tensions are told to a hundredth of a newton, so that
/// less is told as none; what a chord of the margin bears in the presets is ten times as much and more.
pub const SLACK_BELOW_N: f64 = 0.01;

/// A neochord of which some strands, or all, are slack in the closed valve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SlackNeochord {
    /// The number of its repair, from 0.
    pub repair: usize,
    /// Name of its chord group.
    pub name: String,
    /// How many strands it has.
    pub strands: usize,
    /// How many of them bear less than [`SLACK_BELOW_N`].
    pub slack_strands: usize,
}

impl SlackNeochord {
    /// Whether no strand bears anything, so that the valve closes as without this repair.
    pub fn is_idle(&self) -> bool {
        self.slack_strands == self.strands
    }
}

/// Neochordae of some repairs that are slack at the given positions [mm], shape `[vertex]`, in the order of the repairs; `reports` is
/// what the repairs did, shape `[repair]`, and `model` the one after them.
///
/// A repair whose strands were cut again has none that could be slack.
pub fn slack_neochordae(model: &Model, reports: &[Report], positions_mm: &[Vec3]) -> Vec<SlackNeochord> {
    let tensions_n = chord_forces(model, positions_mm);
    let numbered = reports.iter().enumerate();
    let slack = numbered.filter_map(|(repair, report)| {
        let Report::Neochord(strung) = report else {
            return None;
        };
        let is_meant = |group: &u32| {
            let group = &model.chord_groups[*group as usize];
            group.kind == ChordKind::Neochorda && group.name == strung.name
        };
        let strands = model.chords.group.iter().zip(&tensions_n);
        let strands: Vec<f64> = strands
            .filter(|(group, _)| is_meant(group))
            .map(|(_, tension_n)| *tension_n)
            .collect();
        let slack_strands = strands
            .iter()
            .filter(|tension_n| **tension_n < SLACK_BELOW_N)
            .count();
        (slack_strands > 0).then(|| SlackNeochord {
            repair,
            name: strung.name.clone(),
            strands: strands.len(),
            slack_strands,
        })
    });
    slack.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::parametric::{Preset, ValveParameters, generate};
    use crate::repair;
    use crate::scene::{Neochord, Repair};

    fn neochord(position: f64, length_mm: f64) -> Repair {
        Repair::Neochord(Neochord {
            position: Some(position),
            length_mm: Some(length_mm),
            ..Neochord::to("posterior")
        })
    }

    /// In the open valve a strand longer than it spans bears nothing and a shorter one something: the second of three repairs is
    /// slack, and a loop of which one strand is cut has one left.
    #[test]
    fn strands_longer_than_they_span_are_slack() {
        let parameters = ValveParameters {
            face_count_target: 200,
            ..ValveParameters::preset(Preset::Healthy)
        };
        let model = Model::build(&generate(&parameters).unwrap()).unwrap().model;
        let applied = |repairs: &[Repair]| {
            let begun = (model.clone(), Vec::new());
            repairs.iter().fold(begun, |(model, mut reports), deed| {
                let repaired = repair::apply(&model, deed).unwrap();
                reports.push(repaired.report);
                (repaired.model, reports)
            })
        };
        let found = |repairs: &[Repair]| {
            let (model, reports) = applied(repairs);
            slack_neochordae(&model, &reports, &model.rest_mm)
        };
        let slack = found(&[neochord(0.4, 5.0), neochord(0.6, 60.0), neochord(0.5, 5.0)]);
        assert_eq!(slack.len(), 1, "{slack:?}");
        assert_eq!(slack[0].name, "neochord posterior 0.6");
        assert_eq!((slack[0].repair, slack[0].strands), (1, 2));
        assert!(slack[0].is_idle());
        assert_eq!(found(&[]), []);
        // Spans differ from strand to strand: between them one is taut and the other slack.
        let (_, reports) = applied(&[neochord(0.3, 5.0)]);
        let Report::Neochord(report) = &reports[0] else {
            panic!("{reports:?}");
        };
        let middle_mm = report.open_mm.iter().sum::<f64>() / 2.0;
        let half = found(&[neochord(0.3, middle_mm)]);
        assert_eq!(
            (half[0].strands, half[0].slack_strands),
            (2, 1),
            "{:?}",
            report.open_mm
        );
        assert!(!half[0].is_idle());
    }
}

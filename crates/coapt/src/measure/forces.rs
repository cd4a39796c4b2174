//! Chordal tensions and the forces on the papillary muscles and the annulus.

use serde::{Deserialize, Serialize};

use crate::Vec3;
use crate::model::{ChordGroup, ChordKind, Model};

/// Chordal tensions, of the patient's own chordae and of neochordae.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ChordMeasures {
    /// Largest tension of any segment [N].
    pub max_force_n: f64,
    /// Sum of the tensions of the segments that insert into a leaflet [N]; so a chord of several segments counts once
    /// and a branched one by its branches.
    pub total_force_n: f64,
    /// The same per group, shape `[group of chordae]`.
    pub groups: Vec<ChordGroupMeasures>,
}

/// Chordal tensions of one group.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChordGroupMeasures {
    /// Name of the group.
    pub name: String,
    /// Largest tension of any segment [N].
    pub max_force_n: f64,
    /// Sum of the tensions of the segments that insert into a leaflet [N].
    pub total_force_n: f64,
}

/// Tensions of the sutures of one repair: stitches, or what the grip of a clip carries.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SutureMeasures {
    /// Name of the repair.
    pub name: String,
    /// Largest tension of any suture [N].
    pub max_force_n: f64,
    /// Sum of the tensions [N].
    pub total_force_n: f64,
}

/// Force on one papillary muscle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PapillaryMeasures {
    /// Name.
    pub name: String,
    /// Force of the chordae on the muscle's tips together [N].
    pub force_n: [f64; 3],
}

/// Tension of each chord segment [N], shape `[segment]`: section times the stress of its group's law at `l/L₀ - 1`, zero when slack.
pub fn chord_forces(model: &Model, positions_mm: &[Vec3]) -> Vec<f64> {
    let positions_mm = super::usable_positions(model, positions_mm);
    model.chords.tensions_n(positions_mm)
}

/// Largest tension and the total, over all chordae and per group of chordae.
pub(super) fn chords(model: &Model, positions_mm: &[Vec3]) -> ChordMeasures {
    let tensions = chord_forces(model, positions_mm);
    let is_suture = |group: &ChordGroup| group.kind == ChordKind::Suture;
    let mut m = ChordMeasures::default();
    for (number, group) in model.chord_groups.iter().enumerate() {
        if is_suture(group) {
            continue;
        }
        let [max_force_n, total_force_n] = of_group(model, &tensions, number);
        m.max_force_n = m.max_force_n.max(max_force_n);
        m.total_force_n += total_force_n;
        m.groups.push(ChordGroupMeasures {
            name: group.name.clone(),
            max_force_n,
            total_force_n,
        });
    }
    m
}

/// The same of each repair that sewed leaflets together.
pub(super) fn sutures(model: &Model, positions_mm: &[Vec3]) -> Vec<SutureMeasures> {
    let tensions = chord_forces(model, positions_mm);
    let groups = model.chord_groups.iter().enumerate();
    let sutures = groups.filter(|(_, group)| group.kind == ChordKind::Suture);
    let measured = sutures.map(|(number, group)| {
        let [max_force_n, total_force_n] = of_group(model, &tensions, number);
        SutureMeasures {
            name: group.name.clone(),
            max_force_n,
            total_force_n,
        }
    });
    measured.collect()
}

/// Largest tension in a group, and the sum over its segments that insert into a leaflet [N].
fn of_group(model: &Model, tensions_n: &[f64], group: usize) -> [f64; 2] {
    let chords = &model.chords;
    let (mut largest, mut total) = (0.0_f64, 0.0);
    for (segment, &tension) in tensions_n.iter().enumerate() {
        if chords.group[segment] as usize != group {
            continue;
        }
        let inserts = chords.ends[segment].iter().any(|&point| {
            let vertices = &chords.points[point as usize];
            vertices
                .iter()
                .any(|&(vertex, _)| (vertex as usize) < model.leaflet_vertex_count)
        });
        largest = largest.max(tension);
        total += if inserts { tension } else { 0.0 };
    }
    [largest, total]
}

/// Force of the valve on each papillary muscle: sum over its tips.
pub(super) fn papillary(model: &Model, nodal_reaction_n: &[Vec3]) -> Vec<PapillaryMeasures> {
    let muscles = model.papillary.iter();
    muscles
        .map(|p| PapillaryMeasures {
            name: p.name.clone(),
            force_n: total(&p.tips, nodal_reaction_n),
        })
        .collect()
}

/// Force of the valve on the whole annulus.
pub(super) fn annulus_force_n(model: &Model, nodal_reaction_n: &[Vec3]) -> [f64; 3] {
    total(&model.annulus, nodal_reaction_n)
}

fn total(vertices: &[u32], nodal_reaction_n: &[Vec3]) -> [f64; 3] {
    let known = vertices.iter().filter_map(|&v| nodal_reaction_n.get(v as usize));
    known
        .filter(|f| f.iter().all(|x| x.is_finite()))
        .sum::<Vec3>()
        .into()
}

#[cfg(test)]
mod tests {
    use super::super::test_models::sheet;
    use super::*;
    use crate::energy::chord::Chords;
    use crate::model::Papillary;
    use crate::scene::ChordLaw;

    /// A 2 × 2 sheet whose corner 0 hangs by a trunk of two segments from a tip at (0, 0, -10), branching to corner 1,
    /// and a slack chord to corner 2.
    fn hung() -> Model {
        let mut model = sheet(1, 2.0, 1);
        model
            .rest_mm
            .extend([Vec3::new(0.0, 0.0, -5.0), Vec3::new(0.0, 0.0, -10.0)]);
        let (node, tip) = (4, 5);
        model.chords = Chords {
            points: (0..6).map(|vertex| vec![(vertex, 1.0)]).collect(),
            ends: vec![[tip, node], [node, 0], [node, 1], [tip, 2]],
            rest_length_mm: vec![4.0, 4.0, 29f64.sqrt() / 1.1, 50.0],
            area_mm2: vec![2.0, 1.0, 3.0, 4.0],
            group: vec![1, 0, 0, 1],
            laws: vec![ChordLaw::Linear { modulus_mpa: 10.0 }; 2],
        };
        let group = |name: &str, kind| ChordGroup {
            name: name.into(),
            kind,
        };
        model.chord_groups = vec![
            group("marginal", ChordKind::Chorda),
            group("strut", ChordKind::Neochorda),
        ];
        model.papillary = vec![Papillary {
            name: "anterolateral".into(),
            tips: vec![tip],
        }];
        model
    }

    /// Tensions by hand: 20 · 1/4, 10 · 1/4, 30 · 0.1, slack; to rounding.
    #[test]
    fn tensions() {
        let model = hung();
        assert_eq!((model.rest_mm[1] - model.rest_mm[4]).norm(), 29f64.sqrt());
        let t = chord_forces(&model, &model.rest_mm);
        for (found, expected) in t.iter().zip([5.0, 2.5, 3.0, 0.0]) {
            assert!((found - expected).abs() < 1e-12, "{t:?}");
        }
        let m = chords(&model, &model.rest_mm);
        assert!(
            (m.max_force_n - 5.0).abs() < 1e-12 && (m.total_force_n - 5.5).abs() < 1e-12,
            "{m:?}"
        );
        let group = |i: usize| (m.groups[i].max_force_n, m.groups[i].total_force_n);
        assert!(
            (group(0).0 - 3.0).abs() < 1e-12 && (group(0).1 - 5.5).abs() < 1e-12,
            "{m:?}"
        );
        assert!((group(1).0 - 5.0).abs() < 1e-12 && group(1).1 == 0.0, "{m:?}");
    }

    /// The same as sutures: no chord pulls 5 N any more, the sutures do.
    #[test]
    fn sutures_are_told_apart() {
        let mut model = hung();
        model.chord_groups[1].kind = ChordKind::Suture;
        let m = chords(&model, &model.rest_mm);
        assert_eq!(m.groups.len(), 1);
        assert!(
            (m.max_force_n - 3.0).abs() < 1e-12 && (m.total_force_n - 5.5).abs() < 1e-12,
            "{m:?}"
        );
        let sewn = sutures(&model, &model.rest_mm);
        assert_eq!(sewn.len(), 1);
        assert!(
            (sewn[0].max_force_n - 5.0).abs() < 1e-12 && sewn[0].name == "strut",
            "{sewn:?}"
        );
    }

    /// Reactions are summed over the right vertices; missing and undefined ones count as zero.
    #[test]
    fn reactions() {
        let mut model = hung();
        model.annulus = vec![1, 3];
        let mut reaction: Vec<Vec3> = (0..6).map(|i| Vec3::new(f64::from(1 << i), 0.0, -1.0)).collect();
        assert_eq!(annulus_force_n(&model, &reaction), [10.0, 0.0, -2.0]);
        assert_eq!(papillary(&model, &reaction)[0].force_n, [32.0, 0.0, -1.0]);
        reaction[3].y = f64::NAN;
        assert_eq!(annulus_force_n(&model, &reaction), [2.0, 0.0, -1.0]);
        assert_eq!(papillary(&model, &reaction[..2])[0].force_n, [0.0; 3]);
    }
}

//! Chords put in by a surgeon, and chords taken out.

use std::collections::BTreeSet;

use crate::Vec3;
use crate::energy::chord::WeightedVertices;
use crate::model::{ChordGroup, ChordKind, Model};
use crate::scene::ChordLaw;

/// A new chord of one segment.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Rod {
    /// Its ends.
    pub(super) ends: [WeightedVertices; 2],
    /// Unloaded length [mm].
    pub(super) rest_length_mm: f64,
    /// Cross-section [mm²].
    pub area_mm2: f64,
}

/// Adds rods of a linear law as a chord group of their own; the name that it got.
pub(super) fn string(
    model: &mut Model,
    name: &str,
    kind: ChordKind,
    modulus_mpa: f64,
    rods: Vec<Rod>,
) -> String {
    let name = unused_name(model, name);
    let group = model.chord_groups.len() as u32;
    let chords = &mut model.chords;
    chords.laws.push(ChordLaw::Linear { modulus_mpa });
    for rod in rods {
        let first = chords.points.len() as u32;
        chords.points.extend(rod.ends);
        chords.ends.push([first, first + 1]);
        chords.rest_length_mm.push(rod.rest_length_mm);
        chords.area_mm2.push(rod.area_mm2);
        chords.group.push(group);
    }
    model.chord_groups.push(ChordGroup {
        name: name.clone(),
        kind,
    });
    name
}

/// A name that no chord group has yet: the one asked for, or with a number behind it.
fn unused_name(model: &Model, name: &str) -> String {
    let taken = |name: &str| model.chord_groups.iter().any(|group| group.name == name);
    let numbered = (2..).map(|number| format!("{name} ({number})"));
    let mut names = std::iter::once(name.to_owned()).chain(numbered);
    names.find(|name| !taken(name)).unwrap_or_else(|| name.to_owned())
}

/// Where a weighted place is [mm].
pub(super) fn place_mm(place: &WeightedVertices, positions_mm: &[Vec3]) -> Vec3 {
    place
        .iter()
        .map(|&(vertex, weight)| positions_mm[vertex as usize] * weight)
        .sum()
}

/// The vertex of a chord point where chords branch; none for tips and places on leaflets.
pub(super) fn node_of(model: &Model, point: u32) -> Option<u32> {
    let &[(vertex, _)] = &model.chords.points[point as usize][..] else {
        return None;
    };
    let is_tip = model.papillary.iter().any(|muscle| muscle.tips.contains(&vertex));
    (vertex as usize >= model.leaflet_vertex_count && !is_tip).then_some(vertex)
}

/// Takes segments out, what they leave hanging from one end, and the branchings at which nothing meets any more.
pub(super) fn without(model: &Model, segments: &BTreeSet<usize>) -> Model {
    let mut cut = segments.clone();
    loop {
        let mut left_at = vec![0_u32; model.rest_mm.len()];
        let nodes_of = |segment: usize| {
            let ends = model.chords.ends[segment];
            ends.into_iter().filter_map(|point| node_of(model, point))
        };
        let left: Vec<usize> = (0..model.chords.ends.len())
            .filter(|segment| !cut.contains(segment))
            .collect();
        left.iter()
            .flat_map(|&segment| nodes_of(segment))
            .for_each(|node| left_at[node as usize] += 1);
        let hangs = |&segment: &usize| nodes_of(segment).any(|node| left_at[node as usize] == 1);
        let hanging: Vec<usize> = left.into_iter().filter(hangs).collect();
        if hanging.is_empty() {
            break;
        }
        cut.extend(hanging);
    }
    let mut kept = model.clone();
    let chords = &mut kept.chords;
    let stays = |segment: usize| !cut.contains(&segment);
    keep(&mut chords.ends, stays);
    keep(&mut chords.rest_length_mm, stays);
    keep(&mut chords.area_mm2, stays);
    keep(&mut chords.group, stays);
    let used: BTreeSet<u32> = chords.ends.iter().flatten().copied().collect();
    let number = |point: u32| used.range(..point).count() as u32;
    chords.ends.iter_mut().for_each(|ends| *ends = ends.map(number));
    keep(&mut chords.points, |point| used.contains(&(point as u32)));
    drop_vertices(model, kept)
}

/// Leaves out branchings that no chord reaches any more.
fn drop_vertices(before: &Model, mut model: Model) -> Model {
    let reached: BTreeSet<u32> = model
        .chords
        .points
        .iter()
        .flatten()
        .map(|&(vertex, _)| vertex)
        .collect();
    let nodes = (0..before.chords.points.len() as u32).filter_map(|point| node_of(before, point));
    let gone: BTreeSet<u32> = nodes.filter(|node| !reached.contains(node)).collect();
    let number = |vertex: u32| vertex - gone.range(..vertex).count() as u32;
    for (vertex, _) in model.chords.points.iter_mut().flatten() {
        *vertex = number(*vertex);
    }
    for tip in model.papillary.iter_mut().flat_map(|muscle| &mut muscle.tips) {
        *tip = number(*tip);
    }
    model
        .prescribed
        .iter_mut()
        .for_each(|fixed| fixed.vertex = number(fixed.vertex));
    model.dead_loads_n.retain(|(vertex, _)| !gone.contains(vertex));
    model
        .dead_loads_n
        .iter_mut()
        .for_each(|(vertex, _)| *vertex = number(*vertex));
    keep(&mut model.rest_mm, |vertex| !gone.contains(&(vertex as u32)));
    model
}

fn keep<T>(items: &mut Vec<T>, stays: impl Fn(usize) -> bool) {
    let mut number = 0..;
    items.retain(|_| number.next().is_some_and(&stays));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::fixtures::{built, skirt};

    /// Of six segments, from each of two tips a trunk and two branches, one branch is cut: the rest stays as it was. Then the
    /// other branch of that trunk: trunk and branching go, and the tips are renumbered.
    #[test]
    fn what_is_left_hanging_goes_too() {
        let model = built(&skirt()).model;
        let one = without(&model, &BTreeSet::from([1]));
        assert_eq!((one.chords.ends.len(), one.chords.points.len()), (5, 7));
        assert_eq!(one.rest_mm, model.rest_mm);
        let both = without(&model, &BTreeSet::from([1, 2]));
        assert_eq!((both.chords.ends.len(), both.chords.points.len()), (3, 4));
        assert_eq!(both.rest_mm.len(), model.rest_mm.len() - 1);
        for (muscle, old) in both.papillary.iter().zip(&model.papillary) {
            assert_eq!(
                both.rest_mm[muscle.tips[0] as usize],
                model.rest_mm[old.tips[0] as usize]
            );
        }
        for (ends, old) in both.chords.ends.iter().zip(&model.chords.ends[3..]) {
            let at = |model: &Model, ends: &[u32; 2]| {
                ends.map(|point| model.chords.point_mm(point, &model.rest_mm))
            };
            assert_eq!(at(&both, ends), at(&model, old));
        }
        let moved: Vec<Vec3> = both
            .prescribed
            .iter()
            .map(|p| both.rest_mm[p.vertex as usize])
            .collect();
        let before: Vec<Vec3> = model
            .prescribed
            .iter()
            .map(|p| model.rest_mm[p.vertex as usize])
            .collect();
        assert_eq!(moved, before);
    }
}

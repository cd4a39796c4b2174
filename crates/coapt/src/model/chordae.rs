//! Chordae ready to pull: every rod between two chord points, with rest length, cross-section and law.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use super::attachment::{self, Anchor, Attached, Segment};
use super::chord_checks::{Length, check_components, judge_lengths, refuse_short_circuits};
use super::faults::Faults;
use super::strands::{self, Rod};
use super::surface::Surface;
use crate::Vec3;
use crate::energy::chord::Chords;
use crate::scene::{ChordGroup, Scene};

/// Chords over the vertices leaflets, `nodes`, tips, in this order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Strung {
    pub(crate) chords: Chords,
    /// Positions of the chord nodes.
    pub(crate) nodes: Vec<Vec3>,
    /// What was given and is not among them.
    pub(crate) left_out: Vec<LeftOut>,
}

/// Chord segments of a group that reach neither tip nor leaflet, or hang on such: the model is without them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// Name of the group.
    pub group: String,
    /// How many of its segments.
    pub segments: usize,
}

/// Welds, checks and numbers the chordae.
pub(crate) fn string(scene: &Scene, leaflet: &Surface, tips: &[Vec3], faults: &mut Faults) -> Strung {
    let mut attached = attachment::attach(scene, leaflet, tips);
    refuse_short_circuits(&attached, faults);
    drop_duplicates(&mut attached.segments, faults);
    check_components(&attached, tips, faults);
    if faults.any_error() {
        return Strung::default();
    }
    let groups_left_out = drop_free_ends(&mut attached, &leaflet.points, faults);
    let count = |(number, group): (usize, &ChordGroup)| LeftOut {
        group: group.name.clone(),
        segments: groups_left_out
            .iter()
            .filter(|&&of| of as usize == number)
            .count(),
    };
    let left_out = scene.chordae.iter().enumerate().map(count);
    Strung {
        left_out: left_out.filter(|of_group| of_group.segments > 0).collect(),
        ..number(scene, &attached, &leaflet.points, tips, faults)
    }
}

fn drop_duplicates(segments: &mut Vec<Segment>, faults: &mut Faults) {
    let mut first_of: BTreeMap<[Anchor; 2], String> = BTreeMap::new();
    let mut dropped: Vec<[String; 2]> = Vec::new();
    segments.retain(|segment| {
        let [a, b] = segment.ends;
        let name = segment.name();
        if let Some(first) = first_of.get(&[a.min(b), a.max(b)]) {
            dropped.push([name, first.clone()]);
            return false;
        }
        first_of.insert([a.min(b), a.max(b)], name);
        true
    });
    if let Some([name, first]) = dropped.first() {
        let message = format!(
            "joins the same points as {first} and is left out ({} such)",
            dropped.len()
        );
        faults.warning(name, message);
    }
}

/// Chord ends that reach nothing carry nothing: leaves them out, and what they leave behind, each segment once. Returns the
/// group of each that is left out.
fn drop_free_ends(attached: &mut Attached, leaflet: &[Vec3], faults: &mut Faults) -> Vec<u32> {
    let segments = &attached.segments;
    let mut at_node: Vec<Vec<usize>> = vec![Vec::new(); attached.nodes.len()];
    for (number, segment) in segments.iter().enumerate() {
        for node in nodes(segment) {
            at_node[node].push(number);
        }
    }
    let mut degree: Vec<usize> = at_node.iter().map(Vec::len).collect();
    let mut dropped = vec![false; segments.len()];
    let mut free: VecDeque<usize> = segments
        .iter()
        .flat_map(nodes)
        .filter(|&node| degree[node] == 1)
        .collect();
    while let Some(node) = free.pop_front() {
        let Some(&number) = at_node[node].iter().find(|&&number| !dropped[number]) else {
            continue;
        };
        dropped[number] = true;
        faults.warning(
            segments[number].name(),
            reaches_nothing(attached.nodes[node], leaflet),
        );
        for end in nodes(&segments[number]) {
            degree[end] -= 1;
            if degree[end] == 1 {
                free.push_back(end);
            }
        }
    }
    let groups = segments.iter().zip(&dropped).filter(|(_, dropped)| **dropped);
    let groups = groups.map(|(segment, _)| segment.group).collect();
    let mut kept = dropped.iter().map(|dropped| !dropped);
    attached.segments.retain(|_| kept.next().unwrap_or(true));
    groups
}

fn nodes(segment: &Segment) -> impl Iterator<Item = usize> + use<> {
    segment.ends.into_iter().filter_map(|end| match end {
        Anchor::Node(node) => Some(node as usize),
        _ => None,
    })
}

fn reaches_nothing(at: Vec3, leaflet: &[Vec3]) -> String {
    let away = leaflet
        .iter()
        .map(|p| (p - at).norm())
        .fold(f64::INFINITY, f64::min);
    format!(
        "its end at ({:.2}, {:.2}, {:.2}) reaches neither tip nor leaflet and it is left out; the nearest leaflet point is \
         {away:.2} mm away",
        at.x, at.y, at.z
    )
}

/// Gives vertices numbers and rods their constants.
fn number(
    scene: &Scene,
    attached: &Attached,
    leaflet: &[Vec3],
    tips: &[Vec3],
    faults: &mut Faults,
) -> Strung {
    let lengths: Vec<Length> = attached
        .segments
        .iter()
        .map(|segment| length(scene, attached, segment, tips))
        .collect();
    judge_lengths(&lengths, faults);
    let segments = attached.segments.iter().zip(&lengths);
    let rods = segments.map(|(segment, length)| rod(scene, attached, segment, length, leaflet, tips));
    let rods = strands::join(rods.collect());
    let anchors: BTreeSet<Anchor> = rods.iter().flat_map(|rod| rod.ends).collect();
    let node = |anchor: &Anchor| match *anchor {
        Anchor::Node(node) => Some(attached.nodes[node as usize]),
        _ => None,
    };
    let nodes: Vec<Vec3> = anchors.iter().filter_map(node).collect();
    let first_tip = (leaflet.len() + nodes.len()) as u32;
    let mut vertices = leaflet.len() as u32..first_tip;
    let mut number = BTreeMap::new();
    let mut chords = Chords {
        laws: scene.chordae.iter().map(ChordGroup::law).collect(),
        ..Chords::default()
    };
    for &anchor in &anchors {
        number.insert(anchor, chords.points.len() as u32);
        chords.points.push(match anchor {
            Anchor::Leaflet(insertion) => attached.insertions[insertion as usize].vertices.clone(),
            Anchor::Tip(tip) => vec![(first_tip + tip, 1.0)],
            // As many vertices as nodes: each takes the next.
            Anchor::Node(_) => vertices.next().map(|vertex| (vertex, 1.0)).into_iter().collect(),
        });
    }
    for rod in &rods {
        chords.ends.push(rod.ends.map(|end| number[&end]));
        chords.rest_length_mm.push(rod.rest_length_mm);
        chords.area_mm2.push(rod.area_mm2);
        chords.group.push(rod.group);
    }
    Strung {
        chords,
        nodes,
        left_out: Vec::new(),
    }
}

/// Lengths are given to the insertion; the chord pulls at the middle of its patch, at a margin a little inward. In no
/// geometry does that take up the whole chord.
fn rod(
    scene: &Scene,
    attached: &Attached,
    segment: &Segment,
    length: &Length,
    leaflet: &[Vec3],
    tips: &[Vec3],
) -> Rod {
    let pulling = distance(segment.ends.map(|end| pull_mm(attached, leaflet, tips, end)));
    let Length {
        rest_mm, drawn_mm, ..
    } = *length;
    Rod {
        ends: segment.ends,
        group: segment.group,
        rest_length_mm: (rest_mm + (pulling - drawn_mm)).max(0.1 * rest_mm),
        area_mm2: area_mm2(scene, segment),
    }
}

/// Where a chord end pulls.
fn pull_mm(attached: &Attached, leaflet: &[Vec3], tips: &[Vec3], end: Anchor) -> Vec3 {
    match end {
        Anchor::Leaflet(insertion) => {
            let shares = &attached.insertions[insertion as usize].vertices;
            shares
                .iter()
                .map(|&(vertex, share)| leaflet[vertex as usize] * share)
                .sum()
        }
        Anchor::Tip(_) | Anchor::Node(_) => place(attached, tips, end),
    }
}

/// Where a chord end was drawn or welded to.
fn place(attached: &Attached, tips: &[Vec3], end: Anchor) -> Vec3 {
    match end {
        Anchor::Leaflet(insertion) => attached.insertions[insertion as usize].at_mm,
        Anchor::Tip(tip) => tips[tip as usize],
        Anchor::Node(node) => attached.nodes[node as usize],
    }
}

fn distance([a, b]: [Vec3; 2]) -> f64 {
    (b - a).norm()
}

/// Given, else the distance between the welded ends; times the group's factor.
fn length(scene: &Scene, attached: &Attached, segment: &Segment, tips: &[Vec3]) -> Length {
    let group = &scene.chordae[segment.group as usize];
    let given = group.mesh.as_ref().and_then(|mesh| mesh.rest_length_mm.as_ref());
    let drawn_mm = distance(segment.ends.map(|end| place(attached, tips, end)));
    let unscaled_mm = given.map_or(drawn_mm, |lengths| lengths[segment.number as usize]);
    Length {
        segment: segment.name(),
        rest_mm: unscaled_mm * group.rest_length_scale,
        drawn_mm,
    }
}

/// Given, else that of a round rod.
fn area_mm2(scene: &Scene, segment: &Segment) -> f64 {
    let group = &scene.chordae[segment.group as usize];
    let areas = group.mesh.as_ref().and_then(|mesh| mesh.area_mm2.as_ref());
    let round = std::f64::consts::FRAC_PI_4 * group.diameter_mm.powi(2);
    areas.map_or(round, |areas| areas[segment.number as usize])
}

#[cfg(test)]
mod tests {
    use super::super::Built;
    use super::super::fixtures::{COLUMNS, ROWS, built, faults, lines, skirt, skirt_point, told};
    use super::*;
    use crate::model::Model;
    use crate::scene::ChordLaw;

    fn at(model: &Model, segment: usize, end: usize) -> Vec3 {
        let chords = &model.chords;
        chords.point_mm(chords.ends[segment][end], &model.rest_mm)
    }

    #[test]
    fn chords_join_tips_nodes_and_leaflets() {
        let model = built(&skirt()).model;
        let chords = &model.chords;
        let nodes = (COLUMNS * ROWS) as u32;
        assert_eq!(chords.ends.len(), 6);
        let vertex = |end: usize| &chords.points[chords.ends[0][end] as usize][..];
        assert_eq!([vertex(0), vertex(1)], [[(nodes + 2, 1.0)], [(nodes, 1.0)]]);
        assert_eq!(at(&model, 1, 1), Vec3::from(skirt_point(11, ROWS - 1)));
        for (i, rest) in chords.rest_length_mm.iter().enumerate() {
            assert_eq!(*rest, distance([at(&model, i, 0), at(&model, i, 1)]));
        }
        // The default rod of 1 mm and 30 MPa.
        assert_eq!(chords.area_mm2[0], std::f64::consts::FRAC_PI_4);
        assert_eq!(chords.laws, [ChordLaw::Linear { modulus_mpa: 30.0 }]);
    }

    #[test]
    fn given_lengths_areas_and_factor_are_used() {
        let mut scene = skirt();
        scene.chordae[0].rest_length_scale = 1.1;
        lines(&mut scene).rest_length_mm = Some(vec![10.0; 6]);
        lines(&mut scene).area_mm2 = Some(vec![0.5; 6]);
        let model = built(&scene).model;
        assert_eq!(model.chords.rest_length_mm, [10.0 * 1.1; 6]);
        assert_eq!(model.chords.area_mm2, [0.5; 6]);
    }

    #[test]
    fn ends_are_caught_within_the_tolerance_and_drawn_points_before_them_are_not() {
        let mut scene = skirt();
        let mesh = lines(&mut scene);
        let end = Vec3::from(mesh.points_mm[2]);
        let step = (Vec3::from(mesh.points_mm[1]) - end).normalize();
        // The last point 0.3 mm short of the leaflet, the one before it 0.8 mm.
        mesh.points_mm[2] = (end + step * 0.3).into();
        mesh.points_mm.push((end + step * 0.8).into());
        mesh.segments[1] = [1, 8];
        mesh.segments.push([8, 2]);
        let model = built(&scene).model;
        // The point before is an inner one of the same rod.
        assert_eq!(model.rest_mm.len(), model.leaflet_vertex_count + 2 + 2);
        let drawn = end + step * 0.3;
        assert!((at(&model, 1, 1) - drawn).norm() <= 0.3);
    }

    #[test]
    fn a_chord_may_pass_a_leaflet_and_two_may_end_short_of_one_point() {
        let mut scene = skirt();
        let mesh = lines(&mut scene);
        let way = |a: [f64; 3], b: [f64; 3], t: f64| [0, 1, 2].map(|i| a[i] + t * (b[i] - a[i]));
        // Point 8 lies halfway along the chord to column 11, beside the margin point of column 12.
        mesh.points_mm[1] = [-12.0, -2.0, -22.0];
        mesh.points_mm.push(skirt_point(12, ROWS - 1));
        mesh.points_mm[8][2] -= 0.9;
        mesh.segments[1] = [1, 8];
        mesh.segments.push([8, 2]);
        // Both chords from the other tip end 0.3 mm below the margin point of column 0.
        mesh.points_mm[6] = skirt_point(0, ROWS - 1);
        mesh.points_mm[6][2] -= 0.3;
        mesh.points_mm
            .push(way(mesh.points_mm[5], mesh.points_mm[6], 0.5));
        mesh.points_mm[9][1] += 1.0;
        mesh.segments[5] = [5, 9];
        mesh.segments.push([9, 6]);
        let model = built(&scene).model;
        assert_eq!(at(&model, 1, 1), Vec3::from(skirt_point(11, ROWS - 1)), "passes");
        assert_eq!(at(&model, 4, 1), Vec3::from(skirt_point(0, ROWS - 1)));
        assert_eq!(at(&model, 5, 1), Vec3::from(skirt_point(0, ROWS - 1)));
    }

    /// Far more than it takes when each segment is looked at once; looked at anew for each that is left out, it was minutes.
    #[test]
    fn a_long_strand_that_reaches_nothing_is_left_out_in_the_time_of_its_length() {
        let mut scene = skirt();
        let mesh = lines(&mut scene);
        let first = mesh.points_mm.len() as u32;
        let count = 100_000;
        mesh.points_mm
            .extend((1..=count).map(|i| [-12.0 - 0.05 * f64::from(i), -2.0, -28.0]));
        mesh.segments.push([0, first]);
        mesh.segments
            .extend((first..first + count - 1).map(|point| [point, point + 1]));
        let start = std::time::Instant::now();
        let Built { model, warnings, .. } = built(&scene);
        assert!(start.elapsed().as_secs() < 10, "{:?}", start.elapsed());
        assert_eq!(model.chords.ends.len(), 6);
        assert!(told(
            &warnings,
            "segment 100005",
            "reaches neither tip nor leaflet"
        ));
        assert!(told(&warnings, "scene", "more like these"));
    }

    #[test]
    fn branches_of_different_groups_meet() {
        let mut scene = skirt();
        let mut other = scene.chordae[0].clone();
        let mesh = other.mesh.as_mut().unwrap();
        mesh.points_mm = vec![[-12.0, 0.0, -20.0], skirt_point(12, ROWS - 1)];
        mesh.segments = vec![[0, 1]];
        scene.chordae.push(other);
        let model = built(&scene).model;
        assert_eq!(model.chords.ends[6][0], model.chords.ends[0][1]);
        assert_eq!(model.chords.group[6], 1);
    }

    #[test]
    fn short_circuits_are_refused() {
        let mut scene = skirt();
        lines(&mut scene).segments.push([0, 4]);
        assert!(told(&faults(&scene), "segment 6", "two papillary tips"));
        lines(&mut scene).segments[6] = [0, 0];
        assert!(told(&faults(&scene), "segment 6", "joins point 0 to itself"));
        lines(&mut scene).points_mm.push([-12.0, -2.0, -28.005]);
        lines(&mut scene).segments[6] = [0, 8];
        assert!(told(&faults(&scene), "segment 6", "welded to the same point"));
    }

    #[test]
    fn cycles_are_refused_among_nodes_only() {
        let mut scene = skirt();
        let mesh = lines(&mut scene);
        mesh.points_mm.extend([[-10.0, 0.0, -18.0], [-14.0, 0.0, -18.0]]);
        mesh.segments.extend([[1, 8], [8, 9], [9, 1]]);
        assert!(told(&faults(&scene), "segment 8", "cycle"));
        // Branches that meet in one leaflet point are how chordae are.
        let mut scene = skirt();
        let mesh = lines(&mut scene);
        mesh.points_mm.push([-10.0, 0.0, -18.0]);
        mesh.segments.extend([[0, 8], [8, 2]]);
        assert_eq!(built(&scene).model.chords.ends.len(), 7);
    }

    #[test]
    fn duplicates_and_free_ends_are_left_out() {
        let mut scene = skirt();
        let mesh = lines(&mut scene);
        mesh.points_mm.extend([[-9.0, 0.0, -20.0], [-6.0, 0.0, -20.0]]);
        mesh.segments.extend([[1, 0], [1, 8], [8, 9]]);
        let built = built(&scene);
        assert_eq!(built.model.chords.ends.len(), 6);
        assert!(told(
            &built.warnings,
            "segment 6",
            "same points as chordae[0].mesh segment 0"
        ));
        assert!(told(
            &built.warnings,
            "segment 8",
            "reaches neither tip nor leaflet"
        ));
        assert!(told(
            &built.warnings,
            "segment 7",
            "reaches neither tip nor leaflet"
        ));
        // What is there twice is not missing.
        let left_out = LeftOut {
            group: scene.chordae[0].name.clone(),
            segments: 2,
        };
        assert_eq!(built.chordae_left_out, [left_out]);
    }

    #[test]
    fn a_chord_without_a_tip_is_refused() {
        let mut scene = skirt();
        lines(&mut scene).points_mm[0] = [-12.0, -2.0, -30.0];
        assert!(told(
            &faults(&scene),
            "segment 0",
            "no papillary tip; the nearest tip is 2.00 mm"
        ));
    }

    #[test]
    fn a_thread_between_leaflet_points_is_kept_and_told() {
        let mut scene = skirt();
        lines(&mut scene).segments.push([2, 6]);
        let built = built(&scene);
        assert_eq!(built.model.chords.ends.len(), 7);
        assert!(told(&built.warnings, "segment 6", "joins two leaflet points"));
    }

    #[test]
    fn doubtful_lengths_are_told_with_both_numbers() {
        let mut scene = skirt();
        lines(&mut scene).rest_length_mm = Some(vec![100.0, 10.0, 10.0, 10.0, 10.0, 10.0]);
        assert!(told(
            &built(&scene).warnings,
            "segment 0",
            "is 100.000 mm, its ends lie 8.246 mm"
        ));
        lines(&mut scene).rest_length_mm = Some(vec![f64::NAN, 0.0, 10.0, 10.0, 10.0, 10.0]);
        let found = faults(&scene);
        assert!(
            told(&found, "rest_length_mm segment 0", "NaN")
                && told(&found, "rest_length_mm segment 1", "is 0 mm")
        );
    }
}

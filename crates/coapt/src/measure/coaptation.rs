//! How far the leaflets lie on each other: contact area, line of closure, coaptation length.

use serde::{Deserialize, Serialize};

use super::annulus::plane_of;
use super::distance::{point_segment, triangle_area};
use super::gap::Gaps;
use super::seal::Seal;
use super::sewn::free_margins;
use super::surface::{Surface, leaflet_bit};
use crate::Vec3;
use crate::model::Model;

/// How far the leaflets lie on each other.
///
/// Tissue is in contact where its gap to another leaflet is within the contact thickness plus a tolerance (0.1 mm and
/// 2 % of the local edge length, our choice): sealed at the resolution of the mesh. Within each face the root of the gap
/// beyond the contact thickness runs linearly, as it does where round sheets part, so that areas and lines neither jump
/// from vertex to vertex nor shrink on coarse meshes. A valve given as one leaflet is measured by its
/// contact with itself. What a clip grasps and stitches hold is in contact, and counts: in a valve that is joined edge to edge, the
/// lengths at the joint, which is at A2-P2 where a surgeon put it there, are in part those of the grasp.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CoaptationMeasures {
    /// Area of contact [mm²]: half the sum over both sides.
    pub area_mm2: f64,
    /// Coaptation length (height), mean along the line of closure [mm]: from points of the line the closest straight
    /// distance to the free margin of the same leaflet (`SlicerHeart`), over all leaflets, weighted by length.
    pub length_mean_mm: f64,
    /// The same, at its largest [mm].
    pub length_max_mm: f64,
    /// The same at A2-P2 [mm]: the mean over pieces of the line near the section through the middles of the annulus,
    /// normal to the annular plane, with a weight that falls from one in the section to nothing 4 mm away from it (our
    /// choice: some two mesh edges of a valve of 650 faces, so that no single vertex decides). Zero where nothing touches
    /// there.
    pub length_a2p2_mm: f64,
    /// Length of the line of closure [mm]: the border of the contact towards the annulus, mean of its two sides
    /// (half the sum over all leaflets), smoothed over an edge length. Where the line is interrupted by a leak, the
    /// flanks of the contact count up to the margin.
    pub closure_line_mm: f64,
    /// Area over the line of closure: how deep the contact is on average [mm].
    pub contact_depth_mm: f64,
    /// Area of contact of leaflets with themselves [mm²], half the sum over both sides; not part of `area_mm2`.
    /// Zero in a valve given as one leaflet.
    pub self_contact_area_mm2: f64,
}

/// Contact of a leaflet with itself that a repair brings is worth a word from here on [mm²], our choice: of 90 rings of 24 to 40 mm on
/// the five presets at 650 faces those that add more are twelve in Barlow's valve; the most elsewhere is 22, in `flail`.
pub const FOLDS_FROM_MM2: f64 = 25.0;

/// How far from the section through the middles of the annulus the line of closure still counts as at A2-P2 [mm].
const MIDDLE_MM: f64 = 4.0;

/// Measures coaptation; all zero when nothing touches.
pub(super) fn coaptation(model: &Model, s: &Surface, gaps: &Gaps, seal: &Seal) -> CoaptationMeasures {
    let clearance = |gap: &[f64]| -> Vec<f64> {
        let open = |distance: f64| (distance - model.contact.thickness_mm).max(0.0).sqrt();
        gap.iter()
            .zip(&gaps.threshold_mm)
            .map(|(&g, &t)| open(g) - open(t))
            .collect()
    };
    let facing = clearance(&gaps.facing_mm);
    let mut m = CoaptationMeasures {
        area_mm2: contact_area(s, &facing) / 2.0,
        ..Default::default()
    };
    if s.face_leaflet.iter().any(|&l| l != s.face_leaflet[0]) {
        m.self_contact_area_mm2 = contact_area(s, &clearance(&gaps.own_mm)) / 2.0;
    }
    let (mut line_mm, mut moment) = (0.0, 0.0);
    let (mut middle_mm, mut middle_moment) = (0.0, 0.0);
    let middle = middle_section(model, s);
    for leaflet in 0..model.leaflets.len() as u32 {
        let margin = margin_segments(model, s, leaflet);
        for chain in closure_chains(s, seal, &facing, leaflet) {
            for [a, b] in chain.windows(2).map(|w| [w[0], w[1]]) {
                let (length, centre) = ((b - a).norm(), (a + b) / 2.0);
                line_mm += length;
                if let Some(depth) = nearest_segment(centre, &margin) {
                    moment += length * depth;
                    m.length_max_mm = m.length_max_mm.max(depth);
                    let away_mm =
                        middle.map_or(MIDDLE_MM, |[origin, across]| (centre - origin).dot(&across).abs());
                    let weight = length * (1.0 - away_mm / MIDDLE_MM).max(0.0);
                    middle_mm += weight;
                    middle_moment += weight * depth;
                }
            }
        }
    }
    if line_mm > 0.0 {
        m.closure_line_mm = line_mm / 2.0;
        m.length_mean_mm = moment / line_mm;
        m.contact_depth_mm = m.area_mm2 / m.closure_line_mm;
    }
    if middle_mm > 0.0 {
        m.length_a2p2_mm = middle_moment / middle_mm;
    }
    m
}

/// A point of the section through the middles of the annulus, and its normal.
fn middle_section(model: &Model, s: &Surface) -> Option<[Vec3; 2]> {
    let plane = plane_of(model, s.positions_mm)?;
    let at = |index: usize| Some(s.positions_mm[*model.annulus.get(index)? as usize]);
    let (anterior, posterior) = (
        at(model.landmarks.mid_anterior)?,
        at(model.landmarks.mid_posterior)?,
    );
    let across = (anterior - posterior).cross(&plane.normal).try_normalize(1e-9)?;
    Some([posterior, across])
}

/// Area where a field that runs linearly within faces is negative.
fn contact_area(s: &Surface, field: &[f64]) -> f64 {
    (0..s.faces.len())
        .map(|f| {
            let value = s.faces[f].map(|v| field[v as usize]);
            match value.iter().filter(|&&x| x < 0.0).count() {
                0 => 0.0,
                3 => triangle_area(s.corners(f)),
                1 => triangle_area(s.corners(f)) * corner_share(value, |x| x < 0.0),
                _ => triangle_area(s.corners(f)) * (1.0 - corner_share(value, |x| x >= 0.0)),
            }
        })
        .sum()
}

/// Share of a triangle that the zero line cuts off about the one corner that is chosen.
fn corner_share(value: [f64; 3], chosen: impl Fn(f64) -> bool) -> f64 {
    let k = value.iter().position(|&x| chosen(x)).unwrap_or(0);
    let cut = |other: usize| value[k] / (value[k] - value[other % 3]);
    cut(k + 1) * cut(k + 2)
}

/// The edges of the free margin that belong to one leaflet.
fn margin_segments(model: &Model, s: &Surface, leaflet: u32) -> Vec<[Vec3; 2]> {
    let of_leaflet = |&[a, b]: &[u32; 2]| {
        s.edge(a, b)
            .is_some_and(|e| s.edge_leaflets[e] & leaflet_bit(leaflet) != 0)
    };
    free_margins(model, s)
        .iter()
        .flat_map(|m| {
            let n = m.vertices.len();
            (0..if m.closed { n } else { n.saturating_sub(1) })
                .map(move |i| [m.vertices[i], m.vertices[(i + 1) % n]])
        })
        .filter(of_leaflet)
        .map(|ends| ends.map(|v| s.positions_mm[v as usize]))
        .collect()
}

fn nearest_segment(p: Vec3, segments: &[[Vec3; 2]]) -> Option<f64> {
    segments
        .iter()
        .map(|&segment| point_segment(p, segment))
        .min_by(f64::total_cmp)
}

/// The border of the contact towards the annulus on one leaflet, as smoothed polylines.
fn closure_chains(s: &Surface, seal: &Seal, field: &[f64], leaflet: u32) -> Vec<Vec<Vec3>> {
    let mut crossings = Vec::new();
    for f in (0..s.faces.len()).filter(|&f| s.face_leaflet[f] == leaflet) {
        let face = s.faces[f];
        let touching = face.map(|v| field[v as usize] < 0.0);
        let atrial = (0..3).any(|k| !touching[k] && seal.open[face[k] as usize]);
        let cut: Vec<u32> = (0..3)
            .filter(|&k| touching[k] != touching[(k + 1) % 3])
            .map(|k| s.face_edges[f][k])
            .collect();
        if let (true, &[a, b]) = (atrial, &cut[..]) {
            crossings.push([a, b]);
        }
    }
    let at = |edge: u32| {
        let [a, b] = s.edges[edge as usize].map(|v| v as usize);
        s.positions_mm[a].lerp(&s.positions_mm[b], field[a] / (field[a] - field[b]))
    };
    chains(&crossings)
        .into_iter()
        .map(|(chain, closed)| {
            smoothed(
                &chain.into_iter().map(at).collect::<Vec<_>>(),
                closed,
                s.mean_edge_mm,
            )
        })
        .collect()
}

/// Joins pairs of edge numbers to chains; the second part says whether the chain closes, its first number then
/// also being its last.
fn chains(pairs: &[[u32; 2]]) -> Vec<(Vec<u32>, bool)> {
    let mut ends: Vec<(u32, usize)> = pairs
        .iter()
        .enumerate()
        .flat_map(|(i, p)| p.map(|e| (e, i)))
        .collect();
    ends.sort_unstable();
    let at = |e: u32| {
        let first = ends.partition_point(|x| x.0 < e);
        &ends[first..first + ends[first..].partition_point(|x| x.0 == e)]
    };
    let mut used = vec![false; pairs.len()];
    // Ends of open chains first, then what is left closes on itself.
    let tips = ends.iter().filter(|x| at(x.0).len() == 1);
    let mut found = Vec::new();
    for &(start, segment) in tips.chain(&ends) {
        if used[segment] {
            continue;
        }
        let mut chain = vec![start];
        let mut next = Some(segment);
        while let Some(i) = next {
            used[i] = true;
            let here = chain[chain.len() - 1];
            let there = if pairs[i][0] == here {
                pairs[i][1]
            } else {
                pairs[i][0]
            };
            chain.push(there);
            next = at(there).iter().map(|x| x.1).find(|&i| !used[i]);
        }
        let closed = chain.len() > 3 && chain[0] == chain[chain.len() - 1];
        found.push((chain, closed));
    }
    found
}

/// Each point becomes the mean of the line within `reach` of it: a line drawn from vertex to vertex of an irregular
/// mesh is longer than the line it stands for. Ends stay, straight lines keep their length.
fn smoothed(line: &[Vec3], closed: bool, reach: f64) -> Vec<Vec3> {
    let mut along = vec![0.0; line.len()];
    for i in 1..line.len() {
        along[i] = along[i - 1] + (line[i] - line[i - 1]).norm();
    }
    let total = along.last().copied().unwrap_or(0.0);
    (0..line.len())
        .map(|i| {
            let room = if closed {
                total / 2.0
            } else {
                along[i].min(total - along[i])
            };
            let reach = reach.min(room);
            if reach > 0.0 {
                mean_between(line, &along, closed, along[i] - reach, along[i] + reach)
            } else {
                line[i]
            }
        })
        .collect()
}

/// Mean position of the piece of a polyline between two arc lengths.
fn mean_between(line: &[Vec3], along: &[f64], closed: bool, from: f64, to: f64) -> Vec3 {
    let total = along[along.len() - 1];
    let turns: &[f64] = if closed { &[-1.0, 0.0, 1.0] } else { &[0.0] };
    let mut sum = Vec3::zeros();
    for turn in turns {
        let (from, to) = (from - turn * total, to - turn * total);
        let first = along.partition_point(|&l| l <= from).max(1);
        for i in (first..line.len()).take_while(|&i| along[i - 1] < to) {
            let length = along[i] - along[i - 1];
            let (a, b) = (from.max(along[i - 1]), to.min(along[i]));
            if length > 0.0 && b > a {
                let middle = ((a + b) / 2.0 - along[i - 1]) / length;
                sum += line[i - 1].lerp(&line[i], middle) * (b - a);
            }
        }
    }
    sum / (to - from)
}

#[cfg(test)]
mod tests {
    use super::super::test_models::{flared_strips, sloping_strips, two_strips};
    use super::super::{gap, seal, surface};
    use super::*;

    fn measured(model: &Model) -> CoaptationMeasures {
        let s = surface::surface(model, &model.rest_mm);
        let gaps = gap::gaps(model, &s);
        coaptation(model, &s, &gaps, &seal::seal(model, &s, &gaps))
    }

    /// Two strips of 20 × 5 mm all in contact: the area is that of one strip, and there is no border. Apart, none.
    #[test]
    fn parallel_strips() {
        let m = measured(&two_strips(20, 8, 0.4));
        assert!((m.area_mm2 - 100.0).abs() < 1e-9, "{m:?}");
        assert_eq!(m.closure_line_mm, 0.0);
        assert_eq!(m.self_contact_area_mm2, 0.0);
        assert_eq!(measured(&two_strips(20, 8, 1.0)).area_mm2, 0.0);
    }

    /// Strips 20 mm wide that lie on each other over 5 mm and part above it at 45° each: the line is 20 mm long, but
    /// for the ends, where edges and so the threshold differ a little. Above the bend the gap √((0.4 + z)² + z²) opens
    /// to the threshold 0.6 + 0.02 h at z = 0.18 mm, which the coaptation length contains, and times the width and √2
    /// the area: 105.0 mm². Parting at a sharp corner is the worst case for a rule made for round sheets: the line comes
    /// out too high by up to a fifth of an edge.
    #[test]
    fn strips_that_part() {
        for n in [5, 10, 20] {
            let m = measured(&flared_strips(4 * n, n, 5.0));
            assert!((m.closure_line_mm - 20.0).abs() < 1e-4, "{m:?}");
            let edge_mm = 5.0 / f64::from(n as u32);
            assert!((m.length_mean_mm - 5.18).abs() < 0.2 * edge_mm, "{m:?}");
            assert!((m.length_max_mm - m.length_mean_mm).abs() < 2e-3, "{m:?}");
            assert!((m.area_mm2 - 105.0).abs() < 20.0 * 0.25 * edge_mm, "{m:?}");
            assert!((m.contact_depth_mm - m.area_mm2 / 20.0).abs() < 1e-4);
        }
    }

    /// Strips that lie on each other the deeper the farther along their width: 3 mm at its beginning, 7 mm at its end. At the
    /// section that the middles of the annulus mark, 5 mm from the beginning and then 5 mm from the end, it is 4 and 6 mm,
    /// and 0.18 mm more as above; less a hundredth or two, as the nearest point of the sloping margin is not straight below.
    #[test]
    fn at_a2p2_is_where_the_annulus_says() {
        let columns = 80;
        let mut model = sloping_strips(columns, 20, |x| 3.0 + 4.0 * x);
        for (column, expected_mm) in [(20, 4.18), (60, 6.18)] {
            model.landmarks.mid_anterior = column;
            model.landmarks.mid_posterior = 2 * (columns + 1) - 1 - column;
            let m = measured(&model);
            let slope = 1.0 / f64::hypot(1.0, 4.0 / 20.0);
            assert!((m.length_a2p2_mm - expected_mm * slope).abs() < 0.05, "{m:?}");
        }
    }

    /// A field x - 0.3 on a unit square is negative on 0.3 of it, however the square is cut into triangles.
    #[test]
    fn area_is_cut_within_faces() {
        let model = super::super::test_models::sheet(3, 1.0, 1);
        let s = surface::surface(&model, &model.rest_mm);
        let field: Vec<f64> = model.rest_mm.iter().map(|p| p.x - 0.3).collect();
        assert!((contact_area(&s, &field) - 0.3).abs() < 1e-12);
    }

    /// A saw-tooth of ±0.25 about a line 20 mm long, teeth 1 mm apart, is 22.4 mm long; smoothed over 1 mm each way
    /// it is within 2 % of 20. A straight line is kept exactly. A circle loses (reach/r)²/6 of its length, and the polygon
    /// of 100 points (2π/100)²/12 more.
    #[test]
    fn smoothing_takes_the_teeth() {
        let length = |l: &[Vec3]| l.windows(2).map(|w| (w[1] - w[0]).norm()).sum::<f64>();
        let saw: Vec<Vec3> = (0..=20)
            .map(|i| Vec3::new(f64::from(i), if i % 2 == 0 { 0.25 } else { -0.25 }, 0.0))
            .collect();
        assert!(length(&saw) > 22.3);
        assert!((length(&smoothed(&saw, false, 1.0)) - 20.0).abs() < 0.4);
        let straight: Vec<Vec3> = (0..=20).map(|i| Vec3::x() * f64::from(i * i)).collect();
        assert!((length(&smoothed(&straight, false, 1.0)) - 400.0).abs() < 1e-9);
        let angle = |i: i32| std::f64::consts::TAU * f64::from(i % 100) / 100.0;
        let circle: Vec<Vec3> = (0..=100)
            .map(|i| Vec3::new(angle(i).cos(), angle(i).sin(), 0.0) * 10.0)
            .collect();
        let ratio = length(&smoothed(&circle, true, 1.0)) / length(&circle);
        assert!((ratio - (1.0 - 0.01 / 6.0 - 3.3e-4)).abs() < 2e-5, "{ratio}");
    }

    /// Chains come out whole whatever the order of their pieces.
    #[test]
    fn pieces_join_to_chains() {
        let open = chains(&[[3, 4], [1, 2], [3, 2]]);
        assert_eq!(open, [(vec![1, 2, 3, 4], false)]);
        let mixed = chains(&[[7, 5], [5, 6], [6, 7], [1, 2]]);
        assert_eq!(mixed[0], (vec![1, 2], false));
        assert!(mixed[1].1 && mixed[1].0.len() == 4);
    }
}

//! What is left open: the anatomic regurgitant orifice at the free margin.

use serde::{Deserialize, Serialize};

use super::distance::point_segment;
use super::gap::{GAP_CAP_MM, Gaps, threshold_mm};
use super::seal::Seal;
use super::sewn::free_margins;
use super::spanning::spanning_area;
use super::surface::Surface;
use crate::Vec3;
use crate::model::{Margin, Model};

/// What is left open.
///
/// A stretch of free margin is open when nothing touches on its way up to the annulus. Open stretches that face each
/// other bound a hole, and so does a commissure's one stretch, a perforation's rim, or the whole margin of a valve
/// that does not close at all. Holes narrower than contact at the resolution of the mesh are none. Distances are
/// between mid-surfaces: the thickness of the tissue is not taken off.
///
/// Where an open margin has no open margin across from it, or one that is much farther than the leaflet it belongs to
/// (an everted flap), margins do not bound the hole: there it is half of each side's strip between the open margin
/// and the nearest tissue of another leaflet. Edges of one leaflet that stitches hold in contact are no margin.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OrificeMeasures {
    /// Anatomic regurgitant orifice area [mm²]: sum over the holes of the smallest triangulated surface that spans
    /// the hole's rim.
    pub area_mm2: f64,
    /// The narrowest passage [mm²], see `passage_mm2`, found without regard to margins. Absent where it was not asked for or leaflets do
    /// not hang from the annulus all round.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub passage_mm2: Option<f64>,
    /// Number of holes.
    pub count: usize,
    /// How wide the widest hole gapes [mm], which says nothing of how long it is: the farthest that its open margin is from the
    /// tissue of another leaflet, on the side of the hole where that is less. So a margin that hangs free below a seal, or one open
    /// farther along a slit than the one across, widens nothing. Never more than the farthest that its margins are apart, which alone
    /// counts of a perforation and where nothing is within 10 mm.
    pub max_gap_mm: f64,
}

/// A hole must gape by this much of an edge length more than contact to count (our choice): a vertex that just fails
/// to touch says less of the valve than of the mesh.
const RESOLUTION_EDGES: f64 = 0.05;

/// An open margin with none across counts when it gapes by this many edge lengths more than contact (our choice): the
/// way up to the annulus that decides what is open follows edges, and may miss contact by one.
const ONE_SIDED_EDGES: f64 = 1.0;

/// Margins bound a hole together when the leaflets are at least this part of the margins' distance apart [1]. In a
/// slit the two are the same; a flap folded back has its margin about twice as far away as its belly.
const FACING_PART: f64 = 0.65;

/// From this part on they bound a slit [1], and nothing but the surface between them counts. In between, the surface between several
/// margins counts up to a multiple of the half strips that grows from one: else a flap folded back by a tenth of a millimetre more
/// has half the orifice. Our choice; at 650 faces the presets measure the same with it and without.
const SLIT_PART: f64 = 0.9;

/// An open stretch of margin.
struct Stretch {
    points: Vec<Vec3>,
    /// Distance of each point to the nearest other leaflet [mm].
    facing_mm: Vec<f64>,
    /// Leaflets at each point, one bit each.
    leaflets: Vec<u64>,
    /// A whole margin, which closes on itself.
    closed: bool,
}

/// Finds and measures the holes.
pub(super) fn orifice(model: &Model, s: &Surface, gaps: &Gaps, seal: &Seal) -> OrificeMeasures {
    let mut m = OrificeMeasures::default();
    let stretches: Vec<Stretch> = free_margins(model, s)
        .iter()
        .flat_map(|margin| open_stretches(s, gaps, seal, &oriented(s, margin)))
        .collect();
    let contact = threshold_mm(model, s.mean_edge_mm);
    let least = contact + RESOLUTION_EDGES * s.mean_edge_mm;
    for hole in holes(&stretches) {
        let rim: Vec<&Stretch> = hole.iter().map(|&i| &stretches[i]).collect();
        let gap = widest(&rim);
        let facing = rim.iter().flat_map(|r| &r.facing_mm).copied().fold(0.0, f64::max);
        let half_strips_mm2 = rim.iter().map(|r| 0.5 * strip_area_mm2(r)).sum::<f64>();
        if is_one_sided(&rim) || (rim.len() > 1 && facing < FACING_PART * gap) {
            let lonely = rim
                .iter()
                .all(|one| !stretches.iter().any(|other| lies_across(one, other, facing)));
            if facing
                > if lonely {
                    contact + ONE_SIDED_EDGES * s.mean_edge_mm
                } else {
                    least
                }
            {
                m.area_mm2 += half_strips_mm2;
                m.count += 1;
                m.max_gap_mm = m.max_gap_mm.max(width(&rim, facing));
            }
        } else if gap > least {
            let polygon: Vec<Vec3> = rim.iter().flat_map(|r| r.points.iter().copied()).collect();
            let most_mm2 = match rim.len() {
                1 => f64::INFINITY,
                _ => half_strips_mm2 * most_of_strips(facing / gap),
            };
            m.area_mm2 += spanning_area(&polygon).min(most_mm2);
            m.count += 1;
            m.max_gap_mm = m.max_gap_mm.max(width(&rim, gap));
        }
    }
    m
}

/// How many times the half strips the surface between margins may be that are so much farther apart than the leaflets
/// (`part` of the margins' distance) [1]: once at [`FACING_PART`], where half strips take over, and any number of times in a slit.
fn most_of_strips(part: f64) -> f64 {
    1.0 / (1.0 - (part - FACING_PART) / (SLIT_PART - FACING_PART)).max(0.0)
}

/// A single stretch along one leaflet: nothing open lies across from it.
fn is_one_sided(rim: &[&Stretch]) -> bool {
    match rim {
        [only] => !only.closed && only.leaflets.iter().fold(u64::MAX, |all, at| all & at) != 0,
        _ => false,
    }
}

/// Whether an open margin of another leaflet lies about as near as the tissue that an open margin faces.
fn lies_across(one: &Stretch, other: &Stretch, facing_mm: f64) -> bool {
    let leaflets = |stretch: &Stretch| stretch.leaflets.iter().fold(u64::MAX, |all, at| all & at);
    let near = |a: &Vec3| {
        other
            .points
            .iter()
            .any(|b| (a - b).norm() <= facing_mm / FACING_PART)
    };
    leaflets(one) & leaflets(other) == 0 && one.points.iter().any(near)
}

/// Area between an open margin and the nearest tissue of another leaflet, by the trapezoidal rule [mm²].
fn strip_area_mm2(stretch: &Stretch) -> f64 {
    let sides = stretch.points.windows(2).zip(stretch.facing_mm.windows(2));
    sides
        .map(|(points, gaps)| (points[1] - points[0]).norm() * 0.5 * (gaps[0] + gaps[1]))
        .sum()
}

/// The margin in the sense in which its faces run along it, so that opposite stretches run against each other.
fn oriented(s: &Surface, margin: &Margin) -> Margin {
    let along = margin
        .vertices
        .windows(2)
        .find_map(|w| s.edge(w[0], w[1]).map(|e| s.edge_forward[e] == (w[0] < w[1])));
    let mut margin = margin.clone();
    if along == Some(false) {
        margin.vertices.reverse();
    }
    margin
}

fn open_stretches(s: &Surface, gaps: &Gaps, seal: &Seal, margin: &Margin) -> Vec<Stretch> {
    let n = margin.vertices.len();
    let vertex = |i: usize| margin.vertices[i % n] as usize;
    let open = |i: usize| seal.open[vertex(i)];
    let Some(sealed) = (0..n).find(|&i| !open(i)) else {
        return if n > 1 {
            vec![stretch(s, gaps, (0..n).map(vertex), margin.closed)]
        } else {
            vec![]
        };
    };
    // A closed margin is walked from a sealed vertex once around; an open one from its start.
    let (from, to) = if margin.closed {
        (sealed, sealed + n)
    } else {
        (0, n)
    };
    let mut found = Vec::new();
    let mut i = from;
    while i < to {
        let end = (i..to).find(|&j| !open(j)).unwrap_or(to);
        if end > i {
            let mut run = stretch(s, gaps, (i..end).map(vertex), false);
            if i > from || margin.closed {
                run.extend(s, seal, vertex(i), vertex(i + n - 1), true);
            }
            if end < to || margin.closed {
                run.extend(s, seal, vertex(end - 1), vertex(end), false);
            }
            found.push(run);
        }
        i = end + 1;
    }
    found
}

fn stretch(s: &Surface, gaps: &Gaps, vertices: impl Iterator<Item = usize>, closed: bool) -> Stretch {
    let vertices: Vec<usize> = vertices.collect();
    let (points, leaflets) = vertices
        .iter()
        .map(|&v| (s.positions_mm[v], s.vertex_leaflets[v]))
        .unzip();
    Stretch {
        points,
        facing_mm: vertices.iter().map(|&v| gaps.facing_mm[v]).collect(),
        leaflets,
        closed,
    }
}

impl Stretch {
    /// Goes on from the last open vertex to where the clearance vanishes on the way to the sealed one; half-way when
    /// that one is sealed by something above it.
    fn extend(&mut self, s: &Surface, seal: &Seal, open: usize, sealed: usize, at_start: bool) {
        let (a, b) = (seal.clearance_mm[open], seal.clearance_mm[sealed]);
        let t = if b < 0.0 && a >= 0.0 { a / (a - b) } else { 0.5 };
        let place = if at_start { 0 } else { self.points.len() };
        self.points
            .insert(place, s.positions_mm[open].lerp(&s.positions_mm[sealed], t));
        // There it meets the seal.
        self.facing_mm.insert(place, 0.0);
        self.leaflets
            .insert(place, s.vertex_leaflets[open] & s.vertex_leaflets[sealed]);
    }
}

/// Groups stretches to holes: the end of each is joined to the nearest start, nearest pairs first.
fn holes(stretches: &[Stretch]) -> Vec<Vec<usize>> {
    let parts: Vec<usize> = (0..stretches.len()).filter(|&i| !stretches[i].closed).collect();
    let mut pairs = Vec::new();
    for &i in &parts {
        for &j in &parts {
            let end = stretches[i].points[stretches[i].points.len() - 1];
            pairs.push(((end - stretches[j].points[0]).norm(), i, j));
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut next: Vec<Option<usize>> = stretches
        .iter()
        .enumerate()
        .map(|(i, r)| r.closed.then_some(i))
        .collect();
    let mut taken = vec![false; stretches.len()];
    for (_, i, j) in pairs {
        if next[i].is_none() && !taken[j] {
            next[i] = Some(j);
            taken[j] = true;
        }
    }
    let mut seen = vec![false; stretches.len()];
    let mut found = Vec::new();
    for start in 0..stretches.len() {
        let mut hole = Vec::new();
        let mut at = start;
        while !std::mem::replace(&mut seen[at], true) {
            hole.push(at);
            at = next[at].unwrap_or(at);
        }
        if !hole.is_empty() {
            found.push(hole);
        }
    }
    found
}

/// How wide a hole gapes [mm], at most so much: see [`OrificeMeasures::max_gap_mm`].
fn width(rim: &[&Stretch], most_mm: f64) -> f64 {
    let points = || {
        let of = |r: &&Stretch| {
            r.leaflets
                .iter()
                .copied()
                .zip(r.facing_mm.iter().copied())
                .collect::<Vec<_>>()
        };
        rim.iter().flat_map(of)
    };
    // Where leaflets join, a point is of both and parts none.
    let alone = points().filter(|(leaflets, _)| leaflets.count_ones() == 1);
    let sides = alone.fold(0, |sides, (leaflet, _)| sides | leaflet);
    let farthest_mm = |of: u64| {
        points()
            .filter(|(leaflets, _)| leaflets & of != 0)
            .map(|(_, mm)| mm)
            .fold(0.0, f64::max)
    };
    let bits = (0..u64::BITS).map(|bit| 1 << bit).filter(|bit| sides & bit != 0);
    let widths_mm = bits.map(farthest_mm).filter(|mm| (0.0..GAP_CAP_MM).contains(mm));
    match rim {
        // A perforation: what lies across from it is its own leaflet.
        [only] if only.closed => most_mm,
        _ => widths_mm.fold(most_mm, f64::min),
    }
}

/// The farthest that the sides of a hole are apart: leaflets, else stretches, else the sides of its rim.
fn widest(rim: &[&Stretch]) -> f64 {
    let by_leaflet: Vec<(Vec<Vec3>, Vec<u64>)> =
        rim.iter().map(|r| (closed_points(r), closed_labels(r))).collect();
    let by_stretch: Vec<(Vec<Vec3>, Vec<u64>)> = rim
        .iter()
        .enumerate()
        .map(|(k, r)| (closed_points(r), vec![1 << (k % 64); closed_points(r).len()]))
        .collect();
    let polygon: Vec<Vec3> = rim.iter().flat_map(|r| r.points.iter().copied()).collect();
    across(&by_leaflet)
        .or_else(|| across(&by_stretch))
        .or_else(|| across(&[sides(&polygon)]))
        .unwrap_or(0.0)
}

fn closed_points(r: &Stretch) -> Vec<Vec3> {
    r.points
        .iter()
        .chain(r.points.first().filter(|_| r.closed))
        .copied()
        .collect()
}

fn closed_labels(r: &Stretch) -> Vec<u64> {
    r.leaflets
        .iter()
        .chain(r.leaflets.first().filter(|_| r.closed))
        .copied()
        .collect()
}

/// Parts a rim at its two points farthest from each other.
fn sides(polygon: &[Vec3]) -> (Vec<Vec3>, Vec<u64>) {
    let n = polygon.len();
    let far = |i: usize| {
        (0..n)
            .map(|j| ((polygon[i] - polygon[j]).norm(), j))
            .fold((0.0, i), |a, b| if b.0 > a.0 { b } else { a })
    };
    let (_, a, b) = (0..n).map(|i| (far(i), i)).fold(
        (0.0, 0, 0),
        |best, ((d, j), i)| if d > best.0 { (d, i, j) } else { best },
    );
    let around: Vec<usize> = (0..=n).map(|k| (a + k) % n.max(1)).collect();
    let points = around
        .iter()
        .map(|&i| polygon.get(i).copied().unwrap_or_default())
        .collect();
    let turn = (b + n - a) % n.max(1);
    let label = |k: usize| {
        if k == 0 || k == n || k == turn {
            3
        } else if k < turn {
            1
        } else {
            2
        }
    };
    (points, (0..=n).map(label).collect())
}

/// The largest, over labelled points, of the distance to the nearest segment with no label in common.
fn across(lines: &[(Vec<Vec3>, Vec<u64>)]) -> Option<f64> {
    let segments: Vec<([Vec3; 2], u64)> = lines
        .iter()
        .flat_map(|(points, labels)| {
            (1..points.len()).map(move |i| ([points[i - 1], points[i]], labels[i - 1] & labels[i]))
        })
        .filter(|(_, label)| *label != 0)
        .collect();
    let nearest = |p: Vec3, label: u64| {
        let others = segments.iter().filter(|(_, other)| other & label == 0);
        others
            .map(|&(segment, _)| point_segment(p, segment))
            .min_by(f64::total_cmp)
    };
    let points = lines
        .iter()
        .flat_map(|(points, labels)| points.iter().zip(labels));
    points
        .filter(|(_, label)| **label != 0)
        .filter_map(|(&p, &label)| nearest(p, label))
        .max_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use super::super::test_models::{commissure_valve, grid_model, lens_state, tube};
    use super::super::{gap, seal, surface};
    use super::*;
    use std::f64::consts::{PI, TAU};

    fn measured(model: &Model, positions: &[Vec3]) -> OrificeMeasures {
        let s = surface::surface(model, positions);
        let gaps = gap::gaps(model, &s);
        orifice(model, &s, &gaps, &seal::seal(model, &s, &gaps))
    }

    fn regular_area(n: usize, r: f64) -> f64 {
        0.5 * n as f64 * r * r * (TAU / n as f64).sin()
    }

    /// A tube of one leaflet: its rim is a regular polygon, whose area is exact. It gapes by √2 r: from the middle of
    /// one side to the ends of the other. A rim of more points than are kept loses of the circle what a regular
    /// polygon of 120 points loses: 5e-4 of π r².
    #[test]
    fn an_open_tube() {
        let model = tube(64, 4, 12.0);
        let m = measured(&model, &model.rest_mm);
        assert!((m.area_mm2 - regular_area(64, 12.0)).abs() < 1e-9, "{m:?}");
        assert_eq!(m.count, 1);
        assert!((m.max_gap_mm - 12.0 * 2f64.sqrt()).abs() < 1e-9, "{m:?}");
        let fine = tube(400, 4, 12.0);
        assert!((measured(&fine, &fine.rest_mm).area_mm2 / (PI * 144.0) - 1.0).abs() < 5e-4);
    }

    /// A valve of two leaflets that does not close at all: the whole margin is one hole.
    #[test]
    fn a_wide_open_valve() {
        let model = commissure_valve(16, 4);
        let m = measured(&model, &model.rest_mm);
        assert!((m.area_mm2 - regular_area(32, 12.0)).abs() < 1e-9, "{m:?}");
        assert_eq!(m.count, 1);
    }

    /// Leaflets on each other along the whole line leave nothing open.
    #[test]
    fn a_closed_valve() {
        for n in [8, 24, 64] {
            let model = commissure_valve(n, n / 2);
            assert_eq!(
                measured(&model, &lens_state(&model, &[])),
                OrificeMeasures::default(),
                "{n}"
            );
        }
    }

    /// A slit between two parabolas y = ±(0.2 + b (1 - (x/a)²)): the hole reaches to where the opening falls to the
    /// threshold, and its area is the integral of the opening up to there. The mesh cuts the parabolas by chords and
    /// the ends by an edge; both shrink with its size.
    #[test]
    fn a_slit_of_known_area() {
        for (a, b) in [(6.0, 2.0), (8.0, 1.0)] {
            let error = |n: usize| {
                let model = commissure_valve(n, 8);
                let m = measured(&model, &lens_state(&model, &[(0.0, a, b)]));
                assert_eq!(m.count, 1);
                let end = a * (1.0 - 0.1 / b).sqrt();
                let exact = 2.0 * (0.4 * end + 2.0 * b * (end - end.powi(3) / (3.0 * a * a)));
                // Its middle stands 0.4 + 2b apart.
                assert!((m.max_gap_mm / (0.4 + 2.0 * b) - 1.0).abs() < 0.05, "{m:?}");
                (m.area_mm2 / exact - 1.0).abs()
            };
            let (coarse, fine, finest) = (error(24), error(48), error(96));
            assert!(
                coarse < 0.08 && fine < 0.03 && finest < 0.012,
                "{coarse} {fine} {finest}"
            );
        }
    }

    /// Two slits are two holes with the sum of their areas; the tolerance is that of one slit at this mesh.
    #[test]
    fn two_slits() {
        let model = commissure_valve(64, 8);
        let one = measured(&model, &lens_state(&model, &[(-5.0, 3.0, 2.0)]));
        let two = measured(&model, &lens_state(&model, &[(-5.0, 3.0, 2.0), (5.0, 3.0, 2.0)]));
        assert_eq!((one.count, two.count), (1, 2));
        assert!(
            (two.area_mm2 / one.area_mm2 - 2.0).abs() < 0.05,
            "{one:?} {two:?}"
        );
    }

    /// A leak at a commissure is one stretch from one leaflet over the seam to the other. Half a slit: the
    /// opening up to the seam, which closes it with two straight edges of the mesh; 5 % at this mesh.
    #[test]
    fn a_leak_at_the_commissure() {
        let model = commissure_valve(64, 8);
        let (a, b) = (6.0, 2.0);
        let m = measured(&model, &lens_state(&model, &[(12.0, a, b)]));
        let end = a * (1.0f64 - 0.1 / b).sqrt();
        let exact = 0.4 * end + 2.0 * b * (end - end.powi(3) / (3.0 * a * a));
        assert_eq!(m.count, 1);
        assert!((m.area_mm2 / exact - 1.0).abs() < 0.05, "{m:?} {exact}");
    }

    /// A slit half a millimetre wide whose two sides are open over lengths of one and ten millimetres: the end of the longer is nine from
    /// the shorter, and the hole is half a millimetre wide. So it is where the longer margin hangs free, nine millimetres below the
    /// seal; but not where nothing is near either side, nor in a perforation.
    #[test]
    fn a_slit_is_as_wide_as_its_narrower_side() {
        let side = |leaflet: u64, y: f64, length_mm: u32, facing_mm: f64| Stretch {
            points: (0..=length_mm).map(|x| Vec3::new(f64::from(x), y, 0.0)).collect(),
            facing_mm: vec![facing_mm; length_mm as usize + 1],
            leaflets: vec![leaflet; length_mm as usize + 1],
            closed: false,
        };
        let (short, long) = (side(1, 0.0, 1, 0.5), side(2, 0.5, 10, 0.5));
        let rim = [&short, &long];
        assert!((widest(&rim) - 9.0).abs() < 0.1, "{}", widest(&rim));
        assert_eq!(width(&rim, widest(&rim)), 0.5);
        let hanging = side(2, 0.5, 10, 9.0);
        assert_eq!(width(&[&short, &hanging], 9.0), 0.5);
        let far = [side(1, 0.0, 1, GAP_CAP_MM), side(2, 24.0, 1, GAP_CAP_MM)];
        assert_eq!(width(&[&far[0], &far[1]], 24.0), 24.0);
        let mut around = side(1, 0.0, 4, 0.1);
        around.closed = true;
        assert_eq!(width(&[&around], 2.0), 2.0);
    }

    /// A strip whose width grows along the margin.
    #[test]
    fn strips_follow_the_trapezoidal_rule() {
        let stretch = Stretch {
            points: (0..=10).map(|k| Vec3::new(f64::from(k), 0.0, 0.0)).collect(),
            facing_mm: (0..=10).map(|k| 0.2 * f64::from(k)).collect(),
            leaflets: vec![1; 11],
            closed: false,
        };
        // A linear width is integrated exactly: 10 · (0 + 2)/2.
        assert!((strip_area_mm2(&stretch) - 10.0).abs() < 1e-12);
        assert!(is_one_sided(&[&stretch]));
    }

    /// A square hole of 2 mm in a leaflet of 6 mm hung from its whole border: 4 mm², exactly, and 2 mm wide.
    #[test]
    fn a_perforation() {
        let mut model = grid_model(7, 7, 6.0, 6.0);
        let inside = |v: u32| (2..=4).contains(&(v / 7)) && (2..=4).contains(&(v % 7));
        model.faces.retain(|face| !face.iter().all(|&v| inside(v)));
        model.face_leaflet.truncate(model.faces.len());
        model.annulus = (0..49)
            .filter(|v| v / 7 == 0 || v / 7 == 6 || v % 7 == 0 || v % 7 == 6)
            .collect();
        model.margins = vec![Margin {
            vertices: vec![16, 17, 18, 25, 32, 31, 30, 23],
            closed: true,
        }];
        let m = measured(&model, &model.rest_mm);
        assert_eq!(m.count, 1);
        assert!(
            (m.area_mm2 - 4.0).abs() < 1e-12 && (m.max_gap_mm - 2.0).abs() < 1e-12,
            "{m:?}"
        );
    }
}

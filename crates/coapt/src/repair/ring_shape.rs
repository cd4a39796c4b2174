//! Ring curves: parametric families by size, and curves that somebody measured.
//!
//! The families are generic shapes with published proportions, not any maker's geometry.

use std::f64::consts::TAU;

use crate::Vec3;
use crate::mesh::landmarks::TRIGONE_HALF_ANGLE;
use crate::mesh::polyline;
use crate::scene::{Fault, Ring, RingFamily};

/// Sizes that are made, and two more at either end [mm]: rings come in 24 to 40.
pub const SIZES_MM: std::ops::RangeInclusive<f64> = 20.0..=44.0;

/// Points on a family's closed outline: 0.25 mm apart on a large ring, far below any mesh edge.
const SAMPLES: usize = 480;

/// Share of the anteroposterior diameter that lies anterior to the widest line; 0.40-0.45 gives the D shape.
const ANTERIOR_SHARE: f64 = 0.40;

/// Share of the outline that a posterior band covers: 60-70 % are usual, this is the middle.
const BAND_SHARE: f64 = 0.65;

/// A ring with the places that belong to the annulus' landmarks. It runs counter-clockwise seen from the atrium.
#[derive(Clone, Debug, PartialEq)]
pub struct RingCurve {
    /// Points [mm], shape `[point]`; of an open ring, from the end next after the anterior middle on.
    pub points_mm: Vec<Vec3>,
    /// Whether the last point joins the first.
    pub closed: bool,
    /// Landmarks; those of an open ring may lie off it, in the gap.
    pub marks: RingMarks,
}

/// Places on a ring, or in its gap, that belong to landmarks of the annulus [mm].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RingMarks {
    /// Middle of the anterior annulus.
    pub mid_anterior: Vec3,
    /// Trigones: the one counter-clockwise of the anterior middle (the left one in a human heart), then the other.
    pub trigones: [Vec3; 2],
    /// Middle of the posterior annulus.
    pub mid_posterior: Vec3,
}

impl RingCurve {
    /// Applies a motion to points and landmarks.
    pub fn moved(&self, motion: impl Fn(Vec3) -> Vec3) -> Self {
        Self {
            points_mm: self.points_mm.iter().map(|&p| motion(p)).collect(),
            closed: self.closed,
            marks: RingMarks {
                mid_anterior: motion(self.marks.mid_anterior),
                trigones: self.marks.trigones.map(&motion),
                mid_posterior: motion(self.marks.mid_posterior),
            },
        }
    }
}

/// Proportions of a family, all over the size (inner transverse diameter).
struct Proportions {
    anteroposterior: f64,
    anterior_height: f64,
    posterior_height: f64,
}

fn proportions(family: RingFamily) -> Proportions {
    let (anteroposterior, anterior_height, posterior_height) = match family {
        // 3 : 4, planar.
        RingFamily::ClassicLike | RingFamily::PosteriorBand => (0.75, 0.0, 0.0),
        // Mild anterior saddle of 5-10 %; a posterior horn of a fifth of it, as the natural annulus has (our choice).
        RingFamily::PhysioLike => (0.75, 0.075, 0.015),
        // Heights above the commissures that put the highest and lowest points 20 % of the width apart across the
        // best-fit plane (annular height to commissural width ratio 0.20); the posterior horn 0.3 of the anterior.
        RingFamily::Saddle => (0.75, 0.262, 0.0786),
        // Remodelling rings have 0.76 to 0.91 of the usual anteroposterior diameter (Bothe 2010, outer
        // dimensions); 0.84 is the middle.
        RingFamily::ReducedAp => (0.75 * 0.84, 0.075, 0.015),
    };
    Proportions {
        anteroposterior,
        anterior_height,
        posterior_height,
    }
}

/// Posterior over anterior height where a planar family is given a height [1]: as in [`RingFamily::Saddle`].
const POSTERIOR_PART: f64 = 0.3;

/// A family's curve: x across, y anterior, z to the atrium, origin midway between the widest points.
pub fn family_curve(family: RingFamily, size_mm: f64) -> RingCurve {
    shaped_curve(family, size_mm, None, None)
}

/// The same with another anteroposterior diameter, or another height of its anterior middle above the widest line [mm].
pub fn shaped_curve(
    family: RingFamily,
    size_mm: f64,
    ap_mm: Option<f64>,
    saddle_height_mm: Option<f64>,
) -> RingCurve {
    let mut shape = proportions(family);
    if let Some(ap_mm) = ap_mm {
        shape.anteroposterior = ap_mm / size_mm;
    }
    if let Some(height_mm) = saddle_height_mm {
        let posterior_part = match shape.anterior_height > 0.0 {
            true => shape.posterior_height / shape.anterior_height,
            false => POSTERIOR_PART,
        };
        shape.anterior_height = height_mm / size_mm;
        shape.posterior_height = posterior_part * shape.anterior_height;
    }
    let point = |i: usize| {
        // The first point is the anterior middle.
        let (sin, cos) = (TAU * (0.25 + i as f64 / SAMPLES as f64)).sin_cos();
        let (depth, height) = match sin >= 0.0 {
            true => (ANTERIOR_SHARE, shape.anterior_height),
            false => (1.0 - ANTERIOR_SHARE, shape.posterior_height),
        };
        Vec3::new(0.5 * cos, depth * shape.anteroposterior * sin, height * sin * sin) * size_mm
    };
    let outline: Vec<Vec3> = (0..SAMPLES).map(point).collect();
    let ring = closed_ring(outline, 0, Vec3::z());
    match family {
        RingFamily::ClassicLike => {
            let arcs = ring.marks.trigones.map(|t| arc_of(&ring.points_mm, t));
            cut_open(ring, arcs)
        }
        RingFamily::PosteriorBand => {
            let length = polyline::length(&ring.points_mm, true);
            let gap = 0.5 * (1.0 - BAND_SHARE) * length;
            cut_open(ring, [gap, length - gap])
        }
        RingFamily::PhysioLike | RingFamily::Saddle | RingFamily::ReducedAp => ring,
    }
}

fn arc_of(points: &[Vec3], point: Vec3) -> f64 {
    polyline::nearest(points, true, point).map_or(0.0, |found| found.arc_mm)
}

/// Landmarks of a closed outline whose point `anterior` is the anterior middle: trigones at 38 degrees about the
/// centroid, the posterior middle opposite by arc length.
fn closed_ring(outline: Vec<Vec3>, anterior: usize, normal: Vec3) -> RingCurve {
    let centre = polyline::centroid(&outline, true);
    let mid_anterior = outline[anterior];
    let length = polyline::length(&outline, true);
    let opposite = arc_of(&outline, mid_anterior) + 0.5 * length;
    let marks = RingMarks {
        mid_anterior,
        trigones: [1.0, -1.0]
            .map(|side| at_angle(&outline, centre, normal, mid_anterior, side * TRIGONE_HALF_ANGLE)),
        mid_posterior: polyline::point_at(&outline, true, opposite),
    };
    RingCurve {
        points_mm: outline,
        closed: true,
        marks,
    }
}

/// Where a closed outline crosses the ray at an angle from a point: the nearest of a dense resampling.
fn at_angle(outline: &[Vec3], centre: Vec3, normal: Vec3, from: Vec3, angle: f64) -> Vec3 {
    let flat = |p: Vec3| (p - centre) - normal * normal.dot(&(p - centre));
    let zero = flat(from);
    let wanted = zero * angle.cos() + normal.cross(&zero) * angle.sin();
    let dense = polyline::resample(outline, true, 4 * SAMPLES);
    let nearest = dense
        .into_iter()
        .min_by(|&a, &b| flat(a).angle(&wanted).total_cmp(&flat(b).angle(&wanted)));
    nearest.unwrap_or(from)
}

/// Keeps the stretch between two arc lengths.
fn cut_open(ring: RingCurve, [from, to]: [f64; 2]) -> RingCurve {
    let count = (SAMPLES as f64 * (to - from) / polyline::length(&ring.points_mm, true)).ceil() as usize;
    let step = (to - from) / count as f64;
    let arcs = polyline::arc_lengths(&ring.points_mm, true);
    let at = |i: usize| polyline::point_at_arc(&ring.points_mm, true, &arcs, from + step * i as f64);
    RingCurve {
        points_mm: (0..=count).map(at).collect(),
        closed: false,
        marks: ring.marks,
    }
}

/// The ways in which a measured curve may sit on the annulus, each a ring with its landmarks: with either side up,
/// and, for a closed one, with either half anterior. Closed curves are widest between the commissures; of an open
/// one the gap is anterior.
pub fn curve_candidates(points: &[Vec3], closed: bool) -> Vec<RingCurve> {
    let backward: Vec<Vec3> = points.iter().rev().copied().collect();
    let sides = [points.to_vec(), backward].into_iter();
    if closed {
        sides.flat_map(closed_candidates).collect()
    } else {
        sides.map(open_candidate).collect()
    }
}

fn closed_candidates(points: Vec<Vec3>) -> Vec<RingCurve> {
    let normal = normal_of(&points);
    let dense = polyline::resample(&points, true, SAMPLES);
    let flat = |v: Vec3| v - normal * normal.dot(&v);
    let width = |&(i, j): &(usize, usize)| flat(dense[i] - dense[j]).norm();
    let pairs = (0..SAMPLES).flat_map(|i| (i + 1..SAMPLES).map(move |j| (i, j)));
    let Some((i, j)) = pairs.reduce(|best, next| if width(&next) > width(&best) { next } else { best })
    else {
        return Vec::new();
    };
    let middle = (dense[i] + dense[j]) * 0.5;
    let up = normal.cross(&flat(dense[j] - dense[i]));
    let reach = |direction: Vec3| {
        let off = |k: &usize| flat(dense[*k] - middle).angle(&direction);
        (0..SAMPLES).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0)
    };
    [up, -up]
        .map(|direction| closed_ring(dense.clone(), reach(direction), normal))
        .into()
}

fn open_candidate(points: Vec<Vec3>) -> RingCurve {
    let length = polyline::length(&points, false);
    let ends = [points[0], points[points.len() - 1]];
    RingCurve {
        marks: RingMarks {
            mid_anterior: (ends[0] + ends[1]) * 0.5,
            trigones: ends,
            mid_posterior: polyline::point_at(&points, false, 0.5 * length),
        },
        points_mm: points,
        closed: false,
    }
}

/// Unit normal from which the (closed) curve runs counter-clockwise.
pub fn normal_of(points: &[Vec3]) -> Vec3 {
    polyline::vector_area(points)
        .try_normalize(0.0)
        .unwrap_or_else(Vec3::z)
}

const FAMILIES: [(&str, RingFamily); 5] = [
    ("classic-like", RingFamily::ClassicLike),
    ("physio-like", RingFamily::PhysioLike),
    ("saddle", RingFamily::Saddle),
    ("reduced-ap", RingFamily::ReducedAp),
    ("posterior-band", RingFamily::PosteriorBand),
];

/// The name of a family, as in scene files.
pub fn family_name(family: RingFamily) -> &'static str {
    FAMILIES
        .iter()
        .find(|(_, f)| *f == family)
        .map_or("", |(name, _)| name)
}

/// Reads a ring as one writes it on a command line, `physio-like:28`: family, colon, size [mm].
///
/// # Errors
/// An unknown family, or a size that is no number or not made; the message lists what there is.
pub fn parse_ring_spec(spec: &str) -> Result<Ring, Fault> {
    let names = FAMILIES.map(|(name, _)| name).join(", ");
    let fault = |what: String| Fault::error("ring", format!("`{spec}` {what}"));
    let (name, size) = spec.split_once(':').ok_or_else(|| {
        fault(format!(
            "lacks a size; expected FAMILY:SIZE with a family of {names}"
        ))
    })?;
    let family = FAMILIES
        .iter()
        .find(|(n, _)| *n == name.trim())
        .map(|&(_, family)| family);
    let family = family.ok_or_else(|| fault(format!("has an unknown family; there are {names}")))?;
    let size_mm: f64 = size
        .trim()
        .parse()
        .map_err(|_| fault("has a size that is no number".into()))?;
    if !SIZES_MM.contains(&size_mm) {
        return Err(fault(size_range()));
    }
    Ok(Ring {
        family: Some(family),
        size_mm: Some(size_mm),
        ..Ring::default()
    })
}

/// What sizes are expected.
pub(crate) fn size_range() -> String {
    format!(
        "is out of range, expected {} to {} mm",
        SIZES_MM.start(),
        SIZES_MM.end()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn families_have_their_proportions() {
        for (_, family) in FAMILIES {
            let ring = family_curve(family, 30.0);
            let span = |axis: usize| {
                let values = ring.points_mm.iter().map(|p| p[axis]);
                values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min)
            };
            // Open outlines are chords of a polygon with sides of 0.75 degrees, which lie within its circle by up
            // to 1 - cos(0.375 degrees) = 2e-5 of the radius, twice over, and their corners fall anywhere.
            assert!((span(0) - 30.0).abs() < 3e-3, "{family:?}: {}", span(0));
            if ring.closed {
                assert!((span(1) - 30.0 * proportions(family).anteroposterior).abs() < 1e-3);
            }
            assert!(
                normal_of(&ring.points_mm).z > 0.9,
                "counter-clockwise from the atrium"
            );
            assert!(ring.marks.trigones[0].x < 0.0 && ring.marks.trigones[1].x > 0.0);
        }
    }

    #[test]
    fn open_rings_have_their_gap_in_front() {
        let classic = family_curve(RingFamily::ClassicLike, 30.0);
        let ends = [
            classic.points_mm[0],
            classic.points_mm[classic.points_mm.len() - 1],
        ];
        // The landmarks lie on a resampling: equal to rounding.
        assert!((ends[0] - classic.marks.trigones[0]).norm() < 1e-9);
        assert!((ends[1] - classic.marks.trigones[1]).norm() < 1e-9);
        let whole = polyline::length(&family_curve(RingFamily::PhysioLike, 30.0).points_mm, true);
        let band = polyline::length(&family_curve(RingFamily::PosteriorBand, 30.0).points_mm, false);
        // The planar outline is up to 1 % shorter than the saddle that it is compared with here.
        assert!((band / whole - 0.65).abs() < 0.01);
    }

    #[test]
    fn the_saddle_is_a_fifth_as_high_as_wide() {
        let ring = family_curve(RingFamily::Saddle, 30.0).points_mm;
        let points = polyline::resample(&ring, true, 1000);
        let centre = points.iter().sum::<Vec3>() / 1000.0;
        let spread: crate::Mat3 = points
            .iter()
            .map(|p| (p - centre) * (p - centre).transpose())
            .sum();
        let eigen = spread.symmetric_eigen();
        let normal = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned();
        let heights = points.iter().map(|p| (p - centre).dot(&normal));
        let height = heights.clone().fold(f64::MIN, f64::max) - heights.fold(f64::MAX, f64::min);
        // The proportions are given to three digits.
        assert!((height / 30.0 - 0.20).abs() < 0.001, "{}", height / 30.0);
    }

    #[test]
    fn a_measured_curve_finds_its_own_front_among_the_candidates() {
        let ring = family_curve(RingFamily::PhysioLike, 30.0);
        let candidates = curve_candidates(&ring.points_mm, true);
        assert_eq!(candidates.len(), 4);
        let off = |c: &RingCurve| (c.marks.mid_anterior - ring.marks.mid_anterior).norm();
        // One sample of the outline is at most 0.2 mm.
        assert!(
            candidates
                .iter()
                .any(|c| off(c) < 0.2 && normal_of(&c.points_mm).z > 0.9)
        );
    }

    #[test]
    fn specs_are_read_and_refused() {
        let ring = parse_ring_spec("physio-like:28").unwrap();
        assert_eq!(
            (ring.family, ring.size_mm),
            (Some(RingFamily::PhysioLike), Some(28.0))
        );
        for (spec, words) in [
            ("physio-like", "lacks a size"),
            ("duran:28", "classic-like, physio-like"),
            ("saddle:large", "no number"),
            ("saddle:50", "20 to 44 mm"),
            ("saddle:NaN", "20 to 44 mm"),
        ] {
            assert!(
                parse_ring_spec(spec).unwrap_err().message.contains(words),
                "{spec}"
            );
        }
    }
}

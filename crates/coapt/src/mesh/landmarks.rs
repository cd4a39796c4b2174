//! Where commissures, trigones and the middles of the annulus lie.
//!
//! What the person names wins; then the leaflets' borders on the annulus; then shape. Sides follow the papillary
//! muscles' names, else anatomy: seen from the atrium with the aorta at 12 o'clock the anterolateral commissure
//! is at 9 o'clock (Mahmood 2012, Anesth Analg 115:779), so that counter-clockwise from the middle of the
//! anterior annulus come: left trigone, anterolateral commissure, middle of the posterior annulus,
//! posteromedial commissure, right trigone.

use crate::Vec3;
use crate::mesh::anterior_arc::anterior_arc;
use crate::mesh::polyline;
use crate::scene::{Fault, Landmarks};

/// Half the angle between the trigones about the annulus' centroid [rad]: 76 ± 13 degrees between them in 82
/// fresh cadavers (PMID 17965505).
pub const TRIGONE_HALF_ANGLE: f64 = 38.0 * std::f64::consts::PI / 180.0;

/// Half the angle between the commissures [rad], used where no leaflet border shows them: 121 ± 11 degrees (ibid.).
pub const COMMISSURE_HALF_ANGLE: f64 = 60.5 * std::f64::consts::PI / 180.0;

/// A named point this far from the annulus is doubtful [mm] (our choice: about two mesh edges).
const NAMED_REACH_MM: f64 = 5.0;

/// Landmarks as indices into the annulus' vertex list.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AnnulusLandmarks {
    /// Middle of the anterior annulus.
    pub mid_anterior: usize,
    /// Middle of the posterior annulus.
    pub mid_posterior: usize,
    /// Anterolateral commissure.
    pub commissure_anterolateral: usize,
    /// Posteromedial commissure.
    pub commissure_posteromedial: usize,
    /// Left trigone.
    pub trigone_left: usize,
    /// Right trigone.
    pub trigone_right: usize,
}

/// What landmarks are found from.
#[derive(Clone, Copy, Debug)]
pub struct LandmarkInput<'a> {
    /// The annulus, counter-clockwise seen from the atrium [mm].
    pub annulus_mm: &'a [Vec3],
    /// Leaflet at the annulus edge that leaves each annulus point; none where that edge is no mesh edge.
    pub edge_leaflet: &'a [Option<u32>],
    /// Leaflet names.
    pub leaflet_names: &'a [&'a str],
    /// Unit normal of the annulus, to the atrium.
    pub atrial: Vec3,
    /// Name and mean tip of each papillary muscle that has tips [mm].
    pub papillary: &'a [(&'a str, Vec3)],
    /// Points that the person named.
    pub named: &'a Landmarks,
}

/// Finds the landmarks; warnings say what was guessed. An empty annulus gives zeros.
pub fn find(input: &LandmarkInput) -> (AnnulusLandmarks, Vec<Fault>) {
    let mut warnings = Vec::new();
    if input.annulus_mm.len() < 3 {
        return (AnnulusLandmarks::default(), warnings);
    }
    let (start, end) = anterior_arc(input, &mut warnings);
    let named = input.named;
    let mut pick = |at: Option<[f64; 3]>, key: &str, found: usize| match at {
        Some(point) => nearest_vertex(input, point, key, &mut warnings),
        None => found,
    };
    // The arc runs counter-clockwise, so its start is the posteromedial commissure in a human heart.
    let mid_anterior = pick(
        named.mid_anterior_mm,
        "mid_anterior_mm",
        arc_middle(input, start, end),
    );
    let mid_posterior = pick(
        named.mid_posterior_mm,
        "mid_posterior_mm",
        arc_middle(input, end, start),
    );
    let mirrored = is_mirrored(input, start, end);
    let (al, pm) = if mirrored { (start, end) } else { (end, start) };
    let al = pick(
        named.commissure_anterolateral_mm,
        "commissure_anterolateral_mm",
        al,
    );
    let pm = pick(
        named.commissure_posteromedial_mm,
        "commissure_posteromedial_mm",
        pm,
    );
    let turn = if mirrored {
        -TRIGONE_HALF_ANGLE
    } else {
        TRIGONE_HALF_ANGLE
    };
    let left = pick(
        named.trigone_left_mm,
        "trigone_left_mm",
        at_angle(input, mid_anterior, turn),
    );
    let right = pick(
        named.trigone_right_mm,
        "trigone_right_mm",
        at_angle(input, mid_anterior, -turn),
    );
    if mirrored {
        warnings.push(mirror_warning());
    }
    if trigones_are_swapped(input, mid_anterior, [al, left, right]) {
        let message = "lies on the posteromedial side and trigone_right_mm on the anterolateral one; expected the left trigone \
                       beside the anterolateral commissure: they look swapped";
        warnings.push(Fault::warning("landmarks.trigone_left_mm", message));
    }
    let landmarks = AnnulusLandmarks {
        mid_anterior,
        mid_posterior,
        commissure_anterolateral: al,
        commissure_posteromedial: pm,
        trigone_left: left,
        trigone_right: right,
    };
    (landmarks, warnings)
}

fn mirror_warning() -> Fault {
    Fault::warning(
        "landmarks",
        "the anterolateral side lies clockwise from the anterior middle, seen from the atrium; in a human heart it \
         lies counter-clockwise: the valve looks mirrored",
    )
}

/// Whether both trigones are named, each on the other's side of the anterior middle. What side is which the anterolateral
/// commissure says, or where the trigones themselves decided that, the muscle of that name.
fn trigones_are_swapped(input: &LandmarkInput, mid_anterior: usize, [al, left, right]: [usize; 3]) -> bool {
    let named = input.named;
    if named.trigone_left_mm.is_none() || named.trigone_right_mm.is_none() {
        return false;
    }
    let at = |index: usize| input.annulus_mm[index];
    // To the anterolateral side from the anterior middle, across the valve.
    let has_commissures =
        named.commissure_anterolateral_mm.is_some() && named.commissure_posteromedial_mm.is_some();
    let muscles = side_of_muscle(input, is_anterolateral).zip(side_of_muscle(input, is_posteromedial));
    let across = match muscles {
        Some((lateral, medial)) if !has_commissures => lateral - medial,
        _ => at(al) - at(mid_anterior),
    };
    let side = |index: usize| (at(index) - at(mid_anterior)).dot(&across);
    side(left) < 0.0 && side(right) > 0.0
}

/// Whether the anterolateral side is at the arc's start, as the named commissures or muscles tell; anatomy has
/// it at the end.
fn is_mirrored(input: &LandmarkInput, start: usize, end: usize) -> bool {
    let across = input.annulus_mm[end] - input.annulus_mm[start];
    let named = input.named;
    let from_names = side_of_muscle(input, is_anterolateral).zip(side_of_muscle(input, is_posteromedial));
    let pairs = [
        named
            .commissure_anterolateral_mm
            .zip(named.commissure_posteromedial_mm),
        named.trigone_left_mm.zip(named.trigone_right_mm),
    ];
    let points = pairs
        .into_iter()
        .flatten()
        .next()
        .map(|(al, pm)| (Vec3::from(al), Vec3::from(pm)));
    points
        .or(from_names)
        .is_some_and(|(al, pm)| (al - pm).dot(&across) < 0.0)
}

fn side_of_muscle(input: &LandmarkInput, is_side: fn(&str) -> bool) -> Option<Vec3> {
    input
        .papillary
        .iter()
        .find(|(name, _)| is_side(name))
        .map(|&(_, tip)| tip)
}

fn is_anterolateral(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    name.contains("lateral") || name == "al" || name == "alpm"
}

fn is_posteromedial(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    name.contains("medial") || name == "pm" || name == "pmpm"
}

pub(super) fn nearest_vertex(
    input: &LandmarkInput,
    point: [f64; 3],
    key: &str,
    warnings: &mut Vec<Fault>,
) -> usize {
    let point = Vec3::from(point);
    let distance = |i: &usize| (input.annulus_mm[*i] - point).norm();
    let best = (0..input.annulus_mm.len())
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .unwrap_or(0);
    let off = distance(&best);
    if off > NAMED_REACH_MM {
        let message = format!("lies {off:.1} mm from the annulus, expected within {NAMED_REACH_MM} mm");
        warnings.push(Fault::warning(format!("landmarks.{key}"), message));
    }
    best
}

/// Halfway along the annulus from one vertex counter-clockwise to another.
fn arc_middle(input: &LandmarkInput, from: usize, to: usize) -> usize {
    let arcs = polyline::arc_lengths(input.annulus_mm, true);
    let total = arcs[input.annulus_mm.len()];
    let span = (arcs[to] - arcs[from]).rem_euclid(total);
    let middle = (arcs[from] + 0.5 * span).rem_euclid(total);
    let off = |i: usize| {
        let away = (arcs[i] - middle).abs();
        away.min(total - away)
    };
    (0..input.annulus_mm.len())
        .min_by(|&a, &b| off(a).total_cmp(&off(b)))
        .unwrap_or(from)
}

/// The vertex nearest to an angle [rad], counter-clockwise about the centroid from a vertex.
pub(super) fn at_angle(input: &LandmarkInput, from: usize, angle: f64) -> usize {
    let centre = polyline::centroid(input.annulus_mm, true);
    let flat = |i: usize| {
        let arm = input.annulus_mm[i] - centre;
        arm - input.atrial * arm.dot(&input.atrial)
    };
    let zero = flat(from);
    let left = input.atrial.cross(&zero);
    let wanted = zero * angle.cos() + left * angle.sin();
    let off = |i: usize| flat(i).angle(&wanted);
    (0..input.annulus_mm.len())
        .min_by(|&a, &b| off(a).total_cmp(&off(b)))
        .unwrap_or(from)
}

#[cfg(test)]
mod tests {
    use super::*;

    const COUNT: usize = 72;

    /// An ellipse of 38 by 28 mm counter-clockwise from +x, `height` times sin² above the plane for y > 0.
    fn ring(height: f64) -> Vec<Vec3> {
        let point = |i: usize| {
            let (sin, cos) = (i as f64 * std::f64::consts::TAU / COUNT as f64).sin_cos();
            Vec3::new(19.0 * cos, 14.0 * sin, height * sin.max(0.0).powi(2))
        };
        (0..COUNT).map(point).collect()
    }

    fn input<'a>(
        annulus_mm: &'a [Vec3],
        edge_leaflet: &'a [Option<u32>],
        papillary: &'a [(&'a str, Vec3)],
        named: &'a Landmarks,
    ) -> LandmarkInput<'a> {
        LandmarkInput {
            annulus_mm,
            edge_leaflet,
            leaflet_names: &["posterior", "anterior"],
            atrial: Vec3::z(),
            papillary,
            named,
        }
    }

    /// Leaflet 1 (anterior) between 30 and 150 degrees, y being anterior.
    fn borders() -> Vec<Option<u32>> {
        (0..COUNT)
            .map(|i| Some(u32::from((6..30).contains(&i))))
            .collect()
    }

    #[test]
    fn anatomy_has_the_anterolateral_side_at_nine_o_clock() {
        let (found, warnings) = find(&input(&ring(0.0), &borders(), &[], &Landmarks::default()));
        // Seen along -z with +y up, +x is to the right: 9 o'clock is -x, which is 150 degrees here.
        assert_eq!(
            (found.commissure_anterolateral, found.commissure_posteromedial),
            (30, 6)
        );
        assert_eq!((found.mid_anterior, found.mid_posterior), (18, 54));
        let ring = ring(0.0);
        let angle = |i: usize| ring[i].y.atan2(ring[i].x).to_degrees();
        // Vertices are at most 6.8 degrees apart about the centre, so the nearest is within 3.4.
        assert!((angle(found.trigone_left) - 128.0).abs() < 3.4);
        assert!((angle(found.trigone_right) - 52.0).abs() < 3.4);
        assert!(warnings.is_empty());
    }

    #[test]
    fn muscles_names_decide_the_side_and_a_mirror_image_is_told() {
        let tips = [
            ("posteromedial", Vec3::new(-12.0, -3.0, -20.0)),
            ("Anterolateral", Vec3::new(12.0, -2.0, -20.0)),
        ];
        let (found, warnings) = find(&input(&ring(0.0), &borders(), &tips, &Landmarks::default()));
        assert_eq!(
            (found.commissure_anterolateral, found.commissure_posteromedial),
            (6, 30)
        );
        assert!(ring(0.0)[found.trigone_left].x > 0.0);
        assert!(warnings[0].message.contains("mirrored"));
    }

    /// Whatever else tells the sides: commissures, muscles, or both at once.
    #[test]
    fn swapped_trigones_are_told() {
        let tips = [
            ("posteromedial", Vec3::new(12.0, -3.0, -20.0)),
            ("anterolateral", Vec3::new(-12.0, -2.0, -20.0)),
        ];
        let (left, right) = (Some([-10.0, 12.0, 0.0]), Some([10.0, 12.0, 0.0]));
        let commissures = Landmarks {
            commissure_anterolateral_mm: Some([-16.0, 7.0, 0.0]),
            commissure_posteromedial_mm: Some([16.0, 7.0, 0.0]),
            ..Landmarks::default()
        };
        let with = |named: &Landmarks, trigones: [Option<[f64; 3]>; 2]| Landmarks {
            trigone_left_mm: trigones[0],
            trigone_right_mm: trigones[1],
            ..*named
        };
        for (tips, named) in [
            (&tips[..], &Landmarks::default()),
            (&[][..], &commissures),
            (&tips[..], &commissures),
        ] {
            let swapped = |trigones| {
                let named = with(named, trigones);
                let (_, warnings) = find(&input(&ring(0.0), &borders(), tips, &named));
                warnings.iter().any(|warning| warning.message.contains("swapped"))
            };
            assert!(!swapped([left, right]));
            assert!(swapped([right, left]));
            // Of one alone nobody can tell that the other is meant.
            assert!(!swapped([right, None]));
        }
    }

    #[test]
    fn named_points_win_and_far_ones_are_doubted() {
        let named = Landmarks {
            mid_anterior_mm: Some([2.0, 30.0, 0.0]),
            commissure_anterolateral_mm: Some([-19.0, 0.0, 0.0]),
            commissure_posteromedial_mm: Some([19.0, 0.0, 0.0]),
            ..Landmarks::default()
        };
        let (found, warnings) = find(&input(&ring(0.0), &vec![None; COUNT], &[], &named));
        assert_eq!(
            (found.commissure_anterolateral, found.commissure_posteromedial),
            (36, 0)
        );
        assert_eq!(found.mid_posterior, 54);
        assert_eq!(
            warnings.len(),
            1,
            "only the anterior middle lies far: {warnings:?}"
        );
        assert_eq!(warnings[0].place, "landmarks.mid_anterior_mm");
    }

    #[test]
    fn without_borders_the_saddle_and_then_the_muscles_tell() {
        let none = vec![None; COUNT];
        let (found, warnings) = find(&input(&ring(6.0), &none, &[], &Landmarks::default()));
        assert_eq!(found.mid_anterior, 18);
        assert!(warnings[0].message.contains("high point"));
        let tips = [
            ("a", Vec3::new(10.0, -6.0, -20.0)),
            ("b", Vec3::new(-10.0, -6.0, -20.0)),
        ];
        let (found, warnings) = find(&input(&ring(0.0), &none, &tips, &Landmarks::default()));
        assert_eq!(found.mid_anterior, 18);
        assert!(warnings[0].message.contains("away from"));
    }

    #[test]
    fn an_empty_annulus_is_survived() {
        assert_eq!(
            find(&input(&[], &[], &[], &Landmarks::default())).0,
            AnnulusLandmarks::default()
        );
    }
}

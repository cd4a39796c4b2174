//! Where commissures, trigones and the middles of the annulus lie.
//!
//! What the person names wins; then the leaflets' borders on the annulus; then shape. Sides follow the papillary
//! muscles' names, else anatomy: seen from the atrium with the aorta at 12 o'clock the anterolateral commissure
//! is at 9 o'clock (Mahmood 2012, Anesth Analg 115:779), so that counter-clockwise from the middle of the
//! anterior annulus come: left trigone, anterolateral commissure, middle of the posterior annulus,
//! posteromedial commissure, right trigone.

use crate::Vec3;
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

fn nearest_vertex(input: &LandmarkInput, point: [f64; 3], key: &str, warnings: &mut Vec<Fault>) -> usize {
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

/// First and last vertex of the anterior arc, counter-clockwise.
fn anterior_arc(input: &LandmarkInput, warnings: &mut Vec<Fault>) -> (usize, usize) {
    let named = input.named;
    if let (Some(al), Some(pm)) = (
        named.commissure_anterolateral_mm,
        named.commissure_posteromedial_mm,
    ) {
        let al = nearest_vertex(input, al, "commissure_anterolateral_mm", &mut Vec::new());
        let pm = nearest_vertex(input, pm, "commissure_posteromedial_mm", &mut Vec::new());
        if al != pm {
            return arc_between(input, al, pm);
        }
    }
    if let Some(arc) = arc_of_leaflet(input, warnings) {
        return arc;
    }
    let anterior = anterior_from_shape(input, warnings);
    (
        at_angle(input, anterior, -COMMISSURE_HALF_ANGLE),
        at_angle(input, anterior, COMMISSURE_HALF_ANGLE),
    )
}

/// Which of the two arcs between named commissures is anterior: the one with the named anterior middle, the one
/// without the named posterior middle, the one with more edges of the leaflet `anterior`, else as in a human heart.
fn arc_between(input: &LandmarkInput, al: usize, pm: usize) -> (usize, usize) {
    let count = input.annulus_mm.len();
    let inside = |i: usize| (i + count - pm) % count <= (al + count - pm) % count;
    let place = |point| nearest_vertex(input, point, "", &mut Vec::new());
    let edges_of_anterior = |on_arc: bool| {
        let edges = (0..count).filter(|&i| (inside(i) && i != al) == on_arc);
        edges
            .filter(|&i| input.edge_leaflet[i].is_some_and(|l| is_anterior(input, l)))
            .count()
    };
    let normal = match (input.named.mid_anterior_mm, input.named.mid_posterior_mm) {
        (Some(anterior), _) => inside(place(anterior)),
        (None, Some(posterior)) => !inside(place(posterior)),
        (None, None) => edges_of_anterior(true) >= edges_of_anterior(false),
    };
    if normal { (pm, al) } else { (al, pm) }
}

fn is_anterior(input: &LandmarkInput, leaflet: u32) -> bool {
    input
        .leaflet_names
        .get(leaflet as usize)
        .is_some_and(|n| n.eq_ignore_ascii_case("anterior"))
}

/// The longest run of annulus edges on the leaflet `anterior`, or on the first leaflet if none has that name.
fn arc_of_leaflet(input: &LandmarkInput, warnings: &mut Vec<Fault>) -> Option<(usize, usize)> {
    let leaflet_count = input.leaflet_names.len();
    let by_name = (0..leaflet_count as u32).find(|&leaflet| is_anterior(input, leaflet));
    let leaflet = by_name.unwrap_or(0);
    let arc = longest_run(input, leaflet)?;
    if by_name.is_none() {
        let name = input.leaflet_names.first().copied().unwrap_or_default();
        let message = format!("no leaflet is named `anterior`; `{name}` is taken for it");
        warnings.push(Fault::warning("leaflets", message));
    }
    Some(arc)
}

fn longest_run(input: &LandmarkInput, leaflet: u32) -> Option<(usize, usize)> {
    let count = input.annulus_mm.len();
    let on = |i: usize| input.edge_leaflet[i % count] == Some(leaflet);
    let starts = (0..count).filter(|&i| on(i) && !on(i + count - 1));
    let runs = starts.map(|start| {
        (
            start,
            (1..=count).take_while(|&step| on(start + step)).count() + 1,
        )
    });
    let (start, steps) = runs.reduce(|best, next| if next.1 > best.1 { next } else { best })?;
    Some((start, (start + steps) % count)).filter(|_| steps < count)
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
fn at_angle(input: &LandmarkInput, from: usize, angle: f64) -> usize {
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

/// The anterior middle where no leaflet border tells: the named one, the saddle's high point, the point away from
/// the papillary muscles, else the first vertex.
fn anterior_from_shape(input: &LandmarkInput, warnings: &mut Vec<Fault>) -> usize {
    if let Some(point) = input.named.mid_anterior_mm {
        return nearest_vertex(input, point, "mid_anterior_mm", &mut Vec::new());
    }
    let centre = polyline::centroid(input.annulus_mm, true);
    let extreme = |direction: Vec3| {
        let reach = |i: usize| (input.annulus_mm[i] - centre).dot(&direction);
        (0..input.annulus_mm.len())
            .max_by(|&a, &b| reach(a).total_cmp(&reach(b)).then(b.cmp(&a)))
            .unwrap_or(0)
    };
    let size = (2.0 * polyline::vector_area(input.annulus_mm).norm()).sqrt();
    let high = extreme(input.atrial);
    let tips =
        input.papillary.iter().map(|&(_, tip)| tip).sum::<Vec3>() / (input.papillary.len().max(1) as f64);
    let away = (centre - tips) - input.atrial * (centre - tips).dot(&input.atrial);
    // A twentieth of the annulus' size tells a saddle, or an offset of the muscles, from noise (our choice).
    let (found, why) = if (input.annulus_mm[high] - centre).dot(&input.atrial) > 0.05 * size {
        (high, "the saddle's high point")
    } else if !input.papillary.is_empty() && away.norm() > 0.05 * size {
        (extreme(away), "the point away from the papillary muscles")
    } else {
        (0, "an arbitrary annulus point")
    };
    let message = format!("no leaflet border shows the commissures; {why} is taken for the anterior middle");
    warnings.push(Fault::warning("landmarks", message));
    found
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

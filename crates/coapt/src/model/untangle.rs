//! Leaflets that cross or touch each other in the open valve are drawn apart, where it is clear how.
//!
//! Imaged valves are drawn by hand, leaflet by leaflet, and overlap by a millimetre here and there. Who is on which side of
//! whom cannot be read off where they cross, but from where they hang: the valve is opened wider, each point towards the
//! ventricular side of its leaflet by a part of how far it hangs from the annulus, until nothing crosses. Then it is let back
//! to where it was given, and contact stops what would cross. What was left of the way is told; where that is more than an
//! error of drawing, or where opening does not help, the valve is refused.

use std::collections::BTreeSet;

use super::faults::Faults;
use super::surface::Surface;
use crate::Vec3;
use crate::contact::gather::PairList;
use crate::contact::pairs::Place;
use crate::contact::step_bound::bound_steps;
use crate::contact::surface as contact;
use crate::contact::tangle::{self, Tangle};
use crate::mesh::topology::Edges;
use crate::mesh::ways::ways_to;

/// How much wider the valve is opened, in turn, until nothing crosses: parts of the way from the annulus [1]. The least that
/// serves leaves the shortest way back; the last opens a funnel to a cone. Our choice.
const OPENINGS: [f64; 6] = [0.05, 0.1, 0.2, 0.4, 0.8, 1.6];
/// Leaflets that crossed stay apart by this part of the contact thickness [1]. Our choice, no other was tried: contact begins at
/// half of what parts are apart at rest, so that less makes it a needle, and more moves points farther than they need.
const KEPT_APART: f64 = 0.2;
/// Points that move by less than this part of the contact thickness are not counted as moved [1]: that is rounding of the way back.
const COUNTED: f64 = 0.01;
/// Points that must move farther than this are no error of drawing [mm]. Our choice: two or three voxels of ultrasound, 0.5
/// to 1 mm wide.
const FARTHEST_MM: f64 = 3.0;
/// Longest step on the way back, in mean edges [1], and how many at most: 40 edges of way. Our choice.
const STEP_EDGES: f64 = 0.1;
const STEP_LIMIT: u32 = 400;
/// The way back ends where no point comes on by more than this part of a step [1].
const STANDSTILL: f64 = 0.01;
/// Rounds in which directions are averaged with the neighbours': enough to smooth over a few edges.
const SMOOTHING_ROUNDS: u32 = 10;

/// How many places where surfaces crossed are given by coordinates: enough to find them in a picture.
const PLACES_GIVEN: usize = 5;

/// What was drawn apart: the valve that is closed is not quite the one that was given.
#[derive(Clone, Debug, PartialEq)]
pub struct Untangled {
    /// At how many places surfaces crossed or touched.
    pub places: usize,
    /// Where, as given, the first five points at most [mm], LPS, shape `[place, 3]`.
    pub first_at_mm: Vec<[f64; 3]>,
    /// How many points were moved.
    pub moved_points: usize,
    /// How far the one was moved that was moved farthest [mm].
    pub farthest_mm: f64,
}

/// Draws apart what crosses or touches and says what it did, or tells why not; nothing where nothing crosses.
pub(crate) fn untangle(
    surface: &mut Surface,
    edges: &Edges,
    annulus: &[u32],
    thickness_mm: f64,
    faults: &mut Faults,
) -> Option<Untangled> {
    let parts = contact::Surface::new(&surface.faces, &surface.points);
    let tangles = tangle::tangles(&parts, &surface.points);
    let first = tangles.first()?;
    let place = surface.point_name(first.vertex);
    let named = |tangle: &Tangle| {
        let face = surface.face_name(tangle.face as usize);
        let [x, y, z] = surface.points[tangle.vertex as usize].into();
        let point = surface.point_name(tangle.vertex);
        format!("{point} at {face} ({x:.1}, {y:.1}, {z:.1}) mm")
    };
    let firsts = firsts(&tangles);
    let named: Vec<String> = firsts.iter().map(|tangle| named(tangle)).collect();
    let what = format!(
        "surfaces cross or touch in the open valve at {} places: {}{}",
        tangles.len(),
        named.join(", "),
        if tangles.len() > named.len() { ", ..." } else { "" }
    );
    let opening = opening(surface, edges, annulus);
    let opened = OPENINGS
        .iter()
        .map(|part| added(&surface.points, &opening, *part));
    let Some(opened) = { opened }.find(|points| tangle::tangles(&parts, points).is_empty()) else {
        let message = format!(
            "{what}; they still do when the valve is opened wider, so there is no telling which side is which"
        );
        faults.error(place, message);
        return None;
    };
    let apart = let_back(&opened, surface, thickness_mm);
    let moves = apart
        .iter()
        .zip(&surface.points)
        .map(|(to, from)| (to - from).norm());
    let (count, farthest_mm) = moves.fold((0, 0.0_f64), |(count, farthest), way| {
        (
            count + usize::from(way > COUNTED * thickness_mm),
            farthest.max(way),
        )
    });
    if farthest_mm > FARTHEST_MM {
        let message = format!(
            "{what}; to part them a point would have to move by {farthest_mm:.1} mm, expected at most {FARTHEST_MM} mm"
        );
        faults.error(place, message);
        return None;
    }
    let at = |tangle: &&Tangle| surface.points[tangle.vertex as usize].into();
    let first_at_mm = firsts.iter().map(at).collect();
    surface.points = apart;
    faults.warning_above_others(
        place,
        format!("{what}; they are drawn apart: {count} points are moved, by {farthest_mm:.2} mm at most"),
    );
    Some(Untangled {
        places: tangles.len(),
        first_at_mm,
        moved_points: count,
        farthest_mm,
    })
}

/// The first places at different points: a point that lies on a surface touches several faces.
fn firsts(tangles: &[Tangle]) -> Vec<&Tangle> {
    let mut seen = BTreeSet::new();
    let new = tangles.iter().filter(|tangle| seen.insert(tangle.vertex));
    new.take(PLACES_GIVEN).collect()
}

/// How points go when the valve is opened wider [mm]: towards the ventricular side of the leaflet around them, as far as
/// they hang from the annulus.
fn opening(surface: &Surface, edges: &Edges, annulus: &[u32]) -> Vec<Vec3> {
    let mut normals = vec![Vec3::zeros(); surface.points.len()];
    for (face, corners) in surface.faces.iter().enumerate() {
        let [a, b, c] = surface.corners(face);
        let twice_area = (b - a).cross(&(c - a));
        corners.iter().for_each(|&v| normals[v as usize] += twice_area);
    }
    for _ in 0..SMOOTHING_ROUNDS {
        let mut sums: Vec<Vec3> = normals.iter().map(unit).collect();
        for &[a, b] in &edges.ends {
            let (one, other) = (unit(&normals[a as usize]), unit(&normals[b as usize]));
            sums[a as usize] += other;
            sums[b as usize] += one;
        }
        normals = sums;
    }
    normals
        .iter()
        .zip(hanging_mm(surface, edges, annulus))
        .map(|(normal, way)| unit(normal) * -way)
        .collect()
}

fn unit(vector: &Vec3) -> Vec3 {
    vector.try_normalize(0.0).unwrap_or_default()
}

/// Length of the shortest way along edges to the annulus [mm], shape `[point]`; zero for what hangs on chordae alone.
fn hanging_mm(surface: &Surface, edges: &Edges, annulus: &[u32]) -> Vec<f64> {
    let mut around: Vec<Vec<u32>> = vec![Vec::new(); surface.points.len()];
    for &[a, b] in &edges.ends {
        around[a as usize].push(b);
        around[b as usize].push(a);
    }
    let ways = ways_to(annulus, &surface.points, |vertex| &around[vertex]);
    let or_zero = |way: f64| if way.is_finite() { way } else { 0.0 };
    ways.length_mm.into_iter().map(or_zero).collect()
}

fn added(points: &[Vec3], motion: &[Vec3], part: f64) -> Vec<Vec3> {
    points
        .iter()
        .zip(motion)
        .map(|(point, motion)| point + motion * part)
        .collect()
}

/// Goes from the opened shape back to the given one as far as contact lets each vertex.
fn let_back(opened: &[Vec3], surface: &Surface, thickness_mm: f64) -> Vec<Vec3> {
    let parts = contact::Surface::new(&surface.faces, opened);
    let step_mm = STEP_EDGES * parts.mean_edge_mm;
    let mut positions = opened.to_vec();
    let (mut pairs, mut near, mut allowances) = (PairList::default(), Vec::new(), Vec::new());
    for _ in 0..STEP_LIMIT {
        let way = |(goal, here): (&Vec3, &Vec3)| {
            let way = goal - here;
            way * (step_mm / way.norm().max(step_mm))
        };
        let mut step: Vec<Vec3> = surface.points.iter().zip(&positions).map(way).collect();
        let place = Place {
            surface: &parts,
            rest_mm: opened,
            positions_mm: &positions,
            thickness_mm: KEPT_APART * thickness_mm,
            rigid_fraction: 0.0,
            kept_fraction: 1.0,
        };
        bound_steps(&mut pairs, &place, &mut step, &mut near, &mut allowances);
        positions = added(&positions, &step, 1.0);
        if step.iter().all(|step| step.norm() < STANDSTILL * step_mm) {
            break;
        }
    }
    positions
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{ROWS, built, faults, mesh, skirt, told};
    use super::FARTHEST_MM;
    use crate::contact::surface::Surface;
    use crate::contact::tangle::tangles;
    use crate::scene::{Fault, Scene};

    /// The skirt with its margins drawn towards the middle of the orifice and beyond, along y.
    fn swung(part: f64) -> Scene {
        let mut scene = skirt();
        for leaflet in 0..2 {
            let points = &mut mesh(&mut scene, leaflet).points_mm;
            let last = points.len() - ROWS;
            for (number, point) in points.iter_mut().enumerate() {
                let depth = -point[2] / 14.0;
                point[1] *= 1.0 - part * depth;
                // Else points of both leaflets would coincide, and be one; commissures are.
                if leaflet == 1 && (ROWS..last).contains(&number) {
                    point[0] += 0.5 * depth;
                }
            }
        }
        scene
    }

    fn is_told(faults: &[Fault]) -> bool {
        faults
            .iter()
            .any(|fault| fault.message.contains("cross or touch"))
    }

    #[test]
    fn leaflets_that_overlap_or_lie_on_each_other_are_drawn_apart() {
        for part in [1.0, 1.05] {
            let done = built(&swung(part));
            assert!(told(&done.warnings, "leaflets[", "are drawn apart"));
            let untangled = done.untangled.unwrap();
            assert!(untangled.places >= untangled.first_at_mm.len() && !untangled.first_at_mm.is_empty());
            // In the plane between the leaflets, where the swing has brought both margins, each place once.
            assert!(
                untangled.first_at_mm.iter().any(|at| at[1].abs() < 1.0),
                "{untangled:?}"
            );
            let mut places = untangled.first_at_mm.clone();
            places.dedup();
            assert_eq!(places, untangled.first_at_mm);
            assert!(untangled.moved_points > 0 && (0.01..FARTHEST_MM).contains(&untangled.farthest_mm));
            let [x, y, z] = untangled.first_at_mm[0];
            assert!(told(
                &done.warnings,
                "leaflets[",
                &format!("({x:.1}, {y:.1}, {z:.1})")
            ));
            let model = done.model;
            assert!(tangles(&Surface::new(&model.faces, &model.rest_mm), &model.rest_mm).is_empty());
        }
        let open = built(&swung(0.5));
        assert!(!is_told(&open.warnings) && open.untangled.is_none());
    }

    #[test]
    fn leaflets_that_have_changed_places_are_refused() {
        let faults = faults(&swung(3.0));
        assert!(told(
            &faults,
            "leaflets[",
            "surfaces cross or touch in the open valve"
        ));
        // Where to look, by coordinates: as many as places are named.
        let places = faults[0].message.matches(" (").count();
        assert!((1..=5).contains(&places), "{faults:#?}");
    }

    #[test]
    fn leaflets_without_contact_may_cross() {
        let mut scene = swung(3.0);
        scene.contact.stiffness_mpa = 0.0;
        assert!(!is_told(&built(&scene).warnings));
    }
}

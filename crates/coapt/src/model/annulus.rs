//! Which boundary is annulus, and what is left as free margin.

use super::Margin;
use super::annulus_checks;
use super::faults::{Faults, some};
use super::surface::Surface;
use crate::Vec3;
use crate::mesh::polyline;
use crate::mesh::topology::{self, Chain};
use crate::scene::{Annulus, Scene};

/// The annulus and the boundary loop that it lies on.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    /// Annulus vertices in boundary order; closed if they are the whole loop.
    pub(crate) annulus: Chain,
    /// All vertices of that loop.
    pub(crate) ring: Vec<u32>,
}

/// Finds the annulus among the boundary loops: by marks, by a curve, else by distance from the papillary tips.
///
/// It must be one whole loop. Where the surface has no other boundary, as with a single leaflet or a test patch,
/// part of the loop will do: the rest is free margin, and the annulus runs from the end of its longest gap on.
pub(crate) fn find(
    surface: &Surface,
    loops: &[Chain],
    scene: &Scene,
    tips: &[Vec3],
    faults: &mut Faults,
) -> Option<Found> {
    if loops.is_empty() {
        faults.error(
            "leaflets",
            "no support: the surface is closed, so there is no annulus to hold it",
        );
        return None;
    }
    if let Some(marked) = &surface.marked {
        return from_marks(surface, loops, marked, "leaflets[].mesh.annulus_points", faults);
    }
    if let Some(curve) = &scene.annulus.curve_mm {
        let marked = near_curve(surface, loops, curve, &scene.annulus, faults)?;
        return from_marks(surface, loops, &marked, "annulus.curve_mm", faults);
    }
    if !annulus_checks::is_joined(surface, loops, faults) {
        return None;
    }
    let far = |chain: &Chain| match tips {
        [] => polyline::length(&positions(surface, &chain.vertices), true),
        _ => mean_distance(&positions(surface, &chain.vertices), tips),
    };
    let ring = loops
        .iter()
        .reduce(|best, next| if far(next) > far(best) { next } else { best })?;
    match (loops.len(), scene.chordae.is_empty()) {
        (1, true) => {
            let message = "none is given; the only boundary is held all round, and there is no free margin";
            faults.warning("annulus", message);
        }
        // Chordae would hang on held points, and such a sheet never leaks: a valve that was told wrongly would look competent.
        (1, false) => {
            faults.error(
                "annulus",
                "none is given, and the only boundary would be held all round, with no free margin for the chordae; expected \
                 `annulus.curve_mm` or `annulus.marker_array`",
            );
            return None;
        }
        _ => {}
    }
    Some(Found {
        annulus: ring.clone(),
        ring: ring.vertices.clone(),
    })
}

pub(crate) fn positions(surface: &Surface, vertices: &[u32]) -> Vec<Vec3> {
    vertices.iter().map(|&v| surface.points[v as usize]).collect()
}

fn mean_distance(points: &[Vec3], tips: &[Vec3]) -> f64 {
    let centre = tips.iter().sum::<Vec3>() / tips.len() as f64;
    points.iter().map(|p| (p - centre).norm()).sum::<f64>() / points.len() as f64
}

/// Marks boundary vertices near the curve; by default within half the mean boundary edge, which a resampled curve
/// through the same points never exceeds by much (our choice).
fn near_curve(
    surface: &Surface,
    loops: &[Chain],
    curve: &[[f64; 3]],
    annulus: &Annulus,
    faults: &mut Faults,
) -> Option<Vec<bool>> {
    let curve: Vec<Vec3> = curve.iter().map(|&p| Vec3::from(p)).collect();
    let length: f64 = loops
        .iter()
        .map(|l| polyline::length(&positions(surface, &l.vertices), true))
        .sum();
    let edges: usize = loops.iter().map(|l| l.vertices.len()).sum();
    let tolerance = annulus.curve_tolerance_mm.unwrap_or(0.5 * length / edges as f64);
    let mut marked = vec![false; surface.points.len()];
    let mut nearest = f64::INFINITY;
    for &vertex in loops.iter().flat_map(|l| &l.vertices) {
        let distance = polyline::nearest(&curve, true, surface.points[vertex as usize])?.distance_mm;
        nearest = nearest.min(distance);
        marked[vertex as usize] = distance <= tolerance;
    }
    if nearest > tolerance {
        let message = format!(
            "no boundary point lies within {tolerance:.2} mm of it; the nearest is {nearest:.2} mm away"
        );
        faults.error("annulus.curve_mm", message);
        return None;
    }
    Some(marked)
}

/// The one loop that the marks lie on.
fn from_marks(
    surface: &Surface,
    loops: &[Chain],
    marked: &[bool],
    place: &str,
    faults: &mut Faults,
) -> Option<Found> {
    let mut inside = marked.to_vec();
    loops
        .iter()
        .flat_map(|l| &l.vertices)
        .for_each(|&v| inside[v as usize] = false);
    let inside: Vec<u32> = (0..marked.len() as u32).filter(|&v| inside[v as usize]).collect();
    if !inside.is_empty() {
        let names = some(inside.iter().map(|&v| surface.point_name(v)));
        faults.error(
            place,
            format!(
                "{} annulus points lie within the surface, not on its boundary: {names}",
                inside.len()
            ),
        );
    }
    let is_marked = |v: &&u32| marked[**v as usize];
    let with_marks: Vec<&Chain> = loops
        .iter()
        .filter(|l| l.vertices.iter().any(|v| is_marked(&v)))
        .collect();
    match with_marks[..] {
        [] => {
            faults.error(place, "no support: no boundary point is annulus");
            None
        }
        [ring] => along(surface, ring, marked, loops.len() == 1, place, faults),
        _ => {
            let sets: Vec<Vec<u32>> = with_marks
                .iter()
                .map(|l| l.vertices.iter().filter(is_marked).copied().collect())
                .collect();
            let gap = smallest_gap(surface, &sets);
            let message = format!(
                "annulus points lie on {} separate boundary loops, {gap:.2} mm apart at the nearest; expected one \
                 loop (join the leaflets at the commissures)",
                sets.len()
            );
            faults.error(place, message);
            None
        }
    }
}

pub(super) fn smallest_gap(surface: &Surface, sets: &[Vec<u32>]) -> f64 {
    let [first, rest @ ..] = sets else {
        return f64::INFINITY;
    };
    let others = positions(surface, &rest.concat());
    let near = |p: &Vec3| {
        others
            .iter()
            .map(|q| (p - q).norm())
            .fold(f64::INFINITY, f64::min)
    };
    positions(surface, first)
        .iter()
        .map(near)
        .fold(f64::INFINITY, f64::min)
}

/// Marked vertices in loop order, from the end of the longest gap on.
fn along(
    surface: &Surface,
    ring: &Chain,
    marked: &[bool],
    only_loop: bool,
    place: &str,
    faults: &mut Faults,
) -> Option<Found> {
    let count = ring.vertices.len();
    let on = |i: usize| marked[ring.vertices[i % count] as usize];
    let gaps: Vec<(usize, usize)> = (0..count)
        .filter(|&i| on(i) && !on(i + 1))
        .map(|i| (i, (1..count).find(|&step| on(i + step)).unwrap_or(count)))
        .collect();
    let arc = |&(from, steps): &(usize, usize)| {
        let vertices: Vec<u32> = (0..=steps)
            .map(|step| ring.vertices[(from + step) % count])
            .collect();
        polyline::length(&positions(surface, &vertices), false)
    };
    let longest = gaps
        .iter()
        .reduce(|best, next| if arc(next) > arc(best) { next } else { best });
    let start = match longest {
        None => 0,
        Some(gap) if only_loop => {
            let message = format!(
                "the annulus is part of the only boundary; {} stretches of it, the longest {:.2} mm, are free margin",
                gaps.len(),
                arc(gap)
            );
            faults.warning(place, message);
            gap.0 + gap.1
        }
        Some(gap) => {
            let [a, b] = [gap.0, gap.0 + gap.1].map(|i| surface.point_name(ring.vertices[i % count]));
            let message = format!(
                "the annulus is open; {} gaps, the longest {:.2} mm from {a} to {b}; expected a closed loop",
                gaps.len(),
                arc(gap)
            );
            faults.error(place, message);
            return None;
        }
    };
    let in_order = (start..start + count)
        .filter(|&i| on(i))
        .map(|i| ring.vertices[i % count]);
    Some(Found {
        annulus: Chain {
            vertices: in_order.collect(),
            closed: longest.is_none(),
        },
        ring: ring.vertices.clone(),
    })
}

/// Every stretch of boundary that is not annulus, in winding order; an open one begins and ends on the annulus.
pub(crate) fn margins(found: &Found, loops: &[Chain]) -> Vec<Margin> {
    let mut held = found.annulus.vertices.clone();
    held.sort_unstable();
    let is_held = |v: u32| held.binary_search(&v).is_ok();
    let sides = loops.iter().flat_map(|chain| {
        let next = chain.vertices.iter().cycle().skip(1);
        chain.vertices.iter().zip(next).map(|(&a, &b)| [a, b])
    });
    let free: Vec<[u32; 2]> = sides.filter(|&[a, b]| !(is_held(a) && is_held(b))).collect();
    let chains = topology::chains(&free).into_iter();
    chains
        .map(|Chain { vertices, closed }| Margin { vertices, closed })
        .collect()
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::fixtures::{COLUMNS, ROWS, built, faults, mesh, skirt, skirt_point, told};
    use super::*;
    use crate::scene::SurfaceMesh;

    /// Every annulus point of a skirt leaflet, whose points run from annulus to margin.
    pub(in super::super) fn mark(scene: &mut Scene) {
        for leaflet in 0..2 {
            let surface = mesh(scene, leaflet);
            surface.annulus_points = Some((0..surface.points_mm.len() as u32).step_by(ROWS).collect());
        }
    }

    #[test]
    fn marks_curve_and_default_agree() {
        let plain = built(&skirt()).model;
        let mut marked = skirt();
        mark(&mut marked);
        let mut curved = skirt();
        curved.annulus.curve_mm = Some((0..COLUMNS).map(|c| skirt_point(c, 0)).collect());
        let mut without_tips = skirt();
        without_tips.papillary.clear();
        without_tips.chordae.clear();
        for scene in [marked, curved, without_tips] {
            assert_eq!(built(&scene).model.annulus, plain.annulus);
        }
    }

    /// One boundary held all round never leaks, whatever the chordae are: a valve of which nobody said where its annulus is.
    #[test]
    fn chordae_need_a_free_margin() {
        let mut scene = patch(5);
        assert!(told(&built(&scene).warnings, "annulus", "no free margin"));
        scene.chordae = skirt().chordae;
        assert!(told(&faults(&scene), "annulus", "no free margin for the chordae"));
    }

    #[test]
    fn a_gap_is_told_with_its_size() {
        let mut scene = skirt();
        mark(&mut scene);
        mesh(&mut scene, 1).annulus_points.as_mut().unwrap().remove(8);
        // Point 8 of the posterior leaflet is column 18, mid-posterior; the gap runs from column 17 to 19.
        let size = 2.0 * (Vec3::from(skirt_point(18, 0)) - Vec3::from(skirt_point(17, 0))).norm();
        assert!(told(
            &faults(&scene),
            "annulus_points",
            &format!("open; 1 gaps, the longest {size:.2} mm")
        ));
    }

    #[test]
    fn marks_inside_and_on_two_loops_are_told() {
        let mut scene = skirt();
        mark(&mut scene);
        mesh(&mut scene, 0)
            .annulus_points
            .as_mut()
            .unwrap()
            .push(ROWS as u32 + 1);
        assert!(told(&faults(&scene), "annulus_points", "within the surface"));
        mesh(&mut scene, 0).annulus_points = Some(vec![0, ROWS as u32 - 1]);
        assert!(told(
            &faults(&scene),
            "annulus_points",
            "2 separate boundary loops"
        ));
        mesh(&mut scene, 0).annulus_points = Some(vec![]);
        mesh(&mut scene, 1).annulus_points = None;
        assert!(told(&faults(&scene), "annulus_points", "no support"));
    }

    #[test]
    fn a_far_curve_is_told() {
        let mut scene = skirt();
        scene.annulus.curve_mm = Some(vec![[0.0, 0.0, 50.0], [1.0, 0.0, 50.0], [0.0, 1.0, 50.0]]);
        assert!(told(&faults(&scene), "annulus.curve_mm", "no boundary point"));
    }

    #[test]
    fn a_closed_surface_has_no_support() {
        let mut scene = skirt();
        scene.leaflets.truncate(1);
        scene.chordae.clear();
        *mesh(&mut scene, 0) = SurfaceMesh {
            points_mm: vec![[0.0; 3], [20.0, 0.0, 0.0], [0.0, 20.0, 0.0], [0.0, 0.0, 20.0]],
            faces: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
            ..SurfaceMesh::default()
        };
        assert!(told(&faults(&scene), "leaflets", "no support"));
    }

    /// A square patch of 20 mm with `count` points a side.
    pub(in super::super) fn patch(count: usize) -> Scene {
        let mut scene = skirt();
        scene.leaflets.truncate(1);
        scene.chordae.clear();
        let step = 20.0 / (count - 1) as f64;
        let surface = mesh(&mut scene, 0);
        *surface = SurfaceMesh::default();
        for i in 0..count * count {
            surface
                .points_mm
                .push([step * (i % count) as f64, step * (i / count) as f64, 0.0]);
        }
        for i in (0..count * (count - 1))
            .filter(|i| i % count != count - 1)
            .map(|i| i as u32)
        {
            let up = i + count as u32;
            surface.faces.extend([[i, i + 1, up], [i + 1, up + 1, up]]);
        }
        scene
    }

    #[test]
    fn a_patch_may_be_held_in_part() {
        let mut scene = patch(5);
        mesh(&mut scene, 0).annulus_points = Some(vec![0, 1, 2, 3, 4]);
        let built = built(&scene);
        assert_eq!(built.model.annulus, [0, 1, 2, 3, 4]);
        assert!(told(
            &built.warnings,
            "annulus_points",
            "part of the only boundary"
        ));
        let [margin] = &built.model.margins[..] else {
            panic!()
        };
        assert!(!margin.closed);
        assert_eq!((margin.vertices[0], margin.vertices.last()), (4, Some(&0)));
        assert_eq!(margin.vertices.len(), 13);
    }
}

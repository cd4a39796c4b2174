//! Whether what was taken for the annulus can be it: leaflets that do not meet, chordae on the annulus, holes.

use super::annulus::{Found, positions, smallest_gap};
use super::faults::{Faults, some};
use super::surface::Surface;
use crate::Vec3;
use crate::energy::chord::WeightedVertices;
use crate::mesh::polyline;
use crate::mesh::topology::{self, Chain};

/// Without marks, the annulus is a whole boundary loop, so that leaflets must hang together: of two that only nearly
/// meet, one would be held all round and the other not at all. Parts that are no leaflets of their own are told
/// elsewhere.
pub(super) fn is_joined(surface: &Surface, loops: &[Chain], faults: &mut Faults) -> bool {
    let edges = topology::edges(&surface.faces);
    let (component, count) = topology::components(surface.faces.len(), &edges);
    let mut whole = vec![None; count];
    // A leaflet is where most of its faces are.
    for leaflet in 0..surface.face_leaflet.iter().max().map_or(0, |&last| last + 1) {
        let mut size = vec![0_usize; count];
        for face in (0..component.len()).filter(|&face| surface.face_leaflet[face] == leaflet) {
            size[component[face] as usize] += 1;
        }
        let largest = (0..count).reduce(|best, next| if size[next] > size[best] { next } else { best });
        if let Some(part) = largest.filter(|&part| size[part] > 0) {
            whole[part].get_or_insert(leaflet);
        }
    }
    let leaflets: Vec<(u32, u32)> = (0..)
        .zip(whole)
        .filter_map(|(part, l)| Some((part, l?)))
        .collect();
    let [(first, one), (_, other), ..] = leaflets[..] else {
        return true;
    };
    let mut of_first = vec![false; surface.points.len()];
    let in_first = (0..component.len()).filter(|&face| component[face] == first);
    in_first
        .flat_map(|face| surface.faces[face])
        .for_each(|v| of_first[v as usize] = true);
    let border = loops.iter().flat_map(|chain| chain.vertices.iter().copied());
    let (these, those) = border.partition(|&v| of_first[v as usize]);
    let gap = smallest_gap(surface, &[these, those]);
    let size_ratio = extent_mm(surface, one) / extent_mm(surface, other);
    let doubt = match size_ratio.max(1.0 / size_ratio) {
        ratio if ratio >= DOUBTFUL_SIZE_RATIO => {
            format!("; one is {ratio:.0} times as large as the other: check their units")
        }
        _ => String::new(),
    };
    let message = format!(
        "leaflets[{one}] and leaflets[{other}] share no points, the gap is {gap:.3} mm at the narrowest: which boundary \
         is annulus is unclear; join them at the commissures, raise `weld.tolerance_mm`, or mark the annulus{doubt}"
    );
    faults.error("leaflets", message);
    false
}

/// Leaflets of one valve are not as different in size as this [1]: one is in centimetres or inches (2.54), the other in millimetres is
/// ten or 25 times as large. Our choice.
const DOUBTFUL_SIZE_RATIO: f64 = 5.0;

/// Diagonal of the box around a leaflet [mm].
fn extent_mm(surface: &Surface, leaflet: u32) -> f64 {
    let faces = surface.faces.iter().zip(&surface.face_leaflet);
    let of_leaflet = faces.filter(|(_, of)| **of == leaflet);
    let points = of_leaflet.flat_map(|(face, _)| face.map(|vertex| surface.points[vertex as usize]));
    let none = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    let (low, high) = points.fold(none, |(low, high), point| (low.inf(&point), high.sup(&point)));
    (high - low).norm()
}

/// Chordae insert in leaflets; where they insert in the annulus, the free margin has been taken for it.
pub(crate) fn check_insertions(
    surface: &Surface,
    found: &Found,
    chord_points: &[WeightedVertices],
    faults: &mut Faults,
) {
    let mut held = found.annulus.vertices.clone();
    held.sort_unstable();
    let leaflet_vertex = |&&(vertex, _): &&(u32, f64)| (vertex as usize) < surface.points.len();
    let heaviest = |point: &WeightedVertices| {
        point
            .iter()
            .filter(leaflet_vertex)
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .map(|p| p.0)
    };
    let mut inserted: Vec<u32> = chord_points.iter().filter_map(heaviest).collect();
    inserted.sort_unstable();
    inserted.dedup();
    let on_annulus: Vec<u32> = inserted
        .iter()
        .filter(|&v| held.binary_search(v).is_ok())
        .copied()
        .collect();
    // A patch that is held all round has nowhere else to insert.
    if on_annulus.is_empty() || held.len() == surface.points.len() {
        return;
    }
    let names = some(on_annulus.iter().map(|&v| surface.point_name(v)));
    let message = format!(
        "{} of {} points where chordae insert are annulus, which is held: {names}",
        on_annulus.len(),
        inserted.len()
    );
    if on_annulus.len() == inserted.len() {
        let advice = "the free margin seems to be taken for the annulus; check the side of the papillary tips and the \
                      axes (LPS/RAS?), or mark the annulus";
        faults.error("annulus", format!("{message}; {advice}"));
    } else {
        faults.warning("annulus", message);
    }
}

/// Besides annulus and free margin, a boundary is a hole; the longest is taken for the margin.
pub(crate) fn tell_holes(surface: &Surface, found: &Found, loops: &[Chain], faults: &mut Faults) {
    let others = loops
        .iter()
        .filter(|chain| !chain.vertices.iter().any(|v| found.ring.contains(v)));
    let mut around: Vec<(f64, u32)> = others
        .map(|chain| {
            (
                polyline::length(&positions(surface, &chain.vertices), true),
                chain.vertices[0],
            )
        })
        .collect();
    around.sort_by(|a, b| b.0.total_cmp(&a.0));
    if let [_, (length, vertex), ref rest @ ..] = around[..] {
        let more = if rest.is_empty() {
            String::new()
        } else {
            format!(" ({} such)", rest.len() + 1)
        };
        let message = format!(
            "a hole of {length:.1} mm circumference begins here, besides annulus and free margin{more}; it counts as leak"
        );
        faults.warning(surface.point_name(vertex), message);
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{ROWS, built, faults, lines, mesh, skirt, skirt_point, told};

    /// One in centimetres; the posterior leaflet is 1.2 times as large as the anterior one.
    #[test]
    fn leaflets_in_two_units_are_told() {
        let mut scene = skirt();
        let points = &mut mesh(&mut scene, 0).points_mm;
        points.iter_mut().flatten().for_each(|x| *x *= 0.1);
        assert!(told(
            &faults(&scene),
            "leaflets",
            "one is 12 times as large as the other: check their units"
        ));
    }

    #[test]
    fn leaflets_that_nearly_meet_are_told_with_the_gap() {
        let mut scene = skirt();
        mesh(&mut scene, 0)
            .points_mm
            .iter_mut()
            .for_each(|point| point[2] += 0.25);
        // Both ends are shifted alike, so that the gap is the shift.
        assert!(told(
            &faults(&scene),
            "leaflets",
            "share no points, the gap is 0.250 mm"
        ));
        scene.weld.tolerance_mm = 0.3;
        assert!(built(&scene).model.margins[0].closed);
    }

    #[test]
    fn tips_above_the_valve_are_told_by_the_chordae() {
        let mut scene = skirt();
        for muscle in &mut scene.papillary {
            muscle.tips_mm[0][2] = 40.0;
        }
        for point in [0, 4] {
            lines(&mut scene).points_mm[point][2] = 40.0;
            lines(&mut scene).points_mm[point + 1][2] = 20.0;
        }
        assert!(told(
            &faults(&scene),
            "annulus",
            "4 of 4 points where chordae insert are annulus"
        ));
        // A single one may be a slip of the hand.
        let mut scene = skirt();
        lines(&mut scene).points_mm[2] = skirt_point(11, 0);
        assert!(told(
            &built(&scene).warnings,
            "annulus",
            "1 of 4 points where chordae insert"
        ));
    }

    #[test]
    fn a_hole_is_told_with_its_circumference() {
        let mut scene = skirt();
        // The skirt has two rows of faces; a third below makes room for a hole that touches neither boundary.
        for (leaflet, first, last) in [(0, 2, 10), (1, 10, 26)] {
            let surface = mesh(&mut scene, leaflet);
            let count = surface.points_mm.len() as u32;
            surface
                .points_mm
                .extend((first..=last).map(|column| skirt_point(column, ROWS)));
            for column in 0..(last - first) as u32 {
                let (top, next) = (column * ROWS as u32 + 2, column * ROWS as u32 + 5);
                let (low, low_next) = (count + column, count + column + 1);
                surface.faces.extend([[top, next, low], [next, low_next, low]]);
            }
        }
        assert!(
            built(&scene)
                .warnings
                .iter()
                .all(|fault| !fault.message.contains("hole"))
        );
        // Two faces that share an edge between rows 1 and 2.
        mesh(&mut scene, 1).faces.drain(18..20);
        let around = |corners: [(usize, usize); 4]| -> f64 {
            let at = |(column, row)| crate::Vec3::from(skirt_point(column, row));
            (0..4)
                .map(|i| (at(corners[i]) - at(corners[(i + 1) % 4])).norm())
                .sum()
        };
        let length = around([(14, 1), (15, 1), (15, 2), (14, 2)]);
        let words = format!("a hole of {length:.1} mm circumference");
        assert!(told(&built(&scene).warnings, "leaflets[1].mesh point", &words));
    }
}

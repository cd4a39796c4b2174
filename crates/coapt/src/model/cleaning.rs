//! Takes out of the surface what is no surface, and refuses what cannot be one; every change is told.

use std::collections::{BTreeMap, BTreeSet};

use super::faults::{Faults, some};
use super::near_points;
use super::surface::Surface;
use crate::Vec3;
use crate::mesh::topology::{self, Edges};

/// Faces are slivers above this ratio of longest side to height, or below this smallest angle [degree]
/// (our choice: beyond them spring stiffnesses, which go with area over length squared, differ by 100 or more).
const SLIVER_ASPECT: f64 = 20.0;
const SLIVER_ANGLE_DEGREES: f64 = 5.0;

/// Drops faces that are none; opposite twins and holes that a dropped face would leave are errors.
pub(crate) fn clean(surface: &mut Surface, faults: &mut Faults) {
    let leaflets_before = surface.face_leaflet.clone();
    let repeated = |f: &[u32; 3]| f[0] == f[1] || f[1] == f[2] || f[2] == f[0];
    drop_faces(surface, |_, face| repeated(face), "use a point twice", faults);
    let twins = twins(surface, faults);
    drop_faces(
        surface,
        |number, _| twins[number],
        "repeat another triangle",
        faults,
    );
    let flat = flat_faces(surface, faults);
    drop_faces(surface, |number, _| flat[number], "have no area", faults);
    if surface.faces.is_empty() {
        faults.error("leaflets", "no triangle is left");
    } else {
        refuse_lost_leaflets(surface, &leaflets_before, faults);
    }
    compact(surface);
}

/// A valve without one of its leaflets is another valve.
fn refuse_lost_leaflets(surface: &Surface, leaflets_before: &[u32], faults: &mut Faults) {
    let left: BTreeSet<u32> = surface.face_leaflet.iter().copied().collect();
    let lost = leaflets_before.iter().copied().collect::<BTreeSet<u32>>();
    for leaflet in lost.difference(&left) {
        let message =
            "not one of its triangles is left; is it the same surface as another leaflet, or a point?";
        faults.error(format!("leaflets[{leaflet}].mesh"), message);
    }
}

fn drop_faces(surface: &mut Surface, bad: impl Fn(usize, &[u32; 3]) -> bool, why: &str, faults: &mut Faults) {
    let keep: Vec<bool> = surface
        .faces
        .iter()
        .enumerate()
        .map(|(n, face)| !bad(n, face))
        .collect();
    if let Some(first) = keep.iter().position(|&k| !k) {
        let count = keep.iter().filter(|&&k| !k).count();
        faults.warning(
            surface.face_name(first),
            format!("triangles that {why} are left out ({count} such)"),
        );
        surface.keep_faces(&keep);
    }
}

/// Faces with the same three vertices as an earlier one: flagged if wound alike, an error if not.
fn twins(surface: &Surface, faults: &mut Faults) -> Vec<bool> {
    let mut first_of: BTreeMap<[u32; 3], usize> = BTreeMap::new();
    let from_lowest = |f: [u32; 3]| {
        let place = (0..3).min_by_key(|&i| f[i]).unwrap_or(0);
        [f[place], f[(place + 1) % 3], f[(place + 2) % 3]]
    };
    let mut twins = vec![false; surface.faces.len()];
    for (number, &face) in surface.faces.iter().enumerate() {
        let mut key = face;
        key.sort_unstable();
        let first = *first_of.entry(key).or_insert(number);
        let alike = from_lowest(surface.faces[first]) == from_lowest(face);
        if !alike {
            let message = format!(
                "is the back of {}; which side is meant is unclear",
                surface.face_name(first)
            );
            faults.error(surface.face_name(number), message);
        }
        twins[number] = alike && first != number;
    }
    twins
}

/// Flags faces without area that have a side on the border. One within the surface would leave a slit.
fn flat_faces(surface: &Surface, faults: &mut Faults) -> Vec<bool> {
    let mut flat: Vec<bool> = (0..surface.faces.len())
        .map(|f| height(surface.corners(f)).is_none())
        .collect();
    if !flat.contains(&true) {
        return flat;
    }
    let edges = topology::edges(&surface.faces);
    let mut border = vec![false; surface.faces.len()];
    for edge in 0..edges.len() {
        if let [face] = *edges.faces_of(edge) {
            border[face as usize] = true;
        }
    }
    for face in 0..flat.len() {
        if flat[face] && !border[face] {
            faults.error(
                surface.face_name(face),
                "has no area, and without it the surface would have a slit",
            );
            flat[face] = false;
        }
    }
    flat
}

/// Longest side and the height over it; nothing if the height drowns in rounding.
fn height([a, b, c]: [Vec3; 3]) -> Option<(f64, f64)> {
    let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
    let height = (b - a).cross(&(c - a)).norm() / longest;
    (height > 1e-10 * longest).then_some((longest, height))
}

/// Drops vertices that no face uses any more.
fn compact(surface: &mut Surface) {
    let mut number = vec![u32::MAX; surface.points.len()];
    surface
        .faces
        .iter()
        .flatten()
        .for_each(|&v| number[v as usize] = 0);
    for (count, slot) in number.iter_mut().filter(|slot| **slot == 0).enumerate() {
        *slot = count as u32;
    }
    let used = |v: usize| number[v] != u32::MAX;
    let marked = surface.marked.take();
    surface.marked = marked.map(|m| (0..m.len()).filter(|&v| used(v)).map(|v| m[v]).collect());
    let kept: Vec<usize> = (0..number.len()).filter(|&v| used(v)).collect();
    surface.points = kept.iter().map(|&v| surface.points[v]).collect();
    surface.point_source = kept.iter().map(|&v| surface.point_source[v]).collect();
    surface.displacement = kept.iter().map(|&v| surface.displacement[v]).collect();
    surface
        .faces
        .iter_mut()
        .flatten()
        .for_each(|v| *v = number[*v as usize]);
}

/// Where several leaflets meet in nothing but one point, they most likely only touch there.
fn touching_leaflets(surface: &Surface, vertex: u32) -> String {
    let faces = surface.faces.iter().zip(&surface.face_leaflet);
    let mut leaflets: Vec<u32> = faces
        .filter(|(face, _)| face.contains(&vertex))
        .map(|(_, &leaflet)| leaflet)
        .collect();
    leaflets.sort_unstable();
    leaflets.dedup();
    if leaflets.len() < 2 {
        return String::new();
    }
    let names: Vec<String> = leaflets
        .iter()
        .map(|leaflet| format!("leaflets[{leaflet}]"))
        .collect();
    let [x, y, z] = surface.points[vertex as usize].into();
    format!(
        "; {} have that one point at ({x:.2}, {y:.2}, {z:.2}) mm in common: if they only touch there, move them apart by more than \
         `weld.tolerance_mm`",
        names.join(" and ")
    )
}

/// Refuses what is no surface, tells of slivers, makes neighbours wind alike.
pub(crate) fn check_shape(surface: &mut Surface, faults: &mut Faults) -> Edges {
    let edges = topology::edges(&surface.faces);
    slivers(surface, faults);
    let crowded: Vec<usize> = (0..edges.len())
        .filter(|&e| edges.faces_of(e).len() > 2)
        .collect();
    if let Some(&first) = crowded.first() {
        let [a, b] = edges.ends[first].map(|v| surface.point_name(v));
        let count = edges.faces_of(first).len();
        let message = format!(
            "{count} triangles share the edge to {b}, expected 2 ({} such edges)",
            crowded.len()
        );
        faults.error(a, message);
        return edges;
    }
    let pinched = topology::pinched_vertices(&surface.faces, &edges, surface.points.len());
    if let Some(&first) = pinched.first() {
        let message = "the surface hangs together by single points: ".to_string()
            + &some(pinched.iter().map(|&v| surface.point_name(v)))
            + &touching_leaflets(surface, first)
            + &near_points::advice(surface, &edges);
        faults.error(surface.point_name(first), message);
    }
    match topology::orient(&mut surface.faces, &edges) {
        Ok(turned) if turned.is_empty() => {}
        Ok(turned) => {
            let names = some(turned.iter().map(|&f| surface.face_name(f as usize)));
            faults.warning(
                "leaflets",
                format!(
                    "{} triangles wound against their neighbours are turned: {names}",
                    turned.len()
                ),
            );
        }
        Err([a, b]) => {
            let message = format!(
                "the surface has one side only; its winding cannot agree at the edge to {}",
                surface.point_name(b)
            );
            faults.error(surface.point_name(a), message);
        }
    }
    edges
}

fn slivers(surface: &Surface, faults: &mut Faults) {
    let mut worst: Option<(usize, f64, f64)> = None;
    let mut count = 0;
    for face in 0..surface.faces.len() {
        let corners = surface.corners(face);
        let Some((longest, height)) = height(corners) else {
            continue;
        };
        let (aspect, angle) = (longest / height, smallest_angle(corners));
        if aspect > SLIVER_ASPECT || angle < SLIVER_ANGLE_DEGREES {
            count += 1;
            if worst.is_none_or(|(_, most, _)| aspect > most) {
                worst = Some((face, aspect, angle));
            }
        }
    }
    if let Some((face, aspect, angle)) = worst {
        let message = format!(
            "{count} slivers; this one is worst: aspect {aspect:.0}, smallest angle {angle:.2} degrees (expected \
             below {SLIVER_ASPECT} and above {SLIVER_ANGLE_DEGREES})"
        );
        faults.warning(surface.face_name(face), message);
    }
}

fn smallest_angle(corners: [Vec3; 3]) -> f64 {
    let angle = |i: usize| {
        let [a, b, c] = [0, 1, 2].map(|step| corners[(i + step) % 3]);
        (b - a).angle(&(c - a))
    };
    angle(0).min(angle(1)).min(angle(2)).to_degrees()
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{COLUMNS, ROWS, built, faults, mesh, skirt, told};

    #[test]
    fn a_triangle_soup_is_welded() {
        let mut scene = skirt();
        let surface = mesh(&mut scene, 0);
        let soup: Vec<[f64; 3]> = surface
            .faces
            .iter()
            .flatten()
            .map(|&v| surface.points_mm[v as usize])
            .collect();
        surface.faces = (0..soup.len() as u32 / 3)
            .map(|f| [3 * f, 3 * f + 1, 3 * f + 2])
            .collect();
        surface.points_mm = soup;
        let built = built(&scene);
        assert_eq!(built.model.leaflet_vertex_count, COLUMNS * ROWS);
        assert!(told(&built.warnings, "leaflets[0].mesh", "are welded"));
    }

    #[test]
    fn useless_points_and_faces_are_left_out() {
        let mut scene = skirt();
        let surface = mesh(&mut scene, 0);
        surface.points_mm.push([0.0; 3]);
        let twin = surface.faces[3];
        surface.faces.extend([[0, 0, 1], [twin[1], twin[2], twin[0]]]);
        let built = built(&scene);
        assert_eq!(built.model.faces.len(), COLUMNS * (ROWS - 1) * 2);
        assert!(told(
            &built.warnings,
            "leaflets[0].mesh",
            "1 points belong to no triangle"
        ));
        assert!(told(
            &built.warnings,
            "leaflets[0].mesh face 32",
            "use a point twice"
        ));
        assert!(told(
            &built.warnings,
            "leaflets[0].mesh face 33",
            "repeat another"
        ));
    }

    #[test]
    fn a_leaflet_that_is_another_one_is_refused() {
        let mut scene = skirt();
        let copy = mesh(&mut scene, 0).clone();
        *mesh(&mut scene, 1) = copy;
        assert!(told(
            &faults(&scene),
            "leaflets[1].mesh",
            "not one of its triangles is left"
        ));
    }

    #[test]
    fn an_opposite_twin_is_refused() {
        let mut scene = skirt();
        let [a, b, c] = mesh(&mut scene, 0).faces[3];
        mesh(&mut scene, 0).faces.push([a, c, b]);
        assert!(told(
            &faults(&scene),
            "leaflets[0].mesh face 32",
            "back of leaflets[0].mesh face 3"
        ));
    }

    #[test]
    fn flat_faces_go_from_the_border_and_stay_refused_inside() {
        // A point halfway along a margin edge, with a triangle of no area over it: gone without a trace.
        let mut scene = skirt();
        let surface = mesh(&mut scene, 1);
        let (a, b) = (ROWS as u32 - 1 + 3, ROWS as u32 - 1 + 6);
        let middle =
            [0, 1, 2].map(|i| 0.5 * (surface.points_mm[a as usize][i] + surface.points_mm[b as usize][i]));
        surface.points_mm.push(middle);
        let new = surface.points_mm.len() as u32 - 1;
        surface.faces.push([a, b, new]);
        let done = built(&scene);
        assert_eq!(done.model.leaflet_vertex_count, COLUMNS * ROWS);
        assert!(told(&done.warnings, "leaflets[1].mesh face 64", "have no area"));
        // The same within the surface, its neighbours holding on to the middle point.
        let mut scene = skirt();
        let surface = mesh(&mut scene, 1);
        let face = surface.faces.iter().position(|f| *f == [3, 6, 4]).unwrap();
        let middle = [0, 1, 2].map(|i| 0.5 * (surface.points_mm[6][i] + surface.points_mm[4][i]));
        surface.points_mm.push(middle);
        let new = surface.points_mm.len() as u32 - 1;
        surface.faces[face] = [3, 6, new];
        surface.faces.extend([[3, new, 4], [6, 4, new]]);
        assert!(told(&faults(&scene), "leaflets[1].mesh face 65", "slit"));
    }

    #[test]
    fn slivers_are_counted() {
        let mut scene = skirt();
        let surface = mesh(&mut scene, 1);
        surface.points_mm[4] = surface.points_mm[3];
        surface.points_mm[4][2] -= 0.05;
        assert!(told(&built(&scene).warnings, "leaflets[1].mesh face", "slivers"));
    }

    #[test]
    fn crowded_edges_and_pinched_points_are_refused() {
        let mut scene = skirt();
        let surface = mesh(&mut scene, 0);
        surface.points_mm.push([0.0, 0.0, -3.0]);
        let new = surface.points_mm.len() as u32 - 1;
        surface.faces.push([3, 4, new]);
        assert!(told(
            &faults(&scene),
            "leaflets[0].mesh point 3",
            "3 triangles share the edge"
        ));
        let mut scene = skirt();
        let surface = mesh(&mut scene, 0);
        surface.points_mm.extend([[0.0, 0.0, -3.0], [1.0, 0.0, -3.0]]);
        surface.faces.push([5, new, new + 1]);
        assert!(told(&faults(&scene), "leaflets[0].mesh point 5", "single points"));
    }

    #[test]
    fn a_wrongly_wound_face_is_turned() {
        let mut scene = skirt();
        mesh(&mut scene, 0).faces[9].swap(0, 1);
        let done = built(&scene);
        assert!(told(&done.warnings, "leaflets", "1 triangles wound against"));
        assert!(told(&done.warnings, "leaflets", "leaflets[0].mesh face 9"));
    }
}

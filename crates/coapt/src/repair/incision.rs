//! Faces divided along lines, so that what lies on either side of a line can be taken apart exactly there.
//!
//! A line is where a number given at every vertex passes zero, running linearly within faces. Vertices near a line are first
//! moved onto it along their edges, so that no slivers arise: a face's height over an edge shrinks by [`SNAP`] at most.

use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

use crate::Vec3;
use crate::mesh::topology::{self, Edges};
use crate::model::Model;

/// A vertex goes to the line if that crosses one of its edges within this part of the edge [1]. With 0.1 slivers of a tenth of
/// an edge are left, beyond 0.4 whole rows of vertices move and bend what is flat; our choice.
const SNAP: f64 = 0.25;

/// Triangles and where they are.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Mesh {
    /// Places [mm], shape `[vertex]`.
    pub(super) points_mm: Vec<Vec3>,
    /// Triangles, shape `[face]`.
    pub(super) faces: Vec<[u32; 3]>,
    /// The leaflet of each, shape `[face]`.
    pub(super) face_leaflet: Vec<u32>,
}

impl Mesh {
    /// The leaflets of a model, unloaded.
    pub(super) fn of(model: &Model) -> Self {
        Self {
            points_mm: model.rest_mm[..model.leaflet_vertex_count].to_vec(),
            faces: model.faces.clone(),
            face_leaflet: model.face_leaflet.clone(),
        }
    }
}

/// Numbers at the vertices, shape `[line][vertex]`; what is to be cut out lies where all are negative. Not a number where no
/// line is to go.
pub(super) type Fields = Vec<Vec<f64>>;

/// Divides faces along the border of the region where all fields are negative. New vertices come after the old ones; those of
/// `fixed` are not moved.
pub(super) fn incise(mesh: &mut Mesh, fields: &mut Fields, fixed: &[bool]) {
    for line in 0..fields.len() {
        incise_along(mesh, fields, fixed, line);
    }
}

/// The same along one of the lines only, as far as it is the region's border.
pub(super) fn incise_along(mesh: &mut Mesh, fields: &mut Fields, fixed: &[bool], line: usize) {
    snap(mesh, fields, fixed, line);
    divide(mesh, fields, line);
}

/// How a line crosses an edge, as share of the edge from its first end, and the largest of the other fields there.
fn crossing(fields: &Fields, line: usize, [a, b]: [u32; 2]) -> Option<(f64, f64)> {
    let [fa, fb] = [a, b].map(|v| fields[line][v as usize]);
    // Not a number on either end is no crossing.
    if (fa * fb).partial_cmp(&0.0) != Some(Ordering::Less) {
        return None;
    }
    let share = fa / (fa - fb);
    let others = (0..fields.len()).filter(|&other| other != line);
    let at = others.map(|other| mixed(&fields[other], [a, b], share));
    at.map(|value| if value.is_nan() { f64::INFINITY } else { value })
        .reduce(f64::max)
        .map(|most| (share, most))
        .or(Some((share, f64::NEG_INFINITY)))
}

fn mixed(field: &[f64], [a, b]: [u32; 2], share: f64) -> f64 {
    let [fa, fb] = [a, b].map(|v| field[v as usize]);
    // Exactly zero between two zeros, so that a vertex on two lines stays on both.
    fa * (1.0 - share) + fb * share
}

/// The edges to be divided along a line: those that it crosses on the border of the region, and one more beyond each corner, so
/// that the corner comes to lie on an edge, where the next line finds it.
fn to_divide(mesh: &Mesh, edges: &Edges, fields: &Fields, line: usize) -> BTreeMap<usize, f64> {
    let found = (0..edges.len()).map(|edge| crossing(fields, line, edges.ends[edge]));
    let found: Vec<Option<(f64, f64)>> = found.collect();
    let begins_at = |v: u32| {
        let on_line = fields[line][v as usize] == 0.0;
        on_line && (0..fields.len()).all(|other| other == line || fields[other][v as usize] < 0.0)
    };
    let mut in_region: Vec<bool> = mesh
        .faces
        .iter()
        .map(|face| face.iter().any(|&v| begins_at(v)))
        .collect();
    for (edge, crossed) in found.iter().enumerate() {
        if crossed.is_some_and(|(_, others)| others <= 0.0) {
            edges
                .faces_of(edge)
                .iter()
                .for_each(|&face| in_region[face as usize] = true);
        }
    }
    let wanted =
        |&(edge, _): &(usize, f64)| edges.faces_of(edge).iter().any(|&face| in_region[face as usize]);
    let crossed = found
        .iter()
        .enumerate()
        .filter_map(|(edge, crossed)| crossed.map(|(share, _)| (edge, share)));
    crossed.filter(wanted).collect()
}

/// Moves vertices near a line onto it: along the margin if they are on it, along lines that were cut before if on those.
fn snap(mesh: &mut Mesh, fields: &mut Fields, fixed: &[bool], line: usize) {
    let edges = topology::edges(&mesh.faces);
    let on_border: BTreeSet<u32> = (0..edges.len())
        .filter(|&edge| edges.faces_of(edge).len() == 1)
        .flat_map(|edge| edges.ends[edge])
        .collect();
    // Each round puts a vertex on the line, where it stays.
    for _ in 0..mesh.points_mm.len() {
        let mut moves: Vec<(f64, u32, u32)> = Vec::new();
        for (edge, share) in to_divide(mesh, &edges, fields, line) {
            let [a, b] = edges.ends[edge];
            for (from, to, share) in [(a, b, share), (b, a, 1.0 - share)] {
                let keeps_to_lines = (0..line)
                    .all(|other| fields[other][from as usize] != 0.0 || fields[other][to as usize] == 0.0);
                let keeps_to_border = !on_border.contains(&from) || edges.faces_of(edge).len() == 1;
                let is_free = !fixed.get(from as usize).copied().unwrap_or(false);
                if share < SNAP && keeps_to_lines && keeps_to_border && is_free {
                    moves.push((share, from, to));
                }
            }
        }
        let Some(&(share, from, to)) = moves.iter().min_by(|a, b| a.0.total_cmp(&b.0)) else {
            return;
        };
        let [place, other] = [from, to].map(|v| mesh.points_mm[v as usize]);
        mesh.points_mm[from as usize] = place.lerp(&other, share);
        for (number, field) in fields.iter_mut().enumerate() {
            field[from as usize] = if number == line {
                0.0
            } else {
                mixed(field, [from, to], share)
            };
        }
    }
}

fn divide(mesh: &mut Mesh, fields: &mut Fields, line: usize) {
    let edges = topology::edges(&mesh.faces);
    let mut middle: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    for (edge, share) in to_divide(mesh, &edges, fields, line) {
        let ends = edges.ends[edge];
        let [a, b] = ends.map(|v| mesh.points_mm[v as usize]);
        middle.insert(ends, mesh.points_mm.len() as u32);
        mesh.points_mm.push(a.lerp(&b, share));
        for (number, field) in fields.iter_mut().enumerate() {
            let value = if number == line {
                0.0
            } else {
                mixed(field, ends, share)
            };
            field.push(value);
        }
    }
    let (mut faces, mut face_leaflet) = (Vec::new(), Vec::new());
    for (&face, &leaflet) in mesh.faces.iter().zip(&mesh.face_leaflet) {
        let parts = divided(face, &middle, &mesh.points_mm);
        face_leaflet.extend(parts.iter().map(|_| leaflet));
        faces.extend(parts);
    }
    (mesh.faces, mesh.face_leaflet) = (faces, face_leaflet);
}

/// A face, one or two of whose edges may be divided, in parts.
fn divided(face: [u32; 3], middle: &BTreeMap<[u32; 2], u32>, points_mm: &[Vec3]) -> Vec<[u32; 3]> {
    let on = |a: u32, b: u32| middle.get(&[a.min(b), a.max(b)]).copied();
    let turned = [0, 1, 2].map(|k| [face[k], face[(k + 1) % 3], face[(k + 2) % 3]]);
    for [a, b, c] in turned {
        if let (Some(m), Some(n)) = (on(a, b), on(a, c)) {
            let length = |[p, q]: [u32; 2]| (points_mm[p as usize] - points_mm[q as usize]).norm();
            return match length([m, c]) <= length([b, n]) {
                true => vec![[a, m, n], [m, b, c], [m, c, n]],
                false => vec![[a, m, n], [m, b, n], [b, c, n]],
            };
        }
    }
    for [a, b, c] in turned {
        if let Some(m) = on(a, b) {
            return vec![[a, m, c], [m, b, c]];
        }
    }
    vec![face]
}

/// The faces within the region, each with all its vertices in it or on its border.
pub(super) fn inside(mesh: &Mesh, fields: &Fields) -> Vec<bool> {
    let is_inside = |face: &[u32; 3]| {
        fields.iter().all(|field| {
            let values = face.map(|v| field[v as usize]);
            values.iter().all(|&value| value <= 0.0) && values.iter().any(|&value| value < 0.0)
        })
    };
    mesh.faces.iter().map(is_inside).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sheet of 10 × 10 mm in squares of 1 mm, each cut in two.
    fn sheet() -> Mesh {
        let place = |i: u32| Vec3::new(f64::from(i % 11), f64::from(i / 11), 0.0);
        let squares = (0..100).map(|i| 11 * (i / 10) + i % 10);
        let faces: Vec<[u32; 3]> = squares
            .flat_map(|v| [[v, v + 1, v + 12], [v, v + 12, v + 11]])
            .collect();
        Mesh {
            points_mm: (0..121).map(place).collect(),
            face_leaflet: vec![0; faces.len()],
            faces,
        }
    }

    fn area(mesh: &Mesh, which: impl Fn(usize) -> bool) -> f64 {
        let areas = mesh.faces.iter().enumerate().filter(|&(face, _)| which(face));
        areas
            .map(|(_, face)| {
                let [a, b, c] = face.map(|v| mesh.points_mm[v as usize]);
                0.5 * (b - a).cross(&(c - a)).z
            })
            .sum()
    }

    /// A triangle from (2.3, 0) and (7.9, 0) to an apex within a face, at (5.2, 6.4): what is inside has exactly its area, and the
    /// sheet its own. No face has less than a twentieth of its area: snapped by a quarter, twice.
    #[test]
    fn a_triangle_is_cut_exactly() {
        let mut mesh = sheet();
        let apex = Vec3::new(5.2, 6.4, 0.0);
        let side = |foot: f64, sign: f64| {
            let along = (apex - Vec3::new(foot, 0.0, 0.0)).normalize();
            move |p: &Vec3| sign * (along.x * p.y - along.y * (p.x - foot))
        };
        let mut fields: Fields = vec![
            mesh.points_mm.iter().map(side(2.3, 1.0)).collect(),
            mesh.points_mm.iter().map(side(7.9, -1.0)).collect(),
        ];
        incise(&mut mesh, &mut fields, &[]);
        let inside = inside(&mesh, &fields);
        let found = area(&mesh, |face| inside[face]);
        assert!((found - 0.5 * 5.6 * 6.4).abs() < 1e-9, "{found}");
        assert!((area(&mesh, |_| true) - 100.0).abs() < 1e-9);
        let least = (0..mesh.faces.len())
            .map(|one| area(&mesh, |face| face == one))
            .fold(1.0, f64::min);
        assert!(least > 0.025, "{least}");
        let edges = topology::edges(&mesh.faces);
        assert!((0..edges.len()).all(|edge| edges.faces_of(edge).len() <= 2));
        let corner = (0..mesh.points_mm.len()).filter(|&v| fields.iter().all(|field| field[v] == 0.0));
        assert_eq!(
            corner
                .map(|v| (mesh.points_mm[v] - apex).norm() < 1e-9)
                .collect::<Vec<_>>(),
            [true]
        );
    }
}

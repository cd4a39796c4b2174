//! A leaflet opened along a line, and new faces set into the gap.

use std::collections::BTreeMap;

use super::incision::Mesh;
use crate::Vec3;
use crate::mesh::topology;

/// Gaps lower than this part of an edge stay closed: faces in them would be slivers [1] (our choice). What lies beyond is
/// stretched by as much.
const LEAST_GAP: f64 = 0.3;

/// Opens the leaflet along the vertices where the field is zero: those where it is negative go by `motions_mm`, vertices of the
/// line become two, and rows of new faces, about `edge_mm` high, fill what is between. At the ends of the line motions must be
/// zero. Gives the area of the new faces [mm²]; nothing where the vertices are no single line.
pub(super) fn open(
    mesh: &mut Mesh,
    leaflet: u32,
    field: &[f64],
    motions_mm: &[Vec3],
    edge_mm: f64,
) -> Option<f64> {
    let line = line(mesh, field)?;
    let beyond = |face: &[u32; 3]| face.iter().any(|&v| field[v as usize] < 0.0);
    // New faces run along the line against the faces before it.
    let forward = mesh.faces.iter().filter(|face| !beyond(face)).any(|&face| {
        let sides = topology::face_edges(face);
        sides.iter().any(|side| line.windows(2).any(|pair| pair == side))
    });
    for (v, point) in mesh.points_mm.iter_mut().enumerate() {
        if field[v] < 0.0 {
            *point += motions_mm[v];
        }
    }
    let mut columns: Vec<Vec<u32>> = Vec::new();
    for (place, &vertex) in line.iter().enumerate() {
        let mut column = vec![vertex];
        let (from, motion) = (mesh.points_mm[vertex as usize], motions_mm[vertex as usize]);
        if place > 0 && place + 1 < line.len() && motion.norm() > LEAST_GAP * edge_mm {
            let rows = (motion.norm() / edge_mm).round().max(1.0);
            for row in 1..=rows as u32 {
                column.push(mesh.points_mm.len() as u32);
                mesh.points_mm.push(from + motion * (f64::from(row) / rows));
            }
        }
        columns.push(column);
    }
    let far: BTreeMap<u32, u32> = columns
        .iter()
        .map(|column| (column[0], column[column.len() - 1]))
        .collect();
    for face in &mut mesh.faces {
        if beyond(face) {
            *face = face.map(|v| far.get(&v).copied().unwrap_or(v));
        }
    }
    let mut area_mm2 = 0.0;
    for pair in columns.windows(2) {
        for face in between(&pair[0], &pair[1], &mesh.points_mm) {
            let [a, b, c] = face.map(|v| mesh.points_mm[v as usize]);
            area_mm2 += 0.5 * (b - a).cross(&(c - a)).norm();
            mesh.faces.push(if forward {
                face
            } else {
                [face[1], face[0], face[2]]
            });
            mesh.face_leaflet.push(leaflet);
        }
    }
    Some(area_mm2)
}

/// The vertices of the line in order; nothing where they are not a single one of three vertices at least.
fn line(mesh: &Mesh, field: &[f64]) -> Option<Vec<u32>> {
    let edges = topology::edges(&mesh.faces);
    let mut next: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for &[a, b] in &edges.ends {
        if field[a as usize] == 0.0 && field[b as usize] == 0.0 {
            next.entry(a).or_default().push(b);
            next.entry(b).or_default().push(a);
        }
    }
    let (&start, _) = next.iter().find(|(_, neighbours)| neighbours.len() == 1)?;
    let mut line = vec![start];
    while let Some(&to) = next[&line[line.len() - 1]]
        .iter()
        .find(|&&v| line.len() < 2 || v != line[line.len() - 2])
    {
        if line.len() > next.len() || next[&to].len() > 2 {
            return None;
        }
        line.push(to);
    }
    (line.len() == next.len() && line.len() > 2).then_some(line)
}

/// Faces between two columns of vertices, by the shorter diagonal each time; they run up the first column and down the second.
fn between(one: &[u32], other: &[u32], points_mm: &[Vec3]) -> Vec<[u32; 3]> {
    let length = |a: u32, b: u32| (points_mm[a as usize] - points_mm[b as usize]).norm();
    let (mut i, mut j) = (0, 0);
    let mut faces = Vec::new();
    while i + 1 < one.len() || j + 1 < other.len() {
        let first_goes_on = match (one.get(i + 1), other.get(j + 1)) {
            (Some(&up), Some(&along)) => length(up, other[j]) <= length(one[i], along),
            (up, _) => up.is_some(),
        };
        if first_goes_on {
            faces.push([one[i], one[i + 1], other[j]]);
            i += 1;
        } else {
            faces.push([one[i], other[j + 1], other[j]]);
            j += 1;
        }
    }
    faces
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sheet of 8 × 4 squares of 1 mm opened along its middle row between columns 1 and 7, by 3 mm in the middle: the gap is
    /// filled with faces that face the same way, all edges have two faces or lie on the border, and areas add up.
    #[test]
    fn a_gap_is_filled() {
        let place = |i: u32| Vec3::new(f64::from(i % 9), f64::from(i / 9), 0.0);
        let squares = (0..32).map(|i| 9 * (i / 8) + i % 8);
        let faces: Vec<[u32; 3]> = squares
            .flat_map(|v| [[v, v + 1, v + 10], [v, v + 10, v + 9]])
            .collect();
        let mut mesh = Mesh {
            points_mm: (0..45).map(place).collect(),
            face_leaflet: vec![0; faces.len()],
            faces,
        };
        let field: Vec<f64> = (0..45)
            .map(|i| match (i / 9, i % 9) {
                (2, 1..=7) => 0.0,
                (2, _) => 1.0,
                (row, _) => 2.0 - f64::from(row),
            })
            .collect();
        let width = |i: u32| (3.0 - (f64::from(i % 9) - 4.0).abs()).max(0.0);
        let motions: Vec<Vec3> = (0..45).map(|i| Vec3::new(0.0, width(i), 0.0)).collect();
        let opened_mm2 = open(&mut mesh, 0, &field, &motions, 1.0).unwrap();
        // Trapezia under 0, 1, 2, 3, 2, 1, 0.
        assert!((opened_mm2 - 9.0).abs() < 1e-12, "{opened_mm2}");
        let mut area = 0.0;
        for face in &mesh.faces {
            let [a, b, c] = face.map(|v| mesh.points_mm[v as usize]);
            let twice = (b - a).cross(&(c - a)).z;
            assert!(twice > 1e-9, "{face:?}");
            area += 0.5 * twice;
        }
        assert!((area - 41.0).abs() < 1e-9, "{area}");
        let edges = topology::edges(&mesh.faces);
        assert_eq!(topology::boundary_edges(&mesh.faces, &edges).len(), 24);
        assert!((0..edges.len()).all(|edge| edges.faces_of(edge).len() <= 2));
    }
}

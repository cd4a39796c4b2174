//! Better-shaped triangles: edges are flipped to be Delaunay in space, vertices slide on the surface.

use super::skirt::{Place, Sheet};
use super::surface::Surface;
use crate::Vec3;

/// No neighbour: a boundary edge.
const NONE: u32 = u32::MAX;
/// Rounds of flipping and sliding, and sweeps of sliding in each. Our choice: more changes nothing visible.
const ROUNDS: usize = 5;
const SWEEPS: usize = 3;
/// Margin edges longer than this, over the mean edge, are halved. Our choice: the halves are no shorter than
/// the others.
const LONG_MARGIN_EDGE: f64 = 1.5;
/// Shape from which on a vertex no longer needs its worst triangle to improve, only the sum.
const GOOD_SHAPE: f64 = 0.8;

/// Flips edges and slides vertices until the triangles are well shaped.
pub(super) fn improve(sheet: &mut Sheet, surface: &Surface) {
    let turn_mm = surface.annulus.length_mm;
    split_margin(sheet, surface);
    let mut neighbours = face_neighbours(&sheet.faces);
    for _ in 0..ROUNDS {
        flip_edges(sheet, &mut neighbours, turn_mm);
        let fans = vertex_faces(sheet);
        for _ in 0..SWEEPS {
            slide_vertices(sheet, &fans, surface);
        }
    }
    flip_edges(sheet, &mut neighbours, turn_mm);
}

/// Halves long margin edges. Columns stand evenly along the annulus, so where the margin is steep its edges
/// are long, and sliding alone cannot mend that.
fn split_margin(sheet: &mut Sheet, surface: &Surface) {
    let areas = sheet.faces.iter().map(|face| {
        let [a, b, c] = face.map(|v| sheet.points_mm[v as usize]);
        0.5 * (b - a).cross(&(c - a)).norm()
    });
    // Edge of the equilateral triangle of mean area.
    let edge_mm = (areas.sum::<f64>() / sheet.faces.len() as f64 * 4.0 / 3.0_f64.sqrt()).sqrt();
    let neighbours = face_neighbours(&sheet.faces);
    for (face, across) in neighbours.iter().enumerate() {
        for (corner, &beyond) in across.iter().enumerate() {
            let (a, b, c) = rotated(sheet.faces[face], corner);
            let length = (sheet.points_mm[b as usize] - sheet.points_mm[c as usize]).norm();
            let hinge =
                sheet.place[b as usize] == Place::Annulus || sheet.place[c as usize] == Place::Annulus;
            if beyond == NONE && !hinge && length > LONG_MARGIN_EDGE * edge_mm {
                let middle = add_margin_vertex(sheet, surface, b, c);
                sheet.faces[face] = [a, b, middle];
                sheet.faces.push([a, middle, c]);
                sheet.sides.push(sheet.sides[face]);
                break;
            }
        }
    }
}

/// A vertex on the margin midway between two others.
fn add_margin_vertex(sheet: &mut Sheet, surface: &Surface, b: u32, c: u32) -> u32 {
    let (from, to) = (sheet.arc_mm[b as usize], sheet.arc_mm[c as usize]);
    let arc_mm = from + 0.5 * wrapped(to - from, surface.annulus.length_mm);
    let depth_mm = surface.height_mm(arc_mm);
    sheet.arc_mm.push(arc_mm);
    sheet.depth_mm.push(depth_mm);
    sheet.place.push(Place::Margin);
    sheet.points_mm.push(surface.at(arc_mm, depth_mm));
    sheet.points_mm.len() as u32 - 1
}

/// Shape of a triangle: 1 equilateral, 0 degenerate (mean ratio).
fn shape([a, b, c]: [Vec3; 3]) -> f64 {
    let squares = (b - a).norm_squared() + (c - b).norm_squared() + (a - c).norm_squared();
    2.0 * 3.0_f64.sqrt() * (b - a).cross(&(c - a)).norm() / squares
}

/// The face across each edge, shape `[face]`; entry i lies opposite corner i.
fn face_neighbours(faces: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut edges: Vec<[u32; 4]> = Vec::with_capacity(3 * faces.len());
    for (f, face) in faces.iter().enumerate() {
        for i in 0..3 {
            let (p, q) = (face[(i + 1) % 3], face[(i + 2) % 3]);
            edges.push([p.min(q), p.max(q), f as u32, i as u32]);
        }
    }
    edges.sort_unstable();
    let mut neighbours = vec![[NONE; 3]; faces.len()];
    for pair in edges.windows(2) {
        if pair[0][..2] == pair[1][..2] {
            neighbours[pair[0][2] as usize][pair[0][3] as usize] = pair[1][2];
            neighbours[pair[1][2] as usize][pair[1][3] as usize] = pair[0][2];
        }
    }
    neighbours
}

/// Flips until every edge inside a leaflet is Delaunay.
fn flip_edges(sheet: &mut Sheet, neighbours: &mut [[u32; 3]], turn_mm: f64) {
    // Flipping ends by itself in the plane; the bound is for a curved surface.
    for _ in 0..20 {
        let mut flips = 0;
        for face in 0..sheet.faces.len() {
            for corner in 0..3 {
                if let Some(across) = flippable(sheet, neighbours, turn_mm, face, corner) {
                    flip(sheet, neighbours, face, corner, across);
                    flips += 1;
                }
            }
        }
        if flips == 0 {
            break;
        }
    }
}

/// The face and its corner across an edge, where flipping that edge is allowed and helps.
fn flippable(
    sheet: &Sheet,
    neighbours: &[[u32; 3]],
    turn_mm: f64,
    face: usize,
    corner: usize,
) -> Option<(usize, usize)> {
    let other = neighbours[face][corner];
    if other == NONE || sheet.sides[other as usize] != sheet.sides[face] {
        return None;
    }
    let other = other as usize;
    let opposite = (0..3).find(|&j| neighbours[other][j] as usize == face)?;
    let (a, b, c) = rotated(sheet.faces[face], corner);
    let d = sheet.faces[other][opposite];
    let at = |v: u32| sheet.points_mm[v as usize];
    let cotangent = |p: Vec3, q: Vec3| p.dot(&q) / p.cross(&q).norm().max(f64::MIN_POSITIVE);
    let sum = cotangent(at(b) - at(a), at(c) - at(a)) + cotangent(at(b) - at(d), at(c) - at(d));
    let keeps_sense =
        signed_area(sheet, turn_mm, [a, b, d]) > 0.0 && signed_area(sheet, turn_mm, [a, d, c]) > 0.0;
    (sum < -1e-6 && keeps_sense).then_some((other, opposite))
}

fn rotated(face: [u32; 3], corner: usize) -> (u32, u32, u32) {
    (face[corner], face[(corner + 1) % 3], face[(corner + 2) % 3])
}

/// Turns the edge b-c of the faces (a, b, c) and (d, c, b) into a-d.
fn flip(
    sheet: &mut Sheet,
    neighbours: &mut [[u32; 3]],
    face: usize,
    corner: usize,
    (other, opposite): (usize, usize),
) {
    let (a, b, c) = rotated(sheet.faces[face], corner);
    let d = sheet.faces[other][opposite];
    let (_, across_b, across_c) = rotated(neighbours[face], corner);
    let (_, beyond_c, beyond_b) = rotated(neighbours[other], opposite);
    sheet.faces[face] = [a, b, d];
    sheet.faces[other] = [a, d, c];
    neighbours[face] = [beyond_c, other as u32, across_c];
    neighbours[other] = [beyond_b, across_b, face as u32];
    for (outer, before, after) in [(beyond_c, other, face), (across_b, face, other)] {
        if outer != NONE {
            for entry in &mut neighbours[outer as usize] {
                if *entry as usize == before {
                    *entry = after as u32;
                }
            }
        }
    }
}

/// Twice the area of a triangle in (arc, depth) [mm²]; positive where the normal points to the atrium.
fn signed_area(sheet: &Sheet, turn_mm: f64, [a, b, c]: [u32; 3]) -> f64 {
    let from_a = |v: u32| {
        let (v, a) = (v as usize, a as usize);
        (
            wrapped(sheet.arc_mm[v] - sheet.arc_mm[a], turn_mm),
            sheet.depth_mm[v] - sheet.depth_mm[a],
        )
    };
    let ((bx, by), (cx, cy)) = (from_a(b), from_a(c));
    by * cx - bx * cy
}

/// An arc length difference within half a turn.
fn wrapped(difference_mm: f64, turn_mm: f64) -> f64 {
    difference_mm - turn_mm * (difference_mm / turn_mm).round()
}

/// Faces around each vertex: offsets, shape `[vertex + 1]`, and the faces.
struct Fans {
    offsets: Vec<usize>,
    faces: Vec<u32>,
}

fn vertex_faces(sheet: &Sheet) -> Fans {
    let mut offsets = vec![0; sheet.points_mm.len() + 1];
    for &v in sheet.faces.as_flattened() {
        offsets[v as usize + 1] += 1;
    }
    for v in 1..offsets.len() {
        offsets[v] += offsets[v - 1];
    }
    let mut next = offsets.clone();
    let mut faces = vec![0; 3 * sheet.faces.len()];
    for (f, face) in sheet.faces.iter().enumerate() {
        for &v in face {
            faces[next[v as usize]] = f as u32;
            next[v as usize] += 1;
        }
    }
    Fans { offsets, faces }
}

/// One sweep: each vertex goes to the area-weighted middle of its triangles wherever that improves them.
fn slide_vertices(sheet: &mut Sheet, fans: &Fans, surface: &Surface) {
    let turn_mm = surface.annulus.length_mm;
    for v in 0..sheet.points_mm.len() {
        let place = sheet.place[v];
        if matches!(place, Place::Annulus | Place::Corner) {
            continue;
        }
        let fan = &fans.faces[fans.offsets[v]..fans.offsets[v + 1]];
        let (along, down) = pull(sheet, fan, v, turn_mm);
        let before = (sheet.arc_mm[v], sheet.depth_mm[v], sheet.points_mm[v]);
        let old = fan_shape(sheet, fan, turn_mm);
        for share in [1.0, 0.5, 0.25] {
            let (arc, depth) = slid(surface, place, before.0, before.1, (share * along, share * down));
            sheet.arc_mm[v] = arc;
            sheet.depth_mm[v] = depth;
            sheet.points_mm[v] = surface.at(arc, depth);
            let new = fan_shape(sheet, fan, turn_mm);
            if new.0 > old.0 || (new.0 > GOOD_SHAPE && new.1 > old.1) {
                break;
            }
            (sheet.arc_mm[v], sheet.depth_mm[v], sheet.points_mm[v]) = before;
        }
    }
}

/// Where a vertex comes to lie when it is pulled, within what its place allows.
fn slid(surface: &Surface, place: Place, arc: f64, depth: f64, (along, down): (f64, f64)) -> (f64, f64) {
    match place {
        Place::Annulus | Place::Corner => (arc, depth),
        Place::Commissure => (arc, depth + down),
        Place::Margin => (arc + along, surface.height_mm(arc + along)),
        Place::Interior => (arc + along, depth + down),
    }
}

/// From a vertex to the area-weighted middle of its triangles, in (arc, depth) [mm].
fn pull(sheet: &Sheet, fan: &[u32], v: usize, turn_mm: f64) -> (f64, f64) {
    let (mut along, mut down, mut total) = (0.0, 0.0, f64::MIN_POSITIVE);
    for &f in fan {
        let face = sheet.faces[f as usize];
        let [a, b, c] = face.map(|w| sheet.points_mm[w as usize]);
        let area = (b - a).cross(&(c - a)).norm();
        for w in face.map(|w| w as usize) {
            along += area * wrapped(sheet.arc_mm[w] - sheet.arc_mm[v], turn_mm);
            down += area * (sheet.depth_mm[w] - sheet.depth_mm[v]);
        }
        total += area;
    }
    (along / (3.0 * total), down / (3.0 * total))
}

/// Worst shape and sum of shapes around a vertex; a folded triangle counts as worse than any.
fn fan_shape(sheet: &Sheet, fan: &[u32], turn_mm: f64) -> (f64, f64) {
    let mut worst = f64::INFINITY;
    let mut sum = 0.0;
    for &f in fan {
        let face = sheet.faces[f as usize];
        let folded = signed_area(sheet, turn_mm, face) <= 0.0;
        let value = if folded {
            -1.0
        } else {
            shape(face.map(|w| sheet.points_mm[w as usize]))
        };
        worst = worst.min(value);
        sum += value;
    }
    (worst, sum)
}

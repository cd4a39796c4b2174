//! One view of a closed valve: leaflets shaded as by a lamp at the eye, chordae, rings.

use coapt::Vec3;
use coapt::measure::ValveFrame;

use super::canvas::{Canvas, Corner};
use super::colours::{Colouring, RING, TENSE};
use crate::page::geometry::Geometry;

/// Where one looks from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Direction {
    /// From the atrium, the aorta on top.
    Atrium,
    /// From the posteromedial side, the atrium on top and the aorta to the right, as a long-axis view of echo shows it.
    Side,
}

/// Edges are smoothed by drawing everything twice as large.
const LARGER: usize = 2;

/// Room about the valve.
const ROOM: f64 = 1.05;

/// Pixels of a millimetre in a view of so many pixels.
pub(super) fn pixels_per_mm(reach_mm: f64, [width, height]: [usize; 2]) -> f64 {
    width.min(height) as f64 / (2.0 * ROOM * reach_mm)
}

/// Right, up, and to the eye.
fn axes(frame: &ValveFrame, direction: Direction) -> [Vec3; 3] {
    let (atrium, anterior) = (Vec3::from(frame.to_atrium), Vec3::from(frame.to_anterior));
    match direction {
        Direction::Atrium => [anterior.cross(&atrium), anterior, atrium],
        Direction::Side => [anterior, atrium, anterior.cross(&atrium)],
    }
}

/// Draws a closed valve about the centre of its annulus, a little below it in the view from the side.
pub(super) fn drawn(
    frame: &ValveFrame,
    geometry: &Geometry,
    direction: Direction,
    colouring: &Colouring,
    reach_mm: f64,
    size: [usize; 2],
) -> Canvas {
    let [width, height] = size.map(|pixels| pixels * LARGER);
    let scale = pixels_per_mm(reach_mm, [width, height]);
    let [right, up, eye] = axes(frame, direction);
    let lowered = match direction {
        Direction::Atrium => 0.5,
        Direction::Side => 0.3,
    };
    let centre = Vec3::from(frame.centre_mm);
    let project = |point: Vec3| -> [f32; 3] {
        let from_centre = point - centre;
        [
            (width as f64 / 2.0 + from_centre.dot(&right) * scale) as f32,
            (height as f64 * lowered - from_centre.dot(&up) * scale) as f32,
            from_centre.dot(&eye) as f32,
        ]
    };
    let mut canvas = Canvas::new(width, height);
    leaflets(&mut canvas, geometry, colouring, eye, project);
    lines(&mut canvas, geometry, project);
    canvas.halved()
}

fn points(values: &[f32]) -> impl Iterator<Item = Vec3> + '_ {
    let triples = values.as_chunks::<3>().0.iter();
    triples.map(|point| Vec3::from(point.map(f64::from)))
}

fn leaflets(
    canvas: &mut Canvas,
    geometry: &Geometry,
    colouring: &Colouring,
    eye: Vec3,
    project: impl Fn(Vec3) -> [f32; 3],
) {
    let positions: Vec<Vec3> = points(&geometry.closed.0).collect();
    let faces = geometry.faces.0.as_chunks::<3>().0;
    let mut normals = vec![Vec3::zeros(); positions.len()];
    for face in faces {
        let [a, b, c] = face.map(|vertex| positions[vertex as usize]);
        let normal = (b - a).cross(&(c - a));
        for &vertex in face {
            normals[vertex as usize] += normal;
        }
    }
    for (number, face) in faces.iter().enumerate() {
        canvas.triangle(face.map(|vertex| {
            let vertex = vertex as usize;
            let facing = normals[vertex]
                .try_normalize(0.0)
                .map_or(1.0, |normal| normal.dot(&eye).abs());
            // Never quite dark: colours are to be read.
            let light = 0.45 + 0.55 * facing as f32;
            let colour = colouring.of(geometry, number, vertex);
            Corner {
                at: project(positions[vertex]),
                colour: colour.map(|part| part * light),
            }
        }));
    }
}

fn lines(canvas: &mut Canvas, geometry: &Geometry, project: impl Fn(Vec3) -> [f32; 3]) {
    if let Some(chords) = &geometry.chords {
        let ends: Vec<Vec3> = points(&chords.closed.0).collect();
        for (&[from, to], &force_n) in chords.ends.0.as_chunks::<2>().0.iter().zip(&chords.force_n.0) {
            let colour = if force_n > 0.0 {
                TENSE
            } else {
                super::colours::SLACK
            };
            let corner = |point: u32| Corner {
                at: project(ends[point as usize]),
                colour,
            };
            canvas.line([corner(from), corner(to)], 2.0);
        }
    }
    for ring in &geometry.rings {
        let along: Vec<Corner> = points(&ring.0)
            .map(|point| Corner {
                at: project(point),
                colour: RING,
            })
            .collect();
        for pair in along.windows(2) {
            canvas.line([pair[0], pair[1]], 7.0);
        }
    }
}

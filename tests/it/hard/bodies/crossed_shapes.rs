//! Spikes, wedges, cracks and cliffs pressed on each other, after the kinds of cases in Erleben 2018, "Methodology for
//! assessing mesh-based contact point methods": rebuilt from their names with shapes of our own. Each is a sheet over a
//! square of 10 mm whose rim is held.

use coapt::Vec3;
use coapt::relax::Status;

use super::assembly::{Body, Matter, assemble, height_field};
use super::{begun, uncertified};
use crate::hard::{HardCase, JITTER};
use crate::shapes::Mesh;

const HALF_MM: f64 = 5.0;
const CELLS: u32 = 8;
/// Bodies begin this far apart, as a part of their size [1]; and as far more as points may be moved.
const GAP: f64 = 1e-4;
/// The upper one comes down by a tenth of its size.
const DOWN_MM: f64 = 1.0;

/// Height over a place [mm].
type Height = fn(f64, f64) -> f64;

/// How steep they are [1].
const SLOPE: f64 = 0.6;
const STEEP: f64 = 1.2;

fn spike(x: f64, y: f64) -> f64 {
    -SLOPE * x.abs().max(y.abs())
}
fn wedge_along_y(x: f64, _: f64) -> f64 {
    -SLOPE * x.abs()
}
fn wedge_along_x(_: f64, y: f64) -> f64 {
    -SLOPE * y.abs()
}
fn flat(_: f64, _: f64) -> f64 {
    0.0
}
fn crack(x: f64, _: f64) -> f64 {
    SLOPE * x.abs()
}
fn hole(x: f64, y: f64) -> f64 {
    SLOPE * x.abs().max(y.abs())
}
/// Level on the left, and a step down just right of the middle.
fn cliff(x: f64, _: f64) -> f64 {
    -2.0 * (x / 1.25).clamp(0.0, 1.0)
}
fn opposite_cliff(x: f64, y: f64) -> f64 {
    cliff(-x, y)
}
fn plateau(x: f64, y: f64) -> f64 {
    -STEEP * (x.abs().max(y.abs()) - 2.5).max(0.0)
}
fn steep_spike(x: f64, y: f64) -> f64 {
    -STEEP * x.abs().max(y.abs())
}
fn steep_wedge(x: f64, _: f64) -> f64 {
    -STEEP * x.abs()
}

/// Which sides of the square are held.
#[derive(Clone, Copy, PartialEq)]
enum Sides {
    All,
    /// Those where |x| is greatest: gable ends of roofs along y stay free.
    LeftAndRight,
    FrontAndBack,
}
use Sides::{All, FrontAndBack, LeftAndRight};

/// A sheet: its height and where it is held.
type Shape = (Height, Sides);

/// Name, what is hard, the lower sheet, the upper one turned over, where the upper one goes besides down [mm].
const PAIRS: [(&str, &str, Shape, Shape, [f64; 2]); 14] = [
    (
        "spike on spike",
        "vertex over vertex: one slips off the other, any way",
        (spike, All),
        (spike, All),
        [0.0, 0.0],
    ),
    (
        "spike on wedge",
        "vertex over edge",
        (wedge_along_y, LeftAndRight),
        (spike, All),
        [0.0, 0.0],
    ),
    (
        "wedge on wedge, crossed",
        "edge over edge",
        (wedge_along_y, LeftAndRight),
        (wedge_along_x, FrontAndBack),
        [0.0, 0.0],
    ),
    (
        "wedge on wedge, parallel",
        "edges exactly parallel, vertices over each other",
        (wedge_along_y, LeftAndRight),
        (wedge_along_y, LeftAndRight),
        [0.0, 0.0],
    ),
    (
        "spike on sheet",
        "vertex over a vertex of a flat sheet",
        (flat, All),
        (spike, All),
        [0.0, 0.0],
    ),
    (
        "spike in a crack",
        "vertex over the edge of a valley",
        (crack, LeftAndRight),
        (steep_spike, All),
        [0.0, 0.0],
    ),
    (
        "wedge in a crack",
        "edge in the edge of a valley, exactly parallel",
        (crack, LeftAndRight),
        (steep_wedge, LeftAndRight),
        [0.0, 0.0],
    ),
    (
        "spike in a hole",
        "vertex in the apex of a pit",
        (hole, All),
        (steep_spike, All),
        [0.0, 0.0],
    ),
    (
        "cliff on cliff",
        "edges of two steps on each other, exactly parallel",
        (cliff, LeftAndRight),
        (opposite_cliff, LeftAndRight),
        [0.0, 0.0],
    ),
    (
        "cliff past cliff",
        "edge slides over edge",
        (cliff, LeftAndRight),
        (opposite_cliff, LeftAndRight),
        [-1.0, 0.0],
    ),
    (
        "plateau on sheet",
        "inner edges of equal meshes on each other",
        (flat, All),
        (plateau, All),
        [0.0, 0.0],
    ),
    (
        "sliding spike",
        "a vertex slides over inner edges",
        (flat, All),
        (spike, All),
        [3.0, 1.0],
    ),
    (
        "sliding wedge",
        "an edge slides over inner edges parallel to it",
        (flat, All),
        (wedge_along_y, LeftAndRight),
        [3.0, 0.0],
    ),
    (
        "sliding plateau",
        "inner edges slide over inner edges",
        (flat, All),
        (plateau, All),
        [2.0, 1.0],
    ),
];

pub(super) fn cases() -> Vec<HardCase> {
    let mut cases: Vec<HardCase> = PAIRS
        .into_iter()
        .map(|(name, what, lower, upper, aside)| {
            begun(name, what, move |jitter| {
                let way_mm = Vec3::new(aside[0], aside[1], -DOWN_MM);
                assemble(
                    &[below(lower), above(upper, HALF_MM, way_mm)],
                    &Matter::default(),
                    jitter,
                )
            })
        })
        .collect();
    cases.push(begun(
        "spike in a hole of its shape",
        "all faces a few 1e-4 from each other and parallel",
        |jitter| {
            let spike = above((spike, All), 0.5 * HALF_MM, -Vec3::z() * DOWN_MM);
            assemble(&[below((hole, All)), spike], &Matter::default(), jitter)
        },
    ));
    cases.push(uncertified(
        begun(
            "rims pressed through each other",
            "held points are in each other's way",
            |jitter| {
                let bodies = [
                    below((hole, All)),
                    above((spike, All), HALF_MM, -Vec3::z() * DOWN_MM),
                ];
                let (mut model, start_mm) = assemble(&bodies, &Matter::default(), jitter);
                model.settings.iteration_limit = 20;
                (model, start_mm)
            },
        ),
        &[Status::IterationLimit],
        "supports can come to where they are asked only through each other",
    ));
    cases
}

fn below((height, sides): Shape) -> Body {
    sheet(height_field(CELLS, HALF_MM, height), sides, Vec3::zeros())
}

fn above((depth, sides): Shape, half_mm: f64, way_mm: Vec3) -> Body {
    let edge_mm = 2.0 * HALF_MM / f64::from(CELLS);
    let gap_mm = GAP * 2.0 * HALF_MM + 8.0 * JITTER * edge_mm;
    let cells = (f64::from(CELLS) * half_mm / HALF_MM) as u32;
    sheet(
        height_field(cells, half_mm, |x, y| gap_mm - depth(x, y)),
        sides,
        way_mm,
    )
}

fn sheet(mesh: Mesh, sides: Sides, way_mm: Vec3) -> Body {
    let half_mm = mesh.points_mm.iter().map(|point| point.x).fold(0.0, f64::max);
    let is_at = |ordinate: f64| ordinate.abs() > half_mm - 1e-6;
    let is_held = |vertex: &u32| {
        let point = mesh.points_mm[*vertex as usize];
        match sides {
            All => true,
            LeftAndRight => is_at(point.x),
            FrontAndBack => is_at(point.y),
        }
    };
    let held = mesh.rim.iter().copied().filter(is_held).collect();
    Body {
        held,
        ..Body::sheet(mesh, way_mm)
    }
}

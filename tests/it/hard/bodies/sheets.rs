//! Sheets laid over things, drawn through things, and wound up.

use std::f64::consts::TAU;

use coapt::Vec3;
use coapt::model::Model;

use super::assembly::{Body, Matter, assemble, height_field, roof};
use super::begun;
use crate::hard::{HardCase, Jitter};
use crate::shapes::{Mesh, sphere};

pub(super) fn cases() -> Vec<HardCase> {
    vec![
        begun(
            "sheet lowered on nine knives",
            "sharp edges under a taut sheet, parallel to edges of its own",
            knives,
        ),
        begun(
            "strip twisted by 360 degrees, its ends brought together",
            "it winds up on itself",
            twisted,
        ),
        begun(
            "sheet drawn over a sphere",
            "sheet and sphere lie on each other over many parts",
            over_sphere,
        ),
        begun(
            "sheet drawn through a ring by its middle",
            "tissue gathers in folds that rub on the ring and on each other",
            through_ring,
        ),
    ]
}

fn knives(jitter: &mut Jitter) -> (Model, Vec<Vec3>) {
    let sheet = height_field(12, 10.0, |_, _| 0.0);
    let mut bodies = vec![Body::sheet(sheet, -Vec3::z() * 2.0)];
    for knife in -4..=4 {
        let x = 2.0 * f64::from(knife);
        let ridge = [Vec3::new(x, -7.0, -0.6), Vec3::new(x, 7.0, -0.6)];
        let [right, left] = [0.4, -0.4].map(|across| Vec3::new(across, 0.0, -4.0));
        bodies.push(Body::rigid(roof(ridge, right, left), Vec3::zeros()));
    }
    assemble(&bodies, &Matter::default(), jitter)
}

/// Rest is flat; it begins wound up evenly, as no straight way of its ends would wind it.
fn twisted(jitter: &mut Jitter) -> (Model, Vec<Vec3>) {
    const HALF_MM: f64 = 15.0;
    const SHORTER_MM: f64 = 6.0;
    let strip = first_rows(&height_field(20, HALF_MM, |_, _| 0.0), 20, 4);
    let ends = |side: f64| -> Vec<u32> {
        (0..strip.points_mm.len() as u32)
            .filter(|&v| side * strip.points_mm[v as usize].x > HALF_MM - 1e-6)
            .collect()
    };
    let (left, right) = (ends(-1.0), ends(1.0));
    let body = Body {
        held: [left, right.clone()].concat(),
        ..Body::free(strip)
    };
    let matter = Matter {
        plate_n_mm: 0.02,
        ..Matter::default()
    };
    let (mut model, flat_mm) = assemble(&[body], &matter, jitter);
    let start_mm: Vec<Vec3> = flat_mm
        .iter()
        .map(|x| {
            let (sin, cos) = (0.5 * TAU * (1.0 + x.x / HALF_MM)).sin_cos();
            Vec3::new(x.x, x.y * cos - x.z * sin, x.y * sin + x.z * cos)
        })
        .collect();
    for held in &mut model.prescribed {
        held.target_mm = start_mm[held.vertex as usize];
        if right.contains(&held.vertex) {
            held.target_mm.x -= SHORTER_MM;
        }
    }
    (model, start_mm)
}

/// The first rows of a square sheet of n × n cells, moved to the middle.
fn first_rows(sheet: &Mesh, n: u32, rows: u32) -> Mesh {
    let kept = (n + 1) * (rows + 1);
    let points: Vec<Vec3> = sheet.points_mm[..kept as usize].to_vec();
    let middle = 0.5 * (points[0].y + points[kept as usize - 1].y);
    Mesh {
        points_mm: points.iter().map(|x| x - Vec3::y() * middle).collect(),
        faces: sheet
            .faces
            .iter()
            .copied()
            .filter(|face| face.iter().all(|&v| v < kept))
            .collect(),
        rim: vec![],
    }
}

fn over_sphere(jitter: &mut Jitter) -> (Model, Vec<Vec3>) {
    const RADIUS_MM: f64 = 5.0;
    let ball = sphere(3, RADIUS_MM);
    let sheet = height_field(10, 8.0, |_, _| RADIUS_MM + 0.6);
    let bodies = [
        Body::rigid(ball, Vec3::zeros()),
        Body::sheet(sheet, -Vec3::z() * RADIUS_MM),
    ];
    assemble(&bodies, &Matter::default(), jitter)
}

fn through_ring(jitter: &mut Jitter) -> (Model, Vec<Vec3>) {
    let sheet = height_field(10, 6.0, |_, _| 1.5);
    let middle = 60;
    let sheet = Body {
        held: vec![middle],
        way_mm: -Vec3::z() * 8.0,
        ..Body::free(sheet)
    };
    let bodies = [sheet, Body::rigid(ring(4.0, 0.8), Vec3::zeros())];
    assemble(&bodies, &Matter::default(), jitter)
}

/// A ring of 16 × 6 places around the z axis, of a radius and a half thickness [mm].
fn ring(radius_mm: f64, half_mm: f64) -> Mesh {
    const AROUND: u32 = 16;
    const ACROSS: u32 = 6;
    let mut mesh = Mesh::default();
    let at = |i: u32, k: u32| (i % AROUND) * ACROSS + k % ACROSS;
    for i in 0..AROUND {
        let (sin, cos) = (TAU * f64::from(i) / f64::from(AROUND)).sin_cos();
        for k in 0..ACROSS {
            let (up, out) = (TAU * f64::from(k) / f64::from(ACROSS)).sin_cos();
            let radius = radius_mm + half_mm * out;
            mesh.points_mm
                .push(Vec3::new(radius * cos, radius * sin, half_mm * up));
            mesh.faces.extend([
                [at(i, k), at(i + 1, k), at(i + 1, k + 1)],
                [at(i, k), at(i + 1, k + 1), at(i, k + 1)],
            ]);
        }
    }
    mesh
}

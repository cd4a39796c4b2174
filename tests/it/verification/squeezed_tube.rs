//! A tube under pressure, free and between two plates.

use std::f64::consts::{PI, TAU};

use coapt::Vec3;
use coapt::energy::bilinear_spring::Springs;
use coapt::model::{Model, Prescribed};
use coapt::scene::Contact;

use super::{error, report, settled};
use crate::shapes::{Mesh, add_spring, bare};

const RADIUS_MM: f64 = 10.0;
const HALF_WIDTH_MM: f64 = 2.0;
const PRESSURE_MPA: f64 = 0.016;
const AROUND: u32 = 120;

/// A ring of tissue about the y axis: three circles of vertices, springs along them that share the width as 1 : 2 : 1, as
/// pressure does, across, which keep the width, and weak ones along the diagonals: triangles hand the pressure on a
/// rectangle to its corners unevenly, which would turn the circles against each other. Normals outwards.
fn tube(stiffness_n_per_mm: f64) -> Model {
    let mut mesh = Mesh::default();
    let at = |i: u32, circle: u32| 3 * (i % AROUND) + circle;
    for i in 0..AROUND {
        let (sin, cos) = (TAU * f64::from(i) / f64::from(AROUND)).sin_cos();
        let across = [-HALF_WIDTH_MM, 0.0, HALF_WIDTH_MM];
        let point = |y: f64| Vec3::new(RADIUS_MM * sin, y, RADIUS_MM * cos);
        mesh.points_mm.extend(across.map(point));
    }
    let mut springs = Springs::default();
    let edge_mm = (mesh.points_mm[0] - mesh.points_mm[3]).norm();
    let along = stiffness_n_per_mm * HALF_WIDTH_MM / edge_mm;
    for i in 0..AROUND {
        mesh.faces.extend([
            [at(i, 0), at(i + 1, 0), at(i + 1, 1)],
            [at(i, 0), at(i + 1, 1), at(i, 1)],
            [at(i, 2), at(i + 1, 1), at(i + 1, 2)],
            [at(i, 2), at(i, 1), at(i + 1, 1)],
        ]);
        for (circle, share) in [(0, 0.5), (1, 1.0), (2, 0.5)] {
            add_spring(
                &mut springs,
                [at(i, circle), at(i + 1, circle)],
                edge_mm,
                share * along,
            );
        }
        for side in [0, 2] {
            add_spring(&mut springs, [at(i, 1), at(i, side)], HALF_WIDTH_MM, along);
            let diagonal_mm = edge_mm.hypot(HALF_WIDTH_MM);
            add_spring(
                &mut springs,
                [at(i, side), at(i + 1, 1)],
                diagonal_mm,
                0.05 * along,
            );
        }
    }
    Model {
        springs,
        ..bare(&mesh, PRESSURE_MPA)
    }
}

/// T = p R, and R grows by p R / (E h) of R₀. On a regular polygon both hold exactly for the radius R of its corners: the
/// load on an edge of length L = 2 R sin(π/n) is p L, and its two neighbours pull with 2 T sin(π/n).
#[test]
fn a_free_tube_pulls_with_pressure_times_radius() {
    const STIFFNESS_N_PER_MM: f64 = 10.0;
    let model = tube(STIFFNESS_N_PER_MM);
    let positions = settled("tube", &model, model.rest_mm.clone()).state.positions_mm;
    let radius_mm = RADIUS_MM / (1.0 - PRESSURE_MPA * RADIUS_MM / STIFFNESS_N_PER_MM);
    let middle: Vec3 = positions.iter().sum::<Vec3>() / positions.len() as f64;
    let worst = positions
        .iter()
        .map(|x| error((x - middle).xz().norm(), radius_mm))
        .fold(0.0, f64::max);
    let springs = &model.springs;
    // Springs come as three along and four others.
    let pulls = (0..springs.ends.len())
        .filter(|spring| spring % 7 < 3)
        .map(|spring| {
            let [a, b] = springs.ends[spring].map(|vertex| positions[vertex as usize]);
            springs.tension_and_tangent(spring, (a - b).norm()).0
        });
    let pull = pulls.sum::<f64>() / f64::from(AROUND) / (2.0 * HALF_WIDTH_MM);
    let off = error(pull, PRESSURE_MPA * radius_mm);
    report(&format!(
        "free tube: radius off by {worst:.1e}, T / (p R) by {off:.1e}"
    ));
    // Diagonals carry a part of a thousand.
    assert!(worst < 1e-4 && off < 2e-3);
}

const THICKNESS_MM: f64 = 0.1;
const HEIGHT_MM: f64 = 12.0;

/// The tube, all but inextensible, and a large triangle over and another under it, which come together to a distance H.
pub(crate) fn tube_between_plates() -> Model {
    let mut model = tube(PRESSURE_MPA / 1e-5);
    model.contact = Contact {
        thickness_mm: THICKNESS_MM,
        ..Contact::default()
    };
    let first = model.rest_mm.len() as u32;
    // One large triangle for each plate: its edges and corners are far from the tube.
    for side in [1.0, -1.0] {
        let corner = model.rest_mm.len() as u32;
        for (x, y) in [(-30.0, -8.0), (30.0, -8.0), (0.0, 22.0)] {
            model
                .rest_mm
                .push(Vec3::new(x, y * side, side * (RADIUS_MM + 1.0)));
        }
        model.faces.push([corner, corner + 1, corner + 2]);
        model.face_leaflet.push(0);
    }
    model.leaflet_vertex_count = model.rest_mm.len();
    // Mid-surfaces under this pressure lie at about 0.9 of the contact thickness.
    let squeezed_mm = 0.5 * HEIGHT_MM + 0.9 * THICKNESS_MM;
    let plate = |vertex: u32| {
        let mut target_mm = model.rest_mm[vertex as usize];
        target_mm.z = squeezed_mm.copysign(target_mm.z);
        Prescribed { vertex, target_mm }
    };
    model.prescribed = (first..first + 6).map(plate).collect();
    model
}

/// Between plates at a distance H a tube of fixed perimeter P lies flat over (P − π H)/2 on each side, for the rest is two
/// half circles, T = p H/2; each plate carries p times that, per depth. Here P = 20π and H = 12: 4π.
#[test]
fn a_tube_between_plates_lies_flat_as_far_as_its_perimeter_allows() {
    let model = tube_between_plates();
    let first = 3 * AROUND;
    // Pressure on the plates is not the tube's.
    let plate_n = |corner: u32| {
        let [a, b, c] = [0, 1, 2].map(|k| model.rest_mm[(corner + k) as usize]);
        0.5 * PRESSURE_MPA * (b - a).cross(&(c - a)).z
    };
    let equilibrium = settled("tube between plates", &model, model.rest_mm.clone());
    let exact_mm = 0.5 * (TAU * RADIUS_MM - PI * HEIGHT_MM);
    for (corner, side) in [(first, 1.0), (first + 3, -1.0)] {
        let carried: Vec3 = (corner..corner + 3)
            .map(|v| equilibrium.reactions_n[v as usize])
            .sum();
        let pushed_n = side * (carried.z - plate_n(corner));
        let length_mm = pushed_n / (PRESSURE_MPA * 2.0 * HALF_WIDTH_MM);
        report(&format!(
            "tube between plates: contact length {length_mm:.3} mm, exact {exact_mm:.3} mm ({:.2} %)",
            100.0 * error(length_mm, exact_mm)
        ));
        assert!(error(length_mm, exact_mm) < 0.02);
    }
}

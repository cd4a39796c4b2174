//! Bodies pressed together: pillows, tubes, flaps, and sheets between walls.

use coapt::Vec3;
use coapt::model::Model;
use coapt::relax::Status;
use coapt::scene::Contact;

use super::assembly::{Body, Matter, assemble, height_field, rectangle};
use super::{begun, jittered, uncertified};
use crate::hard::{HardCase, Jitter};
use crate::shapes::{Mesh, SpringTissue, add_spring, hold, sphere, sprung};
use crate::verification::squeezed_tube::tube_between_plates;

pub(super) fn cases() -> Vec<HardCase> {
    let mut cases = walls();
    cases.push(begun(
        "tube between plates",
        "all but inextensible, squeezed from a radius of 10 to a height of 12 mm",
        |jitter| {
            let model = tube_between_plates();
            let start_mm = model.rest_mm.iter().map(|&x| jitter.moved(x, 0.5)).collect();
            (model, start_mm)
        },
    ));
    cases.push(begun(
        "one-triangle leaflets",
        "two free vertices, which come to lie on each other, each on a thread",
        flaps,
    ));
    const STRUCK: &str = "points are driven through where a sheet is; it must be carried along";
    for (times, stiffness_mpa) in [(5.0, 0.5), (20.0, 0.5), (50.0, 50.0)] {
        cases.push(begun(
            format!("sheet struck by a spike that goes {times} thicknesses, contact of {stiffness_mpa} MPa"),
            STRUCK,
            move |jitter| struck(jitter, times, stiffness_mpa),
        ));
    }
    cases.push(uncertified(
        begun(
            "sheet struck by a spike that goes 50 thicknesses, contact of 0.5 MPa",
            "contact too soft for the pull of a sheet stretched fivefold",
            |jitter| {
                let (mut model, start_mm) = struck(jitter, 50.0, 0.5);
                model.settings.iteration_limit = 100;
                (model, start_mm)
            },
        ),
        &[Status::IterationLimit, Status::Stalled],
        "the sheet pulls with more than contact bears at no distance at all; steps alone keep parts from each other",
    ));
    cases
}

/// Two inflated spheres, the far cap of each held, that come together by their radius; all lengths times a unit.
pub(super) fn sphere_pair(jitter: &mut Jitter, unit: f64) -> (Model, Vec<Vec3>) {
    let radius_mm = 5.0 * unit;
    let matter = Matter {
        springs: SpringTissue::linear(unit),
        plate_n_mm: 0.05 * unit.powi(3),
        pressure_mpa: 0.02,
        contact: Contact {
            thickness_mm: 0.5 * unit,
            ..Contact::default()
        },
    };
    let ball = |side: f64| {
        let mesh = sphere(3, radius_mm).moved(|x| x + Vec3::z() * (1.1 * side * radius_mm));
        let held = (0..mesh.points_mm.len() as u32)
            .filter(|&v| side * mesh.points_mm[v as usize].z > 1.8 * radius_mm)
            .collect();
        Body {
            held,
            way_mm: -Vec3::z() * (0.5 * side * radius_mm),
            ..Body::free(mesh)
        }
    };
    assemble(&[ball(-1.0), ball(1.0)], &matter, jitter)
}

/// A wall that comes from a side by a way, 12 mm wide.
fn wall(from: Vec3, way_mm: f64) -> Body {
    let towards = -from.normalize();
    let across = if towards.z.abs() > 0.5 {
        Vec3::x()
    } else {
        Vec3::z()
    };
    let other = towards.cross(&across);
    let corner = from - (across + other) * 6.0;
    Body::rigid(rectangle(corner, across * 12.0, other * 12.0), towards * way_mm)
}

fn walls() -> Vec<HardCase> {
    let mut cases = Vec::new();
    for (name, sides) in [
        ("two walls", vec![Vec3::x(), -Vec3::x()]),
        ("four walls", vec![Vec3::x(), -Vec3::x(), Vec3::y(), -Vec3::y()]),
    ] {
        let around = sides.clone();
        cases.push(begun(
            format!("free sheet pushed by {name}"),
            "nothing holds it but the walls at its edges; it buckles away or folds up",
            move |jitter| {
                let sheet = height_field(6, 3.0, |_, _| 0.0);
                let mut bodies = vec![Body::free(sheet)];
                // Walls as wide as the gap between them would meet at the corners.
                bodies.extend(around.iter().enumerate().map(|(k, side)| {
                    let lift = Vec3::z() * if k < 2 { 0.0 } else { 0.1 };
                    let mut wall = wall(side * 3.8, 1.5);
                    wall.mesh = narrowed(wall.mesh, *side, 2.2).moved(|x| x + lift);
                    wall
                }));
                assemble(&bodies, &Matter::default(), jitter)
            },
        ));
        cases.push(begun(
            format!("free sphere pushed by {name}"),
            "nothing holds it but the walls",
            move |jitter| {
                let mut bodies = vec![Body::free(sphere(3, 3.0))];
                bodies.extend(sides.iter().map(|side| {
                    let mut wall = wall(side * 3.8, 1.5);
                    wall.mesh = narrowed(wall.mesh, *side, 2.2);
                    wall
                }));
                assemble(&bodies, &Matter::default(), jitter)
            },
        ));
    }
    cases
}

/// A wall made narrower sideways, level with z.
fn narrowed(mesh: Mesh, side: Vec3, half_mm: f64) -> Mesh {
    let along = side.cross(&Vec3::z());
    mesh.moved(|x| x - along * (x.dot(&along) * (1.0 - half_mm / 6.0)))
}

/// Two triangles hinged 20 mm apart, hanging towards each other, each with its corner on a thread; pressure from below.
fn flaps(jitter: &mut Jitter) -> (Model, Vec<Vec3>) {
    let mut mesh = Mesh::default();
    for side in [-1.0, 1.0] {
        let first = mesh.points_mm.len() as u32;
        mesh.points_mm.extend([
            Vec3::new(10.0 * side, -5.0 * side, 0.0),
            Vec3::new(10.0 * side, 5.0 * side, 0.0),
            Vec3::new(2.0 * side, 0.0, -9.0),
        ]);
        mesh.faces.push([first, first + 1, first + 2]);
    }
    let mesh = jittered(mesh, jitter);
    let mut model = sprung(&mesh, SpringTissue::linear(1.0), 0.016);
    for side in [-1.0, 1.0] {
        let tip = model.rest_mm.len() as u32;
        model.rest_mm.push(Vec3::new(4.0 * side, 0.0, -25.0));
        add_spring(
            &mut model.springs,
            [if side < 0.0 { 2 } else { 5 }, tip],
            18.0,
            5.0,
        );
        if let Some(compression) = model.springs.compression_n_per_mm.last_mut() {
            *compression = 0.0;
        }
    }
    hold(&mut model, &[0, 1, 3, 4, 6, 7]);
    model.contact = Contact::default();
    let start_mm = model.rest_mm.clone();
    (model, start_mm)
}

/// A sheet of 10 mm held along its rim, and a rigid spike over its middle that goes some thicknesses down.
fn struck(jitter: &mut Jitter, times: f64, stiffness_mpa: f64) -> (Model, Vec<Vec3>) {
    let mut matter = Matter::default();
    matter.contact.stiffness_mpa = stiffness_mpa;
    let sheet = Body::sheet(height_field(8, 5.0, |_, _| 0.0), Vec3::zeros());
    let thickness_mm = matter.contact.thickness_mm;
    let spike = height_field(2, 0.8, |x, y| 2.0 * thickness_mm + 4.0 * x.abs().max(y.abs()));
    let spike = Body::rigid(spike, -Vec3::z() * (times * thickness_mm));
    assemble(&[sheet, spike], &matter, jitter)
}

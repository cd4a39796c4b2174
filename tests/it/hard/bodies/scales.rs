//! The same shapes in other units, and numbers far from each other.

use coapt::Vec3;
use coapt::model::Model;
use coapt::relax::Status;
use coapt::scene::{Contact, Load};

use super::assembly::{Body, Matter, assemble, height_field};
use super::pressed::sphere_pair;
use super::{begun, count_in_pressure, jittered_in_plane, resting, uncertified};
use crate::hard::{HardCase, Jitter};
use crate::shapes::{Mesh, SpringTissue, disk, hold, sprung};

pub(super) fn cases() -> Vec<HardCase> {
    let mut cases = Vec::new();
    for unit in [1e-3, 1.0, 1e3] {
        cases.push(resting(
            format!("flat disk of springs, a unit of {unit} mm"),
            "all lengths times the unit, stresses the same",
            move |jitter| blown_disk(jitter, unit, 0.03),
        ));
        cases.push(begun(
            format!("two inflated spheres pressed on each other, a unit of {unit} mm"),
            "supports come together by a radius; all lengths times the unit, stresses the same",
            move |jitter| sphere_pair(jitter, unit),
        ));
    }
    cases.extend(uneven());
    cases.push(resting(
        "flat disk of springs, 25 times as many faces",
        "a mesh much finer than others here",
        |jitter| blown_mesh(disk(30, RADIUS_MM), jitter, 1.0, 0.03),
    ));
    cases.push(uncertified(
        resting(
            "flat disk of springs, a thousandth as thick",
            "hardly any tissue, and no knee",
            |jitter| blown_disk(jitter, 1.0, 30.0),
        ),
        &[Status::Burst],
        "springs without a knee grow weaker the farther they are stretched: above a pressure that falls with the thickness there \
         is no balance",
    ));
    cases.push(resting(
        "flat disk without pressure",
        "nothing to do, and nothing to count residuals in but stiffness",
        |jitter| blown_disk(jitter, 1.0, 0.0),
    ));
    cases.push(resting(
        "flat disk, pressure and springs 4444 times",
        "133 MPa: numbers far from 1, the same shape",
        |jitter| {
            let pressure_mpa = Load::mmhg(1e6).pressure_mpa().expect("one unit");
            let mut model = blown_disk(jitter, 1.0, 0.03);
            let factor = pressure_mpa / model.pressure_mpa;
            (0..model.springs.ends.len()).for_each(|spring| scale_spring(&mut model, spring, factor));
            model.pressure_mpa = pressure_mpa;
            model
        },
    ));
    cases.extend(thick_and_thin());
    cases
}

fn uneven() -> Vec<HardCase> {
    let halves = |ratio: f64| {
        resting(
            format!("flat disk, one half {ratio:e} times as stiff"),
            "stiffness of neighbours far apart",
            move |jitter| uneven_disk(jitter, ratio, |_, middle| middle.x > 0.0),
        )
    };
    let needles = |ratio: f64, iteration_limit: u32| {
        resting(
            format!("flat disk, one spring in ten {ratio:e} times as stiff"),
            "hard needles all over a soft sheet",
            move |jitter| {
                let mut model = uneven_disk(jitter, ratio, |spring, _| spring % 10 == 0);
                model.settings.iteration_limit = iteration_limit;
                model
            },
        )
    };
    vec![
        halves(1e3),
        halves(1e6),
        halves(1e9),
        needles(1e3, 2000),
        needles(1e6, 2000),
        uncertified(
            needles(1e9, 100),
            &[Status::IterationLimit],
            "needles that keep their length to 1e-12 bend the way of the sheet so sharply that steps along it are of 1e-4 of \
             an edge; 2000 do not suffice either",
        ),
    ]
}

fn thick_and_thin() -> Vec<HardCase> {
    let sheets = |thickness_mm: f64, iteration_limit: u32| {
        begun(
            format!("sheets pressed on each other over a contact thickness of {thickness_mm} mm"),
            match thickness_mm > 1.0 {
                true => "contact reaches over several faces, and is there from the start",
                false => "contact goes from nothing to rigid within almost no distance",
            },
            move |jitter| {
                let (mut model, start_mm) = lowered_plateau(jitter, thickness_mm);
                model.settings.iteration_limit = iteration_limit;
                (model, start_mm)
            },
        )
    };
    vec![
        sheets(2.5, 2000),
        sheets(5.0, 2000),
        sheets(1e-2, 2000),
        uncertified(
            sheets(1e-4, 50),
            &[Status::IterationLimit],
            "sheets slide over each other's facets by less than the thickness in a step; 2000 do not suffice either",
        ),
        uncertified(
            sheets(1e-6, 50),
            &[Status::IterationLimit],
            "steps keep parts 1e-5 mm from each other, where contact of this thickness has not begun",
        ),
    ]
}

const RADIUS_MM: f64 = 10.0;

/// A disk in other units, under p a / (E h).
fn blown_disk(jitter: &mut Jitter, unit: f64, softness: f64) -> Model {
    blown_mesh(disk(6, RADIUS_MM * unit), jitter, unit, softness)
}

fn blown_mesh(mesh: Mesh, jitter: &mut Jitter, unit: f64, softness: f64) -> Model {
    let mesh = jittered_in_plane(mesh, jitter);
    let mut model = sprung(&mesh, SpringTissue::linear(unit), softness / RADIUS_MM);
    hold(&mut model, &mesh.rim);
    model
}

/// A disk of which some springs, known by their index and middle, are so many times as stiff as others.
///
/// Their forces are known to 1e-16 of stiffness times length, which at 1e9 is 3e-4 of the pressure on a vertex.
fn uneven_disk(jitter: &mut Jitter, ratio: f64, is_stiff: impl Fn(usize, Vec3) -> bool) -> Model {
    let mut model = blown_disk(jitter, 1.0, 0.03);
    for spring in 0..model.springs.ends.len() {
        let [a, b] = model.springs.ends[spring].map(|v| model.rest_mm[v as usize]);
        if is_stiff(spring, 0.5 * (a + b)) {
            scale_spring(&mut model, spring, ratio);
        }
    }
    count_in_pressure(&mut model);
    model.settings.residual_tolerance *= (1e-6 * ratio).max(1.0);
    model
}

fn scale_spring(model: &mut Model, spring: usize, factor: f64) {
    for stiffness in [
        &mut model.springs.soft_n_per_mm,
        &mut model.springs.stiff_n_per_mm,
        &mut model.springs.compression_n_per_mm,
    ] {
        stiffness[spring] *= factor;
    }
}

/// A blunt pyramid lowered on a flat sheet.
fn lowered_plateau(jitter: &mut Jitter, thickness_mm: f64) -> (Model, Vec<Vec3>) {
    let matter = Matter {
        contact: Contact {
            thickness_mm,
            ..Contact::default()
        },
        ..Matter::default()
    };
    let plateau = |x: f64, y: f64| 0.1 + (x.abs().max(y.abs()) - 2.5).max(0.0);
    let bodies = [
        Body::sheet(height_field(6, 5.0, |_, _| 0.0), Vec3::zeros()),
        Body::sheet(height_field(6, 5.0, plateau), -Vec3::z()),
    ];
    assemble(&bodies, &matter, jitter)
}

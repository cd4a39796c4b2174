//! Spheres of membrane: p = (dU/dλ) / (dV/dλ) = h w′(λ) / (R λ²) for any isotropic law, w the energy per unloaded volume under
//! equal stretches. For neo-Hookean tissue that is p R / (μ h) = 2 (1/λ − 1/λ⁷), at most 1.239 at λ = 7^(1/6); for St. Venant
//! and Kirchhoff's p R (1 − ν) / (E h) = λ − 1/λ, without a limit.

use coapt::energy::membrane::{Law, exponential};
use coapt::relax::{Status, relax};
use coapt::state::State;

use super::laws::stresses_mpa;
use super::spheres::{CAP_ANGLE, RADIUS_MM, crown_error, stretch_of};
use super::{error, oracle, order, report};
use crate::shapes::{cap, hold, neo_hookean, skinned, sphere, st_venant_kirchhoff, taut};

const THICKNESS_MM: f64 = 0.5;

/// Pressure that holds a sphere at a stretch [MPa].
fn pressure_mpa(law: &Law, stretch: f64) -> f64 {
    // w′ is the sum of both slopes, which are equal.
    2.0 * stresses_mpa(law, [stretch; 2])[0] * THICKNESS_MM / (RADIUS_MM * stretch * stretch)
}

fn fung() -> Law {
    Law::Exponential(exponential::Constants {
        c0_mpa: 0.02,
        c1_mpa: 0.002,
        c2: 2.0,
        compressibility_per_mpa: 0.0,
    })
}

fn compressible() -> Law {
    Law::Exponential(exponential::Constants {
        c0_mpa: 0.02,
        c1_mpa: 0.0,
        c2: 1.0,
        compressibility_per_mpa: 20.0,
    })
}

/// The formula that all tests here go by is the closed forms'.
#[test]
fn pressures_are_the_closed_forms() {
    for stretch in [1.05, 1.3, 2.0, 3.0_f64] {
        let neo_hookean = pressure_mpa(&neo_hookean(0.02), stretch) * RADIUS_MM / (0.02 * THICKNESS_MM);
        let stiff =
            pressure_mpa(&st_venant_kirchhoff(0.1, 0.45), stretch) * RADIUS_MM * 0.55 / (0.1 * THICKNESS_MM);
        assert!(error(neo_hookean, 2.0 * (1.0 / stretch - stretch.powi(-7))) < 1e-7);
        assert!(error(stiff, stretch - 1.0 / stretch) < 1e-7);
    }
    let limit = 7_f64.powf(1.0 / 6.0);
    if let Some(values) = oracle("reference_values.json") {
        let number = |key: &str| values["sphere_neo_hookean"][key].as_f64().expect("a number");
        assert!(error(limit, number("l_crit")) < 1e-12);
        assert!(error(2.0 * (1.0 / limit - limit.powi(-7)), number("p_crit")) < 1e-12);
    }
}

/// As far as each law is stable under pressure: neo-Hookean tissue to λ = 1.38, the others as far as asked.
#[test]
fn closed_spheres_inflate_along_their_curves() {
    let laws: [(&str, Law, &[f64]); 4] = [
        ("neo-Hookean", neo_hookean(0.02), &[1.02, 1.1, 1.2, 1.3, 1.36]),
        (
            "St. Venant-Kirchhoff, ν 0.45",
            st_venant_kirchhoff(0.1, 0.45),
            &[1.02, 1.1, 1.5, 2.0],
        ),
        ("exponential", fung(), &[1.02, 1.1, 1.3, 1.5]),
        (
            "neo-Hookean, compressible",
            compressible(),
            &[1.02, 1.1, 1.2, 1.3],
        ),
    ];
    for (name, law, stretches) in laws {
        let mut errors = Vec::new();
        for n in [3, 6, 12] {
            let mesh = sphere(n, RADIUS_MM);
            let mut worst = 0.0_f64;
            for &stretch in stretches {
                let pressure = pressure_mpa(&law, stretch);
                let model = skinned(&mesh, taut(law), THICKNESS_MM, pressure);
                let found = stretch_of(name, &mesh, model, mesh.points_mm.clone());
                worst = worst.max(error(pressure_mpa(&law, found), pressure));
            }
            report(&format!(
                "sphere, {name}, {} triangles, λ to {}: pressure off by {:.3} % at most",
                mesh.faces.len(),
                stretches[stretches.len() - 1],
                100.0 * worst
            ));
            errors.push(worst);
        }
        assert!(errors[1] < 0.01 && errors[2] < 0.0025, "{name}");
        for pair in errors.windows(2) {
            let slope = order([2.0, 1.0], [pair[0], pair[1]]);
            report(&format!("  order {slope:.2}"));
            assert!(slope > 1.8, "{name}");
        }
    }
}

/// There is no balance, and none is claimed.
#[test]
fn above_the_limit_pressure_no_neo_hookean_sphere_converges() {
    let mesh = sphere(3, RADIUS_MM);
    let limit = 7_f64.powf(1.0 / 6.0);
    let pressure = 1.1 * pressure_mpa(&neo_hookean(0.02), limit);
    let mut model = skinned(&mesh, taut(neo_hookean(0.02)), THICKNESS_MM, pressure);
    hold(&mut model, &[0]);
    model.settings.iteration_limit = 200;
    let end = relax(&model, &State::open(&model));
    assert_eq!(end.status, Status::Burst);
    assert!(mesh.volume_mm3(&end.state.positions_mm) > 8.0 * mesh.volume_mm3(&mesh.points_mm));
}

/// A cap whose rim is held at λ times its radius is stable beyond the limit point.
#[test]
fn caps_follow_their_curves_past_the_limit_point() {
    let laws = [
        ("neo-Hookean", neo_hookean(0.02)),
        ("St. Venant-Kirchhoff, ν 0.45", st_venant_kirchhoff(0.1, 0.45)),
        ("neo-Hookean, compressible", compressible()),
    ];
    for (name, law) in laws {
        let mut errors = Vec::new();
        for rings in [6, 12] {
            let mesh = cap(rings, RADIUS_MM, CAP_ANGLE);
            let mut worst = 0.0_f64;
            for stretch in [1.1, 1.383, 1.6, 2.0, 3.0] {
                let model = skinned(&mesh, taut(law), THICKNESS_MM, pressure_mpa(&law, stretch));
                worst = worst.max(crown_error(name, &mesh, model, stretch));
            }
            report(&format!(
                "cap, {name}, λ 1.1 to 3, {} triangles: crown off by {:.3} % at most",
                mesh.faces.len(),
                100.0 * worst
            ));
            errors.push(worst);
        }
        assert!(errors[0] < 0.01 && errors[1] < 0.0025, "{name} {errors:?}");
        let slope = order([2.0, 1.0], [errors[0], errors[1]]);
        report(&format!("  order {slope:.2}"));
        assert!(slope > 1.7, "{name}");
    }
}

//! Spheres under pressure. Uniformly stretched by λ, a sphere is in balance where p = (dU/dλ) / (dV/dλ). Edge springs store
//! the same under a uniform stretch whatever the mesh, Σ k L² (λ − 1)²/2 = 3/2 E h A (λ − 1)², so that
//!
//! ```text
//! p R = 3 E h (λ − 1) / λ²                   linear: at most 3/4 E h, at λ = 2, where inflation becomes unstable
//! p R = 3 (E₁h e* + E₂h (λ − 1 − e*)) / λ²   beyond the knee e* of bilinear springs
//! ```
//!
//! Beyond the limit point no closed sphere is at rest. A cap of it is, whose rim is held at λ times its radius: the rest of
//! the sphere, which would run away, is not there.

use coapt::Vec3;
use coapt::model::Model;
use coapt::relax::{Status, relax};
use coapt::state::State;
use coapt_tests::Random;

use super::references::root;
use super::{error, order, report, settled};
use crate::shapes::{Mesh, SpringTissue, cap, hold, sphere, sprung};

pub(super) const RADIUS_MM: f64 = 15.0;
const STIFFNESS_N_PER_MM: f64 = 0.05;
/// From its axis to its rim, a cap spans so much [rad].
pub(super) const CAP_ANGLE: f64 = 1.0;
const KNEE: f64 = 0.25;

/// Pressure that holds a sphere of springs at a stretch [MPa].
fn spring_pressure_mpa(tissue: SpringTissue, stretch: f64) -> f64 {
    let strain = stretch - 1.0;
    let beyond = (strain - tissue.knee).max(0.0);
    let pull = tissue.soft_n_per_mm * (strain - beyond) + tissue.stiff_n_per_mm * beyond;
    3.0 * pull / (stretch * stretch * RADIUS_MM)
}

fn bilinear(ratio: f64) -> SpringTissue {
    SpringTissue {
        soft_n_per_mm: STIFFNESS_N_PER_MM,
        stiff_n_per_mm: ratio * STIFFNESS_N_PER_MM,
        knee: KNEE,
        compression_ratio: 1.0,
    }
}

/// Mean stretch of a closed sphere at rest under pressure [1], from its volume.
///
/// One vertex is held, which keeps the sphere from drifting and must carry nothing: neither tissue nor pressure on a closed
/// surface pushes as a whole. Turning about it costs nothing and is left alone.
pub(super) fn stretch_of(name: &str, mesh: &Mesh, mut model: Model, start_mm: Vec<Vec3>) -> f64 {
    hold(&mut model, &[0]);
    model.prescribed[0].target_mm = start_mm[0];
    let equilibrium = settled(name, &model, start_mm);
    let positions = &equilibrium.state.positions_mm;
    let pushed_n = model.pressure_mpa * mesh.area_mm2(positions);
    // The residuals of all free vertices, each at most 1e-6 of a vertex' share of the load, may add up.
    let carried_n = equilibrium.reactions_n[0].norm();
    assert!(carried_n < 1e-6 * pushed_n, "{name}: {carried_n} of {pushed_n}");
    assert!(equilibrium.certificate.is_certified(equilibrium.status), "{name}");
    (mesh.volume_mm3(positions) / mesh.volume_mm3(&mesh.points_mm)).cbrt()
}

/// Up to the limit point a closed sphere is stable under pressure. What is compared is the pressure that belongs to the
/// stretch found: the stretch itself runs away near the limit.
#[test]
fn a_sphere_of_springs_inflates_along_its_curve() {
    let tissue = SpringTissue::linear(STIFFNESS_N_PER_MM);
    let mut errors = Vec::new();
    for n in [3, 6, 12] {
        let mesh = sphere(n, RADIUS_MM);
        let mut worst = 0.0_f64;
        for stretch in [1.05, 1.2, 1.5, 1.8, 1.9] {
            let pressure_mpa = spring_pressure_mpa(tissue, stretch);
            let model = sprung(&mesh, tissue, pressure_mpa);
            let found = stretch_of("sphere", &mesh, model, mesh.points_mm.clone());
            worst = worst.max(error(spring_pressure_mpa(tissue, found), pressure_mpa));
        }
        report(&format!(
            "sphere of springs, λ 1.05 to 1.9, {} triangles: pressure off by {:.3} % at most",
            mesh.faces.len(),
            100.0 * worst
        ));
        errors.push(worst);
    }
    assert!(errors[1] < 0.01 && errors[2] < 0.0025);
    for pair in errors.windows(2) {
        let slope = order([2.0, 1.0], [pair[0], pair[1]]);
        report(&format!("  order {slope:.2}"));
        assert!(slope > 1.8);
    }
}

/// There is no balance, and none is claimed.
#[test]
fn above_the_limit_pressure_no_sphere_converges() {
    let mesh = sphere(3, RADIUS_MM);
    let mut model = sprung(
        &mesh,
        SpringTissue::linear(STIFFNESS_N_PER_MM),
        1.1 * 0.75 * STIFFNESS_N_PER_MM / RADIUS_MM,
    );
    hold(&mut model, &[0]);
    model.settings.iteration_limit = 300;
    let end = relax(&model, &State::open(&model));
    assert_eq!(end.status, Status::Burst);
    let positions = &end.state.positions_mm;
    assert!(positions.iter().all(|x| x.iter().all(|value| value.is_finite())));
    assert!(mesh.volume_mm3(positions) > 8.0 * mesh.volume_mm3(&mesh.points_mm));
}

/// A cap stretched from 1.2 to 4 times, twice beyond the limit point: its crown rises as a sphere's.
#[test]
fn a_cap_of_springs_follows_the_curve_past_the_limit_point() {
    let tissue = SpringTissue::linear(STIFFNESS_N_PER_MM);
    let mut errors = Vec::new();
    for rings in [6, 12] {
        let mesh = cap(rings, RADIUS_MM, CAP_ANGLE);
        let mut worst = 0.0_f64;
        for stretch in [1.2, 1.8, 2.0, 2.3, 3.0, 4.0] {
            let model = sprung(&mesh, tissue, spring_pressure_mpa(tissue, stretch));
            worst = worst.max(crown_error("cap of springs", &mesh, model, stretch));
        }
        report(&format!(
            "cap of springs, λ 1.2 to 4, {} triangles: crown off by {:.3} % at most",
            mesh.faces.len(),
            100.0 * worst
        ));
        errors.push(worst);
    }
    assert!(errors[0] < 0.01 && errors[1] < 0.0025, "{errors:?}");
    let slope = order([2.0, 1.0], [errors[0], errors[1]]);
    report(&format!("  order {slope:.2}"));
    assert!(slope > 1.8);
}

/// How far the crown of a cap whose rim is widened by a stretch is from where a sphere so stretched has it, as a part of its
/// height over the rim.
pub(super) fn crown_error(name: &str, mesh: &Mesh, mut model: Model, stretch: f64) -> f64 {
    hold(&mut model, &mesh.rim);
    for held in &mut model.prescribed {
        held.target_mm *= stretch;
    }
    let positions = settled(name, &model, mesh.points_mm.clone()).state.positions_mm;
    let top_mm = positions.iter().map(|x| x.z).fold(0.0, f64::max);
    let rim_mm = stretch * RADIUS_MM * CAP_ANGLE.cos();
    error(top_mm - rim_mm, stretch * RADIUS_MM - rim_mm)
}

/// Where soft tissue alone would burst, stiff tissue beyond the knee holds; before the knee, on it and beyond, at stiffness
/// ratios from 1 to 1000, from the unloaded sphere, a crumpled one, one blown up beyond the knee, and one whose vertices
/// were moved at random, always the same stretch comes out, and the closed form's pressure within 1 %.
#[test]
fn a_bilinear_sphere_has_one_equilibrium_whatever_the_start() {
    let mesh = sphere(6, RADIUS_MM);
    let edge_mm = 1.1 * RADIUS_MM / 6.0;
    let mut random = Random(7);
    for ratio in [1.0, 10.0, 100.0, 1000.0] {
        let tissue = bilinear(ratio);
        // The pressure has its peak where λ = 2 (1 + e* − e* E₁/E₂); up to there the closed form rises.
        let limit = 2.0 * (1.0 + KNEE - KNEE / ratio);
        for load in [0.3, 0.6, 2.0] {
            let pressure_mpa = load * STIFFNESS_N_PER_MM / RADIUS_MM;
            if spring_pressure_mpa(tissue, limit) < pressure_mpa {
                continue;
            }
            let exact = root(
                |stretch| spring_pressure_mpa(tissue, stretch) - pressure_mpa,
                1.0,
                limit,
            );
            let mut found = Vec::new();
            for (scale, jitter_mm) in [(1.0, 0.0), (0.6, 0.0), (1.6, 0.0), (1.0, 0.25 * edge_mm)] {
                let start = mesh
                    .points_mm
                    .iter()
                    .map(|x| x * scale + random.vector() * jitter_mm);
                let name = format!("stiffness ratio {ratio}, load {load}, start {scale} {jitter_mm}");
                let model = sprung(&mesh, tissue, pressure_mpa);
                found.push(stretch_of(&name, &mesh, model, start.collect()));
            }
            let off = error(spring_pressure_mpa(tissue, found[0]), pressure_mpa);
            report(&format!(
                "bilinear sphere, stiffness ratio {ratio}, p R / (E₁ h) = {load}: λ {:.5}, exact {exact:.5}, pressure off {:.2} %",
                found[0],
                100.0 * off
            ));
            assert!(off < 0.01);
            // Volumes of equal shapes, each found to residuals of 1e-6.
            assert!(
                found.iter().all(|other| error(*other, found[0]) < 1e-6),
                "{found:?}"
            );
        }
    }
}

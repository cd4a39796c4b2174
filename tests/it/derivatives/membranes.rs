//! Membranes: every law in every regime it has.

use super::*;
use coapt::energy::membrane::{
    self, Law, Membranes, Metric, Tissue, UNLOADED, exponential, may_newman, st_venant_kirchhoff,
    tension_field,
};
use coapt_tests::Random;

fn st_venant_kirchhoff() -> Law {
    Law::StVenantKirchhoff(st_venant_kirchhoff::Constants {
        modulus_mpa: 0.4,
        poisson_ratio: 0.45,
    })
}

/// The anterior tricuspid leaflet of Mathur 2022, incompressible or as compressible as there.
fn exponential(compressibility_per_mpa: f64) -> Law {
    Law::Exponential(exponential::Constants {
        c0_mpa: 0.001,
        c1_mpa: 0.000124,
        c2: 4.568202,
        compressibility_per_mpa,
    })
}

fn neo_hookean() -> Law {
    Law::Exponential(exponential::Constants {
        c0_mpa: 0.1,
        c1_mpa: 0.0,
        c2: 0.0,
        compressibility_per_mpa: 0.0,
    })
}

/// The anterior mitral leaflet as May-Newman & Yin 1998 are often quoted.
fn may_newman() -> Law {
    Law::MayNewman(may_newman::ANTERIOR)
}

fn laws() -> [Law; 5] {
    [
        st_venant_kirchhoff(),
        exponential(0.0),
        exponential(20.06689),
        neo_hookean(),
        may_newman(),
    ]
}

/// Stretches along the two axes, and how far the first is turned in the plane.
fn metric([first, second, turn]: [f64; 3]) -> Metric {
    let (sin, cos) = turn.sin_cos();
    let (a, b) = (first * first, second * second);
    Metric::new(
        a * cos * cos + b * sin * sin,
        a * sin * sin + b * cos * cos,
        (a - b) * sin * cos,
    )
}

/// A response has the slopes that it says, by central differences with a step of 1e-5: 1e-6 of the largest part.
fn assert_response(respond: impl Fn(&Metric) -> membrane::Response, at: &Metric, what: &str) {
    let response = respond(at);
    let scale = response.curvature_mpa.amax().max(response.slope_mpa.amax());
    for k in 0..3 {
        let nudged = |by: f64| {
            let mut moved = *at;
            moved[k] += by;
            respond(&moved)
        };
        let (ahead, behind) = (nudged(STEP), nudged(-STEP));
        let slope = (ahead.energy_mpa - behind.energy_mpa) / (2.0 * STEP);
        assert!(
            (slope - response.slope_mpa[k]).abs() < 1e-6 * scale,
            "{what} {k}: {slope} {response:?}"
        );
        let slope = (ahead.slope_mpa - behind.slope_mpa) / (2.0 * STEP);
        let off = (slope - response.curvature_mpa.column(k)).amax();
        assert!(off < 1e-5 * scale, "{what} {k}: {slope} {response:?}");
    }
}

#[test]
fn laws_have_the_slopes_they_say() {
    for law in laws() {
        for stretches in [
            [1.1, 1.05, 0.3],
            [1.3, 0.8, 1.0],
            [1.45, 1.2, -0.4],
            [0.9, 0.7, 0.2],
            [1.01, 1.0, 0.0],
        ] {
            assert_response(
                |c| law.response(c),
                &metric(stretches),
                &format!("{law:?} {stretches:?}"),
            );
        }
        // Beyond the bound of the exponent too.
        assert_response(
            |c| law.response(c),
            &metric([2.6, 2.2, 0.5]),
            &format!("{law:?} far"),
        );
    }
}

/// Unloaded tissue has no stress and stores nothing.
#[test]
fn laws_are_at_rest_unloaded() {
    for law in laws() {
        let response = law.response(&UNLOADED);
        assert!(
            response.energy_mpa.abs() < 1e-15 && response.slope_mpa.amax() < 1e-13,
            "{law:?} {response:?}"
        );
    }
}

/// With hardly any compressibility the compressible law is the incompressible one; with much of it, softer.
#[test]
fn compressibility_vanishes() {
    for stretches in [[1.3, 1.2, 0.0], [1.5, 0.9, 0.7]] {
        let at = metric(stretches);
        let [stiff, nearly, soft] = [0.0, 1e-6, 20.0].map(|d| exponential(d).response(&at));
        assert!((nearly.energy_mpa / stiff.energy_mpa - 1.0).abs() < 1e-6);
        assert!((nearly.slope_mpa - stiff.slope_mpa).amax() < 1e-5 * stiff.slope_mpa.amax());
        assert!((nearly.curvature_mpa - stiff.curvature_mpa).amax() < 1e-4 * stiff.curvature_mpa.amax());
        assert!(soft.energy_mpa < stiff.energy_mpa);
    }
}

/// Neo-Hookean under equibiaxial stretch λ: Cauchy stress μ (λ² − λ⁻⁴); S = σ / λ², and the slope is S / 2.
#[test]
fn neo_hookean_under_equibiaxial_stretch() {
    let stretch = 1.3_f64;
    let response = neo_hookean().response(&metric([stretch, stretch, 0.0]));
    let cauchy = 0.1 * (stretch.powi(2) - stretch.powi(-4));
    assert!((2.0 * response.slope_mpa[0] * stretch * stretch / cauchy - 1.0).abs() < 1e-14);
}

/// Taut, wrinkled and slack, and for isotropic tissue uniaxial tension while it wrinkles: St. Venant-Kirchhoff stretched by
/// λ stores ½ E G² then, G = (λ² − 1) / 2, whatever the other stretch.
#[test]
fn wrinkled_tissue_carries_tension_only() {
    for law in laws() {
        for (stretches, wrinkled) in [
            ([1.3, 1.2, 0.4], false),
            ([1.3, 0.5, 0.4], true),
            ([1.2, 0.3, 1.2], true),
            ([1.05, 0.9, 0.1], true),
        ] {
            let at = metric(stretches);
            let response = tension_field::response(&law, &at);
            assert_response(
                |c| tension_field::response(&law, c),
                &at,
                &format!("{law:?} {stretches:?}"),
            );
            let stress = nalgebra::Matrix2::new(
                response.slope_mpa[0],
                0.5 * response.slope_mpa[2],
                0.5 * response.slope_mpa[2],
                response.slope_mpa[1],
            );
            let least = stress.symmetric_eigenvalues().min();
            assert!(least >= -1e-9 * stress.amax(), "{law:?} {stretches:?} {stress}");
            let full = law.response(&at).energy_mpa;
            assert_eq!(
                response.energy_mpa < full * (1.0 - 1e-9),
                wrinkled,
                "{law:?} {stretches:?}"
            );
        }
        let slack = tension_field::response(&law, &metric([0.9, 0.7, 0.3]));
        assert_eq!(slack, membrane::Response::default());
    }
    let response = tension_field::response(&st_venant_kirchhoff(), &metric([1.3, 0.4, 0.9]));
    let green = (1.3_f64.powi(2) - 1.0) / 2.0;
    assert!((response.energy_mpa / (0.5 * 0.4 * green * green) - 1.0).abs() < 1e-9);
}

/// Two triangles of two tissues, in the plane or bent, with fibres that lie askew.
fn pair_of_triangles(laws: [Law; 2], wrinkles: bool, random: &mut Random) -> (Membranes, Vec<Vec3>) {
    let rest = [[0.0, 0.0], [1.2, 0.1], [0.4, 0.9], [1.5, 1.1]].map(|[x, y]| Vec3::new(x, y, 0.1 * x));
    let mut membranes = Membranes {
        tissues: laws.map(|law| Tissue { law, wrinkles }).to_vec(),
        ..Membranes::default()
    };
    let fibre = Vec3::new(1.0, 0.4, -0.3);
    membranes.push([0, 1, 2], 0, 0.7, &rest, fibre);
    membranes.push([2, 1, 3], 1, 1.1, &rest, fibre);
    let stretched = rest.map(|p| Vec3::new(1.25 * p.x + 0.1 * p.y, 1.15 * p.y, p.z) + random.vector() * 0.08);
    (membranes, stretched.to_vec())
}

#[test]
fn membranes_of_every_law() {
    let mut random = Random(11);
    for law in laws() {
        for wrinkles in [false, true] {
            let (membranes, positions) =
                pair_of_triangles([law, st_venant_kirchhoff()], wrinkles, &mut random);
            let term = Term {
                energy: &|x| membrane::energy(&membranes, x),
                gradient: &|x| gradient_of(4, |g| membrane::add_gradient(&membranes, x, g)),
                hessian: &|x, _| dense(4, |sink| membrane::add_hessian(&membranes, x, sink)),
            };
            assert_all(&term, &positions);
        }
    }
}

/// Delingette 2008, "Triangular springs for modeling nonlinear membranes": St. Venant-Kirchhoff on a triangle is
/// W = Σ kⱼ/4 dⱼ² + Σ cⱼ/2 dₖ dₗ with dⱼ = lⱼ² − Lⱼ², kⱼ = (2 cot²αⱼ (λ + μ) + μ) / 16 A, cⱼ = (2 cot αₖ cot αₗ (λ + μ) − μ) / 16 A,
/// λ = E t ν / (1 − ν²) and μ = E t / (1 + ν), twice the usual one. 1e-12: rounding.
#[test]
fn st_venant_kirchhoff_is_the_triangular_biquadratic_spring() {
    let mut random = Random(12);
    for _ in 0..100 {
        let rest = [0; 3].map(|_| random.vector() * 3.0);
        let now = [0; 3].map(|_| random.vector() * 3.0);
        let (thickness, modulus, ratio) = (0.8, 0.4, 0.45);
        let mut membranes = Membranes {
            tissues: vec![Tissue {
                law: st_venant_kirchhoff(),
                wrinkles: false,
            }],
            ..Membranes::default()
        };
        membranes.push([0, 1, 2], 0, thickness, &rest, random.vector());
        let (lambda, mu) = (
            modulus * thickness * ratio / (1.0 - ratio * ratio),
            modulus * thickness / (1.0 + ratio),
        );
        let area = 0.5 * (rest[1] - rest[0]).cross(&(rest[2] - rest[0])).norm();
        let squared = |p: &[Vec3; 3], j: usize| (p[(j + 1) % 3] - p[(j + 2) % 3]).norm_squared();
        let cotangent = |j: usize| {
            (squared(&rest, (j + 1) % 3) + squared(&rest, (j + 2) % 3) - squared(&rest, j)) / (4.0 * area)
        };
        let d = |j: usize| squared(&now, j % 3) - squared(&rest, j % 3);
        let biquadratic: f64 = (0..3)
            .map(|j| {
                let k = (2.0 * cotangent(j).powi(2) * (lambda + mu) + mu) / (16.0 * area);
                let across = cotangent((j + 1) % 3) * cotangent((j + 2) % 3);
                let c = (2.0 * across * (lambda + mu) - mu) / (16.0 * area);
                k / 4.0 * d(j).powi(2) + c / 2.0 * d(j + 1) * d(j + 2)
            })
            .sum();
        let ours = membrane::energy(&membranes, &now);
        assert!((ours / biquadratic - 1.0).abs() < 1e-12, "{ours} {biquadratic}");
    }
}

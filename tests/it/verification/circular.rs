//! A flat circular membrane, clamped all round, blown up by pressure. It starts exactly flat, where nothing resists pressure
//! at all.

use coapt::Vec3;
use coapt::energy::membrane::Law as MembraneLaw;
use coapt::model::Model;

use super::laws::stresses_mpa;
use super::references::{Law, biot, follower, hencky, spring_mean};
use super::{error, full, oracle, order, report, settled};
use crate::shapes::{
    Mesh, SpringTissue, disk, hold, neo_hookean, skinned, sprung, st_venant_kirchhoff, taut,
};

const RADIUS_MM: f64 = 10.0;
const THICKNESS_MM: f64 = 0.5;
const MODULUS_MPA: f64 = 1.0;
/// Modulus times thickness [N/mm].
const STIFFNESS_N_PER_MM: f64 = MODULUS_MPA * THICKNESS_MM;

/// Crown over radius and volume over radius³ of the inflated disk [1], q = p a / (E h).
fn inflated(mesh: &Mesh, q: f64) -> [f64; 2] {
    blown_up(
        mesh,
        sprung(mesh, SpringTissue::linear(STIFFNESS_N_PER_MM), pressure_mpa(q)),
    )
}

/// The same on a mesh that takes a few milliseconds.
pub(crate) fn inflated_coarsely(q: f64) -> [f64; 2] {
    inflated(&disk(6, RADIUS_MM), q)
}

/// The same for a disk of membrane.
fn inflated_membrane(mesh: &Mesh, law: MembraneLaw, q: f64) -> [f64; 2] {
    blown_up(mesh, skinned(mesh, taut(law), THICKNESS_MM, pressure_mpa(q)))
}

fn pressure_mpa(q: f64) -> f64 {
    q * STIFFNESS_N_PER_MM / RADIUS_MM
}

fn blown_up(mesh: &Mesh, mut model: Model) -> [f64; 2] {
    hold(&mut model, &mesh.rim);
    let positions = settled("disk", &model, mesh.points_mm.clone()).state.positions_mm;
    let crown = positions.iter().map(|x| x.z).fold(0.0, f64::max);
    [crown / RADIUS_MM, mesh.volume_mm3(&positions) / RADIUS_MM.powi(3)]
}

/// The series is that of another program; every number to the digits of that program.
#[test]
fn hencky_series_is_the_oracles() {
    let Some(values) = oracle("reference_values.json") else {
        return;
    };
    for row in values["hencky_foppl"]["rows"].as_array().expect("rows") {
        let number = |key: &str| row[key].as_f64().expect("a number");
        let ours = hencky(number("nu"));
        for (found, key) in [
            (ours.crown, "w0_over_a_q13"),
            (ours.centre_stress, "sig_r_centre"),
            (ours.rim_stress, "sig_r_edge"),
            (ours.volume, "V_over_pi_a3_q13"),
        ] {
            // 60 terms; nu = 1/3 and 0.5 converge slowest.
            assert!(error(found, number(key)) < 1e-9, "{key}: {found} {row}");
        }
    }
}

/// So is the shooting: 150 steps of fourth order against 1500.
#[test]
fn follower_shooting_is_the_oracles() {
    let Some(values) = oracle("circular_follower.json") else {
        return;
    };
    for row in values["rows"].as_array().expect("rows") {
        let number = |key: &str| row[key].as_f64().expect("a number");
        let (q, nu) = (number("q"), number("nu"));
        // At 1e-6 rounding rules in both programs.
        if q < 1e-5 {
            continue;
        }
        let ours = follower(&biot(nu), q, nu);
        assert!(error(ours.crown, number("w0_over_a")) < 1e-5, "{row} {ours:?}");
        assert!(
            error(ours.centre_strain, number("centre_strain")) < 1e-4,
            "{row} {ours:?}"
        );
        assert!(error(ours.volume, number("V_over_a3")) < 1e-5, "{row} {ours:?}");
    }
}

/// Small pressure: Hencky's crown within 0.3 % and volume within 0.5 % at 1000 triangles; they are 0.13 and 0.26 % off, of which
/// 0.05 % is that Hencky's load does not follow the surface.
#[test]
fn a_spring_disk_rises_as_henckys() {
    let q: f64 = 1e-4;
    let exact = hencky(1.0 / 3.0);
    let mesh = disk(13, RADIUS_MM);
    let found = inflated(&mesh, q);
    let errors = [
        error(found[0], exact.crown * q.cbrt()),
        error(found[1], exact.volume * std::f64::consts::PI * q.cbrt()),
    ];
    report(&format!(
        "Hencky, springs, {} triangles: crown {:.3} %, volume {:.3} %",
        mesh.faces.len(),
        100.0 * errors[0],
        100.0 * errors[1]
    ));
    assert!(errors[0] < 0.003 && errors[1] < 0.005, "{errors:?}");
}

/// Halved edges leave a quarter of the error, chords in place of the circle's arcs included; down to a few 1e-5, where it is seen
/// that a lattice is its mean over orientations only nearly.
#[test]
fn a_spring_disk_converges_with_the_square_of_its_edges() {
    let q = 1e-2;
    let exact = follower(&spring_mean, q, 1.0 / 3.0);
    let sizes: &[i32] = if full() { &[4, 8, 16, 32] } else { &[4, 8, 16] };
    let errors: Vec<[f64; 2]> = sizes
        .iter()
        .map(|&rings| {
            let [crown, volume] = inflated(&disk(rings, RADIUS_MM), q);
            [error(crown, exact.crown), error(volume, exact.volume)]
        })
        .collect();
    report_orders("disk, springs", sizes, &errors);
}

/// Finite rotations and strains. The network's own continuum is met within 0.06 % in the crown; Hooke's law in Biot's strain,
/// which it is only while strains are small or equal, within 0.5 %.
#[test]
fn a_spring_disk_follows_the_shooting_at_any_pressure() {
    let mesh = disk(16, RADIUS_MM);
    // In the volume 1536 triangles lack 0.2 to 0.35 %, a good part of it between chords and circle.
    let laws: [(&str, Law, [f64; 2]); 2] = [
        ("Biot", &biot(1.0 / 3.0), [5e-3, 8e-3]),
        ("spring mean", &spring_mean, [1e-3, 4e-3]),
    ];
    for q in [1e-4, 1e-3, 1e-2, 0.03, 0.1, 0.3] {
        let [crown, volume] = inflated(&mesh, q);
        for (name, law, tolerances) in laws {
            let exact = follower(law, q, 1.0 / 3.0);
            report(&format!(
                "follower q = {q}: crown {crown:.6}, {name} {:.6} ({:+.3} %), volume {:+.3} %",
                exact.crown,
                100.0 * (crown / exact.crown - 1.0),
                100.0 * (volume / exact.volume - 1.0)
            ));
            assert!(error(crown, exact.crown) < tolerances[0], "{name} {q}");
            assert!(error(volume, exact.volume) < tolerances[1], "{name} {q}");
        }
    }
}

/// Blown to the wrong side first, it comes back through itself to the same shape.
#[test]
fn a_disk_blown_to_the_wrong_side_comes_back() {
    let mesh = disk(8, RADIUS_MM);
    let mut model = skinned(
        &mesh,
        taut(st_venant_kirchhoff(MODULUS_MPA, 0.45)),
        THICKNESS_MM,
        pressure_mpa(0.01),
    );
    hold(&mut model, &mesh.rim);
    let from = |height: f64| {
        let lift = |x: &Vec3| x + Vec3::z() * (height * (RADIUS_MM - x.norm_squared() / RADIUS_MM));
        let start = mesh.points_mm.iter().map(lift).collect();
        settled("disk", &model, start).state.positions_mm
    };
    let [flat, wrong] = [0.0, -0.4].map(from);
    let apart = flat
        .iter()
        .zip(&wrong)
        .map(|(a, b)| (a - b).norm())
        .fold(0.0, f64::max);
    // What residuals of 1e-6 leave.
    assert!(apart < 1e-5 && flat.iter().all(|x| x.z >= 0.0), "{apart}");
}

/// Small pressure, any Poisson ratio: well within 1 % at 1014 triangles.
#[test]
fn a_membrane_disk_rises_as_henckys() {
    let q: f64 = 1e-4;
    let mesh = disk(13, RADIUS_MM);
    for nu in [0.0, 0.2, 0.3, 1.0 / 3.0, 0.45] {
        let exact = hencky(nu);
        let found = inflated_membrane(&mesh, st_venant_kirchhoff(MODULUS_MPA, nu), q);
        let errors = [
            error(found[0], exact.crown * q.cbrt()),
            error(found[1], exact.volume * std::f64::consts::PI * q.cbrt()),
        ];
        report(&format!(
            "Hencky, St. Venant-Kirchhoff, ν {nu:.3}, {} triangles: crown {:.3} %, volume {:.3} %",
            mesh.faces.len(),
            100.0 * errors[0],
            100.0 * errors[1]
        ));
        assert!(errors[0] < 0.002 && errors[1] < 0.005, "{nu} {errors:?}");
    }
}

/// Finite rotations and strains, each law against the shooting with that law. Hooke's law in Biot's strain, which the oracle
/// shoots with, is another law where strains are not small: St. Venant and Kirchhoff's stiffens with the stretch.
#[test]
fn membrane_disks_follow_the_shooting_at_any_pressure() {
    let mesh = disk(16, RADIUS_MM);
    let laws = [
        (
            "St. Venant-Kirchhoff, ν 1/3",
            st_venant_kirchhoff(MODULUS_MPA, 1.0 / 3.0),
            1.0 / 3.0,
        ),
        (
            "St. Venant-Kirchhoff, ν 0.45",
            st_venant_kirchhoff(MODULUS_MPA, 0.45),
            0.45,
        ),
        ("neo-Hookean", neo_hookean(MODULUS_MPA / 3.0), 0.5),
    ];
    for (name, law, nu) in laws {
        for q in [1e-4, 1e-3, 1e-2, 0.03, 0.1, 0.3] {
            let [crown, volume] = inflated_membrane(&mesh, law, q);
            let exact = follower(&|a, b| stresses_mpa(&law, [a, b]), q, nu);
            let hooke = follower(&biot(nu), q, nu);
            report(&format!(
                "follower q = {q}, {name}: crown {crown:.6}, exact {:.6} ({:+.3} %; Biot's law {:+.2} %), volume {:+.3} %",
                exact.crown,
                100.0 * (crown / exact.crown - 1.0),
                100.0 * (crown / hooke.crown - 1.0),
                100.0 * (volume / exact.volume - 1.0)
            ));
            assert!(error(crown, exact.crown) < 1e-3, "{name} {q}");
            assert!(error(volume, exact.volume) < 4e-3, "{name} {q}");
        }
    }
}

/// Halved edges leave a quarter of the error.
#[test]
fn a_membrane_disk_converges_with_the_square_of_its_edges() {
    let (q, nu) = (1e-2, 0.45);
    let law = st_venant_kirchhoff(MODULUS_MPA, nu);
    let exact = follower(&|a, b| stresses_mpa(&law, [a, b]), q, nu);
    let sizes: &[i32] = if full() { &[4, 8, 16, 32, 64] } else { &[4, 8, 16] };
    let errors: Vec<[f64; 2]> = sizes
        .iter()
        .map(|&rings| {
            let [crown, volume] = inflated_membrane(&disk(rings, RADIUS_MM), law, q);
            [error(crown, exact.crown), error(volume, exact.volume)]
        })
        .collect();
    report_orders("disk, St. Venant-Kirchhoff, ν 0.45", sizes, &errors);
}

fn report_orders(name: &str, sizes: &[i32], errors: &[[f64; 2]]) {
    for (rings, [crown, volume]) in sizes.iter().zip(errors) {
        report(&format!(
            "{name}, {} triangles: crown {:.4} %, volume {:.4} %",
            6 * rings * rings,
            100.0 * crown,
            100.0 * volume
        ));
    }
    for pair in errors.windows(2) {
        let slopes = [0, 1].map(|i| order([2.0, 1.0], [pair[0][i], pair[1][i]]));
        report(&format!(
            "  order: crown {:.2}, volume {:.2}",
            slopes[0], slopes[1]
        ));
        assert!(slopes.iter().all(|&slope| slope > 1.7), "{slopes:?}");
    }
}

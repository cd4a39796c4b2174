//! The patch tests that springs fail, with membranes: whatever the mesh and the law, a boundary that is displaced affinely
//! carries the inside with it, exactly, for a triangle of constant strain can follow.

use coapt::energy::membrane::{Law, Tissue};
use coapt::relax::Equilibrium;
use coapt::{Mat3, Vec3};
use nalgebra::Rotation3;

use super::laws::{one_of_each, stresses_mpa};
use super::patch::{macneal_harder, macneal_harder_way};
use super::{error, order, report, settled};
use crate::shapes::{Mesh, hold, skinned, st_venant_kirchhoff, taut};

const THICKNESS_MM: f64 = 1e-3;

/// The plate whose corners go where a map takes them, from rest.
fn stretched(mesh: &Mesh, tissue: Tissue, map: impl Fn(Vec3) -> Vec3) -> Equilibrium {
    let mut model = skinned(mesh, tissue, THICKNESS_MM, 0.0);
    hold(&mut model, &mesh.rim);
    for held in &mut model.prescribed {
        held.target_mm = map(held.target_mm);
    }
    // Forces are counted in those of a strain of 1e-3; of those May and Newman's law has hardly any.
    model.settings.residual_tolerance = if matches!(tissue.law, Law::MayNewman(_)) {
        1e-6
    } else {
        1e-10
    };
    settled("patch", &model, mesh.points_mm.clone())
}

/// How far inner vertices are from where the map takes them [mm].
fn off_mm(mesh: &Mesh, equilibrium: &Equilibrium, map: impl Fn(Vec3) -> Vec3) -> f64 {
    let ways = equilibrium.state.positions_mm.iter().zip(&mesh.points_mm);
    ways.map(|(x, rest)| (x - map(*rest)).amax()).fold(0.0, f64::max)
}

/// Stretched by a tenth, sheared, turned in space and moved: within 1e-10 of the plate's length,
/// where springs are 37 % of a displacement off.
#[test]
fn every_membrane_passes_the_patch_test_at_large_strain() {
    let gradient = Rotation3::from_euler_angles(0.4, -0.3, 0.8).matrix()
        * Mat3::new(1.12, 0.05, 0.0, 0.02, 1.08, 0.0, 0.0, 0.0, 1.0);
    let map = |x: Vec3| gradient * x + Vec3::new(0.01, -0.02, 0.005);
    for (name, law) in one_of_each() {
        for wrinkles in [false, true] {
            for diagonal in [0, 1] {
                let mesh = macneal_harder(diagonal);
                let equilibrium = stretched(&mesh, Tissue { law, wrinkles }, map);
                let off = off_mm(&mesh, &equilibrium, map) / 0.24;
                report(&format!(
                    "patch, {name}, tension field {wrinkles}, diagonal {diagonal}: inner positions off {off:.1e}"
                ));
                assert!(off < 1e-10, "{name} {wrinkles} {diagonal}");
            }
        }
    }
}

/// `MacNeal` and Harder's own displacements, exact, and their stresses 1333.33, 1333.33 and 400 within 0.3 %: printed are those
/// of linear elasticity. Green's strain has products of displacement gradients besides, a thousandth of it, and stress per
/// unloaded area another; both become a tenth where the displacements do.
#[test]
fn st_venant_kirchhoff_passes_macneal_and_harders_patch() {
    for diagonal in [0, 1] {
        let mesh = macneal_harder(diagonal);
        let off = [1.0, 0.1].map(|scale| {
            let map = |x: Vec3| x + macneal_harder_way(x) * scale;
            let tissue = taut(st_venant_kirchhoff(1e6, 0.25));
            let equilibrium = stretched(&mesh, tissue, map);
            let displacement = off_mm(&mesh, &equilibrium, map) / (3e-4 * scale);
            let model = skinned(&mesh, tissue, THICKNESS_MM, 0.0);
            let positions = &equilibrium.state.positions_mm;
            let stresses = model.membranes.metrics(positions).into_iter().map(|metric| {
                let slope = tissue.response(&metric).slope_mpa;
                [2.0 * slope[0], 2.0 * slope[1], slope[2]]
            });
            let linear = [4000.0 / 3.0, 4000.0 / 3.0, 400.0].map(|stress| stress * scale);
            let of_triangle = |found: [f64; 3]| (0..3).map(|i| error(found[i], linear[i])).fold(0.0, f64::max);
            let stress = stresses.map(of_triangle).fold(0.0, f64::max);
            report(&format!(
                "MacNeal-Harder, St. Venant-Kirchhoff, diagonal {diagonal}, displacements times {scale}: inner displacement off {displacement:.1e}, stress {stress:.1e} from the linear one"
            ));
            assert!(displacement < 1e-9);
            stress
        });
        assert!(off[0] < 3e-3);
        assert!((order([1.0, 0.1], off) - 1.0).abs() < 0.02);
    }
}

/// What the supports carry is the law's nominal stress on the unloaded sides, whatever the law: the right side is pulled by
/// P₁ t 0.12, the upper one by P₂ t 0.24, with stresses from the laws as they are written, by differences.
#[test]
fn supports_of_a_stretched_plate_carry_the_laws_stress() {
    let stretches = [1.15, 1.08];
    let map = |x: Vec3| Vec3::new(stretches[0] * x.x, stretches[1] * x.y, 0.0);
    for (name, law) in one_of_each() {
        let mesh = macneal_harder(0);
        let carried = stretched(&mesh, taut(law), map).reactions_n;
        let exact = stresses_mpa(&law, stretches);
        // The valve pulls its supports inwards.
        let right = -(carried[1] + carried[2]).x / (THICKNESS_MM * 0.12);
        let upper = -(carried[2] + carried[3]).y / (THICKNESS_MM * 0.24);
        let off = [error(right, exact[0]), error(upper, exact[1])];
        report(&format!(
            "plate stretched by {stretches:?}, {name}: stresses {right:.5} {upper:.5} MPa, off {:.1e} {:.1e}",
            off[0], off[1]
        ));
        // Central differences with steps of 1e-5.
        assert!(off.iter().all(|&off| off < 1e-6), "{name}");
    }
}

//! Alignment of moved and changed shapes.

use nalgebra::{Isometry3, Rotation3};

use super::super::*;
use super::{compared, hills, moved, surface_rows};

/// A copy of one mesh, moved: each node by as much as it was, and after alignment nowhere. The motion found undoes the
/// one made.
#[test]
fn a_moved_copy() {
    let reference = hills(20);
    let shift = moved(&reference, &Isometry3::translation(0.3, 0.4, 1.2));
    let d = compared(&shift, &reference).as_given.whole.node_to_node.unwrap();
    assert!((d.mean_mm - 1.3).abs() < 1e-12 && d.sd_mm < 1e-12 && (d.max_mm - 1.3).abs() < 1e-12);
    let motion = Isometry3::new(Vec3::new(2.0, -1.0, 1.5), Vec3::new(0.05, -0.03, 0.08));
    let found = compared(&moved(&reference, &motion), &reference);
    assert!(found.nodes_correspond && found.alignment.method == AlignmentMethod::Nodes);
    assert!((found.alignment.rotation_deg - motion.rotation.angle().to_degrees()).abs() < 1e-9);
    assert!(found.aligned.whole.node_to_node.unwrap().max_mm < 1e-12);
    assert!(
        surface_rows(&found.aligned.whole)
            .iter()
            .all(|d| d.max_mm < 1e-12)
    );
    assert!(found.as_given.whole.result_to_reference.unwrap().mean_mm > 0.5);
}

/// The same, with the faces in another order, so that nothing says which node is which: the surfaces find each other
/// all the same, in few steps, from 3 mm and 6 degree away. What is left is the rounding of 40 mm, far below 1e-6.
#[test]
fn a_moved_copy_of_unknown_nodes() {
    let reference = hills(20);
    let motion = Isometry3::new(Vec3::new(2.0, -1.0, 1.5), Vec3::new(0.05, -0.03, 0.08));
    let mut result = moved(&reference, &motion);
    result.faces.reverse();
    let found = compared(&result, &reference);
    assert!(!found.nodes_correspond && found.alignment.method == AlignmentMethod::Surface);
    assert!(
        surface_rows(&found.aligned.whole).iter().all(|d| d.max_mm < 1e-9),
        "{:?}",
        found.alignment
    );
    assert!(
        found.alignment.converged && found.alignment.iterations <= 20,
        "{:?}",
        found.alignment
    );
    assert!((found.alignment.rotation_deg - motion.rotation.angle().to_degrees()).abs() < 1e-8);
}

/// Alignment ends where no small motion lowers the root mean square: of a surface that is no copy, at a minimum in all
/// six directions. Steps of 0.01 mm and 0.0005 rad raise it by more than rounding.
#[test]
fn alignment_ends_at_a_minimum() {
    let (mut result, reference) = (hills(17), hills(20));
    result
        .points_mm
        .iter_mut()
        .for_each(|p| p.z += 0.5 * (0.4 * p.x + 0.3 * p.y).sin());
    let motion = Isometry3::new(Vec3::new(1.0, 1.0, 0.5), Vec3::new(0.02, 0.03, -0.02));
    let result = moved(&result, &motion);
    let found = compared(&result, &reference);
    let best = found.aligned.whole.result_to_reference_by_area.unwrap().rms_mm;
    assert!((found.alignment.rms_mm[1] - best).abs() < 1e-12 && best < found.alignment.rms_mm[0]);
    let mut at_best = result.clone();
    at_best
        .points_mm
        .iter_mut()
        .for_each(|p| *p = found.alignment.moved(*p));
    let middle = Vec3::new(20.0, 20.0, 0.0);
    for axis in [Vec3::x(), Vec3::y(), Vec3::z()] {
        for sign in [-1.0, 1.0] {
            let shift = Isometry3::new(axis * 0.01 * sign, Vec3::zeros());
            let turn = Rotation3::new(axis * 0.0005 * sign);
            let turn = Isometry3::new(middle - turn * middle, axis * 0.0005 * sign);
            for step in [shift, turn] {
                let near = compared(&moved(&at_best, &step), &reference).as_given.whole;
                let rms = near.result_to_reference_by_area.unwrap().rms_mm;
                assert!(rms > best + 1e-9, "{axis} {sign}: {rms} {best}");
            }
        }
    }
}

//! Surfaces with distances known by hand.

mod distances;
mod motions;
mod odd;
mod parts;

use std::f64::consts::TAU;

use nalgebra::Isometry3;

use super::*;
use crate::measure::DistanceStatistics;
use crate::measure::test_models::sheet;
use crate::model::Model;

/// A model's leaflets as they stand.
fn plain(model: &Model) -> ComparedSurface {
    ComparedSurface {
        name: "valve".into(),
        points_mm: model.rest_mm.clone(),
        faces: model.faces.clone(),
        ..ComparedSurface::default()
    }
}

/// A flat square, `n` squares a side, that looks up.
fn flat(n: usize, size_mm: f64) -> ComparedSurface {
    let mut surface = plain(&sheet(n, size_mm, 1));
    surface.faces.iter_mut().for_each(|face| face.swap(0, 1));
    surface
}

/// A flat square of 20 mm, `n` squares a side, at a height.
fn square(n: usize, height_mm: f64) -> ComparedSurface {
    let mut surface = flat(n, 20.0);
    surface.points_mm.iter_mut().for_each(|p| p.z = height_mm);
    surface
}

/// A bowl: the lower part of a sphere, `rings` deep and `6 · rings` around, turned about its axis by an angle, its
/// faces to the inside.
fn bowl(radius_mm: f64, rings: u32, angle: f64) -> ComparedSurface {
    let around = 6 * rings;
    let mut points_mm = vec![Vec3::new(0.0, 0.0, -radius_mm)];
    let mut faces = Vec::new();
    for ring in 1..=rings {
        let polar = TAU / 6.0 * f64::from(ring) / f64::from(rings);
        for k in 0..around {
            let (sin, cos) = (TAU * f64::from(k) / f64::from(around) + angle).sin_cos();
            points_mm.push(Vec3::new(polar.sin() * cos, polar.sin() * sin, -polar.cos()) * radius_mm);
            let [a, b] = [k, (k + 1) % around].map(|k| 1 + (ring - 1) * around + k);
            match ring {
                1 => faces.push([0, a, b]),
                _ => faces.extend([[a - around, a, b], [a - around, b, b - around]]),
            }
        }
    }
    ComparedSurface {
        name: "bowl".into(),
        points_mm,
        faces,
        ..ComparedSurface::default()
    }
}

/// Hills that no rigid motion maps on themselves, 40 mm wide, over a grid of `n` squares a side.
pub(super) fn hills(n: usize) -> ComparedSurface {
    let mut surface = flat(n, 40.0);
    for p in &mut surface.points_mm {
        p.z = 3.0 * (0.21 * p.x).sin() + 2.0 * (0.17 * p.y + 0.05 * p.x).cos() - 0.01 * p.x * p.y;
    }
    surface
}

pub(super) fn moved(surface: &ComparedSurface, motion: &Isometry3<f64>) -> ComparedSurface {
    let place = |p: &Vec3| motion.rotation * p + motion.translation.vector;
    ComparedSurface {
        points_mm: surface.points_mm.iter().map(place).collect(),
        ..surface.clone()
    }
}

fn compared(result: &ComparedSurface, reference: &ComparedSurface) -> Comparison {
    compare(result, reference, &CompareSettings::default()).unwrap()
}

fn surface_rows(d: &Definitions) -> Vec<DistanceStatistics> {
    let rows = [
        d.result_to_reference,
        d.result_to_reference_by_area,
        d.reference_to_result,
        d.reference_to_result_by_area,
    ];
    rows.into_iter().flatten().collect()
}

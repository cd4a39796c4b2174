//! Numbers and arrays of them: finite, in range, of the right count.

use super::faults::Faults;
use crate::scene::{LARGEST, LineMesh, Readable, SurfaceMesh};

/// What is nearer to nothing is nothing.
const LEAST: f64 = 1e-9;

/// The range, for a number whose fault is to lie beyond its far ends.
fn range_beyond(value: f64, least: f64) -> Option<String> {
    let beyond = value.is_finite() && (value > LARGEST || (0.0 < value && value < least));
    beyond.then(|| format!("{} to {}", Readable(least), Readable(LARGEST)))
}

/// A number above zero, not so small or large that arithmetic overflows.
pub(crate) fn positive(value: f64, place: &str, unit: &str, faults: &mut Faults) {
    if !(value.is_finite() && (LEAST..=LARGEST).contains(&value)) {
        let range = range_beyond(value, LEAST).unwrap_or_else(|| "a finite number above 0".into());
        faults.error(
            place,
            format!("is {} {unit}, expected {range}", Readable(value)).replace(" ,", ","),
        );
    }
}

pub(crate) fn not_negative(value: f64, place: &str, unit: &str, faults: &mut Faults) {
    if !(value.is_finite() && (0.0..=LARGEST).contains(&value)) {
        let range = range_beyond(value, 0.0).unwrap_or_else(|| "a finite number, 0 or above".into());
        faults.error(
            place,
            format!("is {} {unit}, expected {range}", Readable(value)).replace(" ,", ","),
        );
    }
}

/// Points or vectors; only the first bad one is named, with how many there are.
pub(crate) fn points(points: &[[f64; 3]], place: &str, element: &str, faults: &mut Faults) {
    let bad = |p: &[f64; 3]| p.iter().any(|c| !c.is_finite() || c.abs() > LARGEST);
    let count = points.iter().filter(|p| bad(p)).count();
    if let Some(first) = points.iter().position(bad) {
        let [x, y, z] = points[first].map(Readable);
        let largest = Readable(LARGEST);
        let message =
            format!("is ({x}, {y}, {z}), expected numbers from -{largest} to {largest} mm ({count} such)");
        faults.error(format!("{place} {element} {first}"), message);
    }
}

pub(crate) fn surface(mesh: &SurfaceMesh, place: &str, faults: &mut Faults) {
    let count = mesh.points_mm.len();
    if mesh.faces.is_empty() {
        faults.error(place, format!("has no triangles ({count} points)"));
    }
    points(&mesh.points_mm, place, "point", faults);
    let beyond = |face: &[u32; 3]| face.iter().any(|&v| v as usize >= count);
    if let Some(first) = mesh.faces.iter().position(beyond) {
        let bad = mesh.faces.iter().filter(|f| beyond(f)).count();
        let message = format!(
            "is {:?}, but there are {count} points ({bad} such)",
            mesh.faces[first]
        );
        faults.error(format!("{place} face {first}"), message);
    }
    for &point in mesh
        .annulus_points
        .iter()
        .flatten()
        .filter(|&&p| p as usize >= count)
        .take(1)
    {
        faults.error(
            format!("{place}.annulus_points"),
            format!("name point {point}, but there are {count}"),
        );
    }
    if let Some(moves) = &mesh.annulus_displacement_mm {
        same_count(
            moves.len(),
            count,
            &format!("{place}.annulus_displacement_mm"),
            "points",
            faults,
        );
        points(
            moves,
            &format!("{place}.annulus_displacement_mm"),
            "point",
            faults,
        );
    }
}

pub(crate) fn same_count(found: usize, expected: usize, place: &str, what: &str, faults: &mut Faults) {
    if found != expected {
        faults.error(
            place,
            format!("has {found} entries, but there are {expected} {what}"),
        );
    }
}

pub(crate) fn lines(mesh: &LineMesh, place: &str, faults: &mut Faults) {
    let count = mesh.points_mm.len();
    points(&mesh.points_mm, place, "point", faults);
    for (i, segment) in mesh.segments.iter().enumerate() {
        if segment.iter().any(|&p| p as usize >= count) {
            faults.error(
                format!("{place} segment {i}"),
                format!("is {segment:?}, but there are {count} points"),
            );
        } else if segment[0] == segment[1] {
            faults.error(
                format!("{place} segment {i}"),
                format!("joins point {} to itself", segment[0]),
            );
        }
    }
    let columns = [
        (&mesh.rest_length_mm, "rest_length_mm", "mm"),
        (&mesh.area_mm2, "area_mm2", "mm²"),
    ];
    for (values, key, unit) in columns {
        let Some(values) = values else { continue };
        same_count(
            values.len(),
            mesh.segments.len(),
            &format!("{place}.{key}"),
            "segments",
            faults,
        );
        for (i, &value) in values.iter().enumerate() {
            positive(value, &format!("{place}.{key} segment {i}"), unit, faults);
        }
    }
}

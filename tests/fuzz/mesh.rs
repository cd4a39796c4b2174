//! Any bytes as a mesh, a curve and a list of points: refused with faults, or read to something that can be written and
//! read again.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use crate::{check_defined, check_faults, scratch, within_memory};
use coapt::measure::compare::{CompareSettings, compare};
use coapt::scene::Fault;
use coapt_io::compare::read_surface;
use coapt_io::mesh::{Curve, PolyData, read_curve, read_mesh, read_points, write_markups_curve, write_vtp};

static FOLDER: LazyLock<PathBuf> = LazyLock::new(scratch);
/// Deflate packs at most 1032 times; what a number of the file becomes is larger than its bytes.
const MEMORY_PER_BYTE: u64 = 4000;
/// Comparing surfaces takes a hundred times as long as reading them: only so small ones are, and of these one in so many.
const MOST_COMPARED: usize = 64;
const ONE_COMPARED_IN: usize = 61;

/// One input.
pub fn mesh(bytes: &[u8]) {
    let file = FOLDER.join("input");
    std::fs::write(&file, bytes).expect("a file");
    let mut read = within_memory(bytes, MEMORY_PER_BYTE, || read_mesh(&file));
    check(&read);
    if read.is_err() {
        // What looks like no format may still be an STL that was cut, by its extension.
        let stl = FOLDER.join("input.stl");
        std::fs::write(&stl, bytes).expect("a file");
        read = within_memory(bytes, MEMORY_PER_BYTE, || read_mesh(&stl));
        check(&read);
    }
    if let Ok((mesh, _)) = &read {
        check_mesh(mesh);
        write_and_read(mesh);
        if bytes.len().is_multiple_of(ONE_COMPARED_IN)
            && mesh.triangles.len().max(mesh.points.len()) <= MOST_COMPARED
        {
            compare_with_itself(&file);
        }
    }
    let curve = within_memory(bytes, MEMORY_PER_BYTE, || read_curve(&file));
    check(&curve);
    if let Ok((curve, _)) = &curve {
        check_curve(curve);
    }
    let points = within_memory(bytes, MEMORY_PER_BYTE, || read_points(&file));
    check(&points);
    if let Ok((points, _)) = &points {
        check_defined(&points.points_mm);
        assert!(!points.points_mm.is_empty());
        assert_eq!(points.points_mm.len(), points.labels.len());
    }
}

fn check<T>(read: &Result<(T, Vec<Fault>), Vec<Fault>>) {
    match read {
        Ok((_, warnings)) => check_faults(warnings, false),
        Err(faults) => check_faults(faults, true),
    }
}

fn check_mesh(mesh: &PolyData) {
    let count = mesh.points.len() as u32;
    assert!(mesh.points.iter().flatten().all(|value| value.is_finite()));
    assert!(!mesh.triangles.is_empty() || !mesh.lines.is_empty());
    assert!(mesh.triangles.iter().flatten().all(|&point| point < count));
    assert!(mesh.lines.iter().flatten().all(|&point| point < count));
    assert!(mesh.triangles.iter().all(|&[a, b, c]| a != b && b != c && c != a));
    assert!(mesh.lines.iter().all(|&[a, b]| a != b));
    let fits = |sources: usize, cells: usize| sources == 0 || sources == cells;
    assert!(fits(mesh.triangle_source.len(), mesh.triangles.len()));
    assert!(fits(mesh.line_source.len(), mesh.lines.len()));
    for array in &mesh.point_arrays {
        assert!(array.components >= 1);
        assert_eq!(array.values.len(), array.components * mesh.points.len());
    }
    for array in &mesh.cell_arrays {
        assert!(array.components >= 1);
        assert_eq!(array.values.len() % array.components, 0);
        assert!((0..mesh.triangles.len()).all(|triangle| mesh.triangle_value(array, triangle).is_some()));
        assert!((0..mesh.lines.len()).all(|line| mesh.line_value(array, line).is_some()));
    }
}

fn write_and_read(mesh: &PolyData) {
    let file = FOLDER.join("written.vtp");
    let mut arrays = mesh.point_arrays.iter().chain(&mesh.cell_arrays);
    let whole = arrays.all(|array| array.values.iter().all(|value| value.is_finite()));
    let written = write_vtp(&file, mesh);
    // The one thing that is read, with a warning, and not written.
    assert_eq!(written.is_ok(), whole, "{written:?}");
    if !whole {
        return;
    }
    let (again, warnings) = read_mesh(&file).unwrap_or_else(|faults| panic!("{faults:#?}"));
    assert!(warnings.is_empty(), "{warnings:#?}");
    assert_eq!(mesh.points, again.points);
    assert_eq!(mesh.triangles, again.triangles);
    assert_eq!(mesh.lines, again.lines);
    assert_eq!(mesh.point_arrays, again.point_arrays);
    assert_eq!(mesh.cell_arrays.len(), again.cell_arrays.len());
    for (before, after) in mesh.cell_arrays.iter().zip(&again.cell_arrays) {
        assert_eq!(before.name, after.name);
        for triangle in 0..mesh.triangles.len() {
            assert_eq!(
                mesh.triangle_value(before, triangle),
                again.triangle_value(after, triangle)
            );
        }
        for line in 0..mesh.lines.len() {
            assert_eq!(mesh.line_value(before, line), again.line_value(after, line));
        }
    }
}

fn compare_with_itself(file: &Path) {
    let Ok((read, _)) = read_surface(file, "contact", u32::MAX) else {
        return;
    };
    if let Ok(comparison) = compare(&read.surface, &read.surface, &CompareSettings::default()) {
        assert!(comparison.nodes_correspond);
        check_defined(&comparison);
    }
}

fn check_curve(curve: &Curve) {
    check_defined(&curve.points_mm);
    assert!(curve.points_mm.len() >= if curve.closed { 3 } else { 2 });
    assert!(curve.labels.is_empty() || curve.labels.len() == curve.points_mm.len());
    let file = FOLDER.join("written.mrk.json");
    write_markups_curve(&file, "curve", curve).unwrap_or_else(|fault| panic!("{fault:?}"));
    let (again, warnings) = read_curve(&file).unwrap_or_else(|faults| panic!("{faults:#?}"));
    assert!(warnings.is_empty(), "{warnings:#?}");
    assert_eq!((&curve.points_mm, curve.closed), (&again.points_mm, again.closed));
}

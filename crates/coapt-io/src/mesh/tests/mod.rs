//! Every variant of every format gives the same mesh; every trap gives its message; no bytes make a reader panic.
//!
//! Here: the fixtures, and the mesh that they all hold. assets/meshes/README.md says how they were made.

use coapt::scene::{Severity, Space};

use super::*;

mod fuzzed;
mod spoilt;
mod traps;
mod variants;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/meshes");

/// What VTK can store all of: vertices, lines, triangles, a quad and arrays.
const VALVES: [&str; 20] = [
    "valve_legacy_30_ascii.vtk",
    "valve_legacy_42_ascii.vtk",
    "valve_legacy_42_binary.vtk",
    "valve_legacy_51_ascii.vtk",
    "valve_legacy_51_binary.vtk",
    "valve_grid_42_ascii.vtk",
    "valve_grid_42_binary.vtk",
    "valve_grid_51_ascii.vtk",
    "valve_grid_51_binary.vtk",
    "valve_ascii.vtp",
    "valve_appended_raw_u64.vtp",
    "valve_appended_raw_u32_big_endian.vtp",
    "valve_appended_raw_zlib.vtp",
    "valve_appended_raw_zlib_blocks.vtp",
    "valve_appended_base64.vtp",
    "valve_appended_base64_zlib.vtp",
    "valve_appended_base64_zlib_blocks.vtp",
    "valve_inline_binary.vtp",
    "valve_inline_binary_zlib_blocks.vtp",
    "valve_inline_binary_zlib_u64_big_endian.vtp",
];

/// Its surface alone.
const SURFACES: [&str; 6] = [
    "surface_ascii.ply",
    "surface_binary.ply",
    "surface_binary_big_endian.ply",
    "surface_ascii.stl",
    "surface_binary.stl",
    "surface.obj",
];

const STRIPS: [&str; 2] = ["strips_legacy_42_ascii.vtk", "strips_legacy_51_ascii.vtk"];

fn fixture(name: &str) -> Vec<u8> {
    std::fs::read(Path::new(FOLDER).join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

type Read = Result<(PolyData, Vec<Fault>), Vec<Fault>>;

fn parse(name: &str, bytes: &[u8]) -> Read {
    let mut faults = Faults::new(name.to_owned());
    let extension = Path::new(name)
        .extension()
        .and_then(|extension| extension.to_str());
    let mesh = parse_mesh(bytes, extension, &mut faults);
    faults.finish(mesh)
}

fn read(name: &str) -> (PolyData, Vec<Fault>) {
    read_mesh(&Path::new(FOLDER).join(name)).unwrap_or_else(|faults| panic!("{name}: {faults:?}"))
}

/// The faults as text, without the folder.
fn said(faults: &[Fault]) -> Vec<String> {
    faults
        .iter()
        .map(|fault| format!("{}: {}", fault.place, fault.message))
        .collect()
}

/// The errors, if it is refused.
fn refusal(name: &str, bytes: &[u8]) -> Vec<String> {
    match parse(name, bytes) {
        Ok((mesh, _)) => panic!("{name} was read: {mesh:?}"),
        Err(mut faults) => {
            faults.retain(|fault| fault.severity == Severity::Error);
            said(&faults)
        }
    }
}

/// A fixture with one text replaced by another; panics if there is nothing to replace.
fn edited(name: &str, old: &str, new: &str) -> Vec<u8> {
    let bytes = fixture(name);
    let at = bytes.windows(old.len()).position(|part| part == old.as_bytes());
    let at = at.unwrap_or_else(|| panic!("{name} has no `{old}`"));
    [&bytes[..at], new.as_bytes(), &bytes[at + old.len()..]].concat()
}

/// The mesh of `assets/meshes/make_fixtures.py`, written down independently of any reader.
fn valve() -> PolyData {
    let array = |name: &str, components, values: Vec<f64>| Array {
        name: name.to_owned(),
        components,
        values,
    };
    let up_to = |count: u32| (0..count).map(f64::from);
    PolyData {
        points: vec![
            [0.0, 0.0, 0.0],
            [10.0, 0.0, 1.5],
            [20.0, 0.0, 0.0],
            [0.0, 8.0, 0.25],
            [10.0, 8.0, 2.125],
            [20.0, 8.0, 0.25],
            [0.0, 16.0, 0.5],
            [10.0, 16.0, 2.5],
            [20.0, 16.0, 0.5],
            [5.0, 4.0, -12.0],
            [5.0, 4.0, -18.75],
        ],
        // The quad 3 4 7 6 is cell 7; its diagonal 4 6 is the shorter.
        triangles: vec![
            [0, 1, 4],
            [0, 4, 3],
            [1, 2, 5],
            [1, 5, 4],
            [3, 4, 6],
            [4, 7, 6],
            [4, 5, 8],
            [4, 8, 7],
        ],
        triangle_source: vec![3, 4, 5, 6, 7, 7, 8, 9],
        lines: vec![[10, 9], [9, 3], [9, 4]],
        line_source: vec![1, 1, 2],
        point_arrays: vec![
            array("annulus", 1, up_to(11).map(|i| f64::from(i < 3.0)).collect()),
            array(
                "displacement",
                3,
                up_to(11).flat_map(|i| [-i * 0.5, i * 0.25, 0.125]).collect(),
            ),
            array("wall thickness é", 1, up_to(11).map(|i| i * 0.0625).collect()),
        ],
        cell_arrays: vec![
            array("leaflet", 1, up_to(10).map(|i| (i / 4.0).floor()).collect()),
            array("rest_length_mm", 1, up_to(10).map(|i| i * 1.5).collect()),
        ],
        space: Some(Space::LPS),
    }
}

/// Corner coordinates of all triangles: what is left when points are numbered differently.
fn corners(mesh: &PolyData) -> Vec<[[f64; 3]; 3]> {
    mesh.triangles
        .iter()
        .map(|triangle| triangle.map(|point| mesh.points[point as usize]))
        .collect()
}

//! What is read, what is refused, and what comes out.

use std::path::PathBuf;

use super::*;
use crate::mesh::{read_mesh, write_vtp};

/// A folder that is gone at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("coapt-compare-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A trough of two squares, 10 mm long, whose valley may lie lower; the far half in contact.
fn trough(depth: f64) -> PolyData {
    let point = |i: usize| {
        let (x, y) = ((i % 3) as f64 * 10.0, (i / 3) as f64 * 10.0);
        [x, y, if i % 3 == 1 { -depth } else { 0.0 }]
    };
    PolyData {
        points: (0..6).map(point).collect(),
        triangles: vec![[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]],
        point_arrays: vec![Array {
            name: "contact".into(),
            components: 1,
            values: (0..6).map(|i| f64::from(i / 3)).collect(),
        }],
        ..PolyData::default()
    }
}

fn report_of(folder: &Folder, change: impl Fn(&mut PolyData)) -> (ReadSurface, ComparisonReport) {
    let write = |name: &str, mesh: &PolyData| {
        let path = folder.0.join(name);
        write_vtp(&path, mesh).unwrap();
        read_surface(&path, "contact", u32::MAX).unwrap().0
    };
    let mut result = trough(3.0);
    change(&mut result);
    let (result, reference) = (write("result.vtp", &result), write("reference.vtp", &trough(2.0)));
    let settings = CompareSettings::default();
    let report = ComparisonReport::new(&result, &reference, &settings, "contact", vec![]).unwrap();
    (result, report)
}

/// The map comes back from its file as it was, and a second writing gives the same bytes.
#[test]
fn the_error_map_is_written() {
    let folder = Folder::new("map");
    let (result, report) = report_of(&folder, |_| {});
    let bytes = || {
        let out = folder.0.join("out");
        write_comparison(&out, &result.mesh, &report).unwrap();
        ["comparison.json", "error.vtp"].map(|name| std::fs::read(out.join(name)).unwrap())
    };
    assert_eq!(bytes(), bytes());
    let (map, _) = read_mesh(&folder.0.join("out/error.vtp")).unwrap();
    assert_eq!(
        (&map.points, &map.triangles),
        (&result.mesh.points, &result.mesh.triangles)
    );
    let values = |name: &str| &map.point_array(name).unwrap().values;
    assert_eq!(values("distance_mm"), &report.comparison.map.distance_mm);
    // The valley lies 1 mm under one whose walls fall by 2 in 10: 1 / √1.04 away, on the side of the ventricle.
    assert!(
        (values("signed_distance_mm")[1] + 1.0).abs() < 1e-12,
        "{:?}",
        values("signed_distance_mm")
    );
    assert_eq!(values("contact"), &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
    assert!(values("visible").iter().all(|&seen| seen == 1.0));
    assert_eq!(values("aligned_distance_mm").len(), 6);
    let json: serde_json::Value = serde_json::from_slice(&bytes()[0]).unwrap();
    assert_eq!(json["schema"], COMPARISON_SCHEMA);
    let nodes = &json["as_given"]["whole"]["node_to_node"];
    assert!((nodes["mean_mm"].as_f64().unwrap() - 1.0 / 3.0).abs() < 1e-12);
    assert_eq!(json["aligned"]["in_contact"]["node_to_node"]["count"], 3);
    assert_eq!(json["alignment"]["method"], "nodes");
}

/// Every definition has a row in every part, all columns end in one place, and nothing but paths is wider than a
/// screen of 100 letters.
#[test]
fn the_table_is_aligned() {
    let folder = Folder::new("table");
    let (_, mut report) = report_of(&folder, |_| {});
    report.warnings = vec!["word ".repeat(60)];
    let text = text(&report);
    let wide = |line: &&str| line.chars().count() > 100 && !line.contains(".vtp");
    assert_eq!(text.lines().find(wide), None);
    let rows: Vec<&str> = text
        .lines()
        .filter(|line| line.contains(" -> ") && line.starts_with("  "))
        .collect();
    assert_eq!(
        rows.iter()
            .filter(|row| row.ends_with(|c: char| c.is_ascii_digit()))
            .count(),
        2 * 4 * 6
    );
    let widths: Vec<usize> = rows[..48].iter().map(|row| row.len()).collect();
    assert!(widths.iter().all(|&width| width == widths[0]), "{text}");
    assert!(text.ends_with("research use, not a medical device\n"));
}

/// What only one file knows, or none, is said and not guessed.
#[test]
fn what_is_not_known_is_said() {
    let folder = Folder::new("unknown");
    let (_, report) = report_of(&folder, |mesh| mesh.point_arrays.clear());
    assert!(
        text(&report).contains("contact    known of the reference only: the result has not a point array")
    );
    let folder = Folder::new("other-mesh");
    let (_, report) = report_of(&folder, |mesh| mesh.triangles.swap(0, 1));
    let text = text(&report);
    assert!(
        text.contains("meshes     differ: no distance from node to node") && !text.contains("node -> node")
    );
    assert!(text.contains("ICP"));
}

/// A folder means its closed valve; one of a plan must be chosen from, and another is refused.
#[test]
fn folders_are_understood() {
    let folder = Folder::new("folders");
    let refused = |path: &Path| {
        read_surface(path, "contact", u32::MAX).unwrap_err()[0]
            .message
            .clone()
    };
    assert!(refused(&folder.0).contains("is a folder without closed.vtp"));
    std::fs::create_dir_all(folder.0.join("after")).unwrap();
    write_vtp(&folder.0.join("after/closed.vtp"), &trough(1.0)).unwrap();
    let message = refused(&folder.0);
    assert!(
        message.contains("before and after a plan") && message.contains("after"),
        "{message}"
    );
    assert!(read_surface(&folder.0.join("after"), "contact", u32::MAX).is_ok());
    write_vtp(&folder.0.join("closed.vtp"), &trough(1.0)).unwrap();
    let (read, _) = read_surface(&folder.0, "contact", u32::MAX).unwrap();
    assert!(read.surface.name.ends_with("closed.vtp"));
    assert!(refused(&folder.0.join("missing.vtp")).contains("No such file"));
}

/// Marks that are no marks are refused; lines alone are no surface.
#[test]
fn marks_and_surfaces_are_checked() {
    let folder = Folder::new("marks");
    let path = folder.0.join("a.vtp");
    let mut mesh = trough(1.0);
    mesh.point_arrays[0].components = 2;
    mesh.point_arrays[0].values = vec![0.0; 12];
    write_vtp(&path, &mesh).unwrap();
    let message = read_surface(&path, "contact", u32::MAX).unwrap_err()[0]
        .message
        .clone();
    assert_eq!(
        message,
        "point array `contact` has 12 values, expected one for each of 6 points"
    );
    let legacy = |values: &str| {
        let path = folder.0.join("a.vtk");
        let head =
            "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0 9 0 0 0 9 0\n";
        let tail = "POINT_DATA 3\nSCALARS contact float 1\nLOOKUP_TABLE default\n";
        std::fs::write(&path, format!("{head}{values}{tail}0 nan 1\n")).unwrap();
        read_surface(&path, "contact", u32::MAX)
    };
    let message = legacy("POLYGONS 1 4\n3 0 1 2\n").unwrap_err()[0].message.clone();
    assert!(
        message.starts_with("point array `contact` is NaN at point 1"),
        "{message}"
    );
    let lines = PolyData {
        triangles: vec![],
        lines: vec![[0, 1]],
        ..trough(1.0)
    };
    write_vtp(&path, &lines).unwrap();
    let (read, _) = read_surface(&path, "contact", u32::MAX).unwrap();
    let faults =
        ComparisonReport::new(&read, &read, &CompareSettings::default(), "contact", vec![]).unwrap_err();
    assert!(faults[0].message.starts_with("has no faces"), "{faults:?}");
}

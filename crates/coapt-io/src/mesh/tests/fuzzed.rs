//! What fuzzing found, and what was found by reading for the same reasons: files that made faults without end, that took the
//! square of their length, or whose arrays did not fit. `fuzz/README.md` says how it is run.

use super::*;

#[test]
fn a_fault_quotes_a_long_word_in_part() {
    let word = "[".repeat(5000);
    let digits = "9".repeat(5000);
    for (name, text) in [
        (
            "a.vtp",
            format!("<?xml version=\"1.0\"?><VTKFile type=\"PolyData\"><{word}></a>"),
        ),
        ("a.obj", format!("v {digits} 0 0\n")),
        ("a.obj", format!("v 0,{digits} 0 0\n")),
    ] {
        let told = refusal(name, text.as_bytes());
        assert!(told.iter().all(|line| line.chars().count() < 1100), "{name}");
    }
}

#[test]
fn warnings_are_told_up_to_twenty() {
    let strings = "<DataArray type=\"String\" Name=\"a\" format=\"ascii\">0</DataArray>".repeat(30);
    let text = String::from_utf8(fixture("valve_ascii.vtp")).unwrap();
    let text = text.replacen("</PointData>", &format!("{strings}</PointData>"), 1);
    let (_, warnings) = parse("valve.vtp", text.as_bytes()).unwrap();
    assert_eq!(warnings.len(), 21, "{warnings:#?}");
    assert!(warnings[20].message.contains("more warnings"), "{warnings:#?}");
}

#[test]
fn points_and_cells_that_come_after_their_arrays_are_refused() {
    let head = "# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\n";
    let points = "POINTS 3 float\n0 0 0 1 0 0 0 1 0\n";
    let arrays = "POINT_DATA 3\nSCALARS a float\nLOOKUP_TABLE default\n1 2 3\n";
    let more = "POINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\nPOLYGONS 1 4\n3 0 1 2\n";
    assert_eq!(
        refusal("a.vtk", format!("{head}{points}{arrays}{more}").as_bytes()),
        ["a.vtk: array `a` is for 3 points, but there are 4"]
    );
    let early = "CELL_DATA 0\nSCALARS b float\nLOOKUP_TABLE default\nPOLYGONS 1 4\n3 0 1 2\n";
    assert_eq!(
        refusal("a.vtk", format!("{head}{points}{early}").as_bytes()),
        ["a.vtk: array `b` is for 0 cells, but there are 1"]
    );
}

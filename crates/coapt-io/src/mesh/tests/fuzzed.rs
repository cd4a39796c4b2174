//! What fuzzing found, and what was found by reading for the same reasons: files that made faults without end, that took the
//! square of their length, or whose arrays did not fit. `fuzz/README.md` says how it is run.

use std::fmt::Write;
use std::time::{Duration, Instant};

use super::*;

/// Far more than a file here takes if time grows with its length, far less than if with its square: minutes.
const LINEAR: Duration = Duration::from_secs(10);

fn timed(name: &str, bytes: &[u8]) -> Read {
    let start = Instant::now();
    let read = parse(name, bytes);
    assert!(start.elapsed() < LINEAR, "{name} took {:?}", start.elapsed());
    read
}

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

#[test]
fn two_elements_of_vertices_are_refused() {
    let twice =
        "element vertex 1\nproperty char x\nproperty char y\nproperty char z\nproperty char a\n".repeat(2);
    assert_eq!(
        refusal(
            "a.ply",
            format!("ply\nformat ascii 1.0\n{twice}end_header\n0 0 0 1\n0 0 1 1\n").as_bytes()
        ),
        ["a.ply: the header has two elements `vertex`; expected one"]
    );
}

#[test]
fn a_vertex_of_very_many_properties_is_read_in_the_time_of_its_length() {
    let mut text = String::from("ply\nformat ascii 1.0\nelement vertex 3\n");
    for name in ["x", "y", "z"]
        .map(str::to_owned)
        .into_iter()
        .chain((0..100_000).map(|n| format!("a{n}")))
    {
        writeln!(text, "property float {name}").unwrap();
    }
    text += "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    for point in ["0 0 0", "1 0 0", "0 1 0"] {
        writeln!(text, "{point}{}", " 7".repeat(100_000)).unwrap();
    }
    let (mesh, _) = timed("a.ply", (text + "3 0 1 2\n").as_bytes()).unwrap();
    assert_eq!(mesh.point_arrays.len(), 100_000);
    assert!(mesh.point_arrays.iter().all(|array| array.values == [7.0; 3]));
}

#[test]
fn very_many_vectors_are_turned_in_the_time_of_their_length() {
    let mut text = String::from(
        "# vtk DataFile Version 3.0\nSPACE=RAS\nASCII\nDATASET POLYDATA\nPOINTS 2 float\n0 0 0 1 0 0\nLINES 1 3\n2 0 1\n\
         POINT_DATA 2\n",
    );
    (0..100_000).for_each(|number| writeln!(text, "VECTORS a{number} float\n1 2 3 1 2 3").unwrap());
    let (mesh, warnings) = timed("a.vtk", text.as_bytes()).unwrap();
    assert!(
        mesh.point_arrays
            .iter()
            .all(|array| array.values[..2] == [-1.0, -2.0])
    );
    assert!(warnings[0].message.chars().count() < 1100);
}

/// They would take the square of the file: 30 MB of arrays for these 30 kB, 300 GB for 3 MB.
#[test]
fn arrays_that_lie_on_one_another_are_refused() {
    let count = 1000;
    let one = format!(
        "<DataArray type=\"UInt8\" Name=\"a\" NumberOfComponents=\"{count}\" format=\"appended\" offset=\"0\"/>"
    );
    let head = "<?xml version=\"1.0\"?><VTKFile type=\"PolyData\" byte_order=\"LittleEndian\"><PolyData>";
    let points = "<Points><DataArray type=\"UInt8\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0</DataArray></Points>";
    let piece = format!(
        "<Piece NumberOfPoints=\"1\"><PointData>{}</PointData>{points}</Piece>",
        one.repeat(300)
    );
    let mut bytes = format!("{head}{piece}</PolyData><AppendedData encoding=\"raw\">_").into_bytes();
    bytes.extend((count as u32).to_le_bytes());
    bytes.extend(vec![1; count]);
    assert_eq!(
        refusal("a.vtp", &bytes),
        [
            "a.vtp:1: array `a` in <PointData>: lies where others do: together they are more than the file holds"
        ]
    );
}

/// It became triangles with a point twice, some of them one on the other.
#[test]
fn a_polygon_that_goes_round_twice_is_refused() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 1 2 3\n";
    assert_eq!(
        refusal("a.obj", text.as_bytes()),
        ["a.obj:4: face 0: 6 corners, some of them twice; triangulate it"]
    );
}

//! Every variant of every format, as VTK writes it, gives the same mesh, and so does what is written.

use super::*;

#[test]
fn every_vtk_variant_gives_the_same_mesh() {
    for name in VALVES {
        let (mesh, warnings) = read(name);
        assert_eq!(mesh, valve(), "{name}");
        // Only the quad. Its diagonals (10, 8, 2.25) and (-10, 8, -1.625) have the cross product (-31, -6.25, 160)
        // of length 163.1; on it their distance (10, 0, 1.875) is 10 / 163.1.
        let warnings: Vec<_> = warnings.into_iter().map(|fault| fault.message).collect();
        assert_eq!(
            warnings,
            [
                "quads split along the shorter diagonal (their diagonals are up to 0.061 mm apart): 1, the first is face 4"
            ],
            "{name}"
        );
    }
}

#[test]
fn every_surface_format_gives_the_same_triangles() {
    for name in SURFACES {
        let (mesh, warnings) = read(name);
        assert_eq!(corners(&mesh), corners(&valve()), "{name}");
        assert_eq!(
            mesh.points.len(),
            9,
            "{name}: points that triangles share are one"
        );
        assert_eq!(warnings, [], "{name}");
        let marked = (!name.ends_with("obj")).then_some(Space::LPS);
        assert_eq!(mesh.space, marked, "{name}");
    }
}

#[test]
fn strips_give_the_same_triangles_in_another_order() {
    let from_lowest = |mesh: &PolyData| {
        let mut all = corners(mesh);
        for triangle in &mut all {
            let lowest = (0..3)
                .min_by(|&a, &b| triangle[a].partial_cmp(&triangle[b]).unwrap())
                .unwrap();
            triangle.rotate_left(lowest);
        }
        all.sort_by(|a, b| a.partial_cmp(b).unwrap());
        all
    };
    for name in STRIPS {
        assert_eq!(from_lowest(&read(name).0), from_lowest(&valve()), "{name}");
    }
}

#[test]
fn what_is_written_is_read_back_and_is_what_vtk_has_checked() {
    let path = std::env::temp_dir().join(format!("coapt-written-{}.vtp", std::process::id()));
    write_vtp(&path, &valve()).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let (back, warnings) = read_mesh(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    // make_fixtures.py opens this very file with VTK and compares.
    assert_eq!(bytes, fixture("written_by_coapt.vtp"));
    assert_eq!(warnings, []);
    let valve = valve();
    assert_eq!(back.points, valve.points);
    assert_eq!(back.triangles, valve.triangles);
    assert_eq!(back.lines, valve.lines);
    assert_eq!(back.point_arrays, valve.point_arrays);
    assert_eq!(back.space, Some(Space::LPS));
    let value = |mesh: &PolyData, part| mesh.triangle_value(&mesh.cell_arrays[1], part).unwrap()[0];
    let line = |mesh: &PolyData, part| mesh.line_value(&mesh.cell_arrays[1], part).unwrap()[0];
    assert!((0..8).all(|part| value(&back, part) == value(&valve, part)));
    assert!((0..3).all(|part| line(&back, part) == line(&valve, part)));
}

#[test]
fn a_list_of_frames_names_its_files() {
    let path = std::env::temp_dir().join(format!("coapt-frames-{}.pvd", std::process::id()));
    write_pvd(&path, &[(0.0, "a & b.vtp".into()), (0.25, "c.vtp".into())]).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    assert!(
        text.contains("timestep=\"0\" group=\"\" part=\"0\" file=\"a &amp; b.vtp\"/>"),
        "{text}"
    );
    assert!(text.contains("timestep=\"0.25\""), "{text}");
    assert!(write_pvd(&path, &[(f64::NAN, "a".into())]).is_err());
}

#[test]
fn a_file_marked_ras_is_turned_with_its_vectors() {
    for name in [
        "valve_legacy_51_ascii.vtk",
        "valve_legacy_42_binary.vtk",
        "valve_ascii.vtp",
        "surface_ascii.stl",
    ] {
        let is_xml = name.ends_with("vtp");
        let (old, new) = if is_xml {
            ("76 80 83 0", "82 65 83 0")
        } else {
            ("SPACE=LPS", "SPACE=RAS")
        };
        let (turned, _) = parse(name, &edited(name, old, new)).unwrap();
        let (plain, _) = read(name);
        assert_eq!(turned.space, Some(Space::RAS), "{name}");
        for (turned, plain) in turned.points.iter().zip(&plain.points) {
            assert_eq!(*turned, [0.0 - plain[0], 0.0 - plain[1], plain[2]], "{name}");
        }
        assert_eq!(
            turned.triangles, plain.triangles,
            "{name}: a rotation keeps the winding"
        );
        if let Some(displacement) = turned.point_array("displacement") {
            assert_eq!(displacement.tuple(2), Some(&[1.0, -0.5, 0.125][..]), "{name}");
        }
    }
}

#[test]
fn the_mark_is_found_in_comments_and_missed_when_absent() {
    let obj = [
        b"# 3D Slicer output. SPACE=RAS\n".to_vec(),
        fixture("surface.obj"),
    ]
    .concat();
    assert_eq!(parse("a.obj", &obj).unwrap().0.points[1], [-10.0, 0.0, 1.5]);
    for (name, old) in [
        ("valve_legacy_42_ascii.vtk", "SPACE=LPS"),
        ("surface_ascii.ply", "SPACE=LPS"),
    ] {
        assert_eq!(
            parse(name, &edited(name, old, "by hand")).unwrap().0.space,
            None,
            "{name}"
        );
    }
    let unknown = edited("surface_ascii.ply", "SPACE=LPS", "SPACE=LAS");
    assert_eq!(
        refusal("a.ply", &unknown),
        ["a.ply:4: SPACE is `LAS`; only LPS and RAS are known"]
    );
}

#[test]
fn line_endings_marks_and_latin_letters_do_not_matter() {
    for name in [
        "valve_legacy_42_ascii.vtk",
        "valve_ascii.vtp",
        "surface_ascii.ply",
        "surface_ascii.stl",
        "surface.obj",
    ] {
        let text = String::from_utf8(fixture(name)).unwrap();
        let expected = read(name).0;
        for (ending, what) in [("\r\n", "CRLF"), ("\r", "lone CR")] {
            let other = text.replace('\n', ending);
            let (mesh, _) =
                parse(name, other.as_bytes()).unwrap_or_else(|faults| panic!("{name} {what}: {faults:?}"));
            assert_eq!(mesh, expected, "{name} {what}");
        }
        assert_eq!(
            parse(name, text.trim_end().as_bytes()).unwrap().0,
            expected,
            "{name} without a final newline"
        );
        let (mesh, warnings) = parse(name, format!("\u{feff}\n{text}").as_bytes()).unwrap();
        assert_eq!(mesh, expected, "{name} with a byte order mark and a blank line");
        assert!(warnings[0].message.contains("byte order mark"), "{warnings:?}");
        for order in [u16::to_le_bytes, u16::to_be_bytes] {
            let utf16: Vec<u8> = text.encode_utf16().flat_map(order).collect();
            assert_eq!(
                refusal(name, &utf16),
                [format!("{name}: is text in UTF-16; save it as UTF-8")]
            );
        }
    }
    let mut latin = fixture("surface_binary.ply");
    let at = latin.windows(3).position(|part| part == b"VTK").unwrap();
    latin[at] = 0xe9;
    assert_eq!(corners(&parse("a.ply", &latin).unwrap().0), corners(&valve()));
}

#[test]
fn a_binary_body_after_a_crlf_header_begins_after_the_newline() {
    let bytes = fixture("surface_binary.ply");
    let end = bytes
        .windows(11)
        .position(|part| part == b"end_header\n")
        .unwrap()
        + 11;
    let head = String::from_utf8(bytes[..end].to_vec())
        .unwrap()
        .replace('\n', "\r\n");
    let mesh = parse("a.ply", &[head.as_bytes(), &bytes[end..]].concat())
        .unwrap()
        .0;
    assert_eq!(corners(&mesh), corners(&valve()));
}

#[test]
fn obj_faces_may_count_back_stand_first_and_carry_texture() {
    let text = "o one\nf 1/1/1 2//2 3\no two\nv 0 0 0 1 0.5 0.5 0.5\nv 1 0 0\\\n\nv 0 1 0 # SPACE=LPS\nf -3 -2 -1\nl 1 2 3\n";
    let (mesh, warnings) = parse("a.obj", text.as_bytes()).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 1, 2]]);
    assert_eq!((mesh.lines, mesh.line_source), (vec![[0, 1], [1, 2]], vec![0, 0]));
    assert_eq!(mesh.triangle_source, [1, 2]);
    assert_eq!(mesh.space, Some(Space::LPS));
    assert_eq!(said(&warnings), ["a.obj: 2 objects or groups, all taken"]);
}

#[test]
fn ply_vertex_properties_edges_and_strips_are_read() {
    let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty uchar red\nproperty float x\nproperty float y\n\
                property float z\nproperty float nx\nproperty float ny\nproperty float nz\nelement empty 9999999999999\n\
                element tristrips 1\nproperty list int int vertex_indices\nelement edge 1\nproperty int vertex1\n\
                property int vertex2\nproperty float rest\nend_header\n255 0 0 0 0 0 1\n0 1 0 0 0 0 1\n1 0 1 0 0 0 1\n\
                2 1 1 0 0 1 0\n7 0 1 2 -1 1 3 2\n0 3 2.5\n";
    let (mesh, warnings) = parse("a.ply", text.as_bytes()).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [1, 3, 2]]);
    assert_eq!(mesh.lines, [[0, 3]]);
    assert_eq!(mesh.point_array("red").unwrap().values, [255.0, 0.0, 1.0, 2.0]);
    assert_eq!(
        mesh.point_array("Normals").unwrap().tuple(3),
        Some(&[0.0, 1.0, 0.0][..])
    );
    assert_eq!(warnings, []);
}

#[test]
fn legacy_attributes_of_all_kinds_are_read_or_passed_over() {
    let text = "# vtk DataFile Version 3.0\nby hand\nASCII\nDATASET POLYDATA\nFIELD FieldData 2\nTIME 1 1 double\n0.5\n\
                note 1 1 string\nhello there\nPOINTS 3 double\n0 0 0 1 0 0 0 1 0\nMETADATA\nINFORMATION 0\n\n\
                POLYGONS 1 4\n3 0 1 2\nPOINT_DATA 3\nSCALARS s float 2\nLOOKUP_TABLE t\n1 2 3 4 5 6\nLOOKUP_TABLE t 1\n\
                0 0 0 1\nVECTORS v int\n1 2 3 4 5 6 7 8 9\nCOLOR_SCALARS c 1\n0.5 0.5 1\nTEXTURE_COORDINATES tc 2 float\n\
                0 0 1 0 0 1\nFIELD f 2\na%20b 1 3 int\n7 8 9\nMETADATA\nCOMPONENT_NAMES\nx\n\nn 1 3 string\none\ntwo\n\
                three\nCELL_DATA 1\nNORMALS n float\n0 0 1\n";
    let (mesh, warnings) = parse("a.vtk", text.as_bytes()).unwrap();
    let names: Vec<_> = mesh
        .point_arrays
        .iter()
        .map(|array| (array.name.as_str(), array.components))
        .collect();
    assert_eq!(names, [("s", 2), ("v", 3), ("c", 1), ("tc", 2), ("a b", 1)]);
    assert_eq!(mesh.point_arrays[4].values, [7.0, 8.0, 9.0]);
    assert_eq!(
        mesh.triangle_value(&mesh.cell_arrays[0], 0),
        Some(&[0.0, 0.0, 1.0][..])
    );
    assert_eq!(said(&warnings), ["a.vtk: array `n` holds text and is ignored"]);
}

#[test]
fn the_lines_of_a_mesh_are_a_curve_and_branches_are_not() {
    let path = Path::new(FOLDER).join("valve_ascii.vtp");
    let faults = read_curve(&path).unwrap_err();
    assert!(
        faults
            .iter()
            .any(|fault| fault.message == "the curve branches: 3 segments meet there"),
        "{faults:?}"
    );
    let folder = std::env::temp_dir().join(format!("coapt-curve-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let text = "# vtk DataFile Version 3.0\nSPACE=RAS\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n\
                1 2 3 4 5 6 7 8 10\nLINES 1 5\n4 0 1 2 0\n";
    std::fs::write(folder.join("ring.vtk"), text).unwrap();
    let (curve, _) = read_curve(&folder.join("ring.vtk")).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    assert_eq!(
        curve.points_mm,
        [[-1.0, -2.0, 3.0], [-4.0, -5.0, 6.0], [-7.0, -8.0, 10.0]]
    );
    assert!(curve.closed);
    assert_eq!(curve.space, Some(Space::RAS));
}

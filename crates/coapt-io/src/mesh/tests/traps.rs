//! Wrong files, each with the message it must get.

use super::*;

#[test]
fn what_no_reader_could_use_is_not_written() {
    let path = std::env::temp_dir().join(format!("coapt-unwritten-{}.vtp", std::process::id()));
    let refused = |spoil: &dyn Fn(&mut PolyData)| {
        let mut mesh = valve();
        spoil(&mut mesh);
        write_vtp(&path, &mesh).unwrap_err().message
    };
    assert_eq!(
        refused(&|mesh| mesh.points[4][1] = f64::NAN),
        "point 4 is not finite"
    );
    assert!(
        refused(&|mesh| mesh.triangles[2][0] = 11).starts_with("triangle 2 has a point that does not exist")
    );
    assert!(refused(&|mesh| mesh.lines[1][0] = 99).starts_with("segment 1 has a point"));
    assert!(
        refused(&|mesh| mesh.point_arrays[1].values.truncate(32))
            .starts_with("point array `displacement`: 32")
    );
    assert!(refused(&|mesh| mesh.cell_arrays[0].values.truncate(9)).ends_with("no value for cell 9"));
    assert_eq!(
        refused(&|mesh| mesh.cell_arrays[1].values[3] = f64::INFINITY),
        "array `rest_length_mm` is not finite at 3"
    );
    assert!(!path.exists());
}

#[test]
fn the_content_decides_and_a_lying_extension_is_told() {
    let (mesh, warnings) = parse("a.stl", &fixture("surface.obj")).unwrap();
    assert_eq!(mesh.triangles.len(), 8);
    assert_eq!(said(&warnings), ["a.stl: is OBJ in spite of its extension .stl"]);
    let mut stl = fixture("surface_binary.stl");
    stl[..5].copy_from_slice(b"solid");
    assert_eq!(
        parse("a.stl", &stl).unwrap().0.triangles.len(),
        8,
        "binary, though it begins with `solid`"
    );
    assert_eq!(
        refusal("a.stl", b"\x1f\x8b\x08"),
        ["a.stl: is compressed with gzip; unpack it"]
    );
    assert_eq!(
        refusal("a.obj", b"{}"),
        ["a.obj: is JSON, not a mesh; Slicer markups hold curves and points only"]
    );
}

#[test]
fn every_trap_gets_its_message() {
    let cases: &[(&str, Vec<u8>, &str)] = &[
        (
            "nan.obj",
            edited("surface.obj", "v 10 8 2.125", "v 10 nan 2.125"),
            "nan.obj:4: point 2 is not finite (NaN)",
        ),
        (
            "comma.obj",
            edited("surface.obj", "v 10 0 1.5", "v 10 0 1,5"),
            "comma.obj:3: point 1: decimal comma in `1,5`; re-export with \".\"",
        ),
        (
            "large.ply",
            edited("surface_ascii.ply", "10 8 2.125", "10 8 1e400"),
            "large.ply:15: vertex 2: `1e400` is too large for a number",
        ),
        (
            "zero.obj",
            edited("surface.obj", "f 1 3 4", "f 0 3 4"),
            "zero.obj:12: point 0: OBJ counts from 1",
        ),
        (
            "range.obj",
            edited("surface.obj", "f 1 3 4", "f 1 3 44"),
            "range.obj:12: face 1: point 43 does not exist: there are 9, from 0",
        ),
        (
            "range.vtk",
            edited("valve_legacy_42_ascii.vtk", "3 1 2 5", "3 1 2 55"),
            "range.vtk: face 2: point 55 does not exist: there are 11, from 0",
        ),
        (
            "range.ply",
            edited("surface_ascii.ply", "3 3 2 6", "3 3 2 -6"),
            "range.ply:26: face 4: point -6 does not exist: there are 9, from 0",
        ),
        (
            "word.vtk",
            edited("valve_legacy_51_ascii.vtk", "POINTS 11", "POINTS 12"),
            "word.vtk:10: point 11: `VERTICES` is not a number; the count in the header may be too large",
        ),
        (
            "huge.vtk",
            edited("valve_legacy_42_binary.vtk", "POINTS 11", "POINTS 353535235358"),
            "huge.vtk: byte 105: the header says 1060605706074 point values = 4242422824296 bytes, file has 1087 left",
        ),
        (
            "huge.ply",
            edited("surface_binary.ply", "vertex 9", "vertex 99999999999"),
            "huge.ply: byte 295: header says 99999999999 vertex elements = at least 12 bytes each, file has 212 left",
        ),
        (
            "huge.vtp",
            edited(
                "valve_ascii.vtp",
                "NumberOfPoints=\"11\"",
                "NumberOfPoints=\"99999999999\"",
            ),
            "huge.vtp:10: the header promises 99999999999 numbers for `annulus`, but only 51 bytes are left of the file",
        ),
        (
            "list.ply",
            edited("surface_ascii.ply", "3 0 1 2", "-3 0 1 2"),
            "list.ply:22: face 0: a list cannot have -3 values",
        ),
        (
            "cells.vtk",
            edited("valve_legacy_42_ascii.vtk", "CELL_DATA 10", "CELL_DATA 9"),
            "cells.vtk:26: CELL_DATA is for 9, but there are 10",
        ),
        (
            "tetrahedron.vtk",
            fixture("unsupported_tetrahedron_grid.vtk"),
            "tetrahedron.vtk: cell 0 is of type 10 (tetrahedron); extract the surface first",
        ),
        (
            "lz4.vtp",
            fixture("unsupported_lz4.vtp"),
            "lz4.vtp:1: compressor vtkLZ4DataCompressor is not read; save with zlib or without",
        ),
        ("empty.ply", Vec::new(), "empty.ply: the file is blank"),
        (
            "header.stl",
            b"solid nothing\nendsolid".to_vec(),
            "header.stl: no triangles",
        ),
        (
            "grid.vtk",
            b"# vtk DataFile Version 3.0\n\nASCII\nDATASET STRUCTURED_POINTS".to_vec(),
            "grid.vtk:4: DATASET STRUCTURED_POINTS is not read; export a surface as POLYDATA",
        ),
        (
            "points.obj",
            b"v 0 0 0\nv 1 0 0\n".to_vec(),
            "points.obj: no triangles and no lines, only 2 points",
        ),
        (
            "grid.vtp",
            b"<VTKFile type=\"ImageData\">".to_vec(),
            "grid.vtp:1: VTKFile of type `ImageData`; export a surface as PolyData (.vtp)",
        ),
    ];
    for (name, bytes, message) in cases {
        assert_eq!(refusal(name, bytes), [*message]);
    }
}

#[test]
fn a_cut_binary_says_what_is_missing_and_an_appendix_is_told() {
    let stl = fixture("surface_binary.stl");
    let cut = refusal("a.stl", &stl[..400]);
    assert_eq!(
        cut,
        ["a.stl: byte 80: header says 8 facets = 484 bytes, file has 400"]
    );
    let (mesh, warnings) = parse("a.stl", &[&stl[..], b"more"].concat()).unwrap();
    assert_eq!(mesh.triangles.len(), 8);
    assert_eq!(
        said(&warnings),
        ["a.stl: byte 484: 4 bytes after the last of 8 facets, ignored"]
    );
    let ply = fixture("surface_binary.ply");
    let cut = refusal("a.ply", &ply[..ply.len() - 3]);
    assert!(cut[0].contains("the file ends within face 7"), "{cut:?}");
    for name in VALVES.iter().filter(|name| !name.contains("ascii")) {
        // Cut in the middle: no data array can be whole.
        let bytes = fixture(name);
        assert!(parse(name, &bytes[..bytes.len() / 2]).is_err(), "{name}");
    }
}

#[test]
fn a_nan_in_binary_is_named_with_its_byte() {
    let mut stl = fixture("surface_binary.stl");
    // Facet 2 begins at 84 + 100; its normal takes 12 bytes, its first corner 12.
    stl[84 + 100 + 24..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
    assert_eq!(
        refusal("a.stl", &stl)[0],
        "a.stl: byte 208: facet 2, corner 1 is not finite (NaN)"
    );
    let mut vtk = fixture("valve_legacy_51_binary.vtk");
    let start = vtk
        .windows(16)
        .position(|part| part == b"POINTS 11 float\n")
        .unwrap()
        + 16;
    vtk[start + 4 * 7..][..4].copy_from_slice(&f32::INFINITY.to_be_bytes());
    assert_eq!(
        refusal("a.vtk", &vtk)[0],
        format!("a.vtk: byte {}: point 2 is not finite (inf)", start + 28)
    );
}

#[test]
fn faults_are_collected_up_to_twenty() {
    let bad = |count: usize| format!("{}f 1 2 3\n", "v 0,5 0 0\n".repeat(count));
    assert_eq!(refusal("a.obj", bad(7).as_bytes()).len(), 7);
    let many = refusal("a.obj", bad(1000).as_bytes());
    assert_eq!(many.len(), 21);
    assert_eq!(many[20], "a.obj: 20 errors: reading stopped, there may be more");
}

#[test]
fn arrays_may_have_gaps_but_they_are_told() {
    let (mesh, warnings) = parse(
        "a.vtk",
        &edited("valve_legacy_42_ascii.vtk", "0 1.5 3", "0 nan 3"),
    )
    .unwrap();
    assert!(mesh.cell_arrays[1].values[1].is_nan());
    let message = "a.vtk: array `rest_length_mm`: 1 values are not finite, the first at 1";
    assert!(said(&warnings).contains(&message.to_owned()), "{warnings:?}");
}

#[test]
fn only_regular_files_are_opened() {
    let folder = std::env::temp_dir().join(format!("coapt-files-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("empty.vtk"), b"").unwrap();
    let message = |path: &Path| read_mesh(path).unwrap_err()[0].message.clone();
    assert_eq!(message(&folder), "is a folder, not a file");
    assert_eq!(message(&folder.join("empty.vtk")), "the file is empty");
    assert!(
        message(&folder.join("none.vtk")).contains("os error 2"),
        "not found"
    );
    #[cfg(unix)]
    {
        assert_eq!(message(Path::new("/dev/zero")), "is not a regular file");
        let fifo = folder.join("fifo.vtk");
        if std::process::Command::new("mkfifo")
            .arg(&fifo)
            .status()
            .is_ok_and(|status| status.success())
        {
            assert_eq!(message(&fifo), "is not a regular file");
        }
        std::os::unix::fs::symlink(folder.join("loop.vtk"), folder.join("loop.vtk")).unwrap();
        assert!(read_mesh(&folder.join("loop.vtk")).is_err());
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn a_version_from_the_future_is_read_and_told() {
    let (mesh, warnings) = parse(
        "a.vtk",
        &edited("valve_legacy_51_ascii.vtk", "Version 5.1", "Version 6.0"),
    )
    .unwrap();
    assert_eq!(mesh, valve());
    assert_eq!(
        said(&warnings)[0],
        "a.vtk:1: version `6.0` is not known; read as 5.1"
    );
}

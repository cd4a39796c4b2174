//! `coapt study`, of meshes and tolerances and of laws.

use std::path::Path;

use serde_json::Value;

use crate::program::{Folder, coapt, status, stderr, stdout};

/// Two small meshes at two tolerances, and a contact thickness: files, lines, and the front as the figures have it.
#[test]
fn a_study_sets_error_against_time() {
    let folder = Folder::new("study");
    let out = folder.path("out");
    let mut arguments = vec![
        "study",
        "healthy",
        "--faces",
        "300,150",
        "--reference-faces",
        "600",
    ];
    arguments.extend([
        "--tolerance",
        "1e-1,1e-3",
        "--thickness",
        "1.0,0.7",
        "--repeats",
        "1",
    ]);
    arguments.extend(["--out", &out]);
    let output = coapt(&arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stdout(&output).ends_with("research use, not a medical device\n"));
    let read = |name: &str| std::fs::read_to_string(Path::new(&out).join(name)).unwrap();
    // Table, object, picture, and the list of them.
    assert_eq!(std::fs::read_dir(&out).unwrap().count(), 4);
    // Four of the grid, one of the thickness that is not the default.
    assert_eq!(read("study.csv").lines().count(), 1 + 4 + 1);
    assert!(read("study.csv").starts_with("varied,faces,residual_tolerance,"));
    assert!(read("study.svg").contains("research use"));
    let study: Value = serde_json::from_str(&read("study.json")).unwrap();
    let rows = study["rows"].as_array().unwrap();
    assert!(rows.iter().all(|row| row["certified"] == true), "{rows:?}");
    let number = |row: &Value, key: &str| row.pointer(key).and_then(Value::as_f64).unwrap();
    // The finer mesh lies nearer to the reference: 0.4 against 0.7 mm.
    assert!(
        number(&rows[3], "/error/rms_mm") < 0.8 * number(&rows[1], "/error/rms_mm"),
        "{rows:?}"
    );
    // The tightest of each mesh is what its others are held against.
    assert!(number(&rows[3], "/own_mesh_rms_mm") < 1e-12, "{rows:?}");
    assert!(
        number(&rows[2], "/own_mesh_rms_mm") < 0.1 * number(&rows[2], "/error/rms_mm"),
        "{rows:?}"
    );
    let competing: Vec<&Value> = rows
        .iter()
        .filter(|row| row["varied"] == "mesh-and-tolerance")
        .collect();
    let fastest = competing
        .iter()
        .min_by(|a, b| number(a, "/wall_ms").total_cmp(&number(b, "/wall_ms")))
        .unwrap();
    assert_eq!(fastest["on_front"], true);
    let knees: Vec<_> = rows.iter().filter(|row| row["knee"] == true).collect();
    assert!(knees.len() <= 1 && knees.iter().all(|row| row["on_front"] == true));
}

/// The coarsest meshes under every law: files, lines, every closure certified. What the laws differ in is measured in
/// docs/laws.md; here the tissue itself is no distance from itself, and every other law is some.
#[test]
fn a_study_of_laws_has_a_line_for_each() {
    let folder = Folder::new("study-laws");
    let out = folder.path("out");
    let mut arguments = vec!["study", "healthy", "--laws", "--faces", "150"];
    arguments.extend(["--reference-faces", "200", "--repeats", "1", "--out", &out]);
    let output = coapt(&arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stdout(&output).contains("one tissue in each law"));
    let read = |name: &str| std::fs::read_to_string(Path::new(&out).join(name)).unwrap();
    // Table, object, and the list of them.
    assert_eq!(std::fs::read_dir(&out).unwrap().count(), 3);
    assert_eq!(read("laws.csv").lines().count(), 1 + 8);
    let study: Value = serde_json::from_str(&read("laws.json")).unwrap();
    let rows = study["rows"].as_array().unwrap();
    assert!(rows.iter().all(|row| row["certified"] == true), "{rows:?}");
    assert!(rows.iter().all(|row| row["mesh_error"].is_object()), "{rows:?}");
    assert!(rows[0]["model_error"].is_null());
    for row in &rows[1..] {
        let rms_mm = row
            .pointer("/model_error/rms_mm")
            .and_then(Value::as_f64)
            .unwrap();
        assert!((1e-3..5.0).contains(&rms_mm), "{row}");
    }
    assert_eq!(rows[7]["tissues"][1]["wrinkling"], "tension-field");
    assert_eq!(
        status(&["study", "--laws", "--tolerance", "1e-3", "--out", &out]),
        Some(2)
    );
}

#[test]
fn a_study_of_a_scene_has_its_own_mesh_and_wrong_lists_are_refused() {
    let folder = Folder::new("study-scene");
    let valve = folder.valve(&[]);
    let out = folder.path("out");
    let mut arguments = vec!["study", &valve, "--tolerance", "1e-2", "--thickness", "1.0"];
    arguments.extend(["--repeats", "1", "--out", &out]);
    let output = coapt(&arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = std::fs::read_to_string(Path::new(&out).join("study.csv")).unwrap();
    assert_eq!(text.lines().count(), 2, "{text}");
    // Without a finer mesh nobody is told that the error is that of mesh and solver.
    let told = "what the mesh costs is not in";
    assert!(stdout(&output).contains(told), "{}", stdout(&output));
    for name in ["study.json", "study.svg"] {
        let text = std::fs::read_to_string(Path::new(&out).join(name)).unwrap();
        assert!(text.contains(told), "{name}");
    }
    let never = folder.path("never");
    for (wrong, told) in [
        (vec![&valve[..], "--faces", "300"], "is for presets"),
        (vec!["healthy", "--faces", "300,ten"], "ten"),
        (vec!["healthy", "--faces", "9"], "100"),
        (vec!["healthy", "--tolerance", "0"], "above 0 and below 1"),
        (vec!["healthy", "--tolerance", "nan"], "above 0 and below 1"),
        (vec!["healthy", "--thickness=-1"], "above 0"),
        (vec!["healthy", "--thickness", "inf"], "above 0"),
        (vec!["healthy", "--repeats", "0"], "from 1 to 1000"),
        (vec!["helthy"], "did you mean `healthy`?"),
    ] {
        let mut arguments = vec!["study"];
        arguments.extend(&wrong);
        arguments.extend(["--out", &never]);
        let output = coapt(&arguments);
        assert_eq!(output.status.code(), Some(2), "{wrong:?} {}", stderr(&output));
        assert!(stderr(&output).contains(told), "{wrong:?} {}", stderr(&output));
    }
    assert!(!Path::new(&never).exists());
    assert_eq!(status(&["study", "healthy"]), Some(2));
    let file = folder.path("valve/scene.toml");
    assert_eq!(status(&["study", "--out", &file]), Some(2));
}

/// Against a coarser mesh an error would say nothing.
#[test]
fn a_reference_coarser_than_the_mesh_is_refused() {
    let folder = Folder::new("study-coarse");
    let out = folder.path("out");
    for laws in [&["--laws"][..], &[]] {
        let coarse = [
            "study",
            "healthy",
            "--faces",
            "150,300",
            "--reference-faces",
            "200",
            "--out",
            &out,
        ];
        let output = coapt(&[&coarse[..], laws].concat());
        assert_eq!(output.status.code(), Some(2));
        let said = stderr(&output);
        let told = "--reference-faces is 200, coarser than the finest mesh studied; expected at least 300";
        assert!(said.contains(told), "{said}");
        assert!(!Path::new(&out).exists());
    }
}

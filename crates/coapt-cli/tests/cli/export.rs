//! `coapt export`.

use std::path::Path;

use crate::program::{Folder, coapt, status, stderr, with_membranes};

/// The small healthy valve with leaflets of a law that other engines have.
fn membrane_valve(folder: &Folder) -> String {
    with_membranes(&folder.valve(&[]))
}

#[test]
fn export_writes_a_valve_for_each_engine() {
    let folder = Folder::new("export");
    let valve = membrane_valve(&folder);
    for (engine, beginning) in [("calculix", "** healthy for CalculiX"), ("febio", "<?xml")] {
        let out = folder.path(engine);
        let output = coapt(&["export", &valve, "--format", engine, "--out", &out]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        assert!(output.stdout.is_empty());
        let text = std::fs::read_to_string(&out).unwrap();
        assert!(text.starts_with(beginning), "{}", &text[..80]);
        let head: Vec<&str> = text.lines().take(5).collect();
        assert!(
            head.iter()
                .any(|line| line.contains("research use, not a medical device")),
            "{head:?}"
        );
    }
}

#[test]
fn export_turns_a_result_into_a_surface() {
    let folder = Folder::new("export-results");
    let valve = membrane_valve(&folder);
    let input = folder.path("valve.inp");
    assert_eq!(
        status(&["export", &valve, "--format", "calculix", "--out", &input]),
        Some(0)
    );
    // Every vertex goes up by 1 mm.
    let text = std::fs::read_to_string(&input).unwrap();
    let vertices = text
        .lines()
        .skip_while(|line| !line.contains("NSET=VERTICES"))
        .skip(1);
    let mut table = "node,ux,uy,uz\n".to_owned();
    for line in vertices.take_while(|line| !line.starts_with('*')) {
        table += &format!("{},0,0,1\n", line.split(',').next().unwrap());
    }
    let results = folder.path("result.csv");
    std::fs::write(&results, &table).unwrap();
    let out = folder.path("closed.vtp");
    let output = coapt(&["export", &valve, "--results", &results, "--out", &out]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let (surface, _) = coapt_io::mesh::read_mesh(Path::new(&out)).unwrap();
    let way = surface.point_array("displacement_mm").unwrap();
    assert!(
        way.values
            .chunks(3)
            .all(|way| way[0].abs() < 1e-12 && (way[2] - 1.0).abs() < 1e-12)
    );
    assert_eq!(surface.triangles.len(), text.matches("*SOLID SECTION").count());

    std::fs::write(&results, "node,ux,uy,uz\n1,0,0,up\n").unwrap();
    let output = coapt(&["export", &valve, "--results", &results, "--out", &out]);
    assert_eq!(output.status.code(), Some(2));
    let said = stderr(&output);
    assert!(
        said.contains("result.csv:2: node 1: found `up`; expected a finite number"),
        "{said}"
    );
    // What CalculiX leaves of a run that failed.
    std::fs::write(&results, "\n").unwrap();
    let output = coapt(&["export", &valve, "--results", &results, "--out", &out]);
    assert_eq!(output.status.code(), Some(2));
    let said = stderr(&output);
    assert!(
        said.contains("result.csv is empty; expected displacements"),
        "{said}"
    );
}

#[test]
fn export_refuses_what_no_engine_has_and_names_the_line() {
    let folder = Folder::new("export-refused");
    let valve = folder.valve(&[]);
    let out = folder.path("valve.inp");
    let output = coapt(&["export", &valve, "--format", "calculix", "--out", &out]);
    assert_eq!(output.status.code(), Some(2));
    let said = stderr(&output);
    assert!(
        said.contains("scene.toml:") && said.contains("leaflet `anterior` is made of bilinear-springs"),
        "{said}"
    );
    assert!(!Path::new(&out).exists());
    // Neither, and both.
    assert_eq!(status(&["export", &valve, "--out", &out]), Some(2));
    let both = [
        "export",
        &valve,
        "--format",
        "febio",
        "--results",
        &out,
        "--out",
        &out,
    ];
    assert_eq!(status(&both), Some(2));
}

//! `coapt compare` as its users meet it.

use std::path::Path;

use serde_json::Value;

use crate::program::{Folder, coapt, shared};

fn json(arguments: &[&str]) -> Value {
    let output = coapt(&[arguments, &["--format", "json"]].concat());
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    serde_json::from_slice(&output.stdout).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

/// Two meshes of the healthy valve close to shapes a fraction of a millimetre apart, under every definition but the one
/// between centroids, which is larger by its nature; alignment does not make the least squares worse.
#[test]
fn results_of_two_meshes_are_compared() {
    let folder = Folder::new("compare");
    let root = folder.path("");
    let [scene, coarse, fine, out] = ["scene", "coarse", "fine", "out"].map(|name| format!("{root}/{name}"));
    let commands: [&[&str]; 3] = [
        &["closure", "healthy", "--out", &coarse],
        &["generate", "healthy", "--set", "faces=1300", "--out", &scene],
        &["closure", &scene, "--out", &fine],
    ];
    for arguments in commands {
        let output = coapt(arguments);
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
    }
    let output = coapt(&["compare", &coarse, &fine, "--out", &out]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert!(
        text.ends_with("research use, not a medical device\n") && !text.contains("warning"),
        "{text}"
    );
    assert!(Path::new(&out).join("error.vtp").is_file());
    let written = std::fs::read(format!("{out}/comparison.json")).unwrap();
    let found = json(&["compare", &coarse, &fine]);
    assert_eq!(found, serde_json::from_slice::<Value>(&written).unwrap());
    for part in ["whole", "visible", "in_contact", "not_in_contact"] {
        for way in [
            "result_to_reference",
            "result_to_reference_by_area",
            "reference_to_result",
        ] {
            let rms = number(&found["as_given"][part][way]["rms_mm"]);
            assert!(rms > 0.0 && rms < 0.5, "{part} {way} {rms}");
        }
    }
    let whole = &found["as_given"]["whole"];
    let (surface, centroid) = (&whole["result_to_reference"], &whole["centroid_to_centroid"]);
    assert!(number(&centroid["mean_mm"]) > number(&surface["mean_mm"]) + 0.1);
    let rms = |when: &str| number(&found[when]["whole"]["result_to_reference_by_area"]["rms_mm"]);
    assert!(rms("aligned") <= rms("as_given"));
    assert!(whole["node_to_node"].is_null());
    let visible = number(&found["result"]["visible_share"]);
    assert!(visible > 0.4 && visible < 0.95, "{visible}");
}

/// Wrong input is status 2 with a sentence that names it; all wrong names at once.
#[test]
fn wrong_input_is_told() {
    let folder = Folder::new("compare-wrong");
    let root = folder.path("");
    let cloud = format!("{root}/cloud.vtk");
    let head = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n";
    std::fs::write(&cloud, format!("{head}0 0 0 9 0 0 0 9 0\n")).unwrap();
    let good = format!("{root}/good.vtk");
    std::fs::write(&good, format!("{head}0 0 0 9 0 0 0 9 0\nPOLYGONS 1 4\n3 0 1 2\n")).unwrap();
    let cases: [(&[&str], &str); 8] = [
        (&["nothing.vtp", "neither.stl"], "neither.stl"),
        (&["nothing.vtp", "neither.stl"], "nothing.vtp"),
        (&[&root, &good], "folder without closed.vtp"),
        (&[&cloud, &good], "no triangles and no lines, only 3 points"),
        (&[&good], "required arguments"),
        (
            &[&good, &good, "--thickness", "0"],
            "--thickness is 0 mm, expected more than 0",
        ),
        (
            &[&good, &good, "--atrial-direction", "0,0,0"],
            "--atrial-direction is (0, 0, 0), expected",
        ),
        (&[&good, &good, "--atrial-direction", "up"], "three numbers"),
    ];
    for (arguments, expected) in cases {
        let output = coapt(&[&["compare"], arguments].concat());
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?} {said}");
        assert!(said.contains(expected), "{arguments:?} {said}");
    }
    let blocked = coapt(&["compare", &good, &good, "--out", &good]);
    assert_eq!(blocked.status.code(), Some(1));
    let turned = json(&["compare", &good, &good, "--atrial-direction", "0,0,-2"]);
    assert_eq!(turned["result"]["atrial_direction"][2], -1.0);
}

/// A finite-element valve of warped quadrilaterals, open and closed: one mesh, whose leaflet nodes are 8.0 mm apart on
/// average and 18.3 mm at most, as its source states to these digits. Against itself nothing is apart.
#[test]
fn a_finite_element_valve_is_compared_node_by_node() {
    let Some(data) = shared("data/texas_trivalve_healthy") else {
        return;
    };
    let [open, closed] =
        ["open", "closed"].map(|state| data.join(format!("healthy_{state}.vtk")).display().to_string());
    let found = json(&["compare", &closed, &open]);
    let nodes = &found["as_given"]["whole"]["node_to_node"];
    assert_eq!(
        (&found["nodes_correspond"], &nodes["count"]),
        (&Value::Bool(true), &Value::from(8587))
    );
    assert!((number(&nodes["mean_mm"]) - 8.0).abs() < 0.05, "{nodes}");
    assert!((number(&nodes["max_mm"]) - 18.3).abs() < 0.05, "{nodes}");
    // Its file has z out of the annulus and leaflets that hang to -z, while its faces look to the ventricle.
    for surface in ["result", "reference"] {
        assert!(
            number(&found[surface]["atrial_direction"][2]) > 0.99,
            "{}",
            found[surface]
        );
    }
    let same = json(&["compare", &closed, &closed]);
    for when in ["as_given", "aligned"] {
        for way in [
            "result_to_reference",
            "reference_to_result",
            "centroid_to_centroid",
            "node_to_node",
        ] {
            // Rounding of coordinates of some 30 mm.
            assert!(
                number(&same[when]["whole"][way]["max_mm"]) < 1e-12,
                "{when} {way}"
            );
        }
    }
}

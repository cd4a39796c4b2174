//! `coapt personalise` and `coapt fit-tissue` as their users meet them.

use serde_json::Value;

use crate::program::{Folder, coapt, stderr, stdout};

/// A small valve with chordae so many times as long as usual.
fn valve(folder: &Folder, name: &str, length: &str) -> String {
    folder.preset(
        name,
        "restricted",
        &[&format!("chordae.rest_length_scale={length}")],
    )
}

/// A valve with chordae of 0.9 is fitted to the closed shape that it has with 1.0, and its scene then closes to that. The
/// search stops within thousandths.
#[test]
fn a_scene_is_fitted_and_closes_to_the_target() {
    let folder = Folder::new("fits");
    let (given, other) = (valve(&folder, "given", "0.9"), valve(&folder, "other", "1.0"));
    let closed = folder.path("closed");
    assert!(coapt(&["closure", &other, "--out", &closed]).status.success());
    let (target, out) = (format!("{closed}/closed.vtp"), folder.path("fitted"));
    let output = coapt(&["personalise", &given, &target, "--out", &out, "--format", "json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let report: Value = serde_json::from_str(&stdout(&output)).unwrap();
    let scale = report["chord_groups"][0]["scale"].as_f64().unwrap();
    assert!((scale * 0.9 - 1.0).abs() < 0.006, "{report:#}");
    assert!(
        rms(&report, "tuned") < 0.15 && rms(&report, "untuned") > 0.5,
        "{report:#}"
    );
    assert_eq!(
        std::fs::read_to_string(format!("{out}/personalise.json")).unwrap(),
        stdout(&output)
    );
    assert_is_the_valve_reported(&out, &target, &report);
    let text = stdout(&coapt(&["personalise", &given, &target]));
    for part in [
        "FITTED",
        "as given",
        "95 % interval",
        "not how well it predicts",
        "research use, not a medical device",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
}

/// No length of chordae brings a valve to a target that lies elsewhere: factors are given, and doubted. One that they reach is not.
#[test]
fn a_target_that_chordae_do_not_reach_is_doubted() {
    let folder = Folder::new("elsewhere");
    let given = valve(&folder, "given", "1.0");
    let closed = folder.path("closed");
    let ring = ["closure", &given, "--ring", "physio-like:26", "--out", &closed];
    assert!(coapt(&ring).status.success());
    for (target, doubted) in [("after/closed.vtp", true), ("before/closed.vtp", false)] {
        let text = stdout(&coapt(&["personalise", &given, &format!("{closed}/{target}")]));
        assert_eq!(
            text.contains("more than chordae explain"),
            doubted,
            "{target}: {text}"
        );
    }
}

/// A closed annulus that the scene does not know of goes into the scene that is written.
#[test]
fn the_annulus_of_the_target_is_taken_over() {
    let folder = Folder::new("annulus");
    let given = valve(&folder, "given", "1.0");
    let closed = folder.path("closed");
    assert!(coapt(&["closure", &given, "--out", &closed]).status.success());
    let target = format!("{closed}/closed.vtp");
    // The parametric annulus is 36 by 28 mm and lies about the origin; this one is a flat ellipse near it.
    let points: Vec<String> = (0..72)
        .map(|k| {
            let angle = f64::from(k) * std::f64::consts::TAU / 72.0;
            format!("{} {} 0", 18.0 * angle.cos(), 14.0 * angle.sin())
        })
        .collect();
    let line: String = (0..=72).map(|k| format!(" {}", k % 72)).collect();
    let curve = folder.file(
        "annulus.vtk",
        &format!(
            "# vtk DataFile Version 3.0\nannulus SPACE=LPS\nASCII\nDATASET POLYDATA\nPOINTS 72 double\n{}\nLINES 1 74\n73{line}\n",
            points.join("\n")
        ),
    );
    let out = folder.path("fitted");
    let output = coapt(&[
        "personalise",
        &given,
        &target,
        "--annulus",
        &curve,
        "--out",
        &out,
        "--format",
        "json",
    ]);
    assert!(matches!(output.status.code(), Some(0 | 3)), "{}", stderr(&output));
    let report: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert!(
        rms(&report, "untuned") > 0.3,
        "the annulus has not moved: {report:#}"
    );
    assert_is_the_valve_reported(&out, &target, &report);
}

fn rms(report: &Value, state: &str) -> f64 {
    report[state]["all_points"]["rms_mm"].as_f64().unwrap()
}

/// The scene that was written, untuned, lies where the fitted valve was said to lie. Rest lengths differ by rounding, and so
/// does the road to the closed state: roads end within 0.05 mm of each other (`tests/it/roads.rs`).
fn assert_is_the_valve_reported(scene: &str, target: &str, report: &Value) {
    let output = coapt(&["personalise", scene, target, "--format", "json"]);
    let again: Value = serde_json::from_str(&stdout(&output)).unwrap();
    let off = rms(&again, "untuned") - rms(report, "tuned");
    assert!(off.abs() < 0.05, "{off}: {report:#} {again:#}");
}

#[test]
fn wrong_targets_are_told_with_their_file() {
    let folder = Folder::new("wrong");
    let given = valve(&folder, "given", "1.0");
    let told = |target: &str| {
        let output = coapt(&["personalise", &given, target]);
        assert_eq!(output.status.code(), Some(2), "{}", stdout(&output));
        assert!(output.stdout.is_empty());
        stderr(&output)
    };
    assert!(told(&folder.path("none.vtp")).contains("none.vtp"));
    let few = folder.file("few.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    assert!(
        told(&few).contains("few.obj has 3 points, expected 20 at least"),
        "{}",
        told(&few)
    );
    let far: String = (0..30).map(|k| format!("v {k} 5000 {}\n", k * k)).collect();
    let faces: String = (1..29).map(|k| format!("f {k} {} {}\n", k + 1, k + 2)).collect();
    let far = folder.file("far.obj", &(far + &faces));
    assert!(
        told(&far).contains("far.obj point 0 is (0, 5000, 0) mm"),
        "{}",
        told(&far)
    );
}

/// Springs of 0.05 MPa, 0.2 and 2 MPa, stretched alike: P = 3/2 σ, as the table has it to the last digit.
#[test]
fn a_biaxial_curve_becomes_a_block_of_a_scene() {
    let folder = Folder::new("tissue");
    let rows: String = (1..=40)
        .map(|k| {
            let strain = 0.006 * f64::from(k);
            let stress = 1.5e3 * (0.05 * strain.min(0.2) + 2.0 * (strain - 0.2).max(0.0));
            format!("{0},{0},{stress},{stress}\n", 1.0 + strain)
        })
        .collect();
    let header = "stretch_circ,stretch_rad,nominal_stress_circ_kpa,nominal_stress_rad_kpa\n";
    let curve = folder.file("curve.csv", &format!("{header}{rows}"));
    let output = coapt(&["fit-tissue", &curve, "--up-to", "150"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    let due = "law = \"bilinear-springs\"\npre_transition_modulus_mpa = 0.05\ntransition_strain = 0.2\n\
               post_transition_modulus_mpa = 2.0\nbending_modulus_ratio = 9.6\n";
    assert!(text.ends_with(due), "{text}");
    let as_json = stdout(&coapt(&[
        "fit-tissue",
        &curve,
        "--up-to",
        "150",
        "--format",
        "json",
    ]));
    let object: Value = serde_json::from_str(&as_json).unwrap();
    assert_eq!(object["tissue"]["law"], "bilinear-springs");
    assert_eq!(object["tissue"]["bending_modulus_ratio"], 9.6);
    // A scene takes the block as it is.
    let valve = valve(&folder, "valve", "1.0");
    let scene = std::fs::read_to_string(format!("{valve}/scene.toml")).unwrap();
    let (head, rest) = scene
        .split_once("[leaflets.tissue]\n")
        .expect("a leaflet has a tissue");
    let rest = rest.split_once("\n\n").map_or("", |(_, rest)| rest);
    std::fs::write(format!("{valve}/scene.toml"), format!("{head}{text}\n{rest}")).unwrap();
    let output = coapt(&["check", &valve]);
    assert_eq!(output.status.code(), Some(0), "{}", stdout(&output));
    let spoilt = folder.file("spoilt.csv", &format!("{header}1.1,1.1,1,1\n1.2,oops,2,2\n"));
    let output = coapt(&["fit-tissue", &spoilt]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("spoilt.csv:3 `stretch_rad` is `oops`"),
        "{}",
        stderr(&output)
    );
    let output = coapt(&["fit-tissue", &curve, "--thickness", "0.8"]);
    assert_eq!(output.status.code(), Some(2));
    let said = stderr(&output);
    assert!(
        said.contains("curve.csv:1: holds stresses, for which a thickness has no meaning"),
        "{said}"
    );
}

/// The scene that is read stays as it is.
#[test]
fn the_scene_itself_is_never_overwritten() {
    let folder = Folder::new("own");
    let own = valve(&folder, "valve", "1.0");
    let scene = format!("{own}/scene.toml");
    let before = std::fs::read(&scene).unwrap();
    let output = coapt(&[
        "personalise",
        &own,
        &format!("{own}/leaflet_anterior.vtp"),
        "--out",
        &own,
    ]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("--out"), "{}", stderr(&output));
    assert_eq!(std::fs::read(&scene).unwrap(), before);
}

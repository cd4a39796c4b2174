//! What people are told: words that a terminal may show, numbers that they can read, what a file looks like.

use std::path::Path;
use std::process::Output;

use serde_json::Value;

use crate::program::{Folder, coapt, stderr, stdout};

/// Clears the screen, in both of its spellings, and begins a line that looks like ours.
const OBEYED: &str = "\u{1b}[2J\u{9b}2J\nerror: made up";
const SHOWN: &str = "\\u001b[2J\\u009b2J\\nerror: made up";

/// A small valve whose case and anterior leaflet have this name.
fn named(folder: &Folder, name: &str) -> String {
    let valve = folder.valve(&[]);
    let scene = Path::new(&valve).join("scene.toml");
    let text = std::fs::read_to_string(&scene).unwrap();
    let name = format!("name = {}", serde_json::to_string(name).unwrap());
    let text = text
        .replace("name = \"healthy\"", &name)
        .replace("name = \"anterior\"", &name);
    std::fs::write(&scene, text).unwrap();
    valve
}

fn assert_obeys_nothing(arguments: &[&str], output: &Output) {
    for stream in [stdout(output), stderr(output)] {
        let control = |letter: char| letter.is_control() && letter != '\n';
        assert!(!stream.contains(control), "{arguments:?}: {stream:?}");
        let made_up = |line: &str| line.trim_start().starts_with("error: made up");
        assert!(!stream.lines().any(made_up), "{arguments:?}: {stream:?}");
    }
}

#[test]
fn names_cannot_command_the_terminal() {
    let folder = Folder::new("obeyed");
    let valve = named(&folder, OBEYED);
    let out = folder.path("out");
    let file = folder.file(
        "wrong\u{1b}[31m.toml",
        "name = \"\\u001b[2J\"\n\"\\u001b[2J\" = 1\n",
    );
    let small = [
        "--reference-faces",
        "300",
        "--tolerance",
        "1e-2",
        "--repeats",
        "1",
    ];
    let study = [&["study", "--faces", "160", "--out", &out][..], &small].concat();
    for arguments in [
        &["closure", &valve, "--out", &out][..],
        &["closure", &valve, "--format", "json"],
        &["check", &valve],
        &["check", &valve, "--format", "json"],
        &["compare", &out, &out],
        &study,
        &["check", &file],
        &["closure", &file],
        &["closure", "\u{1b}[2J"],
        &["closure", "--plan", "\u{1b}[2J"],
        &["\u{1b}[2J"],
        &["generate", "--set", "faces=\u{1b}[2J", "--out", &out],
    ] {
        assert_obeys_nothing(arguments, &coapt(arguments));
    }
    let text = stdout(&coapt(&["closure", &valve]));
    assert!(text.starts_with(SHOWN), "{text}");
    // Machines get the name as it is.
    let report: Value =
        serde_json::from_str(&stdout(&coapt(&["closure", &valve, "--format", "json"]))).unwrap();
    assert_eq!(report["case"], OBEYED);
}

#[test]
fn a_wrong_setting_says_what_it_is_and_what_is_expected() {
    let folder = Folder::new("settings");
    let out = folder.path("never");
    for (setting, told) in [
        (
            "faces=nan",
            "`face_count_target` is `nan`, expected a whole number, 0 or above, such as ",
        ),
        ("faces=1e12", "is `1e12`, expected at most 4294967295, such as "),
        (
            "faces=",
            "`face_count_target` has no value, expected a whole number, 0 or above, such as ",
        ),
        (
            "annulus.transverse_mm= ",
            "`annulus.transverse_mm` has no value, expected a number, such as ",
        ),
        // Edges of the usual number of faces are some millimetre long.
        ("jitter_mm=3", "jitter_mm is 3; expected a number from 0 to 0."),
        ("jitter_mm=-1", "jitter_mm is -1; expected a number from 0 to 0."),
        ("faces=many", "is `many`, expected a whole number, 0 or above"),
        (
            "annulus.transverse_mm=nan",
            "`annulus.transverse_mm` is `nan`, expected a number, such as ",
        ),
        (
            "annulus.transverse_mm=1e308",
            "annulus.transverse_mm is 1e308; expected a number from 5 to 100",
        ),
        (
            "leaflets.anterior_heights_mm=[1,2]",
            "is `[1,2]`, expected a list of numbers, such as [",
        ),
        (
            "leaflets.tissue.law=green",
            "`leaflets.tissue.law` is `green`: unknown value `green`",
        ),
    ] {
        let output = coapt(&["generate", "--set", setting, "--out", &out]);
        assert_eq!(output.status.code(), Some(2), "{setting}");
        let words = stderr(&output);
        assert!(words.contains(told), "{setting}: {words}");
        for name in ["u32", "f64", "i64", "null", "floating point"] {
            assert!(!words.contains(name), "{setting}: {words}");
        }
    }
}

#[test]
fn what_is_no_scene_is_told_by_what_it_looks_like() {
    let folder = Folder::new("no-scene");
    let valve = folder.valve(&[]);
    let mesh = Path::new(&valve)
        .join("leaflet_anterior.vtp")
        .display()
        .to_string();
    let mut stl = vec![b'{'; 80];
    stl.extend(1_u32.to_le_bytes());
    stl.extend([0; 50]);
    let bytes = |name: &str, bytes: &[u8]| {
        std::fs::write(folder.path(name), bytes).unwrap();
        folder.path(name)
    };
    let expected = "a scene or a plan is a TOML or JSON file";
    for (file, told) in [
        (mesh, "is a mesh (VTK XML); "),
        (bytes("a.stl", &stl), "is a mesh (STL, binary); "),
        (
            bytes("a.obj", b"# cube\no cube\nv 1 2 3\nf 1 1 1\n"),
            "is a mesh (OBJ); ",
        ),
        (bytes("a.png", b"\x89PNG\r\n\x1a\n\0\xff"), "is no text; "),
        (
            bytes("garbage", b"{]x)(//"),
            "is read as JSON since it begins with a bracket, but ",
        ),
    ] {
        for arguments in [["check", &file], ["closure", &file]] {
            let output = coapt(&arguments);
            assert_eq!(output.status.code(), Some(2), "{file}");
            let words = stdout(&output) + &stderr(&output);
            assert!(words.contains(&format!("{told}{expected}")), "{file}: {words}");
        }
    }
    // A header is no JSON; and `o` may be a key.
    let words = stdout(&coapt(&[
        "check",
        &folder.file("header.toml", "[load]\npressure_mmhg = 100\n"),
    ]));
    assert!(
        words.contains("schema_version` is missing") && !words.contains("JSON"),
        "{words}"
    );
    let words = stdout(&coapt(&[
        "check",
        &folder.file("o.toml", "o = 1\nschema_version = 1\n"),
    ]));
    assert!(words.contains("unknown key `o`"), "{words}");
}

/// A chord that reaches nothing is not in the model: that stands with the verdict and in the JSON, too.
#[test]
fn chordae_left_out_are_told_of_beside_the_verdict() {
    let bad = |name: &str| format!("{}/../../assets/bad/{name}", env!("CARGO_MANIFEST_DIR"));
    let text = stdout(&coapt(&["closure", &bad("chord_to_nowhere.toml")]));
    let lines: Vec<&str> = text.lines().collect();
    let verdict = lines.iter().position(|line| line.contains("CERTIFIED")).unwrap();
    let told = lines
        .iter()
        .position(|line| line.starts_with("left out: the valve was closed without chord segments that reach"))
        .unwrap();
    // One line on the work stands between.
    assert!(told <= verdict + 2, "{text}");
    let flat = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        flat.contains("neither tip nor leaflet: 1 of `marginal`;"),
        "{text}"
    );
    let json = |name: &str| -> Value {
        serde_json::from_str(&stdout(&coapt(&["closure", &bad(name), "--format", "json"]))).unwrap()
    };
    let left_out = &json("chord_to_nowhere.toml")["chordae_left_out"];
    assert_eq!(left_out[0]["group"], "marginal");
    assert_eq!(left_out[0]["segments"], 1);
    for whole in ["parts/good.toml", "chord_twice.toml"] {
        assert!(json(whole).get("chordae_left_out").is_none(), "{whole}");
    }
}

/// Leaflets that overlap by a millimetre: drawn apart, which stands with the verdict and in the JSON.
#[test]
fn leaflets_drawn_apart_are_told_of_beside_the_verdict() {
    let bad = |name: &str| format!("{}/../../assets/bad/{name}", env!("CARGO_MANIFEST_DIR"));
    let text = stdout(&coapt(&["closure", &bad("overlapping.toml")]));
    let lines: Vec<&str> = text.lines().collect();
    let verdict = lines.iter().position(|line| line.contains("CERTIFIED")).unwrap();
    let told = lines
        .iter()
        .position(|line| line.starts_with("drawn apart: surfaces of the open valve crossed"))
        .unwrap();
    // One line on the work stands between.
    assert!(told <= verdict + 2, "{text}");
    let json: Value = serde_json::from_str(&stdout(&coapt(&[
        "closure",
        &bad("overlapping.toml"),
        "--format",
        "json",
    ])))
    .unwrap();
    let untangled = &json["untangled"];
    assert!(
        untangled["places"].as_u64() > Some(0) && untangled["moved_points"].as_u64() > Some(0),
        "{untangled}"
    );
    assert!(
        (0.0..3.0).contains(&untangled["farthest_mm"].as_f64().unwrap()),
        "{untangled}"
    );
    assert!(untangled["first_at_mm"][0][2].is_f64(), "{untangled}");
    let good: Value = serde_json::from_str(&stdout(&coapt(&[
        "closure",
        &bad("parts/good.toml"),
        "--format",
        "json",
    ])))
    .unwrap();
    assert!(good.get("untangled").is_none());
    // Refused ones say where, too.
    let refused = stderr(&coapt(&["closure", &bad("tangled.toml")]));
    assert!(
        refused.contains(" mm, ") && refused.contains("surfaces cross or touch in the open valve at"),
        "{refused}"
    );
}

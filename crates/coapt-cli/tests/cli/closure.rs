//! `coapt closure`, `check` and `generate`: exit status, streams, files.

use std::path::Path;

use coapt::model::Model;
use coapt::plan::apply_all;
use coapt::relax::relax;
use coapt::scene::Settings;
use coapt::state::State;
use coapt_io::report::{Closed, Closure, Report, write_results};
use coapt_io::scene::{alternative_from_text, read_scene, scene_file};
use serde_json::Value;

use crate::program::{Folder, coapt, snapshot, status, stderr, stdout};

fn replace(file: &Path, from: &str, to: &str) {
    let text = std::fs::read_to_string(file).unwrap();
    assert!(text.contains(from), "{text}");
    std::fs::write(file, text.replace(from, to)).unwrap();
}

#[test]
fn closure_alone_closes_the_healthy_valve() {
    let output = coapt(&["closure"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    assert!(
        text.starts_with("healthy: mitral valve closed at 100 mmHg"),
        "{text}"
    );
    assert!(text.contains("\nCERTIFIED"), "{text}");
    assert!(text.ends_with("research use, not a medical device\n"), "{text}");
    assert!(output.stderr.is_empty(), "{}", stderr(&output));
}

/// The program adds nothing to the library: the same bytes in every file, but for wall-clock times. `python/tests/test_program.py`
/// holds the package against the program with the same cases.
#[test]
fn program_and_library_write_the_same_bytes() {
    let clip = "kind = \"clip\"\nsite = \"A2P2\"\nsize = \"long\"\n";
    let ring =
        "kind = \"ring\"\nfamily = \"physio-like\"\nsize_mm = 30\nattachment = \"sutures\"\nsutures = 14\n";
    let rupture = "kind = \"rupture\"\nregion = \"P2\"\n";
    let neochord = "kind = \"neochord\"\nleaflet = \"posterior\"\nsite = \"A2P2\"\nstrands = 2\n";
    let folder = Folder::new("library");
    let cases: [(&str, &[&str]); 4] = [
        ("healthy", &[]),
        ("flail", &[clip]),
        ("dilated", &[ring]),
        ("barlow", &[rupture, neochord]),
    ];
    for (preset, repairs) in cases {
        let valve = folder.preset(preset, preset, &[]);
        let blocks = repairs.iter().map(|repair| format!("[[repair]]\n{repair}"));
        let text = format!("schema_version = 1\n{}", blocks.collect::<String>());
        let plan = folder.file("plan.toml", &text);
        let by_program = folder.path(&format!("{preset}-by-program"));
        let mut arguments = vec!["closure", &valve, "--out", &by_program];
        if !repairs.is_empty() {
            arguments.extend(["--plan", &plan]);
        }
        assert_eq!(status(&arguments), Some(0), "{preset}");
        let by_library = folder.path(&format!("{preset}-by-library"));
        write_by_library(
            &valve,
            (!repairs.is_empty()).then_some(text.as_str()),
            &by_library,
        );
        let files = [&by_program, &by_library].map(|folder| snapshot(Path::new(folder)));
        assert!(files[0].len() > 3 && files[0] == files[1], "{preset}");
    }
}

/// What `coapt closure` does, in calls of the library.
fn write_by_library(valve: &str, plan: Option<&str>, folder: &str) {
    let (scene, _) = read_scene(&scene_file(Path::new(valve))).unwrap();
    let built = Model::build(&scene).unwrap();
    let closed = |model: Model| Closed {
        equilibrium: relax(&model, &State::open(&model)),
        model,
        wall_ms: 0.0,
    };
    let mut closure = Closure {
        before: closed(built.model.clone()),
        after: None,
        repairs: Vec::new(),
        warnings: built.warnings,
        untangled: built.untangled,
        chordae_left_out: built.chordae_left_out,
    };
    if let Some(text) = plan {
        let (plan, warnings) = alternative_from_text(Path::new("plan.toml"), text).unwrap();
        let applied = apply_all(&built.model, &plan.alternatives[0].repairs).unwrap();
        assert!(warnings.is_empty() && applied.warnings.is_empty());
        closure.after = Some(closed(applied.model));
        closure.repairs = applied.reports;
    }
    write_results(Path::new(folder), &closure, &Report::new(&closure)).unwrap();
}

#[test]
fn wrong_usage_is_status_2_and_help_is_0() {
    let folder = Folder::new("usage");
    let never = folder.path("never");
    let generate = |setting: &'static str| vec!["generate", "--set", setting, "--out", &never];
    for wrong in [
        vec!["closure", "--bogus"],
        vec!["clausure"],
        vec![],
        vec!["closure", "--threads", "0"],
        vec!["closure", "--format", "xml"],
        vec!["closure", "--ring", "saddle:28", "--plan", "x"],
        vec!["closure", "--ring", "saddle"],
        vec!["closure", "helthy"],
        vec!["closure", "--plan", "/does/not/exist"],
        vec!["check"],
        vec!["check", "no-such-scene"],
        vec!["generate", "healthy"],
        vec!["generate", "helthy", "--out", &never],
        generate("faces"),
        generate("faces=-1"),
        generate("annulus.transverse_mm=nan"),
        generate("annulus.transverse_mm.x=1"),
    ] {
        let output = coapt(&wrong);
        assert_eq!(output.status.code(), Some(2), "{wrong:?} {}", stderr(&output));
    }
    assert!(!Path::new(&never).exists());
    assert!(stderr(&coapt(&["closure", "helthy"])).contains("did you mean `healthy`?"));
    let unknown = stderr(&coapt(&generate("annulus.transverse=40")));
    assert!(unknown.contains("did you mean `transverse_mm`?"), "{unknown}");
    let unknown = stderr(&coapt(&generate("fces=1")));
    assert!(
        unknown.contains("unknown key `fces`; did you mean `faces`?"),
        "{unknown}"
    );
    for help in [&["--help"][..], &["--version"], &["closure", "--help"]] {
        assert_eq!(status(help), Some(0), "{help:?}");
    }
}

/// A generated valve is held to the rule of any scene.
#[test]
fn generate_takes_and_doubts_what_a_scene_takes_and_doubts() {
    let folder = Folder::new("doubts");
    for (setting, status, told) in [
        ("pressure_mmhg=350", 0, ""),
        (
            "pressure_mmhg=500",
            0,
            "warning: load.pressure_mmhg is 500 mmHg, expected below 400 mmHg",
        ),
        (
            "pressure_mmhg=-1",
            2,
            "error: generate: pressure_mmhg is -1; expected a number from 0",
        ),
        (
            "chordae.basal_modulus_mpa=20800",
            0,
            "warning: chordae[2].modulus_mpa is 20800 MPa, expected 0.1 to",
        ),
    ] {
        let out = folder.path(setting);
        let output = coapt(&["generate", "--set", "faces=300", "--set", setting, "--out", &out]);
        assert_eq!(output.status.code(), Some(status), "{setting}");
        let said = stderr(&output);
        assert!(
            said.contains(told) && said.is_empty() == told.is_empty(),
            "{setting}: {said}"
        );
        if status == 0 {
            let checked = stdout(&coapt(&["check", &out]));
            assert_eq!(checked.contains("check the unit"), !told.is_empty(), "{checked}");
        }
    }
}

#[test]
fn a_generated_valve_checks_and_closes_before_and_after_a_ring() {
    let folder = Folder::new("round");
    let valve = folder.valve(&["name=case 7", "pressure_mmhg=90", "annulus.transverse_mm=36"]);
    let check = coapt(&["check", &valve]);
    assert_eq!(check.status.code(), Some(0), "{}", stdout(&check));
    assert!(stdout(&check).contains("ready to be closed: 0 errors"));
    let out = folder.path("out");
    let output = coapt(&[
        "closure",
        &valve,
        "--ring",
        "saddle:30",
        "--format",
        "json",
        "--out",
        &out,
    ]);
    let report: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(report["case"], "case 7");
    let certified = |state: &str| report[state]["solve"]["certified"].as_bool().unwrap();
    let expected = if certified("before") && certified("after") {
        0
    } else {
        3
    };
    assert_eq!(output.status.code(), Some(expected), "{}", stderr(&output));
    let ap = |state: &str| report[state]["annulus"]["ap_mm"].as_f64().unwrap();
    assert!(ap("after") < ap("before") - 1.0);
    let written = std::fs::read_to_string(Path::new(&out).join("report.json")).unwrap();
    assert_eq!(
        written,
        stdout(&output),
        "the same report on the screen and in the folder"
    );
    assert!(Path::new(&out).join("after/closed.vtp").is_file());
}

#[test]
fn a_full_folder_is_overwritten_only_when_asked_for() {
    let folder = Folder::new("full");
    let valve = folder.valve(&[]);
    let scene = Path::new(&valve).join("scene.toml");
    let before = std::fs::read(&scene).unwrap();
    assert_eq!(status(&["generate", "dilated", "--out", &valve]), Some(2));
    assert_eq!(before, std::fs::read(&scene).unwrap());
    assert_eq!(
        status(&["generate", "dilated", "--out", &valve, "--force"]),
        Some(0)
    );
    assert_ne!(before, std::fs::read(&scene).unwrap());
}

#[test]
fn a_plan_of_several_kinds_is_carried_out_and_its_faults_have_lines() {
    let folder = Folder::new("plan-kinds");
    let valve = folder.valve(&[]);
    let plan = folder.path("plan.toml");
    let text = "schema_version = 1\n[[repair]]\nkind = \"rupture\"\nregion = \"P2\"\n[[repair]]\nkind = \"clip\"\n\
                site = \"A2P2\"\n[[repair]]\nkind = \"relocate-papillary\"\nmuscle = \"anterolateral\"\n\
                by_mm = [0, 0, 1]\n";
    std::fs::write(&plan, text).unwrap();
    let output = coapt(&["closure", &valve, "--plan", &plan]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let told = stdout(&output);
    for line in [
        "chords torn",
        "repair: clip A2P2: arms 9 mm",
        "repair: anterolateral papillary muscle, 3 tips, drawn by 1.0 mm",
        "clip A2P2: total tension",
    ] {
        assert!(told.contains(line), "no `{line}` in {told}");
    }
    for (from, to, words) in [
        (
            "site = \"A2P2\"",
            "position = 0.01",
            "plan.toml:7: repair[1].position: the clip, 4 mm wide",
        ),
        ("site = \"A2P2\"\n", "", "plan.toml:5: repair[1].site is missing"),
        (
            "anterolateral",
            "lateral",
            "plan.toml:10: repair[2].muscle is `lateral`, expected one of",
        ),
    ] {
        std::fs::write(&plan, text.replace(from, to)).unwrap();
        let wrong = coapt(&["closure", &valve, "--plan", &plan]);
        assert_eq!(wrong.status.code(), Some(2));
        assert!(
            stderr(&wrong).contains(words),
            "no `{words}` in {}",
            stderr(&wrong)
        );
    }
}

#[test]
fn a_plan_file_does_what_the_option_does() {
    let folder = Folder::new("plan");
    let valve = folder.valve(&[]);
    let plan = folder.path("plan.toml");
    let text = "schema_version = 1\n[[repair]]\nkind = \"ring\"\nfamily = \"saddle\"\nsize_mm = 30\n";
    std::fs::write(&plan, text).unwrap();
    let after = |option: &str, value: &str| {
        let output = coapt(&["closure", &valve, option, value, "--format", "json"]);
        let report: Value = serde_json::from_str(&stdout(&output)).unwrap();
        report["after"]["annulus"].clone()
    };
    let by_plan = after("--plan", &plan);
    assert!(by_plan.is_object());
    assert_eq!(by_plan, after("--ring", "saddle:30"));
    std::fs::write(&plan, text.replace("size_mm = 30", "size_mm = 3")).unwrap();
    let wrong = coapt(&["closure", &valve, "--plan", &plan]);
    assert_eq!(wrong.status.code(), Some(2));
    assert!(
        stderr(&wrong).contains("plan.toml:5: repair[0].size_mm"),
        "{}",
        stderr(&wrong)
    );
}

#[test]
fn every_fault_of_a_scene_is_listed_with_its_line() {
    let folder = Folder::new("faults");
    let valve = folder.valve(&[]);
    let scene = Path::new(&valve).join("scene.toml");
    replace(&scene, "thickness_mm = 1.0", "thickness_mm = -1.0");
    let check = coapt(&["check", &valve]);
    assert_eq!(check.status.code(), Some(2));
    let text = stdout(&check);
    assert!(
        text.contains("scene.toml:8: leaflets[0].thickness_mm is -1 mm"),
        "{text}"
    );
    assert!(text.contains("cannot be closed: 3 errors"), "{text}");
    let json: Value = serde_json::from_str(&stdout(&coapt(&["check", &valve, "--format", "json"]))).unwrap();
    assert_eq!(json["errors"], 3);
    assert_eq!(json["faults"].as_array().unwrap().len(), 3);
    let closure = coapt(&["closure", &valve]);
    assert_eq!(closure.status.code(), Some(2));
    assert!(closure.stdout.is_empty() && stderr(&closure).contains("leaflets[1].thickness_mm"));
    replace(&scene, "thickness_mm = -1.0", "thicknes_mm = 1.0");
    let unknown = stdout(&coapt(&["check", &valve]));
    assert!(unknown.contains("scene.toml:8:1: unknown key `thicknes_mm`; did you mean `thickness_mm`?"));
}

#[test]
fn an_unfinished_closure_prints_its_report_and_is_status_3() {
    let folder = Folder::new("limit");
    let valve = folder.valve(&[]);
    let scene = Path::new(&valve).join("scene.toml");
    let default = format!("iteration_limit = {}", Settings::default().iteration_limit);
    replace(&scene, &default, "iteration_limit = 3");
    let output = coapt(&["closure", &valve]);
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    let text = stdout(&output);
    assert!(
        text.contains("NOT CERTIFIED: the iteration limit came first"),
        "{text}"
    );
    assert!(text.contains("regurgitant orifice area"));
}

/// Leaflets that pass through each other far in the open valve: both verbs say where, and close nothing.
#[test]
fn a_tangled_start_is_told() {
    let folder = Folder::new("tangled");
    let valve = folder.valve(&["leaflets.opening_angle_deg=20"]);
    let leaflet = Path::new(&valve).join("leaflet_posterior.vtp");
    let (mut mesh, _) = coapt_io::mesh::read_mesh(&leaflet).unwrap();
    // The lower half of the posterior leaflet goes through the anterior one.
    let mut heights: Vec<f64> = mesh.points.iter().map(|point| point[2]).collect();
    heights.sort_unstable_by(f64::total_cmp);
    let middle = heights[heights.len() / 2];
    for point in mesh.points.iter_mut().filter(|point| point[2] < middle - 2.0) {
        point[1] -= 25.0;
    }
    coapt_io::mesh::write_vtp(&leaflet, &mesh).unwrap();
    let told = "surfaces cross or touch in the open valve at";
    let check = coapt(&["check", &valve]);
    assert_eq!(check.status.code(), Some(2), "{}", stdout(&check));
    assert!(stdout(&check).contains(told), "{}", stdout(&check));
    let closure = coapt(&["closure", &valve]);
    assert_eq!(closure.status.code(), Some(2), "{}", stdout(&closure));
    assert!(stderr(&closure).contains(told), "{}", stderr(&closure));
}

/// Every third inner point of the posterior leaflet half an edge lower: nothing for springs. `check` says how far they are off, of the
/// good mesh too, and warns of the bad one.
#[test]
fn an_irregular_mesh_of_springs_is_told_of() {
    let folder = Folder::new("irregular");
    let valve = folder.valve(&[]);
    let json = |path: &str| -> Value {
        serde_json::from_str(&stdout(&coapt(&["check", path, "--format", "json"]))).unwrap()
    };
    let error = |found: &Value| found["springs"][1]["stiffness_error"].as_f64().unwrap();
    let good = json(&valve);
    assert_eq!(
        (&good["warnings"], good["springs"].as_array().unwrap().len()),
        (&0.into(), 2)
    );
    assert!(error(&good) < 0.25);
    let [anterior, posterior] =
        ["anterior", "posterior"].map(|name| Path::new(&valve).join(format!("leaflet_{name}.vtp")));
    let (mut mesh, _) = coapt_io::mesh::read_mesh(&posterior).unwrap();
    let (other, _) = coapt_io::mesh::read_mesh(&anterior).unwrap();
    let is_inner = |point: &[f64; 3]| point[2] < -1.0 && !other.points.contains(point);
    for point in mesh.points.iter_mut().step_by(3).filter(|point| is_inner(point)) {
        point[2] -= 1.5;
    }
    coapt_io::mesh::write_vtp(&posterior, &mesh).unwrap();
    let bad = json(&valve);
    assert!(
        bad["warnings"].as_u64() > Some(0) && error(&bad) > 0.25,
        "{bad:#}"
    );
    let text = stdout(&coapt(&["check", &valve]));
    assert!(text.contains("leaflets[1].mesh point"), "{text}");
    assert!(text.contains("the mesh is too irregular for springs"), "{text}");
    assert!(text.contains("posterior: springs are"), "{text}");
}

#[test]
fn a_folder_that_cannot_be_written_is_status_1() {
    let folder = Folder::new("unwritable");
    std::fs::write(folder.path("file"), "in the way").unwrap();
    let output = coapt(&["closure", "--out", &folder.path("file/results")]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(stderr(&output).contains("file/results"));
}

/// Without times the files are the same to the last byte, whatever the number of threads.
#[test]
fn the_number_of_threads_changes_nothing() {
    let folder = Folder::new("threads");
    let valve = folder.valve(&[]);
    let run = |threads: &str| {
        let out = folder.path(threads);
        let output = coapt(&[
            "closure",
            &valve,
            "--ring",
            "saddle:30",
            "--threads",
            threads,
            "--out",
            &out,
        ]);
        assert!(matches!(output.status.code(), Some(0 | 3)), "{}", stderr(&output));
        let bytes = |file: &str| std::fs::read(Path::new(&out).join(file)).unwrap();
        let report = String::from_utf8(bytes("report.json")).unwrap();
        let timeless: Vec<String> = report
            .lines()
            .filter(|line| !line.contains("\"wall_ms\""))
            .map(str::to_owned)
            .collect();
        assert_eq!(timeless.len() + 2, report.lines().count());
        let surfaces = ["before/closed.vtp", "after/closed.vtp", "after/chords.vtp"].map(bytes);
        (timeless, surfaces)
    };
    let one = run("1");
    assert!(one == run("2"));
    assert!(one == run("3"));
}

//! `--record`, `--sequence` and `coapt replay`.

use std::path::Path;

use coapt::film::film;
use coapt::model::Model;
use coapt::relax::relax;
use coapt::scene::Load;
use coapt::state::State;
use coapt_io::mesh::read_mesh;
use coapt_io::record::{Filmed, Source, read, write_recording};
use coapt_io::scene::read_scene;

use crate::program::{Folder, coapt, fits_its_list, snapshot, stderr, stdout};

fn bits(points: &[[f64; 3]]) -> Vec<[u64; 3]> {
    points.iter().map(|point| point.map(f64::to_bits)).collect()
}

fn points_of(path: impl AsRef<Path>) -> Vec<[u64; 3]> {
    bits(&read_mesh(path.as_ref()).unwrap().0.points)
}

/// Before and after a ring, by one thread and by two; the last frames are the closed valves of the report.
#[test]
fn a_closure_is_recorded_and_made_again() {
    let folder = Folder::new("record");
    let valve = folder.preset("valve", "dilated", &[]);
    let (file, other, out) = (
        folder.path("made/closing.mcap"),
        folder.path("b.mcap"),
        folder.path("out"),
    );
    let arguments = [
        "closure",
        &valve,
        "--ring",
        "physio-like:30",
        "--frames",
        "8",
        "--threads",
    ];
    let plain = coapt(&["closure", &valve, "--ring", "physio-like:30", "--format", "json"]);
    let recorded = coapt(
        &[
            &arguments[..],
            &["1", "--record", &file, "--out", &out, "--format", "json"],
        ]
        .concat(),
    );
    assert_eq!(recorded.status.code(), Some(0), "{}", stderr(&recorded));
    let timeless = |text: String| -> Vec<String> {
        text.lines()
            .filter(|line| !line.contains("wall_ms"))
            .map(str::to_owned)
            .collect()
    };
    assert_eq!(timeless(stdout(&plain)), timeless(stdout(&recorded)));
    assert!(
        stderr(&recorded).contains("closing.layout.json"),
        "{}",
        stderr(&recorded)
    );
    let read = read(Path::new(&file)).unwrap();
    assert_eq!(read.films.len(), 2);
    for (film, stage) in read.films.iter().zip(["before", "after"]) {
        assert_eq!(film.topic, format!("/{stage}/valve"));
        assert_eq!(film.frames.len(), 8);
        let last = &film.frames[7];
        assert_eq!(
            bits(&last.positions_mm),
            points_of(format!("{out}/{stage}/closed.vtp"))
        );
        assert!(
            (last.pressure_mmhg - 100.0).abs() < 1e-9,
            "{}",
            last.pressure_mmhg
        );
    }
    assert_eq!(read.films[1].rings_mm.len(), 1);
    let again = coapt(&[&arguments[..], &["2", "--record", &other]].concat());
    assert_eq!(again.status.code(), Some(0), "{}", stderr(&again));
    assert_eq!(std::fs::read(&file).unwrap(), std::fs::read(&other).unwrap());
    let replay = coapt(&["replay", &file]);
    assert_eq!(replay.status.code(), Some(0), "{}", stderr(&replay));
    assert_eq!(
        stdout(&replay),
        "agrees: 16 frames, each the same to the last bit\n"
    );
}

#[test]
fn a_cut_recording_is_replayed_as_far_as_it_goes() {
    let folder = Folder::new("cut");
    let valve = folder.valve(&[]);
    let file = folder.path("a.mcap");
    assert!(
        coapt(&["closure", &valve, "--record", &file, "--frames", "40"])
            .status
            .success()
    );
    let bytes = std::fs::read(&file).unwrap();
    std::fs::write(&file, &bytes[..bytes.len() * 4 / 5]).unwrap();
    let replay = coapt(&["replay", &file]);
    assert_eq!(replay.status.code(), Some(0), "{}", stderr(&replay));
    assert!(stdout(&replay).starts_with("agrees: "), "{}", stdout(&replay));
    assert!(
        stderr(&replay).contains("is cut off; of 40 frames"),
        "{}",
        stderr(&replay)
    );
}

/// A film of another pressure than the scene's: as if the solver had changed.
#[test]
fn a_replay_that_differs_says_where_and_is_status_3() {
    let folder = Folder::new("differs");
    let (scene, _) = read_scene(&Path::new(&folder.valve(&[])).join("scene.toml")).unwrap();
    let model = Model::build(&scene).unwrap().model;
    let film = film(&model, &relax(&model, &State::open(&model)), 3);
    let other = coapt::scene::Scene {
        load: Load::mmhg(101.0),
        ..scene
    };
    let source = Source {
        scene: &other,
        repairs_before: &[],
        repairs: &[],
    };
    let filmed = Filmed {
        model: &model,
        film: &film,
        repairs: &[],
    };
    let file = folder.path("a.mcap");
    write_recording(Path::new(&file), source, filmed, None).unwrap();
    let replay = coapt(&["replay", &file]);
    assert_eq!(replay.status.code(), Some(3), "{}", stderr(&replay));
    let text = stdout(&replay);
    assert!(
        text.starts_with("DIFFERS: ") && text.contains("of 3 frames"),
        "{text}"
    );
    assert!(
        text.contains("first: frame 0 of /valve lies elsewhere: vertex "),
        "{text}"
    );
}

#[test]
fn wrong_usage_and_what_is_no_recording_are_status_2() {
    let folder = Folder::new("record-wrong");
    let never = folder.path("never.mcap");
    for wrong in [
        &["closure", "--frames", "10"][..],
        &["closure", "--record", &never, "--frames", "1"],
        &["closure", "--record", &never, "--frames", "10001"],
        &["replay"],
        &["replay", &never],
        &["replay", &folder.file("text.mcap", "no recording")],
    ] {
        let output = coapt(wrong);
        assert_eq!(output.status.code(), Some(2), "{wrong:?} {}", stderr(&output));
    }
    assert!(!Path::new(&never).exists());
    // A file has the place of the folder: told before the valve is closed.
    let file = folder.file("file", "");
    for (option, name) in [("--record", "a.mcap"), ("--picture", "a.png")] {
        let output = coapt(&["closure", option, &format!("{file}/{name}")]);
        assert_eq!(output.status.code(), Some(1), "{option}");
        assert_eq!(stdout(&output), "", "{option}");
    }
}

/// A picture under another name would be opened by programs for that name.
#[test]
fn a_picture_that_is_not_called_png_is_refused() {
    let folder = Folder::new("picture-wrong");
    let never = folder.path("never.jpg");
    let output = coapt(&["closure", "--picture", &never]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    let told = "never.jpg would hold a PNG picture, the only kind that is written; expected a name that ends in .png";
    assert!(stderr(&output).contains(told), "{}", stderr(&output));
    assert!(!Path::new(&never).exists());
}

/// The best alternative is filmed, and ends where the comparison found it.
#[test]
fn a_plan_records_the_alternative_that_ranks_first() {
    let folder = Folder::new("plan-record");
    let valve = folder.preset("valve", "dilated", &[]);
    let rings = "schema_version = 1\n[[alternative]]\n[[alternative.repair]]\nkind = \"ring\"\nfamily = \"saddle\"\nsize_mm = [28, 34]\n";
    let plan = folder.file("plan.toml", rings);
    let (file, out) = (folder.path("best.mcap"), folder.path("out"));
    let arguments = ["plan", &valve, &plan, "--frames", "6", "--record", &file];
    let output = coapt(&[&arguments[..], &["--out", &out, "--shapes"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(format!("{out}/plan.json")).unwrap()).unwrap();
    let best = &report["alternatives"][0];
    assert_eq!(best["rank"], 1);
    let name = best["name"].as_str().unwrap();
    assert!(
        stderr(&output).contains(&format!("after `{name}`")),
        "{}",
        stderr(&output)
    );
    let read = read(Path::new(&file)).unwrap();
    assert_eq!(serde_json::to_value(&read.repairs).unwrap(), best["repairs"]);
    let shapes = std::fs::read_dir(format!("{out}/shapes")).unwrap();
    let mut shapes: Vec<_> = shapes.map(|entry| entry.unwrap().path()).collect();
    shapes.retain(|path| {
        !path.to_string_lossy().ends_with("_chords.vtp") && !path.to_string_lossy().ends_with("_ring.vtp")
    });
    shapes.sort();
    let number = best["number"].as_u64().unwrap() as usize;
    for (film, shape) in read.films.iter().zip([&shapes[0], &shapes[number]]) {
        assert_eq!(
            bits(&film.frames[5].positions_mm),
            points_of(shape),
            "{}",
            shape.display()
        );
    }
    let warm = coapt(&[&arguments[..], &["--warm"]].concat());
    assert_eq!(warm.status.code(), Some(2));
    assert!(
        stderr(&warm).contains("begin at the open valve"),
        "{}",
        stderr(&warm)
    );
}

/// A shorter film leaves nothing of a longer one, and nothing else is touched.
#[test]
fn a_film_is_a_row_of_surfaces() {
    let folder = Folder::new("sequence");
    let valve = folder.valve(&[]);
    let (row, out) = (folder.path("row"), folder.path("out"));
    let run = |frames: &str, more: &[&str]| {
        let output = coapt(&[&["closure", &valve, "--sequence", &row, "--frames", frames], more].concat());
        assert!(output.status.success(), "{}", stderr(&output));
    };
    run("6", &["--ring", "physio-like:30"]);
    std::fs::write(format!("{row}/notes.txt"), "mine").unwrap();
    run("4", &["--out", &out]);
    let files: Vec<String> = snapshot(Path::new(&row)).into_keys().collect();
    let frames = (0..4).map(|number| format!("chords_000{number}.vtp"));
    let mut expected: Vec<String> = frames.collect();
    expected.extend(["chords.pvd", "notes.txt", "valve.pvd"].map(str::to_owned));
    expected.extend((0..4).map(|number| format!("valve_000{number}.vtp")));
    expected.sort();
    assert_eq!(files, expected);
    assert_ne!(fits_its_list(Path::new(&row)), Some(false));
    assert_eq!(
        points_of(format!("{row}/valve_0003.vtp")),
        points_of(format!("{out}/closed.vtp"))
    );
    let list = std::fs::read_to_string(format!("{row}/valve.pvd")).unwrap();
    assert!(
        list.contains("timestep=\"2\"") && list.contains("valve_0003.vtp"),
        "{list}"
    );
    let mesh = read_mesh(Path::new(&format!("{row}/valve_0000.vtp"))).unwrap().0;
    let certified = mesh
        .cell_arrays
        .iter()
        .find(|array| array.name == "certified")
        .unwrap();
    assert!(certified.values.iter().all(|&value| value == 1.0));
}

/// The format by its own rules: lengths, numbers of bytes, a weight for each frame but the first; bounds of positions are those of the open valve.
#[test]
fn a_film_is_shown_as_glb() {
    let folder = Folder::new("glb");
    let file = folder.path("closing.glb");
    let valve = folder.valve(&[]);
    let output = coapt(&["closure", &valve, "--glb", &file, "--frames", "5"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let bytes = std::fs::read(&file).unwrap();
    let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!(&bytes[..4], b"glTF");
    assert_eq!((number(4), number(8)), (2, bytes.len()));
    let json_end = 20 + number(12);
    assert_eq!(
        (&bytes[16..20], &bytes[json_end + 4..json_end + 8]),
        (&b"JSON"[..], &b"BIN\0"[..])
    );
    assert_eq!(json_end + 8 + number(json_end), bytes.len());
    let document: serde_json::Value = serde_json::from_slice(&bytes[20..json_end]).unwrap();
    let leaflets = &document["meshes"][0]["primitives"][0];
    assert_eq!(leaflets["targets"].as_array().unwrap().len(), 4);
    assert_eq!(document["meshes"][0]["weights"].as_array().unwrap().len(), 4);
    let accessor = |index: &serde_json::Value| &document["accessors"][index.as_u64().unwrap() as usize];
    let sampler = &document["animations"][0]["samplers"][0];
    assert_eq!(
        (
            &accessor(&sampler["input"])["count"],
            &accessor(&sampler["output"])["count"]
        ),
        (&5.into(), &20.into())
    );
    assert_eq!(accessor(&sampler["input"])["max"][0], 2.0);
    let buffer = document["buffers"][0]["byteLength"].as_u64().unwrap();
    for view in document["bufferViews"].as_array().unwrap() {
        let [offset, length] = ["byteOffset", "byteLength"].map(|key| view[key].as_u64().unwrap());
        assert!(offset % 4 == 0 && offset + length <= buffer);
    }
    // Up is +z of the patient: the annulus stands above the tips.
    let base = accessor(&leaflets["attributes"]["POSITION"]);
    let chords = accessor(&document["meshes"][1]["primitives"][0]["attributes"]["POSITION"]);
    assert!(base["max"][1].as_f64() > chords["min"][1].as_f64());
    assert!(base["count"].as_u64().unwrap() > 100);
}

//! Scenes with their files: what is read, what is refused, and that writing loses nothing.

mod fuzzed;
mod laws_page;
mod plans;
mod plans_page;
mod repairs_page;
mod schema;

use std::path::PathBuf;

use coapt::mesh::parametric::{Preset, ValveParameters, generate};
use coapt::model::Model;
use coapt::scene::{Repair, Scene, Severity};

use super::*;

/// A folder that is gone at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str, files: &[(&str, &str)]) -> Self {
        let folder = std::env::temp_dir().join(format!("coapt-scene-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        for (file, text) in files {
            std::fs::write(folder.join(file), text).unwrap();
        }
        Self(folder)
    }

    fn read(&self) -> Result<(Scene, Vec<Fault>), Vec<Fault>> {
        read_scene(&self.0.join("scene.toml"))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

const SQUARE: &str = "v 1 2 0\nv 11 2 0\nv 11 12 -5\nv 1 12 -5\nf 1 2 3\nf 1 3 4\n";

fn valve(preset: Preset, faces: u32) -> Scene {
    generate(&ValveParameters {
        face_count_target: faces,
        ..ValveParameters::preset(preset)
    })
    .unwrap()
}

/// A scene with two leaflet files and more keys.
fn two_leaflets(more: &str) -> String {
    format!(
        "schema_version = 1\nname = \"x\"\n{more}\n[load]\npressure_mmhg = 100\n[[leaflets]]\nname = \"a\"\n\
         mesh_file = \"a.obj\"\n[[leaflets]]\nname = \"b\"\nmesh_file = \"b.obj\"\n"
    )
}

fn messages(faults: &[Fault], severity: Severity) -> Vec<String> {
    let kept = faults.iter().filter(|fault| fault.severity == severity);
    kept.map(|fault| format!("{}: {}", fault.place, fault.message))
        .collect()
}

#[test]
fn what_is_written_reads_back_to_the_same_model() {
    for preset in Preset::ALL {
        let mut scene = valve(preset, 300);
        // Motion of one leaflet and one muscle only, areas, names that no file can have.
        let mesh = scene.leaflets[0].mesh.as_mut().unwrap();
        mesh.annulus_displacement_mm = Some(mesh.points_mm.iter().map(|p| [0.1, p[0] / 7.0, -0.3]).collect());
        scene.papillary[1].displacements_mm = vec![[0.1, 0.2, 1.0 / 3.0]; 3];
        let chords = scene.chordae[0].mesh.as_mut().unwrap();
        chords.area_mm2 = Some(vec![0.1 + 0.2; chords.segments.len()]);
        scene.chordae[1].name = "a/b: ü".into();
        scene.chordae[2].name = "a_b__-".into();
        let folder = Folder::new(preset.name(), &[]);
        write_scene(&folder.0, &scene).unwrap();
        let (back, faults) = folder.read().unwrap();
        // That the posterior leaflet has no motion is told, nothing else.
        assert_eq!(faults.len(), 1, "{faults:#?}");
        // `Debug` prints the shortest decimals that give the same bits.
        let [there, here] = [&scene, &back].map(|scene| format!("{:?}", Model::build(scene).unwrap().model));
        assert!(there == here, "{}", preset.name());
        // And a second time gives the same bytes.
        let first = std::fs::read(folder.0.join("scene.toml")).unwrap();
        write_scene(&folder.0, &scene).unwrap();
        assert_eq!(first, std::fs::read(folder.0.join("scene.toml")).unwrap());
    }
}

#[test]
fn a_scene_in_ras_is_turned_with_everything_in_it() {
    let mut scene = valve(Preset::Healthy, 300);
    let mesh = scene.leaflets[0].mesh.as_mut().unwrap();
    mesh.annulus_displacement_mm = Some(vec![[1.0, 2.0, 3.0]; mesh.points_mm.len()]);
    scene.papillary[0].displacements_mm = vec![[1.0, 0.0, 3.0]; 3];
    scene.annulus.curve_mm = Some(vec![[1.0, 2.0, 3.0]; 3]);
    let text = serde_json::to_string(&scene).unwrap();
    let read = |text: &str| scene_from_text(Path::new("scene.json"), text).unwrap().0;
    assert_eq!(read(&text), scene, "LPS stays as it is");
    let turned = read(&text.replace("\"LPS\"", "\"RAS\""));
    assert_eq!(turned.space, Space::LPS);
    assert_eq!(turned.annulus.curve_mm.as_ref().unwrap()[0], [-1.0, -2.0, 3.0]);
    assert_eq!(turned.papillary[0].displacements_mm[0], [-1.0, 0.0, 3.0]);
    let motion = turned.leaflets[0]
        .mesh
        .as_ref()
        .unwrap()
        .annulus_displacement_mm
        .as_ref();
    assert_eq!(motion.unwrap()[0], [-1.0, -2.0, 3.0]);
    let mut twice = turned.clone();
    frame::turn_scene(&mut twice);
    assert_eq!(twice, scene, "two half turns are none, zeros included");
    assert_ne!(turned, scene);
}

#[test]
fn files_without_a_mark_are_told_once_and_taken_in_the_frame_of_the_scene() {
    let first = |read: &(Scene, Vec<Fault>)| read.0.leaflets[0].mesh.as_ref().unwrap().points_mm[0];
    let lps = Folder::new(
        "lps",
        &[
            ("a.obj", SQUARE),
            ("b.obj", SQUARE),
            ("scene.toml", &two_leaflets("")),
        ],
    );
    let read = lps.read().unwrap();
    assert_eq!(read.1.len(), 1, "{:#?}", read.1);
    assert!(
        read.1[0]
            .message
            .contains("no SPACE mark in 2 files, `a.obj` the first: taken as LPS")
    );
    assert_eq!(first(&read), [1.0, 2.0, 0.0]);
    let text = two_leaflets("space = \"RAS\"");
    let ras = Folder::new(
        "ras",
        &[("a.obj", SQUARE), ("b.obj", SQUARE), ("scene.toml", &text)],
    );
    let read = ras.read().unwrap();
    assert!(read.1[0].message.contains("taken as RAS, as the scene says"));
    assert_eq!(first(&read), [-1.0, -2.0, 0.0]);
    let marked = format!("# SPACE=RAS\n{SQUARE}");
    let mixed = Folder::new(
        "mixed",
        &[
            ("a.obj", SQUARE),
            ("b.obj", &marked),
            ("scene.toml", &two_leaflets("")),
        ],
    );
    let errors = messages(&mixed.read().unwrap_err(), Severity::Error);
    assert!(
        errors[0].contains("`b.obj` is marked RAS and `a.obj` has no SPACE mark"),
        "{errors:?}"
    );
    let text = two_leaflets("").replace("a.obj", "b.obj");
    let all_marked = Folder::new("marked", &[("b.obj", &marked), ("scene.toml", &text)]);
    let read = all_marked.read().unwrap();
    assert_eq!((first(&read), read.1.len()), ([-1.0, -2.0, 0.0], 0));
}

#[test]
fn every_wrong_file_is_told_with_the_line_of_its_key() {
    let text = "schema_version = 1\nname = \"x\"\nload = { pressure_mmhg = 100 }\n\
                [[leaflets]]\nname = \"a\"\nmesh_file = \"../a.obj\"\n\
                [[leaflets]]\nname = \"b\"\nmesh_file = \"c.obj\"\n\
                [[leaflets]]\nname = \"c\"\nmesh_file = \"a.obj\"\nregion = 2\n\
                [[leaflets]]\nname = \"d\"\nmesh_file = \"bad.obj\"\n\
                [[chordae]]\nname = \"e\"\nmesh_file = \"a.obj\"\n\
                [annulus]\ncurve_file = \"https://a.b/c.json\"\n\
                [[papillary]]\nname = \"f\"\ntips_file = \"a.obj\"\ntips_mm = [[0, 0, 0]]\n";
    let bad = SQUARE.replace("f 1 3 4", "f 1 3 9");
    let folder = Folder::new(
        "wrong",
        &[("a.obj", SQUARE), ("bad.obj", &bad), ("scene.toml", text)],
    );
    let told = messages(&folder.read().unwrap_err(), Severity::Error).join("\n");
    for (line, words) in [
        (
            "scene.toml:6: ",
            "leaflets[0].mesh_file is `../a.obj`, which leads out of the scene's folder",
        ),
        ("scene.toml:9: ", "which does not exist; did you mean `a.obj`?"),
        ("scene.toml:13: ", "no cell array `leaflet`"),
        ("bad.obj:6: ", "point 8 does not exist"),
        ("scene.toml:19: ", "holds triangles and no lines"),
        ("scene.toml:21: ", "an address on a network"),
        (
            "scene.toml:24: ",
            "papillary[0].tips_file is given beside `tips_mm`",
        ),
    ] {
        let found = told
            .lines()
            .any(|fault| fault.contains(line) && fault.contains(words));
        assert!(found, "{line} {words}\n{told}");
    }
    assert_eq!(told.lines().count(), 7, "{told}");
}

#[test]
fn regions_marks_and_polylines_are_taken_over() {
    let vtk = "# vtk DataFile Version 3.0\nSPACE=LPS\nASCII\nDATASET POLYDATA\nPOINTS 5 float\n\
               0 0 0 10 0 0 10 10 0 0 10 0 0 10 -10\nLINES 1 4\n3 2 3 4\nPOLYGONS 2 8\n3 0 1 2\n3 0 2 3\n\
               CELL_DATA 3\nSCALARS leaflet int 1\nLOOKUP_TABLE default\n0\n1\n2\n\
               SCALARS rest_length_mm float 1\nLOOKUP_TABLE default\n30\n0\n0\n\
               POINT_DATA 5\nSCALARS ring int 1\nLOOKUP_TABLE default\n1\n0\n0\n1\n0\n";
    let text = "schema_version = 1\nname = \"x\"\nload = { pressure_mmhg = 100 }\nannulus.marker_array = \"ring\"\n\
                [[leaflets]]\nname = \"a\"\nmesh_file = \"v.vtk\"\nregion = 2\n\
                [[chordae]]\nname = \"c\"\nmesh_file = \"v.vtk\"\n";
    let folder = Folder::new("regions", &[("v.vtk", vtk), ("scene.toml", text)]);
    let (scene, faults) = folder.read().unwrap();
    assert!(faults.is_empty(), "{faults:#?}");
    let mesh = scene.leaflets[0].mesh.as_ref().unwrap();
    assert_eq!((mesh.points_mm.len(), &mesh.faces[..]), (3, &[[0, 1, 2]][..]));
    assert_eq!(mesh.annulus_points, Some(vec![0, 2]));
    let lines = scene.chordae[0].mesh.as_ref().unwrap();
    // Two equal segments of 10 mm share the 30 mm of their polyline.
    assert_eq!(lines.rest_length_mm, Some(vec![15.0, 15.0]));
    let wrong = Folder::new(
        "marks",
        &[
            ("v.vtk", vtk),
            ("scene.toml", &text.replace("\"ring\"", "\"rim\"")),
        ],
    );
    let told = messages(&wrong.read().unwrap_err(), Severity::Error);
    assert!(
        told[0].contains("scene.toml:4: annulus.marker_array is `rim`"),
        "{told:?}"
    );
}

#[test]
fn curves_and_tips_come_from_markups() {
    let markup = |kind: &str| {
        let points = "[{\"position\":[1,2,3]},{\"position\":[4,5,6]},{\"position\":[7,8,10]}]";
        format!(
            "{{\"@schema\":\"https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/\
             Resources/Schema/markups-schema-v1.0.3.json#\",\"markups\":[{{\"type\":\"{kind}\",\
             \"coordinateSystem\":\"RAS\",\"controlPoints\":{points}}}]}}"
        )
    };
    let text = two_leaflets(
        "[annulus]\ncurve_file = \"c.mrk.json\"\n[[papillary]]\nname = \"p\"\ntips_file = \"t.mrk.json\"",
    )
    .replace("b.obj", "a.obj");
    let marked = format!("# SPACE=LPS\n{SQUARE}");
    let files = [
        ("a.obj", &marked[..]),
        ("c.mrk.json", &markup("ClosedCurve")),
        ("t.mrk.json", &markup("Fiducial")),
        (
            "plan.toml",
            "schema_version = 1\n[[repair]]\nkind = \"ring\"\ncurve_file = \"c.mrk.json\"\n",
        ),
        ("scene.toml", &text),
    ];
    let folder = Folder::new("markups", &files);
    let (scene, faults) = folder.read().unwrap();
    assert!(faults.is_empty(), "{faults:#?}");
    let turned = vec![[-1.0, -2.0, 3.0], [-4.0, -5.0, 6.0], [-7.0, -8.0, 10.0]];
    assert_eq!(scene.annulus.curve_mm.as_ref(), Some(&turned));
    assert_eq!(scene.papillary[0].tips_mm, turned);
    let (plan, _) = read_plan(&folder.0.join("plan.toml")).unwrap();
    let Repair::Ring(ring) = &plan.repair[0] else {
        panic!("{plan:?}");
    };
    assert_eq!((ring.curve_mm.as_ref(), ring.closed), (Some(&turned), Some(true)));
}

#[test]
fn what_is_no_text_file_is_told_and_never_waited_for() {
    let folder = Folder::new("text", &[("empty.toml", ""), ("spaces.toml", " \n")]);
    std::fs::write(folder.0.join("latin.toml"), b"name = \"a\"\nname = \"\xfc\"").unwrap();
    for (file, words) in [
        (".", "is a folder"),
        ("none.toml", "No such file"),
        ("empty.toml", "is empty"),
        ("spaces.toml", "is empty"),
        ("latin.toml", "is not UTF-8"),
        #[cfg(unix)]
        ("/dev/zero", "not a regular file"),
    ] {
        let told = messages(&read_scene(&folder.0.join(file)).unwrap_err(), Severity::Error);
        assert!(told[0].contains(words), "{told:?}");
    }
    let latin = read_scene(&folder.0.join("latin.toml")).unwrap_err();
    assert!(latin[0].place.ends_with("latin.toml:2"));
}

//! `assets/hard`: the scenes and plans of the rows as files, for the program and for other solvers. Rows that begin elsewhere
//! than open, or at other points for a jitter, are no scenes.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use coapt::repair::ring_shape::parse_ring_spec;
use coapt::scene::{Plan, Repair, SCHEMA_VERSION, Scene};
use coapt_io::scene::{read_plan, read_scene, write_scene};
use coapt_tests::hard::{file_stem, folder};

use super::rows::{Deed, RINGS, ROWS};
use super::scene;

/// The scenes of all rows that are scenes, by the names of their files.
fn scenes() -> BTreeMap<String, Scene> {
    let rows = ROWS
        .iter()
        .filter(|(.., deed, _)| !matches!(deed, Deed::Start(_)));
    let of_row = |&(name, _, deed, presets): &super::rows::Row| {
        let of_preset = move |preset: &coapt::mesh::parametric::Preset| {
            let name = format!("{}: {name}", preset.name());
            let mut scene = scene(*preset, deed).expect("presets are valves");
            name.clone_into(&mut scene.name);
            (file_stem(&name), scene)
        };
        presets.iter().map(of_preset)
    };
    rows.flat_map(of_row).collect()
}

/// The plans of the rows with rings, by the names of their files.
fn plans() -> BTreeMap<String, Plan> {
    let plan = |(_, spec): &(_, &str)| Plan {
        schema_version: SCHEMA_VERSION,
        name: format!("ring {spec}"),
        repair: vec![Repair::Ring(parse_ring_spec(spec).expect("a ring"))],
    };
    RINGS
        .iter()
        .map(|row| (file_stem(&format!("ring {}", row.1)), plan(row)))
        .collect()
}

fn scene_path(stem: &str) -> PathBuf {
    folder().join(format!("{stem}.toml"))
}

fn plan_path(stem: &str) -> PathBuf {
    folder().join("plans").join(format!("{stem}.toml"))
}

#[test]
fn files_hold_the_rows_of_the_gallery() {
    if std::env::var_os("COAPT_WRITE_TABLES").is_some() {
        write();
    }
    let scenes = scenes();
    for (stem, scene) in &scenes {
        let (read, warnings) =
            read_scene(&scene_path(stem)).unwrap_or_else(|faults| panic!("{stem}: {faults:?}"));
        assert!(
            warnings.is_empty() && read == *scene,
            "{stem} {warnings:?}: write the files anew, with COAPT_WRITE_TABLES=1"
        );
    }
    let plans = plans();
    for (stem, plan) in &plans {
        let (read, warnings) =
            read_plan(&plan_path(stem)).unwrap_or_else(|faults| panic!("{stem}: {faults:?}"));
        assert!(warnings.is_empty() && read == *plan, "{stem}");
    }
    let count = |folder: PathBuf| {
        fs::read_dir(folder)
            .unwrap()
            .filter(|entry| {
                entry
                    .as_ref()
                    .unwrap()
                    .path()
                    .extension()
                    .is_some_and(|e| e == "toml")
            })
            .count()
    };
    assert_eq!(
        (count(folder()), count(folder().join("plans"))),
        (scenes.len(), plans.len()),
        "files of no row"
    );
}

/// Writes all files anew. Scenes share the meshes that they have in common.
fn write() {
    let folder = folder();
    for old in ["meshes", "plans"] {
        let _ = fs::remove_dir_all(folder.join(old));
        fs::create_dir_all(folder.join(old)).unwrap();
    }
    for entry in fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            fs::remove_file(path).unwrap();
        }
    }
    let mut meshes: BTreeMap<Vec<u8>, String> = BTreeMap::new();
    let scratch = std::env::temp_dir().join(format!("coapt-hard-{}", std::process::id()));
    for (stem, scene) in scenes() {
        write_scene(&scratch, &scene).unwrap();
        let mut text = fs::read_to_string(scratch.join("scene.toml")).unwrap();
        for file in mesh_files(&scratch) {
            let bytes = fs::read(scratch.join(&file)).unwrap();
            let shared = meshes.entry(bytes).or_insert_with_key(|bytes| {
                let name = format!("meshes/{stem}-{file}");
                fs::write(folder.join(&name), bytes).unwrap();
                name
            });
            text = text.replace(&format!("\"{file}\""), &format!("\"{shared}\""));
        }
        fs::write(scene_path(&stem), text).unwrap();
        fs::remove_dir_all(&scratch).unwrap();
    }
    for (stem, plan) in plans() {
        fs::write(plan_path(&stem), toml::to_string(&plan).unwrap()).unwrap();
    }
}

fn mesh_files(folder: &Path) -> Vec<String> {
    let names = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.filter(|name| name.ends_with(".vtp")).collect();
    names.sort();
    names
}

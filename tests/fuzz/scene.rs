//! Any text as a scene and as a plan, which may name the meshes of `assets/bad`: refused with faults, or made to a model
//! that keeps its promises. A scene that has a model is written and read again.

use std::path::PathBuf;
use std::sync::LazyLock;

use crate::{assets, check_defined, check_faults, check_model, good_scene, scratch, within_memory};
use coapt::model::{Built, Model};
use coapt::repair::{apply, parse_ring_spec};
use coapt::scene::{Fault, Repair, Scene};
use coapt_io::scene::{located, plan_from_text, read_scene, scene_from_text, write_scene};

static GOOD: LazyLock<Model> =
    LazyLock::new(|| Model::build(&good_scene()).expect("the good scene is good").model);
static FOLDER: LazyLock<PathBuf> = LazyLock::new(scratch);
/// A table of one key and one number, `a=1`, is a few hundred bytes of memory, and each of up to twenty unknown keys is
/// taken out of a copy.
const MEMORY_PER_BYTE: u64 = 1000;
/// More repairs only repeat what one does.
const MOST_REPAIRS: usize = 4;

/// One input; what is no text is none.
pub fn scene(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    let path = assets().join("input.toml");
    let (model, read) = within_memory(bytes, MEMORY_PER_BYTE, || {
        let read = scene_from_text(&path, text);
        check(&read);
        let model = read.as_ref().ok().and_then(|(scene, _)| model(text, scene));
        (model, read)
    });
    if let (Some(model), Ok((scene, _))) = (model, read) {
        check_model(&model);
        write_and_read(&scene, &model);
    }
    let plan = within_memory(bytes, MEMORY_PER_BYTE, || plan_from_text(&path, text));
    check(&plan);
    if let Ok((plan, _)) = plan {
        repair(&plan.repair);
    }
    if let Some(Ok(ring)) = text.lines().next().map(parse_ring_spec) {
        repair(&[Repair::Ring(ring)]);
    }
}

fn check<T>(read: &Result<(T, Vec<Fault>), Vec<Fault>>) {
    match read {
        Ok((_, warnings)) => check_faults(warnings, false),
        Err(faults) => check_faults(faults, true),
    }
}

fn model(text: &str, scene: &Scene) -> Option<Model> {
    match Model::build(scene) {
        Ok(Built { model, warnings, .. }) => {
            check_faults(&warnings, false);
            Some(model)
        }
        Err(faults) => {
            check_faults(&faults, true);
            let told: Vec<Fault> = faults
                .iter()
                .map(|fault| located("input.toml", text, fault))
                .collect();
            check_faults(&told, true);
            None
        }
    }
}

/// What was built can be written, and builds to the same model from there.
fn write_and_read(scene: &Scene, model: &Model) {
    let folder = FOLDER.join("written");
    write_scene(&folder, scene).unwrap_or_else(|fault| panic!("{fault:?}"));
    let (again, _) = read_scene(&folder.join("scene.toml")).unwrap_or_else(|faults| panic!("{faults:#?}"));
    let again = Model::build(&again).unwrap_or_else(|faults| panic!("{faults:#?}"));
    assert_eq!(format!("{model:?}"), format!("{:?}", again.model));
    std::fs::remove_dir_all(&folder).expect("the folder was written");
}

fn repair(repairs: &[Repair]) {
    let mut model = GOOD.clone();
    for repair in repairs.iter().take(MOST_REPAIRS) {
        match apply(&model, repair) {
            Ok(repaired) => {
                check_faults(&repaired.warnings, false);
                check_defined(&repaired.report);
                check_model(&repaired.model);
                model = repaired.model;
            }
            Err(faults) => return check_faults(&faults, true),
        }
    }
}

//! What the fuzz targets do with an input: `fuzz/` hands them those that libFuzzer makes, the test of seeds those that are kept.
//!
//! They stand here so that every build compiles them, though fuzzing itself wants another compiler.

mod changes;
mod closure;
mod mesh;
mod recording;
mod scene;
mod tables;

use std::fmt::Debug;
use std::path::{Path, PathBuf};

use coapt::model::Model;
use coapt::scene::{Fault, Severity};

pub use closure::closure;
pub use mesh::mesh;
pub use recording::recording;
pub use scene::scene;
pub use tables::tables;

/// The folder of wrong inputs, with the good valve of 96 faces that they are made from.
pub(crate) fn assets() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/bad")
}

/// The folder of seeds that are no files of other tests.
pub fn seeds() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/seeds")
}

/// A scene of the good valve, with its meshes.
pub(crate) fn good_scene() -> coapt::scene::Scene {
    let path = assets().join("parts/good.toml");
    coapt_io::scene::read_scene(&path)
        .expect("the good scene is good")
        .0
}

/// A folder for files of this process alone; `run` puts it into memory.
pub fn scratch() -> PathBuf {
    let folder = std::env::temp_dir().join(format!("coapt-fuzz-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for files");
    folder
}

/// Runs a reader and sees that it takes no more memory than `per_byte` times its input and some room of its own.
pub(crate) fn within_memory<T>(bytes: &[u8], per_byte: u64, run: impl FnOnce() -> T) -> T {
    let mut result = None;
    let taken = allocation_counter::measure(|| result = Some(run()));
    let most = (16 << 20) + per_byte * bytes.len() as u64;
    assert!(
        taken.bytes_max <= most,
        "{} bytes of memory for {} bytes of input",
        taken.bytes_max,
        bytes.len()
    );
    result.expect("it has run")
}

/// Errors, and warnings, that a reader or `Model::build` may tell: twenty and one that says that there are more.
const MOST_FAULTS: usize = 21;
/// Letters of a fault that still help; what a file says must be quoted in part.
const MOST_LETTERS: usize = 2000;

/// Faults are few, short, and have an error among them where nothing came out.
pub(crate) fn check_faults(faults: &[Fault], refused: bool) {
    let errors = faults
        .iter()
        .filter(|fault| fault.severity == Severity::Error)
        .count();
    assert_eq!(errors > 0, refused, "{faults:#?}");
    assert!(
        errors <= MOST_FAULTS && faults.len() - errors <= MOST_FAULTS,
        "{} faults: {faults:#?}",
        faults.len()
    );
    for fault in faults {
        let letters = fault.place.len() + fault.message.len();
        assert!(letters <= MOST_LETTERS, "{letters} letters in a fault: {fault:?}");
        assert!(!fault.message.is_empty());
    }
}

/// Sees that no number in something is undefined or infinite. Names that people give must be taken out before.
pub(crate) fn check_defined(what: &impl Debug) {
    let text = format!("{what:?}");
    let is_name = |letter: char| letter.is_alphanumeric() || letter == '_';
    let mut words = text.split(|letter: char| !is_name(letter));
    let undefined = words.any(|word| word == "NaN" || word == "inf");
    assert!(!undefined, "{text}");
}

/// Sees that a model that was built keeps its promises: numbers are defined, indices lead somewhere.
pub(crate) fn check_model(model: &Model) {
    let mut unnamed = model.clone();
    unnamed.name.clear();
    unnamed.chord_groups.clear();
    unnamed
        .leaflets
        .iter_mut()
        .for_each(|leaflet| leaflet.name.clear());
    unnamed
        .papillary
        .iter_mut()
        .for_each(|muscle| muscle.name.clear());
    check_defined(&unnamed);
    let (vertices, in_leaflets) = (model.rest_mm.len() as u32, model.leaflet_vertex_count as u32);
    assert!(in_leaflets <= vertices);
    assert!(model.faces.iter().flatten().all(|&vertex| vertex < in_leaflets));
    assert_eq!(model.faces.len(), model.face_leaflet.len());
    assert!(
        model
            .face_leaflet
            .iter()
            .all(|&leaflet| (leaflet as usize) < model.leaflets.len())
    );
    assert!(
        model
            .springs
            .ends
            .iter()
            .flatten()
            .all(|&vertex| vertex < in_leaflets)
    );
    assert!(
        model
            .membranes
            .corners
            .iter()
            .flatten()
            .all(|&vertex| vertex < in_leaflets)
    );
    assert!(
        model
            .hinges
            .vertices
            .iter()
            .flatten()
            .all(|&vertex| vertex < in_leaflets)
    );
    let chords = &model.chords;
    assert!(
        chords
            .points
            .iter()
            .flatten()
            .all(|&(vertex, _)| vertex < vertices)
    );
    assert!(
        chords
            .ends
            .iter()
            .flatten()
            .all(|&point| (point as usize) < chords.points.len())
    );
    assert!(
        chords
            .group
            .iter()
            .all(|&group| (group as usize) < chords.laws.len())
    );
    assert!(model.annulus.iter().all(|&vertex| vertex < in_leaflets));
    assert!(
        model
            .margins
            .iter()
            .flat_map(|margin| &margin.vertices)
            .all(|&vertex| vertex < in_leaflets)
    );
    assert!(
        model
            .papillary
            .iter()
            .flat_map(|muscle| &muscle.tips)
            .all(|&vertex| vertex < vertices)
    );
    assert!(model.prescribed.is_sorted_by(|a, b| a.vertex < b.vertex));
    assert!(
        model
            .prescribed
            .iter()
            .all(|prescribed| prescribed.vertex < vertices)
    );
    let marks = &model.landmarks;
    let marks = [
        marks.mid_anterior,
        marks.mid_posterior,
        marks.commissure_anterolateral,
        marks.commissure_posteromedial,
        marks.trigone_left,
        marks.trigone_right,
    ];
    assert!(marks.iter().all(|&mark| mark < model.annulus.len()));
}

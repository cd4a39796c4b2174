//! Any bytes as a biaxial table and as a result of CalculiX or FEBio: refused with faults, or read to numbers.

use std::path::PathBuf;
use std::sync::LazyLock;

use crate::{check_defined, check_faults, good_scene, scratch, within_memory};
use coapt::model::Model;
use coapt_io::biaxial::{biaxial_from_text, read_biaxial};
use coapt_io::export::read_positions;

/// A few triangles of the good valve, so that short files have all its vertices.
static MODEL: LazyLock<Model> = LazyLock::new(|| {
    let mut model = Model::build(&good_scene()).expect("the good scene is good").model;
    model.faces.truncate(2);
    model.rest_mm.truncate(
        model
            .faces
            .iter()
            .flatten()
            .max()
            .map_or(0, |&last| last as usize + 1),
    );
    model
});
static FOLDER: LazyLock<PathBuf> = LazyLock::new(scratch);
/// The shortest line of a node becomes an entry of a map.
const MEMORY_PER_BYTE: u64 = 100;

/// One input.
pub fn tables(bytes: &[u8]) {
    let file = FOLDER.join("table");
    std::fs::write(&file, bytes).expect("a file");
    match within_memory(bytes, MEMORY_PER_BYTE, || read_positions(&file, &MODEL)) {
        Ok((positions, warnings)) => {
            check_faults(&warnings, false);
            assert_eq!(positions.len(), MODEL.rest_mm.len());
            check_defined(&positions);
        }
        Err(faults) => check_faults(&faults, true),
    }
    for thickness_mm in [None, Some(0.8)] {
        match within_memory(bytes, MEMORY_PER_BYTE, || read_biaxial(&file, thickness_mm)) {
            Ok(points) => check_defined(&points),
            Err(faults) => check_faults(&faults, true),
        }
    }
    let lossy = String::from_utf8_lossy(bytes);
    if let Ok(points) = biaxial_from_text("table", &lossy, Some(1e-3)) {
        check_defined(&points);
    }
}

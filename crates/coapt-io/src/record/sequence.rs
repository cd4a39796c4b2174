//! A film as surfaces that `ParaView` plays, without a viewer of recordings.
//!
//! | file | holds |
//! |---|---|
//! | `valve.pvd`, `chords.pvd` | lists of the frames with their times [s], as in a recording |
//! | `valve_0000.vtp`, ... | leaflets with the arrays of `closed.vtp`, and cells `certified`: 0 where the frame is no balance |
//! | `chords_0000.vtp`, ... | chordae with the arrays of `chords.vtp` |
//! | `SHA256SUMS` | all of these with their checksums |
//!
//! With repairs they stand twice, in `before/` and `after/`.

use std::path::{Path, PathBuf};

use coapt::scene::Fault;
use rayon::prelude::*;

use super::{FRAMES_AT_A_TIME, Filmed, time_ns};
use crate::atomic::{Batch, make_folder};
use crate::mesh::{Array, stage_pvd, stage_vtp};
use crate::report::{closed_surface, loaded_chords};

/// First parts of the names of frames.
const NAMES: [&str; 2] = ["valve", "chords"];

/// Writes films into a folder, which is made if need be; frames of an earlier film are replaced, all of them once all are written.
///
/// # Errors
/// A position that is not finite, or what the file system says.
pub fn write_sequence(folder: &Path, before: Filmed, after: Option<Filmed>) -> Result<(), Fault> {
    let mut batch = Batch::default();
    let mut written = Vec::new();
    let places = ["", "before", "after"].map(|place| folder.join(place));
    match after {
        None => written.extend(stage_film(&mut batch, &places[0], before)?),
        Some(after) => {
            written.extend(stage_film(&mut batch, &places[1], before)?);
            written.extend(stage_film(&mut batch, &places[2], after)?);
        }
    }
    for old in places.iter().flat_map(|place| files_in(place)) {
        if !written.contains(&old) {
            batch.remove(old);
        }
    }
    make_folder(folder)?;
    batch.finish_listed(folder)
}

fn stage_film(batch: &mut Batch, folder: &Path, filmed: Filmed) -> Result<Vec<PathBuf>, Fault> {
    make_folder(folder)?;
    let Filmed { model, film, .. } = filmed;
    let count = film.frames.len();
    let mut written = Vec::new();
    let numbers: Vec<usize> = (0..count).collect();
    for some in numbers.chunks(FRAMES_AT_A_TIME) {
        let surface = |&number: &usize| {
            let frame = &film.frames[number];
            let mut surface = closed_surface(model, &frame.equilibrium.state.positions_mm);
            surface.cell_arrays.push(Array {
                name: "certified".to_owned(),
                components: 1,
                values: vec![f64::from(frame.is_certified()); model.faces.len()],
            });
            surface
        };
        let surfaces: Vec<_> = some.par_iter().map(surface).collect();
        for (&number, surface) in some.iter().zip(&surfaces) {
            written.push(folder.join(file_name(NAMES[0], number)));
            stage_vtp(batch, &written[written.len() - 1], surface)?;
        }
    }
    if !model.chords.ends.is_empty() {
        for (number, frame) in film.frames.iter().enumerate() {
            written.push(folder.join(file_name(NAMES[1], number)));
            let chords = loaded_chords(model, &frame.equilibrium.state.positions_mm);
            stage_vtp(batch, &written[written.len() - 1], &chords)?;
        }
    }
    let names = if model.chords.ends.is_empty() {
        &NAMES[..1]
    } else {
        &NAMES
    };
    for name in names {
        let time_s = |number| time_ns(number, count) as f64 * 1e-9;
        let frames: Vec<(f64, String)> = numbers
            .iter()
            .map(|&number| (time_s(number), file_name(name, number)))
            .collect();
        written.push(folder.join(format!("{name}.pvd")));
        stage_pvd(batch, &written[written.len() - 1], &frames)?;
    }
    Ok(written)
}

fn file_name(name: &str, number: usize) -> String {
    format!("{name}_{number:04}.vtp")
}

/// Files of an earlier film: nothing else is touched.
fn files_in(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let is_ours = |path: &PathBuf| {
        let file = path.file_name().and_then(|name| name.to_str()).unwrap_or("");
        NAMES.iter().any(|name| {
            let number = file
                .strip_prefix(name)
                .and_then(|rest| rest.strip_prefix('_')?.strip_suffix(".vtp"));
            let is_frame = number
                .is_some_and(|number| number.len() >= 4 && number.bytes().all(|byte| byte.is_ascii_digit()));
            is_frame || file.strip_prefix(name) == Some(".pvd")
        })
    };
    entries.map(|entry| entry.path()).filter(is_ours).collect()
}

//! Any bytes as a recording: refused with a fault, or read to frames of numbers.

use crate::{check_defined, check_faults, within_memory};
use coapt_io::record::{RecordedFilm, read_bytes};

/// LZ4 grows to 255 times its bytes at most; of these, two that say nothing of an entity become 96 in memory, and half as much again
/// while their list grows.
const MEMORY_PER_BYTE: u64 = 20_000;

/// One input.
pub fn recording(bytes: &[u8]) {
    match within_memory(bytes, MEMORY_PER_BYTE, || read_bytes(bytes)) {
        Ok(recording) => recording.films.iter().for_each(check_film),
        Err(fault) => check_faults(&[fault], true),
    }
}

fn check_film(film: &RecordedFilm) {
    check_defined(film);
    let vertices = film.frames.first().map_or(0, |frame| frame.positions_mm.len());
    for frame in &film.frames {
        assert_eq!(frame.positions_mm.len(), vertices);
    }
    assert!(
        film.faces
            .iter()
            .flatten()
            .all(|&vertex| (vertex as usize) < vertices)
    );
}

//! Any bytes as a recording: refused with a fault, or read to frames of numbers.

#![no_main]

use coapt_fuzz::{check_faults, within_memory};
use coapt_io::record::read_bytes;
use libfuzzer_sys::fuzz_target;

/// LZ4 grows to 255 times its bytes at most, and a point of 4 bytes in a message to one of 48 in memory, and again in the frame.
const MEMORY_PER_BYTE: u64 = 20_000;

fuzz_target!(|bytes: &[u8]| {
    match within_memory(bytes, MEMORY_PER_BYTE, || read_bytes(bytes)) {
        Ok(recording) => {
            for film in &recording.films {
                for frame in &film.frames {
                    assert_eq!(frame.positions_mm.len(), film.frames[0].positions_mm.len());
                    assert!(frame.positions_mm.iter().flatten().all(|number| number.is_finite()));
                }
                let vertices = film.frames.first().map_or(0, |frame| frame.positions_mm.len());
                assert!(film.faces.iter().flatten().all(|&vertex| (vertex as usize) < vertices));
            }
        }
        Err(fault) => check_faults(&[fault], true),
    }
});

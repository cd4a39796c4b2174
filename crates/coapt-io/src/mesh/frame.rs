//! The patient frame of a file: Slicer's mark `SPACE=LPS` or `SPACE=RAS`, and turning RAS into LPS.

use std::collections::BTreeSet;

use coapt::scene::Space;

use super::PolyData;
use super::faults::{Faults, Place, Stop};

/// The frame that a comment or title names, if it names one.
pub(super) fn find_mark(text: &[u8], place: Place, faults: &mut Faults) -> Result<Option<Space>, Stop> {
    const MARK: &[u8] = b"SPACE=";
    let Some(at) = text
        .windows(MARK.len())
        .position(|part| part.eq_ignore_ascii_case(MARK))
    else {
        return Ok(None);
    };
    let rest = &text[at + MARK.len()..];
    let length = rest
        .iter()
        .position(|byte| !byte.is_ascii_alphanumeric())
        .unwrap_or(rest.len());
    named(&String::from_utf8_lossy(&rest[..length.min(16)]), place, faults)
}

/// The frame of this name; an unknown one is an error, since its points would be misplaced silently.
pub(super) fn named(name: &str, place: Place, faults: &mut Faults) -> Result<Option<Space>, Stop> {
    match name.trim().to_ascii_uppercase().as_str() {
        "LPS" => Ok(Some(Space::LPS)),
        "RAS" => Ok(Some(Space::RAS)),
        _ => {
            faults.error(place, format!("SPACE is `{name}`; only LPS and RAS are known"))?;
            Ok(None)
        }
    }
}

/// Half a turn about z, between RAS and LPS in either direction: a rotation, so that faces keep their side.
pub(super) fn turn(points: &mut [[f64; 3]]) {
    for point in points {
        // `0.0 - x` and not `-x`: a zero stays positive.
        *point = [0.0 - point[0], 0.0 - point[1], point[2]];
    }
}

/// Turns a mesh that is marked RAS, with the arrays named in `vectors`, into LPS.
pub(super) fn to_lps(mesh: &mut PolyData, vectors: &[String], faults: &mut Faults) {
    if mesh.space != Some(Space::RAS) {
        return;
    }
    turn(&mut mesh.points);
    let vectors: BTreeSet<&String> = vectors.iter().collect();
    let mut turned = Vec::new();
    for array in mesh.point_arrays.iter_mut().chain(&mut mesh.cell_arrays) {
        if array.components == 3 && vectors.contains(&array.name) {
            turn(array.values.as_chunks_mut().0);
            turned.push(format!("`{}`", array.name));
        }
    }
    if !turned.is_empty() {
        let message = format!(
            "turned from RAS to LPS with the points, as vectors: {}",
            turned.join(", ")
        );
        faults.warning(Place::File, message);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mark_is_found_and_an_unknown_frame_refused() {
        let mut faults = Faults::new("f".into());
        let mut find = |text: &str| find_mark(text.as_bytes(), Place::Line(2), &mut faults);
        assert_eq!(find("3D Slicer output. SPACE=LPS"), Ok(Some(Space::LPS)));
        assert_eq!(find("SPACE=ras; by hand"), Ok(Some(Space::RAS)));
        assert_eq!(find("vtk output"), Ok(None));
        assert_eq!(find("SPACE=LAS"), Ok(None));
        assert_eq!(
            faults.list[0].message,
            "SPACE is `LAS`; only LPS and RAS are known"
        );
    }
}

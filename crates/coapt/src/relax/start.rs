//! Where a closure begins.

use super::Untangled;
use super::newton::Newton;
use crate::Vec3;
use crate::contact::tangle::{inside_out, tangles};
use crate::state::State;

/// The start that was asked for, or, where it is tangled or inside out, as near to it as one comes from the open valve, which
/// tells who belongs on which side; nothing where that is tangled itself.
pub(super) fn begin(newton: &mut Newton, start: &State) -> Option<(Vec<Vec3>, Option<Untangled>)> {
    let model = newton.model;
    let places = match model.contact.is_on() {
        true => {
            tangles(&newton.surface, &start.positions_mm).len()
                + inside_out(&newton.surface, &model.rest_mm, &start.positions_mm).len()
        }
        false => 0,
    };
    if places == 0 {
        return Some((start.positions_mm.clone(), None));
    }
    if !tangles(&newton.surface, &model.rest_mm).is_empty() {
        return None;
    }
    let mut positions = model.rest_mm.clone();
    newton.walk(&mut positions, &start.positions_mm);
    let ways = positions.iter().zip(&start.positions_mm);
    let farthest_mm = ways
        .map(|(here, there)| (here - there).norm())
        .fold(0.0, f64::max);
    let untangled = Untangled { places, farthest_mm };
    Some((positions, Some(untangled)))
}

//! Pictures of closed valves without a display: from the atrium and from the side, coloured, with a scale bar, as PNG.

mod canvas;
mod colours;
mod view;

use std::path::Path;

use coapt::measure::{ValveFrame, valve_frame};
use coapt::scene::Fault;
use png::{BitDepth, ColorType, Encoder};

use crate::atomic::Batch;
use crate::page::geometry::{Geometry, curve};
use crate::page::{MIDDLE_SURFACES, geometry_of};
use crate::report::{Closed, Closure, NOT_CERTIFIED, NOTICE, ring_curves};
use canvas::{Canvas, INK, LETTER_WIDTH};
use colours::{Colouring, UNCERTIFIED};
use view::{Direction, drawn};

pub use colours::Quantity;

/// A closed valve on a picture.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a> {
    /// What it is called.
    pub name: &'a str,
    /// Whether the result may be used.
    pub certified: bool,
    /// Where it lies.
    pub geometry: &'a Geometry,
}

/// Pixels of one view, across and down.
const VIEW: [usize; 2] = [480, 400];

const HEAD: usize = 28;
const FOOT: usize = 80;

/// A picture of some valves in one frame, a row for each: from the atrium with the aorta on top, and from the side with the atrium on top and
/// the aorta to the right. Equal valves give equal bytes.
///
/// # Errors
/// None that numbers of a valve allow.
pub fn picture_png(frame: &ValveFrame, valves: &[Shown], quantity: Quantity) -> Result<Vec<u8>, Fault> {
    let picture = composed(frame, valves, quantity);
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, picture.width as u32, picture.height as u32);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    let written = encoder
        .write_header()
        .and_then(|mut writer| writer.write_image_data(&picture.bytes()));
    written.map_err(|error| Fault::error("picture", error.to_string()))?;
    Ok(bytes)
}

/// Sees that a file is called what it will be: `picture.jpg` would hold a PNG.
///
/// # Errors
/// A name that does not end in `.png`.
pub fn check_name(place: &str, path: &Path) -> Result<(), Fault> {
    let is_png = path
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("png"));
    match is_png {
        true => Ok(()),
        false => Err(Fault::error(
            place,
            format!(
                "{} would hold a PNG picture, the only kind that is written; expected a name that ends in .png",
                path.display()
            ),
        )),
    }
}

/// Writes a picture of a closed valve, and of the same closed after a plan, to a PNG file.
///
/// # Errors
/// As [`check_name`], an annulus without a plane, and what the file system says; the old file is then untouched.
pub fn write_closure_picture(path: &Path, closure: &Closure, quantity: Quantity) -> Result<(), Fault> {
    check_name("picture", path)?;
    let fault = |message: String| Fault::error(path.display().to_string(), message);
    let before = &closure.before;
    let frame = valve_frame(&before.model, &before.equilibrium.state.positions_mm);
    let frame = frame.ok_or_else(|| fault("cannot be drawn: the annulus has no plane".to_owned()))?;
    let name = &before.model.name;
    let states: Vec<(String, &Closed)> = match &closure.after {
        None => vec![(name.clone(), before)],
        Some(after) => vec![
            (format!("{name}, before"), before),
            (format!("{name}, after"), after),
        ],
    };
    let geometries = states
        .iter()
        .map(|(_, closed)| geometry_of(&closed.model, &closed.equilibrium.state.positions_mm, false));
    let mut geometries: Vec<Geometry> = geometries.collect::<Result<_, _>>().map_err(fault)?;
    if let (Some(last), Some(_)) = (geometries.last_mut(), &closure.after) {
        last.rings = ring_curves(&closure.repairs).iter().map(curve).collect();
    }
    let shown = states
        .iter()
        .zip(&geometries)
        .map(|((name, closed), geometry)| Shown {
            name,
            certified: closed
                .equilibrium
                .certificate
                .is_certified(closed.equilibrium.status),
            geometry,
        });
    let shown: Vec<Shown> = shown.collect();
    let mut batch = Batch::default();
    batch.write(path, &picture_png(&frame, &shown, quantity)?)?;
    batch.finish()
}

fn composed(frame: &ValveFrame, valves: &[Shown], quantity: Quantity) -> Canvas {
    let [width, height] = VIEW;
    let geometries = valves.iter().map(|valve| valve.geometry);
    let reach = geometries
        .clone()
        .map(|geometry| geometry.reach_mm(frame.centre_mm));
    let reach_mm = reach.fold(1.0, f64::max);
    let colouring = Colouring::new(quantity, geometries);
    let mut whole = Canvas::new(2 * width, valves.len() * (height + HEAD) + FOOT);
    for (row, valve) in valves.iter().enumerate() {
        let top = row * (height + HEAD);
        for (column, direction) in [Direction::Atrium, Direction::Side].into_iter().enumerate() {
            let view = drawn(frame, valve.geometry, direction, &colouring, reach_mm, VIEW);
            whole.place([column * width, top + HEAD], &view);
        }
        let (trust, colour) = match valve.certified {
            true => ("certified".to_owned(), INK),
            false => (format!("{NOT_CERTIFIED}: no prediction"), UNCERTIFIED),
        };
        // What is trusted must be seen whole; the name need not.
        let room = (width - 16) / LETTER_WIDTH - trust.len() - 2;
        let name: String = valve.name.chars().take(room).collect();
        whole.words([8, top + 8], &format!("{name}: {trust}"), colour);
        whole.words([width + 8, top + 8], "from the side, aorta right", INK);
    }
    foot(&mut whole, &colouring, reach_mm);
    whole
}

/// Colours, scale, what the picture is not for, and why what is closed does not look so.
fn foot(whole: &mut Canvas, colouring: &Colouring, reach_mm: f64) {
    let top = whole.height - FOOT + 6;
    const BAR: usize = 220;
    for x in 0..BAR {
        let share = x as f32 / (BAR - 1) as f32;
        whole.rectangle([8 + x, top], [1, 12], colouring.at_share(share));
    }
    let [low, high] = colouring.ends();
    whole.words([8, top + 15], &low, INK);
    let right = (8 + BAR).saturating_sub(LETTER_WIDTH * high.chars().count());
    whole.words([right, top + 15], &high, INK);
    whole.words([8 + BAR + 12, top - 2], colouring.title(), INK);
    whole.words([8 + BAR + 12, top + 15], NOTICE, INK);
    whole.words([8, top + 33], MIDDLE_SURFACES, INK);
    let scale = (10.0 * view::pixels_per_mm(reach_mm, VIEW)).round() as usize;
    let left = whole.width.saturating_sub(scale + 12);
    whole.rectangle([left, top + 6], [scale, 3], INK);
    whole.words([left, top + 15], "10 mm", INK);
}

#[cfg(test)]
mod tests;

use coapt::measure::valve_frame;

use super::*;
use crate::report::tests::closure_of;
use crate::report::{Closed, closed_surface};

fn geometry(closed: &Closed) -> Geometry {
    let positions = &closed.equilibrium.state.positions_mm;
    Geometry::of_closed_surface(&closed_surface(&closed.model, positions)).unwrap()
}

/// What is written is PNG, and must be called so.
#[test]
fn a_picture_is_called_what_it_is() {
    for name in ["closed.png", "out/closed.PNG"] {
        assert_eq!(check_name("--picture", Path::new(name)), Ok(()));
    }
    for name in ["closed.jpg", "closed", ".png", "png"] {
        let fault = check_name("--picture", Path::new(name)).unwrap_err();
        let told = crate::scene::sentence(&fault);
        assert!(
            told.contains(name) && told.contains("PNG") && told.contains("ends in .png"),
            "{told}"
        );
    }
}

/// A picture of a valve before and after a ring can be read by any reader, has ink where the valve is and none in its corners, and
/// comes out the same twice.
#[test]
fn a_picture_shows_the_valve() {
    let closure = closure_of("physio-like:30");
    let frame = valve_frame(
        &closure.before.model,
        &closure.before.equilibrium.state.positions_mm,
    )
    .unwrap();
    let geometries = [&closure.before, closure.after.as_ref().unwrap()].map(geometry);
    let shown = |certified: bool| {
        geometries.each_ref().map(|geometry| Shown {
            name: "healthy",
            certified,
            geometry,
        })
    };
    let bytes = picture_png(&frame, &shown(true), Quantity::Gap).unwrap();
    assert_eq!(bytes, picture_png(&frame, &shown(true), Quantity::Gap).unwrap());
    let mut reader = png::Decoder::new(std::io::Cursor::new(&bytes))
        .read_info()
        .unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    assert_eq!([info.width, info.height], [960, 2 * (400 + 28) + 80]);
    let is_ink = |x: usize, y: usize| pixels[3 * (y * 960 + x)..][..3] != [255; 3];
    // The middles of the four views lie on leaflets; the valve reaches nowhere near a view's corner.
    for [x, y] in [[240, 228], [720, 228], [240, 656], [720, 656]] {
        assert!(is_ink(x, y), "nothing at {x}, {y}");
    }
    assert!(!is_ink(470, 35) && !is_ink(5, 420));
    let ink = (0..428 * 960).filter(|at| is_ink(at % 960, at / 960)).count();
    assert!(ink > 428 * 960 / 10, "{ink} pixels");
    // Below both views it is said that middle surfaces are drawn, in a line of its own that ends within the picture.
    let end = 8 + LETTER_WIDTH * MIDDLE_SURFACES.chars().count();
    assert!(end <= 960 && MIDDLE_SURFACES.is_ascii());
    let line = 2 * (400 + 28) + 6 + 33;
    let written = |from: usize, to: usize| (from..to).any(|x| (line..line + 16).any(|y| is_ink(x, y)));
    assert!(
        written(8, 40) && written(end - 40, end) && !written(end, 960),
        "{end}"
    );
    // What is not certified is seen to be so.
    let is_red = |bytes: &[u8]| {
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
            .read_info()
            .unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        pixels
            .as_chunks::<3>()
            .0
            .iter()
            .any(|&[red, green, blue]| red > 150 && green < 60 && blue < 60)
    };
    assert!(!is_red(&bytes));
    assert!(is_red(
        &picture_png(&frame, &shown(false), Quantity::Gap).unwrap()
    ));
    for quantity in [Quantity::Strain, Quantity::Displacement, Quantity::Leaflet] {
        assert_ne!(bytes, picture_png(&frame, &shown(true), quantity).unwrap());
    }
}

//! Rings of other proportions, by single sutures, and flexible ones.

use coapt::mesh::parametric::Preset;
use coapt::repair::parse_ring_spec;
use coapt::scene::{Attachment, Repair, Ring};

use super::{Closed, closed, done, preset};

fn ring() -> Ring {
    parse_ring_spec("physio-like:34").expect("a ring")
}

fn ringed(name: &str, ring: Ring) -> Closed {
    let model = preset(Preset::Dilated);
    closed(name, &done(&model, &Repair::Ring(ring)).model)
}

/// The shorter a ring from front to back, the more the leaflets meet; the annulus is as deep as the ring, to what its chords cut
/// off.
#[test]
fn a_shallower_ring_gives_more_coaptation() {
    let of = |ap_mm: f64| {
        let ring = Ring {
            ap_mm: Some(ap_mm),
            ..ring()
        };
        ringed(&format!("dilated, ring of {ap_mm} mm"), ring).measures
    };
    let [shallow, usual, deep] = [22.0, 25.5, 30.0].map(of);
    let area = |m: &coapt::measure::Measures| m.coaptation.area_mm2;
    assert!(area(&shallow) > area(&usual) && area(&usual) > area(&deep));
    for (measures, ap_mm) in [(&shallow, 22.0), (&deep, 30.0)] {
        assert!(
            (measures.annulus.ap_mm - ap_mm).abs() < 1.0,
            "{}",
            measures.annulus.ap_mm
        );
    }
    let plain = ringed("dilated, ring", ring()).measures;
    // The family has three quarters of its size: the same ring.
    assert_eq!(plain.coaptation, usual.coaptation);
}

/// The higher the saddle of the ring, the higher that of the annulus.
#[test]
fn a_ring_with_a_saddle_gives_the_annulus_one() {
    let of = |height_mm: f64| {
        let ring = Ring {
            saddle_height_mm: Some(height_mm),
            ..ring()
        };
        ringed(&format!("dilated, saddle of {height_mm} mm"), ring)
            .measures
            .annulus
            .height_mm
    };
    let [flat, high] = [0.0, 8.0].map(of);
    // Across the best-fit plane a saddle is lower than its horn stands above the widest line: 0.2 to 0.262 in the saddle family.
    assert!(flat < 0.1 && high > 5.0 && high < 8.0, "{flat} {high}");
}

/// Twelve sutures do nearly what a ring does that holds the annulus everywhere: the dilated annulus is smooth between them.
#[test]
fn twelve_sutures_hold_a_smooth_annulus_as_a_frame_does() {
    let sewn = Ring {
        attachment: Attachment::Sutures,
        ..ring()
    };
    let [frame, sewn] = [("dilated, frame", ring()), ("dilated, 12 sutures", sewn)]
        .map(|(name, ring)| ringed(name, ring).measures);
    let ratio = sewn.coaptation.area_mm2 / frame.coaptation.area_mm2;
    assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
    assert!((sewn.annulus.circumference_mm - frame.annulus.circumference_mm).abs() < 1.0);
}

/// A flexible ring makes the annulus as short as a frame of that size does, and leaves it the shape it had: heights over widths
/// are what they were.
#[test]
fn a_flexible_ring_keeps_the_shape_of_the_annulus() {
    let before = closed("dilated", &preset(Preset::Dilated)).measures;
    let flexible = Ring {
        flexible: true,
        ..ring()
    };
    let after = ringed("dilated, flexible ring", flexible).measures;
    let frame = ringed("dilated, frame", ring()).measures;
    let around = |m: &coapt::measure::Measures| m.annulus.circumference_mm;
    // A frame's annulus cuts the corners of its ring.
    assert!(
        (around(&after) - around(&frame)).abs() < 0.01 * around(&frame),
        "{} {}",
        around(&after),
        around(&frame)
    );
    let shape = |m: &coapt::measure::Measures| {
        [m.annulus.ap_mm, m.annulus.height_mm].map(|x| x / m.annulus.commissural_mm)
    };
    for (old, new) in shape(&before).into_iter().zip(shape(&after)) {
        assert!((old - new).abs() < 1e-6, "{old} {new}");
    }
    assert!(after.coaptation.area_mm2 > 2.0 * before.coaptation.area_mm2);
}

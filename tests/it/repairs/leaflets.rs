//! Leaflets cut and sewn.

#![allow(clippy::print_stdout, reason = "figures for who asks for them")]

use coapt::mesh::parametric::Preset;
use coapt::model::Model;
use coapt::repair::{Report, ResectReport};
use coapt::scene::{Augment, Repair, Resect, ResectionShape, Site};
use coapt_tests::assert_balanced;

use super::{assert_told, closed, done, preset, refused};

fn resect(shape: ResectionShape, width_mm: f64) -> Resect {
    Resect {
        site: Some(Site::A2P2),
        width_mm: Some(width_mm),
        cut_chords: true,
        ..Resect::of("posterior", shape)
    }
}

fn resected(model: &Model, deed: Resect) -> (Model, ResectReport) {
    let repaired = done(model, &Repair::Resect(deed));
    match repaired.report {
        Report::Resect(report) => (repaired.model, report),
        report => panic!("{report:?}"),
    }
}

fn unloaded_mm2(model: &Model) -> f64 {
    let area = |face: &[u32; 3]| {
        let [a, b, c] = face.map(|v| model.rest_mm[v as usize]);
        0.5 * (b - a).cross(&(c - a)).norm()
    };
    model.faces.iter().map(area).sum()
}

/// A triangle of the flail segment taken out: what is left moves no more above the line of closure, and the notch, which
/// stitches hold, is no hole.
#[test]
fn a_triangle_out_of_the_flail_segment_lowers_the_orifice() {
    let model = preset(Preset::Flail);
    let before = closed("flail", &model).measures.orifice;
    let (cut, report) = resected(&model, resect(ResectionShape::Triangular, 12.0));
    let after = closed("flail, triangular resection", &cut);
    let orifice = &after.measures.orifice;
    println!("{before:?} {orifice:?} {report:?}");
    assert!(
        orifice.area_mm2 < 0.5 * before.area_mm2,
        "{orifice:?} of {before:?}"
    );
    assert!(orifice.max_gap_mm < before.max_gap_mm);
    assert_balanced("flail, triangular resection", &cut, &after.equilibrium);
}

/// The mid-section of a valve resected at its middle runs along the seam, between its edges: of triangles of 12 mm at 0.49, 0.50 and
/// 0.51 of the margin 98, 144 and 98 mm² were told, of equal volumes; of a quadrangle of 10 mm at 0.5 204, where its volume says
/// some 110. Area over volume is the same beside the seam and along it, to a tenth.
#[test]
fn the_mid_section_does_not_fall_through_a_seam() {
    let model = preset(Preset::Flail);
    for (shape, width_mm, beside) in [
        (ResectionShape::Triangular, 12.0, 0.49),
        (ResectionShape::Quadrangular, 10.0, 0.46),
    ] {
        let [middle, beside] = [0.5, beside].map(|position| {
            let deed = Resect {
                site: None,
                position: Some(position),
                ..resect(shape, width_mm)
            };
            let (cut, _) = resected(&model, deed);
            closed("flail, cut beside the middle", &cut).measures.tenting
        });
        let [along, aside] = [&middle, &beside].map(|tenting| tenting.area_mm2 / tenting.volume_ml);
        println!("{middle:?} {beside:?}");
        assert!(
            (along / aside - 1.0).abs() < 0.1,
            "{shape:?}: {middle:?} {beside:?}"
        );
    }
}

#[test]
fn a_quadrangle_out_of_the_flail_segment_lowers_the_orifice() {
    let model = preset(Preset::Flail);
    let before = closed("flail", &model).measures;
    let (cut, report) = resected(&model, resect(ResectionShape::Quadrangular, 12.0));
    let after = closed("flail, quadrangular resection", &cut);
    let orifice = &after.measures.orifice;
    println!("{:?} {orifice:?} {report:?}", before.orifice);
    assert!(orifice.area_mm2 < 0.5 * before.orifice.area_mm2, "{orifice:?}");
    let circumference = [&before, &after.measures].map(|m| m.annulus.circumference_mm);
    let [long, short] = report.annulus_mm.expect("a plication");
    // Six tenths of about 12 mm, and as the report has it.
    assert!((long - short - 7.2).abs() < 1.0, "{long} {short}");
    assert!(
        (circumference[0] - circumference[1] - (long - short)).abs() < 0.1,
        "{circumference:?}"
    );
    assert_balanced("flail, quadrangular resection", &cut, &after.equilibrium);
}

/// What is missing has the area that is reported, but for vertices that were moved onto the cut over a curved leaflet: one per
/// cent of the piece. And that is the area of the shape, flat, to 5 %: the leaflet is curved and its margin scalloped.
#[test]
fn the_piece_has_the_area_of_its_shape() {
    for faces in [650, 2600] {
        let model = coapt_tests::preset_model(Preset::Flail, faces, 0.0, 0);
        for width_mm in [8.0, 12.0, 15.0] {
            let (cut, report) = resected(&model, resect(ResectionShape::Triangular, width_mm));
            let missing = unloaded_mm2(&model) - unloaded_mm2(&cut);
            let shape = 0.5 * width_mm * report.height_mm;
            println!("{faces} {width_mm}: {missing} {} {shape}", report.area_mm2);
            assert!(
                (missing - report.area_mm2).abs() < 0.01 * report.area_mm2,
                "{missing} {report:?}"
            );
            assert!((report.area_mm2 / shape - 1.0).abs() < 0.05, "{report:?} {shape}");
            let (cut, report) = resected(&model, resect(ResectionShape::Quadrangular, width_mm));
            let missing = unloaded_mm2(&model) - unloaded_mm2(&cut);
            let shape = width_mm * report.height_mm;
            let [long, short] = report.annulus_mm.expect("a plication");
            // Of the width under the piece six tenths are gathered, but for corners that the annulus' chords cut off.
            let off_mm = if faces == 650 { 0.6 } else { 0.2 };
            assert!(
                (long - short - 0.6 * width_mm).abs() < off_mm,
                "{faces} {width_mm}: {long} {short}"
            );
            println!("{faces} {width_mm}: {missing} {} {shape}", report.area_mm2);
            assert!(
                (missing - report.area_mm2).abs() < 0.01 * report.area_mm2,
                "{missing} {report:?}"
            );
            assert!((report.area_mm2 / shape - 1.0).abs() < 0.05, "{report:?} {shape}");
        }
    }
}

/// A stretched leaf gives way to no force but pressure's: in every preset that a resection is for the closed valve is certified and in
/// balance, on the anterior leaflet too.
#[test]
fn resected_valves_close_and_balance() {
    for (preset_of, leaflet) in [
        (Preset::Barlow, "posterior"),
        (Preset::Barlow, "anterior"),
        (Preset::Healthy, "posterior"),
    ] {
        let model = preset(preset_of);
        let deed = Resect {
            leaflet: leaflet.into(),
            ..resect(ResectionShape::Triangular, 10.0)
        };
        let (cut, _) = resected(&model, deed);
        let name = format!("{}, {leaflet} resection", preset_of.name());
        assert_balanced(&name, &cut, &closed(&name, &cut).equilibrium);
    }
}

/// No needles: the least angle of the cut mesh is not far below that of the mesh it was cut from.
#[test]
fn a_cut_leaves_no_slivers() {
    let least_deg = |model: &Model| {
        let angle = |a: u32, b: u32, c: u32| {
            let [a, b, c] = [a, b, c].map(|v| model.rest_mm[v as usize]);
            (b - a).angle(&(c - a)).to_degrees()
        };
        let angles = model
            .faces
            .iter()
            .flat_map(|&[a, b, c]| [angle(a, b, c), angle(b, c, a), angle(c, a, b)]);
        angles.fold(180.0, f64::min)
    };
    let model = preset(Preset::Flail);
    for width_mm in [8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0] {
        for shape in [ResectionShape::Triangular, ResectionShape::Quadrangular] {
            let (cut, _) = resected(&model, resect(shape, width_mm));
            let least = least_deg(&cut);
            println!("{shape:?} {width_mm}: {least} {}", least_deg(&model));
            assert!(least > 4.0, "{shape:?} {width_mm} mm: {least} degrees");
        }
    }
}

/// Nobody cuts out half of a margin: it can be done, and is doubted.
#[test]
fn a_resection_far_wider_than_usual_is_doubted() {
    let model = preset(Preset::Flail);
    for (width_mm, expected) in [(22.0, None), (23.0, Some("is 23 mm, expected about 8 to 15"))] {
        let cut = done(
            &model,
            &Repair::Resect(resect(ResectionShape::Triangular, width_mm)),
        );
        let told = cut.warnings.first().map(|fault| fault.message.as_str());
        assert_eq!(told.is_some(), expected.is_some(), "{told:?}");
        assert!(
            told.unwrap_or_default().starts_with(expected.unwrap_or_default()),
            "{told:?}"
        );
    }
}

#[test]
fn resections_that_cannot_be_are_refused() {
    let model = preset(Preset::Healthy);
    let told = |deed: Resect, place: &str, words: &str| {
        assert_told(&refused(&model, &Repair::Resect(deed)), place, words);
    };
    let good = resect(ResectionShape::Triangular, 10.0);
    let strict = Resect {
        cut_chords: false,
        ..good.clone()
    };
    told(strict, "resect.cut_chords", "chordae insert in the piece: of `");
    let no_site = Resect {
        site: None,
        ..good.clone()
    };
    told(no_site, "resect.site", "is missing; expected A1P1");
    let septal = Resect {
        leaflet: "septal".into(),
        ..good.clone()
    };
    told(septal, "resect.leaflet", "none of `anterior`, `posterior`");
    for width_mm in [0.0, f64::NAN, -3.0] {
        let wrong = Resect {
            width_mm: Some(width_mm),
            ..good.clone()
        };
        told(wrong, "resect.width_mm", "expected above 0");
    }
    let wide = Resect {
        width_mm: Some(300.0),
        ..good.clone()
    };
    told(wide, "resect.width_mm", "mm long; expected less");
    let aside = Resect {
        site: None,
        position: Some(0.03),
        ..good.clone()
    };
    told(aside, "resect.width_mm", "mm beyond the anterolateral commissure");
    let high = Resect {
        height_fraction: Some(0.99),
        ..good.clone()
    };
    told(high, "resect.height_fraction", "which leaves 1 mm of the");
    let strip = Resect {
        strip_mm: Some(2.0),
        ..good.clone()
    };
    told(strip, "resect.strip_mm", "but the piece is triangular");
    let low = Resect {
        strip_mm: Some(40.0),
        ..resect(ResectionShape::Quadrangular, 10.0)
    };
    told(low, "resect.strip_mm", "is 40 mm, expected 1 to");
    let fraction = Resect {
        height_fraction: Some(0.5),
        ..resect(ResectionShape::Quadrangular, 10.0)
    };
    told(
        fraction,
        "resect.height_fraction",
        "but the piece is quadrangular",
    );
    let anterior = Resect {
        leaflet: "anterior".into(),
        ..resect(ResectionShape::Quadrangular, 10.0)
    };
    told(anterior, "resect.shape", "whose annulus is fibrous");
}

fn augment(width_mm: f64, length_mm: f64) -> Repair {
    Repair::Augment(Augment {
        site: Some(Site::A2P2),
        width_mm,
        length_mm,
        ..Augment::of("posterior")
    })
}

/// A higher posterior leaflet meets the anterior one over more: in the dilated valve, whose muscles hold it back, at least
/// thrice, and nothing stays open; in the restricted one at least four times.
#[test]
fn a_patch_gives_coaptation() {
    for (preset_of, more) in [(Preset::Dilated, 3.0), (Preset::Restricted, 4.0)] {
        let model = preset(preset_of);
        let before = closed(preset_of.name(), &model).measures;
        let patched = done(&model, &augment(12.0, 30.0)).model;
        let name = format!("{}, patch", preset_of.name());
        let after = closed(&name, &patched);
        let area = |m: &coapt::measure::Measures| m.coaptation.area_mm2;
        assert!(
            area(&after.measures) > more * area(&before),
            "{} {}",
            area(&before),
            area(&after.measures)
        );
        assert_balanced(&name, &patched, &after.equilibrium);
        if preset_of == Preset::Dilated {
            assert!(after.measures.orifice.area_mm2 < 0.2 * before.orifice.area_mm2);
        }
    }
}

/// The leaflet is larger by the patch, to the tenth that what lies beyond is sheared; half of width times length is the patch, for it
/// fades to its ends, to 30 % as the leaflet is wider or narrower above its margin. Chordae keep their lengths, the other
/// leaflet its area, and all is as in a valve without where the patch is not.
#[test]
fn a_patch_adds_its_area_and_nothing_else() {
    for faces in [650, 2600] {
        let model = coapt_tests::preset_model(Preset::Dilated, faces, 0.0, 0);
        let repaired = done(&model, &augment(10.0, 30.0));
        let Report::Augment(report) = &repaired.report else {
            panic!("{:?}", repaired.report)
        };
        let gained = unloaded_mm2(&repaired.model) - unloaded_mm2(&model);
        assert!(
            (gained / report.area_mm2 - 1.0).abs() < 0.1,
            "{gained} {report:?}"
        );
        assert!((report.area_mm2 / 150.0 - 1.0).abs() < 0.3, "{report:?}");
        let (chords, old) = (&repaired.model.chords, &model.chords);
        assert_eq!(
            (&chords.ends, &chords.rest_length_mm),
            (&old.ends, &old.rest_length_mm)
        );
        let places = |model: &Model| {
            model
                .annulus
                .iter()
                .map(|&v| model.rest_mm[v as usize])
                .collect::<Vec<_>>()
        };
        assert_eq!(places(&repaired.model), places(&model));
    }
}

/// A patch wider than the leaflet is high there is doubted, with both figures; one that is not is not.
#[test]
fn a_patch_larger_than_the_leaflet_is_doubted() {
    let model = preset(Preset::Dilated);
    let mut seen = [false; 2];
    for width_mm in [8.0, 10.0, 16.0, 20.0] {
        let repaired = done(&model, &augment(width_mm, 30.0));
        let Report::Augment(report) = &repaired.report else {
            panic!("{:?}", repaired.report)
        };
        let is_larger = width_mm > report.leaflet_height_mm;
        seen[usize::from(is_larger)] = true;
        let told: Vec<String> = repaired
            .warnings
            .iter()
            .map(|fault| format!("{} {}", fault.place, fault.message))
            .collect();
        let start = format!(
            "augment.width_mm is {width_mm} mm, more than the {:.1} mm",
            report.leaflet_height_mm
        );
        assert_eq!(told.len(), usize::from(is_larger), "{width_mm}: {told:?}");
        assert!(told.iter().all(|told| told.starts_with(&start)), "{told:?}");
    }
    assert_eq!(seen, [true; 2]);
}

#[test]
fn patches_that_cannot_be_are_refused() {
    let model = preset(Preset::Dilated);
    let told = |deed: Augment, place: &str, words: &str| {
        assert_told(&refused(&model, &Repair::Augment(deed)), place, words);
    };
    let good = Augment {
        site: Some(Site::A2P2),
        ..Augment::of("posterior")
    };
    told(
        Augment::of("posterior"),
        "augment.site",
        "is missing; expected A1P1",
    );
    let wide = Augment {
        width_mm: 40.0,
        ..good.clone()
    };
    told(
        wide,
        "augment.width_mm",
        "is 40 mm, expected above 0 and at most 30",
    );
    let long = Augment {
        length_mm: 90.0,
        ..good.clone()
    };
    told(
        long,
        "augment.length_mm",
        "mm about the position between the commissures",
    );
    let none = Augment {
        length_mm: f64::NAN,
        ..good.clone()
    };
    told(none, "augment.length_mm", "expected above 0");
    let high = Augment {
        fraction: Some(0.95),
        ..good.clone()
    };
    told(high, "augment.fraction", "is 0.95, expected 0.1 to 0.9");
    let anterior = Augment {
        leaflet: "anterior".into(),
        length_mm: 25.0,
        ..good
    };
    told(anterior, "augment.leaflet", "leans so far inward");
}

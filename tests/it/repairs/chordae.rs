//! Chordae strung, cut, moved and torn, and papillary muscles drawn elsewhere.

use coapt::Vec3;
use coapt::mesh::parametric::Preset;
use coapt::model::ChordKind;
use coapt::repair::{Repaired, Report};
use coapt::scene::{
    AnnulusPlace, ChordPart, CloseCleft, CutChord, Neochord, RelocatePapillary, Repair, Rupture, Segment,
    Site, TransferChord,
};

use super::{assert_told, closed, done, middle_of_the_anterior_margin, preset, refused, repaired};

/// Neochordae to both halves of P2, from the muscle of their own side.
fn two_pairs() -> [Repair; 2] {
    [(0.42, "anterolateral"), (0.58, "posteromedial")].map(|(position, muscle)| {
        Repair::Neochord(Neochord {
            position: Some(position),
            muscle: Some(muscle.into()),
            ..Neochord::to("posterior")
        })
    })
}

/// Two loops, of lengths that nobody gave, take most of the orifice away, and hold P2's margin near the depth that they are
/// for.
#[test]
fn neochordae_mend_the_flail_segment() {
    let model = preset(Preset::Flail);
    let before = closed("flail", &model).measures.orifice.area_mm2;
    let strung = repaired(&model, &two_pairs());
    let after = closed("flail, neochordae", &strung);
    let orifice = after.measures.orifice.area_mm2;
    assert!(orifice < 0.25 * before, "{orifice} of {before} mm2");
    let names: Vec<&str> = after
        .measures
        .chords
        .groups
        .iter()
        .map(|group| &*group.name)
        .collect();
    assert!(names.contains(&"neochord posterior 0.42"), "{names:?}");
    assert!(after.measures.sutures.is_empty());
    let taut = after
        .measures
        .chords
        .groups
        .iter()
        .filter(|group| group.name.starts_with("neochord"));
    assert!(
        taut.clone().count() == 2 && taut.clone().all(|group| group.max_force_n > 0.05),
        "they carry the leaflet"
    );
}

/// The estimate of a neochord's length is for the depth at which the margin is to end. Measured on the closed valve: within
/// 3 mm of it, half a coaptation length; the line of closure is guessed and the leaflet bulges between strands.
#[test]
fn a_neochord_ends_near_the_depth_it_is_for() {
    let model = preset(Preset::Flail);
    let strung = repaired(&model, &two_pairs());
    let after = closed("flail, neochordae", &strung);
    let positions = &after.equilibrium.state.positions_mm;
    let annulus: Vec<Vec3> = strung.annulus.iter().map(|&v| positions[v as usize]).collect();
    let centre = annulus.iter().sum::<Vec3>() / annulus.len() as f64;
    let normal = coapt::mesh::polyline::vector_area(&annulus).normalize();
    let chords = &strung.chords;
    for segment in 0..chords.ends.len() {
        let group = &strung.chord_groups[chords.group[segment] as usize];
        if group.kind == ChordKind::Neochorda {
            let place = chords.point_mm(chords.ends[segment][1], positions);
            let depth = -normal.dot(&(place - centre));
            assert!((depth - 5.0).abs() < 3.0, "{depth:.1} mm below the annulus");
        }
    }
}

/// In the dilated valve tenting is what displaced muscles do: drawn back to the annulus by 5 mm, they let the leaflets up.
#[test]
fn muscles_drawn_to_the_annulus_lower_tenting() {
    let model = preset(Preset::Dilated);
    let before = closed("dilated", &model).measures;
    let draw = |muscle: &str, toward| {
        Repair::RelocatePapillary(RelocatePapillary {
            muscle: muscle.into(),
            by_mm: None,
            toward: Some(toward),
            distance_mm: Some(5.0),
        })
    };
    let drawn = repaired(
        &model,
        &[
            draw("anterolateral", AnnulusPlace::TrigoneLeft),
            draw("posteromedial", AnnulusPlace::TrigoneRight),
        ],
    );
    let after = closed("dilated, muscles drawn to the trigones", &drawn).measures;
    assert!(
        after.tenting.height_mm < before.tenting.height_mm - 1.0,
        "{} and {} mm",
        after.tenting.height_mm,
        before.tenting.height_mm
    );
    assert!(after.tenting.volume_ml < before.tenting.volume_ml);
    assert!(after.orifice.area_mm2 < before.orifice.area_mm2);
    for (fixed, old) in drawn.prescribed.iter().zip(&model.prescribed) {
        let is_tip = model
            .papillary
            .iter()
            .any(|muscle| muscle.tips.contains(&fixed.vertex));
        let moved = (fixed.target_mm - old.target_mm).norm();
        assert!((moved - if is_tip { 5.0 } else { 0.0 }).abs() < 1e-9, "{moved}");
    }
    assert_eq!(drawn.rest_mm, model.rest_mm);
}

/// The presets' leaflets are so large that without P2's chordae they still meet, but over less.
#[test]
fn torn_chordae_cost_coaptation() {
    let model = preset(Preset::Healthy);
    let tear = Rupture {
        groups: vec!["marginal".into(), "intermediate".into()],
        ..Rupture::of(Segment::P2)
    };
    let torn = done(&model, &Repair::Rupture(tear));
    let Report::Rupture(report) = &torn.report else {
        panic!("{:?}", torn.report)
    };
    assert!(report.count >= 4 && report.count == report.of, "{report:?}");
    let before = closed("healthy", &model).measures.coaptation.area_mm2;
    let after = closed("healthy, P2 torn", &torn.model)
        .measures
        .coaptation
        .area_mm2;
    assert!(after < 0.95 * before, "{after} of {before} mm2");
    let half = Rupture {
        fraction: Some(0.5),
        ..Rupture::of(Segment::P2)
    };
    let fewer = done(&model, &Repair::Rupture(half));
    let Report::Rupture(some) = &fewer.report else {
        panic!("{:?}", fewer.report)
    };
    assert!(some.count >= 1 && some.count < some.of, "{some:?}");
}

/// With neochordae of 26.5 and 27 mm the flap folds back by a tenth of a millimetre more or less. Its orifice was 175 and 83 mm², as
/// one rule took over from another.
#[test]
fn the_orifice_of_a_flap_does_not_jump() {
    let model = preset(Preset::Flail);
    let [one, other] = [26.5, 27.0].map(|length_mm| {
        let neochord = Neochord {
            site: Some(Site::A2P2),
            length_mm: Some(length_mm),
            ..Neochord::to("posterior")
        };
        let strung = repaired(&model, &[Repair::Neochord(neochord)]);
        closed("flail, long neochordae", &strung)
            .measures
            .orifice
            .area_mm2
    });
    // 82.7 and 83.1; a twentieth is more than the shapes are apart.
    assert!((one - other).abs() < 0.05 * other, "{one} and {other} mm2");
}

/// Strut chordae tether the anterior leaflet in the dilated valve: without them tenting is no more, and the group is still
/// named, with nothing in it.
#[test]
fn cut_struts_tether_no_more() {
    let model = preset(Preset::Dilated);
    let before = closed("dilated", &model).measures;
    let struts = CutChord {
        group: Some("strut".into()),
        ..CutChord::default()
    };
    let deed = Repair::CutChord(struts);
    let cut = done(&model, &deed);
    assert_told(
        &refused(&cut.model, &deed),
        "cut-chord.group",
        "no chordae any more",
    );
    let Report::CutChord(report) = &cut.report else {
        panic!("{:?}", cut.report)
    };
    // Two struts, each a trunk and three branches.
    assert_eq!((report.count, report.segments), (2, 8));
    let after = closed("dilated, struts cut", &cut.model).measures;
    assert!(
        after.tenting.volume_ml < before.tenting.volume_ml,
        "{} and {} mL",
        after.tenting.volume_ml,
        before.tenting.volume_ml
    );
    let strut = after.chords.groups.iter().find(|group| group.name == "strut");
    assert_eq!(strut.map(|group| group.total_force_n), Some(0.0));
    let branch = CutChord {
        near_mm: Some(middle_of_the_anterior_margin(&model)),
        part: ChordPart::Branch,
        ..CutChord::default()
    };
    let one = done(&model, &Repair::CutChord(branch));
    assert_eq!(one.model.chords.ends.len(), model.chords.ends.len() - 1);
    closed("dilated, one branch cut", &one.model);
}

/// A chord of the anterior margin, set to the middle of P2, carries some of what is torn there.
#[test]
fn a_transferred_chord_holds_the_torn_segment() {
    let model = preset(Preset::Flail);
    let before = closed("flail", &model).measures.orifice.area_mm2;
    let transfer = TransferChord {
        near_mm: middle_of_the_anterior_margin(&model),
        leaflet: Some("posterior".into()),
        site: Some(Site::A2P2),
        ..TransferChord::default()
    };
    let moved = done(&model, &Repair::TransferChord(transfer));
    assert_eq!(moved.model.chords.ends.len(), model.chords.ends.len());
    assert_eq!(moved.model.chords.rest_length_mm, model.chords.rest_length_mm);
    assert_eq!(moved.model.chords.points.len(), model.chords.points.len());
    let after = closed("flail, chord transferred", &moved.model)
        .measures
        .orifice
        .area_mm2;
    assert!(after < before, "{after} of {before} mm2");
    let other = TransferChord {
        near_mm: middle_of_the_anterior_margin(&model),
        muscle: Some("posteromedial".into()),
        tip: Some(1),
        ..TransferChord::default()
    };
    let moved = done(&model, &Repair::TransferChord(other));
    // Other chordae still come from the tip that it left.
    assert_eq!(moved.model.chords.points.len(), model.chords.points.len() + 1);
    closed("flail, chord set to another tip", &moved.model);
}

/// The presets' indentations are shallow: closing one folds the margin, which is told, and the valve still closes.
#[test]
fn an_indentation_is_closed() {
    let model = preset(Preset::Healthy);
    let cleft = CloseCleft {
        position: 0.36,
        depth_mm: 2.0,
    };
    let sewn = done(&model, &Repair::CloseCleft(cleft));
    let after = closed("healthy, indentation closed", &sewn.model);
    let Report::CloseCleft(report) = &sewn.report else {
        panic!("{:?}", sewn.report)
    };
    let chords = &sewn.model.chords;
    let &[a, b] = chords.ends.last().expect("a stitch");
    let positions = &after.equilibrium.state.positions_mm;
    let gap = (chords.point_mm(a, positions) - chords.point_mm(b, positions)).norm();
    assert!(gap < report.sewn.gap_mm + 0.2, "{gap} mm");
}

/// Repairs follow each other in any order that makes sense.
#[test]
fn repairs_are_combined() {
    let model = preset(Preset::Barlow);
    let ring = coapt::repair::parse_ring_spec("physio-like:36").expect("a ring");
    let [one, other] = two_pairs();
    let clip = coapt::scene::Clip {
        site: Some(Site::A1P1),
        ..Default::default()
    };
    let all = [Repair::Ring(ring), one, Repair::Clip(clip), other];
    let mut backwards = all.to_vec();
    backwards.reverse();
    let forth = closed("barlow, four repairs", &repaired(&model, &all)).measures;
    let back = closed("barlow, the same backwards", &repaired(&model, &backwards)).measures;
    // The ring moves only targets, but neochordae are fitted to the annulus that they find: the lengths differ a little.
    assert!((forth.orifice.area_mm2 - back.orifice.area_mm2).abs() < 5.0);
    assert_eq!(
        (forth.sutures.len(), forth.chords.groups.len()),
        (1, back.chords.groups.len())
    );
}

/// A doubtful length is told with those that reach in this valve, which are those that a usual depth would give.
#[test]
fn a_doubted_strand_is_told_what_would_reach() {
    let model = preset(Preset::Flail);
    let to_p2 = |change: fn(&mut Neochord)| {
        let mut neochord = Neochord {
            site: Some(Site::A2P2),
            strands: 1,
            ..Neochord::to("posterior")
        };
        change(&mut neochord);
        done(&model, &Repair::Neochord(neochord))
    };
    let length = |done: &Repaired| match &done.report {
        Report::Neochord(report) => report.length_mm[0],
        other => panic!("{other:?}"),
    };
    let usual = [
        to_p2(|it| it.depth_mm = Some(6.0)),
        to_p2(|it| it.depth_mm = Some(4.0)),
    ];
    let [shortest, longest] = usual.each_ref().map(length);
    assert!(usual.iter().all(|done| done.warnings.is_empty()), "{usual:?}");
    assert!(longest > shortest + 1.0, "{shortest} to {longest}");
    let reaching = format!(
        "; with {shortest:.1} to {longest:.1} mm from this tip the margin ends 4 to 6 mm below the closed annulus"
    );
    for (doubted, key) in [
        (to_p2(|it| it.length_mm = Some(4.0)), "neochord.length_mm"),
        (to_p2(|it| it.length_mm = Some(150.0)), "neochord.length_mm"),
        (to_p2(|it| it.depth_mm = Some(-30.0)), "neochord.depth_mm"),
    ] {
        assert_told(&doubted.warnings, key, &reaching);
        assert_eq!(doubted.warnings.len(), 1);
    }
    // A point of one's own has no share of the line of closure; how far it is from the tip can be told.
    let point = Neochord {
        point_mm: Some(middle_of_the_anterior_margin(&model)),
        length_mm: Some(150.0),
        strands: 1,
        ..Neochord::to("anterior")
    };
    let doubted = done(&model, &Repair::Neochord(point));
    let Report::Neochord(report) = &doubted.report else {
        panic!("{:?}", doubted.report)
    };
    let away = format!(
        "; in the open valve the place is {:.1} mm from this tip",
        report.open_mm[0]
    );
    assert_told(&doubted.warnings, "neochord.length_mm", &away);
}

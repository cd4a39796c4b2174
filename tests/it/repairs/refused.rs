//! Repairs of chordae and muscles that cannot be: each is told with its place, what was found and what was expected.

use coapt::mesh::parametric::Preset;
use coapt::scene::{
    AnnulusPlace, CloseCleft, CutChord, Neochord, RelocatePapillary, Repair, Rupture, Segment, Site,
    TransferChord,
};

use super::{assert_told, middle_of_the_anterior_margin, preset, refused};

#[test]
fn neochordae_to_nowhere_are_refused() {
    let model = preset(Preset::Healthy);
    let told = |neochord: Neochord, place: &str, words: &str| {
        assert_told(&refused(&model, &Repair::Neochord(neochord)), place, words);
    };
    let good = Neochord {
        site: Some(Site::A2P2),
        ..Neochord::to("posterior")
    };
    told(
        Neochord::to("posterior"),
        "neochord.site",
        "is missing; expected A1P1",
    );
    told(
        Neochord {
            leaflet: "septal".into(),
            ..good.clone()
        },
        "neochord.leaflet",
        "none of `anterior`, `posterior`",
    );
    let unknown = Neochord {
        muscle: Some("lateral".into()),
        ..good.clone()
    };
    told(
        unknown,
        "neochord.muscle",
        "is `lateral`, expected one of `anterolateral`, `posteromedial`",
    );
    let tip = Neochord {
        muscle: Some("anterolateral".into()),
        tip: Some(7),
        ..good.clone()
    };
    told(tip, "neochord.tip", "is 7, expected 0 to 2");
    told(
        Neochord {
            tip: Some(0),
            ..good.clone()
        },
        "neochord.tip",
        "there is no `muscle`",
    );
    let edge = Neochord {
        position: Some(0.01),
        ..Neochord::to("posterior")
    };
    told(edge, "neochord.position", "beyond the commissure");
    told(
        Neochord {
            inset_mm: 30.0,
            ..good.clone()
        },
        "neochord.inset_mm",
        "less than the height of the leaflet there",
    );
    let far = Neochord {
        point_mm: Some([0.0, 90.0, 0.0]),
        length_mm: Some(20.0),
        ..Neochord::to("posterior")
    };
    told(
        far,
        "neochord.point_mm",
        "expected a place within 2 mm of the posterior leaflet",
    );
    let point = Neochord {
        point_mm: Some(model.rest_mm[model.margins[0].vertices[0] as usize].into()),
        ..Neochord::to("anterior")
    };
    told(
        Neochord {
            leaflet: "posterior".into(),
            site: Some(Site::A2P2),
            ..point.clone()
        },
        "neochord.point_mm",
        "beside a site",
    );
    told(
        Neochord {
            strands: 0,
            ..good.clone()
        },
        "neochord.strands",
        "is 0, expected 1 to 20",
    );
    let both = Neochord {
        length_mm: Some(20.0),
        depth_mm: Some(5.0),
        ..good.clone()
    };
    told(both, "neochord.depth_mm", "is given beside `length_mm`");
    told(
        Neochord {
            length_mm: Some(-1.0),
            ..good.clone()
        },
        "neochord.length_mm",
        "is -1 mm",
    );
    told(
        Neochord {
            axial_stiffness_n: 0.0,
            ..good
        },
        "neochord.axial_stiffness_n",
        "is 0 N",
    );
    let mut without = model.clone();
    without.papillary.clear();
    let site = Neochord {
        site: Some(Site::A2P2),
        ..Neochord::to("posterior")
    };
    assert_told(
        &refused(&without, &Repair::Neochord(site)),
        "neochord.muscle",
        "no papillary tip",
    );
}

#[test]
fn what_cannot_be_cut_torn_or_moved_is_refused() {
    let model = preset(Preset::Healthy);
    let told = |deed: Repair, place: &str, words: &str| assert_told(&refused(&model, &deed), place, words);
    let cut = CutChord::default();
    told(Repair::CutChord(cut.clone()), "cut-chord.group", "is missing");
    let secondary = CutChord {
        group: Some("secondary".into()),
        ..cut.clone()
    };
    told(
        Repair::CutChord(secondary),
        "cut-chord.group",
        "is `secondary`, expected one of the chord groups `marginal`",
    );
    let far = CutChord {
        near_mm: Some([0.0, 0.0, 60.0]),
        ..cut.clone()
    };
    told(
        Repair::CutChord(far),
        "cut-chord.near_mm",
        "mm from the nearest insertion; expected a place within 10 mm",
    );
    let many = CutChord {
        near_mm: Some(middle_of_the_anterior_margin(&model)),
        count: Some(1000),
        ..cut.clone()
    };
    told(
        Repair::CutChord(many),
        "cut-chord.count",
        "is 1000, expected 1 to",
    );
    let some = CutChord {
        group: Some("strut".into()),
        count: Some(1),
        ..cut
    };
    told(Repair::CutChord(some), "cut-chord.count", "without `near_mm`");
    let transfer = TransferChord {
        near_mm: middle_of_the_anterior_margin(&model),
        ..TransferChord::default()
    };
    told(
        Repair::TransferChord(transfer.clone()),
        "transfer-chord.leaflet",
        "is missing",
    );
    let nowhere = TransferChord {
        near_mm: [f64::NAN, 0.0, 0.0],
        leaflet: Some("posterior".into()),
        ..transfer
    };
    told(
        Repair::TransferChord(nowhere),
        "transfer-chord.near_mm",
        "expected finite numbers",
    );
    let rupture = Rupture {
        groups: vec!["marginal".into(), "primary".into()],
        ..Rupture::of(Segment::P2)
    };
    told(Repair::Rupture(rupture), "rupture.groups[1]", "is `primary`");
    let none = Rupture {
        groups: vec!["strut".into()],
        ..Rupture::of(Segment::P2)
    };
    told(Repair::Rupture(none), "rupture.region", "is P2, where no chord");
    let part = Rupture {
        fraction: Some(1.5),
        ..Rupture::of(Segment::A2)
    };
    told(
        Repair::Rupture(part),
        "rupture.fraction",
        "is 1.5, expected above 0 and at most 1",
    );
    let muscle = RelocatePapillary {
        muscle: "anterolateral".into(),
        by_mm: None,
        toward: Some(AnnulusPlace::MidPosterior),
        distance_mm: Some(99.0),
    };
    told(
        Repair::RelocatePapillary(muscle.clone()),
        "relocate-papillary.distance_mm",
        "less than the way there",
    );
    let unknown = RelocatePapillary {
        muscle: "septal".into(),
        ..muscle.clone()
    };
    told(
        Repair::RelocatePapillary(unknown),
        "relocate-papillary.muscle",
        "is `septal`, expected one of",
    );
    let neither = RelocatePapillary {
        toward: None,
        distance_mm: None,
        ..muscle
    };
    told(
        Repair::RelocatePapillary(neither),
        "relocate-papillary.by_mm",
        "is missing; expected a vector",
    );
    let beyond = CloseCleft {
        position: 0.0,
        depth_mm: 9.0,
    };
    told(
        Repair::CloseCleft(beyond),
        "close-cleft.position",
        "mm from a commissure",
    );
}

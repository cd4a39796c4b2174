//! Clips and stitches.

use coapt::mesh::parametric::Preset;
use coapt::model::ChordKind;
use coapt::repair::site::on_both_leaflets;
use coapt::scene::{Alfieri, Clip, ClipModel, ClipSize, Repair, Site};
use rayon::prelude::*;

use super::{assert_told, closed, done, preset, refused, repaired};

fn at(site: Site) -> Clip {
    Clip {
        site: Some(site),
        ..Clip::default()
    }
}

/// The flail segment is P2: a clip there mends it, one on either side does next to nothing.
#[test]
fn a_clip_at_the_lesion_closes_what_one_beside_it_does_not() {
    let model = preset(Preset::Flail);
    let before = closed("flail", &model).measures.orifice.area_mm2;
    for clip_model in [ClipModel::Springs, ClipModel::Rigid] {
        let orifice = |site| {
            let clip = Clip {
                model: clip_model,
                ..at(site)
            };
            let clipped = repaired(&model, &[Repair::Clip(clip)]);
            closed(&format!("flail, clip {clip_model:?} at {site:?}"), &clipped)
                .measures
                .orifice
                .area_mm2
        };
        let here = orifice(Site::A2P2);
        assert!(here < 0.1 * before, "{here} of {before} mm2");
        for beside in [Site::A1P1, Site::A3P3] {
            let left = orifice(beside);
            assert!(left > 0.5 * before, "{beside:?} leaves {left} of {before} mm2");
        }
    }
}

/// Every size, at the middle and beside it, in every preset: certified, the grip held together and nothing through anything.
/// What is gripped lies between the distance at which contact is rigid and one that a tie gives under its force.
#[test]
fn every_clip_holds_in_every_valve() {
    for kind in Preset::ALL {
        let model = preset(kind);
        for (size, position) in [
            (ClipSize::Short, 0.5),
            (ClipSize::LongWide, 0.5),
            (ClipSize::ShortWide, 0.3),
            (ClipSize::Long, 0.7),
        ] {
            let clip = Clip {
                position: Some(position),
                size,
                model: ClipModel::Rigid,
                ..Clip::default()
            };
            let clipped = repaired(&model, &[Repair::Clip(clip)]);
            let name = format!("{}, {size:?} at {position}", kind.name());
            let after = closed(&name, &clipped);
            // Without strict steps in circles, one of these took 575.
            let iterations = after.equilibrium.history.len();
            assert!(iterations < 200, "{name}: {iterations}");
            let chords = &clipped.chords;
            let positions = &after.equilibrium.state.positions_mm;
            for segment in 0..chords.ends.len() {
                let group = &clipped.chord_groups[chords.group[segment] as usize];
                if group.kind != ChordKind::Suture {
                    continue;
                }
                let [a, b] = chords.ends[segment].map(|point| chords.point_mm(point, positions));
                let stretch = (b - a).norm() - chords.rest_length_mm[segment];
                // 50 N/mm under up to 40 N, in the stiff restricted valve, whose leaflets hardly reach each other.
                assert!(
                    stretch < 0.8,
                    "{name}: a tie is {stretch:.2} mm longer than it should be"
                );
            }
        }
    }
}

/// Both models, four sizes, three sites, five presets. One of the 120 comes to rest by the last resort alone: rigid, short and wide, at
/// A2-P2 of the dilated valve.
#[test]
fn every_clip_is_certified_in_every_valve() {
    let sizes = [
        ClipSize::Short,
        ClipSize::ShortWide,
        ClipSize::Long,
        ClipSize::LongWide,
    ];
    let mut clips = Vec::new();
    for kind in Preset::ALL {
        for size in sizes {
            for site in [Site::A1P1, Site::A2P2, Site::A3P3] {
                clips.extend([ClipModel::Springs, ClipModel::Rigid].map(|model| (kind, size, site, model)));
            }
        }
    }
    let uncertified = |&(kind, size, site, model): &(Preset, ClipSize, Site, ClipModel)| {
        let clip = Clip {
            size,
            model,
            ..at(site)
        };
        let closed = coapt_tests::close(&repaired(&preset(kind), &[Repair::Clip(clip)]));
        let is_certified = closed.certificate.is_certified(closed.status);
        (!is_certified).then(|| format!("{kind:?} {size:?} {site:?} {model:?}: {:?}", closed.status))
    };
    let wrong: Vec<String> = clips.par_iter().filter_map(uncertified).collect();
    assert_eq!((clips.len(), wrong), (120, Vec::new()));
}

/// What a clip costs the solver: no more than half again the iterations, and 30 for its settling.
#[test]
fn a_clip_does_not_slow_the_closure_down() {
    for kind in Preset::ALL {
        let model = preset(kind);
        let without = closed(kind.name(), &model).equilibrium.history.len();
        let clipped = repaired(&model, &[Repair::Clip(at(Site::A2P2))]);
        let with = closed(&format!("{}, clipped", kind.name()), &clipped)
            .equilibrium
            .history
            .len();
        assert!(
            with <= without + without / 2 + 30,
            "{}: {with} instead of {without}",
            kind.name()
        );
    }
}

/// A finer mesh is clipped by the same ties and closes as well. Forces are not compared: on 650 faces a clip carries half as
/// much again as on 2600 or 10,400, since a coarse leaflet bends to its grip less easily.
#[test]
fn a_finer_mesh_is_clipped_by_the_same_ties() {
    let clipped = |faces| {
        let model = coapt_tests::preset_model(Preset::Flail, faces, 0.0, 0);
        let before = closed(&format!("flail of {faces} faces"), &model)
            .measures
            .orifice
            .area_mm2;
        let done = done(&model, &Repair::Clip(at(Site::A2P2)));
        let ties = done.model.chords.ends.len() - model.chords.ends.len();
        let after = closed(&format!("flail of {faces} faces, clipped"), &done.model);
        assert!(after.measures.orifice.area_mm2 < 0.1 * before, "{faces} faces");
        ties
    };
    assert_eq!(clipped(650), clipped(2600));
}

/// Ties are no chordae: the measures of chordae name the same groups as before, and the clip has its own.
#[test]
fn a_clip_is_measured_apart_and_the_rest_of_the_model_stays() {
    let model = preset(Preset::Flail);
    let clipped = repaired(&model, &[Repair::Clip(at(Site::A2P2))]);
    let before = model.chords.ends.len();
    assert_eq!(clipped.chords.ends[..before], model.chords.ends);
    assert_eq!(
        clipped.chords.rest_length_mm[..before],
        model.chords.rest_length_mm
    );
    assert_eq!(
        (&clipped.rest_mm, &clipped.prescribed, &clipped.springs),
        (&model.rest_mm, &model.prescribed, &model.springs)
    );
    let measures = closed("flail, clipped", &clipped).measures;
    let names: Vec<&str> = measures.chords.groups.iter().map(|group| &*group.name).collect();
    let old: Vec<&str> = model.chord_groups.iter().map(|group| &*group.name).collect();
    assert_eq!(names, old);
    assert_eq!(measures.sutures[0].name, "clip A2P2");
    // It carries something, and less than the 40 N that the pressure exerts on all of the valve.
    assert!(
        (0.5..40.0).contains(&measures.sutures[0].total_force_n),
        "{:?}",
        measures.sutures
    );
}

/// Either clip stands at a border of the flail segment.
#[test]
fn two_clips_leave_less_than_one() {
    let model = preset(Preset::Flail);
    let clip = |position| {
        Repair::Clip(Clip {
            position: Some(position),
            ..Clip::default()
        })
    };
    let one = closed("flail, one clip", &repaired(&model, &[clip(0.36)]));
    let two = closed("flail, two clips", &repaired(&model, &[clip(0.36), clip(0.64)]));
    let [one, two] = [one, two].map(|closed| closed.measures);
    assert!(
        two.orifice.area_mm2 < one.orifice.area_mm2,
        "{} and {} mm2",
        one.orifice.area_mm2,
        two.orifice.area_mm2
    );
    assert_eq!(two.sutures.len(), 2);
}

/// Six places along the line of closure, as the six of paper 004: each gives a clip of its own.
#[test]
fn six_sites_are_six_clips() {
    let model = preset(Preset::Healthy);
    let ends: Vec<_> = (0..6)
        .map(|i| {
            let clip = Clip {
                position: Some(0.15 + 0.14 * f64::from(i)),
                ..Clip::default()
            };
            let clipped = repaired(&model, &[Repair::Clip(clip)]);
            clipped.chords.points[model.chords.points.len()..].to_vec()
        })
        .collect();
    for i in 0..6 {
        for j in 0..i {
            assert_ne!(ends[i], ends[j]);
        }
    }
}

#[test]
fn stitches_close_what_is_open_in_the_middle() {
    for kind in [Preset::Flail, Preset::Dilated] {
        let model = preset(kind);
        let before = closed(kind.name(), &model).measures.orifice.area_mm2;
        let stitched = Alfieri {
            site: Some(Site::A2P2),
            ..Alfieri::default()
        };
        let sewn = repaired(&model, &[Repair::Alfieri(stitched)]);
        let after = closed(&format!("{}, Alfieri", kind.name()), &sewn)
            .measures
            .orifice
            .area_mm2;
        assert!(after < 0.5 * before, "{after} of {before} mm2");
    }
}

#[test]
fn clips_that_cannot_be_are_refused() {
    let model = preset(Preset::Healthy);
    let told = |clip: Clip, place: &str, words: &str| {
        assert_told(&refused(&model, &Repair::Clip(clip)), place, words)
    };
    told(Clip::default(), "clip.site", "is missing; expected A1P1");
    let long = Clip {
        size: ClipSize::Long,
        grasp_posterior_mm: Some(12.0),
        position: Some(0.12),
        ..Clip::default()
    };
    told(long, "clip.grasp_posterior_mm", "the posterior leaflet is only");
    let deep = Clip {
        grasp_anterior_mm: Some(10.0),
        ..at(Site::A2P2)
    };
    told(
        deep,
        "clip.grasp_anterior_mm",
        "is 10 mm, expected above 0 and at most the arm's length, 9 mm",
    );
    let outside = Clip {
        position: Some(0.02),
        ..Clip::default()
    };
    told(
        outside,
        "clip.position",
        "beyond the anterolateral commissure; expected a position from 0.0",
    );
    let last = Clip {
        position: Some(1.0),
        ..Clip::default()
    };
    told(last, "clip.position", "beyond the posteromedial commissure");
    let flat = Clip {
        angle_deg: 60.0,
        ..at(Site::A2P2)
    };
    told(flat, "clip.angle_deg", "is 60, expected -45 to 45");
    let soft = Clip {
        stiffness_n_per_mm: Some(f64::NAN),
        ..at(Site::A2P2)
    };
    told(soft, "clip.stiffness_n_per_mm", "is NaN N/mm");
    let clipped = repaired(&model, &[Repair::Clip(at(Site::A2P2))]);
    let beside = Clip {
        position: Some(0.55),
        ..Clip::default()
    };
    assert_told(
        &refused(&clipped, &Repair::Clip(beside)),
        "clip.position",
        "where the earlier `clip A2P2` holds",
    );
    let seam = Alfieri {
        site: Some(Site::A2P2),
        ..Alfieri::default()
    };
    assert_told(
        &refused(&clipped, &Repair::Alfieri(seam)),
        "alfieri.site",
        "where the earlier `clip A2P2` holds",
    );
    let apart = Clip {
        position: Some(0.75),
        ..Clip::default()
    };
    done(&clipped, &Repair::Clip(apart));
}

/// Who reads the refusal learns which of the two is how wide, and a clip as far off as it asks is taken.
#[test]
fn an_overlap_tells_how_far_apart_middles_must_be() {
    let model = preset(Preset::Healthy);
    let clipped = repaired(&model, &[Repair::Clip(at(Site::A2P2))]);
    let clip_at = |position: f64| {
        Repair::Clip(Clip {
            position: Some(position),
            ..Clip::default()
        })
    };
    let seam = Alfieri {
        position: Some(0.55),
        length_mm: 7.0,
        ..Alfieri::default()
    };
    for (deed, place, what, width_mm) in [
        (clip_at(0.55), "clip.position", "the clip", 4.0),
        (Repair::Alfieri(seam), "alfieri.position", "the seam", 7.0),
    ] {
        let told = refused(&clipped, &deed);
        assert_told(
            &told,
            place,
            &format!("{what} would take {width_mm:.1} mm of the "),
        );
        let words = &told[0].message;
        let number = |before: &str, after: &str| -> f64 {
            let from = words.split(before).nth(1).unwrap_or_else(|| panic!("{words}"));
            from.split(after).next().unwrap().parse().unwrap()
        };
        let held_mm = number("`clip A2P2` holds ", " mm, from ");
        let apart_mm = number("their middles are ", " mm apart along it");
        let least_mm = number("expected ", " mm at least");
        // Four millimetres wide, and as its arms reach in where the margin bends, it holds up to half as much again. Words have tenths.
        assert!((3.9..6.5).contains(&held_mm), "{words}");
        assert!(
            (least_mm - 0.5 * (width_mm + held_mm)).abs() < 0.16 && apart_mm < least_mm,
            "{words}"
        );
        let site = on_both_leaflets(&model, Some(Site::A2P2), None, "test").unwrap();
        let margin = site.margins.iter().find(|margin| {
            words.contains(&format!(
                "the {} margin",
                model.leaflets[margin.leaflet as usize].name
            ))
        });
        let margin_mm = margin.unwrap().length_mm();
        // The earlier clip's middle is within a tenth of its site.
        assert!((apart_mm - 0.05 * margin_mm).abs() < 0.2, "{words}");
        if what == "the clip" {
            done(&clipped, &clip_at(0.55 + (least_mm - apart_mm) / margin_mm));
            let nearer = clip_at(0.55 + (least_mm - apart_mm - 0.3) / margin_mm);
            assert_told(&refused(&clipped, &nearer), place, "would take");
        }
    }
}

#[test]
fn seams_that_cannot_be_are_refused() {
    let model = preset(Preset::Healthy);
    let told = |seam: Alfieri, place: &str, words: &str| {
        assert_told(&refused(&model, &Repair::Alfieri(seam)), place, words);
    };
    let middle = Alfieri {
        site: Some(Site::A2P2),
        ..Alfieri::default()
    };
    told(
        Alfieri {
            length_mm: -1.0,
            ..middle
        },
        "alfieri.length_mm",
        "is -1 mm, expected above 0",
    );
    told(
        Alfieri {
            length_mm: 50.0,
            ..middle
        },
        "alfieri.site",
        "expected a shorter one",
    );
    told(
        Alfieri {
            bite_mm: 20.0,
            ..middle
        },
        "alfieri.bite_mm",
        "the posterior leaflet is only",
    );
    let both = Alfieri {
        position: Some(0.5),
        ..middle
    };
    told(both, "alfieri.position", "is given beside `site`");
}

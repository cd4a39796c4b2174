//! Plans: every kind of repair is read, and what is wrong in one is told at its line.

use std::path::Path;

use coapt::scene::{ClipModel, ClipSize, Plan, Repair, ResectionShape, Segment, Site};

use super::*;

const ALL: &str = r#"schema_version = 1

[[repair]]
kind = "clip"
site = "A2P2"
size = "long-wide"
model = "rigid"
angle_deg = 10

[[repair]]
kind = "alfieri"
position = 0.25
length_mm = 6

[[repair]]
kind = "neochord"
leaflet = "posterior"
site = "A2P2"
muscle = "anterolateral"
tip = 0
depth_mm = 4.5

[[repair]]
kind = "cut-chord"
group = "strut"

[[repair]]
kind = "transfer-chord"
near_mm = [0, -10, -20]
leaflet = "posterior"
position = 0.5

[[repair]]
kind = "rupture"
region = "P2"
fraction = 0.5

[[repair]]
kind = "relocate-papillary"
muscle = "posteromedial"
toward = "trigone-right"
distance_mm = 8

[[repair]]
kind = "close-cleft"
position = 0.36
depth_mm = 2

[[repair]]
kind = "resect"
leaflet = "posterior"
shape = "quadrangular"
site = "A2P2"
width_mm = 12
strip_mm = 2.5
cut_chords = true

[[repair]]
kind = "augment"
leaflet = "posterior"
position = 0.5
width_mm = 8

[[repair]]
kind = "ring"
family = "saddle"
size_mm = 30
ap_mm = 24
saddle_height_mm = 6
attachment = "sutures"
sutures = 10

[[repair]]
kind = "ring"
family = "posterior-band"
size_mm = 30
flexible = true
"#;

fn read(text: &str) -> Result<(Plan, Vec<Fault>), Vec<Fault>> {
    plan_from_text(Path::new("plan.toml"), text)
}

#[test]
fn every_kind_of_repair_is_read_and_written_again() {
    let (plan, warnings) = read(ALL).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(plan.repair.len(), 12);
    let Repair::Clip(clip) = &plan.repair[0] else {
        panic!("{plan:?}")
    };
    assert_eq!(
        (clip.site, clip.size, clip.model),
        (Some(Site::A2P2), ClipSize::LongWide, ClipModel::Rigid)
    );
    let Repair::Neochord(neochord) = &plan.repair[2] else {
        panic!("{plan:?}")
    };
    assert_eq!(
        (neochord.strands, neochord.tip, neochord.length_mm),
        (2, Some(0), None)
    );
    let Repair::Rupture(rupture) = &plan.repair[5] else {
        panic!("{plan:?}")
    };
    assert_eq!(
        (rupture.region, &rupture.groups[..]),
        (Segment::P2, &["marginal".to_owned()][..])
    );
    let Repair::Resect(piece) = &plan.repair[8] else {
        panic!("{plan:?}")
    };
    assert_eq!(
        (piece.shape, piece.strip_mm, piece.height_fraction),
        (ResectionShape::Quadrangular, Some(2.5), None)
    );
    let Repair::Augment(patch) = &plan.repair[9] else {
        panic!("{plan:?}")
    };
    assert_eq!((patch.width_mm, patch.length_mm), (8.0, 30.0));
    let Repair::Ring(ring) = &plan.repair[10] else {
        panic!("{plan:?}")
    };
    assert_eq!((ring.ap_mm, ring.suture_count()), (Some(24.0), 10));
    let again = toml::to_string(&plan).unwrap();
    assert_eq!(read(&again).unwrap().0, plan);
    let json = serde_json::to_string(&plan).unwrap();
    assert_eq!(read(&json).unwrap().0, plan);
}

#[test]
fn what_is_wrong_in_a_repair_is_told_at_its_line() {
    for (from, to, place, words) in [
        (
            "site = \"A2P2\"\nsize",
            "site = \"B2\"\nsize",
            "plan.toml:5:",
            "unknown value `B2`",
        ),
        (
            "size = \"long-wide\"",
            "size = \"longwide\"",
            "plan.toml:6:",
            "did you mean `long-wide`?",
        ),
        (
            "angle_deg",
            "angle",
            "plan.toml:8:",
            "unknown key `angle`; did you mean `angle_deg`?",
        ),
        (
            "kind = \"alfieri\"",
            "kind = \"alfiery\"",
            "plan.toml:11:",
            "did you mean `alfieri`?",
        ),
        ("tip = 0", "tip = -1", "plan.toml:20:", "tip"),
        (
            "leaflet = \"posterior\"\nsite",
            "site",
            "plan.toml:15:",
            "the key `leaflet` is missing",
        ),
        (
            "toward = \"trigone-right\"",
            "toward = \"trigone\"",
            "plan.toml:41:",
            "unknown value `trigone`",
        ),
    ] {
        assert!(ALL.contains(from), "{from}");
        let faults = read(&ALL.replace(from, to)).unwrap_err();
        let told = faults
            .iter()
            .any(|fault| fault.place.starts_with(place) && fault.message.contains(words));
        assert!(told, "no {place} with {words} in {faults:#?}");
    }
}

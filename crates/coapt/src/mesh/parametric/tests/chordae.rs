//! What the chordae of a generated valve must be, and how presets differ.

use super::*;
use crate::model::Model;
use crate::scene::{ChordGroup, LineMesh, Tissue};

fn group<'a>(scene: &'a Scene, name: &str) -> &'a ChordGroup {
    scene
        .chordae
        .iter()
        .find(|group| group.name == name)
        .expect("group")
}

/// Per chord end on a leaflet: open distance from the tip over the slack length from the tip, less one.
fn pre_stretch(group: &ChordGroup) -> Vec<f64> {
    let mesh = group.mesh.as_ref().expect("inline");
    let rest = mesh.rest_length_mm.as_ref().expect("given");
    let length = |s: usize| {
        let [a, b] = mesh.segments[s].map(|v| Vec3::from(mesh.points_mm[v as usize]));
        (b - a).norm()
    };
    let ends =
        (0..mesh.segments.len()).filter(|&s| mesh.segments.iter().all(|t| t[0] != mesh.segments[s][1]));
    ends.map(|s| {
        let trunk = (0..mesh.segments.len()).find(|&t| mesh.segments[t][1] == mesh.segments[s][0]);
        let (open, slack) = trunk.map_or((0.0, 0.0), |t| (length(t), rest[t]));
        (open + length(s)) / ((slack + rest[s]) * group.rest_length_scale) - 1.0
    })
    .collect()
}

/// Chordae are cut for the closed valve, and the open one is only where closure starts from: some may be taut there,
/// by less than the slack of a closing leaflet takes up. Found: up to 25 % of them, by up to 5.7 %, most at the belly.
#[test]
fn most_healthy_chordae_are_slack_while_the_valve_is_open() {
    for faces in [200, 650, 2600, 10_000] {
        let scene = valve(Preset::Healthy, faces);
        let all: Vec<f64> = scene.chordae.iter().flat_map(pre_stretch).collect();
        let taut = all.iter().filter(|&&stretch| stretch > 1e-9).count() as f64 / all.len() as f64;
        let most = all.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        assert!(taut < 0.3 && most < 0.07, "{faces}: {taut} {most}");
    }
}

/// Every chord of every mesh hangs on a tip and ends in a leaflet, off the annulus; where and how long they are does not
/// depend on the mesh. Built without a word: no end was too far from the leaflets to be taken, none is held.
#[test]
fn chordae_are_the_same_on_every_mesh() {
    for preset in Preset::ALL {
        let scenes = [200, 650, 2600].map(|faces| valve(preset, faces));
        for scene in &scenes {
            assert_eq!(scene.chordae, scenes[0].chordae);
            let built = Model::build(scene).expect("a valve");
            assert!(built.warnings.is_empty(), "{:#?}", built.warnings);
            let leaflet_vertex = |&(v, _): &(u32, f64)| (v as usize) < built.model.leaflet_vertex_count;
            let inserted = built
                .model
                .chords
                .points
                .iter()
                .filter(|point| point.iter().any(leaflet_vertex));
            let segments: usize = scene
                .chordae
                .iter()
                .filter_map(|g| g.mesh.as_ref())
                .map(ends)
                .sum();
            assert_eq!(inserted.count(), segments);
        }
    }
}

/// Segments that nothing hangs on.
fn ends(mesh: &LineMesh) -> usize {
    let last = |s: &&[u32; 2]| mesh.segments.iter().all(|t| t[0] != s[1]);
    mesh.segments.iter().filter(last).count()
}

/// 8 anterior, 14 posterior and 2 commissural trunks, on both muscles, in fans of three.
#[test]
fn the_chord_pattern_is_that_of_a_heart() {
    let scene = valve(Preset::Healthy, 10_000);
    let marginal = group(&scene, "marginal").mesh.as_ref().expect("inline");
    let from_heads = |mesh: &LineMesh, muscle: usize| {
        let tips = &scene.papillary[muscle].tips_mm;
        mesh.segments
            .iter()
            .filter(|s| tips.contains(&mesh.points_mm[s[0] as usize]))
            .count()
    };
    assert_eq!((from_heads(marginal, 0), from_heads(marginal, 1)), (12, 12));
    assert_eq!(marginal.segments.len(), 2 + 22 * 4);
    for (name, each) in [("basal", 3), ("intermediate", 4), ("strut", 1)] {
        let mesh = group(&scene, name).mesh.as_ref().expect("inline");
        assert_eq!((from_heads(mesh, 0), from_heads(mesh, 1)), (each, each), "{name}");
    }
}

/// The dilated valve's chordae are those of the healthy one: the same closed distances, up to where on the
/// margin the mesh has its vertices (half an edge of 1.2 mm) and the slightly lower commissures.
#[test]
fn dilated_chordae_keep_their_healthy_length() {
    let mean = |preset| {
        let scene = valve(preset, 10_000);
        let mesh = group(&scene, "basal").mesh.clone().expect("inline");
        let rest = mesh.rest_length_mm.expect("given");
        rest.iter().sum::<f64>() / rest.len() as f64
    };
    let (healthy, dilated) = (mean(Preset::Healthy), mean(Preset::Dilated));
    assert!((healthy - dilated).abs() < 0.5, "{healthy} {dilated}");
}

#[test]
fn presets_are_what_their_names_say() {
    let scenes = Preset::ALL.map(|preset| valve(preset, 2600));
    for (scene, preset) in scenes.iter().zip(Preset::ALL) {
        assert_eq!(scene.name, preset.name());
        assert_eq!(Preset::from_name(preset.name()), Some(preset));
        assert_eq!(scene.load, Load::mmhg(100.0));
    }
    let [healthy, dilated, flail, barlow, restricted] = &scenes;
    let trunks = |scene: &Scene| group(scene, "marginal").mesh.as_ref().map(|m| m.segments.len());
    assert!(trunks(flail) < trunks(healthy));
    // Chordae as before, tips 3.5 mm away and the annulus wider: less slack, on the mean by more than a tenth.
    let mean = |scene: &Scene| {
        let stretches = pre_stretch(group(scene, "marginal"));
        stretches.iter().sum::<f64>() / stretches.len() as f64
    };
    let tighter = mean(dilated) - mean(healthy);
    assert!(tighter > 0.1, "{tighter}");
    assert!(dilated.papillary[0].tips_mm[1] != healthy.papillary[0].tips_mm[1]);
    let modulus = |scene: &Scene| {
        let Tissue::BilinearSprings {
            post_transition_modulus_mpa,
            ..
        } = scene.leaflets[0].tissue
        else {
            panic!("presets are made of springs");
        };
        post_transition_modulus_mpa
    };
    assert!(modulus(barlow) < modulus(healthy) && modulus(healthy) < modulus(restricted));
    assert!(area_mm2(barlow) > 1.4 * area_mm2(healthy));
    assert_eq!(
        [barlow, restricted].map(|scene| scene.chordae[0].rest_length_scale),
        [1.2, 0.87]
    );
}

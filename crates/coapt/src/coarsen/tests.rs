use nalgebra::Rotation3;

use super::*;
use crate::mesh::parametric::{Preset, ValveParameters, generate};
use crate::mesh::topology::face_edges;
use crate::model::fixtures::{built, skirt};
use crate::scene::{Scene, SurfaceMesh, Tissue};
use crate::{Mat3, Vec3};

fn scene(preset: Preset, face_count: u32, jitter_mm: f64) -> Scene {
    let mut parameters = ValveParameters::preset(preset);
    parameters.face_count_target = face_count;
    parameters.jitter_mm = jitter_mm;
    generate(&parameters).unwrap_or_else(|faults| panic!("{faults:#?}"))
}

fn preset(preset: Preset, face_count: u32) -> Model {
    built(&scene(preset, face_count, 0.0)).model
}

fn normal(model: &Model, face: &[u32; 3]) -> Vec3 {
    let [a, b, c] = face.map(|v| model.rest_mm[v as usize]);
    (b - a).cross(&(c - a))
}

fn area_mm2(model: &Model) -> f64 {
    model.faces.iter().map(|f| 0.5 * normal(model, f).norm()).sum()
}

/// One sheet that winds one way, of the same Euler characteristic and boundary loops, its lists along its border.
fn assert_same_topology(fine: &Model, coarse: &Model) {
    let shape = |model: &Model| {
        let edges = topology::edges(&model.faces);
        let loops = topology::chains(&topology::boundary_edges(&model.faces, &edges));
        let euler = (model.leaflet_vertex_count + model.faces.len()) as i64 - edges.len() as i64;
        (edges, loops, euler)
    };
    let (edges, loops, euler) = shape(coarse);
    let (_, fine_loops, fine_euler) = shape(fine);
    assert_eq!((euler, loops.len()), (fine_euler, fine_loops.len()));
    assert!((0..edges.len()).all(|e| edges.faces_of(e).len() <= 2));
    assert!(topology::pinched_vertices(&coarse.faces, &edges, coarse.leaflet_vertex_count).is_empty());
    let mut sides: Vec<[u32; 2]> = coarse.faces.iter().flat_map(|&f| face_edges(f)).collect();
    sides.sort_unstable();
    assert!(sides.is_sorted_by(|a, b| a < b), "a directed edge twice");
    let mut lists: Vec<Vec<u32>> = coarse.margins.iter().map(|m| m.vertices.clone()).collect();
    lists.push(coarse.annulus.clone());
    for list in lists {
        let is_loop = |chain: &topology::Chain| {
            let start = chain.vertices.iter().position(|&v| v == list[0]);
            start.is_some_and(|at| {
                let (end, begin) = chain.vertices.split_at(at);
                [begin, end].concat() == list
            })
        };
        assert!(loops.iter().any(is_loop), "{list:?}");
    }
}

#[test]
fn every_preset_coarsens_again_and_again() {
    for preset in Preset::ALL {
        for (face_count, jitter_mm) in [(650, 0.0), (2600, 0.1), (10_000, 0.0)] {
            let mut model = built(&scene(preset, face_count, jitter_mm)).model;
            while model.faces.len() > 200 {
                let name = format!("{} with {} faces", preset.name(), model.faces.len());
                let coarse = coarsen(&model, model.leaflet_vertex_count / 4);
                let coarse = coarse.unwrap_or_else(|| panic!("{name}")).model;
                let ratio = model.faces.len() as f64 / coarse.faces.len() as f64;
                assert!((3.0..5.0).contains(&ratio), "{name}: {ratio}");
                assert_same_topology(&model, &coarse);
                // A polygon of a dozen vertices has 95 % of its circle's area: boundaries lose that much, and a
                // funnel a little more.
                let area = area_mm2(&coarse) / area_mm2(&model);
                assert!((0.9..1.02).contains(&area), "{name}: area {area}");
                model = coarse;
            }
            assert!(model.faces.len() > 100, "{}", model.faces.len());
        }
    }
}

#[test]
fn however_hard_it_is_pressed_the_topology_stays() {
    let mut models: Vec<Model> = Preset::ALL.map(|p| preset(p, 650)).into();
    models.push(built(&skirt()).model);
    for fine in models {
        let coarse = coarsen(&fine, 0).unwrap().model;
        assert_same_topology(&fine, &coarse);
    }
}

#[test]
fn no_face_is_a_sliver_or_turned_over() {
    let fine = preset(Preset::Barlow, 2600);
    let coarse = coarsen(&fine, fine.leaflet_vertex_count / 4).unwrap().model;
    for face in &coarse.faces {
        let normal = normal(&coarse, face);
        let squares: f64 = face_edges(*face)
            .iter()
            .map(|&[a, b]| (coarse.rest_mm[a as usize] - coarse.rest_mm[b as usize]).norm_squared())
            .sum();
        // The score that every pull must leave, without its cosine, which is at most 1.
        assert!(2.0 * 3.0_f64.sqrt() * normal.norm() / squares > 0.3);
        let centre: Vec3 = face.iter().map(|&v| coarse.rest_mm[v as usize]).sum::<Vec3>() / 3.0;
        let distance =
            |f: &[u32; 3]| (f.iter().map(|&v| fine.rest_mm[v as usize]).sum::<Vec3>() / 3.0 - centre).norm();
        let below = fine
            .faces
            .iter()
            .min_by(|f, g| distance(f).total_cmp(&distance(g)))
            .unwrap();
        assert!(normal.dot(&super::tests::normal(&fine, below)) > 0.0);
    }
}

#[test]
fn springs_are_those_of_a_valve_built_on_the_coarse_mesh() {
    let mut scene = scene(Preset::Healthy, 650, 0.0);
    scene.leaflets[1].thickness_mm = 1.7;
    scene.leaflets[1].tissue = Tissue::BilinearSprings {
        pre_transition_modulus_mpa: 0.3,
        transition_strain: 0.07,
        post_transition_modulus_mpa: 5.0,
        compression_modulus_ratio: 0.2,
        bending_modulus_ratio: 2.0,
    };
    let fine = built(&scene).model;
    let once = coarsen(&fine, 200).unwrap().model;
    let coarse = coarsen(&once, 80).unwrap().model;
    for (number, leaflet) in scene.leaflets.iter_mut().enumerate() {
        let faces = coarse.faces.iter().zip(&coarse.face_leaflet);
        leaflet.mesh = Some(SurfaceMesh {
            points_mm: coarse.rest_mm.iter().map(|&p| p.into()).collect(),
            faces: faces
                .filter(|(_, l)| **l == number as u32)
                .map(|(f, _)| *f)
                .collect(),
            annulus_points: Some(coarse.annulus.clone()),
            annulus_displacement_mm: None,
        });
    }
    scene.chordae.clear();
    let rebuilt = built(&scene).model;
    let number = |v: u32| {
        coarse
            .rest_mm
            .iter()
            .position(|p| *p == rebuilt.rest_mm[v as usize])
            .unwrap() as u32
    };
    assert_eq!(rebuilt.springs.ends.len(), coarse.springs.ends.len());
    for (i, ends) in rebuilt.springs.ends.iter().enumerate() {
        let [a, b] = ends.map(number);
        let j = coarse.springs.ends.binary_search(&[a.min(b), a.max(b)]).unwrap();
        let (old, new) = (&rebuilt.springs, &coarse.springs);
        // Rounding of two dozen operations; the knee is the difference of two lengths, 1 / 0.07 times as wrong.
        let same = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-13, "{a} {b}");
        same(old.soft_n_per_mm[i], new.soft_n_per_mm[j]);
        same(old.stiff_n_per_mm[i], new.stiff_n_per_mm[j]);
        same(old.compression_n_per_mm[i], new.compression_n_per_mm[j]);
        same(old.transition_length_mm[i], new.transition_length_mm[j]);
    }
}

#[test]
fn chords_keep_their_slack_and_prescribed_vertices_their_targets() {
    let mut fine = preset(Preset::Dilated, 650);
    fine.chords
        .rest_length_mm
        .iter_mut()
        .for_each(|length| *length *= 1.1);
    fine.prescribed.iter_mut().for_each(|p| p.target_mm.x += 1.0);
    let coarse = coarsen(&fine, fine.leaflet_vertex_count / 4).unwrap().model;
    assert_eq!(coarse.chords.group, fine.chords.group);
    let slack = |model: &Model, i: usize| {
        let [a, b] = model.chords.ends[i].map(|point| model.chords.point_mm(point, &model.rest_mm));
        model.chords.rest_length_mm[i] - (a - b).norm()
    };
    let insertions = |model: &Model| {
        let of_leaflet = |&(vertex, _): &(u32, f64)| (vertex as usize) < model.leaflet_vertex_count;
        let inserts = |&&point: &&u32| model.chords.points[point as usize].iter().all(of_leaflet);
        model.chords.ends.iter().flatten().filter(inserts).count()
    };
    assert_eq!(insertions(&coarse), insertions(&fine));
    let mut farthest = 0.0_f64;
    for (i, ends) in coarse.chords.ends.iter().enumerate() {
        // Rounding of lengths of about 20 mm.
        assert!((slack(&coarse, i) - slack(&fine, i)).abs() < 1e-13);
        let at = ends.map(|point| coarse.chords.point_mm(point, &coarse.rest_mm));
        let was = fine.chords.ends[i].map(|point| fine.chords.point_mm(point, &fine.rest_mm));
        farthest = at
            .iter()
            .zip(&was)
            .map(|(at, was)| (at - was).norm())
            .fold(farthest, f64::max);
    }
    // An insertion stays over the same tissue, on flat coarse faces: off by their sagitta, h²/8R with edges h of 4 mm and
    // the least radius R of the open leaflets, 4 mm.
    assert!((1e-3..0.5).contains(&farthest), "{farthest} mm");
    for p in &coarse.prescribed {
        assert_eq!(p.target_mm, coarse.rest_mm[p.vertex as usize] + Vec3::x());
    }
    let tips: usize = fine.papillary.iter().map(|m| m.tips.len()).sum();
    assert_eq!(coarse.prescribed.len(), coarse.annulus.len() + tips);
}

/// Springs, membranes and hinges for a model whose mesh has been changed.
fn remake_tissue(model: &mut Model) {
    let made = elasticity(&super::Sheet::of(model), &topology::edges(&model.faces));
    (model.springs, model.membranes, model.hinges) = (made.springs, made.membranes, made.hinges);
}

#[test]
fn rigid_motions_are_prolonged_exactly() {
    let fine = preset(Preset::Flail, 2600);
    let Coarse { model, prolongation } = coarsen(&fine, fine.leaflet_vertex_count / 4).unwrap();
    let turn = Rotation3::from_euler_angles(2.0, -1.0, 0.5);
    let motion =
        |points: &[Vec3]| -> Vec<Vec3> { points.iter().map(|p| turn * p + Vec3::repeat(7.0)).collect() };
    let found = prolongation.prolong(&model.rest_mm, &motion(&model.rest_mm), &fine.rest_mm);
    for (found, expected) in found.iter().zip(motion(&fine.rest_mm)) {
        // Rounding of coordinates of about 50 mm in flat faces.
        assert!((found - expected).norm() < 1e-12, "{found} {expected}");
    }
}

#[test]
fn linear_motions_of_a_flat_sheet_are_prolonged_exactly_and_kept_vertices_always() {
    let mut fine = built(&skirt()).model;
    let leaflets = fine.leaflet_vertex_count;
    fine.rest_mm[..leaflets]
        .iter_mut()
        .for_each(|point| point.z = 0.0);
    remake_tissue(&mut fine);
    let Coarse { model, prolongation } = coarsen(&fine, 40).unwrap();
    let map = Mat3::new(1.3, 0.4, 0.0, -0.2, 0.8, 0.0, 0.5, -0.6, 1.0);
    let motion = |points: &[Vec3]| -> Vec<Vec3> { points.iter().map(|p| map * p).collect() };
    let found = prolongation.prolong(&model.rest_mm, &motion(&model.rest_mm), &fine.rest_mm);
    for (found, expected) in found.iter().zip(motion(&fine.rest_mm)).take(leaflets) {
        assert!((found - expected).norm() < 1e-12, "{found} {expected}");
    }
    // Kept vertices, and with them chord nodes and tips, go wherever the coarse ones are put.
    let anywhere: Vec<Vec3> = (0..model.rest_mm.len())
        .map(|v| Vec3::new(v as f64, 1.0, 2.0))
        .collect();
    let found = prolongation.prolong(&model.rest_mm, &anywhere, &fine.rest_mm);
    let kept = found.iter().filter(|p| anywhere.contains(p)).count();
    assert!(kept >= model.rest_mm.len());
    assert_eq!(found[leaflets..], anywhere[model.leaflet_vertex_count..]);
}

#[test]
fn what_lies_off_a_bent_face_turns_with_it() {
    // The sheet is rolled by half a turn: what lay 1 mm above it lies 1 mm below.
    let prolongation = Prolongation {
        corners: vec![[0, 1, 2]],
        weights: vec![[1.0 / 3.0; 3]],
        faces: vec![[0, 1, 2]],
    };
    let rest = [Vec3::zeros(), Vec3::x(), Vec3::y()];
    let rolled = [Vec3::zeros(), Vec3::x() * 2.0, -Vec3::y()];
    let above = Vec3::new(1.0 / 3.0, 1.0 / 3.0, 1.0);
    let [found] = prolongation.prolong(&rest, &rolled, &[above])[..] else {
        panic!("one vertex in, one out");
    };
    assert!((found - Vec3::new(2.0 / 3.0, -1.0 / 3.0, -1.0)).norm() < 1e-14);
}

#[test]
fn equal_models_give_equal_bytes() {
    let fine = preset(Preset::Restricted, 2600);
    let bytes = || format!("{:?}", coarsen(&fine, fine.leaflet_vertex_count / 4));
    assert_eq!(bytes(), bytes());
}

#[test]
fn there_is_nothing_where_nothing_can_go() {
    let fine = preset(Preset::Healthy, 650);
    assert!(coarsen(&fine, fine.leaflet_vertex_count).is_none());
    let mut held = fine.clone();
    let hold = |vertex: u32| crate::model::Prescribed {
        vertex,
        target_mm: fine.rest_mm[vertex as usize],
    };
    held.prescribed = (0..fine.rest_mm.len() as u32).map(hold).collect();
    held.face_leaflet
        .iter_mut()
        .enumerate()
        .for_each(|(i, leaflet)| *leaflet = i as u32);
    held.leaflets = vec![fine.leaflets[0].clone(); fine.faces.len()];
    remake_tissue(&mut held);
    assert!(coarsen(&held, 10).is_none(), "every vertex is a corner");
    let mut other = fine.clone();
    other.springs = Default::default();
    assert!(
        coarsen(&other, 90).is_none(),
        "springs that are not of the tissue"
    );
}

#[test]
fn landmarks_stay_near_and_lists_name_what_they_named() {
    let fine = preset(Preset::Healthy, 2600);
    let coarse = coarsen(&fine, fine.leaflet_vertex_count / 4).unwrap().model;
    let at = |model: &Model, landmark: usize| model.rest_mm[model.annulus[landmark] as usize];
    let pairs = [
        (fine.landmarks.mid_anterior, coarse.landmarks.mid_anterior),
        (fine.landmarks.trigone_left, coarse.landmarks.trigone_left),
        (
            fine.landmarks.commissure_posteromedial,
            coarse.landmarks.commissure_posteromedial,
        ),
    ];
    for (old, new) in pairs {
        // Half a coarse edge of the annulus.
        assert!((at(&fine, old) - at(&coarse, new)).norm() < 1.7);
    }
    for (old, new) in fine.papillary.iter().zip(&coarse.papillary) {
        let places = |model: &Model, tips: &[u32]| -> Vec<Vec3> {
            tips.iter().map(|&t| model.rest_mm[t as usize]).collect()
        };
        assert_eq!(places(&fine, &old.tips), places(&coarse, &new.tips));
    }
}

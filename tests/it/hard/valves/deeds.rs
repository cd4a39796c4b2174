//! What rows do to valves.

use std::collections::BTreeMap;

use coapt::Vec3;
use coapt::mesh::parametric::ValveParameters;
use coapt::model::Model;
use coapt::scene::{Scene, SurfaceMesh, Tissue};
use coapt::state::State;

pub(super) fn meshes(scene: &mut Scene) -> impl Iterator<Item = &mut SurfaceMesh> {
    scene
        .leaflets
        .iter_mut()
        .filter_map(|leaflet| leaflet.mesh.as_mut())
}

/// Moves points 0.85 of the way to a neighbour, as many as have no neighbour in common with one moved before: the faces
/// that the two share become needles of a sixth of their height.
pub(super) fn make_slivers(mesh: &mut SurfaceMesh) {
    let sides = |face: &[u32; 3]| [[face[0], face[1]], [face[1], face[2]], [face[2], face[0]]];
    let directed: Vec<[u32; 2]> = mesh.faces.iter().flat_map(sides).collect();
    let on_border = |point: u32| {
        let mut out = directed.iter().filter(|side| side[0] == point);
        out.any(|&[a, b]| !directed.contains(&[b, a]))
    };
    let mut held = vec![false; mesh.points_mm.len()];
    for point in 0..mesh.points_mm.len() as u32 {
        let around: Vec<u32> = directed
            .iter()
            .filter(|side| side[0] == point)
            .map(|side| side[1])
            .collect();
        if held[point as usize] || around.iter().any(|&other| held[other as usize]) || on_border(point) {
            continue;
        }
        let goal = mesh.points_mm[around[0] as usize];
        let place = &mut mesh.points_mm[point as usize];
        (0..3).for_each(|axis| place[axis] += 0.85 * (goal[axis] - place[axis]));
        held[point as usize] = true;
        around.iter().for_each(|&other| held[other as usize] = true);
    }
}

pub(super) fn excess_tissue(valve: &mut ValveParameters) {
    valve.leaflets.height_scale *= 1.3;
    // Else they reach across the orifice already when open.
    valve.leaflets.opening_angle_deg = 8.0;
    valve.chordae.rest_length_scale *= 1.2;
}

pub(super) fn each_tissue(scene: &mut Scene, change: impl Fn(&mut f64, &mut f64)) {
    for leaflet in &mut scene.leaflets {
        if let Tissue::BilinearSprings {
            pre_transition_modulus_mpa,
            post_transition_modulus_mpa,
            ..
        } = &mut leaflet.tissue
        {
            change(pre_transition_modulus_mpa, post_transition_modulus_mpa);
        }
    }
}

/// Leaflets of one thickness throughout.
pub(super) fn thickness(scene: &mut Scene, thickness_mm: f64) {
    for leaflet in &mut scene.leaflets {
        leaflet.thickness_mm = thickness_mm;
    }
}

/// Tissue that is so many times as stiff beyond its knee as below.
pub(super) fn knee(scene: &mut Scene, ratio: f64) {
    each_tissue(scene, |soft, stiff| *soft = *stiff / ratio);
}

/// Moves the annulus to where its anteroposterior diameter is so many times what it is; parametric valves stand with it along
/// y, and their annulus does not move by itself.
pub(super) fn narrow(scene: &mut Scene, part: f64) {
    for mesh in meshes(scene) {
        let motion = |point: &[f64; 3]| [0.0, (part - 1.0) * point[1], 0.0];
        mesh.annulus_displacement_mm = Some(mesh.points_mm.iter().map(motion).collect());
    }
}

pub(super) fn each_free(model: &Model, state: &mut State, change: impl Fn(&mut Vec3)) {
    for vertex in (0..model.leaflet_vertex_count).filter(|vertex| !model.annulus.contains(&(*vertex as u32)))
    {
        change(&mut state.positions_mm[vertex]);
    }
}

pub(super) fn lowest_mm(points_mm: &[Vec3]) -> f64 {
    points_mm.iter().map(|point| point.z).fold(0.0, f64::min)
}

/// Swings a point towards the other leaflet, the lower it hangs the more: at 1 the lowest meet in the middle.
pub(super) fn swing(point: &mut Vec3, part: f64, lowest_mm: f64) {
    point.y *= 1.0 - part * (point.z / lowest_mm).clamp(0.0, 1.0);
}

pub(super) fn each_point(scene: &mut Scene, change: impl Fn(&mut Vec3, f64)) {
    let points = meshes(scene).flat_map(|mesh| &mesh.points_mm);
    let lowest = points.map(|point| point[2]).fold(0.0, f64::min);
    for point in meshes(scene).flat_map(|mesh| &mut mesh.points_mm) {
        let mut moved = Vec3::from(*point);
        change(&mut moved, lowest);
        *point = moved.into();
    }
}

pub(super) fn cross(scene: &mut Scene, part: f64) {
    each_point(scene, |point, lowest| swing(point, part, lowest));
}

/// Puts the lower halves of both leaflets into one plane.
pub(super) fn flatten(scene: &mut Scene, plane_mm: f64) {
    each_point(scene, |point, lowest| {
        let depth = (2.0 * point.z / lowest).clamp(0.0, 1.0);
        point.y += depth * (plane_mm - point.y);
    });
}

/// Moves every point, and points that leaflets share together.
pub(super) fn jitter_points(scene: &mut Scene, mut moved: impl FnMut(Vec3) -> Vec3) {
    let mut known: BTreeMap<[u64; 3], Vec3> = BTreeMap::new();
    for point in meshes(scene).flat_map(|mesh| &mut mesh.points_mm) {
        let place = point.map(f64::to_bits);
        *point = (*known.entry(place).or_insert_with(|| moved(Vec3::from(*point)))).into();
    }
}

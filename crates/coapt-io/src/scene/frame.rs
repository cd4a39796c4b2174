//! A scene whose own numbers are in RAS, turned to LPS.

use coapt::scene::{Scene, Space};

use super::files::turn;

/// Turns every coordinate and displacement that is written in the scene, once: from RAS to LPS. Readers of scenes do so themselves; it is
/// for who puts a scene together of parts in RAS.
pub fn turn_scene(scene: &mut Scene) {
    for mesh in scene
        .leaflets
        .iter_mut()
        .filter_map(|leaflet| leaflet.mesh.as_mut())
    {
        turn(&mut mesh.points_mm);
        turn(mesh.annulus_displacement_mm.as_deref_mut().unwrap_or_default());
    }
    for mesh in scene.chordae.iter_mut().filter_map(|group| group.mesh.as_mut()) {
        turn(&mut mesh.points_mm);
    }
    turn(scene.annulus.curve_mm.as_deref_mut().unwrap_or_default());
    for muscle in &mut scene.papillary {
        turn(&mut muscle.tips_mm);
        turn(&mut muscle.displacements_mm);
    }
    let marks = &mut scene.landmarks;
    let named = [
        &mut marks.mid_anterior_mm,
        &mut marks.mid_posterior_mm,
        &mut marks.commissure_anterolateral_mm,
        &mut marks.commissure_posteromedial_mm,
        &mut marks.trigone_left_mm,
        &mut marks.trigone_right_mm,
    ];
    for point in named.into_iter().flatten() {
        turn(std::slice::from_mut(point));
    }
    scene.space = Space::LPS;
}

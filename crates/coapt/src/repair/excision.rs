//! A model made anew of a leaflet mesh from which faces were taken, or to which some were added.

use std::collections::BTreeMap;

use super::incision::Mesh;
use crate::Vec3;
use crate::mesh::topology::{self, Chain};
use crate::model::elasticity::{Elasticity, Sheet, elasticity};
use crate::model::{Margin, Model, insertion_near};
use crate::scene::Fault;

/// The number of a vertex that is no more.
pub(super) const GONE: u32 = u32::MAX;

/// A chord that is sewn in anew must find tissue so near [mm]: the mesh may have moved by part of an edge (our choice).
const REACH_MM: f64 = 2.0;

/// Where chord points are to be set into the leaflets anew: by the number of the point, the leaflet and the place [mm].
pub(super) type Reinserted = BTreeMap<u32, (u32, Vec3)>;

/// The model of a mesh whose first vertices are the model's leaflet vertices, all other parts as they were, and the number that
/// each vertex of the mesh has there. Vertices without a face leave. Springs, membranes and hinges are those of what is left.
///
/// # Errors
/// A chord point of `reinserted` finds no tissue, with `place`.
pub(super) fn remade(
    model: &Model,
    mesh: &Mesh,
    reinserted: &Reinserted,
    place: &str,
) -> Result<(Model, Vec<u32>), Fault> {
    let mut numbers = vec![GONE; mesh.points_mm.len()];
    mesh.faces.iter().flatten().for_each(|&v| numbers[v as usize] = 0);
    let kept: Vec<usize> = (0..numbers.len()).filter(|&v| numbers[v] != GONE).collect();
    for (number, &vertex) in (0..).zip(&kept) {
        numbers[vertex] = number;
    }
    let (before, after) = (model.leaflet_vertex_count, kept.len());
    // Of a vertex of the model: behind its leaflet vertices come chord nodes and tips, and not what the mesh has there.
    let number = |vertex: u32| match (vertex as usize).checked_sub(before) {
        None => numbers[vertex as usize],
        Some(beyond) => (after + beyond) as u32,
    };
    let mut made = model.clone();
    made.leaflet_vertex_count = after;
    made.rest_mm = kept.iter().map(|&v| mesh.points_mm[v]).collect();
    made.rest_mm.extend(&model.rest_mm[before..]);
    made.faces = mesh
        .faces
        .iter()
        .map(|face| face.map(|v| numbers[v as usize]))
        .collect();
    made.face_leaflet.clone_from(&mesh.face_leaflet);
    made.annulus.iter_mut().for_each(|v| *v = number(*v));
    for tip in made.papillary.iter_mut().flat_map(|muscle| &mut muscle.tips) {
        *tip = number(*tip);
    }
    made.prescribed
        .iter_mut()
        .for_each(|fixed| fixed.vertex = number(fixed.vertex));
    made.prescribed.retain(|fixed| fixed.vertex != GONE);
    made.dead_loads_n
        .iter_mut()
        .for_each(|(vertex, _)| *vertex = number(*vertex));
    made.dead_loads_n.retain(|(vertex, _)| *vertex != GONE);
    made.margins = margins(&made);
    stretch_anew(&mut made);
    for (point, vertices) in (0..).zip(&mut made.chords.points) {
        if !reinserted.contains_key(&point) {
            vertices
                .iter_mut()
                .for_each(|(vertex, _)| *vertex = number(*vertex));
        }
    }
    for (&point, &(leaflet, at_mm)) in reinserted {
        let found = insertion_near(&made, leaflet, at_mm, REACH_MM);
        let found = found.ok_or_else(|| {
            let message = format!(
                "leaves no tissue at ({:.1}, {:.1}, {:.1}) mm, where a chord inserts; expected tissue within {REACH_MM} mm",
                at_mm.x, at_mm.y, at_mm.z
            );
            Fault::of_shape(place, message)
        })?;
        made.chords.points[point as usize] = found.vertices;
    }
    Ok((made, numbers))
}

/// Makes springs, membranes and hinges of the leaflets' tissues.
fn stretch_anew(model: &mut Model) {
    let edges = topology::edges(&model.faces);
    let Elasticity {
        springs,
        membranes,
        hinges,
    } = elasticity(&Sheet::of(model), &edges);
    model.springs = springs;
    model.membranes = membranes;
    model.hinges = hinges;
}

/// Every stretch of boundary that is not annulus, in winding order.
fn margins(model: &Model) -> Vec<Margin> {
    let mut held = model.annulus.clone();
    held.sort_unstable();
    let is_held = |v: u32| held.binary_search(&v).is_ok();
    let mut sides = topology::boundary_edges(&model.faces, &topology::edges(&model.faces));
    sides.retain(|&[a, b]| !(is_held(a) && is_held(b)));
    let chains = topology::chains(&sides).into_iter();
    chains
        .map(|Chain { vertices, closed }| Margin { vertices, closed })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::parametric::{ValveParameters, generate};
    use crate::model::fixtures::built;

    /// Made anew of its own mesh a model is what it was, but that margins may begin elsewhere; also after a vertex has been put
    /// before all others, which shifts every number.
    #[test]
    fn a_mesh_taken_as_it_is_makes_the_same_model() {
        let model = built(&generate(&ValveParameters::default()).unwrap()).model;
        let (same, _) = remade(&model, &Mesh::of(&model), &Reinserted::new(), "test").unwrap();
        assert_eq!((&same.springs, &same.hinges), (&model.springs, &model.hinges));
        assert_eq!(
            (&same.annulus, &same.prescribed),
            (&model.annulus, &model.prescribed)
        );
        assert_eq!((&same.chords, &same.papillary), (&model.chords, &model.papillary));
        let sorted = |model: &Model| {
            let mut vertices = model.margins[0].vertices.clone();
            vertices.sort_unstable();
            (model.margins.len(), vertices, model.margins[0].closed)
        };
        assert_eq!(sorted(&same), sorted(&model));
    }

    /// Without the face at a margin vertex, whatever had a place has it still.
    #[test]
    fn what_is_left_keeps_its_place() {
        let mut model = built(&generate(&ValveParameters::default()).unwrap()).model;
        let tip = model.margins[0].vertices[0];
        model.dead_loads_n = vec![(tip, Vec3::x()), (model.margins[0].vertices[9], Vec3::y())];
        let mut mesh = Mesh::of(&model);
        let stays: Vec<bool> = mesh.faces.iter().map(|face| !face.contains(&tip)).collect();
        let mut number = 0..;
        mesh.faces
            .retain(|_| number.next().is_some_and(|face: usize| stays[face]));
        let mut number = 0..;
        mesh.face_leaflet
            .retain(|_| number.next().is_some_and(|face: usize| stays[face]));
        let touched = (0..)
            .zip(&model.chords.points)
            .filter(|(_, point)| point.iter().any(|&(v, _)| v == tip));
        let away = Vec3::new(0.0, 0.0, 0.0);
        let inserted: Reinserted = touched.map(|(point, _)| (point, (0, away))).collect();
        if let Some(fault) = remade(&model, &mesh, &inserted, "test").err() {
            assert!(fault.message.contains("leaves no tissue at"), "{fault:?}");
        }
        let somewhere = model.rest_mm[model.margins[0].vertices[9] as usize];
        let leaflets = model.faces.iter().zip(&model.face_leaflet);
        let leaflet = leaflets
            .filter(|(face, _)| face.contains(&model.margins[0].vertices[9]))
            .map(|(_, &l)| l)
            .next();
        let inserted: Reinserted = inserted
            .into_keys()
            .map(|point| (point, (leaflet.unwrap(), somewhere)))
            .collect();
        let (left, numbers) = remade(&model, &mesh, &inserted, "test").unwrap();
        assert_eq!(numbers[tip as usize], GONE);
        assert_eq!(left.rest_mm.len(), model.rest_mm.len() - 1);
        let places =
            |model: &Model, of: &[u32]| of.iter().map(|&v| model.rest_mm[v as usize]).collect::<Vec<_>>();
        assert_eq!(places(&left, &left.annulus), places(&model, &model.annulus));
        for (muscle, old) in left.papillary.iter().zip(&model.papillary) {
            assert_eq!(places(&left, &muscle.tips), places(&model, &old.tips));
        }
        assert_eq!(left.dead_loads_n.len(), 1);
        assert_eq!(left.rest_mm[left.dead_loads_n[0].0 as usize], somewhere);
        assert!(left.prescribed.is_sorted_by(|a, b| a.vertex < b.vertex));
        for point in 0..model.chords.points.len() as u32 {
            if !inserted.contains_key(&point) {
                let at = |model: &Model| model.chords.point_mm(point, &model.rest_mm);
                assert!((at(&left) - at(&model)).norm() < 1e-12);
            }
        }
    }
}

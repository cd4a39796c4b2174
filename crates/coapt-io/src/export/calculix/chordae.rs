//! Chordae: springs from point to point with a table.

use coapt::model::Model;

use super::super::material::chord_curve;
use super::super::{density, put};
use super::mesh::Numbering;
use super::{number, put_node};

/// Springs from point to point with a table of force over elongation; an insertion is a node of its own that is the
/// weighted mean of vertices.
pub(super) fn put_chordae(text: &mut String, model: &Model, numbering: Numbering) {
    let chords = &model.chords;
    let mut next = numbering.insertion();
    let mut node_of = Vec::with_capacity(chords.points.len());
    for (point, vertices) in chords.points.iter().enumerate() {
        if let [(vertex, _)] = vertices[..] {
            node_of.push(vertex as usize + 1);
            continue;
        }
        put(text, format_args!("*NODE, NSET=INSERTIONS"));
        put_node(text, next, chords.point_mm(point as u32, &model.rest_mm));
        for axis in 1..=3 {
            put(
                text,
                format_args!("*EQUATION\n{}\n{next}, {axis}, 1.", vertices.len() + 1),
            );
            for (vertex, weight) in vertices {
                put(text, format_args!("{}, {axis}, {}", vertex + 1, number(-weight)));
            }
        }
        node_of.push(next);
        next += 1;
    }
    for (segment, ends) in chords.ends.iter().enumerate() {
        let [from, to] = ends.map(|point| node_of[point as usize]);
        let element = model.faces.len() + segment + 1;
        let name = segment + 1;
        put(
            text,
            format_args!(
                "*ELEMENT, TYPE=SPRINGA, ELSET=CHORD{name}\n{element}, {from}, {to}\n*SPRING, ELSET=CHORD{name}, NONLINEAR"
            ),
        );
        for [elongation, force] in chord_curve(model, segment) {
            put(text, format_args!("{}, {}", number(force), number(elongation)));
        }
    }
}

/// Half of each chord's mass on vertices between chordae: CalculiX cannot begin a dynamic step where nothing has mass.
pub(super) fn put_masses(text: &mut String, model: &Model) {
    let chords = &model.chords;
    let mut volume_mm3 = vec![0.0; model.rest_mm.len()];
    for (segment, ends) in chords.ends.iter().enumerate() {
        for point in ends {
            if let [(vertex, _)] = chords.points[*point as usize][..] {
                volume_mm3[vertex as usize] +=
                    0.5 * chords.area_mm2[segment] * chords.rest_length_mm[segment];
            }
        }
    }
    let first = model.faces.len() + chords.ends.len() + 1;
    let held = |vertex: usize| {
        model
            .prescribed
            .iter()
            .any(|fixed| fixed.vertex as usize == vertex)
    };
    let free = (model.leaflet_vertex_count..model.rest_mm.len()).filter(|&vertex| !held(vertex));
    for (index, vertex) in free.enumerate() {
        let (element, node) = (first + index, vertex + 1);
        let mass = number(density(model) * volume_mm3[vertex]);
        put(
            text,
            format_args!(
                "*ELEMENT, TYPE=MASS, ELSET=MASS{node}\n{element}, {node}\n*MASS, ELSET=MASS{node}\n{mass}"
            ),
        );
    }
}

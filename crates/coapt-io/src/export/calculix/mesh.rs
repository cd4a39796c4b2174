//! Nodes and wedges, and the equations that make membranes of them.

use coapt::Vec3;
use coapt::model::Model;

use super::super::{corners, put};
use super::put_node;

/// Numbers of nodes: vertices, directors, wedges (bottom, then top), chord points between vertices.
#[derive(Clone, Copy, Debug)]
pub(in crate::export) struct Numbering {
    vertices: usize,
    faces: usize,
}

impl Numbering {
    pub(in crate::export) fn of(model: &Model) -> Self {
        Self {
            vertices: model.rest_mm.len(),
            faces: model.faces.len(),
        }
    }

    fn director(self, face: usize) -> usize {
        self.vertices + face + 1
    }

    /// Bottom and top node of a face at its corner.
    pub(in crate::export) fn wedge(self, face: usize, corner: usize) -> [usize; 2] {
        let first = self.vertices + self.faces + 6 * face + corner + 1;
        [first, first + 3]
    }

    /// The first node for a chord point that is no vertex.
    pub(super) fn insertion(self) -> usize {
        self.vertices + 7 * self.faces + 1
    }
}

pub(super) fn put_nodes(text: &mut String, model: &Model, numbering: Numbering) {
    put(text, format_args!("*NODE, NSET=VERTICES"));
    for (vertex, point) in model.rest_mm.iter().enumerate() {
        put_node(text, vertex + 1, *point);
    }
    put(text, format_args!("*NODE, NSET=DIRECTORS"));
    for face in 0..model.faces.len() {
        put_node(
            text,
            numbering.director(face),
            corners(model, face).iter().sum::<Vec3>() / 3.0,
        );
    }
    put(text, format_args!("*NODE, NSET=WEDGES"));
    for face in 0..model.faces.len() {
        let points = corners(model, face);
        let normal = (points[1] - points[0])
            .cross(&(points[2] - points[0]))
            .normalize();
        let half = normal * (0.5 * thickness(model, face));
        for (corner, point) in points.iter().enumerate() {
            put_node(text, numbering.wedge(face, corner)[0], point - half);
        }
        for (corner, point) in points.iter().enumerate() {
            put_node(text, numbering.wedge(face, corner)[1], point + half);
        }
    }
}

/// The elements, an element set for each leaflet, and the equations that hold wedges affine.
pub(super) fn put_wedges(text: &mut String, model: &Model, numbering: Numbering) {
    for leaflet in 0..model.leaflets.len() {
        put(
            text,
            format_args!("*ELEMENT, TYPE=C3D6, ELSET=LEAFLET{}", leaflet + 1),
        );
        for face in (0..model.faces.len()).filter(|&face| model.face_leaflet[face] as usize == leaflet) {
            let [a, b, c] = [0, 1, 2].map(|corner| numbering.wedge(face, corner));
            let ([a, d], [b, e], [c, f]) = (a, b, c);
            put(text, format_args!("{}, {a}, {b}, {c}, {d}, {e}, {f}", face + 1));
        }
    }
    for (face, vertices) in model.faces.iter().enumerate() {
        let director = numbering.director(face);
        for (corner, vertex) in vertices.iter().enumerate() {
            for (node, sign) in numbering.wedge(face, corner).into_iter().zip(["0.5", "-0.5"]) {
                for axis in 1..=3 {
                    let vertex = vertex + 1;
                    put(
                        text,
                        format_args!(
                            "*EQUATION\n3\n{node}, {axis}, 1., {vertex}, {axis}, -1., {director}, {axis}, {sign}"
                        ),
                    );
                }
            }
        }
    }
}

fn thickness(model: &Model, face: usize) -> f64 {
    model.leaflets[model.face_leaflet[face] as usize].thickness_mm
}

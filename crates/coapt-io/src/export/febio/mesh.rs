//! Nodes, shells, and the sets that other sections name.

use coapt::model::Model;

use super::super::put;

/// The node of each chord point: a vertex, or a node behind all vertices.
pub(super) fn insertions(model: &Model) -> Vec<usize> {
    let mut next = model.rest_mm.len() + 1;
    let mut node = |vertices: &[(u32, f64)]| {
        if let [(vertex, _)] = *vertices {
            return vertex as usize + 1;
        }
        next += 1;
        next - 1
    };
    model
        .chords
        .points
        .iter()
        .map(|vertices| node(vertices))
        .collect()
}

pub(super) fn put_mesh(text: &mut String, model: &Model, insertions: &[usize]) {
    put(text, format_args!("<Mesh>\n<Nodes name=\"vertices\">"));
    let between = (0..insertions.len()).filter(|&point| insertions[point] > model.rest_mm.len());
    let between = between.map(|point| model.chords.point_mm(point as u32, &model.rest_mm));
    for (index, point) in model.rest_mm.iter().copied().chain(between).enumerate() {
        let (x, y, z) = (point.x, point.y, point.z);
        put(
            text,
            format_args!("<node id=\"{}\">{x:?},{y:?},{z:?}</node>", index + 1),
        );
    }
    put(text, format_args!("</Nodes>"));
    for leaflet in 0..model.leaflets.len() {
        put(
            text,
            format_args!("<Elements type=\"tri3\" name=\"leaflet{}\">", leaflet + 1),
        );
        put_faces(text, model, leaflet, "elem");
        put(text, format_args!("</Elements>"));
    }
    put_sets(text, model);
    for (segment, ends) in model.chords.ends.iter().enumerate() {
        let [from, to] = ends.map(|point| insertions[point as usize]);
        let name = segment + 1;
        put(
            text,
            format_args!("<DiscreteSet name=\"chord{name}\"><delem>{from},{to}</delem></DiscreteSet>"),
        );
    }
    put(text, format_args!("</Mesh>\n<MeshDomains>"));
    for (leaflet, tissue) in model.leaflets.iter().enumerate() {
        let (name, thickness) = (leaflet + 1, tissue.thickness_mm);
        put(
            text,
            format_args!(
                "<ShellDomain name=\"leaflet{name}\" mat=\"tissue{name}\" type=\"elastic-shell\">\
                 <shell_thickness>{thickness:?}</shell_thickness></ShellDomain>"
            ),
        );
    }
    put(text, format_args!("</MeshDomains>"));
}

fn put_faces(text: &mut String, model: &Model, leaflet: usize, tag: &str) {
    let faces = model.faces.iter().enumerate();
    for (face, vertices) in faces.filter(|(face, _)| model.face_leaflet[*face] as usize == leaflet) {
        let [a, b, c] = vertices.map(|vertex| vertex + 1);
        put(
            text,
            format_args!("<{tag} id=\"{}\">{a},{b},{c}</{tag}>", face + 1),
        );
    }
}

/// Held nodes, each on its own since each goes its own way; the surfaces that pressure acts on and that touch.
fn put_sets(text: &mut String, model: &Model) {
    for fixed in &model.prescribed {
        let node = fixed.vertex + 1;
        put(
            text,
            format_args!("<NodeSet name=\"node{node}\">{node}</NodeSet>"),
        );
    }
    for leaflet in 0..model.leaflets.len() {
        put(text, format_args!("<Surface name=\"surface{}\">", leaflet + 1));
        put_faces(text, model, leaflet, "tri3");
        put(text, format_args!("</Surface>"));
    }
    for (one, other) in pairs(model) {
        put(
            text,
            format_args!(
                "<SurfacePair name=\"pair{one}_{other}\"><primary>surface{one}</primary>\
                 <secondary>surface{other}</secondary></SurfacePair>"
            ),
        );
    }
}

/// Leaflets that may touch, numbered from 1; none where contact is off.
pub(super) fn pairs(model: &Model) -> Vec<(usize, usize)> {
    let count = match model.contact.stiffness_mpa {
        0.0 => 0,
        _ => model.leaflets.len(),
    };
    (1..=count)
        .flat_map(|one| (one + 1..=count).map(move |other| (one, other)))
        .collect()
}

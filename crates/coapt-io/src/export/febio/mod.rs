//! A model as input of FEBio, format 4.0, after its manuals; we have never run it.
//!
//! Faces are triangular shells with the leaflet's thickness. Unlike ours they bend, as their thickness and law say. The load
//! comes on in a dynamic step, and a static one finds the balance, since a membrane without tension has no stiffness.
//! Positive pressure acts against the normal of a surface in FEBio, and our normals point to where the pressure pushes:
//! hence the minus. Leaflets touch by FEBio's own `sliding-elastic` contact of their upper sides, each with each; a leaflet
//! on itself does not.

mod mesh;
mod tissue;

use coapt::model::{Model, Prescribed};
use coapt::scene::Fault;

use super::material::{chord_curve, materials};
use super::{heading, put, refuse_what_no_scene_has};
use mesh::{insertions, pairs, put_mesh};
use tissue::{LAWS, description, put_materials};

/// When the static step ends [s].
pub(super) const END_TIME: f64 = 2.0;

/// Where the run puts its nodes.
const LOG: &str = "closed_nodes.txt";

/// The input file of a model. Its run writes a log `closed_nodes.txt` of the nodes' places.
///
/// # Errors
/// A leaflet whose law FEBio does not have, dead loads, or sutures.
pub fn febio(model: &Model) -> Result<String, Vec<Fault>> {
    refuse_what_no_scene_has(model)?;
    let materials = materials(model, "FEBio", LAWS, |_| true)?;
    let cards: Vec<String> = materials.iter().map(description).collect();
    let lost = [
        "bending stiffness of the leaflets; the shells have that of their thickness and law",
        "contact as it is here; sliding-elastic between leaflets instead, none of a leaflet with itself",
        "forces of chordae beyond a strain of 10",
    ];
    let mut text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!--\n".to_owned();
    for line in heading(model, "FEBio 4 (format 4.0), not run by us", &cards, &lost) {
        put(&mut text, format_args!("{}", line.replace("->", "as")));
    }
    put(
        &mut text,
        format_args!("-->\n<febio_spec version=\"4.0\">\n<Module type=\"solid\"/>"),
    );
    let insertions = insertions(model);
    put_materials(&mut text, model, &materials);
    put_mesh(&mut text, model, &insertions);
    put_supports(&mut text, model, &insertions);
    put_loads(&mut text, model);
    put_chordae(&mut text, model);
    put_run(&mut text);
    Ok(text)
}

fn put_supports(text: &mut String, model: &Model, insertions: &[usize]) {
    put(text, format_args!("<Boundary>"));
    for fixed in &model.prescribed {
        put_support(text, model, fixed);
    }
    for (vertices, &node) in model.chords.points.iter().zip(insertions) {
        if node <= model.rest_mm.len() {
            continue;
        }
        for axis in ["x", "y", "z"] {
            put(
                text,
                format_args!("<bc type=\"linear constraint\"><node>{node}</node><dof>{axis}</dof>"),
            );
            for (vertex, weight) in vertices {
                let vertex = vertex + 1;
                put(
                    text,
                    format_args!(
                        "<child_dof><node>{vertex}</node><dof>{axis}</dof><value>{weight:?}</value></child_dof>"
                    ),
                );
            }
            put(text, format_args!("</bc>"));
        }
    }
    put(text, format_args!("</Boundary>"));
}

fn put_support(text: &mut String, model: &Model, fixed: &Prescribed) {
    let node = fixed.vertex + 1;
    let way = fixed.target_mm - model.rest_mm[fixed.vertex as usize];
    for (axis, way) in ["x", "y", "z"].into_iter().zip(way.iter()) {
        put(
            text,
            format_args!(
                "<bc node_set=\"node{node}\" type=\"prescribed displacement\"><dof>{axis}</dof>\
                 <value lc=\"1\">{way:?}</value><relative>0</relative></bc>"
            ),
        );
    }
}

fn put_loads(text: &mut String, model: &Model) {
    put(text, format_args!("<Loads>"));
    for leaflet in 1..=model.leaflets.len() {
        let pressure = -model.pressure_mpa;
        put(
            text,
            format_args!(
                "<surface_load surface=\"surface{leaflet}\" type=\"pressure\"><pressure lc=\"1\">{pressure:?}</pressure>\
                 <linear>0</linear><symmetric_stiffness>0</symmetric_stiffness></surface_load>"
            ),
        );
    }
    put(text, format_args!("</Loads>"));
    let pairs = pairs(model);
    if pairs.is_empty() {
        return;
    }
    put(text, format_args!("<Contact>"));
    for (one, other) in pairs {
        put(
            text,
            format_args!(
                "<contact name=\"contact{one}_{other}\" surface_pair=\"pair{one}_{other}\" type=\"sliding-elastic\">\
                 <laugon>PENALTY</laugon><penalty>1</penalty><auto_penalty>1</auto_penalty><two_pass>1</two_pass>\
                 <symmetric_stiffness>0</symmetric_stiffness><fric_coeff>0</fric_coeff></contact>"
            ),
        );
    }
    put(text, format_args!("</Contact>"));
}

fn put_chordae(text: &mut String, model: &Model) {
    let count = model.chords.ends.len();
    if count == 0 {
        return;
    }
    put(text, format_args!("<Discrete>"));
    for segment in 0..count {
        let name = segment + 1;
        put(
            text,
            format_args!(
                "<discrete_material id=\"{name}\" name=\"chord{name}\" type=\"nonlinear spring\"><scale>1</scale>\
                 <measure>elongation</measure><force type=\"point\"><interpolate>linear</interpolate><points>"
            ),
        );
        for [elongation, force] in chord_curve(model, segment) {
            put(text, format_args!("<pt>{elongation:?},{force:?}</pt>"));
        }
        put(text, format_args!("</points></force></discrete_material>"));
    }
    for name in 1..=count {
        put(
            text,
            format_args!("<discrete dmat=\"{name}\" discrete_set=\"chord{name}\"/>"),
        );
    }
    put(text, format_args!("</Discrete>"));
}

fn put_run(text: &mut String) {
    put(text, format_args!("<Step>"));
    // Pressure on a free margin and contact make the tangent unsymmetric.
    for (step, analysis) in [(1, "DYNAMIC"), (2, "STATIC")] {
        put(
            text,
            format_args!(
                "<step id=\"{step}\" name=\"step{step}\"><Control><analysis>{analysis}</analysis>\
                 <time_steps>100</time_steps><step_size>0.01</step_size>\n<time_stepper type=\"default\">\
                 <max_retries>20</max_retries><opt_iter>15</opt_iter><dtmin>1e-6</dtmin><dtmax>0.05</dtmax></time_stepper>\n\
                 <solver type=\"solid\"><symmetric_stiffness>non-symmetric</symmetric_stiffness><rhoi>0</rhoi>\
                 <max_refs>25</max_refs><dtol>0.001</dtol><etol>0.01</etol><rtol>0</rtol><lstol>0.9</lstol>\
                 <qn_method type=\"BFGS\"><max_ups>0</max_ups></qn_method></solver></Control></step>"
            ),
        );
    }
    put(
        text,
        format_args!(
            "</Step>\n<LoadData>\n<load_controller id=\"1\" type=\"loadcurve\"><interpolate>LINEAR</interpolate>\
             <extend>CONSTANT</extend><points><pt>0,0</pt><pt>1,1</pt><pt>{END_TIME},1</pt></points></load_controller>\n\
             </LoadData>\n<Output>\n<plotfile type=\"febio\"><var type=\"displacement\"/><var type=\"stress\"/></plotfile>\n\
             <logfile><node_data data=\"x;y;z\" file=\"{LOG}\" delim=\",\"></node_data></logfile>\n</Output>\n\
             </febio_spec>"
        ),
    );
}

//! A model as input of CalculiX 2.20.
//!
//! Its own thin elements do not serve: M3D3 under a pressure did not move, and S3, made into wedges that share their nodes,
//! resists folds between faces however thin it is (up to 1.5 % of the displacements of a dome of 216 faces). So each face becomes
//! a wedge of its own (C3D6) that is held affine by equations: with a vector a per face, its director, the bottom and top
//! node at vertex v move by u(v) ∓ a / 2. Then the deformation gradient in the wedge is constant: in the plane that of
//! our triangle, across it what the law makes of it. That is a membrane of constant strain in plane stress, whatever its
//! thickness: nothing bends and nothing locks. Half the pressure acts on either side, which sums to the pressure on the
//! middle.
//!
//! A membrane without tension has no stiffness, so a static first step fails. The load therefore comes on in a
//! dynamic step with numerical damping, and static steps then find the balance.
//!
//! Compared was a valve that inflates and touches nothing (`tests/it/calculix.rs`). A whole one that closes is another matter:
//! the healthy preset of 650 faces came through the dynamic step, but folds that nothing holds apart kept the static steps
//! from converging.
//!
//! CalculiX reads twenty characters of a number: thirteen digits of ours.

mod chordae;
mod mesh;
mod tissue;

use coapt::Vec3;
use coapt::model::Model;
use coapt::scene::Fault;

pub(super) use mesh::Numbering;

use super::material::materials;
use super::{heading, put, refuse_what_no_scene_has};
use chordae::{put_chordae, put_masses};
use mesh::{put_nodes, put_wedges};
use tissue::{LAWS, card, description, put_materials};

/// When the last step ends [s].
pub(super) const END_TIME: f64 = 3.0;

/// The input file of a model.
///
/// # Errors
/// A leaflet whose law CalculiX does not have, dead loads, or sutures.
pub fn calculix(model: &Model) -> Result<String, Vec<Fault>> {
    refuse_what_no_scene_has(model)?;
    let materials = materials(model, "CalculiX", LAWS, |material| card(material).is_some())?;
    let cards: Vec<String> = materials.iter().map(description).collect();
    let lost = [
        "contact; compare only where nothing touches",
        "bending stiffness of the leaflets",
        "forces of chordae beyond a strain of 10",
    ];
    let mut text = String::new();
    for line in heading(model, "CalculiX 2.20", &cards, &lost) {
        put(&mut text, format_args!("** {line}"));
    }
    let numbering = Numbering::of(model);
    put_nodes(&mut text, model, numbering);
    put_wedges(&mut text, model, numbering);
    put_materials(&mut text, model, &materials);
    put_chordae(&mut text, model, numbering);
    put_masses(&mut text, model);
    put_steps(&mut text, model);
    Ok(text)
}

/// Increments are short: in longer ones, of 0.05 s, CalculiX ended without a word for nearly incompressible tissue.
fn put_steps(text: &mut String, model: &Model) {
    put(
        text,
        format_args!(
            "*STEP, NLGEOM, INC=10000, AMPLITUDE=RAMP\n*DYNAMIC, ALPHA=-0.3333\n0.001, 1., 1e-7, 0.02"
        ),
    );
    put(text, format_args!("*BOUNDARY"));
    for fixed in &model.prescribed {
        let way = fixed.target_mm - model.rest_mm[fixed.vertex as usize];
        for (axis, way) in way.iter().enumerate() {
            let (node, axis) = (fixed.vertex + 1, axis + 1);
            put(text, format_args!("{node}, {axis}, {axis}, {}", number(*way)));
        }
    }
    put_pressure(text, model);
    put(text, format_args!("*END STEP"));
    // CalculiX leaves a static step as soon as the residual is small, with corrections of a per cent to come (4e-4 of the
    // displacements): the second step goes on.
    for print in [
        "",
        "*NODE PRINT, NSET=VERTICES, FREQUENCY=100000\nU\n*NODE FILE, FREQUENCY=100000\nU\n",
    ] {
        put(
            text,
            format_args!(
                "*STEP, NLGEOM, INC=10000\n*CONTROLS, PARAMETERS=FIELD\n1e-6, 1e-4\n*STATIC\n1., 1."
            ),
        );
        put_pressure(text, model);
        put(text, format_args!("{print}*END STEP"));
    }
}

/// On the lower side into the wedge, on the upper side out of it, half each.
fn put_pressure(text: &mut String, model: &Model) {
    let half = 0.5 * model.pressure_mpa;
    put(text, format_args!("*DLOAD"));
    for leaflet in 1..=model.leaflets.len() {
        put(text, format_args!("LEAFLET{leaflet}, P1, {}", number(half)));
        put(text, format_args!("LEAFLET{leaflet}, P2, {}", number(-half)));
    }
}

fn put_node(text: &mut String, node: usize, point: Vec3) {
    let [x, y, z] = [point.x, point.y, point.z].map(number);
    put(text, format_args!("{node}, {x}, {y}, {z}"));
}

/// Never more than twenty characters.
fn number(value: f64) -> String {
    format!("{value:.12e}")
}

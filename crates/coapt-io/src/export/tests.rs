use coapt::mesh::parametric::{Preset, ValveParameters, generate};
use coapt::model::ChordKind;
use coapt::scene::{ChordLaw, Scene, Tissue, Wrinkling};
use quick_xml::events::Event;

use super::*;

/// Branching chordae, insertions shared by vertices, and tips that move.
fn scene(tissue: Tissue) -> Scene {
    let parameters = ValveParameters {
        face_count_target: 300,
        ..ValveParameters::preset(Preset::Restricted)
    };
    let mut scene = generate(&parameters).unwrap();
    for muscle in &mut scene.papillary {
        muscle.displacements_mm = vec![[0.5, -1.0, 2.0]; muscle.tips_mm.len()];
    }
    scene
        .leaflets
        .iter_mut()
        .for_each(|leaflet| leaflet.tissue = tissue);
    scene
}

fn model(tissue: Tissue) -> Model {
    Model::build(&scene(tissue)).unwrap().model
}

fn st_venant_kirchhoff(wrinkling: Wrinkling) -> Tissue {
    Tissue::StVenantKirchhoff {
        modulus_mpa: 0.4,
        poisson_ratio: 0.5,
        wrinkling,
        bending_modulus_mpa: 0.48,
    }
}

fn exponential(c1_mpa: f64) -> Tissue {
    Tissue::Exponential {
        c0_mpa: 0.02,
        c1_mpa,
        c2: 5.0,
        compressibility_per_mpa: 0.0,
        wrinkling: Wrinkling::Resolved,
        bending_modulus_mpa: 0.0,
    }
}

/// The data lines below each card of that beginning, split at commas.
fn below<'a>(text: &'a str, card: &str) -> Vec<Vec<&'a str>> {
    let mut rows = Vec::new();
    let mut inside = false;
    for line in text.lines().filter(|line| !line.starts_with("**")) {
        if line.starts_with('*') {
            inside = line.starts_with(card);
        } else if inside {
            rows.push(line.split(',').map(str::trim).collect());
        }
    }
    rows
}

fn number(word: &str) -> f64 {
    word.parse().unwrap()
}

/// Nodes of the .inp by number.
fn nodes(text: &str) -> Vec<(usize, Vec3)> {
    let rows = below(text, "*NODE, NSET");
    rows.iter()
        .map(|row| {
            (
                row[0].parse().unwrap(),
                Vec3::new(number(row[1]), number(row[2]), number(row[3])),
            )
        })
        .collect()
}

fn shared_points(model: &Model) -> usize {
    model
        .chords
        .points
        .iter()
        .filter(|vertices| vertices.len() > 1)
        .count()
}

/// Thirteen digits of coordinates below 100 mm are off by up to 5e-12 each; a few add up.
const ROUNDING_MM: f64 = 5e-11;

#[test]
fn wedges_stand_around_the_faces_of_the_model() {
    let model = model(st_venant_kirchhoff(Wrinkling::Resolved));
    let text = calculix(&model).unwrap();
    let nodes = nodes(&text);
    let (vertices, faces) = (model.rest_mm.len(), model.faces.len());
    assert!(shared_points(&model) > 10);
    assert_eq!(nodes.len(), vertices + 7 * faces + shared_points(&model));
    // Numbered without gaps, each once.
    assert!(
        nodes
            .iter()
            .enumerate()
            .all(|(index, (node, _))| *node == index + 1)
    );
    let at = |node: &str| nodes[node.parse::<usize>().unwrap() - 1].1;
    for (open, (_, node)) in model.rest_mm.iter().zip(&nodes) {
        assert!((open - node).norm() < ROUNDING_MM);
    }
    let wedges = below(&text, "*ELEMENT, TYPE=C3D6");
    assert_eq!(wedges.len(), faces);
    for wedge in &wedges {
        let face = model.faces[wedge[0].parse::<usize>().unwrap() - 1];
        let leaflet = &model.leaflets[model.face_leaflet[wedge[0].parse::<usize>().unwrap() - 1] as usize];
        let corners = face.map(|vertex| model.rest_mm[vertex as usize]);
        let normal = (corners[1] - corners[0])
            .cross(&(corners[2] - corners[0]))
            .normalize();
        for (corner, open) in corners.iter().enumerate() {
            let (bottom, top) = (at(wedge[1 + corner]), at(wedge[4 + corner]));
            assert!(((bottom + top) / 2.0 - open).norm() < ROUNDING_MM);
            assert!((top - bottom - normal * leaflet.thickness_mm).norm() < ROUNDING_MM);
        }
    }
}

/// A rigid motion of vertices, with the directors at rest, fulfils every equation; six for each corner and axis, besides
/// three for each shared insertion.
#[test]
fn equations_let_everything_move_together() {
    let model = model(st_venant_kirchhoff(Wrinkling::Resolved));
    let text = calculix(&model).unwrap();
    let (vertices, faces) = (model.rest_mm.len(), model.faces.len());
    let rows = below(&text, "*EQUATION");
    let mut rows = rows.iter();
    let mut count = 0;
    while let Some(head) = rows.next() {
        let mut terms: usize = head[0].parse().unwrap();
        let mut sum = 0.0;
        while terms > 0 {
            for term in rows.next().unwrap().chunks(3) {
                let node: usize = term[0].parse().unwrap();
                let director = (vertices + 1..=vertices + faces).contains(&node);
                sum += if director { 0.0 } else { number(term[2]) };
                terms -= 1;
            }
        }
        assert!(f64::abs(sum) < 1e-12, "{sum:e}");
        count += 1;
    }
    assert_eq!(count, 18 * faces + 3 * shared_points(&model));
}

#[test]
fn supports_and_pressure_are_those_of_the_model() {
    let model = model(st_venant_kirchhoff(Wrinkling::Resolved));
    let text = calculix(&model).unwrap();
    let held = below(&text, "*BOUNDARY");
    assert_eq!(held.len(), 3 * model.prescribed.len());
    for (index, row) in held.iter().enumerate() {
        let fixed = &model.prescribed[index / 3];
        let way = fixed.target_mm - model.rest_mm[fixed.vertex as usize];
        assert_eq!(row[0].parse::<u32>().unwrap(), fixed.vertex + 1);
        assert_eq!((row[1], row[2]), (row[2], row[1]));
        assert_eq!(row[1].parse::<usize>().unwrap(), index % 3 + 1);
        assert!((number(row[3]) - way[index % 3]).abs() < 1e-11);
    }
    assert!(
        held.iter().any(|row| number(row[3]).abs() > 0.1),
        "some support moves"
    );
    // Three steps, two leaflets, two sides.
    let loads = below(&text, "*DLOAD");
    assert_eq!(loads.len(), 12);
    for load in loads {
        let sign = if load[1] == "P1" { 0.5 } else { -0.5 };
        assert!((number(load[2]) - sign * model.pressure_mpa).abs() < 1e-12 * model.pressure_mpa);
    }
}

/// CalculiX reads twenty characters of a number, and lines of 1320.
#[test]
fn no_field_is_longer_than_calculix_reads() {
    let text = calculix(&model(st_venant_kirchhoff(Wrinkling::Resolved))).unwrap();
    for line in text.lines().filter(|line| !line.starts_with('*')) {
        assert!(line.split(',').all(|field| field.trim().len() <= 20), "{line}");
    }
    assert!(text.is_ascii() && text.lines().all(|line| line.len() < 1320));
}

#[test]
fn springs_pull_as_chordae_of_every_law() {
    let laws = [
        ChordLaw::Linear { modulus_mpa: 30.0 },
        ChordLaw::PiecewiseLinear {
            toe_modulus_mpa: 3.0,
            transition_strain: 0.025,
            modulus_mpa: 33.0,
        },
        ChordLaw::Exponential {
            scale_mpa: 0.1,
            exponent: 30.0,
        },
        ChordLaw::Collagen {
            scale_mpa: 4.6434e-4,
            exponent: 49.9643,
            full_recruitment_strain: 0.145,
            modulus_mpa: 32.5,
        },
        ChordLaw::Table {
            strain: vec![0.0, 0.02, 0.05],
            stress_mpa: vec![0.0, 0.1, 2.0],
        },
    ];
    for law in laws {
        let mut scene = scene(exponential(0.0));
        scene
            .chordae
            .iter_mut()
            .for_each(|group| (group.modulus_mpa, group.law) = (None, Some(law.clone())));
        let model = Model::build(&scene).unwrap().model;
        let text = calculix(&model).unwrap();
        assert_eq!(
            below(&text, "*ELEMENT, TYPE=SPRINGA").len(),
            model.chords.ends.len()
        );
        let curve = material::chord_curve(&model, 0);
        assert!(curve.windows(2).all(|pair| pair[0][0] < pair[1][0]), "{law:?}");
        let [from, to] = model.chords.ends[0].map(|point| model.chords.point_mm(point, &model.rest_mm));
        let open_mm = (to - from).norm();
        for strain in [-0.5, 0.0, 0.01, 0.03, 0.1, 0.2, 0.6] {
            let elongation = model.chords.rest_length_mm[0] * (1.0 + strain) - open_mm;
            let stress = coapt::energy::chord_law::response(&law, strain).stress_mpa;
            let force = model.chords.area_mm2[0] * stress;
            // The bend of a piece of a curved law: (15 / 300)² / 8.
            let found = interpolated(&curve, elongation);
            assert!(
                (found - force).abs() <= 3.2e-4 * force + 1e-12,
                "{law:?} at {strain}: {found} for {force}"
            );
        }
    }
}

fn interpolated(curve: &[[f64; 2]], at: f64) -> f64 {
    let pair = curve.windows(2).find(|pair| at <= pair[1][0]).unwrap();
    let share = (at - pair[0][0]) / (pair[1][0] - pair[0][0]);
    pair[0][1] + share * (pair[1][1] - pair[0][1])
}

/// Texts of all elements of that name, in order.
fn texts(xml: &str, name: &str) -> Vec<String> {
    let mut reader = quick_xml::Reader::from_str(xml);
    let mut found = Vec::new();
    let mut inside = false;
    loop {
        match reader.read_event().unwrap() {
            Event::Start(tag) if tag.name().as_ref() == name => {
                found.push(String::new());
                inside = true;
            }
            Event::End(tag) if tag.name().as_ref() == name => inside = false,
            Event::Text(text) if inside => found.last_mut().unwrap().push_str(&text),
            Event::Eof => return found,
            _ => {}
        }
    }
}

#[test]
fn the_feb_holds_the_model_to_the_last_bit() {
    let model = model(exponential(0.001));
    let xml = febio(&model).unwrap();
    let nodes = texts(&xml, "node");
    let shared = shared_points(&model);
    // Nodes, and three constraints for each insertion with its children.
    assert!(nodes.len() > model.rest_mm.len() + shared);
    for (open, text) in model.rest_mm.iter().zip(&nodes) {
        let values: Vec<f64> = text.split(',').map(number).collect();
        assert_eq!(values, open.as_slice());
    }
    let faces: Vec<String> = model
        .faces
        .iter()
        .map(|face| face.map(|vertex| (vertex + 1).to_string()).join(","))
        .collect();
    let mut elements = texts(&xml, "elem");
    elements.sort_unstable();
    let mut sorted = faces.clone();
    sorted.sort_unstable();
    assert_eq!(elements, sorted);
    assert_eq!(texts(&xml, "tri3").len(), faces.len());
    assert_eq!(texts(&xml, "NodeSet").len(), model.prescribed.len());
    assert_eq!(texts(&xml, "relative").len(), 3 * model.prescribed.len());
    assert_eq!(texts(&xml, "DiscreteSet").len(), model.chords.ends.len());
    assert_eq!(texts(&xml, "discrete_material").len(), model.chords.ends.len());
    let pressures = texts(&xml, "pressure");
    assert_eq!(pressures.len(), model.leaflets.len());
    assert!(
        pressures
            .iter()
            .all(|pressure| number(pressure) == -model.pressure_mpa)
    );
    let thickness: Vec<f64> = texts(&xml, "shell_thickness")
        .iter()
        .map(|text| number(text))
        .collect();
    assert_eq!(
        thickness,
        model
            .leaflets
            .iter()
            .map(|leaflet| leaflet.thickness_mm)
            .collect::<Vec<_>>()
    );
    assert_eq!(texts(&xml, "contact").len(), 1);
    assert_eq!(texts(&xml, "c1"), ["0.001", "0.001"]);
}

#[test]
fn each_file_says_what_became_of_the_laws() {
    let model = model(st_venant_kirchhoff(Wrinkling::Resolved));
    for text in [calculix(&model).unwrap(), febio(&model).unwrap()] {
        for word in [
            concat!("made by coapt ", env!("CARGO_PKG_VERSION")),
            "units: mm, N, MPa",
            "leaflet anterior: st-venant-kirchhoff",
            "leaflet posterior: st-venant-kirchhoff",
            "not carried over: bending stiffness of the leaflets",
        ] {
            assert!(text.contains(word), "{word}");
        }
    }
    assert!(febio(&model).unwrap().contains("not run by us"));
}

#[test]
fn names_cannot_break_a_comment() {
    let mut model = model(st_venant_kirchhoff(Wrinkling::Resolved));
    model.name = "--> <a>\n*STEP\n\u{e9}".into();
    let text = calculix(&model).unwrap();
    assert!(
        text.starts_with("** __> <a>_*STEP__ for CalculiX"),
        "{}",
        &text[..60]
    );
    assert_eq!(texts(&febio(&model).unwrap(), "shell_thickness").len(), 2);
}

#[test]
fn equal_models_give_equal_bytes() {
    let tissue = exponential(0.0);
    assert_eq!(calculix(&model(tissue)), calculix(&model(tissue)));
    assert_eq!(febio(&model(tissue)), febio(&model(tissue)));
}

#[test]
fn a_law_without_an_equal_is_refused_by_name() {
    let may_newman = Tissue::MayNewman {
        c0_mpa: 4e-4,
        c1: 4.3,
        c2: 1446.0,
        wrinkling: Wrinkling::Resolved,
        bending_modulus_mpa: 0.0,
    };
    for (tissue, law, elsewhere) in [
        (Tissue::default(), "bilinear-springs", false),
        (may_newman, "may-newman", false),
        (
            st_venant_kirchhoff(Wrinkling::TensionField),
            "wrinkling = tension-field",
            false,
        ),
        (exponential(0.001), "exponential with c1_mpa above 0", true),
    ] {
        let model = model(tissue);
        let refused = |faults: Vec<Fault>| {
            assert_eq!(faults.len(), 2, "{faults:?}");
            assert_eq!(faults[1].place, "leaflets[1].tissue");
            let message = &faults[1].message;
            assert!(message.contains("leaflet `posterior` is made of"), "{message}");
            assert!(
                message.contains(law) && message.contains("expected one of st-venant-kirchhoff"),
                "{message}"
            );
        };
        refused(calculix(&model).unwrap_err());
        match elsewhere {
            true => assert!(febio(&model).is_ok()),
            false => refused(febio(&model).unwrap_err()),
        }
    }
}

#[test]
fn dead_loads_and_sutures_are_refused_and_contact_that_is_off_is_left_out() {
    let mut model = model(st_venant_kirchhoff(Wrinkling::Resolved));
    model.contact.stiffness_mpa = 0.0;
    let xml = febio(&model).unwrap();
    assert_eq!(
        (texts(&xml, "contact").len(), texts(&xml, "SurfacePair").len()),
        (0, 0)
    );
    model.dead_loads_n.push((0, Vec3::new(0.0, 0.0, 1.0)));
    for refused in [calculix(&model), febio(&model)] {
        let faults = refused.unwrap_err();
        assert_eq!(
            faults[0].message,
            "1 forces on vertices are not exported; expected none"
        );
    }
    model.dead_loads_n.clear();
    model.chord_groups[0].kind = ChordKind::Suture;
    for refused in [calculix(&model), febio(&model)] {
        let faults = refused.unwrap_err();
        assert!(
            faults[0]
                .message
                .contains("are not exported; expected a valve that is not sewn"),
            "{faults:?}"
        );
    }
}

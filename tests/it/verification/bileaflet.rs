//! The closure of two leaflets in the plane, which has an answer on paper. Hinges stand at ±a; a leaflet of length S hangs
//! from each, and a vertical chord holds its free edge at the depth D. Under pressure from below a leaflet is an arc of a
//! circle of radius R with tension T = p R, then a straight strip on the other one, on which the pressure of contact is p:
//!
//! ```text
//! the arc ends upright at x = 0     depth y = √(2 R a − a²), angle θ = atan2(y, R − a)
//! its length, stretched by T        S (1 + p R / E'h) = R θ + c,  c the coaptation length
//! the edge's depth                  D = y + c
//! balance with the annulus          both chords together pull with 2 p R per depth
//! ```
//!
//! Where no c ≥ 0 fits, the valve stays open: an arc that ends upright at the depth D, and short of the middle by half the
//! gap g: R sin θ = D, R θ = S (1 + p R / E'h), R (1 − cos θ) = a − g/2; the chords pull with 2 p R as well.
//!
//! Mid-surfaces in contact stand apart, which the paper does not know: hinges are moved outwards by half of that.

use std::f64::consts::PI;

use coapt::Vec3;
use coapt::contact::gather::PairList;
use coapt::contact::pairs::{Place, rigid_fraction};
use coapt::contact::penalty;
use coapt::contact::surface::Surface;
use coapt::contact::touch::touches;
use coapt::energy::bilinear_spring::Springs;
use coapt::measure::{Measures, measure};
use coapt::model::{LeafletTissue, Margin, Model, Prescribed};
use coapt::scene::{ChordLaw, Contact, Tissue};

use super::references::root;
use super::shapes::{Mesh, add_spring, bare};
use super::{error, oracle, report, settled};

const PRESSURE_MPA: f64 = 0.016;
/// Small, so that the leaflets are nearly as thin as on paper.
const THICKNESS_MM: f64 = 0.1;
/// Half the distance of mid-surfaces at rest: under this pressure 0.9 of the contact thickness lies between them.
const ASIDE_MM: f64 = 0.45 * THICKNESS_MM;
const HALF_WIDTH_MM: f64 = 2.0;
/// Rows of each leaflet: two numbers, so that vertices do not come to face each other.
const ROWS: [u32; 2] = [60, 63];
/// Chords so long that they stay upright, so stiff that they do not give.
const CHORD_MM: f64 = 1000.0;
const CHORD_MPA: f64 = 1e7;
/// p / (E'h) that stands for tissue that does not stretch [1/mm].
const STIFF: f64 = 1e-5;

#[derive(Clone, Copy, Debug)]
struct Valve {
    half_orifice_mm: f64,
    length_mm: f64,
    depth_mm: f64,
    /// p / (E'h) [1/mm].
    softness: f64,
}

/// Nine valves that close and one whose leaflets do not meet.
const VALVES: [[f64; 4]; 10] = [
    [10.0, 22.0, 12.0, 0.0],
    [10.0, 22.0, 15.0, 0.0],
    [10.0, 20.0, 12.0, 0.0],
    [10.0, 20.0, 8.0, 0.0],
    [15.0, 26.0, 14.0, 0.0],
    [15.0, 26.0, 18.0, 0.0],
    [15.0, 30.0, 20.0, 0.0],
    [10.0, 20.0, 12.0, 0.001],
    [10.0, 20.0, 12.0, 0.01],
    [10.0, 18.0, 14.0, 0.0],
];

fn valve([half_orifice_mm, length_mm, depth_mm, softness]: [f64; 4]) -> Valve {
    Valve {
        half_orifice_mm,
        length_mm,
        depth_mm,
        softness,
    }
}

/// Radius of the arc and coaptation length, which is negative where the leaflets do not meet [mm].
///
/// D − y − c over R begins negative at R = a/2, where the arc is a half circle, or comes back to no root at all.
fn closed(valve: &Valve) -> (f64, f64) {
    let (a, s) = (valve.half_orifice_mm, valve.length_mm);
    let arc = |r: f64| {
        let depth = (2.0 * r * a - a * a).max(0.0).sqrt();
        [depth, r * depth.atan2(r - a)]
    };
    let contact = |r: f64| s * (1.0 + valve.softness * r) - arc(r)[1];
    let off = |r: f64| arc(r)[0] + contact(r) - valve.depth_mm;
    let mut low = 0.5 * a;
    while (off(low) < 0.0) == (off(1.001 * low) < 0.0) {
        low *= 1.001;
    }
    let radius = root(off, low, 1.001 * low);
    (radius, contact(radius))
}

/// Radius of the arc and gap of a valve that stays open [mm].
fn open(valve: &Valve) -> (f64, f64) {
    let radius_at = |angle: f64| valve.depth_mm / angle.sin();
    let off = |angle: f64| {
        let r = radius_at(angle);
        valve.length_mm * (1.0 + valve.softness * r) - r * angle
    };
    let angle = root(off, 0.1, 0.5 * PI);
    let radius = radius_at(angle);
    (
        radius,
        2.0 * (valve.half_orifice_mm - radius * (1.0 - angle.cos())),
    )
}

#[test]
fn roots_are_the_oracles() {
    let Some(values) = oracle("reference_values.json") else {
        return;
    };
    let rows = values["bileaflet_2d"]["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), VALVES.len());
    for row in rows {
        let number = |key: &str| row[key].as_f64().expect("a number");
        let given = ["a", "S", "D", "p_over_Eh"].map(number);
        assert!(VALVES.contains(&given), "{given:?}");
        let (radius, contact) = closed(&valve(given));
        assert!(
            error(radius, number("R")) < 1e-12 && error(contact, number("coapt_length")) < 1e-11,
            "{row}"
        );
    }
}

/// Two strips that hang straight down from their hinges, three columns of vertices each. Springs along the arc share the
/// width as 1 : 2 : 1, as pressure does, so that E' is E; ribs and diagonals of a fiftieth of that keep the strips straight.
fn strips(valve: &Valve) -> Model {
    let (mut mesh, mut springs) = (Mesh::default(), Springs::default());
    let mut firsts = Vec::new();
    for (side, rows) in [1.0, -1.0].into_iter().zip(ROWS) {
        firsts.push((mesh.points_mm.len() as u32, mesh.faces.len()));
        add_strip(&mut mesh, &mut springs, valve, side, rows);
    }
    let (second, half) = firsts[1];
    let count = mesh.points_mm.len() as u32;
    let mut model = bare(&mesh, PRESSURE_MPA);
    model.springs = springs;
    model.face_leaflet = (0..mesh.faces.len())
        .map(|face| u32::from(face >= half))
        .collect();
    let leaflet = |name: &str| LeafletTissue {
        name: name.into(),
        thickness_mm: THICKNESS_MM,
        tissue: Tissue::default(),
    };
    model.leaflets = vec![leaflet("right"), leaflet("left")];
    model.contact = Contact {
        thickness_mm: THICKNESS_MM,
        ..Contact::default()
    };
    model.annulus = vec![0, 1, 2, second + 2, second + 1, second];
    model.landmarks.commissure_posteromedial = 3;
    let margin = |end: u32| Margin {
        vertices: (end - 3..end).collect(),
        closed: false,
    };
    model.margins = vec![margin(second), margin(count)];
    let mut held = model.annulus.clone();
    for edge in [second - 3..second, count - 3..count].into_iter().flatten() {
        held.push(add_chord(&mut model, edge, valve));
    }
    held.sort_unstable();
    let hold = |&vertex: &u32| Prescribed {
        vertex,
        target_mm: model.rest_mm[vertex as usize],
    };
    model.prescribed = held.iter().map(hold).collect();
    model
}

fn add_strip(mesh: &mut Mesh, springs: &mut Springs, valve: &Valve, side: f64, rows: u32) {
    let first = mesh.points_mm.len() as u32;
    let at = |row: u32, column: u32| first + 3 * row + column;
    let edge_mm = valve.length_mm / f64::from(rows);
    let x = side * (valve.half_orifice_mm + ASIDE_MM);
    let along = PRESSURE_MPA / valve.softness * HALF_WIDTH_MM / edge_mm;
    for row in 0..=rows {
        let across = [-HALF_WIDTH_MM, 0.0, HALF_WIDTH_MM];
        mesh.points_mm
            .extend(across.map(|y| Vec3::new(x, y, -edge_mm * f64::from(row))));
        for column in [0, 2] {
            add_spring(
                springs,
                [at(row, 1), at(row, column)],
                HALF_WIDTH_MM,
                0.02 * along,
            );
        }
    }
    for row in 0..rows {
        for (column, share) in [(0, 0.5), (1, 1.0), (2, 0.5)] {
            add_spring(
                springs,
                [at(row, column), at(row + 1, column)],
                edge_mm,
                share * along,
            );
        }
        let mut faces = [
            [at(row, 0), at(row + 1, 0), at(row + 1, 1)],
            [at(row, 0), at(row + 1, 1), at(row, 1)],
            [at(row, 2), at(row + 1, 1), at(row + 1, 2)],
            [at(row, 2), at(row, 1), at(row + 1, 1)],
        ];
        for column in [0, 2] {
            let diagonal_mm = edge_mm.hypot(HALF_WIDTH_MM);
            add_spring(
                springs,
                [at(row, column), at(row + 1, 1)],
                diagonal_mm,
                0.02 * along,
            );
        }
        // Normals to the atrium: inwards while the leaflets hang.
        if side > 0.0 {
            faces.iter_mut().for_each(|face| face.swap(1, 2));
        }
        mesh.faces.extend(faces);
    }
}

/// Hangs an edge vertex on a chord; returns the chord's tip, far below.
fn add_chord(model: &mut Model, edge: u32, valve: &Valve) -> u32 {
    let tip = model.rest_mm.len() as u32;
    let at = model.rest_mm[edge as usize];
    model.rest_mm.push(Vec3::new(
        ASIDE_MM.copysign(at.x),
        at.y,
        -valve.depth_mm - CHORD_MM,
    ));
    let point = model.chords.points.len() as u32;
    model.chords.points.extend([vec![(tip, 1.0)], vec![(edge, 1.0)]]);
    model.chords.ends.push([point, point + 1]);
    model.chords.rest_length_mm.push(CHORD_MM);
    model.chords.area_mm2.push(1.0);
    model.chords.group.push(0);
    if model.chord_groups.is_empty() {
        model.chord_groups.push("margin".into());
        model.chords.laws.push(ChordLaw::Linear {
            modulus_mpa: CHORD_MPA,
        });
    }
    tip
}

/// What the test reads off a closed valve.
struct Found {
    /// Force of all chords per depth over 2 p: the radius of the arc [mm].
    radius_mm: f64,
    /// Force between the leaflets per depth over p: the coaptation length [mm].
    contact_mm: f64,
    measures: Measures,
    /// Mean edge length [mm], which the measures' tolerance goes with.
    edge_mm: f64,
}

fn closure(given: &Valve) -> Found {
    let valve = Valve {
        softness: given.softness.max(STIFF),
        ..*given
    };
    let model = strips(&valve);
    let equilibrium = settled(&format!("{valve:?}"), &model, model.rest_mm.clone());
    assert!(
        equilibrium.certificate.is_certified(equilibrium.status),
        "{valve:?}"
    );
    let positions = &equilibrium.state.positions_mm;
    let per_depth = 1.0 / (2.0 * HALF_WIDTH_MM * PRESSURE_MPA);
    let lengths = &model.springs.rest_length_mm;
    Found {
        radius_mm: 0.5 * per_depth * model.chords.tensions_n(positions).iter().sum::<f64>(),
        contact_mm: per_depth * contact_force_n(&model, positions),
        measures: measure(&model, positions, &equilibrium.reactions_n),
        edge_mm: lengths.iter().sum::<f64>() / lengths.len() as f64,
    }
}

/// Force with which contact pushes the right leaflet to the right [N].
fn contact_force_n(model: &Model, positions_mm: &[Vec3]) -> f64 {
    let Contact {
        thickness_mm,
        stiffness_mpa,
    } = model.contact;
    let surface = Surface::new(&model.faces, &model.rest_mm);
    let place = Place {
        surface: &surface,
        rest_mm: &model.rest_mm,
        positions_mm,
        thickness_mm,
        rigid_fraction: rigid_fraction(&surface, thickness_mm),
    };
    let still = vec![Vec3::zeros(); positions_mm.len()];
    let (mut pairs, mut gradient) = (Vec::new(), still.clone());
    PairList::default().gather(&place, &still, &mut pairs);
    penalty::add_gradient(
        &touches(&pairs, positions_mm),
        stiffness_mpa,
        positions_mm,
        &mut gradient,
    );
    gradient[..3 * (ROWS[0] as usize + 1)]
        .iter()
        .map(|force| -force.x)
        .sum()
}

/// Chord force and coaptation length, as the force between the leaflets over pressure, within 2 %.
///
/// The library measures coaptation where the gap is 0.1 mm and 2 % of an edge wider than the contact thickness, whatever
/// comes above. Two circles that part there, 2 R (1 − cos φ) = Δ, reach that gap R φ ≈ √(R Δ) above where they part on paper:
/// 0.9 to 1.5 mm here. With that added, the measure is within 2 % as well.
#[test]
fn nine_valves_close_as_on_paper() {
    for given in &VALVES[..9] {
        let valve = valve(*given);
        let (radius_mm, contact_mm) = closed(&valve);
        let found = closure(&valve);
        let coaptation = &found.measures.coaptation;
        let parted_mm = THICKNESS_MM - 2.0 * ASIDE_MM + 0.1 + 0.02 * found.edge_mm;
        let beyond_mm = radius_mm * (1.0 - 0.5 * parted_mm / radius_mm).acos();
        let measured_mm = coaptation.length_mean_mm - beyond_mm;
        report(&format!(
            "bileaflet {given:?}: chords off {:.2} %; coaptation {contact_mm:.3} mm, by force off {:.2} %, measured {:.3} mm, of which {beyond_mm:.3} mm are tolerance, off {:.2} %",
            100.0 * error(found.radius_mm, radius_mm),
            100.0 * error(found.contact_mm, contact_mm),
            coaptation.length_mean_mm,
            100.0 * error(measured_mm, contact_mm),
        ));
        assert!(error(found.radius_mm, radius_mm) < 0.02, "{given:?}");
        assert!(error(found.contact_mm, contact_mm) < 0.02, "{given:?}");
        assert!(error(measured_mm, contact_mm) < 0.02, "{given:?}");
        assert_eq!(found.measures.orifice.area_mm2, 0.0, "{given:?}");
    }
}

/// Leaflets that do not reach each other are reported open, by as much as on paper.
#[test]
fn a_valve_whose_leaflets_do_not_meet_stays_open() {
    let valve = valve(VALVES[9]);
    assert!(closed(&valve).1 < 0.0);
    let (radius_mm, gap_mm) = open(&valve);
    let found = closure(&valve);
    let Measures {
        coaptation, orifice, ..
    } = &found.measures;
    // Margins stand apart by the gap and by what the hinges were moved.
    let measured_mm = orifice.max_gap_mm - 2.0 * ASIDE_MM;
    report(&format!(
        "bileaflet {:?}: open, chords off {:.2} %, gap {gap_mm:.3} mm off {:.2} %",
        VALVES[9],
        100.0 * error(found.radius_mm, radius_mm),
        100.0 * error(measured_mm, gap_mm)
    ));
    assert_eq!(coaptation.area_mm2, 0.0);
    assert_eq!(found.contact_mm, 0.0);
    assert!(orifice.area_mm2 > 0.0);
    assert!(error(found.radius_mm, radius_mm) < 0.02);
    assert!(error(measured_mm, gap_mm) < 0.02);
}

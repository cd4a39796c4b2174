//! Two leaflets in the plane as strips in space, for [`super::bileaflet`].

use coapt::Vec3;
use coapt::energy::bilinear_spring::Springs;
use coapt::model::{ChordGroup, LeafletTissue, Margin, Model, Prescribed};
use coapt::scene::{ChordLaw, Contact, Tissue};

use crate::shapes::{Mesh, add_spring, bare};

pub(super) const PRESSURE_MPA: f64 = 0.016;
pub(super) const HALF_WIDTH_MM: f64 = 2.0;
/// Chords so long that they stay upright, so stiff that they do not give.
const CHORD_MM: f64 = 1000.0;
const CHORD_MPA: f64 = 1e7;

/// A plane valve.
#[derive(Clone, Copy, Debug)]
pub(super) struct Valve {
    /// Half the orifice, a.
    pub(super) half_orifice_mm: f64,
    /// A leaflet's length, S.
    pub(super) length_mm: f64,
    /// How deep chords hold the free edges, D.
    pub(super) depth_mm: f64,
    /// p / (E'h) [1/mm].
    pub(super) softness: f64,
    /// Of contact.
    pub(super) thickness_mm: f64,
}

impl Valve {
    /// Half the distance of mid-surfaces at rest: under this pressure 0.9 of the contact thickness lies between them.
    pub(super) fn aside_mm(&self) -> f64 {
        0.45 * self.thickness_mm
    }
}

/// Two strips that hang straight down from their hinges, three columns of vertices each. Springs along the arc share the
/// width as 1 : 2 : 1, as pressure does, so that E' is E; ribs and diagonals of a fiftieth of that keep the strips straight.
pub(super) fn strips(valve: &Valve, row_counts: [u32; 2]) -> Model {
    let (mut mesh, mut springs) = (Mesh::default(), Springs::default());
    let mut firsts = Vec::new();
    for (side, rows) in [1.0, -1.0].into_iter().zip(row_counts) {
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
        thickness_mm: valve.thickness_mm,
        tissue: Tissue::default(),
    };
    model.leaflets = vec![leaflet("right"), leaflet("left")];
    model.contact = Contact {
        thickness_mm: valve.thickness_mm,
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
    let x = side * (valve.half_orifice_mm + valve.aside_mm());
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
        valve.aside_mm().copysign(at.x),
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
        model.chord_groups.push(ChordGroup::chordae("margin"));
        model.chords.laws.push(ChordLaw::Linear {
            modulus_mpa: CHORD_MPA,
        });
    }
    tip
}

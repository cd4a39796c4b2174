//! A frame as a picture in space: leaflets, chordae, places of contact; and once what does not move.
//!
//! Coordinates are the patient's, in mm: viewers clip what is smaller than half a unit.

use coapt::Vec3;
use coapt::film::Frame;
use coapt::measure;
use coapt::model::Model;
use coapt::repair;
use prost::Message;

use super::FRAME_ID;
use super::message::{
    Color, KeyValuePair, LinePrimitive, LineType, Pose, Quaternion, SceneEntity, SceneUpdate,
    SpherePrimitive, TextPrimitive, Timestamp, TriangleListPrimitive, Xyz,
};
use crate::report::NOT_CERTIFIED;

/// Strain of leaflets and tension of chordae [N] at the dark end of their colours; both begin at 0. Fixed, so that frames and
/// recordings can be held against each other. Our choice: about the largest of the presets (95th percentile of strain 0.25 to 0.30, chordae 1.5 to 3 N).
const STRAIN_END: f64 = 0.3;
const TENSION_END_N: f64 = 2.0;

/// Shades of a quantity: as many as an eye tells apart, and few enough to compress well.
const SHADES: f64 = 64.0;
/// From little to much, parts of 255. Our choice: told apart without telling red from green, and darker where there is more.
const RAMP: [[f64; 3]; 4] = [
    [248.0, 234.0, 214.0],
    [240.0, 176.0, 120.0],
    [200.0, 72.0, 84.0],
    [84.0, 22.0, 88.0],
];
/// Colours of all else.
const GREY: Color = shade(150.0, 150.0, 150.0);
const ANNULUS: Color = shade(40.0, 96.0, 170.0);
const RING: Color = shade(20.0, 140.0, 120.0);
const TIPS: Color = shade(96.0, 60.0, 40.0);
const CONTACT: Color = shade(20.0, 20.0, 60.0);
const WARNING: Color = shade(200.0, 0.0, 0.0);

/// Sizes [mm], our choice: to be seen, and to hide nothing.
const CHORD_WIDTH_MM: f64 = 0.4;
const CURVE_WIDTH_MM: f64 = 0.8;
const TIP_MM: f64 = 2.5;
const CONTACT_MM: f64 = 0.5;
const TEXT_MM: f64 = 3.0;

/// Names of what is drawn, by which it is read again.
pub(super) const LEAFLETS: &str = "leaflets";
pub(super) const CHORDAE: &str = "chordae";
pub(super) const ANNULUS_CURVE: &str = "annulus";
pub(super) const PAPILLARY_TIPS: &str = "papillary tips";
pub(super) const RING_CURVE: &str = "ring";

const fn shade(r: f64, g: f64, b: f64) -> Color {
    let a = 1.0;
    Color {
        r: r / 255.0,
        g: g / 255.0,
        b: b / 255.0,
        a,
    }
}

/// The picture of a frame, so many nanoseconds after the beginning. What is no balance is drawn without any quantity, and says so.
pub(super) fn frame(model: &Model, frame: &Frame, time_ns: u64) -> Vec<u8> {
    let positions_mm = &frame.equilibrium.state.positions_mm;
    let certified = frame.is_certified();
    let contact = SceneEntity {
        spheres: contact(model, positions_mm),
        ..entity("contact", time_ns)
    };
    let status = SceneEntity {
        texts: match certified {
            true => Vec::new(),
            false => vec![warning(frame)],
        },
        ..entity("status", time_ns)
    };
    let update = SceneUpdate {
        entities: vec![
            leaflets(model, positions_mm, certified, time_ns),
            chordae(model, positions_mm, certified, time_ns),
            contact,
            status,
        ],
    };
    update.encode_to_vec()
}

/// The picture of what stands still: annulus, papillary tips, rings.
pub(super) fn supports(model: &Model, positions_mm: &[Vec3], repairs: &[repair::Report]) -> Vec<u8> {
    let at = |&vertex: &u32| positions_mm[vertex as usize];
    let annulus: Vec<Vec3> = model.annulus.iter().map(at).collect();
    let mut entities = vec![SceneEntity {
        lines: vec![curve(&annulus, LineType::Loop, ANNULUS)],
        ..entity(ANNULUS_CURVE, 0)
    }];
    let tips = model.papillary.iter().flat_map(|muscle| &muscle.tips);
    entities.push(SceneEntity {
        spheres: tips.map(|tip| sphere(at(tip), TIP_MM, TIPS)).collect(),
        ..entity(PAPILLARY_TIPS, 0)
    });
    let rings = repairs.iter().filter_map(|report| match report {
        repair::Report::Ring(ring) => Some(curve(
            &ring.curve_mm,
            if ring.closed {
                LineType::Loop
            } else {
                LineType::Strip
            },
            RING,
        )),
        _ => None,
    });
    entities.push(SceneEntity {
        lines: rings.collect(),
        ..entity(RING_CURVE, 0)
    });
    SceneUpdate { entities }.encode_to_vec()
}

/// Colour of each leaflet vertex.
pub(super) fn strain_colors(model: &Model, positions_mm: &[Vec3]) -> impl Iterator<Item = Color> {
    let strains = measure::vertex_strain(model, positions_mm).into_iter();
    let strains = strains.take(model.leaflet_vertex_count);
    strains.map(|strain| shaded(strain / STRAIN_END))
}

fn leaflets(model: &Model, positions_mm: &[Vec3], certified: bool, time_ns: u64) -> SceneEntity {
    let count = model.leaflet_vertex_count;
    let colors = strain_colors(model, positions_mm);
    let triangles = TriangleListPrimitive {
        pose: Some(UPRIGHT),
        points: positions_mm.iter().take(count).map(xyz).collect(),
        color: (!certified).then_some(GREY),
        colors: if certified { colors.collect() } else { Vec::new() },
        indices: model.faces.as_flattened().to_vec(),
    };
    SceneEntity {
        triangles: vec![triangles],
        metadata: vec![key(
            "colour",
            format!("mean strain of the edges, 0 to {STRAIN_END}"),
        )],
        ..entity(LEAFLETS, time_ns)
    }
}

/// A pair of points for each segment, in its order.
fn chordae(model: &Model, positions_mm: &[Vec3], certified: bool, time_ns: u64) -> SceneEntity {
    let chords = &model.chords;
    let points = chords.ends.as_flattened().iter();
    let tensions_n = measure::chord_forces(model, positions_mm);
    let colors = tensions_n
        .iter()
        .flat_map(|tension| [shaded(tension / TENSION_END_N); 2]);
    let lines = LinePrimitive {
        r#type: LineType::List.into(),
        pose: Some(UPRIGHT),
        thickness: CHORD_WIDTH_MM,
        points: points
            .map(|&point| xyz(&chords.point_mm(point, positions_mm)))
            .collect(),
        color: (!certified).then_some(GREY),
        colors: if certified { colors.collect() } else { Vec::new() },
    };
    SceneEntity {
        lines: vec![lines],
        metadata: vec![key("colour", format!("tension, 0 to {TENSION_END_N} N"))],
        ..entity(CHORDAE, time_ns)
    }
}

fn contact(model: &Model, positions_mm: &[Vec3]) -> Vec<SpherePrimitive> {
    let touching = measure::in_contact(model, positions_mm);
    let at = positions_mm.iter().take(model.leaflet_vertex_count).zip(touching);
    at.filter(|(_, touching)| *touching)
        .map(|(&place, _)| sphere(place, CONTACT_MM, CONTACT))
        .collect()
}

fn warning(frame: &Frame) -> TextPrimitive {
    let positions_mm = &frame.equilibrium.state.positions_mm;
    let highest = positions_mm.iter().map(|place| place.z).fold(f64::MIN, f64::max);
    let middle = positions_mm.iter().sum::<Vec3>() / positions_mm.len().max(1) as f64;
    let place = Vec3::new(middle.x, middle.y, highest + 2.0 * TEXT_MM);
    TextPrimitive {
        pose: Some(at(place)),
        billboard: true,
        font_size: TEXT_MM,
        scale_invariant: false,
        color: Some(WARNING),
        text: format!("{NOT_CERTIFIED} ({:?})", frame.equilibrium.status),
    }
}

fn entity(id: &str, time_ns: u64) -> SceneEntity {
    SceneEntity {
        timestamp: Some(timestamp(time_ns)),
        frame_id: FRAME_ID.to_owned(),
        id: id.to_owned(),
        ..SceneEntity::default()
    }
}

fn timestamp(time_ns: u64) -> Timestamp {
    Timestamp {
        seconds: (time_ns / 1_000_000_000) as i64,
        nanos: (time_ns % 1_000_000_000) as i32,
    }
}

fn curve(points: &[Vec3], kind: LineType, color: Color) -> LinePrimitive {
    LinePrimitive {
        r#type: kind.into(),
        pose: Some(UPRIGHT),
        thickness: CURVE_WIDTH_MM,
        points: points.iter().map(xyz).collect(),
        color: Some(color),
        colors: Vec::new(),
    }
}

fn sphere(place: Vec3, size_mm: f64, color: Color) -> SpherePrimitive {
    SpherePrimitive {
        pose: Some(at(place)),
        size: Some([size_mm; 3].into()),
        color: Some(color),
    }
}

/// Neither moved nor turned.
const UPRIGHT: Pose = Pose {
    position: Some(Xyz {
        x: Some(0.0),
        y: Some(0.0),
        z: Some(0.0),
    }),
    orientation: Some(Quaternion { w: 1.0 }),
};

fn at(place: Vec3) -> Pose {
    Pose {
        position: Some(xyz(&place)),
        ..UPRIGHT
    }
}

fn xyz(place: &Vec3) -> Xyz {
    <[f64; 3]>::from(*place).into()
}

fn key(key: &str, value: String) -> KeyValuePair {
    KeyValuePair {
        key: key.to_owned(),
        value,
    }
}

/// The colour of a part from 0 to 1; less and more take the colours of the ends.
fn shaded(part: f64) -> Color {
    // Not a number becomes 0.
    let step = (part.clamp(0.0, 1.0) * (SHADES - 1.0)).round().max(0.0);
    let along = step / (SHADES - 1.0) * (RAMP.len() - 1) as f64;
    let from = (along as usize).min(RAMP.len() - 2);
    let rest = along - from as f64;
    let mixed = |channel: usize| RAMP[from][channel] * (1.0 - rest) + RAMP[from + 1][channel] * rest;
    // Whole parts of 255: fewer different bytes.
    let [r, g, b] = [0, 1, 2].map(|channel| mixed(channel).round());
    shade(r, g, b)
}

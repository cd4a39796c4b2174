//! A film as GLB (binary glTF 2.0), which browsers, Blender and office programs play: to show, not to measure.
//!
//! Numbers are single precision. Leaflets have the colours of the closed valve, since colours cannot change in this format. Players
//! go straight from frame to frame, through shapes that are no balances; a frame that is no balance itself is left out. The valve
//! stands upright, its anterior side to the front, in metres as the format asks for.
//!
//! JSON by hand: the types of `gltf-json` would have to be built with derive macros of their own for these few keys.

use std::path::Path;

use coapt::Vec3;
use coapt::film::Frame;
use coapt::model::Model;
use coapt::scene::Fault;
use serde_json::{Value, json};

use super::{Filmed, draw, time_ns};
use crate::atomic::{file_fault, write_text_atomically};
use crate::report::NOTICE;

/// Numbers of the format: what a buffer holds, types of components, kinds of primitives.
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;
const FLOAT: u32 = 5126;
const UNSIGNED: u32 = 5125;
const TRIANGLES: u32 = 4;
const LINES: u32 = 1;

/// Writes the film of one valve, whole or not at all.
///
/// # Errors
/// No frame that is a balance, more than the format can hold (4 GB), or what the file system says.
pub fn write_glb(path: &Path, filmed: Filmed) -> Result<(), Fault> {
    let bytes = glb(filmed).map_err(|message| file_fault(path, &message))?;
    write_text_atomically(path, &bytes)
}

fn glb(filmed: Filmed) -> Result<Vec<u8>, String> {
    let Filmed { model, film, .. } = filmed;
    let count = film.frames.len();
    let numbered = film.frames.iter().enumerate();
    let balances: Vec<(usize, &Frame)> = numbered.filter(|(_, frame)| frame.is_certified()).collect();
    let Some((_, closed)) = balances.last() else {
        return Err("no frame of the film is certified; expected one to show".to_owned());
    };
    let mut draft = Draft::default();
    let leaflet_points = |frame: &Frame| -> Vec<Vec3> {
        let positions = &frame.equilibrium.state.positions_mm;
        positions[..model.leaflet_vertex_count].to_vec()
    };
    let colors: Vec<[f32; 4]> = draw::strain_colors(model, &closed.equilibrium.state.positions_mm)
        .map(|color| [color.r, color.g, color.b, color.a].map(linear))
        .collect();
    let leaflets = draft.mesh(
        &balances,
        &leaflet_points,
        model.faces.as_flattened(),
        TRIANGLES,
        Some(&colors),
    );
    let mut meshes = vec![leaflets];
    if !model.chords.ends.is_empty() {
        let ends = |frame: &Frame| ends_of(model, &frame.equilibrium.state.positions_mm);
        let order: Vec<u32> = (0..2 * model.chords.ends.len() as u32).collect();
        meshes.push(draft.mesh(&balances, &ends, &order, LINES, None));
    }
    let times: Vec<f32> = balances
        .iter()
        .map(|(number, _)| time_ns(*number, count) as f32 * 1e-9)
        .collect();
    let animations = draft.animation(&times, meshes.len());
    let document = json!({
        "asset": { "version": "2.0", "generator": concat!("coapt ", env!("CARGO_PKG_VERSION")), "copyright": NOTICE },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": nodes(&model.name, meshes.len()),
        "meshes": meshes,
        "materials": materials(),
        "animations": animations,
        "buffers": [{ "byteLength": draft.bytes.len() }],
        "bufferViews": draft.views,
        "accessors": draft.accessors,
    });
    assembled(document.to_string().into_bytes(), draft.bytes)
}

/// One for all, and below it one for each mesh: VTK mixes up two parts of one mesh that move.
fn nodes(name: &str, meshes: usize) -> Vec<Value> {
    let children: Vec<usize> = (1..=meshes).collect();
    let all = json!({ "name": name, "children": children, "scale": [1e-3, 1e-3, 1e-3] });
    let each = (0..meshes).map(|mesh| json!({ "mesh": mesh }));
    [all].into_iter().chain(each).collect()
}

/// Of leaflets, which have colours of their own, and of chordae.
fn materials() -> Value {
    json!([
        { "name": "leaflets", "doubleSided": true, "pbrMetallicRoughness": { "metallicFactor": 0.0, "roughnessFactor": 0.7 } },
        { "name": "chordae", "pbrMetallicRoughness": { "baseColorFactor": [0.5, 0.45, 0.4, 1.0], "metallicFactor": 0.0 } },
    ])
}

/// Two points for each segment.
fn ends_of(model: &Model, positions_mm: &[Vec3]) -> Vec<Vec3> {
    let ends = model.chords.ends.as_flattened().iter();
    ends.map(|&end| model.chords.point_mm(end, positions_mm))
        .collect()
}

/// Colours of screens as amounts of light.
fn linear(part: f64) -> f32 {
    let light = if part <= 0.04045 {
        part / 12.92
    } else {
        ((part + 0.055) / 1.055).powf(2.4)
    };
    light as f32
}

/// From the patient's axes to those of glTF: left, up, front.
fn turned(place: &Vec3) -> [f32; 3] {
    [place.x, place.z, -place.y].map(|number| number as f32)
}

/// The parts that are pointed to.
#[derive(Default)]
struct Draft {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Draft {
    /// A mesh as in its first balance, with the way to each other one.
    fn mesh(
        &mut self,
        balances: &[(usize, &Frame)],
        points: &dyn Fn(&Frame) -> Vec<Vec3>,
        indices: &[u32],
        mode: u32,
        colors: Option<&[[f32; 4]]>,
    ) -> Value {
        let first = points(balances[0].1);
        let base: Vec<[f32; 3]> = first.iter().map(turned).collect();
        let mut attributes = json!({ "POSITION": self.floats(&base, "VEC3", Some(VERTICES)) });
        if let Some(colors) = colors {
            attributes["COLOR_0"] = self.floats(colors, "VEC4", Some(VERTICES)).into();
        }
        let mut targets = Vec::new();
        for (_, frame) in &balances[1..] {
            let way = points(frame);
            let way: Vec<[f32; 3]> = way
                .iter()
                .zip(&first)
                .map(|(there, here)| turned(&(there - here)))
                .collect();
            targets.push(json!({ "POSITION": self.floats(&way, "VEC3", Some(VERTICES)) }));
        }
        let bytes: Vec<u8> = indices.iter().flat_map(|index| index.to_le_bytes()).collect();
        let view = self.view(&bytes, Some(INDICES));
        let indices = self.accessor(json!({
            "bufferView": view, "componentType": UNSIGNED, "count": indices.len(), "type": "SCALAR"
        }));
        json!({
            "primitives": [{
                "attributes": attributes,
                "targets": targets,
                "indices": indices,
                "mode": mode,
                "material": usize::from(mode == LINES),
            }],
            "weights": vec![0.0; balances.len() - 1],
        })
    }

    /// Each balance in its turn; one alone does not move.
    fn animation(&mut self, times: &[f32], meshes: usize) -> Vec<Value> {
        if times.len() < 2 {
            return Vec::new();
        }
        let others = times.len() - 1;
        let weight = |index: usize| f32::from(u8::from(index / others == index % others + 1));
        let weights: Vec<[f32; 1]> = (0..times.len() * others).map(|index| [weight(index)]).collect();
        let times: Vec<[f32; 1]> = times.iter().map(|&time| [time]).collect();
        let (input, output) = (
            self.floats(&times, "SCALAR", None),
            self.floats(&weights, "SCALAR", None),
        );
        let channels =
            (1..=meshes).map(|node| json!({ "sampler": 0, "target": { "node": node, "path": "weights" } }));
        vec![json!({
            "name": "closing",
            "samplers": [{ "input": input, "output": output, "interpolation": "LINEAR" }],
            "channels": channels.collect::<Vec<_>>(),
        })]
    }

    /// Numbers with their bounds, which the format wants of positions and times.
    fn floats<const N: usize>(&mut self, rows: &[[f32; N]], kind: &str, target: Option<u32>) -> usize {
        let bytes: Vec<u8> = rows
            .as_flattened()
            .iter()
            .flat_map(|number| number.to_le_bytes())
            .collect();
        let view = self.view(&bytes, target);
        let bound = |pick: fn(f32, f32) -> f32| -> Vec<f32> {
            let column = |axis: usize| rows.iter().map(|row| row[axis]).reduce(pick).unwrap_or_default();
            (0..N).map(column).collect()
        };
        self.accessor(json!({
            "bufferView": view,
            "componentType": FLOAT,
            "count": rows.len(),
            "type": kind,
            "min": bound(f32::min),
            "max": bound(f32::max),
        }))
    }

    fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        let mut view = json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.bytes.extend(bytes);
        self.views.push(view);
        self.views.len() - 1
    }

    fn accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }
}

/// A header and two chunks, each filled up to a multiple of four bytes.
fn assembled(mut json: Vec<u8>, mut binary: Vec<u8>) -> Result<Vec<u8>, String> {
    json.resize(json.len().next_multiple_of(4), b' ');
    binary.resize(binary.len().next_multiple_of(4), 0);
    let size = |length: usize| {
        u32::try_from(length).map_err(|_| "a GLB file ends at 4 GB; expected fewer frames".to_owned())
    };
    let mut bytes = b"glTF".to_vec();
    bytes.extend(2_u32.to_le_bytes());
    bytes.extend(size(12 + 8 + json.len() + 8 + binary.len())?.to_le_bytes());
    for (kind, chunk) in [(b"JSON", json), (b"BIN\0", binary)] {
        bytes.extend(size(chunk.len())?.to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    Ok(bytes)
}

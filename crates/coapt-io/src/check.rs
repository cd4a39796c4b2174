//! What is told of a valve that was read and built, and not closed: its faults, its size, how well its springs stand for tissue.

use coapt::model::mesh_quality::SpringQuality;
use coapt::model::{Model, mesh_quality};
use coapt::scene::{Fault, Severity};
use serde_json::{Value, json};

use crate::escape::escaped;
use crate::scene::sentence;

/// What `coapt check` tells.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckReport {
    /// What the scene is called in messages, such as its path.
    pub scene: String,
    /// Everything that was found.
    pub faults: Vec<Fault>,
    /// What the valve is, where it could be built.
    pub valve: Option<BuiltValve>,
}

/// A valve that could be built.
#[derive(Clone, Debug, PartialEq)]
pub struct BuiltValve {
    /// Name of the case.
    pub name: String,
    /// Vertices: leaflets, chord nodes, papillary tips.
    pub vertices: usize,
    /// Triangles.
    pub faces: usize,
    /// Chord segments.
    pub chords: usize,
    /// How well the mesh of each leaflet made of springs renders the sheet that they stand for, by its name.
    pub springs: Vec<(String, SpringQuality)>,
}

impl From<&Model> for BuiltValve {
    fn from(model: &Model) -> Self {
        let named = |quality: SpringQuality| {
            let leaflet = &model.leaflets[quality.leaflet as usize];
            (leaflet.name.clone(), quality)
        };
        Self {
            name: model.name.clone(),
            vertices: model.rest_mm.len(),
            faces: model.faces.len(),
            chords: model.chords.ends.len(),
            springs: mesh_quality::of_model(model).into_iter().map(named).collect(),
        }
    }
}

impl CheckReport {
    /// How many faults stop.
    pub fn errors(&self) -> usize {
        self.count(Severity::Error)
    }

    fn count(&self, severity: Severity) -> usize {
        let of_it = self.faults.iter().filter(|fault| fault.severity == severity);
        of_it.count()
    }

    /// For people: a line for each fault, what the valve is, and whether it can be closed.
    pub fn text(&self) -> String {
        let mut text: String = self.faults.iter().map(|fault| fault_line(fault) + "\n").collect();
        if let Some(valve) = &self.valve {
            text += &format!(
                "{}: {} triangles, {} vertices, {} chord segments\n",
                escaped(&valve.name),
                valve.faces,
                valve.vertices,
                valve.chords
            );
            for (leaflet, quality) in &valve.springs {
                text += &format!(
                    "{}: springs are {:.1} % too soft for their mesh, {:.0} % off in the strain they render worst\n",
                    escaped(leaflet),
                    100.0 * quality.softening,
                    100.0 * quality.stiffness_error
                );
            }
        }
        let judged = match self.errors() {
            0 => "ready to be closed",
            _ => "cannot be closed",
        };
        text += &format!(
            "{}: {judged}: {}, {}\n",
            escaped(&self.scene),
            counted(self.errors(), "error"),
            counted(self.count(Severity::Warning), "warning")
        );
        text
    }

    /// As one JSON object, with a line break at its end.
    pub fn json(&self) -> String {
        let mesh = self
            .valve
            .as_ref()
            .map(|valve| json!({"vertices": valve.vertices, "faces": valve.faces, "chords": valve.chords}));
        let springs = self.valve.iter().flat_map(|valve| &valve.springs);
        let whole = json!({
            "schema": "coapt-check/1", "scene": self.scene,
            "errors": self.errors(), "warnings": self.count(Severity::Warning), "mesh": mesh,
            "faults": self.faults.iter().map(entry).collect::<Vec<_>>(),
            "springs": springs.map(|(leaflet, quality)| json!({
                "leaflet": leaflet, "softening": quality.softening, "stiffness_error": quality.stiffness_error,
                "worst_error": quality.worst_error, "worst_vertex": quality.worst_vertex,
            })).collect::<Vec<_>>(),
        });
        format!("{whole:#}\n")
    }
}

/// `error: scene.toml:12: leaflets[0].thickness_mm is -1 mm, expected ...`, on one line whatever is told.
pub fn fault_line(fault: &Fault) -> String {
    escaped(&format!("{}: {}", word(fault.severity), sentence(fault)))
}

fn word(severity: Severity) -> &'static str {
    match severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
    }
}

fn counted(count: usize, noun: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {noun}{plural}")
}

fn entry(fault: &Fault) -> Value {
    json!({"severity": word(fault.severity), "place": fault.place, "message": fault.message})
}

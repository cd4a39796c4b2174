//! A valve with its repairs: the scene that it is from, and the model.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use coapt::mesh::parametric::{self, Preset, ValveParameters};
use coapt::model::{LeftOut, Model, Untangled};
use coapt::plan::{Applied, apply_all, refuse_second_ring};
use coapt::repair::Report;
use coapt::scene::{Fault, Repair, Scene, Severity};
use coapt_io::plan::in_plan;
use coapt_io::scene::{located, nearest, read_text, scene_file, scene_within, with_parameter};

/// A valve ready to be closed.
#[derive(Debug)]
pub(crate) struct Built {
    pub(crate) scene: Arc<Scene>,
    pub(crate) source: Option<Arc<Source>>,
    pub(crate) repairs: Vec<Repair>,
    /// After the repairs.
    pub(crate) model: Model,
    /// What the repairs did, shape `[repair]`.
    pub(crate) reports: Vec<Report>,
    /// Those of reading, which no building brings back.
    pub(crate) of_reading: Vec<Fault>,
    /// All.
    pub(crate) warnings: Vec<Fault>,
    pub(crate) untangled: Option<Untangled>,
    pub(crate) chordae_left_out: Vec<LeftOut>,
}

/// The file of a scene, to name lines in it.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub(crate) struct Source {
    pub(crate) name: String,
    pub(crate) text: String,
}

impl Source {
    fn located(&self, fault: &Fault) -> Fault {
        located(&self.name, &self.text, fault)
    }
}

/// Reads a scene file, or a folder with one, and builds it.
pub(crate) fn read(path: &Path, face_limit: Option<u32>) -> Result<Built, Vec<Fault>> {
    let path: PathBuf = scene_file(path);
    let text = read_text(&path).map_err(|fault| vec![fault])?;
    let (scene, of_reading) = scene_within(&path, &text, face_limit)?;
    let name = path.display().to_string();
    build(scene, Some(Arc::new(Source { name, text })), of_reading)
}

/// A parametric valve: a preset with some parameters replaced, by dotted keys.
pub(crate) fn generated(preset: &str, settings: &[(String, toml::Value)]) -> Result<Built, Vec<Fault>> {
    let names = Preset::ALL.map(Preset::name);
    let found = Preset::from_name(preset).ok_or_else(|| {
        let advice = match nearest(preset, names) {
            Some(meant) => format!("did you mean `{meant}`?"),
            None => format!("there are {}", names.join(", ")),
        };
        vec![Fault::error("preset", format!("`{preset}` is unknown; {advice}"))]
    })?;
    let mut parameters = ValveParameters::preset(found);
    let mut faults = Vec::new();
    for (key, value) in settings {
        match with_parameter(&parameters, key, value.clone(), &value.to_string()) {
            Ok(with) => parameters = with,
            Err(message) => faults.push(Fault::error("parameters", message)),
        }
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    build(parametric::generate(&parameters)?, None, Vec::new())
}

/// Builds a scene that is whole.
pub(crate) fn build(
    scene: Scene,
    source: Option<Arc<Source>>,
    of_reading: Vec<Fault>,
) -> Result<Built, Vec<Fault>> {
    let located = |fault: &Fault| located_in(source.as_deref(), fault);
    let mut warnings = of_reading.clone();
    match Model::build(&scene) {
        Ok(built) => {
            warnings.extend(built.warnings.iter().map(located));
            Ok(Built {
                scene: Arc::new(scene),
                source,
                repairs: Vec::new(),
                model: built.model,
                reports: Vec::new(),
                of_reading,
                warnings,
                untangled: built.untangled,
                chordae_left_out: built.chordae_left_out,
            })
        }
        Err(faults) => {
            warnings.extend(faults.iter().map(located));
            warnings.sort_by_key(|fault| fault.severity == Severity::Warning);
            Err(warnings)
        }
    }
}

fn located_in(source: Option<&Source>, fault: &Fault) -> Fault {
    match source {
        Some(source) => source.located(fault),
        None => fault.clone(),
    }
}

impl Built {
    /// A fault with the line of the file that it speaks of, where the valve is from one.
    pub(crate) fn located(&self, fault: &Fault) -> Fault {
        located_in(self.source.as_deref(), fault)
    }

    /// With more repairs, after those that it has. Faults are named by the repair that they are of, as `repair[1].size_mm`.
    pub(crate) fn repaired(&self, repairs: &[Repair]) -> Result<Self, Vec<Fault>> {
        let before = self.repairs.len();
        let named = |number: usize, fault: &Fault| in_plan(&format!("repair[{}]", before + number), fault);
        let whole: Vec<Repair> = self.repairs.iter().chain(repairs).cloned().collect();
        for number in before..whole.len() {
            refuse_second_ring(&whole[..number], &whole[number])
                .map_err(|fault| vec![named(number - before, &fault)])?;
        }
        let Applied {
            model,
            reports,
            warnings,
        } = apply_all(&self.model, repairs).map_err(|refusal| -> Vec<Fault> {
            let faults = refusal.faults.iter();
            faults.map(|fault| named(refusal.repair, fault)).collect()
        })?;
        let doubts = warnings.iter().map(|(number, fault)| named(*number, fault));
        // All but the model is small or shared: edits come many in a second.
        Ok(Self {
            scene: Arc::clone(&self.scene),
            source: self.source.clone(),
            repairs: whole,
            model,
            reports: self.reports.iter().cloned().chain(reports).collect(),
            of_reading: self.of_reading.clone(),
            warnings: self.warnings.iter().cloned().chain(doubts).collect(),
            untangled: self.untangled.clone(),
            chordae_left_out: self.chordae_left_out.clone(),
        })
    }

    /// The same valve of a changed scene: built anew, and repaired anew.
    pub(crate) fn of(&self, scene: Scene) -> Result<Self, Vec<Fault>> {
        build(scene, self.source.clone(), self.of_reading.clone())?.repaired(&self.repairs)
    }
}

//! Finding the valve that a person means: a scene file, a folder with one, or a preset.

use std::path::{Path, PathBuf};

use clap::Args;
use coapt::mesh::parametric::{self, Preset, ValveParameters};
use coapt::model::{Built, Model};
use coapt::scene::{Fault, Scene, Severity};
use coapt_io::scene::{located, nearest, read_text, scene_file, scene_within, sentence};

use crate::whole_number::whole_number;

/// Faces of a preset that is closed without being written first: as many as the models of paper 003, so that an
/// answer is there at once. `coapt generate` writes finer ones.
const FACES_OF_A_PRESET: u32 = 650;

/// How large a valve may be.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct SizeLimit {
    /// Refuse valves of more triangles, with an estimate of what closing them would cost [default: what the scene says,
    /// usually 250000]
    #[arg(long, value_name = "N", value_parser = whole_number(1..=u32::MAX), allow_negative_numbers = true)]
    max_faces: Option<u32>,
}

/// A valve and where it is from.
#[derive(Debug)]
pub(crate) struct Case {
    pub(crate) scene: Scene,
    pub(crate) source: Source,
    /// From reading.
    pub(crate) warnings: Vec<Fault>,
}

/// Where a scene is from, to name lines in it.
#[derive(Clone, Debug)]
pub(crate) enum Source {
    /// A file and its text.
    File(PathBuf, String),
    /// A preset.
    Preset(Preset),
}

/// Finds and reads a valve; without a name, the healthy one.
pub(crate) fn open(name: Option<&Path>, limit: SizeLimit) -> Result<Case, Vec<Fault>> {
    let Some(path) = name else {
        return preset(Preset::Healthy, FACES_OF_A_PRESET, limit);
    };
    // A link that leads nowhere is told as such.
    if path.symlink_metadata().is_ok() {
        return read(&scene_file(path), limit);
    }
    match path.to_str().and_then(Preset::from_name) {
        Some(found) => preset(found, FACES_OF_A_PRESET, limit),
        None => Err(vec![not_found(path)]),
    }
}

fn not_found(path: &Path) -> Fault {
    let names = Preset::ALL.map(Preset::name);
    let meant = path.to_str().and_then(|word| nearest(word, names));
    let advice = meant.map_or(String::new(), |name| format!("; did you mean `{name}`?"));
    let message = format!(
        "no such file or folder, and no preset of that name (there are {}){advice}",
        names.join(", ")
    );
    Fault::error(path.display().to_string(), message)
}

/// A preset at about so many triangles.
pub(crate) fn preset(preset: Preset, face_count_target: u32, limit: SizeLimit) -> Result<Case, Vec<Fault>> {
    let parameters = ValveParameters {
        face_count_target,
        ..ValveParameters::preset(preset)
    };
    let mut scene = parametric::generate(&parameters)?;
    scene.settings.face_limit = limit.max_faces.unwrap_or(scene.settings.face_limit);
    Ok(Case {
        scene,
        source: Source::Preset(preset),
        warnings: Vec::new(),
    })
}

fn read(path: &Path, limit: SizeLimit) -> Result<Case, Vec<Fault>> {
    let text = read_text(path).map_err(|fault| vec![fault])?;
    let (scene, warnings) = scene_within(path, &text, limit.max_faces)?;
    Ok(Case {
        scene,
        source: Source::File(path.to_owned(), text),
        warnings,
    })
}

impl Source {
    /// Faults of the library, with the lines that they speak of.
    pub(crate) fn locate(&self, faults: &[Fault]) -> Vec<Fault> {
        faults.iter().map(|fault| self.located(fault)).collect()
    }

    fn located(&self, fault: &Fault) -> Fault {
        match self {
            Self::File(path, text) => located(&path.display().to_string(), text, fault),
            Self::Preset(preset) => Fault {
                place: preset.name().to_owned(),
                message: sentence(fault),
                ..fault.clone()
            },
        }
    }
}

/// The model of a case; warnings of reading and of building go together.
pub(crate) fn build(case: &Case) -> Result<Built, Vec<Fault>> {
    let mut warnings = case.warnings.clone();
    match Model::build(&case.scene) {
        Ok(built) => {
            warnings.extend(case.source.locate(&built.warnings));
            Ok(Built { warnings, ..built })
        }
        Err(faults) => {
            warnings.extend(case.source.locate(&faults));
            warnings.sort_by_key(|fault| fault.severity == Severity::Warning);
            Err(warnings)
        }
    }
}

//! Scenes and plans: read with the files that they name, written as a folder.
//!
//! TOML for hands, JSON for machines; the first letter decides. Every fault is told at once as far as reading can go
//! on, with `file:line:column` where it is one of the text, and with file and element where it is one of a mesh.
//!
//! What comes out is whole: meshes, curves and tips are in the scene, the file names are gone, all coordinates are
//! LPS. Files must lie below the scene's folder.

mod document;
mod files;
mod frame;
mod geometry;
mod json_text;
mod keyed;
mod locate;
mod missing_key;
mod nearest;
mod parameters;
mod plan;
mod write;
mod wrong_type;

use std::path::{Path, PathBuf};

use coapt::scene::{Fault, Scene, Severity, Space};

pub use document::{in_plain_words, read_text};
pub use frame::turn_scene;
pub use keyed::part_from_table;
pub use locate::{locate, located, sentence};
pub use nearest::nearest;
pub use parameters::with_parameter;
pub(crate) use plan::BEFORE;
pub use plan::{
    ALTERNATIVE_LIMIT, Alternatives, Asked, Bound, SAMPLE_LIMIT, Search, alternative_from_text,
    alternatives_from_text, alternatives_up_to, number_keys, plan_from_text, read_plan, with_number,
};
pub use write::{stage_scene, write_scene};

use files::Files;

/// Reads a scene and all files that it names; the second part are the warnings.
///
/// # Errors
/// All faults found, errors and warnings, up to twenty of each, if one of them is an error.
pub fn read_scene(path: &Path) -> Result<(Scene, Vec<Fault>), Vec<Fault>> {
    let text = read_text(path).map_err(|fault| vec![fault])?;
    scene_from_text(path, &text)
}

/// The same with the text at hand, for callers that keep it to [`locate`] keys; `path` says where files lie.
///
/// # Errors
/// As [`read_scene`].
pub fn scene_from_text(path: &Path, text: &str) -> Result<(Scene, Vec<Fault>), Vec<Fault>> {
    scene_within(path, text, None)
}

/// The same with another limit of triangles than the scene's own, [`Settings::face_limit`](coapt::scene::Settings): files that
/// hold more are not read any further than that is known.
///
/// # Errors
/// As [`read_scene`].
pub fn scene_within(
    path: &Path,
    text: &str,
    face_limit: Option<u32>,
) -> Result<(Scene, Vec<Fault>), Vec<Fault>> {
    let name = path.display().to_string();
    let mut scene: Scene = document::parse(&name, text)?;
    scene.settings.face_limit = face_limit.unwrap_or(scene.settings.face_limit);
    let mut files = Files::new("scene", folder_of(path), scene.space, scene.settings.face_limit);
    if scene.space == Space::RAS {
        turn_scene(&mut scene);
    }
    fill(&mut scene, &mut files);
    files.judge_frames();
    finish(scene, &name, text, files)
}

/// The scene that a path means: itself, or of a folder `scene.toml`, or `scene.json` where only that is in it.
pub fn scene_file(path: &Path) -> PathBuf {
    if !path.is_dir() {
        return path.to_owned();
    }
    let json = path.join("scene.json");
    let toml = path.join("scene.toml");
    if json.exists() && !toml.exists() {
        json
    } else {
        toml
    }
}

fn folder_of(path: &Path) -> &Path {
    path.parent()
        .filter(|folder| !folder.as_os_str().is_empty())
        .unwrap_or(Path::new("."))
}

/// Reads every file that the scene names.
fn fill(scene: &mut Scene, files: &mut Files) {
    for (number, leaflet) in scene.leaflets.iter_mut().enumerate() {
        geometry::fill_leaflet(number, leaflet, &scene.annulus, files);
    }
    for (number, group) in scene.chordae.iter_mut().enumerate() {
        geometry::fill_chords(number, group, files);
    }
    fill_curve(scene, files);
    for (number, muscle) in scene.papillary.iter_mut().enumerate() {
        let key = format!("papillary[{number}].tips_file");
        let Some(file) = muscle.tips_file.take() else {
            continue;
        };
        if !muscle.tips_mm.is_empty() {
            files.error(&key, "is given beside `tips_mm`; expected one of the two");
        } else if let Some(points) = files.points(&key, &file) {
            muscle.tips_mm = points.points_mm;
        }
    }
    let meshes = || scene.leaflets.iter().filter_map(|leaflet| leaflet.mesh.as_ref());
    let any_marks = meshes().any(|mesh| mesh.annulus_points.is_some());
    let any_motion = meshes().any(|mesh| mesh.annulus_displacement_mm.is_some());
    // Taken over into the meshes; of no use any more.
    let marker = (
        scene.annulus.marker_array.take(),
        "annulus.marker_array",
        any_marks,
    );
    let motion = (
        scene.annulus.displacement_array.take(),
        "annulus.displacement_array",
        any_motion,
    );
    for (name, key, found) in [marker, motion] {
        // A file that cannot be read is told already.
        if let Some(name) = name
            && !found
            && !files.any_error()
        {
            files.error(
                key,
                format!("is `{name}`, a point array that no leaflet file has"),
            );
        }
    }
}

fn fill_curve(scene: &mut Scene, files: &mut Files) {
    let key = "annulus.curve_file";
    let Some(file) = scene.annulus.curve_file.take() else {
        return;
    };
    if scene.annulus.curve_mm.is_some() {
        return files.error(key, "is given beside `curve_mm`; expected one of the two");
    }
    let Some(curve) = files.curve(key, &file) else {
        return;
    };
    if !curve.closed {
        files.warning(
            key,
            format!("is `{file}`, an open curve; it is closed from its last point to its first"),
        );
    }
    scene.annulus.curve_mm = Some(curve.points_mm);
}

/// Errors, and warnings, that are told of a scene; more are counted only, unless it is one that a line could tell as well.
const FAULT_LIMIT: usize = 20;

/// The value with its warnings, or all faults, those of the scene with their lines.
fn finish<T>(value: T, name: &str, text: &str, files: Files) -> Result<(T, Vec<Fault>), Vec<Fault>> {
    let any_error = files.any_error();
    let in_files = files.in_files.into_iter().map(|fault| (fault, false));
    let all: Vec<(Fault, bool)> = in_files
        .chain(files.in_scene.into_iter().map(|fault| (fault, true)))
        .collect();
    let mut faults = Vec::new();
    for (severity, more) in [
        (Severity::Error, Fault::error as fn(String, String) -> Fault),
        (Severity::Warning, Fault::warning),
    ] {
        let of_kind: Vec<&(Fault, bool)> = all
            .iter()
            .filter(|(fault, _)| fault.severity == severity)
            .collect();
        faults.extend(limited(name, &of_kind, more, |(fault, has_key)| match has_key {
            true => located(name, text, fault),
            false => fault.clone(),
        }));
    }
    if any_error {
        Err(faults)
    } else {
        Ok((value, faults))
    }
}

/// The first faults of one severity as they are told, and how many more there are: to find the line of a key is to read the text once more.
fn limited<T>(
    name: &str,
    faults: &[T],
    more: impl Fn(String, String) -> Fault,
    told: impl Fn(&T) -> Fault,
) -> Vec<Fault> {
    let count = match faults.len() > FAULT_LIMIT + 1 {
        true => FAULT_LIMIT,
        false => faults.len(),
    };
    let mut all: Vec<Fault> = faults[..count].iter().map(told).collect();
    if count < faults.len() {
        let message = format!("and {} more like these", faults.len() - count);
        all.push(more(name.to_owned(), message));
    }
    all
}

#[cfg(test)]
mod tests;

//! A folder of results, as `coapt closure --out` and `coapt plan --out --shapes` write them.

use std::path::{Path, PathBuf};

use coapt::scene::Fault;
use serde_json::Value;

use super::coded::Coded;
use super::film::page_films;
use super::geometry::{Chords, Geometry, curve};
use super::told::{closure_page, plan_page};
use super::{Page, PageState};
use crate::atomic::{LIST, files_of_other_runs, is_unlisted};
use crate::mesh::{PolyData, read_mesh};
use crate::record::RecordedFilm;
use crate::scene::read_text;

/// The recording that is looked for in a folder of results.
pub const RECORDING: &str = "closing.mcap";

/// Adds the film of a recording to a page of a single closure. It must be of that closure: its last frame is the closed valve.
///
/// # Errors
/// A recording that cannot be read, is of another valve or of another closure; a page of a plan.
pub fn add_film(page: &mut Page, path: &Path) -> Result<(), Vec<Fault>> {
    if page.plan.is_some() {
        return Err(fault(
            path,
            "belongs to a single closure; a page of a plan shows no film",
        ));
    }
    let recording = crate::record::read(path).map_err(|fault| vec![fault])?;
    if recording.cut {
        return Err(fault(
            path,
            "is cut off: its last frames are missing; record the closure again",
        ));
    }
    let films = page_films(&recording)?;
    let same = |state: &PageState, film: &RecordedFilm| {
        let last = film.frames.last().map_or(&[][..], |frame| &frame.positions_mm);
        let rounded = last.iter().flatten().map(|&part| part as f32);
        state.geometry.closed.0.iter().copied().eq(rounded)
    };
    let pairs = || page.states.iter().zip(&recording.films);
    if films.len() != page.states.len() || !pairs().all(|(state, film)| same(state, film)) {
        return Err(fault(
            path,
            "is the film of another closure; expected one that ends where this result does: record and write it in one run",
        ));
    }
    for (state, film) in page.states.iter_mut().zip(films) {
        state.geometry.film = Some(film);
    }
    Ok(())
}

/// Reads a folder of results. Of a plan, the valve as it is and so many alternatives, the first-ranked first, come on the page;
/// what could not be carried out has no shape and stands in its table alone.
///
/// # Errors
/// All faults of a file that is missing, broken or was written by an earlier version.
pub fn read_page(folder: &Path, most_alternatives: usize) -> Result<Page, Vec<Fault>> {
    let names = ["report.json", "plan.json"];
    let [closure, plan] = names.map(|name| folder.join(name));
    let page = match (closure.is_file(), plan.is_file()) {
        (true, false) => read_closure(folder, &closure),
        (false, true) => read_plan(folder, &plan, most_alternatives),
        (true, true) => Err(fault(
            folder,
            "holds report.json and plan.json; expected one of them: remove the older one, and write results into folders of their own",
        )),
        (false, false) => Err(fault(
            folder,
            "holds no results; expected the folder of `coapt closure --out` or of `coapt plan --out --shapes`",
        )),
    }?;
    if let Some(name) = names
        .into_iter()
        .find(|name| folder.join(name).is_file() && is_unlisted(folder, name))
    {
        return Err(fault(
            &folder.join(name),
            format!(
                "is not among the files that {LIST} lists: another command wrote into this folder since, and whether its shapes are \
                 those of one run is not known; write results into folders of their own"
            ),
        ));
    }
    // Shapes and numbers of two runs would make a page that nothing ever closed to.
    let others = files_of_other_runs(folder);
    match others.first() {
        None => Ok(page),
        Some(first) => Err(fault(
            &folder.join(first),
            format!(
                "is not as {LIST} lists it (so are {} of its files): it is of another run, or was changed; write the results again",
                others.len()
            ),
        )),
    }
}

fn fault(path: &Path, message: impl Into<String>) -> Vec<Fault> {
    vec![Fault::error(path.display().to_string(), message)]
}

fn read_closure(folder: &Path, path: &Path) -> Result<Page, Vec<Fault>> {
    let report = read_json(path)?;
    let has_after = report.get("after").is_some();
    closure_page(&path.display().to_string(), report, |state| {
        let folder = match has_after {
            true => folder.join(state),
            false => folder.to_owned(),
        };
        let mut geometry = read_valve(&folder.join("closed.vtp"))?;
        let chords = [folder.join("chords.vtp"), folder.join("open_chords.vtp")];
        geometry.chords = read_chords(&chords[0], Some(&chords[1]))?;
        geometry.rings = read_rings(&folder)?;
        Ok(geometry)
    })
}

fn read_plan(folder: &Path, path: &Path, most_alternatives: usize) -> Result<Page, Vec<Fault>> {
    let report = read_json(path)?;
    let shapes = folder.join("shapes");
    let files = files_in(&shapes).ok_or_else(|| {
        fault(
            &shapes,
            "is not there: expected the closed shapes, which `coapt plan --out --shapes` writes",
        )
    })?;
    plan_page(
        &path.display().to_string(),
        report,
        most_alternatives,
        |number, name| {
            let begins = format!("{number:04}_");
            // Names of alternatives have no underscore in files.
            let named = |ending: &str| {
                files.iter().find(|path| {
                    let name = path.file_name().unwrap_or_default().to_string_lossy();
                    let rest = name.strip_prefix(&begins);
                    rest.is_some_and(|rest| rest.split_once('_').map_or("", |(_, last)| last) == ending)
                })
            };
            let shape = named("");
            let shape =
                shape.ok_or_else(|| fault(&shapes, format!("has no shape of number {number}, {name}")))?;
            let mut geometry = read_valve(shape)?;
            if let Some(chords) = named("chords.vtp") {
                geometry.chords = read_chords(chords, None)?;
            }
            if let Some(ring) = named("ring.vtp") {
                geometry.rings = vec![curve(&read_surface(ring)?)];
            }
            Ok(geometry)
        },
    )
}

fn read_json(path: &Path) -> Result<Value, Vec<Fault>> {
    let text = read_text(path).map_err(|fault| vec![fault])?;
    serde_json::from_str(&text).map_err(|error| fault(path, error.to_string()))
}

fn read_surface(path: &Path) -> Result<PolyData, Vec<Fault>> {
    read_mesh(path).map(|(mesh, _)| mesh)
}

fn read_valve(path: &Path) -> Result<Geometry, Vec<Fault>> {
    let of = Geometry::of_closed_surface(&read_surface(path)?);
    of.map_err(|message| {
        fault(
            path,
            format!("{message}: close the valve again with this version"),
        )
    })
}

/// Chords where their file is; a valve may have none.
fn read_chords(path: &Path, open: Option<&Path>) -> Result<Option<Chords>, Vec<Fault>> {
    if !path.is_file() {
        return Ok(None);
    }
    let open = open.filter(|open| open.is_file()).map(read_surface).transpose()?;
    let chords = Chords::new(&read_surface(path)?, open.as_ref());
    chords.map(Some).map_err(|message| fault(path, message))
}

fn read_rings(folder: &Path) -> Result<Vec<Coded<f32>>, Vec<Fault>> {
    let names = files_in(folder).unwrap_or_default().into_iter().filter(|path| {
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        name == "ring" || name.starts_with("ring_")
    });
    names.map(|path| Ok(curve(&read_surface(&path)?))).collect()
}

/// Surfaces in a folder, by name; none where it cannot be read.
fn files_in(folder: &Path) -> Option<Vec<PathBuf>> {
    let entries = std::fs::read_dir(folder)
        .ok()?
        .flatten()
        .map(|entry| entry.path());
    let mut files: Vec<PathBuf> = entries
        .filter(|path| path.extension().is_some_and(|extension| extension == "vtp"))
        .collect();
    files.sort_unstable();
    Some(files)
}

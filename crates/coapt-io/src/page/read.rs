//! A folder of results, as `coapt closure --out` and `coapt plan --out --shapes` write them.

use std::path::{Path, PathBuf};

use coapt::measure::{Measures, ValveFrame};
use coapt::scene::Fault;
use serde::Deserialize;
use serde_json::Value;

use super::coded::Coded;
use super::film::page_films;
use super::geometry::{Chords, Geometry, curve};
use super::{Page, PageState, Seals};
use crate::atomic::{LIST, files_of_other_runs};
use crate::mesh::{PolyData, read_mesh};
use crate::record::RecordedFilm;
use crate::report::{TableRow, rows_of};
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
    let [closure, plan] = ["report.json", "plan.json"].map(|name| folder.join(name));
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
    let state = |key: &str, name: &str, folder: &Path| -> Result<PageState, Vec<Fault>> {
        let told = &report[key];
        let certificate = parsed(path, &format!("{key}.solve"), &told["solve"])?;
        let mut geometry = read_valve(&folder.join("closed.vtp"))?;
        let chords = [folder.join("chords.vtp"), folder.join("open_chords.vtp")];
        geometry.chords = read_chords(&chords[0], Some(&chords[1]))?;
        geometry.rings = read_rings(folder)?;
        Ok(PageState {
            name: name.to_owned(),
            rank: None,
            only_takes_chordae: false,
            certificate,
            chord_groups: parsed(path, &format!("{key}.chord_groups"), &told["chord_groups"])?,
            geometry,
            seals: None,
        })
    };
    let states = match report.get("after") {
        Some(_) => vec![
            state("before", "before", &folder.join("before"))?,
            state("after", "after", &folder.join("after"))?,
        ],
        None => vec![state("before", "the valve", folder)?],
    };
    let measures = match states.len() {
        1 => vec![&report["before"]],
        _ => vec![&report["before"], &report["after"]],
    };
    let rows = table(path, &measures)?;
    page(path, report, None, states, rows)
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
    let state = |number: u64, name: &str, told: &Value| -> Result<PageState, Vec<Fault>> {
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
        Ok(PageState {
            name: name.to_owned(),
            rank: told["rank"].as_u64(),
            only_takes_chordae: told["only_takes_chordae"].as_bool().unwrap_or(false),
            certificate: parsed(path, &format!("solve of {name}"), &told["solve"])?,
            chord_groups: group_names(&report["before"], told),
            geometry,
            seals: seals(&told["uncertainty"]),
        })
    };
    let mut states = vec![state(0, "before", &report["before"])?];
    let mut measures = vec![&report["before"]];
    let rows = report["alternatives"].as_array().map_or(&[][..], Vec::as_slice);
    let closed = rows.iter().filter(|row| row["solve"].is_object());
    for row in closed.take(most_alternatives) {
        let number = row["number"].as_u64().unwrap_or(0);
        states.push(state(number, row["name"].as_str().unwrap_or("?"), row)?);
        measures.push(row);
    }
    let rows = table(path, &measures)?;
    let plan = report["plan"].as_str().unwrap_or("").to_owned();
    page(path, report, Some(plan), states, rows)
}

/// The table of the measures of some states.
fn table(path: &Path, states: &[&Value]) -> Result<Vec<TableRow>, Vec<Fault>> {
    let measures = states.iter().map(|told| parsed(path, "measures", told));
    let measures: Vec<Measures> = measures.collect::<Result<_, _>>()?;
    Ok(rows_of(&measures.iter().collect::<Vec<_>>()))
}

fn page(
    path: &Path,
    report: Value,
    plan: Option<String>,
    states: Vec<PageState>,
    rows: Vec<TableRow>,
) -> Result<Page, Vec<Fault>> {
    let frame: ValveFrame = parsed(path, "frame", &report["frame"])?;
    let word = |key: &str| report[key].as_str().unwrap_or("").to_owned();
    Ok(Page {
        case: word("case"),
        plan,
        version: word("version"),
        pressure_mmhg: parsed(path, "pressure_mmhg", &report["pressure_mmhg"])?,
        frame,
        rows,
        states,
        report,
    })
}

/// Names of the chord groups of an alternative in the order of its model: chordae of the valve, then what repairs strung. A plan tells
/// neochordae and sutures apart, not in which order they came: where there are both, no names are given.
fn group_names(before: &Value, told: &Value) -> Vec<String> {
    let names = |state: &Value, path: &str| -> Vec<String> {
        let groups = state
            .pointer(path)
            .and_then(Value::as_array)
            .into_iter()
            .flatten();
        groups
            .map(|group| group["name"].as_str().unwrap_or("?").to_owned())
            .collect()
    };
    let chordae = names(told, "/chords/groups");
    let sutures = names(told, "/sutures");
    let strung = chordae.len() > names(before, "/chords/groups").len();
    match strung && !sutures.is_empty() {
        true => Vec::new(),
        false => [chordae, sutures].concat(),
    }
}

fn seals(uncertainty: &Value) -> Option<Seals> {
    let sealed = &uncertainty["sealed"];
    let part = |key: &str| sealed[key].as_f64();
    Some(Seals {
        probability: [part("estimate")?, part("low")?, part("high")?],
        samples: uncertainty["certified"].as_u64()?,
    })
}

fn read_json(path: &Path) -> Result<Value, Vec<Fault>> {
    let text = read_text(path).map_err(|fault| vec![fault])?;
    serde_json::from_str(&text).map_err(|error| fault(path, error.to_string()))
}

/// A part of a report; `key` is what messages call it.
fn parsed<T: for<'a> Deserialize<'a>>(path: &Path, key: &str, value: &Value) -> Result<T, Vec<Fault>> {
    T::deserialize(value).map_err(|error| {
        fault(
            path,
            format!("`{key}` cannot be read ({error}): close the valve again with this version"),
        )
    })
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

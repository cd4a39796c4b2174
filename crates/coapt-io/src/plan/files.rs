//! A comparison as files.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use coapt::Vec3;
use coapt::model::Model;
use coapt::plan::{Comparison, apply_all};
use coapt::repair::Report;
use coapt::scene::Fault;

use super::{PlanReport, csv, long_csv, units_csv};
use crate::atomic::{Batch, make_folder};
use crate::mesh::stage_vtp;
use crate::report::{ring_curves, stage_closed_chords, stage_closed_surface};
use crate::scene::BEFORE;

/// Where the vertices of a comparison's closed valves came to rest [mm], shape `[vertex]` each; empty where they were not kept.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shapes {
    /// Without any repair.
    pub before_mm: Vec<Vec3>,
    /// After the alternatives that were closed, by their numbers in the order of the plan, from 1.
    pub after_mm: BTreeMap<usize, Vec<Vec3>>,
}

impl From<Comparison> for Shapes {
    fn from(comparison: Comparison) -> Self {
        let closed = comparison.rows.into_iter().filter_map(|row| {
            let outcome = row.result.ok()?;
            Some((row.alternative + 1, outcome.positions_mm))
        });
        Self {
            before_mm: comparison.before.positions_mm,
            after_mm: closed.collect(),
        }
    }
}

/// Folder of the closed shapes.
const SHAPES: &str = "shapes";

/// Writes all tables into a folder, which is made if need be, and the closed shapes where the comparison kept them; files of an
/// earlier comparison are replaced, all of them once all are written. The same comparison gives the same bytes.
///
/// # Errors
/// What the file system says.
pub fn write_plan(folder: &Path, report: &PlanReport, model: &Model, shapes: &Shapes) -> Result<(), Fault> {
    make_folder(folder)?;
    let mut batch = Batch::default();
    for (name, text) in [
        ("plan.json", report.json()?),
        ("plan.csv", csv(report)),
        ("plan_long.csv", long_csv(report)),
        ("plan_units.csv", units_csv()),
    ] {
        batch.write(&folder.join(name), text.as_bytes())?;
    }
    let written = stage_shapes(&mut batch, folder, report, model, shapes)?;
    for old in shapes_in(&folder.join(SHAPES)) {
        if !written.contains(&old) {
            batch.remove(old);
        }
    }
    batch.finish_listed(folder)
}

/// Makes the folder for closed shapes, to know before the work that it can be made.
///
/// # Errors
/// What the file system says.
pub fn prepare_shapes(folder: &Path) -> Result<(), Fault> {
    make_folder(&folder.join(SHAPES))
}

fn stage_shapes(
    batch: &mut Batch,
    folder: &Path,
    report: &PlanReport,
    model: &Model,
    shapes: &Shapes,
) -> Result<Vec<PathBuf>, Fault> {
    let mut written = Vec::new();
    let mut stage = |number: usize, name: &str, model: &Model, positions_mm: &[Vec3], reports: &[Report]| {
        if positions_mm.is_empty() {
            return Ok(());
        }
        prepare_shapes(folder)?;
        let shape = folder.join(SHAPES).join(file_name(number, name, ".vtp"));
        stage_closed_surface(batch, &shape, model, positions_mm)?;
        written.push(shape);
        if !model.chords.ends.is_empty() {
            let chords = folder.join(SHAPES).join(file_name(number, name, "_chords.vtp"));
            stage_closed_chords(batch, &chords, model, positions_mm)?;
            written.push(chords);
        }
        // There is one at most.
        for curve in ring_curves(reports) {
            let ring = folder.join(SHAPES).join(file_name(number, name, "_ring.vtp"));
            stage_vtp(batch, &ring, &curve)?;
            written.push(ring);
        }
        Ok(())
    };
    stage(0, BEFORE, model, &shapes.before_mm, &[])?;
    for row in &report.alternatives {
        let kept = shapes.after_mm.get(&row.number);
        let Some(positions_mm) = kept.filter(|kept| !kept.is_empty()) else {
            continue;
        };
        // Models of thousands of alternatives were not kept; to make one is nothing beside writing its shape.
        if let Ok(applied) = apply_all(model, &row.repairs) {
            stage(
                row.number,
                &row.name,
                &applied.model,
                positions_mm,
                &applied.reports,
            )?;
        }
    }
    Ok(written)
}

/// Letters of a name that are part of a file name, at most.
const LONGEST_NAME: usize = 60;

/// `0012_ring-28-clip-A2P2.vtp`: letters, digits and points, everything else as hyphens.
fn file_name(number: usize, name: &str, ending: &str) -> String {
    let words = name.split(|letter: char| !(letter.is_ascii_alphanumeric() || letter == '.'));
    let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
    let name: String = words.join("-").chars().take(LONGEST_NAME).collect();
    format!("{number:04}_{name}{ending}")
}

/// Files of an earlier comparison: nothing else is touched.
fn shapes_in(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let is_ours = |path: &PathBuf| {
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or("");
        let (number, rest) = name.split_once('_').unwrap_or(("", ""));
        number.len() >= 4 && number.bytes().all(|byte| byte.is_ascii_digit()) && rest.ends_with(".vtp")
    };
    entries.map(|entry| entry.path()).filter(is_ours).collect()
}

//! Results as files: the report, and the valve open and closed with what is known at every point.
//!
//! | file | holds |
//! |---|---|
//! | `report.json` | the report |
//! | `open.vtp`, `closed.vtp` | leaflets; cells `leaflet`; points `annulus`; points `along`, `from_margin_mm` of the leaflets laid flat; closed also points `gap_mm`, `contact`, `strain`, `displacement_mm`, `annulus_distance_mm` |
//! | `open_chords.vtp`, `chords.vtp` | chordae; cells `group`, `rest_length_mm`; closed also `force_n` |
//! | `ring.vtp` | the ring where it lies, after an annuloplasty |
//! | `SHA256SUMS` | all of these with their checksums, written last |
//!
//! With a plan the surfaces stand twice, in `before/` and `after/`.

use std::path::Path;

use coapt::Vec3;
use coapt::measure;
use coapt::model::Model;
use coapt::repair;
use coapt::scene::Fault;

use super::{Closed, Closure, Report};
use crate::atomic::{Batch, make_folder};
use crate::mesh::{Array, PolyData, stage_vtp, write_vtp};

/// Writes all results into a folder, which is made if need be; files of the same names are replaced, all of them once all are
/// written. The same closure gives the same bytes, but for the wall-clock times in the report.
///
/// # Errors
/// What the file system says.
pub fn write_results(folder: &Path, closure: &Closure, report: &Report) -> Result<(), Fault> {
    let mut batch = Batch::default();
    stage_results(&mut batch, folder, closure, report)?;
    batch.finish_listed(folder)
}

/// The same as part of a batch.
///
/// # Errors
/// As [`write_results`].
pub fn stage_results(
    batch: &mut Batch,
    folder: &Path,
    closure: &Closure,
    report: &Report,
) -> Result<(), Fault> {
    make_folder(folder)?;
    batch.write(&folder.join("report.json"), report.json()?.as_bytes())?;
    let Some(after) = &closure.after else {
        remove_valve(batch, &folder.join("before"));
        remove_valve(batch, &folder.join("after"));
        return stage_valve(batch, folder, &closure.before);
    };
    remove_valve(batch, folder);
    stage_valve(batch, &folder.join("before"), &closure.before)?;
    stage_valve(batch, &folder.join("after"), after)?;
    for (number, curve) in ring_curves(&closure.repairs).iter().enumerate() {
        let name = match number {
            0 => "ring.vtp".to_owned(),
            _ => format!("ring_{}.vtp", number + 1),
        };
        stage_vtp(batch, &folder.join("after").join(name), curve)?;
    }
    Ok(())
}

/// Files that an earlier run with, or without, a plan may have left: beside the new report they would tell of another
/// valve. Nothing else is touched.
const VALVE_FILES: [&str; 5] = [
    "open.vtp",
    "closed.vtp",
    "open_chords.vtp",
    "chords.vtp",
    "ring.vtp",
];

fn remove_valve(batch: &mut Batch, folder: &Path) {
    VALVE_FILES
        .iter()
        .for_each(|name| batch.remove(folder.join(name)));
}

fn stage_valve(batch: &mut Batch, folder: &Path, closed: &Closed) -> Result<(), Fault> {
    make_folder(folder)?;
    let model = &closed.model;
    let positions = &closed.equilibrium.state.positions_mm;
    stage_vtp(batch, &folder.join("open.vtp"), &leaflets(model, &model.rest_mm))?;
    stage_vtp(
        batch,
        &folder.join("closed.vtp"),
        &closed_surface(model, positions),
    )?;
    if model.chords.ends.is_empty() {
        return Ok(());
    }
    stage_vtp(
        batch,
        &folder.join("open_chords.vtp"),
        &chords(model, &model.rest_mm),
    )?;
    stage_closed_chords(batch, &folder.join("chords.vtp"), model, positions)
}

/// [`loaded_chords`] under any name, as part of a batch.
pub(crate) fn stage_closed_chords(
    batch: &mut Batch,
    path: &Path,
    model: &Model,
    positions_mm: &[Vec3],
) -> Result<(), Fault> {
    stage_vtp(batch, path, &loaded_chords(model, positions_mm))
}

/// Writes [`closed_surface`] under any name.
///
/// # Errors
/// A position that is not finite, or what the file system says.
pub fn write_closed_surface(path: &Path, model: &Model, positions_mm: &[Vec3]) -> Result<(), Fault> {
    write_vtp(path, &closed_surface(model, positions_mm))
}

/// The same as part of a batch.
pub(crate) fn stage_closed_surface(
    batch: &mut Batch,
    path: &Path,
    model: &Model,
    positions_mm: &[Vec3],
) -> Result<(), Fault> {
    stage_vtp(batch, path, &closed_surface(model, positions_mm))
}

/// What `closed.vtp` holds, from positions of any source: the leaflets with what is known at every point.
pub fn closed_surface(model: &Model, positions_mm: &[Vec3]) -> PolyData {
    let mut surface = leaflets(model, positions_mm);
    surface.point_arrays.extend(at_points(model, positions_mm));
    surface
}

/// The leaflets in some position.
fn leaflets(model: &Model, positions_mm: &[Vec3]) -> PolyData {
    let count = model.leaflet_vertex_count;
    let map = measure::leaflet_map(model);
    let mut on_annulus = vec![0.0; count];
    for &vertex in &model.annulus {
        on_annulus[vertex as usize] = 1.0;
    }
    PolyData {
        points: positions_mm.iter().take(count).map(|&p| p.into()).collect(),
        triangles: model.faces.clone(),
        point_arrays: vec![
            array("annulus", 1, on_annulus.into_iter()),
            array("along", 1, map.along.into_iter()),
            array("from_margin_mm", 1, map.from_margin_mm.into_iter()),
        ],
        cell_arrays: vec![array(
            "leaflet",
            1,
            model.face_leaflet.iter().map(|&number| f64::from(number)),
        )],
        ..PolyData::default()
    }
}

/// What is known at the points of the closed leaflets.
fn at_points(model: &Model, positions_mm: &[Vec3]) -> Vec<Array> {
    let count = model.leaflet_vertex_count;
    let contact = measure::in_contact(model, positions_mm);
    let moved = positions_mm.iter().zip(&model.rest_mm).take(count);
    vec![
        array(
            "gap_mm",
            1,
            measure::gap_mm(model, positions_mm).into_iter().take(count),
        ),
        array("contact", 1, contact.into_iter().take(count).map(f64::from)),
        array(
            "strain",
            1,
            measure::vertex_strain(model, positions_mm)
                .into_iter()
                .take(count),
        ),
        array(
            "displacement_mm",
            3,
            moved.flat_map(|(now, open)| <[f64; 3]>::from(now - open)),
        ),
        array(
            "annulus_distance_mm",
            1,
            measure::annulus_distance_mm(model, positions_mm).into_iter(),
        ),
    ]
}

/// What `chords.vtp` holds: the chordae with their tensions.
pub(crate) fn loaded_chords(model: &Model, positions_mm: &[Vec3]) -> PolyData {
    let mut lines = chords(model, positions_mm);
    let forces_n = measure::chord_forces(model, positions_mm).into_iter();
    lines.cell_arrays.push(array("force_n", 1, forces_n));
    lines
}

/// The chordae in some position.
pub(crate) fn chords(model: &Model, positions_mm: &[Vec3]) -> PolyData {
    let chords = &model.chords;
    PolyData {
        points: (0..chords.points.len() as u32)
            .map(|point| chords.point_mm(point, positions_mm).into())
            .collect(),
        lines: chords.ends.clone(),
        cell_arrays: vec![
            array("group", 1, chords.group.iter().map(|&group| f64::from(group))),
            array("rest_length_mm", 1, chords.rest_length_mm.iter().copied()),
        ],
        ..PolyData::default()
    }
}

/// What `ring.vtp` holds, of each ring.
pub(crate) fn ring_curves(reports: &[repair::Report]) -> Vec<PolyData> {
    let rings = reports.iter().filter_map(|report| match report {
        repair::Report::Ring(ring) => Some(polyline(&ring.curve_mm, ring.closed)),
        _ => None,
    });
    rings.collect()
}

fn polyline(points: &[Vec3], closed: bool) -> PolyData {
    let count = points.len() as u32;
    let mut lines: Vec<[u32; 2]> = (1..count).map(|end| [end - 1, end]).collect();
    if closed && count > 2 {
        lines.push([count - 1, 0]);
    }
    PolyData {
        points: points.iter().map(|&p| p.into()).collect(),
        lines,
        ..PolyData::default()
    }
}

fn array(name: &str, components: usize, values: impl Iterator<Item = f64>) -> Array {
    Array {
        name: name.into(),
        components,
        values: values.collect(),
    }
}

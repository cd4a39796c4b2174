//! A study as a table: comma-separated for machines, aligned for people.

use std::fmt::Write;

use coapt::measure::VisibleDistance;
use coapt::relax::Status;

use super::{Factor, Row, Study};
use crate::escape::escaped;

const COLUMNS: &str = "varied,faces,residual_tolerance,contact_thickness_mm,status,certified,residual,iterations,\
                       crossings,wall_ms,rms_mm,mean_mm,p95_mm,max_mm,own_mesh_rms_mm,on_front,knee";

/// A line per closure, columns with their names in the first line; errors are empty where nothing is visible.
pub fn csv(study: &Study) -> String {
    let mut out = format!("{COLUMNS}\n");
    for row in &study.rows {
        let error = row.error.map_or(",,,".to_owned(), |e| {
            format!("{},{},{},{}", e.rms_mm, e.mean_mm, e.p95_mm, e.max_mm)
        });
        // Writing to a string cannot fail.
        let _ = writeln!(
            out,
            "{},{},{:e},{},{},{},{:e},{},{},{},{error},{},{},{}",
            row.varied.name(),
            row.faces,
            row.residual_tolerance,
            row.contact_thickness_mm,
            status_name(row.status),
            row.certified,
            row.residual,
            row.iterations,
            row.crossings,
            row.wall_ms,
            row.own_mesh_rms_mm.map_or(String::new(), |mm| mm.to_string()),
            row.on_front,
            row.knee
        );
    }
    out
}

pub(crate) fn status_name(status: Status) -> &'static str {
    match status {
        Status::Converged => "converged",
        Status::IterationLimit => "iteration-limit",
        Status::Stalled => "stalled",
        Status::Burst => "burst",
        Status::TangledStart => "tangled-start",
        Status::Interrupted => "interrupted",
    }
}

/// The study as a person reads it, at most 100 letters wide, with a line break at its end.
pub fn text(study: &Study) -> String {
    let mut out = format!(
        "{}: error against time of {} closures, each the median of {} (coapt {})\n",
        escaped(&study.case),
        study.rows.len(),
        study.repeats,
        study.version
    );
    let reference = study.reference;
    let _ = writeln!(
        out,
        "reference: {} triangles, residual {:.1e}; error: root mean square\n\
         distance between visible surfaces; own mesh: the same to its tightest tolerance",
        reference.faces, reference.residual
    );
    if study.is_without_mesh_error() {
        out += "it is a distance to the same mesh: what the mesh costs is not in it\n";
    }
    out.push('\n');
    out += "triangles  tolerance  thickness     time  steps   error    95 %  largest  own mesh\n";
    out += "                             mm       ms             mm      mm       mm        mm\n";
    for row in &study.rows {
        line(&mut out, row);
    }
    let _ = match study.knee_row() {
        Some(row) => writeln!(
            out,
            "\nknee: {} triangles to a residual of {:e}: {:.1} ms, {} mm\n\
             (farthest below the line between the ends of the front, in decades)",
            row.faces,
            row.residual_tolerance,
            row.wall_ms,
            short(row.error.map(|error| error.rms_mm))
        ),
        None => writeln!(out, "\nno knee: the front has no bend"),
    };
    let _ = writeln!(out, "\n{}", study.notice);
    out
}

fn line(out: &mut String, row: &Row) {
    let error = |of: fn(&VisibleDistance) -> f64| short(row.error.as_ref().map(of));
    let _ = writeln!(
        out,
        "{:>9}  {:>9e}  {:>9}  {:>7.1}  {:>5}  {:>6}  {:>6}  {:>7}  {:>8}{}",
        row.faces,
        row.residual_tolerance,
        row.contact_thickness_mm,
        row.wall_ms,
        row.iterations,
        error(|error| error.rms_mm),
        error(|error| error.p95_mm),
        error(|error| error.max_mm),
        short(row.own_mesh_rms_mm),
        note(row)
    );
}

/// Three digits, in powers of ten where they begin late.
pub(super) fn short(value_mm: Option<f64>) -> String {
    match value_mm {
        None => "-".to_owned(),
        Some(value) if value < 1e-3 && value > 0.0 => format!("{value:.0e}"),
        Some(value) => format!("{value:.3}"),
    }
}

fn note(row: &Row) -> &'static str {
    match row {
        Row { certified: false, .. } => "  NOT CERTIFIED",
        Row { knee: true, .. } => "  knee",
        Row { on_front: true, .. } => "  front",
        Row {
            varied: Factor::ContactThickness,
            ..
        } => "  thickness",
        _ => "",
    }
}

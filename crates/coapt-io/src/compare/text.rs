//! A comparison as a person reads it: what was compared, and a row for every definition.

use std::fmt::Write;

use coapt::measure::DistanceStatistics;
use coapt::measure::compare::{AlignmentMethod, Comparison, Definitions, Regions, SurfaceSummary};
use coapt::scene::Space;

use super::{ComparisonReport, FileOf};
use crate::escape::escaped;
use crate::report::{line, number};

/// Columns: the definition, how many distances, a statistic.
const NAME: usize = 42;
const COUNT: usize = 9;
const VALUE: usize = 8;

/// What stands below the tables.
const DEFINITIONS: &str = "\
Distances in mm, from where a row says to the whole of the other surface; parts are parts of the
surface that is measured from. SD about the mean, divided by n: RMS2 = mean2 + SD2.
  vertices   to the nearest point of the other surface, each vertex counting the same, percentiles
             between ranks (result -> reference: paper 000; paper 003, weights not stated)
  by area    the same, each vertex weighing a third of its faces' area; percentiles of the area
  centroid   from each triangle's centroid to the nearest one of the reference (paper 002); meshes
             of one surface are a quarter of an edge apart, so never set it against the rows above
  node       from each node to its like, where both surfaces are one mesh
  visible    seen from the atrium, slits of contact closed; paper 002 compares what its probe sees
";

/// The comparison as text, with a line break at its end.
pub fn text(report: &ComparisonReport) -> String {
    let mut out = String::new();
    let c = &report.comparison;
    // Writing to a string cannot fail.
    let _ = writeln!(out, "distance between two surfaces (coapt {})", report.version);
    surface(&mut out, "result", &report.result_file, &c.result);
    surface(&mut out, "reference", &report.reference_file, &c.reference);
    let meshes = match c.nodes_correspond {
        true => "the same in both: nodes correspond",
        false => "differ: no distance from node to node",
    };
    let _ = writeln!(out, "{:10} {meshes}", "meshes");
    let _ = writeln!(out, "{:10} {}", "alignment", alignment(c));
    unknown(&mut out, report);
    table(&mut out, "AS GIVEN, mm", &c.as_given, c);
    table(&mut out, "AFTER RIGID ALIGNMENT, mm", &c.aligned, c);
    let _ = write!(out, "\n{DEFINITIONS}");
    if !report.warnings.is_empty() {
        out.push('\n');
    }
    for warning in &report.warnings {
        line(&mut out, "warning", warning);
    }
    let _ = writeln!(out, "\n{}", report.notice);
    out
}

fn surface(out: &mut String, name: &str, file: &FileOf, summary: &SurfaceSummary) {
    let space = match file.space {
        Some(Space::LPS) => "LPS",
        Some(Space::RAS) => "RAS, turned to LPS",
        None => "no frame mark, taken as LPS",
    };
    let _ = writeln!(out, "{name:10} {} ({space})", escaped(&file.path));
    let mut parts = format!(
        "{} triangles, {} points, {:.0} mm2, mean edge {:.2} mm",
        summary.faces, summary.points, summary.area_mm2, summary.mean_edge_mm
    );
    for (share, what) in [
        (summary.visible_share, "visible"),
        (summary.contact_share, "in contact"),
    ] {
        if let Some(share) = share {
            let _ = write!(parts, ", {:.0} % {what}", 100.0 * share);
        }
    }
    let _ = writeln!(out, "{:10} {parts}", "");
}

fn alignment(c: &Comparison) -> String {
    let a = &c.alignment;
    let method = match a.method {
        AlignmentMethod::Nodes => "node on node (Kabsch)".to_owned(),
        AlignmentMethod::Surface => {
            let rest = if a.converged { "" } else { ", not at rest" };
            format!("points on surface (ICP, {} iterations{rest})", a.iterations)
        }
    };
    let [x, y, z] = a.translation_mm.map(|x| number(x, 3));
    let length = a.translation_mm.iter().map(|x| x * x).sum::<f64>().sqrt();
    format!(
        "{method}: turn {:.3} deg, shift {length:.3} mm ({x}, {y}, {z})",
        a.rotation_deg
    )
}

/// Parts that are not known, and why.
fn unknown(out: &mut String, report: &ComparisonReport) {
    let c = &report.comparison;
    if c.as_given.visible.is_none() {
        let _ = writeln!(out, "{:10} not known: no direction to the atrium", "visible");
    }
    let array = &report.contact_array;
    let who = match (c.result.contact_share, c.reference.contact_share) {
        (Some(_), Some(_)) => return,
        (None, None) => "neither file has",
        (None, Some(_)) => "of the reference only: the result has not",
        (Some(_), None) => "of the result only: the reference has not",
    };
    let known = if c.as_given.in_contact.is_none() {
        "not known: "
    } else {
        "known "
    };
    let _ = writeln!(out, "{:10} {known}{who} a point array `{array}`", "contact");
}

fn table(out: &mut String, title: &str, regions: &Regions, c: &Comparison) {
    let _ = write!(out, "\n{title:NAME$}{:>COUNT$}", "n");
    for head in ["mean", "SD", "RMS", "5 %", "95 %", "max"] {
        let _ = write!(out, "{head:>VALUE$}");
    }
    out.push('\n');
    let parts = [
        ("whole surface", Some(&regions.whole)),
        ("visible from the atrium", regions.visible.as_ref()),
        ("in contact", regions.in_contact.as_ref()),
        ("not in contact", regions.not_in_contact.as_ref()),
    ];
    for (name, definitions) in parts {
        let Some(definitions) = definitions else { continue };
        let _ = writeln!(out, "{name}");
        for (name, found) in rows(definitions) {
            row(out, name, found);
        }
        if !c.nodes_correspond {
            continue;
        }
        row(out, "node -> node", definitions.node_to_node.as_ref());
    }
}

fn rows(d: &Definitions) -> [(&'static str, Option<&DistanceStatistics>); 5] {
    [
        ("result -> reference, vertices", d.result_to_reference.as_ref()),
        (
            "result -> reference, by area",
            d.result_to_reference_by_area.as_ref(),
        ),
        ("reference -> result, vertices", d.reference_to_result.as_ref()),
        (
            "reference -> result, by area",
            d.reference_to_result_by_area.as_ref(),
        ),
        ("centroid -> centroid", d.centroid_to_centroid.as_ref()),
    ]
}

fn row(out: &mut String, name: &str, found: Option<&DistanceStatistics>) {
    let _ = write!(out, "  {name:width$}", width = NAME - 2);
    match found {
        None => {
            let _ = write!(out, "{:>COUNT$}", "-");
        }
        Some(d) => {
            let _ = write!(out, "{:>COUNT$}", d.count);
            for value in [d.mean_mm, d.sd_mm, d.rms_mm, d.p05_mm, d.p95_mm, d.max_mm] {
                let _ = write!(out, "{:>VALUE$}", number(value, 3));
            }
        }
    }
    out.push('\n');
}

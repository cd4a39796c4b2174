//! A study of tissue laws: one valve, one tissue told in each law; what a closure costs and how far it is off.

use std::borrow::Cow;
use std::fmt::Write;
use std::path::Path;

use coapt::measure::VisibleDistance;
use coapt::relax::Status;
use coapt::scene::{Fault, Tissue, Wrinkling};
use serde::{Deserialize, Serialize};

use super::json;
use super::table::{short, status_name};
use crate::atomic::write_files;
use crate::escape::escaped;

/// The layout of `laws.json`.
pub const LAWS_SCHEMA: &str = "coapt-laws/1";

/// What `mesh_error` is.
pub const ERROR_OF_LAWS_MEANS: &str = "distance to the closure of the reference mesh under the same law, where the valve \
                                       is seen from the atrium";

/// What `model_error` is.
pub const MODEL_ERROR_MEANS: &str = "distance to the closure of the same mesh under the first law, where the valve is seen \
                                     from the atrium";

/// All closures of a study of laws.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LawStudy {
    /// [`LAWS_SCHEMA`].
    pub schema: Cow<'static, str>,
    /// Version of the program.
    pub version: Cow<'static, str>,
    /// [`crate::report::NOTICE`].
    pub notice: Cow<'static, str>,
    /// [`ERROR_OF_LAWS_MEANS`].
    pub mesh_error: Cow<'static, str>,
    /// [`MODEL_ERROR_MEANS`].
    pub model_error: Cow<'static, str>,
    /// Name of the case.
    pub case: String,
    /// Closures under each law; times are their medians.
    pub repeats: u16,
    /// Triangles of the reference mesh; absent where a scene has but its own mesh.
    pub reference_faces: Option<usize>,
    /// Names of the leaflets, shape `[leaflet]`.
    pub leaflets: Vec<String>,
    /// The closures: for each mesh each law, in one order.
    pub rows: Vec<LawRow>,
}

/// One closure under one law.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LawRow {
    /// Triangles.
    pub faces: usize,
    /// The law with its constants, shape `[leaflet]`.
    pub tissues: Vec<Tissue>,
    /// How far the law is from the tissue's biaxial curve: root mean square of the error over that of the stress [1], shape
    /// `[leaflet]`.
    pub curve_error: Vec<f64>,
    /// Why the solver stopped.
    pub status: Status,
    /// Whether the result may be used: converged, stable, nothing crosses.
    pub certified: bool,
    /// Residual reached [1].
    pub residual: f64,
    /// Solver iterations.
    pub iterations: usize,
    /// Wall-clock time of the closure, certificate included, median [ms].
    pub wall_ms: f64,
    /// Distance to the reference mesh; absent without a certified one, or where nothing is visible.
    pub mesh_error: Option<VisibleDistance>,
    /// Distance to the first law; absent of that itself, where it is not certified, or nothing is visible.
    pub model_error: Option<VisibleDistance>,
    /// Area of contact of the leaflets [mm²].
    pub coaptation_area_mm2: f64,
    /// Regurgitant orifice area [mm²].
    pub orifice_area_mm2: f64,
    /// Largest tension of any chord segment [N].
    pub largest_chord_force_n: f64,
}

impl LawRow {
    /// The law as scenes name it; of the first leaflet, as all have one law.
    pub fn law(&self) -> &'static str {
        self.tissues.first().map_or("", Tissue::law_name)
    }

    /// What happens under compression, as scenes name it; springs have no such choice.
    pub fn wrinkling(&self) -> &'static str {
        match self.tissues.first().and_then(Tissue::wrinkling) {
            Some(Wrinkling::Resolved) => "resolved",
            Some(Wrinkling::TensionField) => "tension-field",
            None => "",
        }
    }
}

/// Writes table and object into a folder, which is made if need be; files of the same names are replaced.
///
/// # Errors
/// What the file system says.
pub fn write_laws(folder: &Path, study: &LawStudy) -> Result<(), Fault> {
    let json = json(folder, study)?;
    write_files(folder, &[("laws.csv", csv(study)), ("laws.json", json)])
}

const COLUMNS: &str = "faces,law,wrinkling,curve_error,status,certified,residual,iterations,wall_ms,mesh_rms_mm,\
                       mesh_p95_mm,mesh_max_mm,model_rms_mm,model_p95_mm,model_max_mm,coaptation_area_mm2,\
                       orifice_area_mm2,largest_chord_force_n";

/// A line per closure, columns with their names in the first line; `curve_error` is the worst leaflet's, distances are empty
/// where they are absent.
pub fn csv(study: &LawStudy) -> String {
    let mut out = format!("{COLUMNS}\n");
    let distance = |distance: Option<VisibleDistance>| {
        distance.map_or(",,".to_owned(), |d| {
            format!("{},{},{}", d.rms_mm, d.p95_mm, d.max_mm)
        })
    };
    for row in &study.rows {
        // Writing to a string cannot fail.
        let _ = writeln!(
            out,
            "{},{},{},{},{},{},{:e},{},{},{},{},{},{},{}",
            row.faces,
            row.law(),
            row.wrinkling(),
            row.curve_error
                .iter()
                .fold(0.0, |worst: f64, &error| worst.max(error)),
            status_name(row.status),
            row.certified,
            row.residual,
            row.iterations,
            row.wall_ms,
            distance(row.mesh_error),
            distance(row.model_error),
            row.coaptation_area_mm2,
            row.orifice_area_mm2,
            row.largest_chord_force_n
        );
    }
    out
}

/// The study as a person reads it, at most 100 letters wide, with a line break at its end.
pub fn text(study: &LawStudy) -> String {
    let mut out = format!(
        "{}: one tissue in each law, each the median of {} closures (coapt {})\n",
        escaped(&study.case),
        study.repeats,
        study.version
    );
    let mesh = match study.reference_faces {
        Some(faces) => format!("to {faces} triangles of the same law"),
        None => "none: a scene has but its own mesh".to_owned(),
    };
    let _ = writeln!(
        out,
        "errors: root mean square distance between visible surfaces;\n\
         mesh: {mesh}; model: to the same mesh of the first law"
    );
    out += "triangles  law                  wrinkling      steps     time   mesh  model  coapt  orifice  chord\n";
    out += "                                                           ms     mm     mm    mm²      mm²      N\n";
    for row in &study.rows {
        line(&mut out, row);
    }
    let _ = writeln!(out, "\n{}", study.notice);
    out
}

fn line(out: &mut String, row: &LawRow) {
    let error = |distance: Option<VisibleDistance>| short(distance.map(|distance| distance.rms_mm));
    let _ = writeln!(
        out,
        "{:>9}  {:<19}  {:<13}  {:>5}  {:>7.1}  {:>5}  {:>5}  {:>5.1}  {:>7.2}  {:>5.3}{}",
        row.faces,
        row.law(),
        row.wrinkling(),
        row.iterations,
        row.wall_ms,
        error(row.mesh_error),
        error(row.model_error),
        row.coaptation_area_mm2,
        row.orifice_area_mm2,
        row.largest_chord_force_n,
        if row.certified { "" } else { " !" }
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::NOTICE;

    fn row(tissue: Tissue) -> LawRow {
        LawRow {
            faces: 650,
            tissues: vec![tissue; 2],
            curve_error: vec![0.25, 0.125],
            status: Status::Converged,
            certified: true,
            residual: 5e-7,
            iterations: 40,
            wall_ms: 12.5,
            mesh_error: None,
            model_error: Some(VisibleDistance {
                rms_mm: 0.5,
                mean_mm: 0.4,
                p95_mm: 1.0,
                max_mm: 2.0,
            }),
            coaptation_area_mm2: 200.0,
            orifice_area_mm2: 0.0,
            largest_chord_force_n: 1.5,
        }
    }

    fn study() -> LawStudy {
        let membrane = Tissue::StVenantKirchhoff {
            modulus_mpa: 0.4,
            poisson_ratio: 0.5,
            wrinkling: Wrinkling::TensionField,
            bending_modulus_mpa: 0.48,
        };
        let failed = LawRow {
            certified: false,
            status: Status::Stalled,
            ..row(membrane)
        };
        LawStudy {
            schema: LAWS_SCHEMA.into(),
            version: "0".into(),
            notice: NOTICE.into(),
            mesh_error: ERROR_OF_LAWS_MEANS.into(),
            model_error: MODEL_ERROR_MEANS.into(),
            case: "valve".into(),
            repeats: 3,
            reference_faces: Some(2600),
            leaflets: vec!["anterior".into(), "posterior".into()],
            rows: vec![row(Tissue::default()), failed],
        }
    }

    #[test]
    fn tables_have_a_line_per_closure() {
        let study = study();
        let csv = csv(&study);
        let lines: Vec<&str> = csv.lines().collect();
        let columns = lines[0].split(',').count();
        assert_eq!(lines.len(), 3);
        assert!(
            lines.iter().all(|line| line.split(',').count() == columns),
            "{csv}"
        );
        assert_eq!(
            lines[1],
            "650,bilinear-springs,,0.25,converged,true,5e-7,40,12.5,,,,0.5,1,2,200,0,1.5"
        );
        assert!(
            lines[2].starts_with("650,st-venant-kirchhoff,tension-field,0.25,stalled,false,"),
            "{csv}"
        );
    }

    #[test]
    fn text_fits_the_screen_and_marks_what_is_not_certified() {
        let text = text(&study());
        assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
        assert_eq!(
            text.lines().filter(|line| line.ends_with('!')).count(),
            1,
            "{text}"
        );
        assert!(text.contains("2600 triangles of the same law"), "{text}");
        assert!(text.ends_with("research use, not a medical device\n"), "{text}");
    }

    /// A law can be pasted back into a scene from what is written.
    #[test]
    fn the_object_holds_the_laws() {
        let written = serde_json::to_value(study()).unwrap();
        let tissue: Tissue = serde_json::from_value(written["rows"][1]["tissues"][1].clone()).unwrap();
        assert_eq!(tissue, study().rows[1].tissues[1]);
    }
}

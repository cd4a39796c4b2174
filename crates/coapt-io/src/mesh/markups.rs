//! Slicer markups JSON: curves and named points, read and written (markups schema 1.0.3).

use std::path::Path;

use coapt::scene::{Fault, Space};
use serde::{Deserialize, Serialize};

use super::curve::Curve;
use super::faults::{Faults, Place, Stop};
use super::number::shortened;
use super::{frame, sniff};
use crate::atomic::write_text_atomically;

/// As Slicer itself still writes it.
const SCHEMA: &str = "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/\
                      Schema/markups-schema-v1.0.3.json#";

/// Named points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MarkupPoints {
    /// Points [mm], shape `[point]`, in LPS.
    pub points_mm: Vec<[f64; 3]>,
    /// What each is called, shape `[point]`; may be empty text.
    pub labels: Vec<String>,
    /// The frame that the file was marked with; `None`: no mark, taken as LPS.
    pub space: Option<Space>,
}

/// A file. What is not named here (display, measurements) is passed over.
#[derive(Debug, Serialize, Deserialize)]
struct File {
    #[serde(rename = "@schema")]
    schema: String,
    markups: Vec<Markup>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Markup {
    #[serde(rename = "type")]
    kind: String,
    #[serde(default)]
    name: String,
    coordinate_system: Option<String>,
    coordinate_units: Option<serde_json::Value>,
    #[serde(default)]
    control_points: Vec<ControlPoint>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
struct ControlPoint {
    #[serde(default)]
    id: String,
    #[serde(default)]
    label: String,
    position: Option<[f64; 3]>,
    position_status: Option<String>,
}

/// Reads all Fiducial lists of a markups file; the second part are the warnings.
///
/// # Errors
/// All faults found: no regular file, no markups, no Fiducial list, units other than mm, no defined point.
pub fn read_points(path: &Path) -> Result<(MarkupPoints, Vec<Fault>), Vec<Fault>> {
    let mut faults = Faults::new(path.display().to_string());
    let points = super::read_file(path, &mut faults).and_then(|bytes| {
        let text = sniff::without_byte_order_mark(&bytes, &mut faults)?;
        points(text, &mut faults)
    });
    faults.finish(points)
}

fn points(text: &[u8], faults: &mut Faults) -> Result<MarkupPoints, Stop> {
    let file = parse(text, faults)?;
    let mut found: Option<MarkupPoints> = None;
    for (number, markup) in file
        .markups
        .iter()
        .enumerate()
        .filter(|(_, markup)| markup.kind == "Fiducial")
    {
        let read = control_points(markup, number, faults)?;
        match &mut found {
            None => found = Some(read),
            // The points are all LPS; the frames are told only to be reported.
            Some(all) => {
                all.points_mm.extend(read.points_mm);
                all.labels.extend(read.labels);
                all.space = all.space.and(read.space);
            }
        }
    }
    let Some(found) = found else {
        let message = format!("no Fiducial list; the markups are: {}", kinds(&file));
        return Err(faults.fatal(Place::File, message));
    };
    if found.points_mm.is_empty() {
        return Err(faults.fatal(Place::File, "no point with a defined position"));
    }
    Ok(found)
}

/// The first curve of a markups file, else its first Fiducial list.
pub(super) fn curve(text: &[u8], faults: &mut Faults) -> Result<Curve, Stop> {
    let file = parse(text, faults)?;
    let find = |kinds: &[&str]| {
        file.markups
            .iter()
            .position(|markup| kinds.contains(&markup.kind.as_str()))
    };
    let Some(number) = find(&["Curve", "ClosedCurve"]).or_else(|| find(&["Fiducial"])) else {
        let message = format!(
            "no Curve, ClosedCurve or Fiducial; the markups are: {}",
            kinds(&file)
        );
        return Err(faults.fatal(Place::File, message));
    };
    let markup = &file.markups[number];
    if file.markups.len() > 1 {
        let message = format!(
            "{} markups; taken: {} `{}`",
            file.markups.len(),
            markup.kind,
            shortened(&markup.name)
        );
        faults.warning(Place::File, message);
    }
    let MarkupPoints {
        points_mm,
        labels,
        space,
    } = control_points(markup, number, faults)?;
    let closed = markup.kind == "ClosedCurve";
    let needed = if closed { 3 } else { 2 };
    if points_mm.len() < needed {
        let message = format!(
            "{} defined points; a {} needs {needed}",
            points_mm.len(),
            markup.kind
        );
        return Err(faults.fatal(Place::File, message));
    }
    Ok(Curve {
        points_mm,
        closed,
        labels,
        space,
    })
}

fn parse(text: &[u8], faults: &mut Faults) -> Result<File, Stop> {
    let file: File = serde_json::from_slice(text).map_err(|error| {
        let told = error.to_string();
        // The place stands before it already.
        let message = told.split(" at line ").next().unwrap_or(&told);
        faults.fatal(
            Place::Line(error.line()),
            format!("column {}: {message}", error.column()),
        )
    })?;
    if !file.schema.to_ascii_lowercase().contains("markups-schema-v1.") {
        let message = format!("@schema is `{}`; read as markups 1.0", shortened(&file.schema));
        faults.warning(Place::File, message);
    }
    Ok(file)
}

fn kinds(file: &File) -> String {
    let kinds: Vec<_> = file
        .markups
        .iter()
        .take(8)
        .map(|markup| shortened(&markup.kind))
        .collect();
    if kinds.is_empty() {
        "none".to_owned()
    } else {
        kinds.join(", ")
    }
}

/// The defined points of one markup, in LPS.
fn control_points(markup: &Markup, number: usize, faults: &mut Faults) -> Result<MarkupPoints, Stop> {
    let mut points = MarkupPoints::default();
    let in_file = |message: &str| format!("markups[{number}]{message}");
    if let Some(units) = &markup.coordinate_units {
        // A UCUM code, or the code with its scheme and meaning.
        let code = units
            .as_str()
            .or_else(|| units.get(0).and_then(|code| code.as_str()));
        if code != Some("mm") {
            let units = shortened(&units.to_string());
            faults.error(
                Place::File,
                in_file(&format!(".coordinateUnits is {units}; only mm is read")),
            )?;
        }
    }
    if let Some(name) = &markup.coordinate_system {
        // Before version 1, 0 was RAS and 1 LPS.
        let name = match name.as_str() {
            "0" => "RAS",
            "1" => "LPS",
            other => other,
        };
        points.space = frame::named(&shortened(name), Place::File, faults)?;
    }
    let mut undefined = 0;
    for (i, point) in markup.control_points.iter().enumerate() {
        let status = point.position_status.as_deref().unwrap_or("defined");
        match point.position.filter(|_| status == "defined") {
            Some(position) if position.iter().all(|value| value.is_finite()) => {
                points.points_mm.push(position);
                points.labels.push(point.label.clone());
            }
            Some(_) => {
                let message = format!(".controlPoints[{i}].position is not finite");
                faults.error(Place::File, in_file(&message))?;
            }
            None => undefined += 1,
        }
    }
    if undefined > 0 {
        faults.warning(
            Place::File,
            in_file(&format!(
                ": {undefined} points without a defined position skipped"
            )),
        );
    }
    if points.space == Some(Space::RAS) {
        frame::turn(&mut points.points_mm);
    }
    Ok(points)
}

/// Writes a curve that Slicer opens, in LPS.
///
/// # Errors
/// A point that is not finite, labels that are neither none nor one for each point, or what the file system says.
pub fn write_markups_curve(path: &Path, name: &str, curve: &Curve) -> Result<(), Fault> {
    let fault = |message: String| Fault::error(path.display().to_string(), message);
    if let Some(number) = curve
        .points_mm
        .iter()
        .position(|point| !point.iter().all(|value| value.is_finite()))
    {
        return Err(fault(format!("point {number} is not finite")));
    }
    if !curve.labels.is_empty() && curve.labels.len() != curve.points_mm.len() {
        return Err(fault(format!(
            "{} labels for {} points",
            curve.labels.len(),
            curve.points_mm.len()
        )));
    }
    let control_point = |(i, &position): (usize, &[f64; 3])| ControlPoint {
        id: (i + 1).to_string(),
        label: curve.labels.get(i).cloned().unwrap_or_default(),
        position: Some(position),
        // Some versions of Slicer hide points that do not say so.
        position_status: Some("defined".to_owned()),
    };
    let markup = Markup {
        kind: if curve.closed { "ClosedCurve" } else { "Curve" }.to_owned(),
        name: name.to_owned(),
        coordinate_system: Some("LPS".to_owned()),
        coordinate_units: Some("mm".into()),
        control_points: curve.points_mm.iter().enumerate().map(control_point).collect(),
    };
    let file = File {
        schema: SCHEMA.to_owned(),
        markups: vec![markup],
    };
    let mut text = serde_json::to_vec_pretty(&file).map_err(|error| fault(error.to_string()))?;
    text.push(b'\n');
    write_text_atomically(path, &text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::read_curve;

    const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/meshes");

    fn markup(text: &str) -> String {
        format!(r#"{{"@schema": "x/markups-schema-v1.0.3.json#", "markups": [{text}]}}"#)
    }

    fn errors(text: &str) -> Vec<String> {
        let mut faults = Faults::new("f".into());
        let read = curve(text.as_bytes(), &mut faults);
        let faults = faults.finish(read).unwrap_err();
        faults
            .into_iter()
            .map(|fault| format!("{}: {}", fault.place, fault.message))
            .collect()
    }

    #[test]
    fn a_closed_curve_is_read_without_its_undefined_point() {
        let (curve, warnings) = read_curve(&Path::new(FOLDER).join("annulus.mrk.json")).unwrap();
        let points = [
            [0.0, -13.5, 2.25],
            [17.0, 0.0, -1.5],
            [0.0, 13.5, 1.75],
            [-17.0, 0.0, -1.5],
        ];
        assert_eq!(curve.points_mm, points);
        assert_eq!(curve.labels, ["A", "ALC", "P", "PMC"]);
        assert_eq!((curve.closed, curve.space), (true, Some(Space::LPS)));
        assert_eq!(warnings.len(), 1);
        assert!(
            warnings[0]
                .message
                .ends_with("1 points without a defined position skipped")
        );
    }

    #[test]
    fn points_in_ras_are_turned() {
        let (points, warnings) = read_points(&Path::new(FOLDER).join("papillary.mrk.json")).unwrap();
        assert_eq!(points.points_mm, [[14.5, -2.0, -21.0], [12.0, 0.0, -19.25]]);
        assert_eq!(points.labels, ["muscle tip", "chordal insertion"]);
        assert_eq!(points.space, Some(Space::RAS));
        assert_eq!(warnings, []);
    }

    #[test]
    fn a_written_curve_is_read_back() {
        let path = std::env::temp_dir().join(format!("coapt-curve-{}.mrk.json", std::process::id()));
        for (closed, labels) in [
            (true, vec!["a".to_owned(), "b \"é\"".to_owned(), String::new()]),
            (false, Vec::new()),
        ] {
            // A third has no short decimal: it must come back to the last bit.
            let points_mm = vec![[1.0 / 3.0, -2.0, 1e-300], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]];
            let curve = Curve {
                points_mm,
                closed,
                labels,
                space: Some(Space::LPS),
            };
            write_markups_curve(&path, "ring", &curve).unwrap();
            let (mut back, warnings) = read_curve(&path).unwrap();
            back.labels.truncate(curve.labels.len());
            assert_eq!((back, warnings), (curve, vec![]));
        }
        std::fs::remove_file(&path).unwrap();
        let bad = Curve {
            points_mm: vec![[f64::NAN, 0.0, 0.0]],
            ..Curve::default()
        };
        assert_eq!(
            write_markups_curve(&path, "ring", &bad).unwrap_err().message,
            "point 0 is not finite"
        );
    }

    #[test]
    fn wrong_markups_are_refused_with_the_reason() {
        let um = markup(
            r#"{"type": "Curve", "coordinateUnits": "um", "controlPoints": [{"position": [0, 0, 0]}, {"position": [1, 0, 0]}]}"#,
        );
        assert_eq!(
            errors(&um),
            ["f: markups[0].coordinateUnits is \"um\"; only mm is read"]
        );
        let ijk = markup(
            r#"{"type": "Curve", "coordinateSystem": "IJK", "controlPoints": [{"position": [0, 0, 0]}, {"position": [1, 0, 0]}]}"#,
        );
        assert_eq!(errors(&ijk), ["f: SPACE is `IJK`; only LPS and RAS are known"]);
        let one = markup(r#"{"type": "Curve", "controlPoints": [{"position": [0, 0, 0]}]}"#);
        assert_eq!(errors(&one), ["f: 1 defined points; a Curve needs 2"]);
        assert_eq!(
            errors(&markup(r#"{"type": "ROI"}"#)),
            ["f: no Curve, ClosedCurve or Fiducial; the markups are: ROI"]
        );
        assert!(errors("{\n \"@schema\": NaN}")[0].starts_with("f:2: column "));
        // A hundred thousand brackets, in a field that is passed over and in one that is kept.
        let brackets = "[".repeat(100_000);
        let deep = errors(&format!("{{\"display\": {brackets}"));
        assert!(deep[0].contains("EOF while parsing a list"), "{deep:?}");
        let deep = errors(&markup(&format!(
            "{{\"type\": \"Curve\", \"coordinateUnits\": {brackets}}}"
        )));
        assert!(deep[0].contains("recursion limit"), "{deep:?}");
    }

    #[test]
    fn of_several_markups_the_first_curve_is_taken_and_said() {
        let points = r#""controlPoints": [{"position": [0, 0, 0]}, {"position": [1, 0, 0]}]"#;
        let text = markup(&format!(
            r#"{{"type": "Fiducial", {points}}}, {{"type": "Curve", "name": "free edge", {points}}}"#
        ));
        let mut faults = Faults::new("f".into());
        let read = curve(text.as_bytes(), &mut faults).unwrap();
        assert_eq!((read.closed, read.space, read.points_mm.len()), (false, None, 2));
        assert_eq!(faults.list[0].message, "2 markups; taken: Curve `free edge`");
    }
}

use std::path::PathBuf;

use coapt::mesh::parametric::{Preset, ValveParameters, generate};

use super::*;

fn model() -> Model {
    let parameters = ValveParameters {
        face_count_target: 200,
        ..ValveParameters::preset(Preset::Healthy)
    };
    let scene = generate(&parameters).unwrap();
    Model::build(&scene).unwrap().model
}

/// Ways that no two nodes share, exact in few digits.
fn way(node: usize) -> Vec3 {
    Vec3::new(0.5 * node as f64, -0.25, 0.125 * (node % 7) as f64)
}

/// A file that is gone at the end.
struct File(PathBuf);

impl File {
    fn new(name: &str, text: &str) -> Self {
        let path = std::env::temp_dir().join(format!("coapt-results-{}-{name}", std::process::id()));
        std::fs::write(&path, text).unwrap();
        Self(path)
    }
}

impl Drop for File {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

fn dat(count: usize, time: &str) -> String {
    let mut text = format!("\n displacements (vx,vy,vz) for set VERTICES and time  {time}\n\n");
    for node in 1..=count {
        let way = way(node);
        text += &format!("{node:10}  {:e}  {:e}  {:e}\n", way.x, way.y, way.z);
    }
    text
}

fn log(model: &Model, places: bool) -> String {
    let data = if places { "x;y;z" } else { "ux;uy;uz" };
    // An earlier state, which must not be taken.
    let mut text = format!(
        "*Step  = 1\n*Time  = 0.5\n*Data  = {data}\n1,9,9,9\n*Step  = 2\n*Time  = 2\n*Data  = {data}\n"
    );
    for (vertex, open) in model.rest_mm.iter().enumerate() {
        let value = way(vertex + 1) + if places { *open } else { Vec3::zeros() };
        text += &format!("{},{:?},{:?},{:?}\n", vertex + 1, value.x, value.y, value.z);
    }
    text
}

/// Only both sides of wedges, as CalculiX writes them: columns that touch.
fn frd(model: &Model) -> String {
    let numbering = Numbering::of(model);
    let mut text =
        "    1C\n  100CL  101 3.00000E+00         127                     0    1           1\n".to_owned();
    text += " -4  DISP        4    1\n -5  D1          1    2    1    0\n";
    let mut seen = std::collections::BTreeSet::new();
    for (face, vertices) in model.faces.iter().enumerate() {
        for (corner, &vertex) in vertices.iter().enumerate() {
            seen.insert(vertex);
            let way = way(vertex as usize + 1);
            for (node, side) in numbering.wedge(face, corner).into_iter().zip([-0.5, 0.5]) {
                text += &format!(
                    " -1{node:10}{}{}{}\n",
                    twelve(way.x + side),
                    twelve(way.y),
                    twelve(way.z)
                );
            }
        }
    }
    for vertex in (0..model.rest_mm.len()).filter(|&vertex| !seen.contains(&(vertex as u32))) {
        let way = way(vertex + 1);
        text += &format!(
            " -1{:10}{}{}{}\n",
            vertex + 1,
            twelve(way.x),
            twelve(way.y),
            twelve(way.z)
        );
    }
    text + " -3\n 9999\n"
}

/// A number in twelve columns, as Fortran's E12.5 writes it.
fn twelve(value: f64) -> String {
    let text = format!("{value:.5e}");
    let (mantissa, exponent) = text.split_once('e').unwrap();
    let exponent: i32 = exponent.parse().unwrap();
    let sign = if exponent < 0 { '-' } else { '+' };
    format!("{mantissa:>8}E{sign}{:02}", exponent.abs())
}

fn table(model: &Model) -> String {
    let mut text = "Part,Node Label,U1,U2,U3\n".to_owned();
    for vertex in 1..=model.rest_mm.len() {
        let way = way(vertex);
        text += &format!("VALVE,{vertex},{},{},{}\n", way.x, way.y, way.z);
    }
    text
}

#[test]
fn all_kinds_of_files_tell_the_same() {
    let model = model();
    let count = model.rest_mm.len();
    for (name, text) in [
        ("dat", dat(count, "0.3000000E+01")),
        ("frd", frd(&model)),
        ("places", log(&model, true)),
        ("ways", log(&model, false)),
        ("csv", table(&model)),
    ] {
        let file = File::new(name, &text);
        let (positions, warnings) = read_positions(&file.0, &model).unwrap();
        assert_eq!(warnings, [], "{name}");
        for (vertex, (position, open)) in positions.iter().zip(&model.rest_mm).enumerate() {
            let off = (position - open - way(vertex + 1)).norm();
            // The .frd has six digits; places lose a bit to the subtraction.
            let tolerance = if name == "frd" { 1e-3 } else { 1e-12 };
            assert!(off < tolerance, "{name} vertex {vertex}: {off:e}");
        }
    }
}

#[test]
fn the_last_block_counts_and_other_quantities_are_passed_over() {
    let model = model();
    let count = model.rest_mm.len();
    let forces = "\n forces (fx,fy,fz) for set VERTICES and time  0.3000000E+01\n\n         1  9.0E+00  9.0E+00  9.0E+00\n";
    let text = format!(
        "{}{}{forces}",
        dat(1, "0.1000000E+01"),
        dat(count, "0.3000000E+01")
    );
    let file = File::new("blocks", &text);
    let (positions, warnings) = read_positions(&file.0, &model).unwrap();
    assert_eq!(warnings, []);
    assert_eq!(positions[0], model.rest_mm[0] + way(1));
}

#[test]
fn a_state_from_before_the_end_is_told() {
    let model = model();
    let file = File::new("early", &dat(model.rest_mm.len(), "0.1250000E+01"));
    let (_, warnings) = read_positions(&file.0, &model).unwrap();
    assert_eq!(warnings.len(), 1);
    assert!(
        warnings[0]
            .message
            .contains("time 1.25; at time 3 all the load is on"),
        "{warnings:?}"
    );
}

#[test]
fn a_wrong_file_says_where_and_what_was_expected() {
    let model = model();
    let count = model.rest_mm.len();
    let whole = dat(count, "0.3000000E+01");
    let frd = frd(&model);
    for (name, text, place, message) in [
        (
            "none",
            "hello\n".to_owned(),
            "",
            "expected a .dat or .frd of CalculiX",
        ),
        ("empty", "\n".to_owned(), "", "is empty; expected displacements"),
        ("short", dat(count - 2, "0.3000000E+01"), "", "2 of "),
        (
            "nan",
            whole.replacen("-2.5e-1", "NaN", 1),
            ":4",
            "node 1: found `NaN`; expected a finite number",
        ),
        (
            "word",
            whole.replacen("-2.5e-1", "x", 1),
            ":4",
            "node 1: found `x`; expected a finite number",
        ),
        (
            "node",
            whole.replacen("         1  ", "       1.5  ", 1),
            ":4",
            "found `1.5`; expected the number of a node",
        ),
        (
            "twice",
            whole.replacen("         2  ", "         1  ", 1),
            ":5",
            "node 1 stands here a second time",
        ),
        (
            "cut",
            whole.replacen("  -2.5e-1", "", 1),
            ":4",
            "3 words; expected a node and its displacement: 4",
        ),
        (
            "time",
            whole.replacen("0.3000000E+01", "soon", 1),
            ":2",
            "expected `... and time",
        ),
        (
            "binary",
            frd.replacen("           1\n", "           2\n", 1),
            ":2",
            "format 1 (ASCII)",
        ),
        ("open", frd.replace(" -3\n", ""), "", "expected a line ` -3`"),
        ("other", frd.replace("DISP", "FORC"), "", "no block `DISP`"),
        (
            "data",
            log(&model, true).replace("x;y;z", "sx;sy;sz"),
            ":3",
            "expected `x;y;z` or `ux;uy;uz`",
        ),
        (
            "unnamed",
            "*Step = 1\n1 2 3 4\n".to_owned(),
            ":2",
            "no line `*Data",
        ),
        ("columns", "a,b\n1,2\n".to_owned(), ":1", "expected `node` and"),
        (
            "row",
            "node,x,y,z\n1,2\n".to_owned(),
            ":2",
            "2 columns; expected 4",
        ),
    ] {
        let file = File::new(name, &text);
        let faults = read_positions(&file.0, &model).expect_err(name);
        assert_eq!(faults.len(), 1, "{name}: {faults:?}");
        assert!(
            faults[0].place.ends_with(&format!("{name}{place}")),
            "{name}: {faults:?}"
        );
        assert!(faults[0].message.contains(message), "{name}: {faults:?}");
    }
    let faults = read_positions(&std::env::temp_dir(), &model).unwrap_err();
    assert_eq!(faults[0].message, "is not a regular file");
}

/// Wherever a file is cut, and whatever byte is spoilt, there is an answer.
#[test]
fn spoilt_bytes_make_no_reader_panic() {
    let model = model();
    for text in [dat(9, "0.2E+01"), frd(&model), log(&model, true), table(&model)] {
        let text = &text[..text.len().min(900)];
        for at in 0..text.len() {
            let _ = parse(&text[..at]);
            for spoilt in ['\u{e9}', '-', '\n', '9'] {
                let mut bytes = text.to_owned();
                bytes.replace_range(at..=at, &spoilt.to_string());
                let _ = parse(&bytes);
            }
        }
    }
}

#[test]
fn fortran_exponents_of_three_digits_are_read() {
    assert_eq!(float(" -1.250000-101"), Some(-1.25e-101));
    assert_eq!(float("1.5E+00"), Some(1.5));
    assert_eq!(float("-"), None);
    assert_eq!(float("1.5e"), None);
}

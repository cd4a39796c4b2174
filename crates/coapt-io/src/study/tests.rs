//! Studies of made-up closures.

use super::*;
use crate::report::NOTICE;

fn row(faces: usize, residual_tolerance: f64, wall_ms: f64, rms_mm: f64) -> Row {
    Row {
        varied: Factor::MeshAndTolerance,
        faces,
        residual_tolerance,
        contact_thickness_mm: 0.5,
        status: Status::Converged,
        certified: true,
        residual: residual_tolerance / 2.0,
        iterations: 40,
        crossings: 0,
        wall_ms,
        error: Some(VisibleDistance {
            rms_mm,
            mean_mm: 0.8 * rms_mm,
            p95_mm: 2.0 * rms_mm,
            max_mm: 4.0 * rms_mm,
        }),
        own_mesh_rms_mm: Some(1e-5),
        on_front: false,
        knee: false,
    }
}

/// A front with a bend at 650 faces and 1e-3, an uncertified closure that would beat it, and another thickness.
fn study() -> Study {
    let uncertified = Row {
        certified: false,
        status: Status::Stalled,
        ..row(650, 1e-5, 1.0, 0.01)
    };
    let thick = Row {
        varied: Factor::ContactThickness,
        contact_thickness_mm: 1.0,
        ..row(650, 1e-6, 2.0, 0.02)
    };
    let mut rows = vec![
        row(160, 1e-1, 3.0, 2.0),
        row(160, 1e-3, 4.0, 1.9),
        row(650, 1e-1, 6.0, 0.6),
        row(650, 1e-3, 8.0, 0.3),
        row(650, 1e-6, 9.0, 0.3),
        row(2600, 1e-1, 80.0, 0.25),
        row(2600, 1e-6, 120.0, 0.2),
        uncertified,
        thick,
    ];
    mark(&mut rows);
    Study {
        schema: STUDY_SCHEMA.into(),
        version: "0".into(),
        notice: NOTICE.into(),
        error: ERROR_MEANS.into(),
        knee: KNEE_MEANS.into(),
        case: "a <b> & c".into(),
        repeats: 3,
        reference: Reference {
            faces: 10_000,
            residual_tolerance: 1e-10,
            residual: 3e-11,
            contact_thickness_mm: 0.5,
        },
        rows,
    }
}

#[test]
fn only_certified_closures_of_the_same_valve_compete() {
    let study = study();
    let front: Vec<usize> = (0..study.rows.len())
        .filter(|&i| study.rows[i].on_front)
        .collect();
    assert_eq!(front, [0, 1, 2, 3, 5, 6]);
    assert!(study.rows[3].knee);
    assert_eq!(study.rows.iter().filter(|row| row.knee).count(), 1);
}

#[test]
fn tables_have_a_line_per_closure() {
    let study = study();
    let csv = csv(&study);
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines.len(), 1 + study.rows.len());
    let columns = lines[0].split(',').count();
    assert!(
        lines.iter().all(|line| line.split(',').count() == columns),
        "{csv}"
    );
    assert!(
        lines[4].starts_with("mesh-and-tolerance,650,1e-3,0.5,converged,true,5e-4,40,0,8,0.3,"),
        "{csv}"
    );
    let text = text(&study);
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
    assert!(
        text.contains("NOT CERTIFIED") && text.contains("knee: 650 triangles"),
        "{text}"
    );
    assert!(text.ends_with("research use, not a medical device\n"), "{text}");
}

/// The picture is XML, holds all marks and words, and no undefined number; nothing visible, or nothing at all, still
/// is a picture.
#[test]
fn the_picture_is_whole_whatever_the_rows() {
    let full = study();
    let mut blind = full.clone();
    blind.rows.iter_mut().for_each(|row| row.error = None);
    mark(&mut blind.rows);
    let mut exact = full.clone();
    exact.rows.truncate(1);
    exact.rows[0].error = Some(VisibleDistance::default());
    mark(&mut exact.rows);
    let mut none = full.clone();
    none.rows.clear();
    for study in [&full, &blind, &exact, &none] {
        let picture = svg(study);
        let mut reader = quick_xml::Reader::from_str(&picture);
        while reader.read_event().unwrap() != quick_xml::events::Event::Eof {}
        assert!(!picture.contains("NaN") && !picture.contains("inf"), "{picture}");
        assert!(picture.contains("a &lt;b&gt; &amp; c"));
        assert!(picture.contains(NOTICE));
    }
    let picture = svg(&full);
    assert!(picture.contains("knee") && picture.contains("not certified"));
    assert_eq!(picture, svg(&full));
}

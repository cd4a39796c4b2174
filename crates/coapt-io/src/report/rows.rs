//! The rows of the table that a person reads, grouped by what they speak of.

use coapt::measure::Measures;

use super::{Outcome, Report};

/// A row of a report's table, for whoever lays out a table of his own.
#[derive(Clone, Debug, PartialEq)]
pub struct TableRow {
    /// Heading of its group.
    pub title: String,
    /// What is measured.
    pub name: String,
    /// Its unit; empty for a count.
    pub unit: String,
    /// Digits after the decimal point: no more than a mesh of this kind can resolve.
    pub digits: usize,
    /// Without the plan; none of what only the plan brings, such as sutures.
    pub before: Option<f64>,
    /// With the plan; none without one.
    pub after: Option<f64>,
}

/// The rows of the table that [`text`](super::text()) prints, in its order.
pub fn rows(report: &Report) -> Vec<TableRow> {
    let before = groups(&report.before);
    let after = report.after.as_ref().map(groups);
    let mut all = Vec::new();
    for (number, group) in before.iter().enumerate() {
        let later = after.as_ref().map_or(&[][..], |groups| &groups[number].rows);
        let told = |row: &Row, before: Option<f64>, after: Option<f64>| TableRow {
            title: group.title.to_owned(),
            name: row.name.clone(),
            unit: row.unit.to_owned(),
            digits: row.digits,
            before,
            after,
        };
        let kept = group.rows.iter().enumerate().map(|(number, row)| {
            let after = same_row(later, number, row).map(|row| row.value);
            told(row, Some(row.value), after)
        });
        all.extend(kept);
        let is_new = |(number, row): &(usize, &Row)| same_row(&group.rows, *number, row).is_none();
        let new = later.iter().enumerate().filter(is_new);
        all.extend(new.map(|(_, row)| told(row, None, Some(row.value))));
    }
    all
}

/// The row of that number if it has the same name, else one that has: a repair may add chordae and sutures.
fn same_row<'a>(rows: &'a [Row], number: usize, row: &Row) -> Option<&'a Row> {
    let same = |other: &&Row| other.name == row.name;
    rows.get(number).filter(same).or_else(|| rows.iter().find(same))
}

/// A row of one state.
struct Row {
    name: String,
    unit: &'static str,
    /// Digits after the decimal point: no more than a mesh of this kind can resolve.
    digits: usize,
    value: f64,
}

/// Rows under a heading.
struct Group {
    title: &'static str,
    rows: Vec<Row>,
}

fn row(name: impl Into<String>, unit: &'static str, digits: usize, value: f64) -> Row {
    Row {
        name: name.into(),
        unit,
        digits,
        value,
    }
}

fn groups(outcome: &Outcome) -> Vec<Group> {
    let m = &outcome.measures;
    vec![
        Group {
            title: "Competence",
            rows: vec![
                row("regurgitant orifice area", "mm²", 1, m.orifice.area_mm2),
                row("holes", "", 0, m.orifice.count as f64),
                row("widest gap", "mm", 1, m.orifice.max_gap_mm),
            ],
        },
        Group {
            title: "Coaptation",
            rows: vec![
                row("contact area", "mm²", 1, m.coaptation.area_mm2),
                row("coaptation length, mean", "mm", 1, m.coaptation.length_mean_mm),
                row("coaptation length, largest", "mm", 1, m.coaptation.length_max_mm),
                row("coaptation length at A2-P2", "mm", 1, m.coaptation.length_a2p2_mm),
                row("line of closure", "mm", 1, m.coaptation.closure_line_mm),
            ],
        },
        Group {
            title: "Annulus",
            rows: annulus(m),
        },
        Group {
            title: "Tenting and billow",
            rows: vec![
                row("tenting height", "mm", 1, m.tenting.height_mm),
                row("tenting area, mid-section", "mm²", 1, m.tenting.area_mm2),
                row("tenting volume", "mL", 2, m.tenting.volume_ml),
                row("billow height", "mm", 1, m.billow.height_mm),
                row("billow volume", "mL", 2, m.billow.volume_ml),
            ],
        },
        Group {
            title: "Leaflets",
            rows: leaflets(m),
        },
        Group {
            title: "Chordae",
            rows: chordae(m),
        },
        Group {
            title: "Sutures and clips",
            rows: sutures(m),
        },
        Group {
            title: "Force on the heart",
            rows: reactions(m),
        },
    ]
}

fn annulus(m: &Measures) -> Vec<Row> {
    let a = &m.annulus;
    vec![
        row("anteroposterior diameter", "mm", 1, a.ap_mm),
        row("commissural width", "mm", 1, a.commissural_mm),
        row("intertrigonal distance", "mm", 1, a.intertrigonal_mm),
        row("circumference", "mm", 1, a.circumference_mm),
        row("area, projected", "mm²", 0, a.area_2d_mm2),
        row("area, in space", "mm²", 0, a.area_3d_mm2),
        row("height", "mm", 1, a.height_mm),
        row("height / commissural width (AHCWR)", "%", 1, 100.0 * a.ahcwr),
        row("non-planarity angle", "°", 0, a.nonplanarity_angle_deg),
    ]
}

fn leaflets(m: &Measures) -> Vec<Row> {
    let rows = m.leaflets.iter().flat_map(|leaflet| {
        let name = &leaflet.name;
        [
            row(format!("{name}: area, open"), "mm²", 0, leaflet.area_rest_mm2),
            row(format!("{name}: area, closed"), "mm²", 0, leaflet.area_mm2),
            row(
                format!("{name}: strain, 95th percentile"),
                "%",
                1,
                100.0 * leaflet.strain_p95,
            ),
        ]
    });
    rows.collect()
}

fn chordae(m: &Measures) -> Vec<Row> {
    if m.chords.groups.is_empty() {
        return Vec::new();
    }
    let mut rows = vec![
        row("all: total tension", "N", 2, m.chords.total_force_n),
        row("all: largest tension", "N", 2, m.chords.max_force_n),
    ];
    for group in &m.chords.groups {
        rows.push(row(
            format!("{}: total tension", group.name),
            "N",
            2,
            group.total_force_n,
        ));
        rows.push(row(
            format!("{}: largest tension", group.name),
            "N",
            2,
            group.max_force_n,
        ));
    }
    rows
}

fn sutures(m: &Measures) -> Vec<Row> {
    let rows = m.sutures.iter().flat_map(|repair| {
        let name = &repair.name;
        [
            row(format!("{name}: total tension"), "N", 2, repair.total_force_n),
            row(format!("{name}: largest tension"), "N", 2, repair.max_force_n),
        ]
    });
    rows.collect()
}

fn reactions(m: &Measures) -> Vec<Row> {
    let size = |force: [f64; 3]| force.iter().map(|part| part * part).sum::<f64>().sqrt();
    let muscles = m.papillary.iter().map(|muscle| {
        row(
            format!("{} papillary muscle", muscle.name),
            "N",
            2,
            size(muscle.force_n),
        )
    });
    let mut rows: Vec<Row> = muscles.collect();
    rows.push(row("annulus", "N", 2, size(m.annulus_force_n)));
    rows
}

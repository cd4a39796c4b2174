//! The rows of the table that a person reads, grouped by what they speak of.

use coapt::measure::Measures;
use serde::Serialize;

use super::Report;

/// A row of a table of measures, for whoever lays out a table of his own.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TableRow {
    /// Heading of its group.
    pub title: String,
    /// What is measured.
    pub name: String,
    /// Its unit; empty for a count.
    pub unit: String,
    /// Digits after the decimal point: no more than a mesh of this kind can resolve.
    pub digits: usize,
    /// Shape `[state]`; none where a state lacks what others have, such as the sutures of a plan.
    pub values: Vec<Option<f64>>,
}

/// The rows of the table that [`text`](super::text()) prints, in its order; states are the valve before and, with a plan, after.
pub fn rows(report: &Report) -> Vec<TableRow> {
    let after = report.after.iter().map(|after| &after.measures);
    let states: Vec<&Measures> = std::iter::once(&report.before.measures).chain(after).collect();
    rows_of(&states)
}

/// The rows of a table of any states. What only later states have stands below what the first has under the same heading.
pub fn rows_of(states: &[&Measures]) -> Vec<TableRow> {
    let mut all: Vec<Vec<TableRow>> = Vec::new();
    for (state, measures) in states.iter().enumerate() {
        for (number, group) in groups(measures).into_iter().enumerate() {
            if all.len() == number {
                all.push(Vec::new());
            }
            for (place, row) in group.rows.into_iter().enumerate() {
                let value = row.value;
                let table = &mut all[number];
                let at = same_row(table, place, &row.name, state).unwrap_or_else(|| {
                    table.push(TableRow {
                        title: group.title.to_owned(),
                        name: row.name,
                        unit: row.unit.to_owned(),
                        digits: row.digits,
                        values: vec![None; states.len()],
                    });
                    table.len() - 1
                });
                table[at].values[state] = Some(value);
            }
        }
    }
    all.concat()
}

/// The row in that place if it has the same name, else one that has and that the state has not filled: a repair may add chordae and
/// sutures, and they may share names.
fn same_row(table: &[TableRow], place: usize, name: &str, state: usize) -> Option<usize> {
    let fits = |at: &usize| table[*at].name == name && table[*at].values[state].is_none();
    let in_place = Some(place).filter(|&place| place < table.len());
    in_place.filter(fits).or_else(|| (0..table.len()).find(fits))
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

fn groups(m: &Measures) -> Vec<Group> {
    let passage = m.orifice.passage_mm2;
    vec![
        Group {
            title: "Competence",
            rows: [
                row("regurgitant orifice area", "mm²", 1, m.orifice.area_mm2),
                row("holes", "", 0, m.orifice.count as f64),
                row("widest gap", "mm", 1, m.orifice.max_gap_mm),
            ]
            .into_iter()
            .chain(passage.map(|area_mm2| row("narrowest passage between surfaces", "mm²", 1, area_mm2)))
            .collect(),
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

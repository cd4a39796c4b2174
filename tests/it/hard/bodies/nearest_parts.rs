//! Places where closest points are not what they seem: a vertex exactly over a vertex, an edge, a face; edges that graze,
//! edges that are parallel.

use coapt::Vec3;

use super::assembly::{Body, Matter, assemble, height_field, roof};
use super::begun;
use crate::hard::{HardCase, Jitter};
use crate::shapes::Mesh;

const HALF_MM: f64 = 5.0;
/// Cells of 2 mm.
const CELLS: u32 = 5;
const CORNER_MM: f64 = 1.0;
const DOWN_MM: f64 = 1.0;

pub(super) fn cases() -> Vec<HardCase> {
    let mut cases = points();
    cases.extend(edges());
    cases
}

/// A triangle on one corner.
fn pin(tip: Vec3) -> Mesh {
    Mesh {
        points_mm: vec![
            tip,
            tip + Vec3::new(-1.0, 0.3, 3.0),
            tip + Vec3::new(1.0, -0.3, 3.0),
        ],
        faces: vec![[0, 1, 2]],
        rim: vec![],
    }
}

fn sheet() -> Body {
    Body::sheet(height_field(CELLS, HALF_MM, |_, _| 0.0), Vec3::zeros()).level()
}

/// Vertices of the sheet are at odd ordinates.
fn points() -> Vec<HardCase> {
    let places = [
        ("vertex", [CORNER_MM, CORNER_MM]),
        ("edge", [0.0, CORNER_MM]),
        ("diagonal edge", [2.0, 2.0]),
        ("face", [CORNER_MM + 4.0 / 3.0, CORNER_MM + 2.0 / 3.0]),
    ];
    let mut cases = Vec::new();
    for (part, [x, y]) in places {
        let lowered = move |jitter: &mut Jitter, gap_mm: f64| {
            let tip = Body::rigid(pin(Vec3::new(x, y, gap_mm)), -Vec3::z() * DOWN_MM).level();
            assemble(&[sheet(), tip], &Matter::default(), jitter)
        };
        for (start, gap_mm) in [("1e-3", 1e-3), ("1e-9", 1e-9)] {
            cases.push(begun(
                format!("rigid vertex exactly over {part}, {start} mm away"),
                "closest points jump between parts; nearer than steps may bring them",
                move |jitter| lowered(jitter, gap_mm),
            ));
        }
        cases.push(begun(
            format!("rigid vertex exactly on {part}"),
            "no distance, and no direction in which to part",
            move |jitter| lowered(jitter, 0.0),
        ));
    }
    cases
}

fn edges() -> Vec<HardCase> {
    let thickness_mm = Matter::default().contact.thickness_mm;
    let ridge_at = |x: f64, y: f64, z: f64, turn: f64| {
        let way = Vec3::new(turn.sin(), turn.cos(), 0.0);
        let (middle, across) = (Vec3::new(x, y, z), Vec3::new(way.y, -way.x, 0.0));
        let up = Vec3::z() * 2.0;
        roof([middle - way * 3.0, middle + way * 3.0], across + up, up - across)
    };
    let lowered = move |name: &str, what, place: [f64; 4], way: [f64; 3]| {
        begun(name, what, move |jitter| {
            let [x, y, z, turn] = place;
            let roof = Body::rigid(ridge_at(x, y, z, turn), Vec3::from(way)).level();
            assemble(&[sheet(), roof], &Matter::default(), jitter)
        })
    };
    let down = [0.0, 0.0, -DOWN_MM];
    vec![
        lowered(
            "rigid edge exactly parallel over an edge",
            "closest points of parallel edges are everywhere",
            [CORNER_MM, 0.0, 1e-3, 0.0],
            down,
        ),
        lowered(
            "rigid edge nearly parallel over an edge",
            "closest points run along the edge at a touch: 1e-4 rad",
            [CORNER_MM, 0.0, 1e-3, 1e-4],
            down,
        ),
        lowered(
            "rigid edge at 1.8 degrees over an edge",
            "where contact of parallel edges fades out",
            [CORNER_MM, 0.0, 1e-3, 0.0314],
            down,
        ),
        lowered(
            "rigid edge exactly parallel between edges",
            "an edge over faces alone",
            [0.0, 0.0, 1e-3, 0.0],
            down,
        ),
        lowered(
            "rigid edge lowered from exactly the contact thickness",
            "contact begins at the first step",
            [CORNER_MM, 0.0, thickness_mm, 0.0],
            down,
        ),
        lowered(
            "rigid edge grazing a sheet at the contact thickness",
            "it touches and does not, by rounding",
            [-2.0, 0.0, thickness_mm, 0.3],
            [4.0, 0.0, 0.0],
        ),
        lowered(
            "rigid edge grazing a sheet just within the contact thickness",
            "hardly any force",
            [-2.0, 0.0, thickness_mm - 1e-6, 0.3],
            [4.0, 0.0, 0.0],
        ),
        begun(
            "wedge past a rigid edge that grazes its own",
            "edge-edge contact comes and goes along the way",
            move |jitter| {
                let wedge = height_field(CELLS + 1, HALF_MM, |x, _| -0.6 * x.abs());
                let is_side = |v: &u32| wedge.points_mm[*v as usize].x.abs() > HALF_MM - 1e-6;
                let held = wedge.rim.iter().copied().filter(is_side).collect();
                let wedge = Body {
                    held,
                    ..Body::free(wedge)
                };
                let edge = ridge_at(-3.0, 0.0, 0.3, 0.2);
                let roof = Body::rigid(edge, Vec3::new(6.0, 0.0, 0.0));
                assemble(&[wedge, roof], &Matter::default(), jitter)
            },
        ),
    ]
}

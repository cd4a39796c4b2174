//! Small models built by hand, with measures known in closed form.

use std::f64::consts::{PI, TAU};

use crate::Vec3;
use crate::energy::chord::Chords;
use crate::model::{AnnulusLandmarks, LeafletTissue, Margin, Model};
use crate::scene::{Contact, Settings, Tissue};

/// A model of nothing but geometry.
pub(super) fn model_of(
    points: Vec<Vec3>,
    faces: Vec<[u32; 3]>,
    face_leaflet: Vec<u32>,
    annulus: Vec<u32>,
    margins: Vec<Margin>,
) -> Model {
    let n = annulus.len();
    let leaflet_count = face_leaflet.iter().max().map_or(0, |last| last + 1);
    let leaflet = |i: u32| LeafletTissue {
        name: format!("leaflet {i}"),
        thickness_mm: 1.0,
        tissue: Tissue::default(),
    };
    Model {
        name: "test".into(),
        leaflet_vertex_count: points.len(),
        rest_mm: points,
        faces,
        face_leaflet,
        leaflets: (0..leaflet_count).map(leaflet).collect(),
        springs: Default::default(),
        membranes: Default::default(),
        hinges: Default::default(),
        chords: Chords::default(),
        chord_groups: vec![],
        pressure_mpa: 0.0133,
        dead_loads_n: vec![],
        // Shapes with known answers are made for this thickness.
        contact: Contact {
            thickness_mm: 0.5,
            ..Contact::default()
        },
        annulus,
        margins,
        papillary: vec![],
        landmarks: AnnulusLandmarks {
            commissure_anterolateral: 0,
            trigone_left: n / 8,
            mid_anterior: n / 4,
            trigone_right: 3 * n / 8,
            commissure_posteromedial: n / 2,
            mid_posterior: 3 * n / 4,
        },
        prescribed: vec![],
        settings: Settings::default(),
    }
}

/// The D-shaped saddle of two half ellipses with raised horns, counter-clockwise seen from +z; +x the anterolateral
/// commissure, +y anterior.
pub(super) fn saddle(n: usize, cc: f64, ap: f64, fraction: f64, horns: [f64; 2]) -> Vec<Vec3> {
    let point = |i: usize| {
        let (sin, cos) = (TAU * i as f64 / n as f64).sin_cos();
        let (depth, horn) = if sin >= 0.0 {
            (fraction * ap, horns[0])
        } else {
            ((1.0 - fraction) * ap, horns[1])
        };
        Vec3::new(0.5 * cc * cos, depth * sin, horn * sin * sin)
    };
    (0..n).map(point).collect()
}

/// Faces of a grid of vertices, row by row; the last column joins the first when `around`.
fn grid_faces(columns: u32, rows: u32, around: bool) -> Vec<[u32; 3]> {
    let mut faces = Vec::new();
    for row in 0..rows - 1 {
        for column in 0..if around { columns } else { columns - 1 } {
            let (a, b) = (row * columns + column, row * columns + (column + 1) % columns);
            let (c, d) = (a + columns, b + columns);
            faces.extend([[a, c, d], [a, d, b]]);
        }
    }
    faces
}

/// A flat sheet of one leaflet in the x-z plane, first row on top.
pub(super) fn grid_model(columns: usize, rows: usize, width: f64, height: f64) -> Model {
    let point = |i: usize| {
        let (row, column) = ((i / columns) as f64, (i % columns) as f64);
        Vec3::new(
            width * column / (columns - 1) as f64,
            0.0,
            -height * row / (rows - 1) as f64,
        )
    };
    let faces = grid_faces(columns as u32, rows as u32, false);
    let leaflet = vec![0; faces.len()];
    model_of(
        (0..columns * rows).map(point).collect(),
        faces,
        leaflet,
        vec![],
        vec![],
    )
}

/// A flat square sheet in the x-y plane of `n × n` squares, of one leaflet or of two that join at half its width.
pub(super) fn sheet(n: usize, size: f64, leaflets: u32) -> Model {
    let columns = n + 1;
    let step = size / n as f64;
    let points = (0..columns * columns)
        .map(|i| Vec3::new((i % columns) as f64 * step, (i / columns) as f64 * step, 0.0));
    let faces = grid_faces(columns as u32, columns as u32, false);
    let half = |i: usize| {
        if i / 2 % n < n.div_ceil(2) || leaflets == 1 {
            0
        } else {
            1
        }
    };
    let leaflet = (0..faces.len()).map(half).collect();
    model_of(points.collect(), faces, leaflet, vec![], vec![])
}

/// Two leaflets, each a grid of vertices given by its place along the margin (0..1) and its row.
fn two_leaflets(columns: usize, rows: usize, point: impl Fn(f64, usize, f64) -> Vec3) -> Model {
    let (mut points, mut faces) = (Vec::new(), Vec::new());
    for side in [-1.0, 1.0] {
        let first = points.len() as u32;
        for row in 0..rows {
            points.extend((0..columns).map(|c| point(c as f64 / (columns - 1) as f64, row, side)));
        }
        faces.extend(
            grid_faces(columns as u32, rows as u32, false)
                .iter()
                .map(|f| f.map(|v| v + first)),
        );
    }
    let leaflet = (0..faces.len())
        .map(|f| u32::from(f >= faces.len() / 2))
        .collect();
    let (c, r) = (columns as u32, rows as u32);
    let annulus = (0..c).chain((r * c..(r + 1) * c).rev()).collect();
    let margin = |first: u32| Margin {
        vertices: (first..first + c).collect(),
        closed: false,
    };
    model_of(
        points,
        faces,
        leaflet,
        annulus,
        vec![margin((r - 1) * c), margin((2 * r - 1) * c)],
    )
}

/// Two strips of 20 × 5 mm, parallel at a distance.
pub(super) fn two_strips(columns: usize, rows: usize, gap: f64) -> Model {
    two_leaflets(columns + 1, rows + 1, |x, row, side| {
        Vec3::new(20.0 * x, side * gap / 2.0, -5.0 * row as f64 / rows as f64)
    })
}

/// Two strips 20 mm wide that lie 0.4 mm apart over some depth and part above at 45° each over 5 mm of height.
pub(super) fn flared_strips(columns: usize, n: usize, depth: f64) -> Model {
    sloping_strips(columns, n, |_| depth)
}

/// The same with a depth that depends on the place along the width (0..1).
pub(super) fn sloping_strips(columns: usize, n: usize, depth: impl Fn(f64) -> f64) -> Model {
    two_leaflets(columns + 1, 2 * n + 1, |x, row, side| {
        let up = (n as f64 - row as f64) / n as f64;
        let (z, aside) = if up > 0.0 {
            (5.0 * up, 5.0 * up)
        } else {
            (depth(x) * up, 0.0)
        };
        Vec3::new(20.0 * x, side * (0.2 + aside), z)
    })
}

/// An open tube 10 mm long of one leaflet that hangs from a round annulus in the plane z = 0.
pub(super) fn tube(around: usize, rows: usize, radius: f64) -> Model {
    let columns = around as u32;
    let points = (0..=rows).flat_map(|row| {
        let z = -10.0 * row as f64 / rows as f64;
        (0..around).map(move |c| {
            let (sin, cos) = (TAU * c as f64 / around as f64).sin_cos();
            Vec3::new(radius * cos, radius * sin, z)
        })
    });
    let faces = grid_faces(columns, rows as u32 + 1, true);
    let leaflet = vec![0; faces.len()];
    let last = rows as u32 * columns;
    let margin = Margin {
        vertices: (last..last + columns).collect(),
        closed: true,
    };
    model_of(
        points.collect(),
        faces,
        leaflet,
        (0..columns).collect(),
        vec![margin],
    )
}

/// A tube of 12 mm radius made of two leaflets of `n` columns each that join at both commissures, on x = ±12.
pub(super) fn commissure_valve(n: usize, rows: usize) -> Model {
    let mut model = tube(2 * n, rows, 12.0);
    // The commissures' vertices lie on y = 0 to rounding; make that exact.
    for p in model.rest_mm.iter_mut().filter(|p| p.y.abs() < 1e-9) {
        p.y = 0.0;
    }
    let columns = 2 * n;
    for (f, leaflet) in model.face_leaflet.iter_mut().enumerate() {
        *leaflet = u32::from(f / 2 % columns >= n);
    }
    let leaflet = |name: &str| LeafletTissue {
        name: name.into(),
        thickness_mm: 1.0,
        tissue: Tissue::default(),
    };
    model.leaflets = vec![leaflet("anterior"), leaflet("posterior")];
    model
}

/// A [`commissure_valve`] with its lower half pressed flat to a gap.
pub(super) fn fold_state(model: &Model, gap: f64) -> Vec<Vec3> {
    pressed(model, |_| gap / 2.0)
}

/// The same with a gap of 0.4 mm and slits in it: each with its middle x, half length a, and half width b, between
/// the parabolas y = ±(0.2 + b (1 - (x/a)²)).
pub(super) fn lens_state(model: &Model, slits: &[(f64, f64, f64)]) -> Vec<Vec3> {
    let half = |&(middle, a, b): &(f64, f64, f64), x: f64| b * (1.0 - ((x - middle) / a).powi(2)).max(0.0);
    pressed(model, |x| {
        0.2 + slits.iter().map(|slit| half(slit, x)).sum::<f64>()
    })
}

fn pressed(model: &Model, half_width: impl Fn(f64) -> f64) -> Vec<Vec3> {
    let press = |p: &Vec3| {
        let open = p.y.abs() * (1.0 + p.z / 5.0).max(0.0);
        let y = if p.y == 0.0 {
            0.0
        } else {
            half_width(p.x).max(open).min(p.y.abs().max(0.2))
        };
        Vec3::new(p.x, y.copysign(p.y), p.z)
    };
    model.rest_mm.iter().map(press).collect()
}

/// A disc with a height over each point of the plane.
pub(super) fn disc(rings: usize, sectors: usize, radius: f64, height: impl Fn(Vec3) -> f64) -> Model {
    let mut points = vec![Vec3::zeros()];
    for ring in 1..=rings {
        let r = radius * ring as f64 / rings as f64;
        points.extend((0..sectors).map(|k| {
            let (sin, cos) = (2.0 * PI * k as f64 / sectors as f64).sin_cos();
            Vec3::new(r * cos, r * sin, 0.0)
        }));
    }
    for p in &mut points {
        p.z = height(*p);
    }
    let n = sectors as u32;
    let mut faces: Vec<[u32; 3]> = (0..n).map(|k| [0, 1 + k, 1 + (k + 1) % n]).collect();
    for ring in 0..rings as u32 - 1 {
        for k in 0..n {
            let (a, b) = (1 + ring * n + k, 1 + ring * n + (k + 1) % n);
            faces.extend([[a, a + n, b + n], [a, b + n, b]]);
        }
    }
    let leaflet = vec![0; faces.len()];
    let first = 1 + (rings as u32 - 1) * n;
    model_of(points, faces, leaflet, (first..first + n).collect(), vec![])
}

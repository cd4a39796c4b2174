//! The first triangulation of the open leaflets: columns from annulus to margin, every second one shifted by
//! half a step, neighbours zipped together.

use super::annulus::Side;
use super::improve;
use super::surface::Surface;
use crate::Vec3;

/// Both leaflets as one sheet that closes on itself around the annulus.
pub(super) struct Sheet {
    /// Arc length of each vertex's column [mm].
    pub(super) arc_mm: Vec<f64>,
    /// Depth of each vertex along the leaflet [mm].
    pub(super) depth_mm: Vec<f64>,
    /// What each vertex may do.
    pub(super) place: Vec<Place>,
    /// Positions [mm].
    pub(super) points_mm: Vec<Vec3>,
    /// Triangles, normals to the atrium.
    pub(super) faces: Vec<[u32; 3]>,
    /// Leaflet of each triangle.
    pub(super) sides: Vec<Side>,
}

/// Where a vertex lies, which says how it may slide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// On the annulus: does not slide.
    Annulus,
    /// End of a landmark column on the margin: does not slide.
    Corner,
    /// On the margin: slides along it.
    Margin,
    /// On the border of the leaflets: slides along its column.
    Commissure,
    /// Slides freely.
    Interior,
}

/// How the skirt is divided.
struct Division {
    /// Columns of the anterior and of the posterior leaflet, each counting its first commissure; even, so
    /// that both middles are columns.
    columns: [usize; 2],
    /// Step along the columns [mm].
    step_mm: f64,
}

/// Triangulates the surface with about so many faces.
pub(super) fn sheet(surface: &Surface, face_count: u32) -> Sheet {
    let division = divide(surface, face_count);
    let mut sheet = columns(surface, &division);
    improve::improve(&mut sheet, surface);
    sheet
}

/// Arc length at which a column stands [mm].
fn column_arc(surface: &Surface, columns: [usize; 2], column: usize) -> f64 {
    if column < columns[0] {
        surface
            .annulus
            .arc_of(Side::Anterior, column as f64 / columns[0] as f64)
    } else {
        surface
            .annulus
            .arc_of(Side::Posterior, (column - columns[0]) as f64 / columns[1] as f64)
    }
}

/// Number of pieces in a column: shifted ones have half a piece at either end.
fn pieces(height_mm: f64, step_mm: f64, shifted: bool) -> usize {
    let whole = ((height_mm / step_mm).round() as usize).max(1);
    whole + usize::from(shifted)
}

/// The division whose face count comes nearest.
fn divide(surface: &Surface, face_count: u32) -> Division {
    // Equilateral triangles of the mean skirt: columns are as far apart as the triangles are high, and the
    // funnel narrows them by about a sixth halfway down.
    let spacing_over_step = 0.5 * 3.0_f64.sqrt() / 0.85;
    let mean_height = mean_height_mm(surface);
    let area = mean_height * surface.annulus.length_mm;
    let first_step = (2.0 * area / (f64::from(face_count) * spacing_over_step)).sqrt();
    let mut best = (
        usize::MAX,
        Division {
            columns: [2, 2],
            step_mm: first_step,
        },
    );
    for trial in 0..120 {
        let step_mm = first_step * (0.8 + 0.4 * f64::from(trial) / 119.0);
        let division = Division {
            columns: column_counts(surface, step_mm * spacing_over_step),
            step_mm,
        };
        let miss = face_total(surface, &division).abs_diff(face_count as usize);
        if miss < best.0 {
            best = (miss, division);
        }
    }
    best.1
}

fn mean_height_mm(surface: &Surface) -> f64 {
    let length = surface.annulus.length_mm;
    (0..256)
        .map(|i| surface.height_mm(length * f64::from(i) / 256.0))
        .sum::<f64>()
        / 256.0
}

fn column_counts(surface: &Surface, spacing_mm: f64) -> [usize; 2] {
    let anterior = surface.annulus.anterior_length_mm;
    let even = |length: f64| 2 * ((0.5 * length / spacing_mm).round() as usize).max(1);
    [even(anterior), even(surface.annulus.length_mm - anterior)]
}

/// Each strip between columns has as many triangles as its two columns have pieces.
fn face_total(surface: &Surface, division: &Division) -> usize {
    let count = division.columns[0] + division.columns[1];
    (0..count)
        .map(|column| {
            let height = surface.height_mm(column_arc(surface, division.columns, column));
            2 * pieces(height, division.step_mm, column % 2 == 1)
        })
        .sum()
}

/// Places the columns and zips them.
fn columns(surface: &Surface, division: &Division) -> Sheet {
    let mut sheet = Sheet {
        arc_mm: Vec::new(),
        depth_mm: Vec::new(),
        place: Vec::new(),
        points_mm: Vec::new(),
        faces: Vec::new(),
        sides: Vec::new(),
    };
    let count = division.columns[0] + division.columns[1];
    let starts: Vec<usize> = (0..count)
        .map(|column| add_column(&mut sheet, surface, division, column))
        .collect();
    let vertices = |column: usize| {
        let column = column % count;
        starts[column]..starts.get(column + 1).copied().unwrap_or(sheet.points_mm.len())
    };
    let ranges: Vec<_> = (0..=count).map(vertices).collect();
    for column in 0..count {
        let side = if column < division.columns[0] {
            Side::Anterior
        } else {
            Side::Posterior
        };
        zip(
            &mut sheet,
            ranges[column].clone(),
            ranges[column + 1].clone(),
            side,
        );
    }
    sheet
}

/// Appends one column from annulus to margin; gives its first vertex.
fn add_column(sheet: &mut Sheet, surface: &Surface, division: &Division, column: usize) -> usize {
    let [anterior, posterior] = division.columns;
    let commissure = column == 0 || column == anterior;
    let landmark = commissure || column == anterior / 2 || column == anterior + posterior / 2;
    let shifted = column % 2 == 1;
    let arc_mm = column_arc(surface, division.columns, column);
    let height = surface.height_mm(arc_mm);
    let last = pieces(height, division.step_mm, shifted);
    let start = sheet.points_mm.len();
    for k in 0..=last {
        let (depth_mm, place) = if k == 0 {
            (0.0, Place::Annulus)
        } else if k == last {
            (height, if landmark { Place::Corner } else { Place::Margin })
        } else {
            let position = if shifted {
                (k as f64 - 0.5) / (last - 1) as f64
            } else {
                k as f64 / last as f64
            };
            (
                height * position,
                if commissure {
                    Place::Commissure
                } else {
                    Place::Interior
                },
            )
        };
        sheet.arc_mm.push(arc_mm);
        sheet.depth_mm.push(depth_mm);
        sheet.place.push(place);
        sheet.points_mm.push(surface.at(arc_mm, depth_mm));
    }
    start
}

/// Fills the strip between two columns, always over the shorter diagonal.
fn zip(sheet: &mut Sheet, left: std::ops::Range<usize>, right: std::ops::Range<usize>, side: Side) {
    let (mut i, mut j) = (left.start, right.start);
    while i + 1 < left.end || j + 1 < right.end {
        let points = &sheet.points_mm;
        let down_left = j + 1 == right.end
            || (i + 1 < left.end && (points[i + 1] - points[j]).norm() < (points[i] - points[j + 1]).norm());
        let next = if down_left { i + 1 } else { j + 1 };
        // Clockwise in (arc, depth), that is with the normal to the atrium.
        sheet.faces.push([j as u32, i as u32, next as u32]);
        sheet.sides.push(side);
        if down_left { i += 1 } else { j += 1 }
    }
}

//! Shapes as the page's script reads them: lengths in single precision, which is a hundred thousandth of a millimetre.

use std::collections::BTreeMap;

use serde::Serialize;

use super::coded::Coded;
use super::film::PageFilm;
use crate::mesh::{Array, PolyData};

/// A valve open and closed.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Geometry {
    /// Triangles, shape `[face, 3]`.
    pub faces: Coded<u32>,
    /// Which leaflet each face belongs to, shape `[face]`.
    pub face_leaflet: Coded<u32>,
    /// Closed positions [mm], shape `[vertex, 3]`.
    pub closed: Coded<f32>,
    /// Open positions [mm], shape `[vertex, 3]`.
    pub open: Coded<f32>,
    /// What is known at the closed vertices, by name, shape `[vertex]` each.
    pub fields: BTreeMap<String, Coded<f32>>,
    /// Its chords; none where there are none, or they were not written.
    pub chords: Option<Chords>,
    /// Curves of rings [mm], shape `[ring][point, 3]`.
    pub rings: Vec<Coded<f32>>,
    /// How it closes; none where that was not recorded.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub film: Option<PageFilm>,
}

/// Chords of a closed valve.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Chords {
    /// Points at the ends, shape `[chord, 2]`.
    pub ends: Coded<u32>,
    /// Group of each, shape `[chord]`.
    pub group: Coded<u32>,
    /// Closed positions of the points [mm], shape `[point, 3]`.
    pub closed: Coded<f32>,
    /// The same in the open valve; none where it was not written.
    pub open: Option<Coded<f32>>,
    /// Tension [N], shape `[chord]`.
    pub force_n: Coded<f32>,
}

/// What the page colours a valve by, or lays it flat with.
const FIELDS: [&str; 6] = [
    "gap_mm",
    "contact",
    "strain",
    "annulus_distance_mm",
    "along",
    "from_margin_mm",
];

/// The array that the open positions are found from.
const DISPLACEMENT: &str = "displacement_mm";

impl Geometry {
    /// The geometry of a closed surface as results have it.
    ///
    /// # Errors
    /// The name of an array that is missing or does not fit.
    pub fn of_closed_surface(surface: &PolyData) -> Result<Self, String> {
        let count = surface.points.len();
        let moved = point_values(surface, DISPLACEMENT, 3)?;
        let closed: Vec<f64> = surface.points.concat();
        let open = closed.iter().zip(&moved.values).map(|(now, moved)| now - moved);
        let mut fields = BTreeMap::new();
        for name in FIELDS {
            let values = &point_values(surface, name, 1)?.values;
            fields.insert(name.to_owned(), floats(values.iter().copied()));
        }
        let lengths = (0..count).map(|vertex| {
            let parts = moved.tuple(vertex).unwrap_or_default().iter();
            parts.map(|part| part * part).sum::<f64>().sqrt()
        });
        fields.insert(DISPLACEMENT.to_owned(), floats(lengths));
        Ok(Self {
            faces: Coded(surface.triangles.concat()),
            face_leaflet: Coded(face_leaflets(surface)?),
            open: floats(open),
            closed: floats(closed.iter().copied()),
            fields,
            chords: None,
            rings: Vec::new(),
            film: None,
        })
    }

    /// Farthest point of the leaflets, open or closed, from a centre [mm].
    pub fn reach_mm(&self, centre_mm: [f64; 3]) -> f64 {
        let points = self
            .closed
            .0
            .as_chunks::<3>()
            .0
            .iter()
            .chain(self.open.0.as_chunks::<3>().0);
        let apart = points.map(|point| {
            let parts = point.iter().zip(centre_mm);
            parts
                .map(|(&at, centre)| (f64::from(at) - centre).powi(2))
                .sum::<f64>()
        });
        apart.fold(0.0, f64::max).sqrt()
    }
}

impl Chords {
    /// The chords of a file of results, and the same in the open valve.
    ///
    /// # Errors
    /// The name of an array that is missing or does not fit.
    pub fn new(closed: &PolyData, open: Option<&PolyData>) -> Result<Self, String> {
        let group = line_values(closed, "group")?;
        Ok(Self {
            ends: Coded(closed.lines.concat()),
            group: Coded(group.iter().map(|&group| group as u32).collect()),
            closed: points(closed),
            open: open
                .filter(|open| open.points.len() == closed.points.len())
                .map(points),
            force_n: floats(line_values(closed, "force_n")?.into_iter()),
        })
    }
}

/// Points along a curve of lines, the first once more at its end where it closes.
pub(crate) fn curve(lines: &PolyData) -> Coded<f32> {
    let first = lines.lines.first().map(|line| line[0]);
    let rest = lines.lines.iter().map(|line| line[1]);
    let along = first.into_iter().chain(rest);
    floats(along.flat_map(|point| lines.points[point as usize]))
}

fn points(mesh: &PolyData) -> Coded<f32> {
    floats(mesh.points.iter().flatten().copied())
}

fn floats(values: impl Iterator<Item = f64>) -> Coded<f32> {
    Coded(values.map(|value| value as f32).collect())
}

fn point_values<'a>(mesh: &'a PolyData, name: &str, components: usize) -> Result<&'a Array, String> {
    let found = mesh.point_array(name);
    let fits = |array: &&Array| array.components == components && array.tuple_count() == mesh.points.len();
    found
        .filter(fits)
        .ok_or_else(|| format!("has no point array `{name}` with {components} numbers for each point"))
}

fn face_leaflets(mesh: &PolyData) -> Result<Vec<u32>, String> {
    let array = mesh.cell_array("leaflet").ok_or("has no cell array `leaflet`")?;
    (0..mesh.triangles.len())
        .map(|face| {
            let value = mesh.triangle_value(array, face).and_then(|values| values.first());
            value
                .map(|&leaflet| leaflet as u32)
                .ok_or_else(|| format!("has no `leaflet` for triangle {face}"))
        })
        .collect()
}

fn line_values(mesh: &PolyData, name: &str) -> Result<Vec<f64>, String> {
    let array = mesh
        .cell_array(name)
        .ok_or_else(|| format!("has no cell array `{name}`"))?;
    (0..mesh.lines.len())
        .map(|line| {
            let value = array
                .tuple(mesh.line_cell(line))
                .and_then(|values| values.first());
            value
                .copied()
                .ok_or_else(|| format!("has no `{name}` for line {line}"))
        })
        .collect()
}

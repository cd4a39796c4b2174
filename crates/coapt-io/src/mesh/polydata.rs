//! The one type that every mesh file is read into and written from.

use coapt::scene::Space;
use serde::{Deserialize, Serialize};

/// Points, triangles and line segments with what is known of them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PolyData {
    /// Points [mm], shape `[point]`, always in LPS.
    pub points: Vec<[f64; 3]>,
    /// Triangles as point numbers from 0, shape `[triangle]`.
    pub triangles: Vec<[u32; 3]>,
    /// The cell that each triangle is a part of, shape `[triangle]`. Empty: triangle i is cell number
    /// `lines.len() + i`.
    pub triangle_source: Vec<u32>,
    /// Line segments as point numbers from 0, shape `[segment]`; polylines are split.
    pub lines: Vec<[u32; 2]>,
    /// The cell that each segment is a part of, shape `[segment]`. Empty: segment i is cell i.
    pub line_source: Vec<u32>,
    /// Values at the points.
    pub point_arrays: Vec<Array>,
    /// Values of the cells as they stood in the file. Cells are numbered as VTK does: vertices, lines, polygons,
    /// strips; in an unstructured grid in the order of the file.
    pub cell_arrays: Vec<Array>,
    /// The frame that the file was marked with; `None`: no mark, taken as LPS.
    pub space: Option<Space>,
}

/// Named values, several for each point or cell.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Array {
    /// Name in the file.
    pub name: String,
    /// Values per point or cell, at least 1.
    pub components: usize,
    /// The values, shape `[point or cell][component]`.
    pub values: Vec<f64>,
}

impl Array {
    /// The values of one point or cell.
    pub fn tuple(&self, number: usize) -> Option<&[f64]> {
        let start = number.checked_mul(self.components)?;
        self.values.get(start..start.checked_add(self.components)?)
    }

    /// How many points or cells have values.
    pub fn tuple_count(&self) -> usize {
        self.values.len() / self.components.max(1)
    }
}

impl PolyData {
    /// The point array of this name.
    pub fn point_array(&self, name: &str) -> Option<&Array> {
        self.point_arrays.iter().find(|array| array.name == name)
    }

    /// The cell array of this name.
    pub fn cell_array(&self, name: &str) -> Option<&Array> {
        self.cell_arrays.iter().find(|array| array.name == name)
    }

    /// The cell that a triangle is a part of.
    pub fn triangle_cell(&self, triangle: usize) -> usize {
        match self.triangle_source.get(triangle) {
            Some(&cell) => cell as usize,
            None => self.lines.len() + triangle,
        }
    }

    /// The cell that a segment is a part of.
    pub fn line_cell(&self, segment: usize) -> usize {
        self.line_source
            .get(segment)
            .map_or(segment, |&cell| cell as usize)
    }

    /// What a cell array says of a triangle.
    pub fn triangle_value<'a>(&self, array: &'a Array, triangle: usize) -> Option<&'a [f64]> {
        array.tuple(self.triangle_cell(triangle))
    }

    /// What a cell array says of a segment. The segments of one polyline share its value, also where it
    /// measures the whole polyline, as a rest length does.
    pub fn line_value<'a>(&self, array: &'a Array, segment: usize) -> Option<&'a [f64]> {
        array.tuple(self.line_cell(segment))
    }
}

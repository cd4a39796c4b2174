//! VTK legacy files: polydata, and unstructured grids of vertices, lines, triangles, quads and polygons.
//!
//! Since version 5.1 cells are stored as offsets and connectivity, before as counts and points in one list; the
//! content tells which. Binary data are big-endian. Layout: VTK User's Guide, "VTK File Formats".

use super::PolyData;
use super::cells::CellReader;
use super::faults::{Faults, Place, Stop};
use super::frame;
use super::legacy_arrays::{self, Arrays};
use super::number::{NumberType, shortened};
use super::scanner::{Meaning, Scanner};

/// A file while it is read.
#[derive(Debug)]
pub(super) struct Legacy<'a> {
    pub(super) text: Scanner<'a>,
    pub(super) binary: bool,
    pub(super) mesh: PolyData,
    /// Arrays to be turned with the points.
    pub(super) vectors: Vec<String>,
    /// Vertices, lines, polygons, strips: the order in which VTK numbers them.
    lists: [CellList; 4],
    /// Cells of a grid with their types.
    grid: CellList,
    grid_types: Vec<f64>,
}

/// Cells as one list of point numbers, and where each begins in it, with the end as one more.
#[derive(Clone, Debug, Default)]
pub(super) struct CellList {
    pub(super) offsets: Vec<f64>,
    pub(super) connectivity: Vec<f64>,
}

impl CellList {
    /// How many cells there are.
    pub(super) fn count(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// The point numbers of each cell; nothing where the offsets are no offsets.
    pub(super) fn cells(&self) -> impl Iterator<Item = Option<&[f64]>> {
        self.offsets.windows(2).map(|pair| {
            let whole = pair[0] >= 0.0 && pair[0].fract() == 0.0 && pair[1].fract() == 0.0;
            if whole && pair[0] <= pair[1] {
                self.connectivity.get(pair[0] as usize..pair[1] as usize)
            } else {
                None
            }
        })
    }
}

/// Reads a file.
pub(super) fn read(bytes: &[u8], faults: &mut Faults) -> Result<PolyData, Stop> {
    let mut text = Scanner::new(bytes);
    check_version(&mut text, faults);
    let title = text.line().unwrap_or_default();
    let space = frame::find_mark(title, Place::Line(text.line - 1), faults)?;
    let binary = match text.word().unwrap_or_default().to_ascii_uppercase().as_slice() {
        b"ASCII" => false,
        b"BINARY" => true,
        _ => return Err(faults.fatal(Place::Line(text.line), "line 3 must be ASCII or BINARY")),
    };
    let mesh = PolyData {
        space,
        ..PolyData::default()
    };
    let mut file = Legacy {
        text,
        binary,
        mesh,
        vectors: Vec::new(),
        lists: Default::default(),
        grid: CellList::default(),
        grid_types: Vec::new(),
    };
    file.dataset(faults)?;
    while let Some(keyword) = file.text.word() {
        let keyword = String::from_utf8_lossy(keyword).to_ascii_uppercase();
        file.section(&keyword, faults)?;
    }
    file.add_cells(faults)?;
    frame::to_lps(&mut file.mesh, &file.vectors, faults);
    Ok(file.mesh)
}

/// Reads the first line, before which blank lines may stand.
fn check_version(text: &mut Scanner<'_>, faults: &mut Faults) {
    let mut line = text.line();
    while line.is_some_and(|line| line.trim_ascii().is_empty()) {
        line = text.line();
    }
    let last_word = line
        .unwrap_or_default()
        .rsplit(u8::is_ascii_whitespace)
        .find(|word| !word.is_empty());
    let version = String::from_utf8_lossy(last_word.unwrap_or_default());
    if !version
        .parse::<f64>()
        .is_ok_and(|number| (1.0..5.15).contains(&number))
    {
        let message = format!("version `{}` is not known; read as 5.1", shortened(&version));
        faults.warning(Place::Line(text.line - 1), message);
    }
}

impl Legacy<'_> {
    fn dataset(&mut self, faults: &mut Faults) -> Result<(), Stop> {
        let word = self.text.word().unwrap_or_default();
        let kind = self.text.word().unwrap_or_default().to_ascii_uppercase();
        let is_known = kind == b"POLYDATA" || kind == b"UNSTRUCTURED_GRID";
        if word.eq_ignore_ascii_case(b"DATASET") && is_known {
            return Ok(());
        }
        let kind = String::from_utf8_lossy(&kind);
        let message = format!(
            "DATASET {} is not read; export a surface as POLYDATA",
            shortened(&kind)
        );
        Err(faults.fatal(Place::Line(self.text.line), message))
    }

    fn section(&mut self, keyword: &str, faults: &mut Faults) -> Result<(), Stop> {
        match keyword {
            "POINTS" => self.points(faults),
            "VERTICES" => self.cell_list(faults).map(|list| self.lists[0] = list),
            "LINES" => self.cell_list(faults).map(|list| self.lists[1] = list),
            "POLYGONS" => self.cell_list(faults).map(|list| self.lists[2] = list),
            "TRIANGLE_STRIPS" => self.cell_list(faults).map(|list| self.lists[3] = list),
            "CELLS" => self.cell_list(faults).map(|list| self.grid = list),
            "CELL_TYPES" => {
                let count = self.text.count("the number of cell types", faults)?;
                self.grid_types = self.values(NumberType::I32, count, plain("cell type"), faults)?;
                Ok(())
            }
            "METADATA" => {
                self.skip_metadata();
                Ok(())
            }
            // Field data of the whole file: times and the like.
            "FIELD" => legacy_arrays::read_field(self, None, None, faults),
            "POINT_DATA" => legacy_arrays::read(self, Arrays::Points, faults),
            "CELL_DATA" => legacy_arrays::read(self, Arrays::Cells, faults),
            _ => {
                let message = format!("`{}` is not a section that is known", shortened(keyword));
                Err(faults.fatal(Place::Line(self.text.line), message))
            }
        }
    }

    /// How many cells there are.
    pub(super) fn cell_count(&self) -> usize {
        self.grid.count() + self.lists.iter().map(CellList::count).sum::<usize>()
    }

    fn points(&mut self, faults: &mut Faults) -> Result<(), Stop> {
        let count = self.text.count("the number of points", faults)?;
        let number_type = self.number_type(faults)?;
        let meaning = Meaning {
            noun: "point",
            components: 3,
            finite: true,
        };
        let values = self.values(number_type, count.saturating_mul(3), meaning, faults)?;
        self.mesh.points = values.as_chunks().0.to_vec();
        Ok(())
    }

    /// The next word as a type.
    pub(super) fn number_type(&mut self, faults: &mut Faults) -> Result<NumberType, Stop> {
        let word = self.text.word().unwrap_or_default().to_ascii_lowercase();
        legacy_arrays::number_type(&word).ok_or_else(|| {
            let message = format!(
                "`{}` is not a type that is known",
                shortened(&String::from_utf8_lossy(&word))
            );
            faults.fatal(Place::Line(self.text.line), message)
        })
    }

    /// The next `count` numbers: the next words, or the bytes after this line.
    pub(super) fn values(
        &mut self,
        number_type: NumberType,
        count: usize,
        meaning: Meaning<'_>,
        faults: &mut Faults,
    ) -> Result<Vec<f64>, Stop> {
        if !self.binary {
            return self.text.numbers(count, meaning, faults);
        }
        self.text.line();
        let start = self.text.at;
        let size = count.saturating_mul(number_type.size());
        let Some(bytes) = self.text.take(size) else {
            let rest = self.text.rest().len();
            let noun = meaning.noun;
            let message =
                format!("the header says {count} {noun} values = {size} bytes, file has {rest} left");
            return Err(faults.fatal(Place::Byte(start), message));
        };
        let values = number_type.decode(bytes, true);
        for (i, value) in values
            .iter()
            .enumerate()
            .filter(|(_, value)| meaning.finite && !value.is_finite())
        {
            let message = format!(
                "{} {} is not finite ({value})",
                meaning.noun,
                i / meaning.components
            );
            faults.error(Place::Byte(start + i * number_type.size()), message)?;
        }
        Ok(values)
    }

    fn cell_list(&mut self, faults: &mut Faults) -> Result<CellList, Stop> {
        let first = self.text.count("the number of cells", faults)?;
        let second = self.text.count("the size of the cell list", faults)?;
        if self.text.peek() == Some(b"OFFSETS") {
            self.text.word();
            let number_type = self.number_type(faults)?;
            let offsets = self.values(number_type, first, plain("offset"), faults)?;
            if !self
                .text
                .word()
                .is_some_and(|word| word.eq_ignore_ascii_case(b"CONNECTIVITY"))
            {
                return Err(faults.fatal(Place::Line(self.text.line), "CONNECTIVITY must follow OFFSETS"));
            }
            let number_type = self.number_type(faults)?;
            let connectivity = self.values(number_type, second, plain("connectivity"), faults)?;
            return Ok(CellList {
                offsets,
                connectivity,
            });
        }
        let place = Place::Line(self.text.line);
        let list = self.values(NumberType::I32, second, plain("cell list"), faults)?;
        old_cell_list(first, &list).map_err(|message| faults.fatal(place, message))
    }

    /// Skips component names, ranges and the like: from the word METADATA to the blank line that ends them.
    pub(super) fn skip_metadata(&mut self) {
        if self
            .text
            .peek()
            .is_some_and(|word| word.eq_ignore_ascii_case(b"METADATA"))
        {
            self.text.word();
        }
        self.text.line();
        while self.text.line().is_some_and(|line| !line.trim_ascii().is_empty()) {}
    }

    fn add_cells(&mut self, faults: &mut Faults) -> Result<(), Stop> {
        let mut cells = CellReader::default();
        if self.grid.count() > 0 {
            self.add_grid(&mut cells, faults)?;
        } else {
            add_lists(&mut self.mesh, &self.lists, &mut cells, faults)?;
        }
        cells.report(faults);
        Ok(())
    }

    fn add_grid(&mut self, cells: &mut CellReader, faults: &mut Faults) -> Result<(), Stop> {
        if self.grid_types.len() != self.grid.count() {
            let message = format!(
                "{} cells but {} cell types",
                self.grid.count(),
                self.grid_types.len()
            );
            return Err(faults.fatal(Place::File, message));
        }
        for (number, (cell, &cell_type)) in self.grid.cells().zip(&self.grid_types).enumerate() {
            let Some(points) = cell else {
                return Err(faults.fatal(Place::File, format!("cell {number}: its offset is out of order")));
            };
            let mesh = &mut self.mesh;
            match cell_type as i64 {
                1 | 2 => {}
                3 | 4 => cells.polyline(mesh, number, points, None, faults)?,
                5 | 7 | 9 => cells.polygon(mesh, number, points, None, faults)?,
                6 => cells.strip(mesh, number, points, faults)?,
                other => {
                    let name = cell_type_name(other);
                    let message =
                        format!("cell {number} is of type {other} ({name}); extract the surface first");
                    faults.error(Place::File, message)?;
                }
            }
        }
        Ok(())
    }
}

/// Adds vertices (which have no part in a mesh), lines, polygons and strips, numbered in this order.
pub(super) fn add_lists(
    mesh: &mut PolyData,
    lists: &[CellList; 4],
    cells: &mut CellReader,
    faults: &mut Faults,
) -> Result<(), Stop> {
    let mut number = lists[0].count();
    for (kind, list) in lists.iter().enumerate().skip(1) {
        for cell in list.cells() {
            let Some(points) = cell else {
                let kind = ["vertices", "lines", "polygons", "strips"][kind];
                let message = format!("cell {number} ({kind}): its offset is out of order or too large");
                return Err(faults.fatal(Place::File, message));
            };
            match kind {
                1 => cells.polyline(mesh, number, points, None, faults)?,
                2 => cells.polygon(mesh, number, points, None, faults)?,
                _ => cells.strip(mesh, number, points, faults)?,
            }
            number += 1;
        }
    }
    Ok(())
}

/// A list before version 5.1: each cell is its number of points and these.
fn old_cell_list(count: usize, list: &[f64]) -> Result<CellList, String> {
    let mut cells = CellList {
        offsets: vec![0.0],
        connectivity: Vec::with_capacity(list.len()),
    };
    let mut rest = list;
    while let Some((&size, after)) = rest.split_first() {
        let whole = size >= 0.0 && size.fract() == 0.0;
        let Some((points, after)) = after.split_at_checked(size as usize).filter(|_| whole) else {
            return Err(format!("cell {} cannot have {size} points", cells.count()));
        };
        cells.connectivity.extend_from_slice(points);
        cells.offsets.push(cells.connectivity.len() as f64);
        rest = after;
    }
    if cells.count() == count {
        Ok(cells)
    } else {
        Err(format!("header says {count} cells, there are {}", cells.count()))
    }
}

fn plain(noun: &str) -> Meaning<'_> {
    Meaning {
        noun,
        components: 1,
        finite: true,
    }
}

/// Names of the commonest types that hold no surface (vtkCellType.h).
fn cell_type_name(cell_type: i64) -> &'static str {
    match cell_type {
        0 => "empty",
        8 => "pixel",
        10 => "tetrahedron",
        11 => "voxel",
        12 => "hexahedron",
        13 => "wedge",
        14 => "pyramid",
        21 => "quadratic edge",
        22 => "quadratic triangle",
        23 => "quadratic quad",
        24 => "quadratic tetrahedron",
        25 => "quadratic hexahedron",
        42 => "polyhedron",
        _ => "neither line, triangle nor quad",
    }
}

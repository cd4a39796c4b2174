//! Cells of files become triangles and segments: polygons are split, strips unrolled, polylines cut.
//!
//! What is split is counted and reported once. A quad is split along its shorter diagonal, which does not
//! depend on which corner comes first; a larger polygon as a fan, and only if it is planar and convex, since
//! any other would have a shape that the file does not say.

use super::PolyData;
use super::faults::{Faults, Place, Stop};
use super::number::index_below;
use super::polygon::{Halves, is_planar_and_convex, split_quad};

/// The cell at hand, for messages: its number, and its line where the file is text.
#[derive(Clone, Copy, Debug)]
struct Site {
    noun: &'static str,
    number: usize,
    line: Option<usize>,
}

impl Site {
    fn error(self, text: &str, faults: &mut Faults) -> Result<(), Stop> {
        let Self { noun, number, line } = self;
        match line {
            Some(line) => faults.error(Place::Line(line), format!("{noun} {number}: {text}")),
            None => faults.error(Place::Element(noun, number), text),
        }
    }
}

/// How many, and which was the first.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    count: usize,
    first: Option<usize>,
}

impl Tally {
    fn add(&mut self, number: usize) {
        self.count += 1;
        self.first.get_or_insert(number);
    }
}

/// Cells on their way into a mesh, and what had to be done to them.
#[derive(Debug, Default)]
pub(super) struct CellReader {
    /// Corners of the cell at hand.
    corners: Vec<u32>,
    quads: Tally,
    folded_quads: Tally,
    polygons: Tally,
    /// Largest distance of a quad's diagonals [mm]: 0 for planar quads.
    warp_mm: f64,
    dropped_faces: Tally,
    dropped_segments: Tally,
    /// How many faces have been offered, which numbers them in messages.
    pub(super) face_count: usize,
    line_count: usize,
}

impl CellReader {
    /// A triangle, quad or polygon with these point numbers; `line` where the file is text.
    pub(super) fn polygon(
        &mut self,
        mesh: &mut PolyData,
        cell: usize,
        points: &[f64],
        line: Option<usize>,
        faults: &mut Faults,
    ) -> Result<(), Stop> {
        let face = self.face_count;
        self.face_count += 1;
        let site = Site {
            noun: "face",
            number: face,
            line,
        };
        if !self.take_corners(mesh, points, site, faults)? {
            return Ok(());
        }
        self.corners.dedup();
        if self.corners.len() > 1 && self.corners.first() == self.corners.last() {
            self.corners.pop();
        }
        match self.corners.as_slice() {
            [] | [_] | [_, _] => self.dropped_faces.add(face),
            &[a, b, c] => push_triangle(mesh, cell, [a, b, c]),
            &[a, b, c, d] => match split_quad(mesh, [a, b, c, d]) {
                Some(Halves {
                    triangles,
                    warp_mm,
                    folded,
                }) => {
                    self.quads.add(face);
                    if folded {
                        self.folded_quads.add(face);
                    }
                    self.warp_mm = self.warp_mm.max(warp_mm);
                    triangles
                        .into_iter()
                        .for_each(|half| push_triangle(mesh, cell, half));
                }
                None => site.error("the sides of the quad cross; triangulate it", faults)?,
            },
            _ if !is_planar_and_convex(mesh, &self.corners) => {
                let count = self.corners.len();
                let text = format!("{count} corners, not planar and convex; triangulate it");
                site.error(&text, faults)?;
            }
            _ if has_twice(&self.corners) => {
                let count = self.corners.len();
                let text = format!("{count} corners, some of them twice; triangulate it");
                site.error(&text, faults)?;
            }
            [first, others @ ..] => {
                self.polygons.add(face);
                for pair in others.windows(2) {
                    push_triangle(mesh, cell, [*first, pair[0], pair[1]]);
                }
            }
        }
        Ok(())
    }

    /// A strip of triangles. Those with a repeated point join parts of a strip and are left out.
    pub(super) fn strip(
        &mut self,
        mesh: &mut PolyData,
        cell: usize,
        points: &[f64],
        faults: &mut Faults,
    ) -> Result<(), Stop> {
        let face = self.face_count;
        self.face_count += 1;
        if !self.take_corners(
            mesh,
            points,
            Site {
                noun: "face",
                number: face,
                line: None,
            },
            faults,
        )? {
            return Ok(());
        }
        for (i, corner) in self.corners.windows(3).enumerate() {
            let [a, b, c] = [corner[0], corner[1], corner[2]];
            if a != b && b != c && a != c {
                push_triangle(mesh, cell, if i % 2 == 0 { [a, b, c] } else { [b, a, c] });
            }
        }
        Ok(())
    }

    /// A line or polyline.
    pub(super) fn polyline(
        &mut self,
        mesh: &mut PolyData,
        cell: usize,
        points: &[f64],
        line: Option<usize>,
        faults: &mut Faults,
    ) -> Result<(), Stop> {
        let number = self.line_count;
        self.line_count += 1;
        let site = Site {
            noun: "line",
            number,
            line,
        };
        if !self.take_corners(mesh, points, site, faults)? {
            return Ok(());
        }
        for pair in self.corners.windows(2) {
            if pair[0] == pair[1] {
                self.dropped_segments.add(number);
            } else {
                mesh.lines.push([pair[0], pair[1]]);
                mesh.line_source.push(cell as u32);
            }
        }
        Ok(())
    }

    /// Reports what was split and dropped.
    pub(super) fn report(&self, faults: &mut Faults) {
        let mut say = |tally: Tally, what: &str, noun: &str| {
            if let Some(first) = tally.first {
                faults.warning(
                    Place::File,
                    format!("{what}: {}, the first is {noun} {first}", tally.count),
                );
            }
        };
        let apart = format!("their diagonals are up to {:.3} mm apart", self.warp_mm);
        say(
            self.quads,
            &format!("quads split along the shorter diagonal ({apart})"),
            "face",
        );
        say(
            self.folded_quads,
            "quads that fold over along either diagonal",
            "face",
        );
        say(
            self.polygons,
            "polygons with more than four corners, split into fans of triangles",
            "face",
        );
        say(
            self.dropped_faces,
            "faces with fewer than three different corners, dropped",
            "face",
        );
        say(
            self.dropped_segments,
            "line cells with a segment from a point to itself, dropped",
            "line",
        );
    }

    /// Whether all points exist; then they are in `corners`.
    fn take_corners(
        &mut self,
        mesh: &PolyData,
        points: &[f64],
        site: Site,
        faults: &mut Faults,
    ) -> Result<bool, Stop> {
        let count = mesh.points.len();
        self.corners.clear();
        self.corners
            .extend(points.iter().map_while(|&point| index_below(point, count)));
        let Some(wrong) = points.get(self.corners.len()) else {
            return Ok(true);
        };
        let text = format!("point {wrong} does not exist: there are {count}, from 0");
        site.error(&text, faults)?;
        Ok(false)
    }
}

/// Whether a polygon passes a point twice: one that goes round a triangle again and again turns left everywhere, as a convex
/// one does.
fn has_twice(corners: &[u32]) -> bool {
    let mut sorted = corners.to_vec();
    sorted.sort_unstable();
    sorted.windows(2).any(|pair| pair[0] == pair[1])
}

fn push_triangle(mesh: &mut PolyData, cell: usize, triangle: [u32; 3]) {
    mesh.triangles.push(triangle);
    // Cells are fewer than the bytes of the largest file that is read.
    mesh.triangle_source.push(cell as u32);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn split(points: &[[f64; 3]], face: &[f64]) -> (Vec<[u32; 3]>, Vec<String>) {
        let mut mesh = PolyData {
            points: points.to_vec(),
            ..PolyData::default()
        };
        let mut faults = Faults::new("f".into());
        let mut cells = CellReader::default();
        cells.polygon(&mut mesh, 0, face, None, &mut faults).unwrap();
        cells.report(&mut faults);
        (
            mesh.triangles,
            faults.list.into_iter().map(|fault| fault.message).collect(),
        )
    }

    #[test]
    fn a_quad_is_split_along_its_shorter_diagonal_whichever_corner_comes_first() {
        let kite = [
            [0.0, 0.0, 0.0],
            [5.0, 1.0, 0.0],
            [10.0, 0.0, 0.0],
            [5.0, -1.0, 0.0],
        ];
        let (triangles, said) = split(&kite, &[0.0, 3.0, 2.0, 1.0]);
        assert_eq!(triangles, [[0, 3, 1], [3, 2, 1]]);
        assert!(
            said[0].starts_with("quads split along the shorter diagonal ("),
            "{said:?}"
        );
        assert_eq!(split(&kite, &[3.0, 2.0, 1.0, 0.0]).0, [[3, 2, 1], [3, 1, 0]]);
    }

    #[test]
    fn an_arrowhead_is_split_inside_and_a_bow_tie_refused() {
        let arrow = [
            [0.0, 0.0, 0.0],
            [4.0, -4.0, 0.0],
            [1.0, 0.0, 0.0],
            [4.0, 4.0, 0.0],
        ];
        assert_eq!(split(&arrow, &[0.0, 1.0, 2.0, 3.0]).0, [[0, 1, 2], [0, 2, 3]]);
        let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let (triangles, said) = split(&square, &[0.0, 2.0, 1.0, 3.0]);
        assert!(triangles.is_empty());
        assert_eq!(said, ["the sides of the quad cross; triangulate it"]);
        // A trapezoid, nearly flat, whose longer side is hardly longer: its crossed diagonals are parallel but for rounding.
        let flat = [
            [16.45, 7.0, 0.0],
            [9.5, 12.12, 0.0],
            [8.36, 10.67, -5.0],
            [14.48, 6.16, -5.0],
        ];
        assert!(split(&flat, &[0.0, 2.0, 1.0, 3.0]).0.is_empty());
    }

    #[test]
    fn a_creased_quad_is_split_and_told() {
        // Points 1 and 3 stand on one side of the diagonal 0 2, and 0 and 2 on one side of 1 3.
        let height = 3.0_f64.sqrt();
        let creased = [
            [0.0, -1.0, 0.0],
            [1.0, 0.0, height],
            [0.0, 1.0, 0.0],
            [1.0, 0.5, -height / 4.0],
        ];
        let (triangles, said) = split(&creased, &[0.0, 1.0, 2.0, 3.0]);
        assert_eq!(triangles.len(), 2);
        assert_eq!(
            said.last().map(String::as_str),
            Some("quads that fold over along either diagonal: 1, the first is face 0")
        );
    }

    #[test]
    fn warp_is_the_distance_of_the_diagonals() {
        let saddle = [[0.0, 0.0, 0.5], [1.0, 0.0, 0.0], [1.0, 1.0, 0.5], [0.0, 1.0, 0.0]];
        let (_, said) = split(&saddle, &[0.0, 1.0, 2.0, 3.0]);
        assert!(
            said[0].ends_with("up to 0.500 mm apart): 1, the first is face 0"),
            "{said:?}"
        );
    }

    #[test]
    fn larger_polygons_are_split_only_if_planar_and_convex() {
        let ring = |turns: f64, lift: f64| -> Vec<[f64; 3]> {
            let corner = |i: f64| {
                let angle = i * turns * std::f64::consts::TAU / 5.0;
                [angle.cos(), angle.sin(), if i == 2.0 { lift } else { 0.0 }]
            };
            [0.0, 1.0, 2.0, 3.0, 4.0].map(corner).to_vec()
        };
        let all = [0.0, 1.0, 2.0, 3.0, 4.0];
        assert_eq!(split(&ring(1.0, 0.0), &all).0, [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
        assert_eq!(split(&ring(1.0, 1e-6), &all).0.len(), 3, "rounding is not a bend");
        assert!(split(&ring(1.0, 0.1), &all).0.is_empty(), "bent");
        assert!(
            split(&ring(2.0, 0.0), &all).0.is_empty(),
            "a pentagram turns left everywhere, but twice round"
        );
        let mut dented = ring(1.0, 0.0);
        dented[2] = [0.0, 0.0, 0.0];
        assert!(split(&dented, &all).0.is_empty(), "dented");
    }

    #[test]
    fn repeated_corners_are_dropped_and_missing_points_named() {
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        assert_eq!(split(&points, &[0.0, 1.0, 1.0, 2.0, 0.0]).0, [[0, 1, 2]]);
        let (triangles, said) = split(&points, &[0.0, 1.0, 0.0]);
        assert!(triangles.is_empty());
        assert_eq!(
            said,
            ["faces with fewer than three different corners, dropped: 1, the first is face 0"]
        );
        assert_eq!(
            split(&points, &[0.0, 1.0, 3.0]).1,
            ["point 3 does not exist: there are 3, from 0"]
        );
        assert_eq!(
            split(&points, &[0.0, -1.0, 2.0]).1,
            ["point -1 does not exist: there are 3, from 0"]
        );
    }

    #[test]
    fn every_other_triangle_of_a_strip_is_turned() {
        let mut mesh = PolyData {
            points: vec![[0.0; 3]; 5],
            ..PolyData::default()
        };
        let mut faults = Faults::new("f".into());
        CellReader::default()
            .strip(&mut mesh, 7, &[0.0, 1.0, 2.0, 3.0, 3.0, 4.0], &mut faults)
            .unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [2, 1, 3]]);
        assert_eq!(mesh.triangle_source, [7, 7]);
    }
}

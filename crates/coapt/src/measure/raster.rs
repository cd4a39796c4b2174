//! Height fields over the annular plane.

use crate::Vec3;

/// Heights at the centres of square pixels; negative infinity where nothing is.
#[derive(Clone)]
pub(super) struct Raster {
    /// Edge of a pixel [mm].
    pub(super) pixel_mm: f64,
    /// Heights, row by row.
    pub(super) height_mm: Vec<f64>,
    columns: usize,
    rows: usize,
    corner: [f64; 2],
}

/// Pixels along a side at most.
const MOST_PIXELS: usize = 400;

impl Raster {
    /// An empty raster over the bounding box of some points, with pixels of the given size or as large as they must be.
    pub(super) fn over(points: &[Vec3], pixel_mm: f64) -> Self {
        let low = points
            .iter()
            .fold(Vec3::repeat(f64::INFINITY), |low, p| low.inf(p));
        let high = points
            .iter()
            .fold(Vec3::repeat(f64::NEG_INFINITY), |high, p| high.sup(p));
        let extent = if points.is_empty() {
            Vec3::zeros()
        } else {
            high - low
        };
        let pixel_mm = pixel_mm
            .max(extent.x.max(extent.y) / MOST_PIXELS as f64)
            .max(f64::MIN_POSITIVE);
        let count = |length: f64| (length / pixel_mm).ceil().clamp(1.0, MOST_PIXELS as f64) as usize;
        let (columns, rows) = (count(extent.x), count(extent.y));
        let height_mm = vec![f64::NEG_INFINITY; columns * rows];
        Self {
            pixel_mm,
            height_mm,
            columns,
            rows,
            corner: [low.x, low.y],
        }
    }

    /// Raises the raster to a triangle where that is higher.
    pub(super) fn paint(&mut self, [a, b, c]: [Vec3; 3]) {
        let twice_area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        if twice_area == 0.0 {
            return;
        }
        let (columns, rows) = (
            self.range(0, self.columns, [a.x, b.x, c.x]),
            self.range(1, self.rows, [a.y, b.y, c.y]),
        );
        for row in rows {
            let y = self.corner[1] + (row as f64 + 0.5) * self.pixel_mm;
            for column in columns.clone() {
                let x = self.corner[0] + (column as f64 + 0.5) * self.pixel_mm;
                let v = ((x - a.x) * (c.y - a.y) - (y - a.y) * (c.x - a.x)) / twice_area;
                let w = ((b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x)) / twice_area;
                // A hair beyond the edge, so that no pixel falls between two triangles.
                if v >= -1e-9 && w >= -1e-9 && v + w <= 1.0 + 1e-9 {
                    let height = &mut self.height_mm[row * self.columns + column];
                    *height = height.max(a.z + v * (b.z - a.z) + w * (c.z - a.z));
                }
            }
        }
    }

    /// Height at a place, linear between the four pixel centres around it, of which empty ones are left out; nothing
    /// where all are.
    pub(super) fn height_at(&self, x: f64, y: f64) -> Option<f64> {
        let place = |value: f64, axis: usize, count: usize| {
            let place = (value - self.corner[axis]) / self.pixel_mm - 0.5;
            place.clamp(0.0, (count - 1) as f64)
        };
        let (column, row) = (place(x, 0, self.columns), place(y, 1, self.rows));
        let (mut sum, mut total) = (0.0, 0.0);
        for r in [row.floor(), row.floor() + 1.0] {
            for c in [column.floor(), column.floor() + 1.0] {
                let weight = (1.0 - (column - c).abs()) * (1.0 - (row - r).abs());
                if weight > 0.0 {
                    let height = self.height_mm[r as usize * self.columns + c as usize];
                    if height.is_finite() {
                        sum += weight * height;
                        total += weight;
                    }
                }
            }
        }
        (total > 0.0).then(|| sum / total)
    }

    /// Pixels whose centres may lie within the extent of a triangle along one axis.
    fn range(&self, axis: usize, count: usize, [a, b, c]: [f64; 3]) -> std::ops::Range<usize> {
        let place = |x: f64| (x - self.corner[axis]) / self.pixel_mm - 0.5;
        // A negative or too large number saturates in the cast.
        let first = (place(a.min(b).min(c)) - 1e-6).ceil() as usize;
        let last = (place(a.max(b).max(c)) + 1e-6).floor();
        let end = if last < 0.0 {
            0
        } else {
            (last as usize).saturating_add(1)
        };
        first.min(count)..end.min(count)
    }

    /// Fills what is narrower than `width_mm`, empty or deep: between two leaflets in contact the mid-surfaces stand a
    /// thickness apart, and a line of sight into that slit is no part of the surface.
    pub(super) fn close_slits(&mut self, width_mm: f64) {
        let reach = (0.5 * width_mm / self.pixel_mm).ceil() as usize;
        for (columns, rows) in [(reach, 0), (0, reach)] {
            self.height_mm = self.filtered(columns, rows, f64::NEG_INFINITY, f64::max);
        }
        for (columns, rows) in [(reach, 0), (0, reach)] {
            self.height_mm = self.filtered(columns, rows, f64::INFINITY, f64::min);
        }
    }

    /// The largest or smallest height within a reach of each pixel.
    fn filtered(&self, columns: usize, rows: usize, start: f64, pick: fn(f64, f64) -> f64) -> Vec<f64> {
        let near =
            |at: usize, reach: usize, count: usize| at.saturating_sub(reach)..(at + reach + 1).min(count);
        let mut picked = Vec::with_capacity(self.height_mm.len());
        for row in 0..self.rows {
            for column in 0..self.columns {
                let mut value = start;
                for r in near(row, rows, self.rows) {
                    for c in near(column, columns, self.columns) {
                        value = pick(value, self.height_mm[r * self.columns + c]);
                    }
                }
                picked.push(value);
            }
        }
        picked
    }

    /// Areas of the connected parts that are empty here but not in the mask [mm²], the largest first; pixels join at their sides.
    pub(super) fn gaps_mm2(&self, mask: &Self) -> Vec<f64> {
        let mut is_gap: Vec<bool> = self
            .height_mm
            .iter()
            .zip(&mask.height_mm)
            .map(|(here, mask)| !here.is_finite() && mask.is_finite())
            .collect();
        let mut areas_mm2 = Vec::new();
        let mut reached = Vec::new();
        for first in 0..is_gap.len() {
            reached.extend(std::mem::take(&mut is_gap[first]).then_some(first));
            let mut count = 0;
            while let Some(pixel) = reached.pop() {
                count += 1;
                for beside in self.beside(pixel) {
                    reached.extend(std::mem::take(&mut is_gap[beside]).then_some(beside));
                }
            }
            if count > 0 {
                areas_mm2.push(f64::from(count) * self.pixel_mm * self.pixel_mm);
            }
        }
        areas_mm2.sort_by(|a, b| b.total_cmp(a));
        areas_mm2
    }

    /// Fills pixels that are empty here but not in the mask with the mean of their neighbours, from the rim inwards.
    pub(super) fn bridge(&mut self, mask: &Self) {
        loop {
            let layer: Vec<(usize, f64)> = (0..self.height_mm.len())
                .filter(|&i| !self.height_mm[i].is_finite() && mask.height_mm[i].is_finite())
                .filter_map(|i| self.neighbour_mean(i).map(|mean| (i, mean)))
                .collect();
            if layer.is_empty() {
                break;
            }
            for (i, mean) in layer {
                self.height_mm[i] = mean;
            }
        }
    }

    /// The pixels at the sides of one.
    fn beside(&self, i: usize) -> impl Iterator<Item = usize> + use<> {
        let (row, column) = (i / self.columns, i % self.columns);
        let neighbours = [
            (column > 0).then(|| i - 1),
            (column + 1 < self.columns).then_some(i + 1),
            (row > 0).then(|| i - self.columns),
            (row + 1 < self.rows).then_some(i + self.columns),
        ];
        neighbours.into_iter().flatten()
    }

    fn neighbour_mean(&self, i: usize) -> Option<f64> {
        let heights = self
            .beside(i)
            .map(|n| self.height_mm[n])
            .filter(|h| h.is_finite());
        let (sum, count) = heights.fold((0.0, 0), |(sum, count), h| (sum + h, count + 1));
        (count > 0).then(|| sum / f64::from(count))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn p(x: f64, y: f64, z: f64) -> Vec3 {
        Vec3::new(x, y, z)
    }

    /// A tilted plane is met exactly at every pixel centre, and the higher of two sheets wins.
    #[test]
    fn sheets_are_painted_at_their_height() {
        let corners = [
            p(0.0, 0.0, 0.0),
            p(4.0, 0.0, 8.0),
            p(4.0, 4.0, 12.0),
            p(0.0, 4.0, 4.0),
        ];
        let mut raster = Raster::over(&corners, 1.0);
        raster.paint([corners[0], corners[1], corners[2]]);
        raster.paint([corners[0], corners[2], corners[3]]);
        raster.paint(
            corners[..3]
                .iter()
                .map(|q| p(q.x, q.y, 3.0))
                .collect::<Vec<_>>()
                .try_into()
                .unwrap(),
        );
        for row in 0..4 {
            for column in 0..4 {
                let plane = 2.0 * (f64::from(column) + 0.5) + f64::from(row) + 0.5;
                let expected = if column >= row { plane.max(3.0) } else { plane };
                let painted = raster.height_mm[(row * 4 + column) as usize];
                assert!((painted - expected).abs() < 1e-12, "{row} {column} {painted}");
            }
        }
    }

    /// Between pixel centres a plane is read exactly, beyond the outermost ones as there, and empty pixels are left
    /// out.
    #[test]
    fn heights_are_read_between_centres() {
        let mut raster = Raster::over(&[p(0.0, 0.0, 0.0), p(4.0, 4.0, 0.0)], 1.0);
        assert_eq!(raster.height_at(1.0, 1.0), None);
        let plane = |x: f64, y: f64| p(x, y, 2.0 * x + y);
        raster.paint([plane(0.0, 0.0), plane(8.0, 0.0), plane(0.0, 8.0)]);
        for (x, y) in [(1.0, 1.0), (2.3, 1.9), (0.5, 3.5)] {
            assert!(
                (raster.height_at(x, y).unwrap() - 2.0 * x - y).abs() < 1e-12,
                "{x} {y}"
            );
        }
        assert!((raster.height_at(-5.0, 9.0).unwrap() - 4.5).abs() < 1e-12);
        raster.height_mm[5] = f64::NEG_INFINITY;
        assert!((raster.height_at(2.0, 1.5).unwrap() - 6.5).abs() < 1e-12);
    }

    /// A gap between two sheets of height 1 and 3 is bridged with heights between, and nothing beyond the mask.
    #[test]
    fn gaps_are_bridged() {
        let mut mask = Raster::over(&[p(0.0, 0.0, 0.0), p(6.0, 1.0, 0.0)], 1.0);
        let mut raster = mask.clone();
        let square = |raster: &mut Raster, x: f64, w: f64, z: f64| {
            let corners = [p(x, 0.0, z), p(x + w, 0.0, z), p(x + w, 1.0, z), p(x, 1.0, z)];
            raster.paint([corners[0], corners[1], corners[2]]);
            raster.paint([corners[0], corners[2], corners[3]]);
        };
        square(&mut mask, 0.0, 5.0, 0.0);
        square(&mut raster, 0.0, 1.0, 1.0);
        square(&mut raster, 4.0, 1.0, 3.0);
        raster.bridge(&mask);
        assert_eq!(raster.height_mm, [1.0, 1.0, 2.0, 3.0, 3.0, f64::NEG_INFINITY]);
    }

    /// No point, a single point and far too many pixels are all a small raster.
    #[test]
    fn size_is_bounded() {
        assert_eq!(Raster::over(&[], 0.25).height_mm.len(), 1);
        assert_eq!(Raster::over(&[p(1.0, 1.0, 1.0)], 0.0).height_mm.len(), 1);
        assert_eq!(
            Raster::over(&[p(0.0, 0.0, 0.0), p(1e6, 1e6, 0.0)], 0.25)
                .height_mm
                .len(),
            160_000
        );
    }
}

//! Pixels: triangles and lines with depth, rectangles and words.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

/// Red, green and blue, each from 0 to 1.
pub(super) type Colour = [f32; 3];

pub(super) const WHITE: Colour = [1.0; 3];
pub(super) const INK: Colour = [0.1; 3];

/// A corner of a triangle or an end of a line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    /// Pixels to the right and down, and nearness: what is nearer hides what is farther.
    pub(super) at: [f32; 3],
    /// Colour there.
    pub(super) colour: Colour,
}

/// A picture being drawn.
#[derive(Clone, Debug)]
pub(super) struct Canvas {
    /// Pixels across.
    pub(super) width: usize,
    /// Pixels down.
    pub(super) height: usize,
    colours: Vec<Colour>,
    nearness: Vec<f32>,
}

impl Canvas {
    /// White and empty.
    pub(super) fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            colours: vec![WHITE; width * height],
            nearness: vec![f32::NEG_INFINITY; width * height],
        }
    }

    /// A triangle whose colour runs linearly between its corners.
    pub(super) fn triangle(&mut self, corners: [Corner; 3]) {
        let [a, b, c] = corners.map(|corner| corner.at);
        let area = edge(a, b, c);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let span = |axis: usize, limit: usize| -> std::ops::Range<usize> {
            let values = [a[axis], b[axis], c[axis]];
            let low = values.iter().copied().fold(f32::INFINITY, f32::min).floor();
            let high = values.iter().copied().fold(f32::NEG_INFINITY, f32::max).ceil();
            low.max(0.0) as usize..(high.max(0.0) as usize + 1).min(limit)
        };
        for y in span(1, self.height) {
            for x in span(0, self.width) {
                let here = [x as f32 + 0.5, y as f32 + 0.5, 0.0];
                let shares = [edge(b, c, here), edge(c, a, here), edge(a, b, here)].map(|part| part / area);
                if shares.iter().all(|&share| share >= 0.0) {
                    let mix = |value: fn(&Corner) -> f32| -> f32 {
                        shares
                            .iter()
                            .zip(&corners)
                            .map(|(share, corner)| share * value(corner))
                            .sum()
                    };
                    let colour = [
                        mix(|corner| corner.colour[0]),
                        mix(|corner| corner.colour[1]),
                        mix(|corner| corner.colour[2]),
                    ];
                    self.put(x, y, mix(|corner| corner.at[2]), colour);
                }
            }
        }
    }

    /// A line so many pixels wide.
    pub(super) fn line(&mut self, [from, to]: [Corner; 2], width: f32) {
        let along = [to.at[0] - from.at[0], to.at[1] - from.at[1]];
        let length = along[0].hypot(along[1]);
        // Nothing that is seen is so long.
        if !length.is_finite() || length > 4.0 * (self.width + self.height) as f32 {
            return;
        }
        let steps = (2.0 * length).ceil().max(1.0) as usize;
        let reach = (width / 2.0).ceil() as i64;
        for step in 0..=steps {
            let share = step as f32 / steps as f32;
            let mix = |a: f32, b: f32| a + (b - a) * share;
            let at: [f32; 3] = std::array::from_fn(|axis| mix(from.at[axis], to.at[axis]));
            let colour = std::array::from_fn(|part| mix(from.colour[part], to.colour[part]));
            for dy in -reach..=reach {
                for dx in -reach..=reach {
                    let (x, y) = (at[0].floor() + dx as f32, at[1].floor() + dy as f32);
                    let inside =
                        x >= 0.0 && y >= 0.0 && (x as usize) < self.width && (y as usize) < self.height;
                    if inside && (x + 0.5 - at[0]).hypot(y + 0.5 - at[1]) <= width / 2.0 {
                        self.put(x as usize, y as usize, at[2], colour);
                    }
                }
            }
        }
    }

    /// A rectangle over everything.
    pub(super) fn rectangle(&mut self, [left, top]: [usize; 2], [width, height]: [usize; 2], colour: Colour) {
        for y in top..(top + height).min(self.height) {
            for x in left..(left + width).min(self.width) {
                self.put(x, y, f32::INFINITY, colour);
            }
        }
    }

    /// Words from their upper left corner, over everything; letters that the font lacks as question marks. Tells where they end.
    pub(super) fn words(&mut self, [left, top]: [usize; 2], text: &str, colour: Colour) -> usize {
        let mut x = left;
        for letter in text.chars() {
            let drawn = get_raster(letter, WEIGHT, SIZE).or_else(|| get_raster('?', WEIGHT, SIZE));
            let rows = drawn.as_ref().map_or(&[][..], |letter| letter.raster());
            for (dy, row) in rows.iter().enumerate() {
                for (dx, &strength) in row.iter().enumerate() {
                    self.blend(x + dx, top + dy, colour, f32::from(strength) / 255.0);
                }
            }
            x += LETTER_WIDTH;
        }
        x
    }

    /// Another picture in this one.
    pub(super) fn place(&mut self, [left, top]: [usize; 2], other: &Self) {
        for y in 0..other.height.min(self.height.saturating_sub(top)) {
            for x in 0..other.width.min(self.width.saturating_sub(left)) {
                self.colours[(top + y) * self.width + left + x] = other.colours[y * other.width + x];
            }
        }
    }

    /// Half as large, each pixel the mean of four: edges become smooth.
    pub(super) fn halved(&self) -> Self {
        let mut half = Self::new(self.width / 2, self.height / 2);
        for y in 0..half.height {
            for x in 0..half.width {
                let four = [(0, 0), (1, 0), (0, 1), (1, 1)]
                    .map(|(dx, dy)| self.colours[(2 * y + dy) * self.width + 2 * x + dx]);
                half.colours[y * half.width + x] =
                    std::array::from_fn(|part| four.iter().map(|colour| colour[part]).sum::<f32>() / 4.0);
            }
        }
        half
    }

    /// Red, green and blue of each pixel, row by row.
    pub(super) fn bytes(&self) -> Vec<u8> {
        let part = |part: f32| (part.clamp(0.0, 1.0) * 255.0).round() as u8;
        self.colours.iter().flatten().map(|&value| part(value)).collect()
    }

    fn put(&mut self, x: usize, y: usize, nearness: f32, colour: Colour) {
        let at = y * self.width + x;
        if nearness >= self.nearness[at] {
            self.nearness[at] = nearness;
            self.colours[at] = colour;
        }
    }

    fn blend(&mut self, x: usize, y: usize, colour: Colour, strength: f32) {
        if x < self.width && y < self.height {
            let old = &mut self.colours[y * self.width + x];
            *old = std::array::from_fn(|part| old[part] + (colour[part] - old[part]) * strength);
        }
    }
}

const WEIGHT: FontWeight = FontWeight::Regular;
const SIZE: RasterHeight = RasterHeight::Size16;

/// Pixels that a letter takes across.
pub(super) const LETTER_WIDTH: usize = get_raster_width(WEIGHT, SIZE);

/// Twice the area of a triangle on the picture, positive where its corners run clockwise as seen.
fn edge(a: [f32; 3], b: [f32; 3], c: [f32; 3]) -> f32 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner(x: f32, y: f32, nearness: f32, colour: Colour) -> Corner {
        Corner {
            at: [x, y, nearness],
            colour,
        }
    }

    fn triangle(nearness: f32, colour: Colour) -> [Corner; 3] {
        [(0.0, 0.0), (8.0, 0.0), (0.0, 8.0)].map(|(x, y)| corner(x, y, nearness, colour))
    }

    /// Half of a square of 8 pixels is filled, whichever way the triangle runs: the 28 below its diagonal, and the 8 on it.
    #[test]
    fn a_triangle_fills_its_pixels() {
        for reversed in [false, true] {
            let mut canvas = Canvas::new(8, 8);
            let mut corners = triangle(0.0, INK);
            if reversed {
                corners.reverse();
            }
            canvas.triangle(corners);
            let dark = canvas.colours.iter().filter(|colour| colour[0] < 0.5).count();
            assert_eq!(dark, 36);
        }
    }

    /// What is nearer hides what is farther, whichever is drawn first.
    #[test]
    fn nearer_hides_farther() {
        let (near, far) = (triangle(2.0, [1.0, 0.0, 0.0]), triangle(1.0, [0.0, 0.0, 1.0]));
        for order in [[near, far], [far, near]] {
            let mut canvas = Canvas::new(8, 8);
            order.into_iter().for_each(|corners| canvas.triangle(corners));
            assert_eq!(canvas.colours[0], [1.0, 0.0, 0.0]);
        }
    }

    /// Nothing outside is drawn and nothing panics: triangles beyond every side, without area, and not finite.
    #[test]
    fn what_is_outside_is_left_out() {
        let mut canvas = Canvas::new(8, 8);
        for shift in [-1e9, -20.0, 20.0, 1e9, f32::NAN] {
            let moved = triangle(0.0, INK).map(|corner| Corner {
                at: [corner.at[0] + shift, corner.at[1], 0.0],
                ..corner
            });
            canvas.triangle(moved);
            canvas.line([moved[0], moved[1]], 3.0);
        }
        assert!(canvas.colours.iter().all(|&colour| colour == WHITE));
    }

    #[test]
    fn words_leave_ink_and_tell_their_end() {
        let mut canvas = Canvas::new(100, 20);
        assert_eq!(canvas.words([2, 2], "10 mm", INK), 2 + 5 * LETTER_WIDTH);
        assert!(canvas.bytes().iter().any(|&byte| byte < 100));
    }
}

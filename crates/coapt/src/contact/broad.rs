//! Sweep and prune over the boxes of triangles.
//!
//! The boxes are kept in the order of their lower ends along one axis. Between two calls that order hardly
//! changes, so an insertion sort restores it in about linear time. The boxes are then dealt out to strips along a
//! second axis and each strip is swept alone, over boxes that lie one after another in memory: the cost stays nearly
//! linear in the number of faces.

use crate::Vec3;

/// The sorted boxes, kept from call to call.
#[derive(Clone, Debug, Default)]
pub struct SweepAndPrune {
    axes: [usize; 3],
    order: Vec<u32>,
    boxes: Vec<FaceBox>,
    strips: Vec<Vec<FaceBox>>,
}

#[derive(Clone, Copy, Debug)]
struct FaceBox {
    low: [f64; 3],
    high: [f64; 3],
    face: u32,
}

/// Width of a strip in mean box widths [1]. Boxes on a seam lie in two strips: at 1 every second box does, beyond 4
/// the sweep meets too many boxes that are far off; between, the time hardly changes.
const STRIP_WIDTH: f64 = 2.0;

impl SweepAndPrune {
    /// Calls `visit(f, g)` for every two faces whose boxes, each grown by half of `reach_mm`, overlap: every
    /// pair of faces within `reach_mm` of each other is among them, each once, in a fixed order.
    pub fn overlapping_faces(
        &mut self,
        faces: &[[u32; 3]],
        positions_mm: &[Vec3],
        reach_mm: f64,
        visit: impl FnMut(u32, u32),
    ) {
        self.grown_overlaps(faces, positions_mm, |_| 0.5 * reach_mm, visit);
    }

    /// The same for boxes that are each grown by a margin of their own.
    pub fn grown_overlaps(
        &mut self,
        faces: &[[u32; 3]],
        positions_mm: &[Vec3],
        margin_mm: impl Fn(u32) -> f64,
        mut visit: impl FnMut(u32, u32),
    ) {
        self.sort(faces, positions_mm, margin_mm);
        let (start, width, count) = self.deal_out();
        let [along, across, third] = self.axes;
        for (number, strip) in self.strips[..count].iter().enumerate() {
            for (index, lower) in strip.iter().enumerate() {
                let end = lower.high[along];
                for upper in strip[index + 1..]
                    .iter()
                    .take_while(|upper| upper.low[along] <= end)
                {
                    if lower.low[across] <= upper.high[across]
                        && upper.low[across] <= lower.high[across]
                        && lower.low[third] <= upper.high[third]
                        && upper.low[third] <= lower.high[third]
                        // Two boxes may share two strips: the one where their overlap begins tells of them.
                        && strip_of(lower.low[across].max(upper.low[across]), start, width, count) == number
                    {
                        visit(lower.face, upper.face);
                    }
                }
            }
        }
    }

    /// Puts each box into every strip that it reaches; returns where the first strip starts, their width and number.
    fn deal_out(&mut self) -> (f64, f64, usize) {
        let across = self.axes[1];
        let (mut low, mut high, mut sum) = (f64::INFINITY, f64::NEG_INFINITY, 0.0);
        for face_box in &self.boxes {
            low = low.min(face_box.low[across]);
            high = high.max(face_box.high[across]);
            sum += face_box.high[across] - face_box.low[across];
        }
        let width = STRIP_WIDTH * sum / self.boxes.len().max(1) as f64;
        let wanted = (high - low) / width;
        // Never more strips than boxes, and one where there is nothing to divide by.
        let count = if wanted >= 1.0 {
            (wanted as usize).min(self.boxes.len())
        } else {
            1
        };
        let width = (high - low) / count as f64;
        self.strips.iter_mut().for_each(Vec::clear);
        self.strips.resize(self.strips.len().max(count), Vec::new());
        for face_box in &self.boxes {
            let first = strip_of(face_box.low[across], low, width, count);
            let last = strip_of(face_box.high[across], low, width, count);
            self.strips[first..=last]
                .iter_mut()
                .for_each(|strip| strip.push(*face_box));
        }
        (low, width, count)
    }

    fn sort(&mut self, faces: &[[u32; 3]], positions_mm: &[Vec3], margin_mm: impl Fn(u32) -> f64) {
        if self.order.len() != faces.len() {
            self.axes = axes_by_length(positions_mm);
            self.order = (0..faces.len() as u32).collect();
            let along = self.axes[0];
            let low = |&face: &u32| face_box(faces, positions_mm, face, 0.0).low[along];
            self.order.sort_by(|a, b| low(a).total_cmp(&low(b)));
        }
        let boxes = self
            .order
            .iter()
            .map(|&face| face_box(faces, positions_mm, face, margin_mm(face)));
        self.boxes.clear();
        self.boxes.extend(boxes);
        insertion_sort(&mut self.boxes, self.axes[0]);
        for (slot, face_box) in self.order.iter_mut().zip(&self.boxes) {
            *slot = face_box.face;
        }
    }
}

fn insertion_sort(boxes: &mut [FaceBox], axis: usize) {
    for index in 1..boxes.len() {
        let moving = boxes[index];
        let mut slot = index;
        while slot > 0 && boxes[slot - 1].low[axis] > moving.low[axis] {
            boxes[slot] = boxes[slot - 1];
            slot -= 1;
        }
        boxes[slot] = moving;
    }
}

fn face_box(faces: &[[u32; 3]], positions_mm: &[Vec3], face: u32, margin_mm: f64) -> FaceBox {
    let [a, b, c] = faces[face as usize].map(|vertex| positions_mm[vertex as usize]);
    let (low, high) = (a.inf(&b).inf(&c), a.sup(&b).sup(&c));
    FaceBox {
        low: std::array::from_fn(|k| low[k] - margin_mm),
        high: std::array::from_fn(|k| high[k] + margin_mm),
        face,
    }
}

fn strip_of(value: f64, start: f64, width: f64, count: usize) -> usize {
    // A cast saturates: below the first strip is the first.
    (((value - start) / width) as usize).min(count - 1)
}

/// The axes, the one along which the points extend farthest first.
fn axes_by_length(positions_mm: &[Vec3]) -> [usize; 3] {
    let low = positions_mm
        .iter()
        .fold(Vec3::repeat(f64::INFINITY), |low, point| low.inf(point));
    let high = positions_mm
        .iter()
        .fold(Vec3::repeat(f64::NEG_INFINITY), |high, point| high.sup(point));
    let length = high - low;
    let mut axes = [0, 1, 2];
    axes.sort_by(|&a, &b| length[b].total_cmp(&length[a]));
    axes
}

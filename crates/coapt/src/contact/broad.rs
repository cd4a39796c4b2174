//! Sweep and prune over the boxes of triangles.
//!
//! The boxes are kept in the order of their lower ends along one axis. Between two calls that order hardly
//! changes, so an insertion sort restores it in about linear time; the sweep then runs over boxes that lie one
//! after another in memory.

use crate::Vec3;

/// The sorted boxes, kept from call to call.
#[derive(Clone, Debug, Default)]
pub struct SweepAndPrune {
    axis: usize,
    order: Vec<u32>,
    boxes: Vec<FaceBox>,
}

#[derive(Clone, Copy, Debug)]
struct FaceBox {
    low: [f64; 3],
    high: [f64; 3],
    face: u32,
}

impl SweepAndPrune {
    /// Calls `visit(f, g)` for every two faces whose boxes, each grown by half of `reach_mm`, overlap: every
    /// pair of faces within `reach_mm` of each other is among them, each once, in a fixed order.
    pub fn overlapping_faces(
        &mut self,
        faces: &[[u32; 3]],
        positions_mm: &[Vec3],
        reach_mm: f64,
        mut visit: impl FnMut(u32, u32),
    ) {
        self.sort(faces, positions_mm, 0.5 * reach_mm);
        let (first, second) = ((self.axis + 1) % 3, (self.axis + 2) % 3);
        for (index, lower) in self.boxes.iter().enumerate() {
            let end = lower.high[self.axis];
            for upper in self.boxes[index + 1..]
                .iter()
                .take_while(|upper| upper.low[self.axis] <= end)
            {
                if lower.low[first] <= upper.high[first]
                    && upper.low[first] <= lower.high[first]
                    && lower.low[second] <= upper.high[second]
                    && upper.low[second] <= lower.high[second]
                {
                    visit(lower.face, upper.face);
                }
            }
        }
    }

    fn sort(&mut self, faces: &[[u32; 3]], positions_mm: &[Vec3], margin_mm: f64) {
        if self.order.len() != faces.len() {
            self.axis = longest_axis(positions_mm);
            self.order = (0..faces.len() as u32).collect();
            let low = |&face: &u32| face_box(faces, positions_mm, face, 0.0).low[self.axis];
            self.order.sort_by(|a, b| low(a).total_cmp(&low(b)));
        }
        let boxes = self
            .order
            .iter()
            .map(|&face| face_box(faces, positions_mm, face, margin_mm));
        self.boxes.clear();
        self.boxes.extend(boxes);
        insertion_sort(&mut self.boxes, self.axis);
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

fn longest_axis(positions_mm: &[Vec3]) -> usize {
    let low = positions_mm
        .iter()
        .fold(Vec3::repeat(f64::INFINITY), |low, point| low.inf(point));
    let high = positions_mm
        .iter()
        .fold(Vec3::repeat(f64::NEG_INFINITY), |high, point| high.sup(point));
    (high - low).imax()
}

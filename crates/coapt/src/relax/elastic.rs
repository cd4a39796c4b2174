//! What tissue and pressure put into the tangent: its pattern never changes, so places are looked up once.

use super::block_matrix::BlockMatrix;
use super::load;
use crate::energy::{BlockSink, Curvature};
use crate::model::Model;
use crate::{Mat3, Vec3};

/// Marks a vertex without a free index, and a block that no free vertex sees.
pub(super) const PRESCRIBED: u32 = u32::MAX;

/// What a motion of the prescribed vertices takes from the right-hand side.
pub(super) struct Moved<'a> {
    /// Motion of prescribed vertices in this step [mm], shape `[vertex]`.
    pub(super) motion_mm: &'a [Vec3],
    /// Right-hand side [N], shape `[free]`.
    pub(super) right_n: &'a mut [Vec3],
}

impl Moved<'_> {
    pub(super) fn take(&mut self, [row, column]: [u32; 2], [i, j]: [u32; 2], block: &Mat3) {
        match (i == PRESCRIBED, j == PRESCRIBED) {
            (false, true) => self.right_n[i as usize] -= block * self.motion_mm[column as usize],
            (true, false) => self.right_n[j as usize] -= block.tr_mul(&self.motion_mm[row as usize]),
            _ => {}
        }
    }
}

/// The tangent without contact over the free vertices.
pub(super) struct Elastic {
    pub(super) matrix: BlockMatrix,
    /// Where the blocks of springs, chordae and pressure go, in the order in which these hand them out.
    slots: Vec<Slot>,
    /// Bending, which does not depend on positions: multiples of the identity [N/mm], shape `[block]`.
    bending_n_per_mm: Vec<f64>,
    bending_of_prescribed: Vec<Held>,
}

/// Where a block goes.
#[derive(Clone, Copy)]
struct Slot {
    /// Index of the block, or [`PRESCRIBED`].
    index: u32,
    transposed: bool,
}

/// How the bending of a hinge ties a free vertex to a prescribed one.
struct Held {
    /// Free index.
    free: u32,
    /// Prescribed vertex.
    vertex: u32,
    stiffness_n_per_mm: f64,
}

impl Elastic {
    /// Finds the pattern; `free_index` holds the free index of each vertex, or [`PRESCRIBED`].
    pub(super) fn new(model: &Model, free_index: &[u32], size: usize) -> Self {
        let index = |[row, column]: [u32; 2]| [free_index[row as usize], free_index[column as usize]];
        let mut handed_out = Vec::new();
        let mut sink = |row: u32, column: u32, _: &Mat3| handed_out.push(index([row, column]));
        // Places do not depend on positions.
        load::add_varying_tangent(model, &model.rest_mm, Curvature::Exact, &mut sink);
        let mut bending = Vec::new();
        let mut sink = |row: u32, column: u32, block: &Mat3| bending.push(([row, column], block[0]));
        load::add_constant_tangent(model, &mut sink);
        let places = handed_out.iter().copied();
        let places = places.chain(bending.iter().map(|&(vertices, _)| index(vertices)));
        let places: Vec<[u32; 2]> = places.filter(|place| !place.contains(&PRESCRIBED)).collect();
        let matrix = BlockMatrix::with_pattern(size, &places);
        let slots = handed_out.iter().map(|&place| slot_of(&matrix, place)).collect();
        let mut elastic = Self {
            bending_n_per_mm: vec![0.0; matrix.rows.len()],
            bending_of_prescribed: Vec::new(),
            matrix,
            slots,
        };
        for &(vertices, stiffness_n_per_mm) in &bending {
            elastic.add_bending(vertices, index(vertices), stiffness_n_per_mm);
        }
        elastic
    }

    fn add_bending(&mut self, [row, column]: [u32; 2], place: [u32; 2], stiffness_n_per_mm: f64) {
        let (free, vertex) = match place {
            [PRESCRIBED, PRESCRIBED] => return,
            [PRESCRIBED, free] => (free, row),
            [free, PRESCRIBED] => (free, column),
            _ => {
                let slot = slot_of(&self.matrix, place).index;
                self.bending_n_per_mm[slot as usize] += stiffness_n_per_mm;
                return;
            }
        };
        self.bending_of_prescribed.push(Held {
            free,
            vertex,
            stiffness_n_per_mm,
        });
    }

    /// Fills the matrix, and takes from the right-hand side what the motion of prescribed vertices brings.
    pub(super) fn fill(
        &mut self,
        model: &Model,
        free_index: &[u32],
        positions: &[Vec3],
        curvature: Curvature,
        moved: &mut Option<Moved>,
    ) {
        for (block, &stiffness) in self.matrix.blocks.iter_mut().zip(&self.bending_n_per_mm) {
            *block = Mat3::from_diagonal_element(stiffness);
        }
        if let Some(Moved { motion_mm, right_n }) = moved {
            for held in &self.bending_of_prescribed {
                right_n[held.free as usize] -= motion_mm[held.vertex as usize] * held.stiffness_n_per_mm;
            }
        }
        let mut sink = Replay {
            slots: self.slots.iter(),
            free_index,
            matrix: &mut self.matrix,
            moved,
        };
        load::add_varying_tangent(model, positions, curvature, &mut sink);
    }
}

fn slot_of(matrix: &BlockMatrix, [i, j]: [u32; 2]) -> Slot {
    let is_free = i != PRESCRIBED && j != PRESCRIBED;
    let slot = is_free.then(|| matrix.slot(i, j)).flatten();
    Slot {
        index: slot.map_or(PRESCRIBED, |slot| slot as u32),
        transposed: i < j,
    }
}

/// Puts blocks that come in a known order where they belong.
struct Replay<'a, 'b> {
    slots: std::slice::Iter<'a, Slot>,
    free_index: &'a [u32],
    matrix: &'a mut BlockMatrix,
    moved: &'a mut Option<Moved<'b>>,
}

impl BlockSink for Replay<'_, '_> {
    #[inline]
    fn add(&mut self, row: u32, column: u32, block: &Mat3) {
        let Some(&Slot { index, transposed }) = self.slots.next() else {
            return;
        };
        if index != PRESCRIBED {
            self.matrix.add_at(index as usize, transposed, block);
        } else if let Some(moved) = self.moved {
            let place = [self.free_index[row as usize], self.free_index[column as usize]];
            moved.take([row, column], place, block);
        }
    }
}

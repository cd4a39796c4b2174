//! The linear system of one Newton step: the tangent over the free vertices, factorised and solved.

use super::block_matrix::BlockMatrix;
use super::cholesky::{Factor, Symbolic};
use super::elastic::{Elastic, Moved, PRESCRIBED};
use super::krylov::{Effort, Krylov};
use super::load;
use crate::contact::pairs::{Pair, PairKind};
use crate::contact::surface::Surface;
use crate::contact::touch::Touch;
use crate::energy::{BlockSink, Curvature, pressure};
use crate::model::Model;
use crate::{Mat3, Vec3};

/// Pairs nearer than this times their activation distance get places in the pattern, so that it lasts for some steps
/// [1]. At 1 it is made anew nearly every time; beyond 2 the fill costs more than the analyses saved.
const PATTERN_MARGIN: f64 = 1.5;
/// Block rows from which zero blocks are left out [1]. At 360 (650 faces) new analyses take what they save; at 5,000 the
/// factorisation takes half as long.
const PRUNED_FROM: usize = 1000;
/// A pattern may hold so many times what is needed before its old places are dropped [1].
const PATTERN_EXCESS: f64 = 1.25;

/// (K + μ A) d = r over the free vertices.
pub(super) struct System<'a> {
    model: &'a Model,
    rim: Vec<[u32; 2]>,
    /// Free vertices, in ascending order.
    pub(super) free: Vec<u32>,
    free_index: Vec<u32>,
    /// A: the area around each free vertex [mm²], shape `[free]`.
    pub(super) weight_mm2: Vec<f64>,
    /// K, or what of it is symmetric.
    pub(super) matrix: BlockMatrix,
    symbolic: Symbolic,
    is_analysed: bool,
    factor: Factor,
    /// μ of the present factor [MPa/mm].
    pub(super) damping: f64,
    elastic: Elastic,
    /// Where its blocks go.
    elastic_slots: Vec<u32>,
    shift: Vec<f64>,
    krylov: Krylov,
    direction: Vec<Vec3>,
    turned: Vec<Vec3>,
}

impl<'a> System<'a> {
    pub(super) fn new(model: &'a Model, surface: &Surface) -> Self {
        let (free, free_index) = free_vertices(model);
        let total_area = surface.vertex_area_mm2.iter().sum::<f64>();
        let mean_area = total_area / model.leaflet_vertex_count.max(1) as f64;
        let area = |&vertex: &u32| match surface.vertex_area_mm2[vertex as usize] {
            // Chord nodes have no area of their own.
            0.0 => mean_area,
            area => area,
        };
        let mut system = Self {
            model,
            rim: pressure::rim(&model.faces),
            weight_mm2: free.iter().map(area).collect(),
            matrix: BlockMatrix::default(),
            symbolic: Symbolic::default(),
            is_analysed: false,
            factor: Factor::default(),
            damping: 0.0,
            elastic: Elastic::new(model, &free_index, free.len()),
            elastic_slots: Vec::new(),
            shift: vec![0.0; free.len()],
            krylov: Krylov::default(),
            direction: vec![Vec3::zeros(); model.rest_mm.len()],
            turned: vec![Vec3::zeros(); model.rest_mm.len()],
            free,
            free_index,
        };
        system.make_pattern(&[], &[]);
        system
    }

    /// Fills the matrix with the tangent, and takes from the right-hand side what the motion of prescribed vertices
    /// brings; grows the pattern where contact needs new places.
    pub(super) fn assemble(
        &mut self,
        near: &[Pair],
        touches: &[Touch],
        positions: &[Vec3],
        curvature: Curvature,
        mut moved: Option<Moved>,
    ) {
        let (model, free_index) = (self.model, &self.free_index);
        self.krylov.forget();
        self.elastic
            .fill(model, free_index, positions, curvature, &mut moved);
        if !self.add_up(touches, positions, curvature, &mut moved) {
            self.make_pattern(near, positions);
            // The right-hand side has had its share.
            self.add_up(touches, positions, curvature, &mut None);
        }
        self.analyse();
    }

    /// Adds contact to the elastic part; false if the pattern lacks a place for it.
    fn add_up(
        &mut self,
        touches: &[Touch],
        positions: &[Vec3],
        curvature: Curvature,
        moved: &mut Option<Moved>,
    ) -> bool {
        self.matrix.clear();
        for (block, &slot) in self.elastic.matrix.blocks.iter().zip(&self.elastic_slots) {
            self.matrix.blocks[slot as usize] = *block;
        }
        let mut sink = Search {
            free_index: &self.free_index,
            matrix: &mut self.matrix,
            moved,
            lacks_place: false,
        };
        load::add_contact_tangent(self.model, touches, positions, curvature, &mut sink);
        !sink.lacks_place
    }

    /// A third of the blocks that contact has room for are zero, closest points being mostly on edges and vertices. In a
    /// large matrix they are not factorised, for as long as they stay so.
    fn analyse(&mut self) {
        let prunes = self.matrix.size() >= PRUNED_FROM;
        if prunes && !(self.is_analysed && self.symbolic.covers(&self.matrix)) {
            self.symbolic = Symbolic::of_nonzero(&self.matrix);
        } else if !self.is_analysed {
            self.symbolic = Symbolic::new(&self.matrix);
        }
        self.is_analysed = true;
    }

    /// Makes a pattern for the pairs that touch or nearly do. That of the last pattern is kept while it is little more
    /// than what is needed now: contact goes back and forth.
    fn make_pattern(&mut self, near: &[Pair], positions: &[Vec3]) {
        let mut places: Vec<[u32; 2]> = self.elastic.matrix.places().collect();
        for pair in near
            .iter()
            .filter(|pair| is_nearer(pair, positions, PATTERN_MARGIN))
        {
            let index = pair.vertices.map(|vertex| self.free_index[vertex as usize]);
            places.extend(couplings(pair.kind, index).into_iter().flatten());
        }
        let mut matrix = BlockMatrix::without_blocks(self.free.len(), &places);
        if !self.matrix.rows.is_empty() {
            let limit = PATTERN_EXCESS * matrix.rows.len() as f64;
            matrix.unite(&self.matrix, limit as usize);
        }
        // Hundreds of megabytes at 100,000 faces, which the system would have to clear again and again.
        matrix.make_blocks(std::mem::take(&mut self.matrix.blocks));
        self.matrix = matrix;
        self.is_analysed = false;
        self.elastic_slots = self.elastic.matrix.slots_in(&self.matrix);
    }

    /// Size of what the tangent answers to a motion of each free vertex alone [N/mm], shape `[free]`.
    pub(super) fn own_stiffness(&self) -> impl Iterator<Item = f64> {
        let block = |free: usize| self.matrix.slot(free as u32, free as u32);
        let stiffness = move |free| block(free).map_or(0.0, |slot| self.matrix.blocks[slot].norm());
        (0..self.free.len()).map(stiffness)
    }

    /// Factorises with a damping; false unless the matrix is positive definite.
    pub(super) fn factorise(&mut self, damping: f64) -> bool {
        self.damping = damping;
        self.krylov.forget();
        for (shift, weight) in self.shift.iter_mut().zip(&self.weight_mm2) {
            *shift = damping * weight;
        }
        self.symbolic
            .factor_into(&self.matrix, &self.shift, &mut self.factor)
            .is_ok()
    }

    /// Solves with the factorised matrix, in place.
    pub(super) fn solve(&self, right: &mut [Vec3]) {
        self.symbolic.solve_in_place(&self.factor, right);
    }

    /// Solves with the true tangent and a damping, in place: the symmetric tangent, of which the factor is near, plus what
    /// pressure on the free margin adds. What one solution has found serves the next: between two assemblies or factorisations all
    /// are for the same positions and damping.
    pub(super) fn solve_unsymmetric(
        &mut self,
        positions: &[Vec3],
        damping: f64,
        right: &mut [Vec3],
        tolerance: f64,
    ) -> Effort {
        let Self {
            model,
            rim,
            free,
            weight_mm2,
            matrix,
            symbolic,
            factor,
            krylov,
            direction,
            turned,
            ..
        } = self;
        let mut tangent = TrueTangent {
            rim,
            pressure_mpa: model.pressure_mpa,
            free,
            weight_mm2,
            matrix,
            direction,
            turned,
        };
        let multiply = |vector: &[Vec3], product: &mut [Vec3]| {
            tangent.multiply_into(positions, damping, vector, product)
        };
        let precondition = |vector: &mut [Vec3]| symbolic.solve_in_place(factor, vector);
        krylov.solve(multiply, precondition, right, tolerance)
    }

    /// The true tangent times a vector over the free vertices.
    pub(super) fn multiply_unsymmetric(&mut self, positions: &[Vec3], vector: &[Vec3], product: &mut [Vec3]) {
        let mut tangent = TrueTangent {
            rim: &self.rim,
            pressure_mpa: self.model.pressure_mpa,
            free: &self.free,
            weight_mm2: &self.weight_mm2,
            matrix: &self.matrix,
            direction: &mut self.direction,
            turned: &mut self.turned,
        };
        tangent.multiply_into(positions, 0.0, vector, product);
    }

    /// Curvature of the symmetric tangent K along a direction x over the free vertices, xᵀ K x [N·mm]; leaves K x in `product`.
    pub(super) fn curvature(&self, direction: &[Vec3], product: &mut [Vec3]) -> f64 {
        self.matrix.multiply_into(direction, product);
        direction.iter().zip(product).map(|(x, kx)| x.dot(kx)).sum()
    }
}

/// The symmetric tangent and what pressure on the free margin adds.
struct TrueTangent<'a> {
    rim: &'a [[u32; 2]],
    pressure_mpa: f64,
    free: &'a [u32],
    weight_mm2: &'a [f64],
    matrix: &'a BlockMatrix,
    /// Room for a vector over all vertices, zero at prescribed ones.
    direction: &'a mut [Vec3],
    /// Room for another.
    turned: &'a mut [Vec3],
}

impl TrueTangent<'_> {
    /// (K + μ A) times a vector over the free vertices.
    fn multiply_into(&mut self, positions: &[Vec3], damping: f64, vector: &[Vec3], product: &mut [Vec3]) {
        self.matrix.multiply_into(vector, product);
        for ((product, value), weight) in product.iter_mut().zip(vector).zip(self.weight_mm2) {
            *product += value * (damping * weight);
        }
        for (&vertex, value) in self.free.iter().zip(vector) {
            self.direction[vertex as usize] = *value;
        }
        for side in self.rim.iter().flatten() {
            self.turned[*side as usize] = Vec3::zeros();
        }
        pressure::add_antisymmetric_product(
            self.rim,
            self.pressure_mpa,
            positions,
            self.direction,
            self.turned,
        );
        for (product, &vertex) in product.iter_mut().zip(self.free) {
            *product += self.turned[vertex as usize];
        }
    }
}

/// Finds the place of each block.
struct Search<'a, 'b> {
    free_index: &'a [u32],
    matrix: &'a mut BlockMatrix,
    moved: &'a mut Option<Moved<'b>>,
    lacks_place: bool,
}

impl BlockSink for Search<'_, '_> {
    #[inline]
    fn add(&mut self, row: u32, column: u32, block: &Mat3) {
        let index = [self.free_index[row as usize], self.free_index[column as usize]];
        if index[0] != PRESCRIBED && index[1] != PRESCRIBED {
            match self.matrix.slot(index[0], index[1]) {
                Some(slot) => self.matrix.add_at(slot, index[0] < index[1], block),
                None => self.lacks_place = true,
            }
        } else if let Some(moved) = self.moved {
            moved.take([row, column], index, block);
        }
    }
}

fn is_nearer(pair: &Pair, positions: &[Vec3], margin: f64) -> bool {
    let limit = margin * pair.activation_mm;
    pair.nearest(positions).separation_mm.norm_squared() < limit * limit
}

/// The off-diagonal places that a pair couples, prescribed vertices left out. Those of its edges are there already.
fn couplings(kind: PairKind, index: [u32; 4]) -> [Option<[u32; 2]>; 4] {
    let free = |k: usize, l: usize| {
        let place = [index[k], index[l]];
        (!place.contains(&PRESCRIBED)).then_some(place)
    };
    match kind {
        PairKind::PointTriangle => [free(0, 1), free(0, 2), free(0, 3), None],
        PairKind::EdgeEdge => [free(0, 2), free(0, 3), free(1, 2), free(1, 3)],
    }
}

fn free_vertices(model: &Model) -> (Vec<u32>, Vec<u32>) {
    let mut free_index = vec![0; model.rest_mm.len()];
    for prescribed in &model.prescribed {
        free_index[prescribed.vertex as usize] = PRESCRIBED;
    }
    let mut free = Vec::new();
    for (vertex, index) in free_index.iter_mut().enumerate() {
        if *index != PRESCRIBED {
            *index = free.len() as u32;
            free.push(vertex as u32);
        }
    }
    (free, free_index)
}

//! The linear system of one Newton step: the tangent over the free vertices, factorised and solved.

use super::block_matrix::BlockMatrix;
use super::cholesky::{Factor, Symbolic};
use super::krylov;
use super::load::{self, FreeSink, PRESCRIBED};
use crate::Vec3;
use crate::contact::pairs::Pair;
use crate::contact::surface::Surface;
use crate::energy::{Curvature, pressure};
use crate::model::Model;

/// Shifts that make the tangent definite are sought in steps of this factor [1].
const SHIFT_RISE: f64 = 2.0;

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
    /// μ [MPa/mm].
    pub(super) damping: f64,
}

impl<'a> System<'a> {
    pub(super) fn new(model: &'a Model, surface: &Surface, damping: f64) -> Self {
        let (free, free_index) = free_vertices(model);
        let total_area = surface.vertex_area_mm2.iter().sum::<f64>();
        let mean_area = total_area / model.leaflet_vertex_count.max(1) as f64;
        let weight_mm2 = free
            .iter()
            .map(|&vertex| match surface.vertex_area_mm2[vertex as usize] {
                // Chord nodes have no area of their own.
                0.0 => mean_area,
                area => area,
            })
            .collect();
        Self {
            model,
            rim: pressure::rim(&model.faces),
            free,
            free_index,
            weight_mm2,
            matrix: BlockMatrix::default(),
            symbolic: Symbolic::default(),
            damping,
        }
    }

    /// Fills the matrix and returns the right-hand side; grows the pattern where contact needs new places.
    pub(super) fn assemble(
        &mut self,
        near: &[Pair],
        positions: &[Vec3],
        gradient: &[Vec3],
        motion: &[Vec3],
        curvature: Curvature,
    ) -> Vec<Vec3> {
        loop {
            let mut right: Vec<Vec3> = self
                .free
                .iter()
                .map(|&vertex| -gradient[vertex as usize])
                .collect();
            let mut complete = self.matrix.column_starts.len() > 1 || self.free.is_empty();
            if complete {
                self.matrix.clear();
                let matrix = &mut self.matrix;
                let mut sink = FreeSink {
                    free_index: &self.free_index,
                    motion_mm: motion,
                    right_n: &mut right,
                    matrix: |row, column, block: &crate::Mat3| complete &= matrix.add(row, column, block),
                };
                load::add_tangent(self.model, near, positions, curvature, &mut sink);
            }
            if complete {
                return right;
            }
            self.grow_pattern(near, positions);
        }
    }

    fn grow_pattern(&mut self, near: &[Pair], positions: &[Vec3]) {
        let mut places = load::tangent_places(self.model);
        for pair in near {
            // A little beyond the activation distance, so that the pattern lasts for some steps.
            if pair.nearest(positions).separation_mm.norm() < 1.2 * pair.activation_mm {
                let v = pair.vertices;
                for i in 0..4 {
                    places.extend((i + 1..4).map(|j| [v[i], v[j]]));
                }
            }
        }
        let free = |place: [u32; 2]| {
            let [i, j] = place.map(|vertex| self.free_index[vertex as usize]);
            (i != PRESCRIBED && j != PRESCRIBED).then_some([i, j])
        };
        let places = places.into_iter().filter_map(free).collect();
        self.matrix = BlockMatrix::with_pattern(self.free.len(), places);
        self.symbolic = Symbolic::new(&self.matrix);
    }

    /// Factorises the symmetric tangent with the present damping; nothing unless it is positive definite.
    pub(super) fn factorise(&self) -> Option<Factor> {
        let shift: Vec<f64> = self
            .weight_mm2
            .iter()
            .map(|weight| self.damping * weight)
            .collect();
        self.symbolic.factor(&self.matrix, &shift).ok()
    }

    /// The exact tangent, factorised with the least damping that makes its symmetric part positive definite; that
    /// damping stays set. Slack chord nodes have no stiffness at all: the least damping, far below any tissue's,
    /// keeps them from counting.
    pub(super) fn factorise_shifted(
        &mut self,
        near: &[Pair],
        positions: &[Vec3],
        least: f64,
    ) -> Option<Factor> {
        // Only the matrix is wanted: neither force nor motion.
        let none = vec![Vec3::zeros(); positions.len()];
        self.assemble(near, positions, &none, &none, Curvature::Exact);
        self.damping = least;
        (0..60).find_map(|_| {
            let factor = self.factorise();
            if factor.is_none() {
                self.damping *= SHIFT_RISE;
            }
            factor
        })
    }

    /// Solves with the factorised matrix.
    pub(super) fn solve(&self, factor: &Factor, right: &[Vec3]) -> Vec<Vec3> {
        self.symbolic.solve(factor, right)
    }

    /// Solves with the true tangent: the factorised symmetric one plus what pressure on the free margin adds.
    pub(super) fn solve_unsymmetric(
        &self,
        factor: &Factor,
        positions: &[Vec3],
        right: &[Vec3],
        tolerance: f64,
    ) -> Vec<Vec3> {
        let shift = |index: usize| self.damping * self.weight_mm2[index];
        let multiply = |vector: &[Vec3]| {
            let mut product = self.matrix.multiply(vector);
            for (index, (product, value)) in product.iter_mut().zip(vector).enumerate() {
                *product += value * shift(index);
            }
            let direction = self.scatter(vector, &vec![Vec3::zeros(); positions.len()]);
            let mut turned = vec![Vec3::zeros(); positions.len()];
            let pressure = self.model.pressure_mpa;
            pressure::add_antisymmetric_product(&self.rim, pressure, positions, &direction, &mut turned);
            for (product, &vertex) in product.iter_mut().zip(&self.free) {
                *product += turned[vertex as usize];
            }
            product
        };
        krylov::solve(
            multiply,
            |vector| self.symbolic.solve(factor, vector),
            right,
            tolerance,
        )
    }

    /// A vector over all vertices: the solution at free ones, the motion at prescribed ones.
    pub(super) fn scatter(&self, solution: &[Vec3], motion: &[Vec3]) -> Vec<Vec3> {
        let mut step = motion.to_vec();
        for (&vertex, value) in self.free.iter().zip(solution) {
            step[vertex as usize] = *value;
        }
        step
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

//! Chordae: elastic rods that carry tension only (paper 003, section 2.2): T = A σ(l / L − 1), 0 when slack, with the
//! stress σ of one of the laws of [`super::chord_law`].
//!
//! A rod runs between two chord points. A papillary tip or a branching is one vertex; an insertion is the weighted mean
//! of the leaflet vertices around it, which share its pull by the same weights.

use super::chord_law::{ChordResponse, response};
use super::{BlockSink, line_block};
use crate::scene::ChordLaw;
use crate::{Mat3, Vec3};

/// A point as the weighted mean of vertices: vertex and weight [1], the weights adding up to one.
pub type WeightedVertices = Vec<(u32, f64)>;

/// Chord segments.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chords {
    /// Where segments begin and end, shape `[chord point]`.
    pub points: Vec<WeightedVertices>,
    /// The two chord points of each segment, shape `[segment]`.
    pub ends: Vec<[u32; 2]>,
    /// Unloaded length L [mm], shape `[segment]`.
    pub rest_length_mm: Vec<f64>,
    /// Unloaded cross-section A [mm²], shape `[segment]`.
    pub area_mm2: Vec<f64>,
    /// Which group each segment belongs to, shape `[segment]`.
    pub group: Vec<u32>,
    /// The law of each group, shape `[group]`.
    pub laws: Vec<ChordLaw>,
}

impl Chords {
    /// Tension of each segment [N], shape `[segment]`.
    pub fn tensions_n(&self, positions_mm: &[Vec3]) -> Vec<f64> {
        (0..self.ends.len())
            .map(|index| {
                let length = self.offset(index, positions_mm).norm();
                self.area_mm2[index] * self.response(index, length).stress_mpa
            })
            .collect()
    }

    /// The same chordae with the unloaded lengths of each group multiplied by its factor [1], shape `[group]`.
    pub fn scaled(&self, factor: &[f64]) -> Self {
        let mut scaled = self.clone();
        for (length_mm, &group) in scaled.rest_length_mm.iter_mut().zip(&self.group) {
            *length_mm *= factor[group as usize];
        }
        scaled
    }

    /// Where a chord point is [mm].
    pub fn point_mm(&self, point: u32, positions_mm: &[Vec3]) -> Vec3 {
        let vertices = &self.points[point as usize];
        vertices
            .iter()
            .map(|&(vertex, weight)| positions_mm[vertex as usize] * weight)
            .sum()
    }

    fn response(&self, index: usize, length_mm: f64) -> ChordResponse {
        let law = &self.laws[self.group[index] as usize];
        response(law, length_mm / self.rest_length_mm[index] - 1.0)
    }

    fn offset(&self, index: usize, positions_mm: &[Vec3]) -> Vec3 {
        let [a, b] = self.ends[index];
        self.point_mm(b, positions_mm) - self.point_mm(a, positions_mm)
    }

    /// How the vector between a segment's ends depends on the vertices: minus the weights at its first end, plus those
    /// at its second.
    fn shares(&self, index: usize) -> impl Iterator<Item = (u32, f64)> + '_ {
        let [a, b] = self.ends[index].map(|point| &self.points[point as usize]);
        let first = a.iter().map(|&(vertex, weight)| (vertex, -weight));
        first.chain(b.iter().copied())
    }
}

/// Elastic energy of all chordae [N·mm]: the law's, times the unloaded volume A·L.
pub fn energy(chords: &Chords, positions_mm: &[Vec3]) -> f64 {
    (0..chords.ends.len())
        .map(|index| {
            let response = chords.response(index, chords.offset(index, positions_mm).norm());
            chords.area_mm2[index] * chords.rest_length_mm[index] * response.energy_mpa
        })
        .sum()
}

/// Adds the gradient of the energy [N], shape `[vertex]`.
pub fn add_gradient(chords: &Chords, positions_mm: &[Vec3], gradient_n: &mut [Vec3]) {
    for index in 0..chords.ends.len() {
        let offset = chords.offset(index, positions_mm);
        let length = offset.norm();
        let tension = chords.area_mm2[index] * chords.response(index, length).stress_mpa;
        if tension == 0.0 {
            continue;
        }
        let pull = offset * (tension / length);
        for (vertex, share) in chords.shares(index) {
            gradient_n[vertex as usize] += pull * share;
        }
    }
}

/// Adds the Hessian of the energy; that of a slack segment is zero.
pub fn add_hessian(chords: &Chords, positions_mm: &[Vec3], sink: &mut impl BlockSink) {
    for index in 0..chords.ends.len() {
        let offset = chords.offset(index, positions_mm);
        let response = chords.response(index, offset.norm());
        let (area, rest_length) = (chords.area_mm2[index], chords.rest_length_mm[index]);
        let block = line_block(
            offset,
            area * response.stress_mpa,
            area * response.modulus_mpa / rest_length,
        );
        add_shared(chords, index, &block, sink);
    }
}

/// Hands out the block of one segment to all vertices that share its ends.
fn add_shared(chords: &Chords, index: usize, block: &Mat3, sink: &mut impl BlockSink) {
    for (i, (a, of_a)) in chords.shares(index).enumerate() {
        for (j, (b, of_b)) in chords.shares(index).enumerate().skip(i) {
            // A vertex that shares both ends meets itself twice on the diagonal, which is handed out once.
            let twice = if a == b && i != j { 2.0 } else { 1.0 };
            sink.add(a, b, &(block * (twice * of_a * of_b)));
        }
    }
}

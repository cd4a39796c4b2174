//! The solver: `gradient` (all forces once), `factor` (the tangent factorised once) and `closure/cold` (from the
//! open valve to the certified equilibrium).
//!
//! `gradient` and `factor` are what an iteration consists of besides contact; `closure/cold` is what the user
//! waits for, the certificate included. At the open valve nothing touches, at the closed one contact is a part of
//! the price: both are timed.

use coapt::energy::Curvature;
use coapt::relax::block_matrix::BlockMatrix;
use coapt::relax::cholesky::Symbolic;
use coapt::relax::load::{self, FreeSink, PRESCRIBED};
use coapt::relax::relax;
use coapt::state::State;
use coapt::{Mat3, Vec3};
use coapt_benches::{
    SIZES, Scenery, assert_certified, closed_scenery, closed_sizes, healthy_model, open_scenery,
};
use criterion::{BenchmarkId, Criterion, SamplingMode, criterion_group, criterion_main};
use std::cell::LazyCell;

fn bench_gradient(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("gradient/open");
    for size in SIZES {
        let open = LazyCell::new(|| open_scenery(size));
        group.bench_function(BenchmarkId::from_parameter(size), |bencher| {
            bencher.iter(|| gradient(&open));
        });
    }
    group.finish();
    let mut group = criterion.benchmark_group("gradient/closed");
    for size in closed_sizes() {
        let closed = LazyCell::new(|| closed_scenery(size));
        group.bench_function(BenchmarkId::from_parameter(size), |bencher| {
            bencher.iter(|| gradient(&closed));
        });
    }
}

fn gradient(scenery: &Scenery) -> Vec<Vec3> {
    load::gradient(&scenery.model, &scenery.pairs, &scenery.state.positions_mm)
}

/// The numbers of the factorisation. The pattern is analysed outside: it lasts for many iterations.
fn bench_factor(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("factor");
    for size in closed_sizes() {
        let system = LazyCell::new(|| {
            let matrix = tangent(&closed_scenery(size));
            (Symbolic::new(&matrix), matrix)
        });
        group.bench_function(BenchmarkId::from_parameter(size), |bencher| {
            let (symbolic, matrix) = &*system;
            // Slack chord nodes have no stiffness; this little, far below any tissue's, lets them pass [N/mm].
            let shift = vec![1e-7; matrix.size()];
            bencher.iter(|| symbolic.factor(matrix, &shift).expect("a stable equilibrium"));
        });
    }
}

/// The exact tangent of the free vertices, contact included.
fn tangent(scenery: &Scenery) -> BlockMatrix {
    let mut free_index = vec![0; scenery.model.rest_mm.len()];
    for prescribed in &scenery.model.prescribed {
        free_index[prescribed.vertex as usize] = PRESCRIBED;
    }
    let free = free_index.iter_mut().filter(|index| **index != PRESCRIBED);
    let size = free.zip(0..).map(|(index, number)| *index = number).count();
    let mut blocks: Vec<(u32, u32, Mat3)> = Vec::new();
    let mut sink = FreeSink {
        free_index: &free_index,
        motion_mm: &vec![Vec3::zeros(); free_index.len()],
        right_n: &mut vec![Vec3::zeros(); size],
        matrix: |row, column, block: &Mat3| blocks.push((row, column, *block)),
    };
    let positions_mm = &scenery.state.positions_mm;
    load::add_tangent(
        &scenery.model,
        &scenery.pairs,
        positions_mm,
        Curvature::Exact,
        &mut sink,
    );
    let places = blocks.iter().map(|&(row, column, _)| [row, column]).collect();
    let mut matrix = BlockMatrix::with_pattern(size, places);
    for (row, column, block) in &blocks {
        assert!(
            matrix.add(*row, *column, block),
            "the pattern was made of these blocks"
        );
    }
    matrix
}

fn bench_closure(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("closure/cold");
    // From tenths of a second to minutes each: few samples, with the same number of closures in each.
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    for size in closed_sizes() {
        let model = LazyCell::new(|| healthy_model(size));
        group.bench_function(BenchmarkId::from_parameter(size), |bencher| {
            let start = State::open(&model);
            bencher.iter(|| {
                let equilibrium = relax(&model, &start);
                assert_certified(&equilibrium);
                equilibrium
            });
        });
    }
}

criterion_group!(benches, bench_gradient, bench_factor, bench_closure);
criterion_main!(benches);

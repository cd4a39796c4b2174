//! The solver: `gradient` (all forces once), `factor` (the tangent factorised once), `closure/cold` (from the open
//! valve to the certified equilibrium), `closure/warm` (from the closed valve, after its annulus was drawn in as by a
//! ring) and `closure/explicit_baseline` (the same by explicit time steps, without certificate).
//!
//! `gradient` and `factor` are what an iteration consists of besides contact; closures are what the user waits for, the
//! certificate included. At the open valve nothing touches, at the closed one contact is a part of the price: both are
//! timed.

use coapt::contact::touch::touches;
use coapt::energy::Curvature;
use coapt::model::Model;
use coapt::relax::block_matrix::BlockMatrix;
use coapt::relax::cholesky::Symbolic;
use coapt::relax::load;
use coapt::relax::relax;
use coapt::state::State;
use coapt::{Mat3, Vec3};
use coapt_benches::explicit::{self, assert_closed, close_explicitly};
use coapt_benches::{
    PLANNING_SIZE, SIZES, Scenery, assert_certified, close, closed_scenery, closed_sizes, healthy_model,
    label, narrowed, open_scenery,
};
use criterion::{BenchmarkId, Criterion, SamplingMode, criterion_group, criterion_main};
use std::cell::LazyCell;

fn bench_gradient(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("gradient/open");
    for size in SIZES {
        let open = LazyCell::new(|| open_scenery(size));
        group.bench_function(BenchmarkId::from_parameter(label(size)), |bencher| {
            bencher.iter(|| gradient(&open));
        });
    }
    group.finish();
    let mut group = criterion.benchmark_group("gradient/closed");
    for size in closed_sizes() {
        let closed = LazyCell::new(|| closed_scenery(size));
        group.bench_function(BenchmarkId::from_parameter(label(size)), |bencher| {
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
        group.bench_function(BenchmarkId::from_parameter(label(size)), |bencher| {
            let (symbolic, matrix) = &*system;
            // Slack chord nodes have no stiffness; this little, far below any tissue's, lets them pass [N/mm].
            let shift = vec![1e-7; matrix.size()];
            bencher.iter(|| symbolic.factor(matrix, &shift).expect("a stable equilibrium"));
        });
    }
}

/// The exact tangent of the free vertices, contact included.
fn tangent(scenery: &Scenery) -> BlockMatrix {
    let Scenery {
        model, pairs, state, ..
    } = scenery;
    let mut free: Vec<Option<u32>> = vec![Some(0); model.rest_mm.len()];
    for prescribed in &model.prescribed {
        free[prescribed.vertex as usize] = None;
    }
    let size = (0..)
        .zip(free.iter_mut().flatten())
        .map(|(number, index)| *index = number)
        .count();
    let mut blocks: Vec<(u32, u32, Mat3)> = Vec::new();
    let mut sink = |row: u32, column: u32, block: &Mat3| {
        if let (Some(row), Some(column)) = (free[row as usize], free[column as usize]) {
            blocks.push((row, column, *block));
        }
    };
    load::add_elastic_tangent(model, &state.positions_mm, Curvature::Exact, &mut sink);
    let touches = touches(pairs, &state.positions_mm);
    load::add_contact_tangent(model, &touches, &state.positions_mm, Curvature::Exact, &mut sink);
    let places: Vec<[u32; 2]> = blocks.iter().map(|&(row, column, _)| [row, column]).collect();
    let mut matrix = BlockMatrix::with_pattern(size, &places);
    for (row, column, block) in &blocks {
        assert!(
            matrix.add(*row, *column, block),
            "the pattern was made of these blocks"
        );
    }
    matrix
}

fn bench_cold(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("closure/cold");
    // From tenths of a second to minutes each: few samples, with the same number of closures in each.
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    for size in closed_sizes() {
        let model = LazyCell::new(|| certifiable(healthy_model(size), State::open));
        group.bench_function(BenchmarkId::from_parameter(label(size)), |bencher| {
            let start = State::open(&model);
            bencher.iter(|| relax(&model, &start));
        });
    }
}

fn bench_warm(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("closure/warm");
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    let unmodified = LazyCell::new(|| {
        let model = healthy_model(PLANNING_SIZE);
        let closed = close(&model).state;
        (model, closed)
    });
    for (name, percent) in [("ring_0p5pct", 0.5), ("ring_2pct", 2.0), ("ring_5pct", 5.0)] {
        let ringed =
            LazyCell::new(|| certifiable(narrowed(&unmodified.0, percent), |_| unmodified.1.clone()));
        group.bench_function(name, |bencher| {
            let (model, start) = (&*ringed, &unmodified.1);
            bencher.iter(|| relax(model, start));
        });
    }
}

/// A valve that closes to a certified state from a start, as it will when it is timed: equal starts, equal bytes.
fn certifiable(model: Model, start: impl Fn(&Model) -> State) -> Model {
    assert_certified(&relax(&model, &start(&model)));
    model
}

fn bench_explicit(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("closure/explicit_baseline");
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    group.bench_function(label(PLANNING_SIZE), |bencher| {
        let model = healthy_model(PLANNING_SIZE);
        let start = State::open(&model);
        let close = || close_explicitly(&model, &start, explicit::TOLERANCE, explicit::STEP_LIMIT);
        assert_closed(&close());
        bencher.iter(close);
    });
}

criterion_group!(
    benches,
    bench_gradient,
    bench_factor,
    bench_cold,
    bench_warm,
    bench_explicit
);
criterion_main!(benches);

//! Measuring the closed valve: everything that is reported of one state.
//!
//! It is paid once per closure, and at every frame of a view that shows figures while the valve is moved.

use coapt::measure::measure;
use coapt_benches::{close, closed_sizes, healthy_model};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use std::cell::LazyCell;

fn bench_measure(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("measure");
    group.sample_size(20);
    for size in closed_sizes() {
        let closed = LazyCell::new(|| {
            let model = healthy_model(size);
            let equilibrium = close(&model);
            (model, equilibrium)
        });
        group.bench_function(BenchmarkId::from_parameter(size), |bencher| {
            let (model, equilibrium) = &*closed;
            let positions_mm = &equilibrium.state.positions_mm;
            bencher.iter(|| measure(model, positions_mm, &equilibrium.reactions_n));
        });
    }
}

criterion_group!(benches, bench_measure);
criterion_main!(benches);

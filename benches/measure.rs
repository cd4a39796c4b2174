//! Measuring the closed valve: `measure` (everything that is reported of one state but the narrowest passage), `passage` (that) and
//! `visible` (how far two valves lie apart where they are seen).
//!
//! `measure` is paid once per closure, and at every frame of a view that shows figures while the valve is moved. `visible` needs
//! no closed valve: the open one against a valve of other size costs as much.

use coapt::measure::{measure, passage_mm2, visible_distance};
use coapt::mesh::parametric::Preset;
use coapt_benches::{PLANNING_SIZE, SIZES, close, closed_sizes, healthy_model, label, preset_model};
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
        group.bench_function(BenchmarkId::from_parameter(label(size)), |bencher| {
            let (model, equilibrium) = &*closed;
            let positions_mm = &equilibrium.state.positions_mm;
            bencher.iter(|| measure(model, positions_mm, &equilibrium.reactions_n));
        });
    }
}

fn bench_passage(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("passage");
    group.sample_size(20);
    for preset in [Preset::Healthy, Preset::Flail] {
        let closed = LazyCell::new(|| {
            let model = preset_model(preset, PLANNING_SIZE);
            let equilibrium = close(&model);
            (model, equilibrium)
        });
        group.bench_function(preset.name(), |bencher| {
            let (model, equilibrium) = &*closed;
            bencher.iter(|| passage_mm2(model, &equilibrium.state.positions_mm));
        });
    }
}

fn bench_visible(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("visible");
    group.sample_size(10);
    for size in SIZES {
        let open = LazyCell::new(|| (healthy_model(size), healthy_model(PLANNING_SIZE)));
        group.bench_function(BenchmarkId::from_parameter(label(size)), |bencher| {
            let (one, other) = &*open;
            bencher.iter(|| visible_distance(one, &one.rest_mm, other, &other.rest_mm));
        });
    }
}

criterion_group!(benches, bench_measure, bench_passage, bench_visible);
criterion_main!(benches);

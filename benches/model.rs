//! Making a valve: `generate` (parameters to scene) and `build` (scene to model).
//!
//! Both are paid once per case, `generate` also at every turn of a slider that shapes the valve. Neither should be
//! felt beside a closure.

use coapt::mesh::parametric::Preset;
use coapt::mesh::parametric::generate;
use coapt::model::Model;
use coapt_benches::{SIZES, label, preset_parameters, preset_scene};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use std::cell::LazyCell;

fn bench_generate(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("generate");
    for size in SIZES {
        let parameters = preset_parameters(Preset::Healthy, size);
        group.bench_function(BenchmarkId::from_parameter(label(size)), |bencher| {
            bencher.iter(|| generate(&parameters).expect("the healthy valve can be generated"));
        });
    }
}

fn bench_build(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("build");
    for size in SIZES {
        let scene = LazyCell::new(|| preset_scene(Preset::Healthy, size));
        group.bench_function(BenchmarkId::from_parameter(label(size)), |bencher| {
            bencher.iter(|| Model::build(&scene).expect("the healthy valve can be built"));
        });
    }
}

criterion_group!(benches, bench_generate, bench_build);
criterion_main!(benches);

//! Finding what may touch: `contact/broad` (sweep and prune alone) and `contact/pairs` (broad and narrow phase
//! and the list of near pairs), at the closed valve, where most is near.
//!
//! The list is made anew every few iterations, so the sweep meets boxes that are almost sorted: here they are
//! sorted already, the best case. What a large motion between two calls would add is the insertion sort alone.

use coapt::contact::broad::SweepAndPrune;
use coapt::contact::pairs::PairList;
use coapt_benches::{budget_mm, closed_scenery, closed_sizes};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use std::cell::LazyCell;

fn bench_broad(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("contact/broad");
    for size in closed_sizes() {
        let closed = LazyCell::new(|| closed_scenery(size));
        let mut sweep = SweepAndPrune::default();
        group.bench_function(BenchmarkId::from_parameter(size), |bencher| {
            let reach_mm = closed.model.contact.thickness_mm + 2.0 * budget_mm(&closed.model);
            bencher.iter(|| {
                let mut count = 0_usize;
                let positions_mm = &closed.state.positions_mm;
                sweep.overlapping_faces(&closed.model.faces, positions_mm, reach_mm, |_, _| count += 1);
                count
            });
        });
    }
}

fn bench_pairs(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("contact/pairs");
    for size in closed_sizes() {
        let closed = LazyCell::new(|| closed_scenery(size));
        let mut list = PairList::default();
        group.bench_function(BenchmarkId::from_parameter(size), |bencher| {
            let model = &closed.model;
            let thickness_mm = model.contact.thickness_mm;
            let positions_mm = &closed.state.positions_mm;
            bencher.iter(|| {
                let budget_mm = budget_mm(model);
                list.rebuild(
                    &closed.surface,
                    &model.rest_mm,
                    positions_mm,
                    thickness_mm,
                    budget_mm,
                );
            });
        });
    }
}

criterion_group!(benches, bench_broad, bench_pairs);
criterion_main!(benches);

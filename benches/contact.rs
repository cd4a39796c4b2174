//! Finding what may touch: `contact/broad` (sweep and prune of the edges alone), `contact/narrow` (closest points of the
//! pairs that may touch), `contact/pairs` (both on all candidates, and the list of near pairs) and `contact/gather` (what
//! of a list that still holds may touch), at the closed valve, where most is near.

use coapt::Vec3;
use coapt::contact::broad::{Box3, SweepAndPrune};
use coapt::contact::gather::PairList;
use coapt::contact::pairs::Place;
use coapt_benches::{Scenery, closed_scenery, closed_sizes, label, place};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use std::cell::LazyCell;

fn bench_broad(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("contact/broad");
    for size in closed_sizes() {
        let closed = LazyCell::new(|| closed_scenery(size));
        let mut sweep = SweepAndPrune::default();
        group.bench_function(BenchmarkId::from_parameter(label(size)), |bencher| {
            // With what the solver's lists allow for when steps have become short.
            let margin_mm = 0.7 * closed.model.contact.thickness_mm;
            let at = |vertex: u32| closed.state.positions_mm[vertex as usize];
            let edges = closed.surface.edges.iter();
            let boxes: Vec<Box3> = edges.map(|edge| Box3::around(edge.map(at), margin_mm)).collect();
            bencher.iter(|| sweep.among(&boxes, &closed.surface.edge_patches).len());
        });
    }
}

fn bench_narrow(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("contact/narrow");
    for size in closed_sizes() {
        let closed = LazyCell::new(|| closed_scenery(size));
        group.bench_function(BenchmarkId::from_parameter(label(size)), |bencher| {
            let (pairs, positions_mm) = (&closed.pairs, &closed.state.positions_mm);
            bencher.iter(|| {
                let distances = pairs
                    .iter()
                    .map(|pair| pair.nearest(positions_mm).separation_mm.norm());
                distances.fold(f64::INFINITY, f64::min)
            });
        });
    }
}

fn bench_pairs(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("contact/pairs");
    for size in closed_sizes() {
        let closed = LazyCell::new(|| closed_scenery(size));
        group.bench_function(BenchmarkId::from_parameter(label(size)), |bencher| {
            let (place, at_rest) = (place_of(&closed), at_rest(&closed));
            let mut pairs = Vec::new();
            // A list without positions holds for none, and is made anew.
            bencher.iter(|| PairList::default().gather(&place, &at_rest, &mut pairs));
        });
    }
}

fn bench_gather(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("contact/gather");
    for size in closed_sizes() {
        let closed = LazyCell::new(|| closed_scenery(size));
        group.bench_function(BenchmarkId::from_parameter(label(size)), |bencher| {
            let (place, at_rest) = (place_of(&closed), at_rest(&closed));
            let (mut list, mut pairs) = (PairList::default(), Vec::new());
            bencher.iter(|| list.gather(&place, &at_rest, &mut pairs));
        });
    }
}

fn place_of(closed: &Scenery) -> Place<'_> {
    place(&closed.model, &closed.surface, &closed.state.positions_mm)
}

/// No step.
fn at_rest(closed: &Scenery) -> Vec<Vec3> {
    vec![Vec3::zeros(); closed.state.positions_mm.len()]
}

criterion_group!(benches, bench_broad, bench_narrow, bench_pairs, bench_gather);
criterion_main!(benches);

//! What each force costs: `term/springs`, `term/chords`, `term/pressure` and `term/contact`, each with the rest left
//! out, at the closed valve; and the same where there are no chordae, no pressure, no parts near each other. What is
//! absent must cost nothing: a single leaflet patch pays for no more than it has.

use coapt::Vec3;
use coapt::contact::penalty;
use coapt::contact::touch::touches;
use coapt::energy::{bilinear_spring, chord, chord::Chords, pressure};
use coapt_benches::{PLANNING_SIZE, Scenery, closed_scenery};
use criterion::{Criterion, criterion_group, criterion_main};
use std::cell::LazyCell;

fn bench_terms(criterion: &mut Criterion) {
    let closed = LazyCell::new(|| closed_scenery(PLANNING_SIZE));
    bench(criterion, "springs/present", &closed, |s, places, gradient| {
        bilinear_spring::add_gradient(&s.model.springs, places, gradient);
    });
    bench(criterion, "chords/present", &closed, |s, places, gradient| {
        chord::add_gradient(&s.model.chords, places, gradient);
    });
    let none = Chords::default();
    bench(criterion, "chords/absent", &closed, |_, places, gradient| {
        chord::add_gradient(&none, places, gradient);
    });
    bench(criterion, "pressure/present", &closed, |s, places, gradient| {
        pressure::add_gradient(&s.model.faces, s.model.pressure_mpa, places, gradient);
    });
    bench(criterion, "pressure/absent", &closed, |s, places, gradient| {
        pressure::add_gradient(&s.model.faces, 0.0, places, gradient);
    });
    bench(criterion, "contact/present", &closed, |s, places, gradient| {
        let touches = touches(&s.pairs, places);
        penalty::add_gradient(&touches, s.model.contact.stiffness_mpa, places, gradient);
    });
    bench(criterion, "contact/apart", &closed, |s, places, gradient| {
        penalty::add_gradient(&[], s.model.contact.stiffness_mpa, places, gradient);
    });
}

/// Times one term, added to a gradient that is there already.
fn bench(
    criterion: &mut Criterion,
    name: &str,
    closed: &LazyCell<Scenery, impl FnOnce() -> Scenery>,
    add: impl Fn(&Scenery, &[Vec3], &mut [Vec3]),
) {
    let mut group = criterion.benchmark_group("term");
    group.bench_function(name, |bencher| {
        let scenery: &Scenery = closed;
        let places = &scenery.state.positions_mm;
        let mut gradient = vec![Vec3::zeros(); places.len()];
        bencher.iter(|| add(scenery, places, &mut gradient));
    });
}

criterion_group!(benches, bench_terms);
criterion_main!(benches);

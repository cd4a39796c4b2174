//! What each force costs: `term/springs`, `term/chords`, `term/pressure` and `term/contact`, each with the rest left
//! out, at the closed valve; and the same where there are no chordae, no pressure, no parts near each other. What is
//! absent must cost nothing: a single leaflet patch pays for no more than it has.
//!
//! `term/<tissue>/energy`, `/gradient` and `/hessian`: leaflets of each tissue at the same positions, those of the valve of springs
//! when closed, stretched and wrinkled as they come.

use coapt::contact::penalty;
use coapt::contact::touch::touches;
use coapt::energy::membrane::{self, Law, Membranes, Tissue, exponential, may_newman, st_venant_kirchhoff};
use coapt::energy::{bilinear_spring, chord, chord::Chords, pressure};
use coapt::{Mat3, Vec3};
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

fn bench_tissues(criterion: &mut Criterion) {
    let closed = LazyCell::new(|| closed_scenery(PLANNING_SIZE));
    bench(criterion, "springs/energy", &closed, |s, places, gradient| {
        gradient[0].x += bilinear_spring::energy(&s.model.springs, places);
    });
    bench(criterion, "springs/gradient", &closed, |s, places, gradient| {
        bilinear_spring::add_gradient(&s.model.springs, places, gradient);
    });
    bench(criterion, "springs/hessian", &closed, |s, places, gradient| {
        bilinear_spring::add_hessian(&s.model.springs, places, &mut |a: u32, _: u32, block: &Mat3| {
            gradient[a as usize] += block.column(0);
        });
    });
    for (name, law) in laws() {
        for (field, wrinkles) in [("", false), (", tension field", true)] {
            let membranes = LazyCell::new(|| skinned(&closed, Tissue { law, wrinkles }));
            bench(
                criterion,
                &format!("{name}{field}/energy"),
                &closed,
                |_, places, gradient| {
                    gradient[0].x += membrane::energy(&membranes, places);
                },
            );
            bench(
                criterion,
                &format!("{name}{field}/gradient"),
                &closed,
                |_, places, gradient| {
                    membrane::add_gradient(&membranes, places, gradient);
                },
            );
            bench(
                criterion,
                &format!("{name}{field}/hessian"),
                &closed,
                |_, places, gradient| {
                    membrane::add_hessian(&membranes, places, &mut |a: u32, _: u32, block: &Mat3| {
                        gradient[a as usize] += block.column(0);
                    });
                },
            );
        }
    }
}

/// Published constants, or of their order.
fn laws() -> [(&'static str, Law); 4] {
    let exponential = |compressibility_per_mpa: f64| {
        Law::Exponential(exponential::Constants {
            c0_mpa: 0.001,
            c1_mpa: 0.000_124,
            c2: 4.568_202,
            compressibility_per_mpa,
        })
    };
    [
        (
            "St. Venant-Kirchhoff",
            Law::StVenantKirchhoff(st_venant_kirchhoff::Constants {
                modulus_mpa: 0.4,
                poisson_ratio: 0.5,
            }),
        ),
        ("exponential", exponential(0.0)),
        ("exponential, compressible", exponential(20.066_89)),
        ("May-Newman", Law::MayNewman(may_newman::ANTERIOR)),
    ]
}

/// The valve's faces as membranes of one tissue.
fn skinned(scenery: &Scenery, tissue: Tissue) -> Membranes {
    let mut membranes = Membranes {
        tissues: vec![tissue],
        ..Membranes::default()
    };
    for &face in &scenery.model.faces {
        membranes.push(face, 0, 1.0, &scenery.model.rest_mm, Vec3::x());
    }
    membranes
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

criterion_group!(benches, bench_terms, bench_tissues);
criterion_main!(benches);

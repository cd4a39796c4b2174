//! Bars: trusses and chains.

use coapt::Vec3;
use coapt::model::Model;
use coapt::relax::Status;

use super::{begun, uncertified};
use crate::hard::{HardCase, Jitter};
use crate::shapes::add_spring;
use crate::verification::frames::{compressed_chain, hanging_chain, largest_truss_force_n, truss};

pub(super) fn cases() -> Vec<HardCase> {
    let mut cases = Vec::new();
    for part in [0.5, 0.999, 1.0, 1.001, 5.0] {
        cases.push(begun(
            format!("von Mises truss at {part} of its largest force"),
            "a limit point: below it the apex stays up, above it the truss snaps through",
            move |jitter| moved(truss(part * largest_truss_force_n(), true), jitter, 10.0),
        ));
    }
    cases.push(begun(
        "von Mises truss without guides",
        "a balance that does not last: it swings over sideways",
        |jitter| moved(truss(0.5 * largest_truss_force_n(), false), jitter, 10.0),
    ));
    cases.push(begun(
        "compressed chain",
        "no bending stiffness: it buckles at once, and ends with no stiffness at all",
        |jitter| moved(compressed_chain(), jitter, 1.0),
    ));
    cases.push(begun(
        "slack catenary",
        "weights across a taut line meet no stiffness",
        |jitter| moved(hanging_chain(), jitter, 1.0),
    ));
    cases.push(begun(
        "slack catenary of links that carry no compression",
        "slack links have no stiffness whichever way",
        |jitter| moved(threads(hanging_chain()), jitter, 1.0),
    ));
    cases.push(begun(
        "chain of slack threads",
        "no force and no stiffness anywhere: the tangent is zero",
        |jitter| {
            let mut model = threads(compressed_chain());
            model
                .springs
                .rest_length_mm
                .iter_mut()
                .for_each(|length| *length *= 2.0);
            moved(model, jitter, 1.0)
        },
    ));
    cases.push(uncertified(
        begun(
            "weight that nothing holds",
            "a mechanism: a load along a direction without stiffness",
            |jitter| {
                let mut model = truss(0.0, false);
                for stiffness in [
                    &mut model.springs.soft_n_per_mm,
                    &mut model.springs.stiff_n_per_mm,
                    &mut model.springs.compression_n_per_mm,
                ] {
                    stiffness.fill(0.0);
                }
                // Between its supports, so that there is something to count forces in.
                add_spring(&mut model.springs, [1, 2], 20.0, 1.0);
                model.dead_loads_n = vec![(0, -Vec3::z())];
                model.settings.iteration_limit = 100;
                moved(model, jitter, 10.0)
            },
        ),
        &[Status::IterationLimit, Status::Stalled],
        "it falls for ever",
    ));
    cases
}

/// A model begun near rest: free vertices are moved a little.
fn moved(model: Model, jitter: &mut Jitter, edge_mm: f64) -> (Model, Vec<Vec3>) {
    let is_held = |vertex: usize| model.prescribed.iter().any(|held| held.vertex as usize == vertex);
    let places = model.rest_mm.iter().enumerate();
    let start_mm = places
        .map(|(vertex, &place)| {
            if is_held(vertex) {
                place
            } else {
                jitter.moved(place, edge_mm)
            }
        })
        .collect();
    (model, start_mm)
}

/// The same of threads, which carry no compression.
fn threads(mut model: Model) -> Model {
    model.springs.compression_n_per_mm.fill(0.0);
    model
}

//! Contact.

use super::*;
use coapt::contact::pairs::{Pair, PairKind};
use coapt::contact::penalty;
use coapt::contact::touch::touches;
use coapt::scene::{Contact, MMHG_MPA};

/// A pair of each kind with its closest points inside, on an edge and on a vertex, and two nearly parallel edges.
fn touching_pairs() -> Vec<(&'static str, PairKind, [Vec3; 4])> {
    let v = Vec3::new;
    let triangle = [v(0.0, 0.0, 0.0), v(2.0, 0.1, 0.0), v(0.2, 1.8, 0.1)];
    let point = |p| [p, triangle[0], triangle[1], triangle[2]];
    vec![
        (
            "point over face",
            PairKind::PointTriangle,
            point(v(0.6, 0.5, 0.3)),
        ),
        (
            "point off edge",
            PairKind::PointTriangle,
            point(v(1.0, -0.2, 0.2)),
        ),
        (
            "point off vertex",
            PairKind::PointTriangle,
            point(v(-0.2, -0.1, 0.15)),
        ),
        (
            "edges crossing",
            PairKind::EdgeEdge,
            [
                v(-1.0, 0.1, 0.0),
                v(1.2, 0.0, 0.1),
                v(0.1, -1.0, 0.35),
                v(0.0, 1.1, 0.3),
            ],
        ),
        (
            "edge past the end of an edge",
            PairKind::EdgeEdge,
            [
                v(-1.0, 0.0, 0.0),
                v(1.0, 0.0, 0.0),
                v(1.1, -1.0, 0.2),
                v(1.2, 1.0, 0.3),
            ],
        ),
        (
            "edges nearly parallel",
            PairKind::EdgeEdge,
            [
                v(-1.0, 0.0, 0.0),
                v(1.0, 0.0, 0.0),
                v(-1.0, 0.02, 0.3),
                v(1.1, -0.02, 0.3),
            ],
        ),
    ]
}

#[test]
fn contact_of_every_kind() {
    // Distances are about 0.3 mm: on the soft side of the band, on the steep one, and on the parabola behind it.
    let regimes = [0.0, 0.1, 0.35];
    for ((name, kind, positions), rigid_mm) in
        touching_pairs().into_iter().flat_map(|p| regimes.map(|r| (p, r)))
    {
        let pairs = [Pair {
            kind,
            vertices: [0, 1, 2, 3],
            activation_mm: 0.5,
            rigid_mm,
            area_mm2: 0.7,
            parallel_limit_mm4: if kind == PairKind::EdgeEdge {
                1e-3 * 16.0
            } else {
                0.0
            },
        }];
        let term = Term {
            energy: &|x| penalty::energy(&touches(&pairs, x), 2.0, x),
            gradient: &|x| gradient_of(4, |g| penalty::add_gradient(&touches(&pairs, x), 2.0, x, g)),
            hessian: &|x, c| {
                dense(4, |sink| {
                    penalty::add_hessian(&touches(&pairs, x), 2.0, x, c, sink)
                })
            },
        };
        assert!(
            (term.energy)(&positions) > 0.0,
            "{name} must touch, rigid at {rigid_mm}"
        );
        assert_all(&term, &positions);
        assert_projected_is_semidefinite(&term, &positions);
    }
}

#[test]
fn contact_begins_smoothly_and_ends_rigid() {
    // C² at the activation distance: value, slope and curvature vanish there like the third, second and first
    // power of the overlap.
    let [value, slope, curvature] = penalty::penalty(0.5 * (1.0 - 1e-4), 0.5, 0.0, 2.0);
    assert!(value < 1e-11 && slope.abs() < 1e-7 && curvature < 1e-2);
    assert_eq!(penalty::penalty(0.5, 0.5, 0.0, 2.0), [0.0; 3]);
    // The parabola goes on from a fifth of the band as the law arrives there, in value, slope and curvature: what is left
    // are the third derivatives, of order 1e4 here, times the gap.
    let [above, below] = [1e-9, -1e-9].map(|off| penalty::penalty(0.3 + off, 0.5, 0.25, 2.0));
    for (above, below) in above.into_iter().zip(below) {
        assert!((above - below).abs() < 1e-5 * above.abs(), "{above} {below}");
    }
    // With the default stiffness mid-surfaces in one place push each other apart by a thousand systolic pressures, and by
    // more where contact is rigid sooner.
    let Contact {
        thickness_mm,
        stiffness_mpa,
    } = Contact::default();
    let pushes = [0.0, 0.5, 0.95].map(|rigid| {
        let [_, slope, _] = penalty::penalty(0.0, thickness_mm, rigid * thickness_mm, stiffness_mpa);
        -slope
    });
    assert!(
        pushes[0] > 1e3 * 120.0 * MMHG_MPA && pushes.is_sorted(),
        "{pushes:?}"
    );
}

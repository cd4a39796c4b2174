//! Every energy: its gradient is the slope of its value, its Hessian the slope of its gradient, and what is
//! internal pushes and turns nothing as a whole.
//!
//! Central differences with step h are off by h² times the third derivative plus rounding over h: with h = 1e-5
//! on quantities of order one, 1e-6 relative is the accuracy to expect of a right formula and 1e-1 of a wrong one.

use coapt::contact::pairs::{Pair, PairKind};
use coapt::contact::penalty;
use coapt::contact::touch::touches;
use coapt::energy::{
    BlockSink, Curvature, bending, bending::Hinges, bilinear_spring, bilinear_spring::Springs, chord,
    chord::Chords, pressure,
};
use coapt::scene::{Contact, MMHG_MPA};
use coapt::{Mat3, Vec3};
use coapt_tests::Random;
use nalgebra::DMatrix;

const STEP: f64 = 1e-5;

/// What a term must offer to be checked.
struct Term<'a> {
    energy: &'a dyn Fn(&[Vec3]) -> f64,
    gradient: &'a dyn Fn(&[Vec3]) -> Vec<Vec3>,
    hessian: &'a dyn Fn(&[Vec3], Curvature) -> DMatrix<f64>,
}

fn nudged(positions: &[Vec3], vertex: usize, axis: usize, by: f64) -> Vec<Vec3> {
    let mut moved = positions.to_vec();
    moved[vertex][axis] += by;
    moved
}

fn assert_gradient(term: &Term, positions: &[Vec3]) {
    let gradient = (term.gradient)(positions);
    let scale = gradient.iter().map(|g| g.norm()).fold(1e-6, f64::max);
    for (vertex, slope) in gradient.iter().enumerate() {
        for (axis, slope) in slope.iter().enumerate() {
            let ahead = (term.energy)(&nudged(positions, vertex, axis, STEP));
            let behind = (term.energy)(&nudged(positions, vertex, axis, -STEP));
            let difference = (ahead - behind) / (2.0 * STEP) - slope;
            assert!(
                difference.abs() <= 1e-6 * scale,
                "vertex {vertex} axis {axis}: {difference} of {scale}"
            );
        }
    }
}

fn assert_hessian(term: &Term, positions: &[Vec3]) {
    let hessian = (term.hessian)(positions, Curvature::Exact);
    let scale = hessian.amax().max(1e-6);
    for vertex in 0..positions.len() {
        for axis in 0..3 {
            let ahead = (term.gradient)(&nudged(positions, vertex, axis, STEP));
            let behind = (term.gradient)(&nudged(positions, vertex, axis, -STEP));
            for (row, (a, b)) in ahead.iter().zip(&behind).enumerate() {
                for k in 0..3 {
                    let slope = (a[k] - b[k]) / (2.0 * STEP);
                    let difference = slope - hessian[(3 * row + k, 3 * vertex + axis)];
                    assert!(
                        difference.abs() <= 1e-5 * scale,
                        "({row}, {k}) by ({vertex}, {axis}): {difference} of {scale}"
                    );
                }
            }
        }
    }
}

fn assert_projected_is_semidefinite(term: &Term, positions: &[Vec3]) {
    let projected = (term.hessian)(positions, Curvature::Projected);
    let eigenvalues = projected.symmetric_eigenvalues();
    assert!(
        eigenvalues.min() >= -1e-10 * eigenvalues.amax().max(1e-12),
        "{}",
        eigenvalues.min()
    );
}

fn assert_balanced(term: &Term, positions: &[Vec3]) {
    let gradient = (term.gradient)(positions);
    let scale: f64 = gradient
        .iter()
        .zip(positions)
        .map(|(g, x)| g.norm() * (1.0 + x.norm()))
        .sum();
    let force: Vec3 = gradient.iter().sum();
    let torque: Vec3 = positions.iter().zip(&gradient).map(|(x, g)| x.cross(g)).sum();
    // Rounding only.
    assert!(
        force.norm() <= 1e-13 * scale && torque.norm() <= 1e-13 * scale,
        "{force} {torque} of {scale}"
    );
}

fn assert_all(term: &Term, positions: &[Vec3]) {
    assert_gradient(term, positions);
    assert_hessian(term, positions);
    assert_balanced(term, positions);
}

/// Collects blocks into a dense matrix.
struct Dense(DMatrix<f64>);

impl BlockSink for Dense {
    fn add(&mut self, row: u32, column: u32, block: &Mat3) {
        for k in 0..3 {
            for l in 0..3 {
                self.0[(3 * row as usize + k, 3 * column as usize + l)] += block[(k, l)];
                if row != column {
                    self.0[(3 * column as usize + l, 3 * row as usize + k)] += block[(k, l)];
                }
            }
        }
    }
}

fn dense(vertices: usize, fill: impl FnOnce(&mut Dense)) -> DMatrix<f64> {
    let mut dense = Dense(DMatrix::zeros(3 * vertices, 3 * vertices));
    fill(&mut dense);
    dense.0
}

fn gradient_of(vertices: usize, fill: impl FnOnce(&mut [Vec3])) -> Vec<Vec3> {
    let mut gradient = vec![Vec3::zeros(); vertices];
    fill(&mut gradient);
    gradient
}

#[test]
fn springs_in_compression_on_the_soft_and_on_the_stiff_branch() {
    for length in [0.7, 1.1, 1.6] {
        let springs = Springs {
            ends: vec![[0, 1]],
            rest_length_mm: vec![1.0],
            transition_length_mm: vec![1.25],
            soft_n_per_mm: vec![0.3],
            stiff_n_per_mm: vec![11.0],
            compression_n_per_mm: vec![0.2],
        };
        let direction = Vec3::new(1.0, -2.0, 0.5).normalize();
        let positions = vec![
            Vec3::new(3.0, 1.0, -2.0),
            Vec3::new(3.0, 1.0, -2.0) + direction * length,
        ];
        let term = Term {
            energy: &|x| bilinear_spring::energy(&springs, x),
            gradient: &|x| gradient_of(2, |g| bilinear_spring::add_gradient(&springs, x, g)),
            hessian: &|x, _| dense(2, |sink| bilinear_spring::add_hessian(&springs, x, sink)),
        };
        assert_all(&term, &positions);
        // The law itself: f(1.6) = 0.3·0.25 + 11·0.35, f(1.1) = 0.3·0.1, f(0.7) = −0.2·0.3.
        let expected = if length < 1.0 {
            -0.06
        } else if length < 1.25 {
            0.03
        } else {
            0.075 + 3.85
        };
        assert!((springs.tension_and_tangent(0, length).0 - expected).abs() < 1e-14);
    }
}

#[test]
fn chords_taut_and_slack() {
    for length in [0.8, 1.05] {
        let chords = Chords {
            points: vec![vec![(0, 1.0)], vec![(1, 1.0)]],
            ..one_chord()
        };
        let positions = vec![Vec3::new(0.2, 0.1, 0.0), Vec3::new(0.2, 0.1, length)];
        assert_chord(&chords, &positions);
        // T = EA ε in tension, nothing in compression.
        let expected = if length > 1.0 { 12.0 * 0.05 } else { 0.0 };
        assert!((chords.tensions_n(&positions)[0] - expected).abs() < 1e-13);
    }
}

/// From a patch of three vertices to one, and to a patch that shares two of them.
#[test]
fn chords_between_patches() {
    let mut random = Random(6);
    let positions: Vec<Vec3> = (0..5)
        .map(|k| random.vector() + Vec3::z() * f64::from(k))
        .collect();
    for second in [vec![(4, 1.0)], vec![(1, 0.3), (2, 0.2), (3, 0.1), (4, 0.4)]] {
        let chords = Chords {
            points: vec![vec![(0, 0.5), (1, 0.3), (2, 0.2)], second],
            ..one_chord()
        };
        assert!(chords.tensions_n(&positions)[0] > 0.0);
        assert_chord(&chords, &positions);
    }
}

fn one_chord() -> Chords {
    Chords {
        points: Vec::new(),
        ends: vec![[0, 1]],
        rest_length_mm: vec![1.0],
        axial_stiffness_n: vec![12.0],
        group: vec![0],
    }
}

fn assert_chord(chords: &Chords, positions: &[Vec3]) {
    let count = positions.len();
    let term = Term {
        energy: &|x| chord::energy(chords, x),
        gradient: &|x| gradient_of(count, |g| chord::add_gradient(chords, x, g)),
        hessian: &|x, _| dense(count, |sink| chord::add_hessian(chords, x, sink)),
    };
    assert_all(&term, positions);
    assert_projected_is_semidefinite(&term, positions);
    assert_eq!(
        places(chords, positions),
        places(chords, &vec![Vec3::zeros(); count])
    );
}

/// Where a chord's blocks go: the solver looks that up once, so it must not depend on the positions, not even on whether
/// a chord is slack.
fn places(chords: &Chords, positions: &[Vec3]) -> Vec<[u32; 2]> {
    let mut places = Vec::new();
    let mut sink = |row: u32, column: u32, _: &Mat3| places.push([row, column]);
    chord::add_hessian(chords, positions, &mut sink);
    places
}

#[test]
fn bent_hinges() {
    let mut random = Random(7);
    let hinges = Hinges {
        vertices: vec![[0, 1, 2, 3], [1, 2, 4, 0]],
        // As cotangents give them: adding up to nothing.
        weights: vec![[0.5, 1.1, -0.9, -0.7], [0.4, 0.8, -1.3, 0.1]],
        stiffness_n_per_mm: vec![0.3, 2.0],
    };
    let positions: Vec<Vec3> = (0..5).map(|_| random.vector() * 2.0).collect();
    let term = Term {
        energy: &|x| bending::energy(&hinges, x),
        gradient: &|x| gradient_of(5, |g| bending::add_gradient(&hinges, x, g)),
        hessian: &|_, _| dense(5, |sink| bending::add_hessian(&hinges, sink)),
    };
    assert_all(&term, &positions);
    assert_projected_is_semidefinite(&term, &positions);
}

/// A fan of six faces around vertex 0, bent at random.
fn fan(random: &mut Random) -> (Vec<[u32; 3]>, Vec<Vec3>) {
    let mut positions = vec![random.vector() * 0.2];
    for k in 0..6 {
        let angle = f64::from(k) * std::f64::consts::FRAC_PI_3;
        positions.push(Vec3::new(angle.cos(), angle.sin(), 0.0) + random.vector() * 0.2);
    }
    ((0..6).map(|k| [0, k + 1, (k + 1) % 6 + 1]).collect(), positions)
}

#[test]
fn pressure_potential_has_the_gradient_it_claims() {
    let mut random = Random(3);
    let (faces, positions) = fan(&mut random);
    let apex = Vec3::new(0.3, -0.2, 1.0);
    let term = Term {
        energy: &|x| pressure::potential(&faces, 0.0133, apex, x),
        gradient: &|x| {
            gradient_of(7, |g| {
                pressure::add_potential_gradient(&faces, 0.0133, apex, x, g)
            })
        },
        hessian: &|_, _| DMatrix::zeros(21, 21),
    };
    assert_gradient(&term, &positions);
}

#[test]
fn pressure_inside_a_rim_is_the_gradient_of_its_potential() {
    let mut random = Random(4);
    let (faces, positions) = fan(&mut random);
    let load = gradient_of(7, |g| pressure::add_gradient(&faces, 1.0, &positions, g));
    let potential = gradient_of(7, |g| {
        pressure::add_potential_gradient(&faces, 1.0, Vec3::new(5.0, 1.0, 2.0), &positions, g)
    });
    assert!(
        (load[0] - potential[0]).norm() < 1e-13,
        "vertex 0 lies inside a ring of faces"
    );
    assert!(
        (load[1] - potential[1]).norm() > 1e-2,
        "vertex 1 lies on an open rim, where the two must differ"
    );
}

#[test]
fn pressure_tangent_is_the_slope_of_the_load_split_in_its_two_parts() {
    let mut random = Random(5);
    let (faces, positions) = fan(&mut random);
    let load = |x: &[Vec3]| gradient_of(7, |g| pressure::add_gradient(&faces, 1.0, x, g));
    let rim = pressure::rim(&faces);
    assert_eq!(rim.len(), 6);
    let symmetric = dense(7, |sink| {
        pressure::add_symmetric_tangent(&faces, 1.0, &positions, sink)
    });
    for column in 0..21 {
        let mut direction = vec![Vec3::zeros(); 7];
        direction[column / 3][column % 3] = 1.0;
        let antisymmetric = gradient_of(7, |g| {
            pressure::add_antisymmetric_product(&rim, 1.0, &positions, &direction, g)
        });
        let ahead = load(&nudged(&positions, column / 3, column % 3, STEP));
        let behind = load(&nudged(&positions, column / 3, column % 3, -STEP));
        for row in 0..21 {
            let slope = (ahead[row / 3][row % 3] - behind[row / 3][row % 3]) / (2.0 * STEP);
            let parts = symmetric[(row, column)] + antisymmetric[row / 3][row % 3];
            // The load is quadratic in the positions: central differences are exact but for rounding over h.
            assert!(
                (slope - parts).abs() < 1e-9,
                "({row}, {column}): {slope} and {parts}"
            );
        }
    }
}

#[test]
fn pressure_on_a_closed_surface_sums_to_nothing() {
    let positions: Vec<Vec3> = vec![
        Vec3::zeros(),
        Vec3::new(2.0, 0.1, 0.0),
        Vec3::new(0.3, 1.5, 0.2),
        Vec3::new(0.4, 0.5, 1.7),
    ];
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let load = gradient_of(4, |g| pressure::add_gradient(&faces, 1.0, &positions, g));
    assert!(load.iter().sum::<Vec3>().norm() < 1e-14);
}

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

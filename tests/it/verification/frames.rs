//! Bars and chords under given forces: von Mises' truss, the catenary, a weight on a chord.

use coapt::Vec3;
use coapt::energy::bilinear_spring;
use coapt::energy::chord::Chords;
use coapt::model::{ChordGroup, Model};
use coapt::scene::ChordLaw;

use super::references::root;
use super::{error, oracle, report, settled};
use crate::shapes::{Mesh, add_spring, bare, hold};

/// Bars between points, some held. Faces carry nothing; they make a mesh of it.
pub(crate) fn frame(
    points_mm: Vec<Vec3>,
    faces: Vec<[u32; 3]>,
    bars: &[([u32; 2], f64)],
    held: &[u32],
) -> Model {
    let mesh = Mesh {
        points_mm,
        faces,
        rim: vec![],
    };
    let mut model = bare(&mesh, 0.0);
    for &([a, b], stiffness) in bars {
        let length_mm = (mesh.points_mm[a as usize] - mesh.points_mm[b as usize]).norm();
        add_spring(&mut model.springs, [a, b], length_mm, stiffness);
    }
    hold(&mut model, held);
    model.settings.residual_tolerance = 1e-9;
    model
}

const HALF_SPAN_MM: f64 = 10.0;
const RISE_MM: f64 = 1.0;
const BAR_N_PER_MM: f64 = 1.0;

/// Two bars lean on each other over a span 2 b, the apex at a height y over the supports, pushed down by
/// P = 2 k (L₀ / L − 1) y, L² = b² + y².
fn truss_force_n(height_mm: f64) -> f64 {
    let rest = HALF_SPAN_MM.hypot(RISE_MM);
    2.0 * BAR_N_PER_MM * (rest / HALF_SPAN_MM.hypot(height_mm) - 1.0) * height_mm
}

/// dP/dy = 0 where L³ = L₀ b², hence P = 2 k (L₀^(2/3) − b^(2/3))^(3/2).
pub(crate) fn largest_truss_force_n() -> f64 {
    let power = |x: f64| x.powf(2.0 / 3.0);
    2.0 * BAR_N_PER_MM * (power(HALF_SPAN_MM.hypot(RISE_MM)) - power(HALF_SPAN_MM)).powf(1.5)
}

/// Two horizontal guides a metre long keep the apex in the plane; when it has come down by w, they hold it back with
/// 2 k (√(l² + w²) − l) w / √(l² + w²), some millionths of what the bars do.
const GUIDE_MM: f64 = 1e3;

fn guide_force_n(height_mm: f64) -> f64 {
    let down = RISE_MM - height_mm;
    let length = GUIDE_MM.hypot(down);
    2.0 * BAR_N_PER_MM * (length - GUIDE_MM) * down / length
}

/// Von Mises' truss under a force on its apex.
pub(crate) fn truss(force_n: f64, guides: bool) -> Model {
    let apex = Vec3::new(0.0, 0.0, RISE_MM);
    let points = vec![
        apex,
        Vec3::new(-HALF_SPAN_MM, 0.0, 0.0),
        Vec3::new(HALF_SPAN_MM, 0.0, 0.0),
        apex + Vec3::y() * GUIDE_MM,
        apex - Vec3::y() * GUIDE_MM,
    ];
    let mut bars = vec![([0, 1], BAR_N_PER_MM), ([0, 2], BAR_N_PER_MM)];
    if guides {
        bars.extend([([0, 3], BAR_N_PER_MM), ([0, 4], BAR_N_PER_MM)]);
    }
    let mut model = frame(points, vec![[1, 2, 0]], &bars, &[1, 2, 3, 4]);
    model.dead_loads_n = vec![(0, Vec3::new(0.0, 0.0, -force_n))];
    // Counted in what a strain of 1e-3 pulls with, in the guides more than anywhere.
    model.settings.residual_tolerance = 1e-13;
    model
}

/// Up to a thousandth below the largest force the apex stays up, from a thousandth above it the truss snaps through to where
/// its bars are in tension, and comes to rest there; both on the curve.
#[test]
fn von_mises_truss_snaps_at_its_largest_force() {
    let largest_n = largest_truss_force_n();
    if let Some(values) = oracle("reference_values.json") {
        let expected = values["von_mises_truss"]["example"]["P_cr"]
            .as_f64()
            .expect("a number");
        assert!(error(largest_n, expected) < 1e-12);
    }
    for part in [0.5, 0.9, 0.99, 0.999, 1.001, 1.01, 1.5, 5.0] {
        let model = truss(part * largest_n, true);
        let equilibrium = settled("truss", &model, model.rest_mm.clone());
        let height_mm = equilibrium.state.positions_mm[0].z;
        let off = error(
            truss_force_n(height_mm) + guide_force_n(height_mm),
            part * largest_n,
        );
        report(&format!(
            "von Mises truss at {part} of its largest force: apex at {height_mm:.6} mm in {} iterations, force off by {off:.1e}",
            equilibrium.history.len()
        ));
        assert_eq!(height_mm > 0.0, part < 1.0);
        assert!(equilibrium.certificate.stable);
        assert!(off < 1e-7);
    }
}

/// Without guides its bars, which are compressed, swing over sideways under any force: a balance that does not last. The
/// solver leaves it for the one that hangs.
#[test]
fn a_truss_without_guides_ends_hanging() {
    let force_n = 0.5 * largest_truss_force_n();
    let model = truss(force_n, false);
    let equilibrium = settled("truss", &model, model.rest_mm.clone());
    let height_mm = equilibrium.state.positions_mm[0].z;
    assert!(height_mm < 0.0 && equilibrium.certificate.stable);
    assert!(error(truss_force_n(height_mm), force_n) < 1e-6);
}

/// A straight chain of eight links whose supports come together by a fifth.
pub(crate) fn compressed_chain() -> Model {
    let points: Vec<Vec3> = (0..=8)
        .map(|i| Vec3::x() * f64::from(i))
        .chain([Vec3::new(4.0, 50.0, 0.0)])
        .collect();
    let bars: Vec<([u32; 2], f64)> = (0..8).map(|i| ([i, i + 1], 1.0)).collect();
    let faces = (0..8).map(|i| [i, i + 1, 9]).collect();
    let mut model = frame(points, faces, &bars, &[0, 8, 9]);
    model.prescribed[1].target_mm.x = 6.4;
    model
}

/// It does not stay compressed, a balance that lasts no longer than nothing pushes it, but gives way sideways until no link
/// resists any more.
#[test]
fn a_compressed_chain_buckles_and_slackens() {
    let model = compressed_chain();
    let equilibrium = settled("compressed chain", &model, model.rest_mm.clone());
    let positions = &equilibrium.state.positions_mm;
    let energy = bilinear_spring::energy(&model.springs, positions);
    // Straight, it stores 8 · ½ k 0.2².
    report(&format!(
        "compressed chain: {energy:.1e} of 0.16 N·mm left, {:?}",
        equilibrium.reactions_n[0].norm()
    ));
    assert!(energy < 1e-9 && positions.iter().all(|x| x.iter().all(|value| value.is_finite())));
    assert!(equilibrium.certificate.stable);
}

/// A weight on a chord stretches it by what its law says, read backwards by hand: σ = W / A.
#[test]
fn a_weight_on_a_chord_stretches_it_by_its_law() {
    const LENGTH_MM: f64 = 20.0;
    const AREA_MM2: f64 = 0.5;
    // Stress, and the strain that goes with it.
    let exponential = |scale: f64, exponent: f64, stress: f64| (stress / scale).ln_1p() / exponent;
    let collagen = ChordLaw::Collagen {
        scale_mpa: 0.1,
        exponent: 60.0,
        full_recruitment_strain: 0.05,
        modulus_mpa: 100.0,
    };
    let recruited = 0.1 * 3.0_f64.exp_m1();
    let cases = [
        (ChordLaw::Linear { modulus_mpa: 40.0 }, 2.0, 2.0 / 40.0),
        (piecewise(), 0.4, 0.4 / 10.0),
        (piecewise(), 2.0, 0.05 + 1.5 / 60.0),
        (
            ChordLaw::Exponential {
                scale_mpa: 0.1,
                exponent: 60.0,
            },
            3.0,
            exponential(0.1, 60.0, 3.0),
        ),
        (collagen.clone(), 1.0, exponential(0.1, 60.0, 1.0)),
        (collagen, recruited + 2.0, 0.05 + 2.0 / 100.0),
        (
            ChordLaw::Table {
                strain: vec![0.0, 0.02, 0.04, 0.06],
                stress_mpa: vec![0.0, 0.2, 1.0, 3.0],
            },
            2.0,
            0.05,
        ),
    ];
    for (law, stress_mpa, strain) in cases {
        let points = vec![Vec3::zeros(), Vec3::x(), Vec3::new(1.0, 0.0, -LENGTH_MM)];
        // The chord alone holds the vertex 2; the bar makes a mesh of it.
        let mut model = frame(points, vec![[0, 1, 2]], &[([0, 1], 1.0)], &[0, 1]);
        model.dead_loads_n = vec![(2, Vec3::z() * (-stress_mpa * AREA_MM2))];
        model.chords = Chords {
            points: vec![vec![(1, 1.0)], vec![(2, 1.0)]],
            ends: vec![[0, 1]],
            rest_length_mm: vec![LENGTH_MM],
            area_mm2: vec![AREA_MM2],
            group: vec![0],
            laws: vec![law.clone()],
        };
        model.chord_groups = vec![ChordGroup::chordae("chord")];
        let equilibrium = settled("chord", &model, model.rest_mm.clone());
        let found = -equilibrium.state.positions_mm[2].z / LENGTH_MM - 1.0;
        report(&format!(
            "weight on a chord, {law:?}: strain {found:.8}, off by {:.1e}",
            error(found, strain)
        ));
        assert!(error(found, strain) < 1e-7, "{law:?}");
        assert!(error(equilibrium.reactions_n[1].norm(), stress_mpa * AREA_MM2) < 1e-7);
    }
}

fn piecewise() -> ChordLaw {
    ChordLaw::PiecewiseLinear {
        toe_modulus_mpa: 10.0,
        transition_strain: 0.05,
        modulus_mpa: 60.0,
    }
}

const LINKS: u32 = 20;
const LINK_N_PER_MM: f64 = 100.0;
const WEIGHT_N: f64 = 0.01;
/// Supports come together by a fifth.
const SPAN_MM: f64 = 16.0;

/// A chain of equal links with a weight at each joint, whose supports come together.
pub(crate) fn hanging_chain() -> Model {
    let mut points: Vec<Vec3> = (0..=LINKS).map(|i| Vec3::x() * f64::from(i)).collect();
    points.push(Vec3::new(10.0, 50.0, 0.0));
    let bars: Vec<([u32; 2], f64)> = (0..LINKS).map(|i| ([i, i + 1], LINK_N_PER_MM)).collect();
    let faces = (0..LINKS).map(|i| [i, i + 1, LINKS + 1]).collect();
    let mut model = frame(points, faces, &bars, &[0, LINKS, LINKS + 1]);
    model.prescribed[1].target_mm.x = SPAN_MM;
    model.dead_loads_n = (1..LINKS).map(|i| (i, Vec3::z() * -WEIGHT_N)).collect();
    model
}

/// All of n links pull sideways with the same H, and each holds one weight more than the next, so that a link's force is
/// (H, (n/2 − i − ½) w) and all of them together span the supports. It starts as a taut line, which resists weights across
/// it with nothing.
#[test]
fn a_hanging_chain_is_a_catenary() {
    let model = hanging_chain();
    let down = |i: u32| (0.5 * f64::from(LINKS) - f64::from(i) - 0.5) * WEIGHT_N;
    let link = |h: f64, i: u32| {
        let pull = h.hypot(down(i));
        (1.0 + pull / LINK_N_PER_MM) / pull
    };
    let span = |h: f64| (0..LINKS).map(|i| h * link(h, i)).sum::<f64>() - SPAN_MM;
    let sideways_n = root(span, 1e-3, 10.0);
    let sag_mm: f64 = (0..LINKS / 2).map(|i| down(i) * link(sideways_n, i)).sum();
    let positions = settled("chain", &model, model.rest_mm.clone()).state.positions_mm;
    let mut worst = error(-positions[LINKS as usize / 2].z, sag_mm);
    for i in 0..LINKS {
        let way = positions[i as usize + 1] - positions[i as usize];
        let (pull, _) = model.springs.tension_and_tangent(i as usize, way.norm());
        let force = way * (pull / way.norm());
        worst = worst
            .max(error(force.x, sideways_n))
            .max((force.z + down(i)).abs() / WEIGHT_N);
    }
    report(&format!(
        "catenary of {LINKS} links: sag {sag_mm:.4} mm, H {sideways_n:.6} N; off by {worst:.1e} at most"
    ));
    assert!(worst < 1e-6);
}

use super::curve::{STRESS_RATIOS, curve_of_law, curve_of_response};
use super::membranes::{exponential_from_curve, st_venant_kirchhoff_from_curve};
use super::*;
use crate::energy::membrane::{Law, exponential, may_newman};

const KILOPASCAL_100: [f64; 2] = [0.0, 0.1];

fn branches(soft: f64, knee: f64, stiff: f64) -> SpringBranches {
    SpringBranches {
        pre_transition_modulus_mpa: soft,
        transition_strain: knee,
        post_transition_modulus_mpa: stiff,
    }
}

fn assert_near(found: SpringBranches, due: SpringBranches, tolerance: f64) {
    let pairs = [
        (found.pre_transition_modulus_mpa, due.pre_transition_modulus_mpa),
        (found.transition_strain, due.transition_strain),
        (found.post_transition_modulus_mpa, due.post_transition_modulus_mpa),
    ];
    assert!(
        pairs.iter().all(|(a, b)| (a / b - 1.0).abs() < tolerance),
        "{found:?} instead of {due:?}"
    );
}

fn anterior() -> Law {
    Law::MayNewman(may_newman::ANTERIOR)
}

fn posterior() -> Law {
    Law::MayNewman(may_newman::POSTERIOR)
}

/// Stretched alike in both directions a lattice bears P = 3/2 σ, whatever way it lies; 1e-14 is rounding.
#[test]
fn an_equibiaxial_lattice_bears_three_halves_of_its_springs() {
    let springs = [branches(0.08, 0.25, 4.0); 2];
    for (strain, spring_mpa) in [(0.1, 0.008), (0.25, 0.02), (0.3, 0.22), (-0.1, -0.004)] {
        for stress in nominal_stress_mpa(&springs, 0.5, [1.0 + strain; 2]) {
            assert!((stress - 1.5 * spring_mpa).abs() < 1e-14, "{stress} at {strain}");
        }
    }
}

/// At small strains an isotropic lattice is a membrane of Poisson ratio 1/3: P₁ = E (e₁ + e₂ / 3) / (1 − 1/9). The next order
/// in strain is left out: 1e-6 of strain leaves 1e-6.
#[test]
fn a_lattice_has_a_poisson_ratio_of_a_third() {
    let found = nominal_stress_mpa(&[branches(2.0, 0.5, 2.0); 2], 1.0, [1.0 + 3e-6, 1.0 - 1e-6]);
    let due = |e: f64, across: f64| 2.0 * (e + across / 3.0) / (1.0 - 1.0 / 9.0);
    assert!((found[0] / due(3e-6, -1e-6) - 1.0).abs() < 1e-5, "{found:?}");
    assert!(found[1].abs() < 1e-10, "{found:?}");
}

/// Springs fitted to the curve of springs are those springs. The transition is bracketed to 1e-10 and moduli are exact for
/// it, but a minimum is only as sharp as the square root of rounding: 1e-6.
#[test]
fn isotropic_springs_are_found_again() {
    for due in [
        branches(0.08, 0.25, 4.0),
        branches(0.3, 0.07, 8.0),
        branches(0.02, 0.4, 0.5),
    ] {
        let response = |stretch| nominal_stress_mpa(&[due; 2], 1.0, stretch);
        let fit = bilinear_from_curve(
            &curve_of_response(response, [1.0; 2], 0.1, 60),
            KILOPASCAL_100,
            1.0,
        )
        .unwrap();
        assert_near(fit.circumferential, due, 1e-6);
        assert!(fit.worst_error_mpa < 1e-7, "{fit:?}");
    }
}

/// The same with two directions, from three proportions of stress. Derivatives by
/// differences leave 1e-7; a flat valley of the error takes the rest.
#[test]
fn springs_with_a_direction_are_found_again() {
    let due = [branches(0.09, 0.10, 6.2), branches(0.06, 0.40, 2.35)];
    let response = |stretch| nominal_stress_mpa(&due, 1.0, stretch);
    let points = of_all_ratios(|ratio| curve_of_response(response, ratio, 0.1, 40));
    let fit = anisotropic_from_curve(&points, KILOPASCAL_100, 1.0).unwrap();
    assert_near(fit.circumferential, due[0], 1e-3);
    assert_near(fit.radial, due[1], 1e-3);
}

fn of_all_ratios(curve: impl Fn([f64; 2]) -> Vec<BiaxialPoint>) -> Vec<BiaxialPoint> {
    STRESS_RATIOS.into_iter().flat_map(curve).collect()
}

/// May-Newman's law under 100 kPa in both directions: the stretches by hand from its stresses,
/// σ₁ = 2 w₁ (λ₁² − λ₃²) + λ₁ ∂w/∂α and σ₂ = 2 w₁ (λ₂² − λ₃²), to two digits. Halving leaves 1e-9 of the stress.
#[test]
fn may_newmans_law_has_its_stretches() {
    for ((law, [c0, c1, c2]), due) in [
        ((anterior(), [0.399e-3, 4.325, 1446.5]), [1.12, 1.44]),
        ((posterior(), [0.414e-3, 4.848, 305.4]), [1.17, 1.39]),
    ] {
        let [first, second] = curve_of_law(&law, [1.0; 2], 0.1, 20)[19].stretch;
        assert!(
            (first - due[0]).abs() < 0.005 && (second - due[1]).abs() < 0.005,
            "{first} {second}"
        );
        let third = 1.0 / (first * second);
        let excess = first.powi(2) + second.powi(2) + third.powi(2) - 3.0;
        let growth = c0 * (c1 * excess.powi(2) + c2 * (first - 1.0).powi(4)).exp();
        let matrix = 4.0 * growth * c1 * excess;
        let fibre = first * growth * 4.0 * c2 * (first - 1.0).powi(3);
        assert!((matrix * (first.powi(2) - third.powi(2)) + fibre - 0.1).abs() < 1e-9);
        assert!((matrix * (second.powi(2) - third.powi(2)) - 0.1).abs() < 1e-9);
    }
}

/// How far springs follow May-Newman's law up to 100 kPa in both directions: root mean square of the error over that of the
/// stress, with what we measured. Isotropic ones follow the curve of area; of the law itself they follow neither direction.
#[test]
fn springs_follow_may_newmans_law() {
    for (law, [isotropic, with_direction]) in [(anterior(), [0.078, 0.054]), (posterior(), [0.078, 0.062])] {
        let curve = curve_of_law(&law, [1.0; 2], 0.1, 60);
        let part = |fit: BilinearFit| fit.rms_error_mpa / fit.rms_stress_mpa;
        let area = bilinear_from_curve(&area_equivalent(&curve), KILOPASCAL_100, 1.0).unwrap();
        assert!((part(area) - isotropic).abs() < 0.002, "{area:?}");
        // Paper 003's isotropic transition strain is 0.25.
        assert!(
            (area.circumferential.transition_strain - 0.24).abs() < 0.01,
            "{area:?}"
        );
        let both = anisotropic_from_curve(&curve, KILOPASCAL_100, 1.0).unwrap();
        assert!((part(both) - with_direction).abs() < 0.002, "{both:?}");
        let alike = bilinear_from_curve(&curve, KILOPASCAL_100, 1.0).unwrap();
        assert!(part(alike) > 0.4, "{alike:?}");
    }
}

/// Tricuspid tissue (Mathur 2022) is isotropic: springs with a direction find none.
#[test]
fn isotropic_tissue_has_no_direction() {
    let constants = exponential::Constants {
        c0_mpa: 0.001,
        c1_mpa: 0.000124,
        c2: 4.568202,
        compressibility_per_mpa: 0.0,
    };
    let curve = curve_of_law(&Law::Exponential(constants), [1.0; 2], 0.1, 60);
    let fit = anisotropic_from_curve(&curve, KILOPASCAL_100, 1.0).unwrap();
    assert_near(fit.radial, fit.circumferential, 1e-4);
}

/// Every conversion gives the same point of one state: λ 1.2 and 1.5, nominal 0.02 and 0.03 MPa, 0.8 mm thick.
#[test]
fn stress_and_tension_are_the_same_state() {
    let point = BiaxialPoint {
        stretch: [1.2, 1.5],
        nominal_stress_mpa: [0.02, 0.03],
    };
    let stress = BiaxialPoint::from_cauchy_stress(point.stretch, [0.024, 0.045]);
    let tension = BiaxialPoint::from_tension(point.stretch, [0.02 * 0.8 / 1.5, 0.03 * 0.8 / 1.2], 0.8);
    for other in [stress, tension] {
        for axis in 0..2 {
            assert!((other.nominal_stress_mpa[axis] - point.nominal_stress_mpa[axis]).abs() < 1e-15);
        }
    }
}

#[test]
fn wrong_curves_are_told() {
    let told = |points: &[BiaxialPoint], range| bilinear_from_curve(points, range, 1.0).unwrap_err();
    let curve = curve_of_law(&anterior(), [1.0; 2], 0.1, 20);
    assert_eq!(told(&curve, [0.1, 0.0])[0].place, "working range");
    assert_eq!(told(&curve, [0.0, f64::NAN])[0].place, "working range");
    assert_eq!(told(&curve[..3], KILOPASCAL_100)[0].place, "working range");
    assert!(told(&curve, [5.0, 6.0])[0].message.contains("holds 0 points"));
    let mut spoilt = curve.clone();
    spoilt[4].nominal_stress_mpa[1] = f64::NAN;
    spoilt[7].stretch[0] = 0.0;
    let places: Vec<String> = told(&spoilt, KILOPASCAL_100)
        .into_iter()
        .map(|fault| fault.place)
        .collect();
    assert_eq!(places, ["point 4", "point 7"]);
}

/// A curve of equal stretches and stresses both ways, of the larger stress 0.1 MPa.
fn alike_both_ways(nominal_stress_mpa: impl Fn(f64) -> f64) -> Vec<BiaxialPoint> {
    let point = |k: i32| {
        let stretch = 1.0 + 0.02 * f64::from(k);
        BiaxialPoint {
            stretch: [stretch; 2],
            nominal_stress_mpa: [nominal_stress_mpa(stretch); 2],
        }
    };
    (1..=12).map(point).collect()
}

/// A straight and a softening curve ask for springs that soften. They get the modulus of a line: that of the straight curve is
/// 3/2 of the springs' at small strains, 1e-9 is rounding in the ratio of sums.
#[test]
fn springs_do_not_soften_where_a_curve_does() {
    let line = |stretch: f64| 1.5 * 0.2 * (stretch - 1.0);
    let soft = |stretch: f64| 0.04 * (1.0 - (-30.0 * (stretch - 1.0)).exp());
    for (curve, due) in [(alike_both_ways(line), Some(0.2)), (alike_both_ways(soft), None)] {
        let found = bilinear_from_curve(&curve, KILOPASCAL_100, 1.0)
            .unwrap()
            .circumferential;
        let (soft, stiff) = (
            found.pre_transition_modulus_mpa,
            found.post_transition_modulus_mpa,
        );
        assert!(0.0 < soft && soft <= stiff, "{found:?}");
        assert!(due.is_none_or(|due| (soft / due - 1.0).abs() < 1e-9), "{found:?}");
    }
}

/// Tissue without stress up to a stretch, and compressed while it is pulled, has constants that no model takes, and each fit
/// says which.
#[test]
fn constants_that_no_model_takes_are_told() {
    let mut slack = alike_both_ways(|stretch| (stretch - 1.1).max(1e-9));
    slack[..5]
        .iter_mut()
        .for_each(|point| point.nominal_stress_mpa[1] = -0.02);
    let mut pushed = alike_both_ways(|_| -0.01);
    pushed
        .iter_mut()
        .for_each(|point| point.nominal_stress_mpa[1] = 1e-9);
    let told = |faults: Vec<Fault>, key: &str| {
        assert!(faults[0].place.ends_with(key), "{faults:?}");
        assert!(faults[0].message.contains("this curve"), "{faults:?}");
    };
    let range = KILOPASCAL_100;
    told(
        bilinear_from_curve(&slack, [0.0, 0.2], 1.0).unwrap_err(),
        "pre_transition_modulus_mpa",
    );
    told(
        st_venant_kirchhoff_from_curve(&pushed, range, 0.5).unwrap_err(),
        "modulus_mpa",
    );
    told(exponential_from_curve(&pushed, range).unwrap_err(), "c0_mpa");
}

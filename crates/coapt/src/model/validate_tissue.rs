//! The constants of tissue and chord laws: present, finite, and such that the law has one unloaded state.

use super::faults::Faults;
use super::validate_numbers::{not_negative, positive, same_count};
use crate::scene::{ChordLaw, SpringBranches, Tissue};

/// Exponents beyond this make a wall of a law, and double precision loses its foot [1].
const LARGEST_EXPONENT: f64 = 1e5;

pub(crate) fn tissue(tissue: &Tissue, place: &str, faults: &mut Faults) {
    let at = |key: &str| format!("{place}.{key}");
    match *tissue {
        Tissue::BilinearSprings {
            pre_transition_modulus_mpa,
            transition_strain,
            post_transition_modulus_mpa,
            compression_modulus_ratio,
            bending_modulus_ratio,
        } => {
            let springs = SpringBranches {
                pre_transition_modulus_mpa,
                transition_strain,
                post_transition_modulus_mpa,
            };
            branches(&springs, place, faults);
            not_negative(
                compression_modulus_ratio,
                &at("compression_modulus_ratio"),
                "",
                faults,
            );
            not_negative(bending_modulus_ratio, &at("bending_modulus_ratio"), "", faults);
        }
        Tissue::AnisotropicSprings {
            circumferential,
            radial,
            compression_modulus_ratio,
            bending_modulus_mpa,
        } => {
            branches(&circumferential, &at("circumferential"), faults);
            branches(&radial, &at("radial"), faults);
            not_negative(
                compression_modulus_ratio,
                &at("compression_modulus_ratio"),
                "",
                faults,
            );
            not_negative(bending_modulus_mpa, &at("bending_modulus_mpa"), "MPa", faults);
        }
        Tissue::StVenantKirchhoff {
            modulus_mpa,
            poisson_ratio,
            bending_modulus_mpa,
            ..
        } => {
            positive(modulus_mpa, &at("modulus_mpa"), "MPa", faults);
            if !(poisson_ratio > -1.0 && poisson_ratio < 1.0) {
                let message =
                    format!("is {poisson_ratio}, expected above -1 and below 1; 0.5 is incompressible");
                faults.error(at("poisson_ratio"), message);
            }
            not_negative(bending_modulus_mpa, &at("bending_modulus_mpa"), "MPa", faults);
        }
        Tissue::Exponential {
            c0_mpa,
            c1_mpa,
            c2,
            compressibility_per_mpa,
            bending_modulus_mpa,
            ..
        } => {
            positive(c0_mpa, &at("c0_mpa"), "MPa", faults);
            not_negative(c1_mpa, &at("c1_mpa"), "MPa", faults);
            exponent(c2, &at("c2"), faults);
            not_negative(
                compressibility_per_mpa,
                &at("compressibility_per_mpa"),
                "1/MPa",
                faults,
            );
            not_negative(bending_modulus_mpa, &at("bending_modulus_mpa"), "MPa", faults);
        }
        Tissue::MayNewman {
            c0_mpa,
            c1,
            c2,
            bending_modulus_mpa,
            ..
        } => {
            positive(c0_mpa, &at("c0_mpa"), "MPa", faults);
            positive(c1, &at("c1"), "", faults);
            exponent(c1, &at("c1"), faults);
            exponent(c2, &at("c2"), faults);
            not_negative(bending_modulus_mpa, &at("bending_modulus_mpa"), "MPa", faults);
        }
    }
}

fn exponent(value: f64, place: &str, faults: &mut Faults) {
    if !(0.0..=LARGEST_EXPONENT).contains(&value) {
        faults.error(place, format!("is {value}, expected 0 to {LARGEST_EXPONENT}"));
    }
}

fn branches(springs: &SpringBranches, place: &str, faults: &mut Faults) {
    let SpringBranches {
        pre_transition_modulus_mpa: soft,
        transition_strain,
        post_transition_modulus_mpa: stiff,
    } = *springs;
    positive(
        soft,
        &format!("{place}.pre_transition_modulus_mpa"),
        "MPa",
        faults,
    );
    positive(
        stiff,
        &format!("{place}.post_transition_modulus_mpa"),
        "MPa",
        faults,
    );
    positive(
        transition_strain,
        &format!("{place}.transition_strain"),
        "",
        faults,
    );
    if stiff < soft {
        let message =
            format!("is {stiff} MPa, below the pre-transition modulus {soft} MPa; collagen stiffens tissue");
        faults.error(format!("{place}.post_transition_modulus_mpa"), message);
    }
}

pub(crate) fn chord_law(law: &ChordLaw, place: &str, faults: &mut Faults) {
    let numbers: &[(&str, f64, &str)] = &match law {
        ChordLaw::Linear { modulus_mpa } => vec![("modulus_mpa", *modulus_mpa, "MPa")],
        ChordLaw::PiecewiseLinear {
            toe_modulus_mpa,
            transition_strain,
            modulus_mpa,
        } => vec![
            ("toe_modulus_mpa", *toe_modulus_mpa, "MPa"),
            ("transition_strain", *transition_strain, ""),
            ("modulus_mpa", *modulus_mpa, "MPa"),
        ],
        ChordLaw::Exponential { scale_mpa, exponent } => {
            vec![("scale_mpa", *scale_mpa, "MPa"), ("exponent", *exponent, "")]
        }
        ChordLaw::Collagen {
            scale_mpa,
            exponent,
            full_recruitment_strain,
            modulus_mpa,
        } => vec![
            ("scale_mpa", *scale_mpa, "MPa"),
            ("exponent", *exponent, ""),
            ("full_recruitment_strain", *full_recruitment_strain, ""),
            ("modulus_mpa", *modulus_mpa, "MPa"),
        ],
        ChordLaw::Table { strain, stress_mpa } => {
            return table(strain, stress_mpa, place, faults);
        }
    };
    for (key, value, unit) in numbers {
        positive(*value, &format!("{place}.{key}"), unit, faults);
    }
}

fn table(strain: &[f64], stress_mpa: &[f64], place: &str, faults: &mut Faults) {
    let at = |key: &str| format!("{place}.{key}");
    if strain.len() < 2 {
        let message = format!("has {} points, expected 2 or more, the first at 0", strain.len());
        faults.error(at("strain"), message);
        return;
    }
    same_count(
        stress_mpa.len(),
        strain.len(),
        &at("stress_mpa"),
        "strains",
        faults,
    );
    for (values, key, what) in [
        (strain, "strain", "rising"),
        (stress_mpa, "stress_mpa", "nowhere falling"),
    ] {
        if let Some(point) = values.iter().position(|value| !value.is_finite()) {
            faults.error(
                format!("{} point {point}", at(key)),
                format!("is {}, expected a finite number", values[point]),
            );
        } else if values.first() != Some(&0.0) {
            faults.error(
                format!("{} point 0", at(key)),
                format!("is {}, expected 0", values.first().unwrap_or(&f64::NAN)),
            );
        } else if let Some(point) = values
            .windows(2)
            .position(|pair| pair[1] < pair[0] || (key == "strain" && pair[1] == pair[0]))
        {
            let message = format!(
                "is {} after {}, expected values {what} from 0",
                values[point + 1],
                values[point]
            );
            faults.error(format!("{} point {}", at(key), point + 1), message);
        }
    }
}

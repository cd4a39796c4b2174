//! The constants of tissue and chord laws: present, finite, and such that the law has one unloaded state.

use super::faults::Faults;
use super::validate_numbers::{not_negative, positive, same_count};
use crate::scene::{ChordLaw, Fault, Readable, SpringBranches, Tissue};

/// Exponents beyond this make a wall of a law, and double precision loses its foot [1].
const LARGEST_EXPONENT: f64 = 1e5;

/// What a model finds wrong with a tissue's constants.
pub(crate) fn tissue_faults(tissue: &Tissue, place: &str) -> Vec<Fault> {
    let mut faults = Faults::default();
    self::tissue(tissue, place, &mut faults);
    faults.stop().err().unwrap_or_default()
}

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
            // In the plane the law would bear 1; no material that is the same in all directions has more than a half.
            if !(poisson_ratio > -1.0 && poisson_ratio <= 0.5) {
                let message = format!(
                    "is {}, expected above -1 and at most 0.5, which is incompressible",
                    Readable(poisson_ratio)
                );
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
            exponent(c2, &at("c2"), faults);
            not_negative(bending_modulus_mpa, &at("bending_modulus_mpa"), "MPa", faults);
        }
    }
}

fn exponent(value: f64, place: &str, faults: &mut Faults) {
    if !(0.0..=LARGEST_EXPONENT).contains(&value) {
        faults.error(
            place,
            format!("is {}, expected 0 to {LARGEST_EXPONENT}", Readable(value)),
        );
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
        let message = format!(
            "is {} MPa, below the pre-transition modulus {} MPa; collagen stiffens tissue",
            Readable(stiff),
            Readable(soft)
        );
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
                format!(
                    "is {}, expected 0",
                    Readable(*values.first().unwrap_or(&f64::NAN))
                ),
            );
        } else if let Some(point) = values
            .windows(2)
            .position(|pair| pair[1] < pair[0] || (key == "strain" && pair[1] == pair[0]))
        {
            let message = format!(
                "is {} after {}, expected values {what} from 0",
                Readable(values[point + 1]),
                Readable(values[point])
            );
            faults.error(format!("{} point {}", at(key), point + 1), message);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{faults, skirt, told};
    use crate::scene::{ChordLaw, SpringBranches, Tissue, Wrinkling};

    const GOOD: SpringBranches = SpringBranches {
        pre_transition_modulus_mpa: 0.1,
        transition_strain: 0.2,
        post_transition_modulus_mpa: 4.0,
    };

    fn springs(circumferential: SpringBranches, radial: SpringBranches) -> Tissue {
        Tissue::AnisotropicSprings {
            circumferential,
            radial,
            compression_modulus_ratio: 1.0,
            bending_modulus_mpa: 0.0,
        }
    }

    fn green(modulus_mpa: f64, poisson_ratio: f64) -> Tissue {
        Tissue::StVenantKirchhoff {
            modulus_mpa,
            poisson_ratio,
            wrinkling: Wrinkling::Resolved,
            bending_modulus_mpa: 0.0,
        }
    }

    fn exponential(c1_mpa: f64, c2: f64, compressibility_per_mpa: f64, bending_modulus_mpa: f64) -> Tissue {
        Tissue::Exponential {
            c0_mpa: 0.001,
            c1_mpa,
            c2,
            compressibility_per_mpa,
            wrinkling: Wrinkling::Resolved,
            bending_modulus_mpa,
        }
    }

    fn may_newman(c0_mpa: f64, c1: f64, c2: f64) -> Tissue {
        Tissue::MayNewman {
            c0_mpa,
            c1,
            c2,
            wrinkling: Wrinkling::Resolved,
            bending_modulus_mpa: 0.0,
        }
    }

    #[test]
    fn every_wrong_constant_of_tissue_is_told() {
        let soft = SpringBranches {
            pre_transition_modulus_mpa: 5.0,
            ..GOOD
        };
        let flat = SpringBranches {
            transition_strain: -0.1,
            ..GOOD
        };
        let wrongs = [
            (
                springs(soft, GOOD),
                "circumferential.post_transition",
                "below the pre-transition modulus 5",
            ),
            (springs(GOOD, flat), "radial.transition_strain", "is -0.1"),
            (green(0.0, 0.4), "modulus_mpa", "is 0 MPa"),
            (
                green(0.1, 0.6),
                "poisson_ratio",
                "is 0.6, expected above -1 and at most 0.5",
            ),
            (green(0.1, f64::NAN), "poisson_ratio", "NaN"),
            (exponential(-1.0, 4.0, 0.0, 0.0), "c1_mpa", "is -1 MPa"),
            (exponential(1.0, f64::INFINITY, 0.0, 0.0), "c2", "inf"),
            (
                exponential(1.0, 4.0, -20.0, 0.0),
                "compressibility_per_mpa",
                "is -20 1/MPa",
            ),
            (exponential(1.0, 4.0, 0.0, f64::NAN), "bending_modulus_mpa", "NaN"),
            (may_newman(0.0, 4.0, 100.0), "c0_mpa", "is 0 MPa"),
            (may_newman(1e-3, 0.0, 100.0), "c1", "is 0,"),
            (may_newman(1e-3, 4.0, 1e9), "c2", "is 1e9, expected 0 to 100000"),
        ];
        for (tissue, key, words) in wrongs {
            let mut scene = skirt();
            scene.leaflets[1].tissue = tissue;
            assert!(
                told(&faults(&scene), &format!("leaflets[1].tissue.{key}"), words),
                "{tissue:?}"
            );
        }
    }

    #[test]
    fn every_wrong_chord_law_is_told() {
        let table = |strain: &[f64], stress_mpa: &[f64]| ChordLaw::Table {
            strain: strain.to_vec(),
            stress_mpa: stress_mpa.to_vec(),
        };
        let toe = ChordLaw::PiecewiseLinear {
            toe_modulus_mpa: 3.0,
            transition_strain: 0.0,
            modulus_mpa: 30.0,
        };
        let wrongs = [
            (ChordLaw::Linear { modulus_mpa: -3.0 }, "modulus_mpa", "is -3 MPa"),
            (toe, "transition_strain", "is 0,"),
            (table(&[0.0], &[0.0]), "strain", "has 1 points"),
            (
                table(&[0.0, 0.1], &[0.0]),
                "stress_mpa",
                "has 1 entries, but there are 2 strains",
            ),
            (
                table(&[0.1, 0.2], &[0.0, 1.0]),
                "strain point 0",
                "is 0.1, expected 0",
            ),
            (
                table(&[0.0, 0.1, 0.1], &[0.0, 1.0, 2.0]),
                "strain point 2",
                "is 0.1 after 0.1, expected values rising",
            ),
            (
                table(&[0.0, 0.1, 0.2], &[0.0, 1.0, 0.5]),
                "stress_mpa point 2",
                "is 0.5 after 1, expected values nowhere falling",
            ),
            (table(&[0.0, f64::NAN], &[0.0, 1.0]), "strain point 1", "NaN"),
        ];
        for (law, key, words) in wrongs {
            let mut scene = skirt();
            scene.chordae[0].modulus_mpa = None;
            scene.chordae[0].law = Some(law.clone());
            assert!(
                told(&faults(&scene), &format!("chordae[0].law.{key}"), words),
                "{law:?}"
            );
        }
    }
}

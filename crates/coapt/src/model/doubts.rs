//! Numbers that the model takes but that look like another unit: kilopascals written as megapascals, metres as millimetres.

use std::ops::RangeInclusive;

use super::faults::Faults;
use crate::scene::{
    ChordGroup, ChordLaw, Fault, LARGEST, Leaflet, MMHG_MPA, Readable, Scene, SpringBranches, Tissue,
};

/// Modulus of tissue at rest [MPa]. Measured mitral leaflets have 0.06 to 0.09 (Krishnamurthy 2009), membranes of paper 002
/// 0.1 to 0.4, valves in general a hundredth of that: two decades about them (our choice). Ten and more are kilopascals.
const SOFT_MPA: RangeInclusive<f64> = 1e-3..=10.0;
/// Modulus of tissue whose collagen is drawn out [MPa]: 2 to 9 (Krishnamurthy 2009); in a network without a knee that of
/// tissue at rest, hence the wide lower side (our choice).
const STIFF_MPA: RangeInclusive<f64> = 1e-2..=200.0;
/// Factor of an exponential law [MPa], about a third of the modulus at rest: 0.0004 (May-Newman) to 0.001 (Mathur 2022). A
/// third of a megapascal is measured in kilopascals (our choice).
const FACTOR_MPA: RangeInclusive<f64> = 1e-5..=0.3;
/// Bending is given as that of tissue, or none.
const BENDING_MPA: RangeInclusive<f64> = 0.0..=50.0;
/// Modulus of chordae [MPa]: 21 to 33 (Kunzelman & Cochran 1990), a decade and a half about them (our choice).
const CHORD_MPA: RangeInclusive<f64> = 0.1..=1000.0;
/// The same of their toe: 0.6 to 3.
const CHORD_TOE_MPA: RangeInclusive<f64> = 1e-2..=1000.0;
/// Leaflets are half a millimetre to three thick, chordae as much; a decade about them (our choice).
const THIN_MM: RangeInclusive<f64> = 0.05..=10.0;
/// Pressures above this are taken but doubted [mmHg]: no human ventricle has been measured there; and those below, which no
/// living ventricle stays under at its peak (our choice): 13 mmHg are kilopascals. None at all is no mistake of units.
const DOUBTFUL_PRESSURE_MMHG: [f64; 2] = [30.0, 400.0];
/// Strain at which tissue stiffens [1]: 0.05 to 0.6 in valves; 25 is per cent (our choice).
const TRANSITION_STRAIN: RangeInclusive<f64> = 1e-3..=2.0;
/// A chord pulls on a patch of some millimetres; leaflets are 20 mm high (our choice).
const INSERTION_RADIUS_MM: RangeInclusive<f64> = 0.05..=8.0;
/// Contact begins where leaflets touch, at their thickness; at more than so many thicknesses something else is meant [1]: our choice.
const CONTACT_THICKNESSES: f64 = 3.0;

/// Hard valves come to rest within 1,600 iterations (docs/hard-cases.md); more than so many are none (our choice).
const MOST_ITERATIONS: u32 = 20_000;
/// Insertions are drawn within half an edge, a millimetre or two, of the leaflet; neighbours are some 5 mm apart (our choice).
const LONGEST_INSERTION_MM: f64 = 5.0;

/// What [`super::Model::build`] takes of a scene's numbers and doubts; for those who write a scene without building it.
pub fn doubts(scene: &Scene) -> Vec<Fault> {
    let mut faults = Faults::default();
    tell(scene, &mut faults);
    faults.into_warnings()
}

pub(crate) fn tell(scene: &Scene, faults: &mut Faults) {
    for (i, entry) in scene.leaflets.iter().enumerate() {
        leaflet(entry, &format!("leaflets[{i}]"), faults);
    }
    for (i, group) in scene.chordae.iter().enumerate() {
        chord_group(group, &format!("chordae[{i}]"), faults);
    }
    doubt(
        scene.contact.thickness_mm,
        &THIN_MM,
        "contact.thickness_mm",
        "mm",
        faults,
    );
    contact(scene, faults);
    pressure(scene, faults);
    let limit = scene.settings.iteration_limit;
    if limit > MOST_ITERATIONS {
        let message = format!(
            "is {limit}, expected 1 to {MOST_ITERATIONS}: what has not come to rest by then never does, and would take hours"
        );
        faults.warning("settings.iteration_limit", message);
    }
    let reach_mm = scene.weld.insertion_tolerance_mm;
    if reach_mm.is_finite() && reach_mm > LONGEST_INSERTION_MM {
        let message = format!(
            "is {} mm, expected 0 to {LONGEST_INSERTION_MM} mm: chord ends take the nearest leaflet or tip so far away",
            Readable(reach_mm)
        );
        faults.warning("weld.insertion_tolerance_mm", message);
    }
}

fn contact(scene: &Scene, faults: &mut Faults) {
    let thickest = scene
        .leaflets
        .iter()
        .map(|leaflet| leaflet.thickness_mm)
        .fold(0.0, f64::max);
    let given = scene.contact.thickness_mm;
    if thickest > 0.0 && given > CONTACT_THICKNESSES * thickest && scene.contact.is_on() {
        let message = format!(
            "is {} mm where leaflets are {} mm thick; they would stop so far from each other",
            Readable(given),
            Readable(thickest)
        );
        faults.warning("contact.thickness_mm", message);
    }
}

/// A number that could stand here but does not look like one of its unit; what cannot stand at all is told elsewhere.
fn doubt(value: f64, usual: &RangeInclusive<f64>, place: &str, unit: &str, faults: &mut Faults) {
    let possible = value > 0.0 && value <= LARGEST;
    if possible && !usual.contains(&value) {
        let message = format!(
            "is {} {unit}, expected {} to {} {unit}; check the unit",
            Readable(value),
            usual.start(),
            usual.end()
        );
        faults.warning(place, message);
    }
}

fn leaflet(leaflet: &Leaflet, place: &str, faults: &mut Faults) {
    let thickness = format!("{place}.thickness_mm");
    doubt(leaflet.thickness_mm, &THIN_MM, &thickness, "mm", faults);
    tissue(&leaflet.tissue, &format!("{place}.tissue"), faults);
}

fn tissue(tissue: &Tissue, place: &str, faults: &mut Faults) {
    let knees: &[(&str, f64)] = match tissue {
        Tissue::BilinearSprings {
            transition_strain, ..
        } => &[("transition_strain", *transition_strain)],
        Tissue::AnisotropicSprings {
            circumferential,
            radial,
            ..
        } => &[
            (
                "circumferential.transition_strain",
                circumferential.transition_strain,
            ),
            ("radial.transition_strain", radial.transition_strain),
        ],
        _ => &[],
    };
    for (key, strain) in knees {
        doubt(
            *strain,
            &TRANSITION_STRAIN,
            &format!("{place}.{key}"),
            "mm/mm",
            faults,
        );
    }
    let mut mpa = |key: &str, value: f64, usual: &RangeInclusive<f64>| {
        doubt(value, usual, &format!("{place}.{key}"), "MPa", faults);
    };
    match *tissue {
        Tissue::BilinearSprings {
            pre_transition_modulus_mpa,
            post_transition_modulus_mpa,
            ..
        } => {
            mpa(
                "pre_transition_modulus_mpa",
                pre_transition_modulus_mpa,
                &SOFT_MPA,
            );
            mpa(
                "post_transition_modulus_mpa",
                post_transition_modulus_mpa,
                &STIFF_MPA,
            );
        }
        Tissue::AnisotropicSprings {
            circumferential,
            radial,
            bending_modulus_mpa,
            ..
        } => {
            for (direction, springs) in [("circumferential", circumferential), ("radial", radial)] {
                let SpringBranches {
                    pre_transition_modulus_mpa: soft,
                    post_transition_modulus_mpa: stiff,
                    ..
                } = springs;
                mpa(
                    &format!("{direction}.pre_transition_modulus_mpa"),
                    soft,
                    &SOFT_MPA,
                );
                mpa(
                    &format!("{direction}.post_transition_modulus_mpa"),
                    stiff,
                    &STIFF_MPA,
                );
            }
            mpa("bending_modulus_mpa", bending_modulus_mpa, &BENDING_MPA);
        }
        Tissue::StVenantKirchhoff {
            modulus_mpa,
            bending_modulus_mpa,
            ..
        } => {
            mpa("modulus_mpa", modulus_mpa, &SOFT_MPA);
            mpa("bending_modulus_mpa", bending_modulus_mpa, &BENDING_MPA);
        }
        Tissue::Exponential {
            c0_mpa,
            bending_modulus_mpa,
            ..
        }
        | Tissue::MayNewman {
            c0_mpa,
            bending_modulus_mpa,
            ..
        } => {
            mpa("c0_mpa", c0_mpa, &FACTOR_MPA);
            mpa("bending_modulus_mpa", bending_modulus_mpa, &BENDING_MPA);
        }
    }
}

fn chord_group(group: &ChordGroup, place: &str, faults: &mut Faults) {
    doubt(
        group.diameter_mm,
        &THIN_MM,
        &format!("{place}.diameter_mm"),
        "mm",
        faults,
    );
    let radius = format!("{place}.insertion_radius_mm");
    doubt(
        group.insertion_radius_mm,
        &INSERTION_RADIUS_MM,
        &radius,
        "mm",
        faults,
    );
    let mut mpa = |key: &str, value: f64, usual: &RangeInclusive<f64>| {
        doubt(value, usual, &format!("{place}.{key}"), "MPa", faults);
    };
    if let Some(modulus_mpa) = group.modulus_mpa {
        mpa("modulus_mpa", modulus_mpa, &CHORD_MPA);
    }
    match group.law {
        Some(ChordLaw::Linear { modulus_mpa } | ChordLaw::Collagen { modulus_mpa, .. }) => {
            mpa("law.modulus_mpa", modulus_mpa, &CHORD_MPA);
        }
        Some(ChordLaw::PiecewiseLinear {
            toe_modulus_mpa,
            modulus_mpa,
            ..
        }) => {
            mpa("law.toe_modulus_mpa", toe_modulus_mpa, &CHORD_TOE_MPA);
            mpa("law.modulus_mpa", modulus_mpa, &CHORD_MPA);
        }
        // Their numbers are no moduli.
        Some(ChordLaw::Exponential { .. } | ChordLaw::Table { .. }) | None => {}
    }
}

fn pressure(scene: &Scene, faults: &mut Faults) {
    let Some(pressure_mpa) = scene.load.pressure_mpa() else {
        return;
    };
    let mmhg = pressure_mpa / MMHG_MPA;
    let (place, given) = match scene.load.pressure_kpa {
        Some(kpa) => (
            "load.pressure_kpa",
            format!("{} kPa = {:.0} mmHg", Readable(kpa), Readable(mmhg)),
        ),
        None => ("load.pressure_mmhg", format!("{:.0} mmHg", Readable(mmhg))),
    };
    let [low, high] = DOUBTFUL_PRESSURE_MMHG;
    if mmhg > high {
        let message = format!("is {given}, expected below {high} mmHg; check the unit");
        faults.warning(place, message);
    } else if mmhg > 0.0 && mmhg < low {
        let message = format!("is {given}, expected above {low} mmHg at peak systole; check the unit");
        faults.warning(place, message);
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{built, skirt, told};
    use super::*;
    use crate::scene::{Load, Wrinkling};

    fn scene(spoil: impl Fn(&mut Scene)) -> Scene {
        let mut scene = skirt();
        spoil(&mut scene);
        scene
    }

    #[test]
    fn wrong_units_are_taken_and_doubted() {
        let green = |modulus_mpa| Tissue::StVenantKirchhoff {
            modulus_mpa,
            poisson_ratio: 0.45,
            wrinkling: Wrinkling::Resolved,
            bending_modulus_mpa: 0.0,
        };
        let toe = ChordLaw::PiecewiseLinear {
            toe_modulus_mpa: 3060.0,
            transition_strain: 0.025,
            modulus_mpa: 33.4,
        };
        let doubted: [(Scene, &str, &str); 7] = [
            (
                scene(|s| s.leaflets[0].tissue = green(400.0)),
                "leaflets[0].tissue.modulus_mpa",
                "is 400 MPa, expected 0.001 to 10 MPa; check the unit",
            ),
            (
                scene(|s| s.leaflets[1].tissue = green(4e-4)),
                "leaflets[1].tissue.modulus_mpa",
                "is 0.0004 MPa",
            ),
            (
                scene(|s| s.leaflets[0].thickness_mm = 0.001),
                "leaflets[0].thickness_mm",
                "is 0.001 mm, expected 0.05 to 10 mm",
            ),
            (
                scene(|s| s.chordae[0].modulus_mpa = Some(3e4)),
                "chordae[0].modulus_mpa",
                "is 30000 MPa",
            ),
            (
                scene(|s| {
                    s.chordae[0].modulus_mpa = None;
                    s.chordae[0].law = Some(toe.clone());
                }),
                "chordae[0].law.toe_modulus_mpa",
                "is 3060 MPa",
            ),
            (
                scene(|s| s.load = Load::mmhg(500.0)),
                "load.pressure_mmhg",
                "is 500 mmHg, expected below 400 mmHg",
            ),
            (
                scene(|s| {
                    s.load = Load {
                        pressure_mmhg: None,
                        pressure_kpa: Some(120.0),
                    }
                }),
                "load.pressure_kpa",
                "is 120 kPa = 900 mmHg",
            ),
        ];
        for (scene, place, words) in doubted {
            assert!(told(&built(&scene).warnings, place, words), "{place}");
            assert!(told(&doubts(&scene), place, words), "{place}");
        }
        assert_eq!(doubts(&skirt()), []);
    }
}

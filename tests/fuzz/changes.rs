//! Changes of a small good valve.

use arbitrary::Arbitrary;
use coapt::Vec3;
use coapt::scene::{ChordLaw, Scene, Tissue, Wrinkling};

/// A part of a range, from all of it one way to all of it the other.
type Part = i16;

/// One thing that is made different in a scene. Numbers choose among what there is, whatever they are.
#[derive(Arbitrary, Debug)]
pub(crate) enum Change {
    Point {
        leaflet: u8,
        point: u8,
        by: [Part; 3],
        far: bool,
    },
    SamePoint {
        leaflet: u8,
        point: u8,
        other: u8,
    },
    AnnulusMotion {
        leaflet: u8,
        point: u8,
        by: [Part; 3],
    },
    Tip {
        muscle: u8,
        tip: u8,
        by: [Part; 3],
    },
    TipMotion {
        muscle: u8,
        by: [Part; 3],
    },
    ChordPoint {
        point: u8,
        by: [Part; 3],
    },
    NoChord {
        segment: u8,
    },
    NoChordae,
    NoFace {
        leaflet: u8,
        face: u8,
    },
    Tissue {
        leaflet: u8,
        law: u8,
        factors: [i8; 4],
        tension_field: bool,
    },
    ChordLaw {
        group: u8,
        law: u8,
        factors: [i8; 4],
    },
    Number {
        which: u8,
        factor: i8,
    },
    OneLevel,
    NoContact,
    NoPressure,
}

/// Makes a change.
pub(crate) fn make(scene: &mut Scene, change: &Change) {
    match *change {
        Change::Point {
            leaflet,
            point,
            by,
            far,
        } => {
            let range_mm = if far { 50.0 } else { 2.0 };
            if let Some(point) = leaflet_point(scene, leaflet, point) {
                *point = moved(*point, by, range_mm);
            }
        }
        Change::SamePoint {
            leaflet,
            point,
            other,
        } => {
            if let Some(&mut place) = leaflet_point(scene, leaflet, other) {
                leaflet_point(scene, leaflet, point)
                    .into_iter()
                    .for_each(|point| *point = place);
            }
        }
        Change::AnnulusMotion { leaflet, point, by } => {
            let Some(mesh) = pick(&mut scene.leaflets, leaflet).and_then(|leaflet| leaflet.mesh.as_mut())
            else {
                return;
            };
            let count = mesh.points_mm.len();
            let motion = mesh
                .annulus_displacement_mm
                .get_or_insert_with(|| vec![[0.0; 3]; count]);
            pick(motion, point)
                .into_iter()
                .for_each(|way| *way = moved(*way, by, 10.0));
        }
        Change::Tip { muscle, tip, by } => {
            let muscle = pick(&mut scene.papillary, muscle);
            let tip = muscle.and_then(|muscle| pick(&mut muscle.tips_mm, tip));
            tip.into_iter().for_each(|tip| *tip = moved(*tip, by, 20.0));
        }
        Change::TipMotion { muscle, by } => {
            if let Some(muscle) = pick(&mut scene.papillary, muscle) {
                muscle.displacements_mm = vec![moved([0.0; 3], by, 20.0); muscle.tips_mm.len()];
            }
        }
        Change::ChordPoint { point, by } => {
            let mesh = scene.chordae.first_mut().and_then(|group| group.mesh.as_mut());
            let point = mesh.and_then(|mesh| pick(&mut mesh.points_mm, point));
            point
                .into_iter()
                .for_each(|point| *point = moved(*point, by, 5.0));
        }
        Change::NoChord { segment } => {
            let mesh = scene.chordae.first_mut().and_then(|group| group.mesh.as_mut());
            if let Some(mesh) = mesh.filter(|mesh| !mesh.segments.is_empty()) {
                let number = usize::from(segment) % mesh.segments.len();
                mesh.segments.remove(number);
                let values = [&mut mesh.rest_length_mm, &mut mesh.area_mm2];
                values.into_iter().flatten().for_each(|values| {
                    values.remove(number);
                });
            }
        }
        Change::NoChordae => scene.chordae.clear(),
        Change::NoFace { leaflet, face } => {
            let mesh = pick(&mut scene.leaflets, leaflet).and_then(|leaflet| leaflet.mesh.as_mut());
            if let Some(mesh) = mesh.filter(|mesh| mesh.faces.len() > 1) {
                mesh.faces.remove(usize::from(face) % mesh.faces.len());
            }
        }
        Change::Tissue {
            leaflet,
            law,
            factors,
            tension_field,
        } => {
            let leaflet = pick(&mut scene.leaflets, leaflet);
            leaflet
                .into_iter()
                .for_each(|leaflet| leaflet.tissue = tissue(law, factors, tension_field));
        }
        Change::ChordLaw { group, law, factors } => {
            let group = pick(&mut scene.chordae, group);
            group
                .into_iter()
                .for_each(|group| group.law = Some(chord_law(law, factors)));
        }
        Change::Number { which, factor } => scale(scene, which, power(factor)),
        Change::OneLevel => scene.settings.coarse_to_fine = false,
        Change::NoContact => scene.contact.stiffness_mpa = 0.0,
        Change::NoPressure => scene.load.pressure_mmhg = Some(0.0),
    }
}

fn pick<T>(items: &mut [T], number: u8) -> Option<&mut T> {
    let count = items.len().max(1);
    items.get_mut(usize::from(number) % count)
}

fn leaflet_point(scene: &mut Scene, leaflet: u8, point: u8) -> Option<&mut [f64; 3]> {
    let mesh = pick(&mut scene.leaflets, leaflet)?.mesh.as_mut()?;
    pick(&mut mesh.points_mm, point)
}

fn moved(point: [f64; 3], by: [Part; 3], range_mm: f64) -> [f64; 3] {
    let way = by.map(|part| f64::from(part) / f64::from(Part::MAX) * range_mm);
    (Vec3::from(point) + Vec3::from(way)).into()
}

/// From 1e-8 to 1e8, one at 0.
fn power(exponent: i8) -> f64 {
    10_f64.powf(f64::from(exponent) / 16.0)
}

fn scale(scene: &mut Scene, which: u8, factor: f64) {
    let number = match which % 11 {
        0 => {
            return scene
                .load
                .pressure_mmhg
                .iter_mut()
                .for_each(|pressure| *pressure *= factor);
        }
        1 => {
            return scene
                .leaflets
                .iter_mut()
                .for_each(|leaflet| leaflet.thickness_mm *= factor);
        }
        2 => {
            return scene
                .chordae
                .iter_mut()
                .for_each(|group| group.modulus_mpa = Some(30.0 * factor));
        }
        3 => {
            return scene
                .chordae
                .iter_mut()
                .for_each(|group| group.diameter_mm *= factor);
        }
        4 => {
            return scene
                .chordae
                .iter_mut()
                .for_each(|group| group.rest_length_scale *= factor.powf(0.125));
        }
        5 => {
            return scene
                .chordae
                .iter_mut()
                .for_each(|group| group.insertion_radius_mm *= factor.powf(0.25));
        }
        6 => &mut scene.contact.thickness_mm,
        7 => &mut scene.contact.stiffness_mpa,
        8 => &mut scene.weld.tolerance_mm,
        9 => &mut scene.settings.residual_tolerance,
        _ => &mut scene.settings.step_scale,
    };
    *number *= factor;
}

fn tissue(law: u8, factors: [i8; 4], tension_field: bool) -> Tissue {
    let [a, b, c, d] = factors.map(power);
    let wrinkling = if tension_field {
        Wrinkling::TensionField
    } else {
        Wrinkling::default()
    };
    let bending_modulus_mpa = 0.1 * d;
    match law % 4 {
        0 => Tissue::BilinearSprings {
            pre_transition_modulus_mpa: 0.1 * a,
            transition_strain: 0.25 * b,
            post_transition_modulus_mpa: 4.0 * c,
            compression_modulus_ratio: d,
            bending_modulus_ratio: d,
        },
        1 => Tissue::StVenantKirchhoff {
            modulus_mpa: a,
            poisson_ratio: 0.3,
            wrinkling,
            bending_modulus_mpa,
        },
        2 => Tissue::Exponential {
            c0_mpa: 1e-3 * a,
            c1_mpa: 1e-4 * b,
            c2: 10.0 * c,
            compressibility_per_mpa: if tension_field { 0.0 } else { d },
            wrinkling,
            bending_modulus_mpa,
        },
        _ => Tissue::MayNewman {
            c0_mpa: 4e-4 * a,
            c1: 4.0 * b,
            c2: 1000.0 * c,
            wrinkling,
            bending_modulus_mpa,
        },
    }
}

fn chord_law(law: u8, factors: [i8; 4]) -> ChordLaw {
    let [a, b, c, d] = factors.map(power);
    match law % 4 {
        0 => ChordLaw::Linear {
            modulus_mpa: 30.0 * a,
        },
        1 => ChordLaw::PiecewiseLinear {
            toe_modulus_mpa: a,
            transition_strain: 0.025 * b,
            modulus_mpa: 30.0 * c,
        },
        2 => ChordLaw::Exponential {
            scale_mpa: 1e-3 * a,
            exponent: 40.0 * b,
        },
        _ => ChordLaw::Collagen {
            scale_mpa: 5e-4 * a,
            exponent: 50.0 * b,
            full_recruitment_strain: 0.145 * c,
            modulus_mpa: 32.5 * d,
        },
    }
}

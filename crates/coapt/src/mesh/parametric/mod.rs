//! The parametric mitral valve: a scene from a few dozen numbers.
//!
//! ```text
//! ValveParameters --annulus--> curve --surface--> open leaflets --skirt, improve--> triangles --> Scene
//!                                                \--closed_shape--> chord rest lengths ---------/
//! ```
//!
//! The annulus is a saddle-shaped D, the leaflets hang from it as one funnel, and the chordae are as long as
//! a target closed shape needs them (the rule of paper 003, which takes them from the image of the closed
//! valve). Axes are LPS, as in medical images, of a heart that stands upright: +x to the anterolateral commissure
//! (the patient's left), +y posterior, +z to the atrium (superior). Seen from the atrium the annulus runs clockwise
//! from the anterolateral commissure over the anterior leaflet to the posteromedial one, as in a human heart.

mod annulus;
mod check;
mod chordae;
mod closed_shape;
mod improve;
mod parameters;
mod presets;
mod skirt;
mod surface;

pub use parameters::{
    AnnulusDimensions, ChordPattern, ClosedShapeTarget, LeafletDimensions, PapillaryPositions,
    ValveParameters,
};
pub use presets::Preset;

use self::annulus::{AnnulusCurve, Side};
use self::skirt::{Place, Sheet};
use self::surface::Surface;
use crate::Vec3;
use crate::scene::{
    Annulus, Contact, Fault, Landmarks, Leaflet, Load, PapillaryMuscle, SCHEMA_VERSION, Scene, Settings,
    Space, SurfaceMesh, Weld,
};

/// Makes a valve: leaflets `anterior` and `posterior` that share the points of both commissures, papillary
/// muscles `anterolateral` and `posteromedial`, chord groups `marginal`, `intermediate`, `basal` and `strut`.
///
/// The same parameters give the same bytes.
///
/// # Errors
///
/// Every parameter outside its range, by key, value and range; or leaflets that cannot hang open in this
/// annulus; or jitter of about half an edge or more.
pub fn generate(parameters: &ValveParameters) -> Result<Scene, Vec<Fault>> {
    let faults = check::faults(parameters);
    if !faults.is_empty() {
        return Err(faults);
    }
    let surface = Surface::new(parameters);
    if let Some(fault) = check::fold_fault(parameters, &surface) {
        return Err(vec![fault]);
    }
    let mut sheet = skirt::sheet(&surface, parameters.face_count_target);
    if let Some(fault) = check::jitter_fault(parameters, &sheet) {
        return Err(vec![fault]);
    }
    jitter(&mut sheet, parameters.jitter_mm, parameters.jitter_seed);
    let heads = chordae::heads(&parameters.papillary).now_mm;
    Ok(Scene {
        schema_version: SCHEMA_VERSION,
        name: parameters.name.clone(),
        space: Space::default(),
        leaflets: leaflets(parameters, &sheet),
        annulus: Annulus::default(),
        papillary: vec![
            muscle("anterolateral", heads[0]),
            muscle("posteromedial", heads[1]),
        ],
        chordae: chordae::chord_groups(parameters, &surface),
        load: Load::mmhg(parameters.pressure_mmhg),
        contact: Contact::default(),
        landmarks: landmarks(&surface.annulus),
        // Leaflets and tips coincide exactly; a micrometre leaves room for rounding in text files. Chordae end on the
        // smooth surface, which the mesh leaves by the sagitta of an edge and by the jitter.
        weld: Weld {
            tolerance_mm: 1e-3,
            ..Weld::default()
        },
        settings: Settings::default(),
    })
}

fn leaflets(parameters: &ValveParameters, sheet: &Sheet) -> Vec<Leaflet> {
    [("anterior", Side::Anterior), ("posterior", Side::Posterior)]
        .into_iter()
        .map(|(name, side)| Leaflet {
            name: name.into(),
            mesh_file: None,
            region: None,
            mesh: Some(part(sheet, side)),
            thickness_mm: parameters.leaflets.thickness_mm,
            tissue: parameters.leaflets.tissue,
        })
        .collect()
}

/// One leaflet of the sheet, its points renumbered in their order.
fn part(sheet: &Sheet, side: Side) -> SurfaceMesh {
    let own = || {
        sheet
            .faces
            .iter()
            .zip(&sheet.sides)
            .filter(|(_, s)| **s == side)
            .map(|(face, _)| face)
    };
    let mut number = vec![u32::MAX; sheet.points_mm.len()];
    for &vertex in own().flatten() {
        number[vertex as usize] = 0;
    }
    let used: Vec<usize> = (0..number.len()).filter(|&v| number[v] == 0).collect();
    for (new, &old) in used.iter().enumerate() {
        number[old] = new as u32;
    }
    let on_annulus = used.iter().filter(|&&v| sheet.place[v] == Place::Annulus);
    SurfaceMesh {
        points_mm: used.iter().map(|&v| sheet.points_mm[v].into()).collect(),
        faces: own().map(|face| face.map(|v| number[v as usize])).collect(),
        annulus_points: Some(on_annulus.map(|&v| number[v]).collect()),
        annulus_displacement_mm: None,
    }
}

fn muscle(name: &str, heads: [Vec3; 3]) -> PapillaryMuscle {
    PapillaryMuscle {
        name: name.into(),
        tips_mm: heads.iter().map(|&head| head.into()).collect(),
        tips_file: None,
        displacements_mm: Vec::new(),
    }
}

fn landmarks(annulus: &AnnulusCurve) -> Landmarks {
    let [left, right] = annulus.trigones();
    Landmarks {
        mid_anterior_mm: Some(annulus.at(Side::Anterior, 0.5).into()),
        mid_posterior_mm: Some(annulus.at(Side::Posterior, 0.5).into()),
        commissure_anterolateral_mm: Some(annulus.at(Side::Anterior, 0.0).into()),
        commissure_posteromedial_mm: Some(annulus.at(Side::Anterior, 1.0).into()),
        trigone_left_mm: Some(left.into()),
        trigone_right_mm: Some(right.into()),
    }
}

/// Moves every vertex off the annulus, evenly within a ball.
fn jitter(sheet: &mut Sheet, radius_mm: f64, seed: u64) {
    if radius_mm == 0.0 {
        return;
    }
    let mut state = seed;
    for (point, place) in sheet.points_mm.iter_mut().zip(&sheet.place) {
        if *place != Place::Annulus {
            *point += in_unit_ball(&mut state) * radius_mm;
        }
    }
}

fn in_unit_ball(state: &mut u64) -> Vec3 {
    loop {
        let point = Vec3::from_fn(|_, _| 2.0 * unit(state) - 1.0);
        if point.norm_squared() <= 1.0 {
            return point;
        }
    }
}

/// The `SplitMix64` generator (Steele, Lea & Flood 2014), as a number in [0, 1).
fn unit(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests;

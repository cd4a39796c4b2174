//! Which parameters make a valve: one fault for each that does not.

use super::parameters::{AnnulusDimensions, ValveParameters};
use super::skirt::Sheet;
use super::surface::Surface;
use crate::scene::{Fault, LARGEST, Readable, Tissue};

/// A number by its key, with the smallest and the largest value that is accepted.
type Bound = (String, f64, f64, f64);

/// Faults of all parameters; none for a valve that can be generated.
pub(super) fn faults(parameters: &ValveParameters) -> Vec<Fault> {
    let mut bounds = general_bounds(parameters);
    bounds.extend(annulus_bounds("annulus", &parameters.annulus));
    if let Some(annulus) = &parameters.chordae.rest_annulus {
        bounds.extend(annulus_bounds("chordae.rest_annulus", annulus));
    }
    bounds.extend(leaflet_bounds(parameters));
    bounds.extend(papillary_bounds(parameters));
    bounds.extend(chord_bounds(parameters));
    let outside = |(_, value, low, high): &Bound| !(value.is_finite() && (*low..=*high).contains(value));
    let mut faults: Vec<Fault> = bounds
        .into_iter()
        .filter(outside)
        .map(|(key, value, low, high)| {
            Fault::error(
                &key,
                format!(
                    "{key} is {}; expected a number from {low} to {high}",
                    Readable(value)
                ),
            )
        })
        .collect();
    let annuli = [
        ("annulus", Some(&parameters.annulus)),
        ("chordae.rest_annulus", parameters.chordae.rest_annulus.as_ref()),
    ];
    for (key, annulus) in annuli
        .into_iter()
        .filter_map(|(key, annulus)| Some((key, annulus?)))
    {
        if annulus.trigone_half_angle_deg >= annulus.commissure_half_angle_deg {
            faults.push(Fault::error(
                format!("{key}.trigone_half_angle_deg"),
                format!(
                    "{key}.trigone_half_angle_deg is {}; expected less than commissure_half_angle_deg, which is {}",
                    Readable(annulus.trigone_half_angle_deg), Readable(annulus.commissure_half_angle_deg)
                ),
            ));
        }
    }
    faults
}

/// A fault where the leaflets are too long to hang open inside the annulus.
pub(super) fn fold_fault(parameters: &ValveParameters, surface: &Surface) -> Option<Fault> {
    // Beyond nine tenths of the way to the middle the two sides of the funnel all but touch.
    let share = (0..360)
        .map(|i| surface.inward_share(surface.annulus.length_mm * f64::from(i) / 360.0))
        .fold(0.0, |most: f64, share| {
            if share.is_finite() {
                most.max(share)
            } else {
                f64::INFINITY
            }
        });
    (share > 0.9).then(|| {
        Fault::error(
            "leaflets.opening_angle_deg",
            format!(
                "leaflets.opening_angle_deg is {} with leaflets.height_scale {}: the open leaflets reach {share:.2} of \
                 the way across the orifice; expected at most 0.9, that is a smaller angle or lower leaflets",
                parameters.leaflets.opening_angle_deg, parameters.leaflets.height_scale
            ),
        )
    })
}

/// Points may be moved by this part of a mean edge [1]. Of 180 valves (all presets at 300, 650 and 2600 faces) with 0.46 none
/// had faces that cross beyond mending; with 0.48 two had, with 0.5 five.
const LARGEST_JITTER: f64 = 0.45;

/// A fault where points are to be moved so far that no valve is left, or by no distance.
pub(super) fn jitter_fault(parameters: &ValveParameters, sheet: &Sheet) -> Option<Fault> {
    let length_mm = |[a, b]: [u32; 2]| (sheet.points_mm[a as usize] - sheet.points_mm[b as usize]).norm();
    let sides = sheet.faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let edge_mm = sides.map(length_mm).sum::<f64>() / (3 * sheet.faces.len()) as f64;
    // To hundredths, down: the value that is told is taken.
    let most_mm = (LARGEST_JITTER * edge_mm * 100.0).floor() / 100.0;
    (!(0.0..=most_mm).contains(&parameters.jitter_mm)).then(|| {
        Fault::error(
            "jitter_mm",
            format!(
                "jitter_mm is {}; expected a number from 0 to {most_mm:.2}, {LARGEST_JITTER} of a mean edge of this mesh",
                Readable(parameters.jitter_mm)
            ),
        )
    })
}

fn general_bounds(p: &ValveParameters) -> Vec<Bound> {
    let closed = &p.closed_shape;
    named(
        "",
        &[
            ("face_count_target", f64::from(p.face_count_target), 100.0, 1e6),
            ("pressure_mmhg", p.pressure_mmhg, 0.0, LARGEST),
            (
                "closed_shape.closure_line_fraction",
                closed.closure_line_fraction,
                0.1,
                0.9,
            ),
            (
                "closed_shape.tenting_height_mm",
                closed.tenting_height_mm,
                -10.0,
                20.0,
            ),
            (
                "closed_shape.coaptation_length_mm",
                closed.coaptation_length_mm,
                0.0,
                20.0,
            ),
            (
                "closed_shape.commissural_coaptation_length_mm",
                closed.commissural_coaptation_length_mm,
                0.0,
                20.0,
            ),
            ("closed_shape.belly_fraction", closed.belly_fraction, -0.3, 0.3),
        ],
    )
}

fn annulus_bounds(prefix: &str, annulus: &AnnulusDimensions) -> Vec<Bound> {
    named(
        &format!("{prefix}."),
        &[
            ("transverse_mm", annulus.transverse_mm, 5.0, 100.0),
            ("anteroposterior_mm", annulus.anteroposterior_mm, 5.0, 100.0),
            ("anterior_fraction", annulus.anterior_fraction, 0.2, 0.8),
            ("anterior_height_mm", annulus.anterior_height_mm, 0.0, 30.0),
            ("posterior_height_mm", annulus.posterior_height_mm, 0.0, 30.0),
            (
                "commissure_half_angle_deg",
                annulus.commissure_half_angle_deg,
                30.0,
                120.0,
            ),
            (
                "trigone_half_angle_deg",
                annulus.trigone_half_angle_deg,
                5.0,
                90.0,
            ),
        ],
    )
}

/// Of springs, which presets are made of; other laws are checked when the model is built.
fn tissue_bounds(tissue: &Tissue) -> Vec<Bound> {
    let Tissue::BilinearSprings {
        pre_transition_modulus_mpa: soft,
        transition_strain,
        post_transition_modulus_mpa: stiff,
        compression_modulus_ratio,
        bending_modulus_ratio,
    } = *tissue
    else {
        return Vec::new();
    };
    named(
        "leaflets.tissue.",
        &[
            ("pre_transition_modulus_mpa", soft, 1e-6, 1e4),
            ("transition_strain", transition_strain, 0.0, 2.0),
            ("post_transition_modulus_mpa", stiff, 1e-6, 1e4),
            ("compression_modulus_ratio", compression_modulus_ratio, 0.0, 10.0),
            ("bending_modulus_ratio", bending_modulus_ratio, 0.0, 1e3),
        ],
    )
}

fn leaflet_bounds(p: &ValveParameters) -> Vec<Bound> {
    let l = &p.leaflets;
    let mut bounds = named(
        "leaflets.",
        &[
            ("commissure_height_mm", l.commissure_height_mm, 0.5, 60.0),
            ("height_scale", l.height_scale, 0.1, 5.0),
            ("indentation_depth", l.indentation_depth, 0.0, 0.6),
            ("indentation_width_mm", l.indentation_width_mm, 0.1, 30.0),
            ("opening_angle_deg", l.opening_angle_deg, -30.0, 80.0),
            ("annular_turn_deg", l.annular_turn_deg, -60.0, 90.0),
            ("thickness_mm", l.thickness_mm, 0.01, 20.0),
        ],
    );
    bounds.extend(tissue_bounds(&l.tissue));
    bounds.extend(components(
        "leaflets.anterior_heights_mm",
        l.anterior_heights_mm,
        0.5,
        60.0,
    ));
    bounds.extend(components(
        "leaflets.posterior_heights_mm",
        l.posterior_heights_mm,
        0.5,
        60.0,
    ));
    bounds
}

fn papillary_bounds(p: &ValveParameters) -> Vec<Bound> {
    let papillary = &p.papillary;
    let mut bounds = named(
        "papillary.",
        &[("head_spread_mm", papillary.head_spread_mm, 0.0, 20.0)],
    );
    for (key, point) in [
        ("papillary.anterolateral_mm", papillary.anterolateral_mm),
        ("papillary.posteromedial_mm", papillary.posteromedial_mm),
        (
            "papillary.anterolateral_shift_mm",
            papillary.anterolateral_shift_mm,
        ),
        (
            "papillary.posteromedial_shift_mm",
            papillary.posteromedial_shift_mm,
        ),
    ] {
        bounds.extend(components(key, point, -100.0, 100.0));
    }
    bounds
}

fn chord_bounds(p: &ValveParameters) -> Vec<Bound> {
    let chordae = &p.chordae;
    named(
        "chordae.",
        &[
            (
                "marginal_anterior",
                f64::from(chordae.marginal_anterior),
                0.0,
                200.0,
            ),
            (
                "marginal_posterior",
                f64::from(chordae.marginal_posterior),
                0.0,
                200.0,
            ),
            (
                "intermediate_per_leaflet",
                f64::from(chordae.intermediate_per_leaflet),
                0.0,
                200.0,
            ),
            ("basal_posterior", f64::from(chordae.basal_posterior), 0.0, 200.0),
            ("branches", f64::from(chordae.branches), 1.0, 10.0),
            ("branch_position", chordae.branch_position, 0.05, 0.95),
            ("closed_strain", chordae.closed_strain, -0.5, 0.5),
            ("rest_length_scale", chordae.rest_length_scale, 0.1, 5.0),
            (
                "ruptured_posterior_fraction",
                chordae.ruptured_posterior_fraction,
                0.0,
                1.0,
            ),
            ("marginal_diameter_mm", chordae.marginal_diameter_mm, 0.01, 10.0),
            ("marginal_modulus_mpa", chordae.marginal_modulus_mpa, 1e-3, 1e5),
            ("basal_diameter_mm", chordae.basal_diameter_mm, 0.01, 10.0),
            ("basal_modulus_mpa", chordae.basal_modulus_mpa, 1e-3, 1e5),
        ],
    )
}

fn named(prefix: &str, bounds: &[(&str, f64, f64, f64)]) -> Vec<Bound> {
    bounds
        .iter()
        .map(|&(key, value, low, high)| (format!("{prefix}{key}"), value, low, high))
        .collect()
}

fn components(key: &str, values: [f64; 3], low: f64, high: f64) -> Vec<Bound> {
    (0..3)
        .map(|i| (format!("{key}[{i}]"), values[i], low, high))
        .collect()
}

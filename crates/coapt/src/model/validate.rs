//! Every entry of a scene, looked at on its own: present, finite, in range.

use super::faults::Faults;
use super::validate_numbers::{lines, not_negative, points, positive, same_count, surface};
use super::{doubts, names, validate_tissue};
use crate::scene::{Annulus, ChordGroup, Leaflet, PapillaryMuscle, Readable, SCHEMA_VERSION, Scene};

pub(crate) fn scene(scene: &Scene, faults: &mut Faults) {
    if scene.schema_version != SCHEMA_VERSION {
        let message = format!(
            "{} is unknown, this version reads {SCHEMA_VERSION}",
            scene.schema_version
        );
        faults.error("schema_version", message);
    }
    if scene.leaflets.is_empty() {
        faults.error("leaflets", "there are none, expected at least one");
    }
    for (i, entry) in scene.leaflets.iter().enumerate() {
        leaflet(entry, &format!("leaflets[{i}]"), faults);
    }
    names::tell_shared(scene, faults);
    annulus(&scene.annulus, faults);
    for (i, muscle) in scene.papillary.iter().enumerate() {
        papillary(muscle, &format!("papillary[{i}]"), faults);
    }
    for (i, group) in scene.chordae.iter().enumerate() {
        chord_group(group, &format!("chordae[{i}]"), faults);
    }
    pressure(scene, faults);
    settings(scene, faults);
    landmarks(scene, faults);
    doubts::tell(scene, faults);
}

fn leaflet(leaflet: &Leaflet, place: &str, faults: &mut Faults) {
    positive(
        leaflet.thickness_mm,
        &format!("{place}.thickness_mm"),
        "mm",
        faults,
    );
    validate_tissue::tissue(&leaflet.tissue, &format!("{place}.tissue"), faults);
    match &leaflet.mesh {
        Some(mesh) => surface(mesh, &format!("{place}.mesh"), faults),
        None => faults.error(
            format!("{place}.mesh"),
            missing(leaflet.mesh_file.as_deref(), "mesh_file"),
        ),
    }
}

fn missing(file: Option<&str>, key: &str) -> String {
    match file {
        Some(file) => format!("`{file}` has not been read into the scene"),
        None => format!("is absent; give it here or name a `{key}`"),
    }
}

fn annulus(annulus: &Annulus, faults: &mut Faults) {
    if let Some(tolerance) = annulus.curve_tolerance_mm {
        positive(tolerance, "annulus.curve_tolerance_mm", "mm", faults);
    }
    match (&annulus.curve_mm, &annulus.curve_file) {
        (Some(curve), _) => {
            points(curve, "annulus.curve_mm", "point", faults);
            if curve.len() < 3 {
                let message = format!("has {} points, expected a closed curve of 3 or more", curve.len());
                faults.error("annulus.curve_mm", message);
            }
        }
        (None, Some(file)) => faults.error("annulus.curve_file", missing(Some(file), "")),
        (None, None) => {}
    }
}

fn papillary(muscle: &PapillaryMuscle, place: &str, faults: &mut Faults) {
    if muscle.tips_mm.is_empty() {
        faults.error(
            format!("{place}.tips_mm"),
            missing(muscle.tips_file.as_deref(), "tips_file"),
        );
    }
    points(&muscle.tips_mm, &format!("{place}.tips_mm"), "tip", faults);
    points(
        &muscle.displacements_mm,
        &format!("{place}.displacements_mm"),
        "tip",
        faults,
    );
    if !muscle.displacements_mm.is_empty() {
        let place = format!("{place}.displacements_mm");
        same_count(
            muscle.displacements_mm.len(),
            muscle.tips_mm.len(),
            &place,
            "tips",
            faults,
        );
    }
}

fn chord_group(group: &ChordGroup, place: &str, faults: &mut Faults) {
    positive(group.diameter_mm, &format!("{place}.diameter_mm"), "mm", faults);
    if let Some(modulus_mpa) = group.modulus_mpa {
        let place = format!("{place}.modulus_mpa");
        positive(modulus_mpa, &place, "MPa", faults);
        if group.law.is_some() {
            faults.error(place, "is given beside `law`; expected one of the two");
        }
    }
    if let Some(law) = &group.law {
        validate_tissue::chord_law(law, &format!("{place}.law"), faults);
    }
    positive(
        group.rest_length_scale,
        &format!("{place}.rest_length_scale"),
        "",
        faults,
    );
    not_negative(
        group.insertion_radius_mm,
        &format!("{place}.insertion_radius_mm"),
        "mm",
        faults,
    );
    match &group.mesh {
        Some(mesh) => lines(mesh, &format!("{place}.mesh"), faults),
        None => faults.error(
            format!("{place}.mesh"),
            missing(group.mesh_file.as_deref(), "mesh_file"),
        ),
    }
}

fn pressure(scene: &Scene, faults: &mut Faults) {
    let (place, unit, pressure) = match (scene.load.pressure_mmhg, scene.load.pressure_kpa) {
        (Some(mmhg), None) => ("load.pressure_mmhg", "mmHg", mmhg),
        (None, Some(kpa)) => ("load.pressure_kpa", "kPa", kpa),
        (Some(_), Some(_)) => {
            return faults.error("load", "has a pressure in mmHg and in kPa, expected one of them");
        }
        (None, None) => {
            return faults.error(
                "load",
                "has no pressure, expected `pressure_mmhg` or `pressure_kpa`",
            );
        }
    };
    not_negative(pressure, place, unit, faults);
}

fn settings(scene: &Scene, faults: &mut Faults) {
    positive(scene.contact.thickness_mm, "contact.thickness_mm", "mm", faults);
    not_negative(
        scene.contact.stiffness_mpa,
        "contact.stiffness_mpa",
        "MPa",
        faults,
    );
    not_negative(scene.weld.tolerance_mm, "weld.tolerance_mm", "mm", faults);
    not_negative(
        scene.weld.insertion_tolerance_mm,
        "weld.insertion_tolerance_mm",
        "mm",
        faults,
    );
    let tolerance = scene.settings.residual_tolerance;
    if !(tolerance > 0.0 && tolerance < 1.0) {
        let message = format!("is {}, expected above 0 and below 1", Readable(tolerance));
        faults.error("settings.residual_tolerance", message);
    }
    let step_scale = scene.settings.step_scale;
    if !(step_scale.is_finite() && (0.01..=100.0).contains(&step_scale)) {
        let message = format!("is {}, expected 0.01 to 100", Readable(step_scale));
        faults.error("settings.step_scale", message);
    }
    if scene.settings.iteration_limit == 0 {
        faults.error("settings.iteration_limit", "is 0, expected at least 1");
    }
}

fn landmarks(scene: &Scene, faults: &mut Faults) {
    let named = &scene.landmarks;
    let all = [
        ("mid_anterior_mm", named.mid_anterior_mm),
        ("mid_posterior_mm", named.mid_posterior_mm),
        ("commissure_anterolateral_mm", named.commissure_anterolateral_mm),
        ("commissure_posteromedial_mm", named.commissure_posteromedial_mm),
        ("trigone_left_mm", named.trigone_left_mm),
        ("trigone_right_mm", named.trigone_right_mm),
    ];
    for (key, point) in all {
        points(point.as_slice(), &format!("landmarks.{key}"), "entry", faults);
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{faults, lines, mesh, skirt, told};
    use super::*;
    use crate::scene::{ChordLaw, Tissue};

    /// A change to a good scene, where it must be told, and in which words.
    type Wrong = (fn(&mut Scene), &'static str, &'static str);

    #[test]
    fn every_wrong_number_is_told_with_place_and_value() {
        let wrongs: [Wrong; 23] = [
            (|s| s.schema_version = 2, "schema_version", "2 is unknown"),
            (|s| s.leaflets.clear(), "leaflets", "none"),
            (
                |s| s.leaflets[1].thickness_mm = 0.0,
                "leaflets[1].thickness_mm",
                "is 0 mm",
            ),
            (
                |s| s.leaflets[0].thickness_mm = f64::NAN,
                "leaflets[0].thickness_mm",
                "NaN",
            ),
            (
                |s| tissue(s, -1.0, 0.25, 4.0),
                "pre_transition_modulus_mpa",
                "is -1 MPa",
            ),
            (|s| tissue(s, 0.1, 0.0, 4.0), "transition_strain", "is 0,"),
            (
                |s| tissue(s, 5.0, 0.25, 4.0),
                "post_transition_modulus_mpa",
                "below the pre-transition modulus 5",
            ),
            (|s| s.leaflets[0].mesh = None, "leaflets[0].mesh", "absent"),
            (|s| mesh(s, 0).faces.clear(), "leaflets[0].mesh", "no triangles"),
            (|s| mesh(s, 0).faces[7][1] = 999, "leaflets[0].mesh face 7", "999"),
            (
                |s| mesh(s, 0).points_mm[4][2] = f64::INFINITY,
                "leaflets[0].mesh point 4",
                "inf",
            ),
            (
                |s| mesh(s, 0).annulus_points = Some(vec![999]),
                "annulus_points",
                "999",
            ),
            (
                |s| s.annulus.curve_file = Some("a.json".into()),
                "annulus.curve_file",
                "a.json",
            ),
            (
                |s| s.papillary[0].tips_mm.clear(),
                "papillary[0].tips_mm",
                "absent",
            ),
            (
                |s| s.papillary[0].displacements_mm = vec![[0.0; 3]; 2],
                "displacements_mm",
                "2 entries",
            ),
            (
                |s| s.chordae[0].modulus_mpa = Some(0.0),
                "chordae[0].modulus_mpa",
                "is 0 MPa",
            ),
            (
                |s| s.chordae[0].law = Some(ChordLaw::Linear { modulus_mpa: 20.0 }),
                "chordae[0].modulus_mpa",
                "beside `law`",
            ),
            (
                |s| lines(s).segments[2] = [0, 99],
                "chordae[0].mesh segment 2",
                "99",
            ),
            (|s| s.load = Load::mmhg(-120.0), "load.pressure_mmhg", "is -120"),
            (|s| s.load.pressure_kpa = Some(16.0), "load", "in mmHg and in kPa"),
            (
                |s| s.contact.thickness_mm = f64::NAN,
                "contact.thickness_mm",
                "NaN",
            ),
            (
                |s| s.settings.residual_tolerance = 0.0,
                "settings.residual_tolerance",
                "is 0",
            ),
            (|s| s.weld.tolerance_mm = -1.0, "weld.tolerance_mm", "is -1 mm"),
        ];
        for (spoil, place, words) in wrongs {
            let mut scene = skirt();
            spoil(&mut scene);
            assert!(told(&faults(&scene), place, words));
        }
    }

    use crate::scene::Load;

    fn tissue(scene: &mut Scene, soft: f64, knee: f64, stiff: f64) {
        scene.leaflets[0].tissue = Tissue::BilinearSprings {
            pre_transition_modulus_mpa: soft,
            transition_strain: knee,
            post_transition_modulus_mpa: stiff,
            compression_modulus_ratio: 1.0,
            bending_modulus_ratio: 1.0,
        };
    }

    #[test]
    fn all_faults_come_at_once_up_to_twenty() {
        let mut scene = skirt();
        scene.leaflets[0].thickness_mm = 0.0;
        scene.load.pressure_mmhg = None;
        assert_eq!(faults(&scene).len(), 2);
        lines(&mut scene).rest_length_mm = Some(vec![0.0; 6]);
        lines(&mut scene).area_mm2 = Some(vec![0.0; 6]);
        for number in 0..10 {
            scene.papillary.push(scene.papillary[0].clone());
            scene.papillary[2 + number].name = number.to_string();
        }
        scene
            .papillary
            .iter_mut()
            .for_each(|muscle| muscle.tips_mm.clear());
        let found = faults(&scene);
        assert_eq!(found.len(), super::super::faults::LIMIT + 1);
        assert!(told(&found, "scene", "and 6 more"));
    }
}

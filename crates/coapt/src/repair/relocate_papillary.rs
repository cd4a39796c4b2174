//! A papillary muscle drawn elsewhere, as by a stitch to the annulus: only where its tips end up changes.

use super::chord_ends::muscle_named;
use super::ring::annulus_targets;
use crate::Vec3;
use crate::model::Model;
use crate::repair::{Repaired, Report};
use crate::scene::{AnnulusPlace, Fault, RelocatePapillary};

/// Muscles are drawn 5 to 15 mm; farther than twice that is doubted [mm].
const DOUBTFUL_MM: f64 = 30.0;

/// And farther than twice that refused [mm], our choice: with a muscle moved by 100 mm a valve whose tissue was stretched by 270 % was
/// certified and ranked first.
const FARTHEST_MM: f64 = 60.0;

/// What was moved.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct RelocationReport {
    /// Name of the muscle.
    pub muscle: String,
    /// How many tips it has.
    pub tips: usize,
    /// By how much they move [mm].
    pub by_mm: [f64; 3],
}

/// Moves the tips of a muscle where they are when the valve is closed.
///
/// # Errors
/// No such muscle, or one without tips; both or neither of vector and place; numbers out of range; past the place.
pub fn relocate(model: &Model, relocation: &RelocatePapillary) -> Result<Repaired, Vec<Fault>> {
    relocated(model, relocation).map_err(|fault| vec![fault])
}

fn relocated(model: &Model, relocation: &RelocatePapillary) -> Result<Repaired, Fault> {
    let number = muscle_named(model, &relocation.muscle, "relocate-papillary.muscle")?;
    let muscle = &model.papillary[number];
    if muscle.tips.is_empty() {
        let message = format!("is `{}`, which has no tips", muscle.name);
        return Err(Fault::of_shape("relocate-papillary.muscle", message));
    }
    let tips = muscle.tips.iter().map(|&tip| model.target_mm(tip));
    let middle = tips.sum::<Vec3>() / muscle.tips.len() as f64;
    let by = motion(model, relocation, middle)?;
    let mut moved = model.clone();
    for fixed in &mut moved.prescribed {
        if muscle.tips.contains(&fixed.vertex) {
            fixed.target_mm += by;
        }
    }
    let mut warnings = Vec::new();
    if by.norm() > DOUBTFUL_MM {
        let message = format!("the muscle moves by {:.1} mm, expected about 5 to 15", by.norm());
        warnings.push(Fault::warning("relocate-papillary", message));
    }
    Ok(Repaired {
        model: moved,
        report: Report::RelocatePapillary(RelocationReport {
            muscle: muscle.name.clone(),
            tips: muscle.tips.len(),
            by_mm: by.into(),
        }),
        warnings,
    })
}

fn motion(model: &Model, relocation: &RelocatePapillary, from: Vec3) -> Result<Vec3, Fault> {
    match (relocation.by_mm, relocation.toward, relocation.distance_mm) {
        (Some(by), None, None) => {
            // Comparisons with what is no number are false.
            if Vec3::from(by).norm() <= FARTHEST_MM {
                return Ok(by.into());
            }
            let [x, y, z] = by;
            let message = format!(
                "is ({x}, {y}, {z}) mm, expected a way of at most {FARTHEST_MM} mm; 5 to 15 are usual"
            );
            Err(Fault::error("relocate-papillary.by_mm", message))
        }
        (None, Some(place), Some(distance)) => {
            let to = place_mm(model, place)?;
            let way = (to - from).norm();
            if distance > 0.0 && distance < way {
                return Ok((to - from) * (distance / way));
            }
            let message =
                format!("is {distance} mm, expected above 0 and less than the way there, {way:.1} mm");
            Err(Fault {
                of_shape: distance >= way,
                ..Fault::error("relocate-papillary.distance_mm", message)
            })
        }
        (Some(_), _, _) => Err(Fault::error(
            "relocate-papillary.by_mm",
            "is given beside `toward` or `distance_mm`; expected the vector alone, or those two",
        )),
        (None, None, _) => Err(Fault::error(
            "relocate-papillary.by_mm",
            "is missing; expected a vector, or `toward` and `distance_mm`",
        )),
        (None, Some(_), None) => Err(Fault::error(
            "relocate-papillary.distance_mm",
            "is missing; expected how far toward the annulus the muscle is drawn",
        )),
    }
}

fn place_mm(model: &Model, place: AnnulusPlace) -> Result<Vec3, Fault> {
    let landmarks = &model.landmarks;
    let index = match place {
        AnnulusPlace::MidAnterior => landmarks.mid_anterior,
        AnnulusPlace::MidPosterior => landmarks.mid_posterior,
        AnnulusPlace::CommissureAnterolateral => landmarks.commissure_anterolateral,
        AnnulusPlace::CommissurePosteromedial => landmarks.commissure_posteromedial,
        AnnulusPlace::TrigoneLeft => landmarks.trigone_left,
        AnnulusPlace::TrigoneRight => landmarks.trigone_right,
    };
    let found = annulus_targets(model).get(index).copied();
    found.ok_or_else(|| {
        Fault::of_shape(
            "relocate-papillary.toward",
            "the valve has no annulus to draw it to",
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::parametric::{Preset, ValveParameters, generate};

    /// A way within the bound is taken, one beyond it or that is no number refused with the bound.
    #[test]
    fn no_muscle_moves_farther_than_a_heart_has_room() {
        let scene = generate(&ValveParameters::preset(Preset::Healthy)).unwrap();
        let model = Model::build(&scene).unwrap().model;
        let moved = |by_mm: [f64; 3]| {
            relocate(
                &model,
                &RelocatePapillary {
                    muscle: model.papillary[0].name.clone(),
                    by_mm: Some(by_mm),
                    toward: None,
                    distance_mm: None,
                },
            )
        };
        assert!(moved([0.0, 0.0, FARTHEST_MM]).is_ok());
        for by_mm in [[0.0, 0.0, 60.1], [50.0, 50.0, 0.0], [f64::NAN, 0.0, 0.0]] {
            let faults = moved(by_mm).unwrap_err();
            assert!(faults[0].message.contains("at most 60 mm"), "{faults:?}");
        }
    }
}

//! What may be asked of a study, for whoever asks: the program's options, the package's keywords.

use std::fmt::Display;
use std::ops::RangeInclusive;

use coapt::scene::Fault;

use super::{REFERENCE_FINER, REPEATS, THICKNESSES_MM, TOLERANCES, Tried};

/// Mesh sizes that a preset is generated in, in triangles.
pub const FACES_ALLOWED: RangeInclusive<u32> = 100..=1_000_000;
/// How often each setting may be closed.
pub const REPEATS_ALLOWED: RangeInclusive<u16> = 1..=1000;
/// Thicker contact than this [mm] would hold leaflets of any valve apart at rest.
const THICKEST_MM: f64 = 5.0;

/// Mesh sizes of a preset.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sizes {
    /// Those studied, in triangles, ascending, each once; at least one.
    pub faces: Vec<u32>,
    /// That of the reference, in triangles: no coarser than any of them.
    pub reference_faces: u32,
}

impl Sizes {
    /// Sizes as asked for, in triangles: `usual` where none are, and [`REFERENCE_FINER`] times the finest for the reference.
    ///
    /// # Errors
    /// No size at all, sizes outside of [`FACES_ALLOWED`], a reference coarser than the finest mesh; places are `faces[1]`
    /// and `reference_faces`.
    pub fn asked(
        faces: Option<&[i64]>,
        reference_faces: Option<i64>,
        usual: &[u32],
    ) -> Result<Self, Vec<Fault>> {
        let mut faults = Vec::new();
        let mut sizes: Vec<u32> = match faces {
            None => usual.to_vec(),
            Some(faces) => {
                let size = |(number, &faces)| whole(&format!("faces[{number}]"), faces, FACES_ALLOWED);
                let sizes = faces.iter().enumerate().map(size);
                sizes.filter_map(|size| kept(size, &mut faults)).collect()
            }
        };
        sizes.sort_unstable();
        sizes.dedup();
        if faces.is_some_and(<[i64]>::is_empty) {
            faults.push(Fault::error(
                "faces",
                "is empty; expected at least one mesh size, in triangles",
            ));
        }
        let reference = reference_faces.map(|faces| whole("reference_faces", faces, FACES_ALLOWED));
        let reference = reference.and_then(|faces| kept(faces, &mut faults));
        let Some(&finest) = sizes.last() else {
            return Err(faults);
        };
        // Against a coarser mesh an error would say nothing.
        if let Some(reference) = reference.filter(|&reference| reference < finest) {
            let message =
                format!("is {reference}, coarser than the finest mesh studied; expected at least {finest}");
            faults.push(Fault::error("reference_faces", message));
        }
        if !faults.is_empty() {
            return Err(faults);
        }
        let finer = finest.saturating_mul(REFERENCE_FINER).min(*FACES_ALLOWED.end());
        Ok(Self {
            faces: sizes,
            reference_faces: reference.unwrap_or(finer),
        })
    }
}

/// Refuses sizes asked for of a valve that is not generated.
///
/// # Errors
/// A size, which would change nothing; places are `faces` and `reference_faces`.
pub fn expect_no_sizes(faces: Option<&[i64]>, reference_faces: Option<i64>) -> Result<(), Vec<Fault>> {
    let faces = faces.map(|faces| format!("{faces:?}"));
    let reference_faces = reference_faces.map(|faces| faces.to_string());
    let given = [("faces", faces), ("reference_faces", reference_faces)];
    let faults = given.into_iter().filter_map(|(place, given)| {
        let message = format!(
            "is {}, which is for presets; expected none: any other valve has the mesh that it has",
            given?
        );
        Some(Fault::error(place, message))
    });
    let faults: Vec<Fault> = faults.collect();
    if faults.is_empty() { Ok(()) } else { Err(faults) }
}

impl Tried {
    /// Settings as asked for: residuals to stop at [1], contact thicknesses [mm] – of which there may be none –, and closures of each;
    /// what is not asked for is as of [`Tried::default`].
    ///
    /// # Errors
    /// No residual at all, and numbers that no closure can be made with; places are `tolerances[1]`, `thicknesses_mm[1]`, `repeats`.
    pub fn asked(
        tolerances: Option<Vec<f64>>,
        thicknesses_mm: Option<Vec<f64>>,
        repeats: Option<i64>,
    ) -> Result<Self, Vec<Fault>> {
        let tolerances = tolerances.unwrap_or_else(|| TOLERANCES.to_vec());
        let thicknesses_mm = thicknesses_mm.unwrap_or_else(|| THICKNESSES_MM.to_vec());
        let mut faults = Vec::new();
        if tolerances.is_empty() {
            faults.push(Fault::error(
                "tolerances",
                "is empty; expected at least one residual",
            ));
        }
        faults.extend(wrong("tolerances", &tolerances, tolerance));
        faults.extend(wrong("thicknesses_mm", &thicknesses_mm, thickness_mm));
        let repeats = kept(self::repeats(repeats), &mut faults);
        match repeats.filter(|_| faults.is_empty()) {
            Some(repeats) => Ok(Self {
                tolerances,
                thicknesses_mm,
                repeats,
            }),
            None => Err(faults),
        }
    }
}

/// How often each setting is closed; [`REPEATS`] where nothing is asked for.
///
/// # Errors
/// A number outside of [`REPEATS_ALLOWED`]; the place is `repeats`.
pub fn repeats(asked: Option<i64>) -> Result<u16, Fault> {
    asked.map_or(Ok(REPEATS), |asked| whole("repeats", asked, REPEATS_ALLOWED))
}

/// A residual to stop at [1].
///
/// # Errors
/// What was expected instead.
pub fn tolerance(asked: f64) -> Result<f64, String> {
    let is_right = asked > 0.0 && asked < 1.0;
    let expected = || "expected a number above 0 and below 1".to_owned();
    is_right.then_some(asked).ok_or_else(expected)
}

/// A contact thickness [mm].
///
/// # Errors
/// What was expected instead.
pub fn thickness_mm(asked: f64) -> Result<f64, String> {
    let is_right = asked > 0.0 && asked <= THICKEST_MM;
    let expected = || format!("expected a number of mm above 0, at most {THICKEST_MM}");
    is_right.then_some(asked).ok_or_else(expected)
}

fn wrong(list: &str, asked: &[f64], check: fn(f64) -> Result<f64, String>) -> Vec<Fault> {
    let told = |(number, &asked): (usize, &f64)| {
        let expected = check(asked).err()?;
        Some(Fault::error(
            format!("{list}[{number}]"),
            format!("is {asked}; {expected}"),
        ))
    };
    asked.iter().enumerate().filter_map(told).collect()
}

fn whole<N>(place: &str, asked: i64, allowed: RangeInclusive<N>) -> Result<N, Fault>
where
    N: Copy + Display + PartialOrd + TryFrom<i64>,
{
    let number = N::try_from(asked).ok();
    number.filter(|number| allowed.contains(number)).ok_or_else(|| {
        let (least, most) = (allowed.start(), allowed.end());
        Fault::error(
            place,
            format!("is {asked}; expected a whole number from {least} to {most}"),
        )
    })
}

/// The value, or its fault put with the others.
fn kept<N>(checked: Result<N, Fault>, faults: &mut Vec<Fault>) -> Option<N> {
    checked.map_err(|fault| faults.push(fault)).ok()
}

#[cfg(test)]
mod tests {
    use super::super::{FACES, FACES_OF_LAWS};
    use super::*;
    use crate::scene::sentence;

    fn told<T: std::fmt::Debug>(asked: Result<T, Vec<Fault>>) -> Vec<String> {
        asked.unwrap_err().iter().map(sentence).collect()
    }

    #[test]
    fn sizes_are_sorted_and_have_a_finer_reference() {
        let sizes = |faces: Option<&[i64]>, reference| Sizes::asked(faces, reference, &FACES).unwrap();
        assert_eq!(sizes(None, None).faces, FACES);
        assert_eq!(sizes(None, None).reference_faces, 10_400);
        let asked = sizes(Some(&[300, 150, 300]), Some(300));
        assert_eq!((asked.faces, asked.reference_faces), (vec![150, 300], 300));
        assert_eq!(sizes(Some(&[900_000]), None).reference_faces, 1_000_000);
        assert_eq!(Sizes::asked(None, None, &FACES_OF_LAWS).unwrap().faces, [650]);
    }

    #[test]
    fn wrong_sizes_are_told_all_at_once() {
        let asked = |faces: &[i64], reference| told(Sizes::asked(Some(faces), reference, &FACES));
        assert_eq!(
            asked(&[9, 300, -1], Some(i64::MAX)),
            [
                "faces[0] is 9; expected a whole number from 100 to 1000000",
                "faces[2] is -1; expected a whole number from 100 to 1000000",
                "reference_faces is 9223372036854775807; expected a whole number from 100 to 1000000",
            ]
        );
        assert_eq!(
            asked(&[], Some(0)),
            [
                "faces is empty; expected at least one mesh size, in triangles",
                "reference_faces is 0; expected a whole number from 100 to 1000000",
            ]
        );
        assert_eq!(
            asked(&[150, 300], Some(200)),
            ["reference_faces is 200, coarser than the finest mesh studied; expected at least 300"]
        );
        assert_eq!(expect_no_sizes(None, None), Ok(()));
        assert_eq!(
            told(expect_no_sizes(Some(&[2600]), Some(9))),
            [
                "faces is [2600], which is for presets; expected none: any other valve has the mesh that it has",
                "reference_faces is 9, which is for presets; expected none: any other valve has the mesh that it has",
            ]
        );
    }

    #[test]
    fn wrong_settings_are_told_all_at_once() {
        assert_eq!(Tried::asked(None, None, None), Ok(Tried::default()));
        let few = Tried::asked(Some(vec![0.1]), Some(Vec::new()), Some(1)).unwrap();
        assert_eq!(
            (few.tolerances, few.thicknesses_mm, few.repeats),
            (vec![0.1], vec![], 1)
        );
        let wrong = Tried::asked(Some(vec![0.1, -1.0, f64::NAN]), Some(vec![6.0, 0.0]), Some(0));
        assert_eq!(
            told(wrong),
            [
                "tolerances[1] is -1; expected a number above 0 and below 1",
                "tolerances[2] is NaN; expected a number above 0 and below 1",
                "thicknesses_mm[0] is 6; expected a number of mm above 0, at most 5",
                "thicknesses_mm[1] is 0; expected a number of mm above 0, at most 5",
                "repeats is 0; expected a whole number from 1 to 1000",
            ]
        );
        assert_eq!(
            told(Tried::asked(Some(Vec::new()), None, Some(1001))),
            [
                "tolerances is empty; expected at least one residual",
                "repeats is 1001; expected a whole number from 1 to 1000",
            ]
        );
    }
}

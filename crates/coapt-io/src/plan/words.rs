//! How criteria are called and written, and how a ranking is told: in the text, on the page, of a search.

use coapt::plan::{COAPTATION_TARGET_MM, Criterion, DIASTOLIC_TARGET_MM2};

/// A criterion in words.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Words {
    /// What a surgeon calls it.
    pub(crate) title: &'static str,
    /// The same over a narrow column.
    pub(crate) head: &'static str,
    /// Unit as it is shown.
    pub(crate) unit: &'static str,
    /// What its value is multiplied by for that unit.
    pub(crate) factor: f64,
    /// Digits after the point of a value.
    pub(crate) digits: usize,
    /// Digits after the point of a rate or a small difference.
    pub(crate) rate_digits: usize,
    /// Where it stands in what is told of a closed valve, with points between the steps; none where it is no number there.
    path: Option<&'static str>,
}

/// How a criterion is called and written.
pub(crate) fn words(criterion: Criterion) -> Words {
    let coaptation = |title, head, path| Words {
        title,
        head,
        unit: "mm",
        factor: 1.0,
        digits: 1,
        rate_digits: 2,
        path: Some(path),
    };
    match criterion {
        Criterion::Orifice => Words {
            title: "orifice",
            head: "orifice",
            unit: "mm²",
            factor: 1.0,
            digits: 1,
            rate_digits: 1,
            path: Some("orifice.area_mm2"),
        },
        Criterion::CoaptationLengthA2P2 => {
            coaptation("coaptation at A2-P2", "A2-P2 coapt.", "coaptation.length_a2p2_mm")
        }
        Criterion::CoaptationLength => {
            coaptation("mean coaptation", "mean coapt.", "coaptation.length_mean_mm")
        }
        Criterion::ChordForce => Words {
            title: "largest chord tension",
            head: "chord, most",
            unit: "N",
            factor: 1.0,
            digits: 2,
            rate_digits: 2,
            path: Some("chords.max_force_n"),
        },
        Criterion::Strain => Words {
            title: "strain",
            head: "strain, 95 %",
            unit: "%",
            factor: 100.0,
            digits: 1,
            rate_digits: 1,
            path: None,
        },
        Criterion::DiastolicOrifice => Words {
            title: "open orifice",
            head: "open orifice",
            unit: "mm²",
            factor: 1.0,
            digits: 0,
            rate_digits: 0,
            path: Some("diastole.area_mm2"),
        },
    }
}

impl Words {
    /// `coaptation at A2-P2 [mm]`
    pub(crate) fn heading(&self) -> String {
        format!("{} [{}]", self.title, self.unit)
    }
}

/// A measure by the name that it has in a plan: how it is called, its unit, and what its value is multiplied by for that. A measure that is
/// no criterion is called by its path.
pub(crate) fn measure_words(name: &str) -> (String, &'static str, f64) {
    let path = name.replace('/', ".");
    let is_meant = |criterion: &Criterion| criterion.name() == name || words(*criterion).path == Some(&*path);
    match Criterion::ALL.into_iter().find(is_meant).map(words) {
        Some(words) => (words.title.to_owned(), words.unit, words.factor),
        None => (name.to_owned(), "", 1.0),
    }
}

/// What ranks, the most important first, each with the width of its bins in its own unit.
pub(crate) fn ranking(criteria: impl Iterator<Item = (Criterion, f64)>) -> String {
    let told = criteria.map(|(criterion, bin)| {
        let Words {
            title, unit, factor, ..
        } = words(criterion);
        let lacking = match criterion {
            Criterion::CoaptationLengthA2P2 | Criterion::CoaptationLength => {
                format!(", as far as it is below {COAPTATION_TARGET_MM} mm,")
            }
            _ => String::new(),
        };
        match criterion {
            Criterion::DiastolicOrifice => {
                format!("{title}, by how often it is halved from {DIASTOLIC_TARGET_MM2} mm²")
            }
            _ => format!("{title}{lacking} in steps of {} {unit}", rounded(factor * bin)),
        }
    });
    let told: Vec<String> = told.collect();
    format!(
        "{}; smaller differences are noise, and share a rank",
        told.join(", then ")
    )
}

/// A hundred times 0.01 is meant to be 1.
pub(super) fn rounded(value: f64) -> f64 {
    (1e9 * value).round() / 1e9
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The words of a criterion are those of the measure at its path, and what ranks is told with its steps, once and for all doors.
    #[test]
    fn a_criterion_is_called_alike_by_name_and_by_path() {
        for criterion in Criterion::ALL {
            let told = words(criterion);
            let by_name = measure_words(criterion.name());
            assert_eq!(by_name, (told.title.to_owned(), told.unit, told.factor));
            if let Some(path) = told.path {
                assert_eq!(measure_words(path), by_name);
                assert_eq!(measure_words(&path.replace('.', "/")), by_name);
            }
        }
        assert_eq!(
            measure_words("annulus.ap_mm"),
            ("annulus.ap_mm".to_owned(), "", 1.0)
        );
        let all = Criterion::ALL.map(|criterion| (criterion, criterion.bin_width().0));
        assert_eq!(
            ranking(all.into_iter()),
            "orifice in steps of 8 mm², then coaptation at A2-P2, as far as it is below 8 mm, in steps of 0.5 mm, then mean coaptation, as \
             far as it is below 8 mm, in steps of 1.5 mm, then largest chord tension in steps of 0.2 N, then strain in steps of 1 %, then \
             open orifice, by how often it is halved from 400 mm²; smaller differences are noise, and share a rank"
        );
    }
}

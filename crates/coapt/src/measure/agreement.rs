//! Whether open margins and the narrowest passage tell the same of a valve.

use super::OrificeMeasures;

/// What margins and passage say of each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Agreement {
    /// As much as slits leave room for, or there is only one of them.
    Fair,
    /// There is a way through where margins have hardly a hole: they missed it.
    MarginsMiss,
    /// Margins have several times as much as can pass: they are far apart where something below them closes.
    MarginsExceed,
}

/// What is missed by chance, in cubes or between vertices [mm²], our choice: passages change by so much with the size of cubes.
const MISSED_MM2: f64 = 2.0;
/// A slit between middle surfaces, over what is left between the surfaces of the tissue [1], our choice. In the dilated valve, where the
/// gap is hardly wider than the tissue is thick, 3.0 to 5.2 on four meshes, so that one of them is told to be in doubt; 9 to 12 where
/// passages of repaired valves showed that margins had far too much.
const MOST_OF_SLITS: f64 = 4.5;
/// Orifices below this are closed within the noise of meshes and roads [mm²] (README).
pub const SMALL_MM2: f64 = 8.0;

impl OrificeMeasures {
    /// Whether margins and passage agree on what is open.
    pub fn agreement(&self) -> Agreement {
        match self.passage_mm2 {
            Some(passage_mm2) if passage_mm2 > self.area_mm2 + MISSED_MM2 => Agreement::MarginsMiss,
            Some(passage_mm2) if self.area_mm2 > SMALL_MM2.max(MOST_OF_SLITS * passage_mm2) => {
                Agreement::MarginsExceed
            }
            _ => Agreement::Fair,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Figures of presets and repairs (`VALIDATION.md`), and both sides of each limit.
    #[test]
    fn margins_and_passage_are_set_against_each_other() {
        let agreement = |area_mm2: f64, passage_mm2: Option<f64>| {
            let orifice = OrificeMeasures {
                area_mm2,
                passage_mm2,
                ..OrificeMeasures::default()
            };
            orifice.agreement()
        };
        let cases = [
            (20.6, Some(6.0), Agreement::Fair),
            (89.0, Some(69.8), Agreement::Fair),
            (0.0, Some(0.0), Agreement::Fair),
            (0.0, Some(1.9), Agreement::Fair),
            (5.8, Some(14.6), Agreement::MarginsMiss),
            (0.0, Some(2.1), Agreement::MarginsMiss),
            (7.9, Some(0.0), Agreement::Fair),
            (22.4, Some(0.0), Agreement::MarginsExceed),
            (87.5, Some(8.0), Agreement::MarginsExceed),
            (45.1, Some(10.0), Agreement::MarginsExceed),
            (44.9, Some(10.0), Agreement::Fair),
            (90.0, None, Agreement::Fair),
        ];
        for (area_mm2, passage_mm2, expected) in cases {
            assert_eq!(
                agreement(area_mm2, passage_mm2),
                expected,
                "{area_mm2} {passage_mm2:?}"
            );
        }
    }
}

//! Which tissue is in contact, and which lies open to the atrium.

use super::gap::Gaps;
use super::surface::Surface;
use super::ways::ways_from_annulus;
use crate::model::Model;

/// Contact and openness per vertex.
pub(super) struct Seal {
    /// Gap minus threshold, of the smaller gap [mm]: negative in contact.
    pub(super) clearance_mm: Vec<f64>,
    /// Whether nothing is in contact on the shortest way along the leaflets from here to the annulus.
    pub(super) open: Vec<bool>,
}

/// Follows the leaflets from the annulus down, until something touches.
///
/// Each vertex looks up along its shortest way to the annulus in the unloaded mesh. A plain flood over everything that
/// is not in contact would pass through a leak, spread below the line of closure and find all of it open.
/// Tissue that no way leads to is open unless it touches: unknown must not look sealed. A leaflet that
/// touches itself seals when it is pleated, between parts that lie side by side along the annulus. Folded over, as
/// an everted flap is, it stops no flow.
pub(super) fn seal(model: &Model, s: &Surface, gaps: &Gaps) -> Seal {
    let clearance_mm: Vec<f64> = (0..s.vertex_leaflets.len())
        .map(|v| gaps.facing_mm[v].min(gaps.own_mm[v]) - gaps.threshold_mm[v])
        .collect();
    let mut open: Vec<bool> = (0..clearance_mm.len())
        .map(|v| gaps.facing_mm[v].min(gaps.beside_mm[v]) >= gaps.threshold_mm[v])
        .collect();
    for &(v, parent) in &ways_from_annulus(model, s).nearest_first {
        open[v] = open[v] && open[parent];
    }
    Seal { clearance_mm, open }
}

#[cfg(test)]
mod tests {
    use super::super::gap::GAP_CAP_MM;
    use super::super::surface::surface;
    use super::super::test_models::grid_model;
    use super::*;

    /// A 5 × 5 sheet hanging from its upper row, with contact in the middle row but for one end: everything below
    /// the contact is sealed, the column below the leak is open, and the leak does not creep sideways.
    #[test]
    fn a_leak_does_not_spread_below_the_contact() {
        let (columns, rows) = (5, 5);
        let mut model = grid_model(columns, rows, 4.0, 4.0);
        model.annulus = (0..columns as u32).collect();
        let s = surface(&model, &model.rest_mm);
        let count = model.rest_mm.len();
        let mut facing_mm = vec![GAP_CAP_MM; count];
        facing_mm[2 * columns..3 * columns - 1].fill(0.4);
        let gaps = Gaps {
            facing_mm,
            own_mm: vec![GAP_CAP_MM; count],
            beside_mm: vec![GAP_CAP_MM; count],
            threshold_mm: vec![0.6; count],
        };
        let open = seal(&model, &s, &gaps).open;
        for row in 0..rows {
            for column in 0..columns {
                let expected = row < 2 || column == columns - 1;
                assert_eq!(
                    open[row * columns + column],
                    expected,
                    "row {row} column {column}"
                );
            }
        }
    }

    /// Without an annulus, everything that does not touch is open.
    #[test]
    fn unknown_is_open() {
        let model = grid_model(3, 3, 2.0, 2.0);
        let s = surface(&model, &model.rest_mm);
        let gaps = Gaps {
            facing_mm: vec![1.0; 9],
            own_mm: vec![1.0; 9],
            beside_mm: vec![1.0; 9],
            threshold_mm: vec![0.6; 9],
        };
        assert!(seal(&model, &s, &gaps).open.iter().all(|&o| o));
    }
}

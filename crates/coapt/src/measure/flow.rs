//! What a geometry would let through, by Bernoulli: estimates with their assumptions, no flow is computed.

use serde::Serialize;

/// Density of blood [kg/m³].
const BLOOD_KG_PER_M3: f64 = 1060.0;
/// One millimetre of mercury [Pa].
const MMHG_PA: f64 = 133.322_368_4;
/// Jet over orifice [1]: a sharp edge contracts the jet to π / (π + 2) in potential flow, a rounded one hardly.
const CONTRACTION: [f64; 2] = [0.611, 0.85];
/// Time for which the ventricle ejects [s]; a usual figure, which a static model does not know.
const SYSTOLE_S: f64 = 0.30;

/// A valve whose anatomic orifice without pressure is smaller hardly opens [mm²]: no gradient is told of it. Our choice: through 50 mm² the
/// heart at rest of [`Filling`]'s default would need 53 mmHg, more than twice what fills lungs with water, and the estimate grows with
/// the inverse square of the area, to thousands. No heart fills like that; what such a figure says is that the valve does not open.
pub const HARDLY_OPENS_MM2: f64 = 50.0;

/// What a heart at rest does in diastole; usual figures, to be replaced by the patient's.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Filling {
    /// Blood that passes the valve in a beat [mL].
    pub stroke_volume_ml: f64,
    /// Time in which it does [s].
    pub filling_time_s: f64,
    /// Discharge coefficient of the open valve [1].
    pub discharge_coefficient: f64,
}

impl Default for Filling {
    fn default() -> Self {
        Self {
            stroke_volume_ml: 70.0,
            filling_time_s: 0.45,
            discharge_coefficient: 0.85,
        }
    }
}

/// Volume that an anatomic regurgitant orifice would let back in a beat [mL], from a sharp to a rounded orifice.
///
/// v = √(2 Δp / ρ) by Bernoulli, Δp the peak pressure for all of systole (0.30 s), through the contracted jet. The pressure of
/// most of systole being lower, it is rather too much.
pub fn regurgitant_volume_ml(anatomic_orifice_mm2: f64, pressure_mmhg: f64) -> [f64; 2] {
    let velocity_mm_per_s = 1e3 * (2.0 * pressure_mmhg.max(0.0) * MMHG_PA / BLOOD_KG_PER_M3).sqrt();
    // A thousand cubic millimetres are a millilitre.
    CONTRACTION.map(|contraction| 1e-3 * contraction * anatomic_orifice_mm2 * velocity_mm_per_s * SYSTOLE_S)
}

/// Mean pressure gradient of the filling ventricle over an anatomic diastolic orifice [mmHg]; two openings in parallel add their
/// areas. None where the valve hardly opens (below `HARDLY_OPENS_MM2`), or the orifice is no number.
///
/// Δp = ½ ρ (q / (C A))² with the mean flow q = stroke volume / filling time.
pub fn mean_diastolic_gradient_mmhg(anatomic_orifice_mm2: f64, filling: &Filling) -> Option<f64> {
    if anatomic_orifice_mm2.is_nan() || anatomic_orifice_mm2 < HARDLY_OPENS_MM2 {
        return None;
    }
    let flow_mm3_per_s = 1e3 * filling.stroke_volume_ml / filling.filling_time_s;
    let velocity_m_per_s = 1e-3 * flow_mm3_per_s / (filling.discharge_coefficient * anatomic_orifice_mm2);
    Some(0.5 * BLOOD_KG_PER_M3 * velocity_m_per_s * velocity_m_per_s / MMHG_PA)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The guideline pairs an effective orifice of 40 mm² with 60 mL and 20 mm² with 30 mL (ASE 2017); at 100 mmHg, v = 5.0 m/s, the
    /// velocity-time integral of 0.30 s is 150 cm. The effective orifice is the contracted one.
    #[test]
    fn agrees_with_the_guideline_pairs() {
        for (effective_mm2, expected_ml) in [(40.0, 60.0), (20.0, 30.0)] {
            let [sharp, _] = regurgitant_volume_ml(effective_mm2 / CONTRACTION[0], 100.0);
            assert!((sharp / expected_ml - 1.0).abs() < 0.01, "{sharp}");
        }
        assert_eq!(regurgitant_volume_ml(0.0, 100.0), [0.0, 0.0]);
    }

    /// By hand with the clinical rule of four: 70 mL in 0.45 s through 2 and 1.5 cm² with a coefficient of 0.85 give 3.35 and 5.95 mmHg;
    /// the rule's 4 is 0.6 % more than half the density.
    #[test]
    fn agrees_with_the_rule_of_four() {
        for area_cm2 in [2.0, 1.5] {
            let velocity_m_per_s = 70.0 / 0.45 / (0.85 * area_cm2) / 100.0;
            let found = mean_diastolic_gradient_mmhg(100.0 * area_cm2, &Filling::default()).unwrap();
            assert!(
                (found / (4.0 * velocity_m_per_s * velocity_m_per_s) - 1.0).abs() < 0.01,
                "{found}"
            );
        }
    }

    /// At the least orifice of which a gradient is told it is what the bound says; below it, down to none, there is no figure.
    #[test]
    fn of_what_hardly_opens_no_gradient_is_told() {
        let at = |area_mm2: f64| mean_diastolic_gradient_mmhg(area_mm2, &Filling::default());
        assert_eq!(at(HARDLY_OPENS_MM2).map(f64::round), Some(53.0));
        for area_mm2 in [HARDLY_OPENS_MM2 - 0.1, 6.0, 0.0, -1.0, f64::NAN] {
            assert_eq!(at(area_mm2), None, "{area_mm2}");
        }
    }
}

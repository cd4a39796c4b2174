//! A comparison in the long layout of `SlicerHeart`'s batch export (`QuantificationResults_long.csv`: Filename, Phase,
//! Measurement, Value; `QuantificationUnits.csv`: Measurement, Unit), so that its tables and these can be joined.
//!
//! What `SlicerHeart` measures too has its name and unit there; the definitions differ where ours say so. Closures without a
//! certificate are left out: a line of such a table cannot carry a mark.

use coapt::measure::Measures;

use super::table::quoted;
use super::{Closed, Open, PlanReport};
use crate::scene::BEFORE;

/// A measure: name, unit, value in that unit.
type Measurement = (&'static str, &'static str, fn(&Measures) -> f64);

/// Cubic millimetres of a millilitre.
const MM3_PER_ML: f64 = 1000.0;

const MEASUREMENTS: [Measurement; 24] = [
    ("Annulus circumference (3D)", "mm", |m| m.annulus.circumference_mm),
    ("A-P distance", "mm", |m| m.annulus.ap_mm),
    ("PMC-ALC distance", "mm", |m| m.annulus.commissural_mm),
    ("Intertrigonal distance", "mm", |m| m.annulus.intertrigonal_mm),
    ("Annulus height", "mm", |m| m.annulus.height_mm),
    ("Annulus area (2D)", "mm*mm", |m| m.annulus.area_2d_mm2),
    ("Annulus area (3D)", "mm*mm", |m| m.annulus.area_3d_mm2),
    ("Non-planarity angle", "deg", |m| m.annulus.nonplanarity_angle_deg),
    ("Tenting height", "mm", |m| m.tenting.height_mm),
    ("Tenting area", "mm*mm", |m| m.tenting.area_mm2),
    ("Tenting volume", "mm*mm*mm", |m| m.tenting.volume_ml * MM3_PER_ML),
    ("Billow height", "mm", |m| m.billow.height_mm),
    ("Billow volume", "mm*mm*mm", |m| m.billow.volume_ml * MM3_PER_ML),
    ("Coaptation area (3D)", "mm*mm", |m| m.coaptation.area_mm2),
    ("Coaptation height - mean", "mm", |m| m.coaptation.length_mean_mm),
    ("Coaptation height - max", "mm", |m| m.coaptation.length_max_mm),
    ("Coaptation line length", "mm", |m| m.coaptation.closure_line_mm),
    ("Regurgitant orifice area", "mm*mm", |m| m.orifice.area_mm2),
    ("Regurgitant orifice count", "1", |m| m.orifice.count as f64),
    ("Regurgitant orifice width", "mm", |m| m.orifice.max_gap_mm),
    ("Chord tension - max", "N", |m| m.chords.max_force_n),
    ("Chord tension - sum", "N", |m| m.chords.total_force_n),
    ("Leaflet area - all (3D)", "mm*mm", |m| {
        m.leaflets.iter().map(|leaflet| leaflet.area_mm2).sum()
    }),
    ("Leaflet strain - 95th percentile", "1", |m| {
        coapt::plan::largest_strain(m)
    }),
];

/// A measure of the valve without pressure: name, unit, value in that unit.
type OpenMeasurement = (&'static str, &'static str, fn(&Open) -> Option<f64>);

/// Written where they are known, in the phase of their row: the annulus stands as in it.
const OF_THE_OPEN_VALVE: [OpenMeasurement; 3] = [
    ("Orifice area without pressure", "mm*mm", |open| open.area_mm2),
    ("Orifice count without pressure", "1", |open| {
        Some(open.openings_mm2.as_ref()?.len() as f64)
    }),
    (
        "Mean gradient without pressure (upper estimate)",
        "mmHg",
        |open| open.mean_gradient_mmhg,
    ),
];

/// A line per measure of each certified closure; its file name is the case with the alternative, its phase mid-systole.
pub fn long_csv(report: &PlanReport) -> String {
    let mut out = "Filename,Phase,Measurement,Value\n".to_owned();
    let rows = report.alternatives.iter();
    let named = rows.filter_map(|row| Some((row.name.as_str(), row.closed.as_ref()?)));
    for (name, closed) in std::iter::once((BEFORE, &report.before)).chain(named) {
        if closed.solve.certified {
            lines(&mut out, &format!("{}: {name}", report.case), closed);
        }
    }
    out
}

fn lines(out: &mut String, name: &str, closed: &Closed) {
    let start = format!("{},MS", quoted(name));
    *out += &format!("{start},ValveType,MitralValve\n");
    for (measurement, _, value) in MEASUREMENTS {
        *out += &format!("{start},{measurement},{}\n", value(&closed.measures));
    }
    for (measurement, _, value) in OF_THE_OPEN_VALVE {
        if let Some(value) = closed.diastole.as_ref().and_then(value) {
            *out += &format!("{start},{measurement},{value}\n");
        }
    }
}

/// The unit of each measure.
pub fn units_csv() -> String {
    let closed = MEASUREMENTS.map(|(name, unit, _)| format!("{name},{unit}\n"));
    let open = OF_THE_OPEN_VALVE.map(|(name, unit, _)| format!("{name},{unit}\n"));
    "Measurement,Unit\n".to_owned() + &closed.concat() + &open.concat()
}

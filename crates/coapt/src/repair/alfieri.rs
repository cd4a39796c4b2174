//! Edge-to-edge repair with stitches (Alfieri): a stretch of both margins is sewn together, which leaves two orifices.

use super::clip::refuse_beyond_commissure;
use super::site::on_both_leaflets;
use super::sutures::{STITCH_N_PER_MM, Sewn, Stitch, held_gap_mm, refuse_overlap, sew};
use crate::model::Model;
use crate::repair::{Repaired, Report};
use crate::scene::{Alfieri, Fault};

/// Distance between stitches, at most [mm]: a running suture's, our choice.
const SPACING_MM: f64 = 2.0;

/// What was sewn.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct AlfieriReport {
    /// Share of the margin from the anterolateral commissure [1].
    pub position: f64,
    /// Length of the stretch [mm].
    pub length_mm: f64,
    /// The stitches.
    #[serde(flatten)]
    pub sewn: Sewn,
}

/// Sews a stretch of the margins together.
///
/// # Errors
/// No such site; a stretch beyond a commissure or where an earlier repair joins the leaflets; leaflets lower than the bite;
/// numbers out of range.
pub fn stitch(model: &Model, stitches: &Alfieri) -> Result<Repaired, Vec<Fault>> {
    let mut faults = Vec::new();
    for (value, key) in [
        (stitches.length_mm, "alfieri.length_mm"),
        (stitches.bite_mm, "alfieri.bite_mm"),
    ] {
        if !(value > 0.0 && value.is_finite()) {
            faults.push(Fault::error(key, format!("is {value} mm, expected above 0")));
        }
    }
    let site = on_both_leaflets(model, stitches.site, stitches.position, "alfieri");
    let site = match site {
        Ok(site) if faults.is_empty() => site,
        Ok(_) => return Err(faults),
        Err(fault) => {
            faults.push(fault);
            return Err(faults);
        }
    };
    let place = if stitches.site.is_some() {
        "alfieri.site"
    } else {
        "alfieri.position"
    };
    let length_mm = stitches.length_mm;
    refuse_beyond_commissure(&site, length_mm, "the seam", place)?;
    refuse_overlap(model, &site, length_mm, "the seam", place).map_err(|fault| vec![fault])?;
    let steps = (length_mm / SPACING_MM).ceil();
    let mut threads = Vec::new();
    for step in 0..=steps as u32 {
        let aside_mm = length_mm * (f64::from(step) / steps - 0.5);
        let mut ends = [Vec::new(), Vec::new()];
        for (end, margin) in ends.iter_mut().zip(&site.margins) {
            let arc_mm = site.position * margin.length_mm() + aside_mm;
            // Each stitch goes straight across the margin where it is.
            let line = margin.height_line(arc_mm, margin.tangent(arc_mm, SPACING_MM), 0.0);
            if line.length_mm() <= stitches.bite_mm {
                let name = &model.leaflets[margin.leaflet as usize].name;
                let message = format!(
                    "is {} mm, but the {name} leaflet is only {:.1} mm high there; expected less",
                    stitches.bite_mm,
                    line.length_mm()
                );
                return Err(vec![Fault::of_shape("alfieri.bite_mm", message)]);
            }
            *end = line.at(stitches.bite_mm);
        }
        threads.push(Stitch {
            ends,
            length_mm: held_gap_mm(model),
        });
    }
    let mut model = model.clone();
    let sewn = sew(
        &mut model,
        &format!("alfieri {}", site.name),
        threads,
        STITCH_N_PER_MM,
    );
    Ok(Repaired {
        model,
        report: Report::Alfieri(AlfieriReport {
            position: site.position,
            length_mm,
            sewn,
        }),
        warnings: Vec::new(),
    })
}

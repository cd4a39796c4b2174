//! Springs fitted to a table of a biaxial test: read, fitted, told as the block of a scene.

use std::path::Path;

use coapt::scene::{
    Fault, SpringBranches, Tissue, default_bending_modulus_mpa, default_compression_modulus_ratio,
};
use coapt::tissue_fit::{BilinearFit, anisotropic_from_curve, area_equivalent, bilinear_from_curve};
use serde_json::json;

use crate::biaxial::read_biaxial;
use crate::escape::escaped;
use crate::report::NOTICE;

/// Largest Cauchy stress that is followed unless told otherwise [kPa]: closed leaflets work at some 50 to 150.
pub const UP_TO_KPA: f64 = 100.0;

/// Springs, and what they were fitted to.
#[derive(Clone, Debug, PartialEq)]
pub struct TissueFit {
    /// What the table is called.
    pub curve: String,
    /// Springs with a direction instead of isotropic ones, which follow the gain of area.
    pub anisotropic: bool,
    /// What was found.
    pub fit: BilinearFit,
}

/// Fits springs to a table with the columns of [`read_biaxial`], up to a Cauchy stress; the thickness is for a table of tensions.
///
/// # Errors
/// As of [`read_biaxial`] and the fits, with the name of the file.
pub fn fit_tissue(
    path: &Path,
    anisotropic: bool,
    up_to_kpa: f64,
    thickness_mm: Option<f64>,
) -> Result<TissueFit, Vec<Fault>> {
    let points = read_biaxial(path, thickness_mm)?;
    let range_mpa = [0.0, 1e-3 * up_to_kpa];
    let fit = match anisotropic {
        true => anisotropic_from_curve(&points, range_mpa, default_compression_modulus_ratio()),
        false => bilinear_from_curve(
            &area_equivalent(&points),
            range_mpa,
            default_compression_modulus_ratio(),
        ),
    };
    let curve = path.display().to_string();
    let fit = fit.map_err(|mut faults| {
        faults
            .iter_mut()
            .for_each(|fault| fault.place = format!("{curve} {}", fault.place));
        faults
    })?;
    Ok(TissueFit {
        curve,
        anisotropic,
        fit,
    })
}

impl TissueFit {
    /// The tissue as a scene holds it, its constants as [`Self::text`] tells them.
    pub fn tissue(&self) -> Tissue {
        let (around, outward) = (
            rounded_all(&self.fit.circumferential),
            rounded_all(&self.fit.radial),
        );
        match self.anisotropic {
            true => Tissue::AnisotropicSprings {
                circumferential: around,
                radial: outward,
                compression_modulus_ratio: default_compression_modulus_ratio(),
                bending_modulus_mpa: default_bending_modulus_mpa(),
            },
            false => Tissue::BilinearSprings {
                pre_transition_modulus_mpa: around.pre_transition_modulus_mpa,
                transition_strain: around.transition_strain,
                post_transition_modulus_mpa: around.post_transition_modulus_mpa,
                compression_modulus_ratio: default_compression_modulus_ratio(),
                bending_modulus_ratio: self.bending_modulus_ratio(),
            },
        }
    }

    /// As much as the other laws bend by default.
    fn bending_modulus_ratio(&self) -> f64 {
        rounded(default_bending_modulus_mpa() / self.fit.circumferential.pre_transition_modulus_mpa)
    }

    /// As one JSON object, with a line break at its end; `tissue` is what a scene holds.
    pub fn json(&self) -> String {
        let whole = json!({
            "schema": "coapt-fit-tissue/1", "notice": NOTICE, "curve": self.curve,
            "law": self.tissue().law_name(), "tissue": self.tissue(), "fit": self.fit,
        });
        format!("{whole:#}\n")
    }

    /// The block of a scene, with what was fitted and how well as comments.
    pub fn text(&self) -> String {
        let fit = &self.fit;
        let what = if self.anisotropic {
            "both directions"
        } else {
            "gain of area"
        };
        let percent = 100.0 * fit.rms_error_mpa / fit.rms_stress_mpa;
        let head = format!(
            "# Fitted to {}, {what}, Cauchy stress {} to {} MPa, {} points. Nominal stress: root mean square of the\n\
             # error {:.3e} MPa ({percent:.1} % of the stress), largest {:.3e} MPa. {NOTICE}\n[leaflets.tissue]\nlaw = \"{}\"\n",
            escaped(&self.curve),
            fit.working_range_mpa[0],
            fit.working_range_mpa[1],
            fit.points,
            fit.rms_error_mpa,
            fit.worst_error_mpa,
            self.tissue().law_name()
        );
        let around = keys(&fit.circumferential);
        match self.anisotropic {
            false => format!(
                "{head}{around}bending_modulus_ratio = {:?}\n",
                self.bending_modulus_ratio()
            ),
            true => format!(
                "{head}\n[leaflets.tissue.circumferential]\n{around}\n[leaflets.tissue.radial]\n{}",
                keys(&fit.radial)
            ),
        }
    }
}

/// To six digits, more than any tissue is known to.
fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

fn rounded_all(branches: &SpringBranches) -> SpringBranches {
    SpringBranches {
        pre_transition_modulus_mpa: rounded(branches.pre_transition_modulus_mpa),
        transition_strain: rounded(branches.transition_strain),
        post_transition_modulus_mpa: rounded(branches.post_transition_modulus_mpa),
    }
}

fn keys(branches: &SpringBranches) -> String {
    let branches = rounded_all(branches);
    format!(
        "pre_transition_modulus_mpa = {:?}\ntransition_strain = {:?}\npost_transition_modulus_mpa = {:?}\n",
        branches.pre_transition_modulus_mpa, branches.transition_strain, branches.post_transition_modulus_mpa
    )
}

//! What a parametric valve is made from. Lengths in mm, angles in degrees; every default says where it is
//! from.
//!
//! Axes, LPS: origin in the plane of the widest transverse points, +x to the anterolateral commissure (left),
//! +y posterior, +z to the atrium (superior). Tags used below: "paper 000 ... 004" are the papers this library builds on;
//! the others are cited by author; "our choice" is a modelling choice.

use serde::{Deserialize, Serialize};

use crate::scene::Tissue;

/// Everything that [`super::generate`] needs. The default is the healthy valve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct ValveParameters {
    /// What the case is called in reports.
    pub name: String,
    /// About so many triangles, both leaflets together; the presets' meshes have this many within 10 %. Paper
    /// 003 has 639 and 674, aiming at 600 to 700.
    pub face_count_target: u32,
    /// Peak systolic transvalvular pressure [mmHg]. 100 is our choice within 70-85 (paper 003) to 120.
    pub pressure_mmhg: f64,
    /// Shape of the annulus.
    pub annulus: AnnulusDimensions,
    /// Size, openness and tissue of the leaflets.
    pub leaflets: LeafletDimensions,
    /// Where the chordae spring from.
    pub papillary: PapillaryPositions,
    /// The closed shape that the chordae are cut for.
    pub closed_shape: ClosedShapeTarget,
    /// Number, branching, length and tissue of the chordae.
    pub chordae: ChordPattern,
    /// Every free leaflet point is moved by up to this distance, for studies of stability [mm].
    pub jitter_mm: f64,
    /// Seed of that motion.
    pub jitter_seed: u64,
}

impl Default for ValveParameters {
    fn default() -> Self {
        Self {
            name: "healthy".into(),
            face_count_target: 650,
            pressure_mmhg: 100.0,
            annulus: AnnulusDimensions::default(),
            leaflets: LeafletDimensions::default(),
            papillary: PapillaryPositions::default(),
            closed_shape: ClosedShapeTarget::default(),
            chordae: ChordPattern::default(),
            jitter_mm: 0.0,
            jitter_seed: 0,
        }
    }
}

/// A saddle-shaped D: an anterior and a posterior semi-ellipse over one transverse axis, with
/// z = height·sin²θ on each half.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct AnnulusDimensions {
    /// Widest transverse diameter [mm]. 39 ± 5 in healthy adults at mid-systole (3D TEE, PMC7368231).
    pub transverse_mm: f64,
    /// Anteroposterior diameter [mm]. 28 ± 4 in the same group.
    pub anteroposterior_mm: f64,
    /// Share of the anteroposterior diameter that lies anterior of the transverse axis [1]. 0.40: our choice;
    /// below one half the annulus is D-shaped.
    pub anterior_fraction: f64,
    /// Height of the anterior horn above the transverse axis [mm]. 6.9 in the same group.
    pub anterior_height_mm: f64,
    /// Height of the posterior horn [mm]. 2.2 follows from the non-planarity angle of 145° of the same group.
    pub posterior_height_mm: f64,
    /// Commissures, as an angle from mid-anterior seen from the middle of the anteroposterior diameter [°].
    /// Half of 121 ± 11° (82 cadaver hearts, PMID 17965505).
    pub commissure_half_angle_deg: f64,
    /// Trigones, likewise [°]. Half of 76 ± 13° (same hearts).
    pub trigone_half_angle_deg: f64,
}

impl Default for AnnulusDimensions {
    fn default() -> Self {
        Self {
            transverse_mm: 38.0,
            anteroposterior_mm: 28.0,
            anterior_fraction: 0.40,
            anterior_height_mm: 6.9,
            posterior_height_mm: 2.2,
            commissure_half_angle_deg: 60.5,
            trigone_half_angle_deg: 38.0,
        }
    }
}

/// The leaflets, hanging open from the annulus as one funnel. Heights are lengths along the leaflet.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct LeafletDimensions {
    /// Heights at the middles of A1, A2, A3 [mm]. A2: 20.6 ± 4.2 at autopsy of 200 hearts (Krawczyk-Ozog
    /// 2017, in paper 004); A1 and A3 our choice, so that closure reaches the commissures.
    pub anterior_heights_mm: [f64; 3],
    /// Heights at the middles of P1, P2, P3 [mm]. 11.0, 12.9, 10.4 (± 2.5 to 2.8) in the same hearts.
    pub posterior_heights_mm: [f64; 3],
    /// Height at the commissures [mm]. Our choice; 5 to 8 is usual.
    pub commissure_height_mm: f64,
    /// Factor on all heights [1]. 1.25, our choice: A2 and P2 become 25.8 and 16.1 mm, a little more than one published
    /// standard deviation above the autopsy means and than 24.1 and 14.0 mm by echo in the living (13.4 and 7.8 mm per m²,
    /// at 1.8 m²). At 1.2 the valve closes barely: holes of 2 to 4 mm² stay at the commissures.
    pub height_scale: f64,
    /// How deep the margin is indented between the posterior scallops, over the local height [1]. Our choice:
    /// so mild that closure bridges it. True clefts are 0.3 to 0.5.
    pub indentation_depth: f64,
    /// Full width of these indentations at half depth [mm]. Our choice.
    pub indentation_width_mm: f64,
    /// Angle of the open leaflets from the vertical at the margin [°]. Our choice: a clear orifice, and few
    /// chordae taut while open.
    pub opening_angle_deg: f64,
    /// How much more inward the leaflets leave the annulus [°]; they bend as circular arcs. Our choice.
    pub annular_turn_deg: f64,
    /// Tissue thickness [mm]. 1 mm in papers 002 and 003.
    pub thickness_mm: f64,
    /// Stress-strain law of both leaflets.
    pub tissue: Tissue,
}

impl Default for LeafletDimensions {
    fn default() -> Self {
        Self {
            anterior_heights_mm: [17.5, 20.6, 17.5],
            posterior_heights_mm: [11.0, 12.9, 10.4],
            commissure_height_mm: 8.0,
            height_scale: 1.25,
            indentation_depth: 0.08,
            indentation_width_mm: 3.0,
            opening_angle_deg: 20.0,
            annular_turn_deg: 12.0,
            thickness_mm: 1.0,
            tissue: Tissue::default(),
        }
    }
}

/// The papillary tips. Each muscle has three heads: anterior, middle, posterior.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct PapillaryPositions {
    /// Middle head of the anterolateral muscle [mm]. 23.5 mm from trigone and P1-P2 border (57 hearts, Sakai 1999)
    /// would be about [10, 0, -16]; moved down and back towards systolic CT (23-27 mm below the annulus, 11-14 mm
    /// posterior), which puts the closure line where it is published.
    pub anterolateral_mm: [f64; 3],
    /// Middle head of the posteromedial muscle [mm]. Likewise.
    pub posteromedial_mm: [f64; 3],
    /// Where disease has moved the anterolateral heads [mm]; rest lengths do not follow.
    pub anterolateral_shift_mm: [f64; 3],
    /// Where disease has moved the posteromedial heads [mm].
    pub posteromedial_shift_mm: [f64; 3],
    /// Distance of the outer heads from the middle head [mm]. Our choice.
    pub head_spread_mm: f64,
}

impl Default for PapillaryPositions {
    fn default() -> Self {
        Self {
            anterolateral_mm: [12.0, 4.0, -20.0],
            posteromedial_mm: [-12.0, 5.0, -21.0],
            anterolateral_shift_mm: [0.0; 3],
            posteromedial_shift_mm: [0.0; 3],
            head_spread_mm: 2.0,
        }
    }
}

/// The closed shape from which chord rest lengths are taken, as paper 003 takes them from the closed valve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct ClosedShapeTarget {
    /// How far across the closure line lies, from the anterior to the posterior annulus [1]. 0.64: coaptation
    /// distance 17.9 of 28 mm.
    pub closure_line_fraction: f64,
    /// Depth of the middle of the closure line below the mean height of the annulus [mm]. 4 to 7 in health; 7, because
    /// the belly's rise under pressure takes the line up again.
    pub tenting_height_mm: f64,
    /// How far the margins hang below the closure line in the middle [mm]. Our choice.
    pub coaptation_length_mm: f64,
    /// The same at the commissures [mm]. Our choice.
    pub commissural_coaptation_length_mm: f64,
    /// Rise of the leaflet belly above the straight line from annulus to closure line, over that line [1].
    /// Negative, our choice: strut and basal chordae hold the belly back, and it bulges between them by itself.
    pub belly_fraction: f64,
}

impl Default for ClosedShapeTarget {
    fn default() -> Self {
        Self {
            closure_line_fraction: 0.64,
            tenting_height_mm: 7.0,
            coaptation_length_mm: 5.5,
            commissural_coaptation_length_mm: 4.0,
            belly_fraction: -0.12,
        }
    }
}

/// The chordae. Moduli and sections: Kunzelman & Cochran 1990 as quoted in paper 000, beyond the toe.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct ChordPattern {
    /// Marginal chordae of the anterior leaflet. Our choice near the 9 of Lam 1970.
    pub marginal_anterior: u32,
    /// Marginal chordae of the posterior leaflet. 14 in Lam 1970.
    pub marginal_posterior: u32,
    /// Intermediate chordae to the rough zone of each leaflet. Our choice.
    pub intermediate_per_leaflet: u32,
    /// Basal chordae of the posterior leaflet. Our choice; Lam 1970 counts 2, other authors far more.
    pub basal_posterior: u32,
    /// Whether the anterior leaflet has its two strut chordae, at 4 and 8 o'clock (Lam 1970).
    pub struts: bool,
    /// Into how many branches a marginal or strut chord splits. 3 (Lam 1970).
    pub branches: u32,
    /// Where it splits, as a fraction of the way from the papillary tip [1]. Our choice: near the leaflet.
    pub branch_position: f64,
    /// Strain of every chord in the closed shape [1]. 0.025: knee of the chord law in paper 000.
    pub closed_strain: f64,
    /// Factor on all rest lengths [1]: below 1 shortened, above 1 elongated.
    pub rest_length_scale: f64,
    /// The annulus in which the chordae had the right length; absent: the valve's own. A dilated annulus with
    /// chordae of normal length is the mark of functional regurgitation (Obase).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rest_annulus: Option<AnnulusDimensions>,
    /// Share of the posterior margin, around its middle, whose marginal and intermediate chordae are ruptured
    /// [1].
    pub ruptured_posterior_fraction: f64,
    /// Diameter of marginal and intermediate chordae [mm]. 0.40 mm².
    pub marginal_diameter_mm: f64,
    /// Modulus of marginal and intermediate chordae [MPa]. 3406 g/mm².
    pub marginal_modulus_mpa: f64,
    /// Diameter of basal and strut chordae [mm]. 2.05 mm².
    pub basal_diameter_mm: f64,
    /// Modulus of basal and strut chordae [MPa]. 2120 g/mm².
    pub basal_modulus_mpa: f64,
}

impl Default for ChordPattern {
    fn default() -> Self {
        Self {
            marginal_anterior: 8,
            marginal_posterior: 14,
            intermediate_per_leaflet: 4,
            basal_posterior: 6,
            struts: true,
            branches: 3,
            branch_position: 0.7,
            closed_strain: 0.025,
            rest_length_scale: 1.0,
            rest_annulus: None,
            ruptured_posterior_fraction: 0.0,
            marginal_diameter_mm: 0.714,
            marginal_modulus_mpa: 33.4,
            basal_diameter_mm: 1.616,
            basal_modulus_mpa: 20.8,
        }
    }
}

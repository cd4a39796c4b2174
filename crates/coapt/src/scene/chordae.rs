//! Chordae and what they are made of.

use serde::{Deserialize, Serialize};

/// Chordae of one kind: tension-only rods. A chord may branch and may be a polyline of several segments.
/// An end is welded to the papillary tip, the leaflet point or the other chord end that it lies on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ChordGroup {
    /// Name in reports, for example `marginal`.
    pub name: String,
    /// File with line cells (.vtk, .vtp), relative to the scene file. Cell arrays `rest_length_mm` and
    /// `area_mm2` are read where present.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh_file: Option<String>,
    /// The segments themselves, instead of a file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<LineMesh>,
    /// Rod diameter [mm] where the mesh gives no areas; 1 mm in paper 003.
    #[serde(default = "default_chord_diameter_mm")]
    pub diameter_mm: f64,
    /// Young's modulus in tension [MPa] of a linear law, instead of `law`; 30 where neither is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub modulus_mpa: Option<f64>,
    /// The stress-strain law, instead of `modulus_mpa`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub law: Option<ChordLaw>,
    /// Factor on all rest lengths [1]: below 1 shortens, above 1 elongates.
    #[serde(default = "default_rest_length_scale")]
    pub rest_length_scale: f64,
    /// Leaflet tissue this near an insertion shares the chord's pull, most in the middle [mm]; 0: the point alone.
    #[serde(default = "default_insertion_radius_mm")]
    pub insertion_radius_mm: f64,
}

/// Paper 003, section 2.2.
fn default_chord_diameter_mm() -> f64 {
    1.0
}

/// Paper 003 prints none. Kunzelman & Cochran 1990 as quoted in paper 000: marginal 33, basal 21 MPa beyond
/// the toe; 30 is our choice in that range.
const DEFAULT_CHORD_MODULUS_MPA: f64 = 30.0;

fn default_rest_length_scale() -> f64 {
    1.0
}

/// Our choice: chordae flare into the leaflet over two to three millimetres. A membrane gives way without bound under a
/// pull on a point: with 0 the belly sinks by another half millimetre each time the mesh is refined; beyond 2 the fans
/// of neighbouring chordae run into one another.
pub(crate) fn default_insertion_radius_mm() -> f64 {
    1.5
}

impl ChordGroup {
    /// The law that its chordae follow.
    pub fn law(&self) -> ChordLaw {
        let linear = ChordLaw::Linear {
            modulus_mpa: self.modulus_mpa.unwrap_or(DEFAULT_CHORD_MODULUS_MPA),
        };
        self.law.clone().unwrap_or(linear)
    }
}

/// A law of engineering stress σ over strain ε = l / L − 1; slack chordae carry nothing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, tag = "kind", rename_all = "kebab-case")]
pub enum ChordLaw {
    /// σ = E ε (paper 003).
    Linear {
        /// Young's modulus E [MPa].
        modulus_mpa: f64,
    },
    /// A soft toe, then stiff (paper 000, after Kunzelman & Cochran 1990: marginal 3.06 then 33.4 MPa, basal 0.647 then
    /// 20.8 MPa, from a strain of 0.025).
    PiecewiseLinear {
        /// Modulus of the toe [MPa].
        toe_modulus_mpa: f64,
        /// Strain at which the toe ends [mm/mm].
        transition_strain: f64,
        /// Modulus beyond it [MPa].
        modulus_mpa: f64,
    },
    /// σ = a (e^{bε} − 1): paper 001 names such a law without its constants.
    Exponential {
        /// a [MPa].
        scale_mpa: f64,
        /// b [1].
        exponent: f64,
    },
    /// σ = a (e^{bε} − 1) until all fibres are recruited, and on along a line from there: collagen of Kaiser et al.
    /// (arXiv 1902.00018; a 4.6434e-4 MPa, b 49.9643, 0.145, 32.5 MPa).
    Collagen {
        /// a [MPa].
        scale_mpa: f64,
        /// b [1].
        exponent: f64,
        /// Strain from which all fibres carry [mm/mm].
        full_recruitment_strain: f64,
        /// Modulus from there on [MPa].
        modulus_mpa: f64,
    },
    /// Straight lines through measured points, and on along the last of them.
    Table {
        /// Strains, ascending from 0 [mm/mm], shape `[point]`.
        strain: Vec<f64>,
        /// Stresses, from 0 and nowhere falling [MPa], shape `[point]`.
        stress_mpa: Vec<f64>,
    },
}

/// Line segments with what is known of each.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct LineMesh {
    /// Points in the open phase [mm], shape `[point]`.
    pub points_mm: Vec<[f64; 3]>,
    /// Segments as point numbers from 0, shape `[segment]`.
    pub segments: Vec<[u32; 2]>,
    /// Unloaded length of each segment [mm], shape `[segment]`; absent: its length in the open phase.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rest_length_mm: Option<Vec<f64>>,
    /// Cross-section of each segment [mm²], shape `[segment]`; absent: from the group's diameter.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub area_mm2: Option<Vec<f64>>,
}

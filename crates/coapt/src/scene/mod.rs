//! What a person writes: anatomy, tissue, load, contact. Plain data; every number carries its unit in its name.
//!
//! A scene may name mesh files. The library never opens them: `coapt-io` reads a scene and puts the geometry
//! in the `mesh` fields. [`crate::model::Model::build`] then checks all of it and reports every fault it finds.

mod chordae;
mod readable;
mod repair;
mod repair_chordae;
mod repair_leaflet;
mod tissue;

use serde::{Deserialize, Serialize};

pub(crate) use chordae::default_insertion_radius_mm;
pub use chordae::{ChordGroup, ChordLaw, LineMesh};
pub use readable::Readable;
pub use repair::{Alfieri, Attachment, Clip, ClipModel, ClipSize, Plan, Repair, Ring, RingFamily, Site};
pub use repair_chordae::{
    AnnulusPlace, ChordPart, CloseCleft, CutChord, Neochord, RelocatePapillary, Rupture, Segment,
    TransferChord,
};
pub use repair_leaflet::{Augment, Resect, ResectionShape};
pub use tissue::{
    SpringBranches, Tissue, Wrinkling, default_bending_modulus_mpa, default_compression_modulus_ratio,
    default_poisson_ratio,
};

/// The scene layout that this version reads and writes.
pub const SCHEMA_VERSION: u32 = 1;

/// A valve, open and unpressurised, and what is done to it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// Layout of this file; this version reads 1.
    pub schema_version: u32,
    /// What the case is called in reports.
    pub name: String,
    /// The patient frame of all coordinates in this scene; Slicer's default is LPS.
    #[serde(default)]
    pub space: Space,
    /// The leaflets. Points that several leaflets share are welded.
    pub leaflets: Vec<Leaflet>,
    /// Where the leaflets hinge, and how that moves from the open to the closed phase.
    #[serde(default)]
    pub annulus: Annulus,
    /// The papillary muscles with the tips that chordae spring from.
    #[serde(default)]
    pub papillary: Vec<PapillaryMuscle>,
    /// Groups of chordae, each with one tissue.
    #[serde(default)]
    pub chordae: Vec<ChordGroup>,
    /// Peak systolic pressure.
    pub load: Load,
    /// How leaflets touch.
    #[serde(default)]
    pub contact: Contact,
    /// Named points on the annulus; what is left out is found geometrically.
    #[serde(default)]
    pub landmarks: Landmarks,
    /// How near points must be to count as one.
    #[serde(default)]
    pub weld: Weld,
    /// How the equilibrium is sought.
    #[serde(default)]
    pub settings: Settings,
}

/// A patient coordinate frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Space {
    /// x to the patient's left, y posterior, z superior (DICOM, Slicer files).
    #[default]
    LPS,
    /// x to the patient's right, y anterior, z superior.
    RAS,
}

/// One leaflet: its open shape, which is also its unloaded shape, and its tissue.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Leaflet {
    /// Name in reports; `anterior` and `posterior` also orient the landmarks.
    pub name: String,
    /// Surface file (.vtk, .vtp, .ply, .stl, .obj), relative to the scene file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh_file: Option<String>,
    /// Take only the cells whose `leaflet` array has this value, for a file that holds several leaflets.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub region: Option<i64>,
    /// The surface itself, instead of a file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<SurfaceMesh>,
    /// Tissue thickness [mm]; with the moduli it gives the membrane stiffness. 1 mm in papers 002 and 003.
    #[serde(default = "default_thickness_mm")]
    pub thickness_mm: f64,
    /// The stress-strain law.
    #[serde(default)]
    pub tissue: Tissue,
}

fn default_thickness_mm() -> f64 {
    1.0
}

/// A triangulated surface with what is known at its points.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SurfaceMesh {
    /// Points of the open, unloaded surface [mm], shape `[point]`.
    pub points_mm: Vec<[f64; 3]>,
    /// Triangles as point numbers from 0, shape `[face]`.
    pub faces: Vec<[u32; 3]>,
    /// Points on the annulus, where the file marks them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub annulus_points: Option<Vec<u32>>,
    /// Prescribed motion of annulus points from the open to the closed phase [mm], shape `[point]`;
    /// other points' entries are ignored. Absent: the annulus stays.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub annulus_displacement_mm: Option<Vec<[f64; 3]>>,
}

/// Which boundary points of the leaflets are annulus. The first of these that is given decides: points marked in
/// the leaflet meshes, a curve, else the boundary loop that lies farthest from the papillary tips.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Annulus {
    /// Annulus curve from a file: Slicer markups JSON or a polyline (.vtk, .vtp).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve_file: Option<String>,
    /// Annulus curve as a closed polyline [mm], shape `[point]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve_mm: Option<Vec<[f64; 3]>>,
    /// Boundary points this near the curve are annulus [mm].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve_tolerance_mm: Option<f64>,
    /// Name of the leaflet files' point array that is non-zero on the annulus.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub marker_array: Option<String>,
    /// Name of the leaflet files' point array with the annulus' prescribed motion [mm], 3 components.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub displacement_array: Option<String>,
}

/// A papillary muscle: one or several tips.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PapillaryMuscle {
    /// Name in reports, for example `anterolateral`.
    pub name: String,
    /// Tips in the open phase [mm], shape `[tip]`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tips_mm: Vec<[f64; 3]>,
    /// Slicer markups JSON with the tips, instead of `tips_mm`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tips_file: Option<String>,
    /// Prescribed motion of each tip to the closed phase [mm], shape `[tip]`; empty: the tips stay.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub displacements_mm: Vec<[f64; 3]>,
}

/// The transvalvular pressure at peak systole, in exactly one unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Load {
    /// Pressure [mmHg].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pressure_mmhg: Option<f64>,
    /// Pressure [kPa].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pressure_kpa: Option<f64>,
}

/// Coordinates and other numbers beyond this are no anatomy in any unit; the bound keeps arithmetic finite.
pub(crate) const LARGEST: f64 = 1e7;

/// One millimetre of mercury [MPa].
pub const MMHG_MPA: f64 = 1.333_223_684e-4;

impl Load {
    /// A load of so many mmHg.
    pub fn mmhg(pressure_mmhg: f64) -> Self {
        Self {
            pressure_mmhg: Some(pressure_mmhg),
            pressure_kpa: None,
        }
    }

    /// The pressure [MPa]; nothing unless exactly one unit is given.
    pub fn pressure_mpa(&self) -> Option<f64> {
        match (self.pressure_mmhg, self.pressure_kpa) {
            (Some(mmhg), None) => Some(mmhg * MMHG_MPA),
            (None, Some(kpa)) => Some(kpa * 1e-3),
            _ => None,
        }
    }
}

/// How leaflets touch: a penalty that grows without bound as the mid-surfaces approach each other.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Contact {
    /// Mid-surface distance at which contact begins [mm].
    pub thickness_mm: f64,
    /// Scale of the contact pressure [MPa]; see [`crate::contact`] for the law. 0: leaflets pass through each other, as in
    /// models without contact.
    pub stiffness_mpa: f64,
}

impl Default for Contact {
    fn default() -> Self {
        // Mid-surfaces of leaflets that lie on each other are one leaflet thickness apart: 1 mm (papers 002, 003).
        // The stiffness is our choice: at 0.5 MPa and 100 mmHg the leaflets come to rest at about 90 % of the thickness;
        // softer lets them sink in, stiffer worsens the conditioning.
        Self {
            thickness_mm: 1.0,
            stiffness_mpa: 0.5,
        }
    }
}

impl Contact {
    /// Whether leaflets touch at all.
    pub fn is_on(&self) -> bool {
        self.stiffness_mpa > 0.0
    }
}

/// Named points on the annulus [mm].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Landmarks {
    /// Middle of the anterior annulus (A2 hinge).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mid_anterior_mm: Option<[f64; 3]>,
    /// Middle of the posterior annulus (P2 hinge).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mid_posterior_mm: Option<[f64; 3]>,
    /// Anterolateral commissure.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub commissure_anterolateral_mm: Option<[f64; 3]>,
    /// Posteromedial commissure.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub commissure_posteromedial_mm: Option<[f64; 3]>,
    /// Left (anterolateral side) fibrous trigone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub trigone_left_mm: Option<[f64; 3]>,
    /// Right (posteromedial side) fibrous trigone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub trigone_right_mm: Option<[f64; 3]>,
}

/// How near points must be to count as one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Weld {
    /// Leaflet points, branch nodes and papillary tips within this distance are one [mm].
    pub tolerance_mm: f64,
    /// A chord end within this distance of a leaflet inserts at its nearest point [mm].
    pub insertion_tolerance_mm: f64,
}

impl Default for Weld {
    fn default() -> Self {
        // Our choice: a hundredth of a millimetre is below any imaging resolution and above the rounding of
        // text files; insertion points are drawn by hand, to about half a mesh edge.
        Self {
            tolerance_mm: 0.01,
            insertion_tolerance_mm: 1.0,
        }
    }
}

/// How the equilibrium is sought.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Settings {
    /// Largest force left on a free vertex, over the mean nodal pressure force or, where that is more, the pull of a strain of
    /// 1e-3 [1].
    pub residual_tolerance: f64,
    /// Give up after so many solver iterations on one mesh, begun anew or not, and say so.
    pub iteration_limit: u32,
    /// Whether an open valve is closed on coarser meshes first. The result is the same but for what several stable shapes
    /// allow; without it large meshes take far longer.
    pub coarse_to_fine: bool,
    /// Longest step of the solver over its own choice [1]; for studies of how far the result depends on the road.
    pub step_scale: f64,
    /// Valves of more triangles are refused, with an estimate of what closing them would cost.
    pub face_limit: u32,
}

impl Default for Settings {
    fn default() -> Self {
        // 1e-3 already leaves position errors below 0.01 mm; three digits more are a few Newton steps and make
        // force balances exact to 1e-6.
        Self {
            residual_tolerance: 1e-6,
            // Our choice: hard cases need up to 2,300 (`docs/hard-cases.md`), those begun anew among them; what takes more never
            // came to rest.
            iteration_limit: 4000,
            coarse_to_fine: true,
            step_scale: 1.0,
            // Some 11 GB and 8 minutes: what a good workstation has to spare. Leaflets of 250,000 triangles have edges of
            // 0.1 mm, a tenth of their thickness: no shell model gains by more.
            face_limit: 250_000,
        }
    }
}

/// Something wrong, or repaired, in what was given.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// An error stops; a warning is reported with the result.
    pub severity: Severity,
    /// Where: the key path in the scene (`leaflets[0].thickness_mm`), with an element where there is one
    /// (`leaflets[0].mesh face 12`).
    pub place: String,
    /// What was found, its value and what was expected.
    pub message: String,
    /// Whether what is asked for is right in itself, and only this valve's shape does not allow it: a ring that does not fit, a
    /// clip over another.
    pub of_shape: bool,
}

/// Whether a fault stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// Nothing can be computed.
    Error,
    /// Computed all the same; the reader must know.
    Warning,
}

impl Fault {
    /// A fault that stops.
    pub fn error(place: impl Into<String>, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Error,
            place: place.into(),
            message: short(message.into()),
            of_shape: false,
        }
    }

    /// A fault that stops, though with another valve it would not.
    pub fn of_shape(place: impl Into<String>, message: impl Into<String>) -> Self {
        Self {
            of_shape: true,
            ..Self::error(place, message)
        }
    }

    /// A fault that is reported with the result.
    pub fn warning(place: impl Into<String>, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Warning,
            place: place.into(),
            message: short(message.into()),
            of_shape: false,
        }
    }
}

/// Letters of a message at most: it may quote a file, and one word of a file may be all of it. Our longest own, the list of
/// all keys of a scene, has a third of these.
const MOST_LETTERS: usize = 1000;

fn short(mut message: String) -> String {
    if let Some((end, _)) = message.char_indices().nth(MOST_LETTERS) {
        message.truncate(end);
        message.push('…');
    }
    message
}

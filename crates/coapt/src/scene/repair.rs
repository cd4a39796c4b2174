//! What a surgeon does to the valve, as a person writes it.

use serde::{Deserialize, Serialize};

use super::{Augment, CloseCleft, CutChord, Neochord, RelocatePapillary, Resect, Rupture, TransferChord};

/// A list of repairs, applied in order.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Plan {
    /// Layout of this file; this version reads 1.
    pub schema_version: u32,
    /// What the plan is called in reports.
    #[serde(default)]
    pub name: String,
    /// The repairs.
    #[serde(default)]
    pub repair: Vec<Repair>,
}

/// One surgical deed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, tag = "kind", rename_all = "kebab-case")]
pub enum Repair {
    /// Annuloplasty: the annulus is drawn onto a ring.
    Ring(Ring),
    /// Edge-to-edge repair with a clip, which grips both leaflets between its arms.
    Clip(Clip),
    /// Edge-to-edge repair with stitches (Alfieri): a stretch of both margins is sewn together.
    Alfieri(Alfieri),
    /// Artificial chordae from a papillary tip to a leaflet.
    Neochord(Neochord),
    /// Chordae are cut, as those that tether a leaflet.
    CutChord(CutChord),
    /// A chord is set to another place of a leaflet or to another papillary tip.
    TransferChord(TransferChord),
    /// Chordae tear; no repair, but what one is for.
    Rupture(Rupture),
    /// A papillary muscle is drawn elsewhere.
    RelocatePapillary(RelocatePapillary),
    /// An indentation of the posterior margin is sewn up.
    CloseCleft(CloseCleft),
    /// A piece of a leaflet is cut out, and the edges of the gap are sewn together.
    Resect(Resect),
    /// A patch is set into a leaflet, which makes it higher.
    Augment(Augment),
}

/// An annuloplasty ring: a parametric family with a size, or a curve.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Ring {
    /// Parametric family; needs `size_mm`. A generic shape, not any maker's geometry.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub family: Option<RingFamily>,
    /// Inner transverse diameter [mm], for a family.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size_mm: Option<f64>,
    /// Inner anteroposterior diameter [mm], instead of the family's share of the size.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ap_mm: Option<f64>,
    /// How far the ring's anterior middle stands above its widest line, toward the atrium [mm], instead of the family's share of
    /// the size. The posterior middle stands up in the family's proportion to it, in a planar family's by 0.3, as in `saddle`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub saddle_height_mm: Option<f64>,
    /// Ring curve from a file: Slicer markups JSON or a polyline (.vtk, .vtp).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve_file: Option<String>,
    /// Ring curve as a polyline [mm], shape `[point]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve_mm: Option<Vec<[f64; 3]>>,
    /// Whether the curve closes on itself; a family knows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub closed: Option<bool>,
    /// Use the curve where it stands instead of fitting it to the annulus' landmarks.
    #[serde(default)]
    pub placed: bool,
    /// How annulus points find their place on the ring.
    #[serde(default)]
    pub attachment: Attachment,
    /// How many sutures there are, for `attachment = "sutures"`; absent: 12, of the 10 to 14 that are usual.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sutures: Option<u32>,
    /// The ring is a thread in the annulus rather than a frame: it takes the annulus' length, not its shape.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub flexible: bool,
}

/// Parametric ring shapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum RingFamily {
    /// Open, rigid, planar.
    ClassicLike,
    /// Closed, mild anterior saddle.
    PhysioLike,
    /// Closed, pronounced saddle.
    Saddle,
    /// Closed, reduced anteroposterior diameter.
    ReducedAp,
    /// Open band along the posterior annulus.
    PosteriorBand,
}

/// How annulus points find their place on a ring.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Attachment {
    /// Between matching landmarks, in proportion to arc length: close to evenly spaced sutures.
    #[default]
    ArcLength,
    /// Each point to the nearest point of the ring (paper 003).
    NearestPoint,
    /// Evenly spaced sutures draw the annulus onto the ring where they are, as far along it as by arc length; what lies between
    /// moves as they do, smoothly from one to the next, and keeps its shape beside that.
    Sutures,
}

/// A named place along the line of closure; see [`crate::repair::site`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Site {
    /// The middle of the anterolateral third.
    A1P1,
    /// The middle.
    A2P2,
    /// The middle of the posteromedial third.
    A3P3,
}

/// A clip that grips both leaflets between its arms, from the margin on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Clip {
    /// Where along the line of closure, by name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub site: Option<Site>,
    /// Where along the line of closure, as share of the margin's arc length from the anterolateral commissure [1]; instead of
    /// `site`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position: Option<f64>,
    /// How large it is.
    #[serde(default)]
    pub size: ClipSize,
    /// How far the arms lean from the perpendicular of the margin toward the posteromedial commissure [°], on both leaflets.
    #[serde(default)]
    pub angle_deg: f64,
    /// How much of the anterior leaflet is gripped, from its margin [mm]; absent: 3 less than the arms, 6 or 9.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub grasp_anterior_mm: Option<f64>,
    /// How much of the posterior leaflet is gripped, from its margin [mm]; absent: 3 less than the arms, 6 or 9.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub grasp_posterior_mm: Option<f64>,
    /// How the grip is modelled.
    #[serde(default)]
    pub model: ClipModel,
    /// Stiffness of each tie between two gripped places [N/mm]; absent: 9.81 for springs, 50 for `rigid`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stiffness_n_per_mm: Option<f64>,
}

/// Clips by arm length and width. Generic ones: arms of 9 and 12 mm as in SlicerHeart's table of devices, widths along the
/// margin of 4 and 6 mm as usually quoted, no maker's geometry.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum ClipSize {
    /// Arms of 9 mm, 4 mm wide.
    #[default]
    Short,
    /// Arms of 9 mm, 6 mm wide.
    ShortWide,
    /// Arms of 12 mm, 4 mm wide.
    Long,
    /// Arms of 12 mm, 6 mm wide.
    LongWide,
}

impl ClipSize {
    /// Length of the arms [mm].
    pub fn arm_mm(self) -> f64 {
        match self {
            Self::Short | Self::ShortWide => 9.0,
            Self::Long | Self::LongWide => 12.0,
        }
    }

    /// Width along the margin [mm].
    pub fn width_mm(self) -> f64 {
        match self {
            Self::Short | Self::Long => 4.0,
            Self::ShortWide | Self::LongWide => 6.0,
        }
    }

    /// How much of a leaflet is gripped if nobody says [mm]: 6 of 9, 9 of 12. Our choice: an implanter wants leaflet to two
    /// thirds of the arm at least, and the rest lies about the clip's hinge.
    pub fn grasp_mm(self) -> f64 {
        self.arm_mm() - 3.0
    }
}

/// How a clip's grip is modelled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum ClipModel {
    /// Facing places are tied by springs (paper 000), between which the leaflets may shift a little along each other.
    #[default]
    Springs,
    /// Facing places are tied five times as stiffly and braced by diagonal ties, so that the leaflets move as one.
    Rigid,
}

impl ClipModel {
    /// Stiffness of each tie if nobody says [N/mm]. Springs: 1000 g/mm each in paper 000. Rigid: 10 to 50 are usual, the upper
    /// end is our choice; under the 0.3 N of a tie that is 0.006 mm.
    pub fn stiffness_n_per_mm(self) -> f64 {
        match self {
            Self::Springs => 9.81,
            Self::Rigid => 50.0,
        }
    }
}

/// Stitches that join a stretch of both margins.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Alfieri {
    /// Where along the line of closure, by name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub site: Option<Site>,
    /// Where along the line of closure, as share of the margin's arc length from the anterolateral commissure [1]; instead of
    /// `site`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position: Option<f64>,
    /// Length of the stretch [mm]. 5 to 10 is usual; 8 is our choice.
    #[serde(default = "default_alfieri_length_mm")]
    pub length_mm: f64,
    /// How far from the margin the stitches go through the leaflets [mm]. 2 is our choice: what a thread holds in.
    #[serde(default = "default_bite_mm")]
    pub bite_mm: f64,
}

fn default_alfieri_length_mm() -> f64 {
    8.0
}

fn default_bite_mm() -> f64 {
    2.0
}

impl Default for Alfieri {
    fn default() -> Self {
        Self {
            site: None,
            position: None,
            length_mm: default_alfieri_length_mm(),
            bite_mm: default_bite_mm(),
        }
    }
}

//! What a surgeon does to the valve, as a person writes it.

use serde::{Deserialize, Serialize};

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
}

/// An annuloplasty ring: a parametric family with a size, or a curve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Ring {
    /// Parametric family; needs `size_mm`. A generic shape, not any maker's geometry.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub family: Option<RingFamily>,
    /// Inner transverse diameter [mm], for a family.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size_mm: Option<f64>,
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

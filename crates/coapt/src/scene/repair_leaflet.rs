//! What a surgeon cuts out of a leaflet or sets into it, as a person writes it.

use serde::{Deserialize, Serialize};

use super::Site;

/// A piece of a leaflet is cut out at its margin, and the edges of the gap are sewn together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Resect {
    /// Name of the leaflet.
    pub leaflet: String,
    /// What is cut out.
    pub shape: ResectionShape,
    /// Where along the margin the middle of the piece is, by name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub site: Option<Site>,
    /// Where along the margin, as share of its arc length from the anterolateral commissure [1]; instead of `site`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position: Option<f64>,
    /// Width of the piece at the margin [mm]; absent: 10 for a triangle, 15 for a quadrangle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub width_mm: Option<f64>,
    /// How much of the leaflet's height a triangle takes [1]; absent: two thirds, as is usual.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height_fraction: Option<f64>,
    /// How much a quadrangle leaves at the annulus [mm]; absent: 3, our choice: what holds the stitches of the plication.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub strip_mm: Option<f64>,
    /// Whether chordae that insert in the piece are cut with it; else they forbid the resection.
    #[serde(default)]
    pub cut_chords: bool,
}

impl Resect {
    /// A shape out of a leaflet, all else absent or as usual.
    pub fn of(leaflet: &str, shape: ResectionShape) -> Self {
        Self {
            leaflet: leaflet.to_owned(),
            shape,
            site: None,
            position: None,
            width_mm: None,
            height_fraction: None,
            strip_mm: None,
            cut_chords: false,
        }
    }
}

/// What piece of a leaflet a resection takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum ResectionShape {
    /// A triangle with its base on the margin and its apex toward the annulus.
    Triangular,
    /// Nearly the whole height, between two lines straight up from the margin; the annulus above is plicated.
    Quadrangular,
}

impl ResectionShape {
    /// Usual widths at the margin, from and to [mm]; as often quoted, not checked by us.
    pub fn usual_width_mm(self) -> [f64; 2] {
        match self {
            Self::Triangular => [8.0, 15.0],
            Self::Quadrangular => [10.0, 20.0],
        }
    }

    /// Width at the margin if nobody says [mm], within the usual ones (our choice).
    pub fn width_mm(self) -> f64 {
        match self {
            Self::Triangular => 10.0,
            Self::Quadrangular => 15.0,
        }
    }
}

/// A patch, of pericardium say, is set into a leaflet near the annulus, which makes it higher.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Augment {
    /// Name of the leaflet.
    pub leaflet: String,
    /// Where along the margin the middle of the patch is, by name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub site: Option<Site>,
    /// Where along the margin, as share of its arc length from the anterolateral commissure [1]; instead of `site`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position: Option<f64>,
    /// Width of the patch, from the annulus toward the margin, in its middle [mm]: 8 to 15 is usual, 10 our choice.
    #[serde(default = "default_patch_width_mm")]
    pub width_mm: f64,
    /// Length of the patch along the leaflet, measured on the margin [mm]; from its middle to its ends its width fades to nothing.
    /// 30 is our choice: the middle segment and half of its neighbours.
    #[serde(default = "default_patch_length_mm")]
    pub length_mm: f64,
    /// Part of the leaflet's height that lies between annulus and patch [1]; absent: a quarter, our choice.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fraction: Option<f64>,
}

fn default_patch_width_mm() -> f64 {
    10.0
}

fn default_patch_length_mm() -> f64 {
    30.0
}

impl Augment {
    /// To a leaflet, all else absent or as usual.
    pub fn of(leaflet: &str) -> Self {
        Self {
            leaflet: leaflet.to_owned(),
            site: None,
            position: None,
            width_mm: default_patch_width_mm(),
            length_mm: default_patch_length_mm(),
            fraction: None,
        }
    }
}

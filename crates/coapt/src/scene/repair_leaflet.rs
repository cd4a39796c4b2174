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
    /// Width of the piece at the margin [mm]; absent: [`ResectionShape::width_mm`].
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
    /// Width at the margin if nobody says [mm]: 10 of the usual 8 to 15, and 15 of the usual 10 to 20 (our choice).
    pub fn width_mm(self) -> f64 {
        match self {
            Self::Triangular => 10.0,
            Self::Quadrangular => 15.0,
        }
    }
}

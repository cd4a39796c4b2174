//! What a surgeon does to chordae and papillary muscles, as a person writes it.

use serde::{Deserialize, Serialize};

use super::Site;

/// Artificial chordae: threads of expanded polytetrafluoroethylene from a papillary tip to a leaflet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Neochord {
    /// Name of the leaflet that they are sewn to.
    pub leaflet: String,
    /// Where along the margin, by name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub site: Option<Site>,
    /// Where along the margin, as share of its arc length from the anterolateral commissure [1]; instead of `site`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position: Option<f64>,
    /// How far from the margin they are sewn [mm].
    #[serde(default)]
    pub inset_mm: f64,
    /// The place on the leaflet itself [mm], in the open valve; instead of `site` or `position`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub point_mm: Option<[f64; 3]>,
    /// Name of the papillary muscle; absent: that of the nearest tip.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub muscle: Option<String>,
    /// Number of the muscle's tip, from 0; absent: the nearest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tip: Option<u32>,
    /// How many strands. 2: a thread makes a loop.
    #[serde(default = "default_strands")]
    pub strands: u32,
    /// Distance along the margin between the outermost strands [mm]. 4 is our choice, about the distance of native marginal
    /// chordae. Strands to a point of their own all go there.
    #[serde(default = "default_spread_mm")]
    pub spread_mm: f64,
    /// Unloaded length from the tip to the leaflet [mm]. Must be there beside `point_mm`, where none is estimated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub length_mm: Option<f64>,
    /// Instead of a length, how far below the plane of the closed annulus the margin is to end [mm]; a geometric estimate.
    /// 5 where neither is given: 4 to 6 is usual.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub depth_mm: Option<f64>,
    /// Force over strain of each strand [N]. 90, our choice: the middle of the 30 to 150 N that are quoted for threads of
    /// 0.25 to 0.31 mm; one of 20 mm gives 0.1 mm under half a newton, anywhere in that range less than a mesh shows.
    #[serde(default = "default_axial_stiffness_n")]
    pub axial_stiffness_n: f64,
}

fn default_strands() -> u32 {
    2
}

fn default_spread_mm() -> f64 {
    4.0
}

fn default_axial_stiffness_n() -> f64 {
    90.0
}

impl Neochord {
    /// To a leaflet, all else absent or as usual.
    pub fn to(leaflet: &str) -> Self {
        Self {
            leaflet: leaflet.to_owned(),
            site: None,
            position: None,
            inset_mm: 0.0,
            point_mm: None,
            muscle: None,
            tip: None,
            strands: default_strands(),
            spread_mm: default_spread_mm(),
            length_mm: None,
            depth_mm: None,
            axial_stiffness_n: default_axial_stiffness_n(),
        }
    }
}

/// Chordae to be cut: those of a group, or those nearest to a place.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct CutChord {
    /// Name of the group it belongs to; absent: any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub group: Option<String>,
    /// A place near their insertions [mm], in the open valve; absent: all of the group.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub near_mm: Option<[f64; 3]>,
    /// How many, the nearest first; absent: one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub count: Option<u32>,
    /// What is cut.
    #[serde(default)]
    pub part: ChordPart,
}

/// What of a branched chord is meant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum ChordPart {
    /// The whole chord with all its branches.
    #[default]
    Chord,
    /// A branch: what inserts in one place.
    Branch,
}

/// A chord set elsewhere: its branch to another place of a leaflet, or all of it to another papillary tip. It keeps its
/// length.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct TransferChord {
    /// Name of the group it belongs to; absent: any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub group: Option<String>,
    /// A place near the insertion of the chord that is meant [mm], in the open valve.
    pub near_mm: [f64; 3],
    /// Name of the leaflet that it is sewn to; absent: it stays where it inserts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub leaflet: Option<String>,
    /// Where along the margin, by name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub site: Option<Site>,
    /// Where along the margin, as share of its arc length from the anterolateral commissure [1]; instead of `site`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position: Option<f64>,
    /// How far from the margin it is sewn [mm].
    #[serde(default)]
    pub inset_mm: f64,
    /// The new place on the leaflet itself [mm], in the open valve; instead of `site` or `position`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub point_mm: Option<[f64; 3]>,
    /// Name of the papillary muscle that it is set to; absent: it stays where it comes from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub muscle: Option<String>,
    /// Number of the muscle's tip, from 0; absent: the nearest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tip: Option<u32>,
}

/// Chordae that tear in one segment of a leaflet, from its middle outward.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Rupture {
    /// The segment.
    pub region: Segment,
    /// Names of the groups that tear.
    #[serde(default = "default_rupture_groups")]
    pub groups: Vec<String>,
    /// How many of the segment's chordae [1], rounded to whole chordae but at least one; absent: all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fraction: Option<f64>,
    /// How many, instead of a fraction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub count: Option<u32>,
}

/// Chordae that tear are most often marginal ones.
fn default_rupture_groups() -> Vec<String> {
    vec!["marginal".to_owned()]
}

impl Rupture {
    /// All marginal chordae of a segment.
    pub fn of(region: Segment) -> Self {
        Self {
            region,
            groups: default_rupture_groups(),
            fraction: None,
            count: None,
        }
    }
}

/// A third of a leaflet's margin by arc length, counted from the anterolateral commissure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Segment {
    /// Anterolateral third of the anterior leaflet.
    A1,
    /// Middle of the anterior leaflet.
    A2,
    /// Posteromedial third of the anterior leaflet.
    A3,
    /// Anterolateral third of the posterior leaflet.
    P1,
    /// Middle of the posterior leaflet.
    P2,
    /// Posteromedial third of the posterior leaflet.
    P3,
}

/// A papillary muscle whose tips end elsewhere when the valve is closed: by a vector, or toward a place of the annulus.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RelocatePapillary {
    /// Name of the muscle.
    pub muscle: String,
    /// By how much its tips move [mm].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub by_mm: Option<[f64; 3]>,
    /// Instead of a vector, the place of the closed annulus toward which they are drawn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub toward: Option<AnnulusPlace>,
    /// How far toward that place [mm]; 5 to 15 is usual.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub distance_mm: Option<f64>,
}

/// Named places of the annulus.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum AnnulusPlace {
    /// Middle of the anterior annulus.
    MidAnterior,
    /// Middle of the posterior annulus.
    MidPosterior,
    /// Anterolateral commissure.
    CommissureAnterolateral,
    /// Posteromedial commissure.
    CommissurePosteromedial,
    /// Left trigone.
    TrigoneLeft,
    /// Right trigone.
    TrigoneRight,
}

/// Stitches that join the two edges of an indentation of the posterior margin.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct CloseCleft {
    /// Where the indentation is, as share of the posterior margin's arc length from the anterolateral commissure [1]; its
    /// bottom is sought within 4 mm of there.
    pub position: f64,
    /// How far stitches go along its edges, from the bottom [mm].
    pub depth_mm: f64,
}

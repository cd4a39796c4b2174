//! Threads between two places of the leaflets: what clips, stitches and closed clefts are made of.
//!
//! A suture is a chord between two leaflet points, linear and carrying tension only: contact keeps the leaflets from passing
//! each other, the suture from parting.

use super::leaflet::LeafletMargin;
use super::rods::{Rod, place_mm, string};
use super::site::SiteMargins;
use crate::Vec3;
use crate::energy::chord::WeightedVertices;
use crate::model::{ChordKind, Model};
use crate::scene::Fault;

/// Unloaded length of a suture over the distance at which contact begins [1]: leaflets that pressure presses together come to
/// rest at nine tenths of it, and so a stitch holds them as pressure would.
const HELD_GAP: f64 = 0.9;

/// Stiffness of a stitch [N/mm]: as the springs that stand for a clip in paper 000, 1000 g/mm. Our choice for a thread: it gives
/// 0.05 mm under half a newton, which a seam does not show.
pub const STITCH_N_PER_MM: f64 = 9.81;

/// Two places that are drawn together.
#[derive(Clone, Debug, PartialEq)]
pub struct Stitch {
    /// The places.
    pub ends: [WeightedVertices; 2],
    /// Distance to which they are drawn [mm].
    pub length_mm: f64,
}

/// What sewing did.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Sewn {
    /// Name of the chord group that holds the sutures.
    pub name: String,
    /// How many there are.
    pub sutures: usize,
    /// Distance to which facing places are drawn [mm].
    pub gap_mm: f64,
    /// Largest distance in the open valve of places that are joined [mm].
    pub farthest_mm: f64,
}

/// The distance between mid-surfaces that are sewn together [mm]: nine tenths of that at which contact begins, or without
/// contact of the leaflets' mean thickness.
pub fn held_gap_mm(model: &Model) -> f64 {
    let thickness_mm = if model.contact.is_on() {
        model.contact.thickness_mm
    } else {
        let sum: f64 = model.leaflets.iter().map(|leaflet| leaflet.thickness_mm).sum();
        sum / model.leaflets.len().max(1) as f64
    };
    HELD_GAP * thickness_mm
}

/// Adds stitches as a chord group of their own. Each pulls with `stiffness_n_per_mm` times what it is longer than its length.
pub fn sew(model: &mut Model, name: &str, stitches: Vec<Stitch>, stiffness_n_per_mm: f64) -> Sewn {
    let gap_mm = held_gap_mm(model);
    let away_mm = |stitch: &Stitch| {
        let [a, b] = stitch.ends.each_ref().map(|end| place_mm(end, &model.rest_mm));
        (b - a).norm()
    };
    let farthest_mm = stitches.iter().map(away_mm).fold(0.0, f64::max);
    let sutures = stitches.len();
    // With a cross-section of L mm² a modulus in MPa is a stiffness in N/mm: T = A E (l / L − 1) = E (l − L).
    let rod = |stitch: Stitch| Rod {
        ends: stitch.ends,
        rest_length_mm: stitch.length_mm,
        area_mm2: stitch.length_mm,
    };
    let rods = stitches.into_iter().map(rod).collect();
    let name = string(model, name, ChordKind::Suture, stiffness_n_per_mm, rods);
    Sewn {
        name,
        sutures,
        gap_mm,
        farthest_mm,
    }
}

/// Refuses to sew where the leaflets are held together already: an earlier repair's sutures from leaflet to leaflet meet the
/// stretch of `width_mm` about the site of either margin. `what` is how the message calls the new repair.
///
/// # Errors
/// The overlap, with `place`, on the margin where more is missing.
pub fn refuse_overlap(
    model: &Model,
    site: &SiteMargins,
    width_mm: f64,
    what: &str,
    place: &str,
) -> Result<(), Fault> {
    for (number, group) in model.chord_groups.iter().enumerate() {
        if group.kind != ChordKind::Suture {
            continue;
        }
        let overlaps = site.margins.iter().filter_map(|margin| {
            let taken = stretch_mm(model, number, margin)?;
            let middle = site.position * margin.length_mm();
            let wanted = [middle - 0.5 * width_mm, middle + 0.5 * width_mm];
            let leaflet = &model.leaflets[margin.leaflet as usize].name;
            Overlap::of(leaflet, margin.length_mm(), [wanted, taken])
        });
        if let Some(overlap) = overlaps.max_by(|a, b| a.missing_share().total_cmp(&b.missing_share())) {
            return Err(Fault::of_shape(place, overlap.words(what, &group.name)));
        }
    }
    Ok(())
}

/// Two stretches of one margin that overlap.
struct Overlap<'a> {
    /// Name of the leaflet.
    leaflet: &'a str,
    /// How long its margin is [mm].
    margin_mm: f64,
    /// From where to where along the margin, of the new repair and of the earlier one [mm].
    stretches_mm: [[f64; 2]; 2],
    /// How far apart their middles are [mm].
    apart_mm: f64,
    /// How far apart they would have to be [mm].
    least_mm: f64,
}

impl<'a> Overlap<'a> {
    fn of(leaflet: &'a str, margin_mm: f64, stretches_mm: [[f64; 2]; 2]) -> Option<Self> {
        let [middle, other] = stretches_mm.map(|[from, to]| 0.5 * (from + to));
        let apart_mm = (middle - other).abs();
        let least_mm = stretches_mm.iter().map(|[from, to]| 0.5 * (to - from)).sum();
        (apart_mm < least_mm).then_some(Self {
            leaflet,
            margin_mm,
            stretches_mm,
            apart_mm,
            least_mm,
        })
    }

    /// How much farther off the site would have to be, as share of the margin [1].
    fn missing_share(&self) -> f64 {
        (self.least_mm - self.apart_mm) / self.margin_mm
    }

    fn words(&self, what: &str, earlier: &str) -> String {
        let [wanted_mm, taken_mm] = self.stretches_mm.map(|[from, to]| to - from);
        let [wanted, taken] = self
            .stretches_mm
            .map(|[from, to]| format!("from {:.3} to {:.3}", from / self.margin_mm, to / self.margin_mm));
        // Rounded away from each other, so that what is expected is never what is found.
        let apart_mm = (10.0 * self.apart_mm).floor() / 10.0;
        let least_mm = (10.0 * self.least_mm).ceil() / 10.0;
        format!(
            "{what} would take {wanted_mm:.1} mm of the {} margin, {wanted}, where the earlier `{earlier}` holds {taken_mm:.1} mm, \
             {taken}: their middles are {apart_mm:.1} mm apart along it, expected {least_mm:.1} mm at least",
            self.leaflet
        )
    }
}

/// The stretch of a leaflet's margin that a group of sutures to another leaflet holds [mm]: where the margin is nearest to each. Of a
/// deep grip on a bent margin that is more than its width.
fn stretch_mm(model: &Model, group: usize, margin: &LeafletMargin) -> Option<[f64; 2]> {
    let chords = &model.chords;
    let of_group = (0..chords.ends.len()).filter(|&segment| chords.group[segment] as usize == group);
    let mut stretch: Option<[f64; 2]> = None;
    for segment in of_group {
        let [a, b] = chords.ends[segment].map(|point| leaflet_of(model, &chords.points[point as usize]));
        if a == b {
            continue;
        }
        let on_leaflet = if a == margin.leaflet { 0 } else { 1 };
        let at: Vec3 = chords.point_mm(chords.ends[segment][on_leaflet], &model.rest_mm);
        if let Some(foot) = crate::mesh::polyline::nearest(&margin.points_mm, false, at) {
            let [first, last] = stretch.unwrap_or([foot.arc_mm; 2]);
            stretch = Some([first.min(foot.arc_mm), last.max(foot.arc_mm)]);
        }
    }
    stretch
}

/// The leaflet that a place lies on: that of a face with all its vertices, or where they are in several, of their first.
pub fn leaflet_of(model: &Model, place: &WeightedVertices) -> u32 {
    let holds = |face: &[u32; 3]| place.iter().all(|(vertex, _)| face.contains(vertex));
    let touches = |face: &[u32; 3]| place.iter().any(|(vertex, _)| face.contains(vertex));
    let face = model
        .faces
        .iter()
        .position(holds)
        .or_else(|| model.faces.iter().position(touches));
    face.map_or(0, |face| model.face_leaflet[face])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::coarsen::coarsen;
    use crate::mesh::parametric::{ValveParameters, generate};
    use crate::model::fixtures::{built, skirt};

    fn stitch() -> Stitch {
        Stitch {
            ends: [vec![(2, 1.0)], vec![(30, 0.5), (33, 0.5)]],
            length_mm: 0.9,
        }
    }

    /// 9.81 N per millimetre beyond the length, to rounding.
    #[test]
    fn a_suture_is_a_spring_that_only_pulls() {
        let mut model = built(&skirt()).model;
        let before = model.chords.ends.len();
        let sewn = sew(&mut model, "clip", vec![stitch()], 9.81);
        let tension = model.chords.tensions_n(&model.rest_mm)[before];
        assert!(
            (tension - 9.81 * (sewn.farthest_mm - 0.9)).abs() < 1e-9,
            "{tension}"
        );
        let together = vec![Vec3::zeros(); model.rest_mm.len()];
        assert_eq!(model.chords.tensions_n(&together)[before], 0.0);
        assert_eq!(sew(&mut model, "clip", vec![stitch()], 1.0).name, "clip (2)");
    }

    /// A coarse mesh has the same stitches, as long and as stiff, between places that lie where the coarse mesh has them.
    #[test]
    fn a_coarse_mesh_keeps_the_length_of_a_stitch() {
        let scene = generate(&ValveParameters::default()).unwrap();
        let mut model = built(&scene).model;
        let [a, b] = [&model.margins[0].vertices[0], &model.margins[0].vertices[10]].map(|&v| vec![(v, 1.0)]);
        let stitch = Stitch {
            ends: [a, b],
            length_mm: 0.9,
        };
        sew(&mut model, "stitch", vec![stitch], 9.81);
        let coarse = coarsen(&model, model.leaflet_vertex_count / 4).unwrap().model;
        assert_eq!(coarse.chord_groups, model.chord_groups);
        assert_eq!(coarse.chords.rest_length_mm.last(), Some(&0.9));
        assert_eq!(coarse.chords.area_mm2.last(), Some(&0.9));
    }
}

//! The distances under every definition, on the whole surface and on its parts.

use serde::{Deserialize, Serialize};

use super::regions::{Mask, Masks};
use crate::measure::indexed_surface::{Foot, IndexedSurface};
use crate::measure::statistics::DistanceStatistics;

/// The distances on the whole surface and on its parts. Parts are parts of where distances are measured from; the
/// other surface stays whole, so that tissue at the border of a part still finds its own like.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Regions {
    /// Everywhere.
    pub whole: Definitions,
    /// Seen from the atrium; none where the direction to it is not known.
    pub visible: Option<Definitions>,
    /// In contact; none where neither surface knows, and rows are missing of a surface that does not.
    pub in_contact: Option<Definitions>,
    /// Not in contact; likewise.
    pub not_in_contact: Option<Definitions>,
}

/// The distance under every definition; none where nothing is measured from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Definitions {
    /// From each point of the result to the reference's surface, each point counting the same.
    pub result_to_reference: Option<DistanceStatistics>,
    /// The same, each point weighing as much as the area about it.
    pub result_to_reference_by_area: Option<DistanceStatistics>,
    /// From each point of the reference to the result's surface, each point counting the same.
    pub reference_to_result: Option<DistanceStatistics>,
    /// The same, each point weighing as much as the area about it.
    pub reference_to_result_by_area: Option<DistanceStatistics>,
    /// From the centroid of each triangle of the result to the nearest centroid of one of the reference (paper 002).
    /// Two meshes of one surface are some quarter of an edge of the reference apart under this definition.
    pub centroid_to_centroid: Option<DistanceStatistics>,
    /// From each node of the result to its like; none where the meshes differ.
    pub node_to_node: Option<DistanceStatistics>,
}

/// All distances of a result to a reference, with the nearest point of the reference to each point of the result.
pub(super) fn regions(
    [result, reference]: [&IndexedSurface; 2],
    [here, there]: [&Masks; 2],
    nodes_correspond: bool,
) -> (Regions, Vec<Foot>) {
    let feet = reference.feet(&result.points_mm);
    let distances = Distances {
        there: feet.iter().map(|foot| foot.distance_mm).collect(),
        back: (result.feet(&reference.points_mm).iter())
            .map(|foot| foot.distance_mm)
            .collect(),
        centroids: reference.to_centroids(&result.centroids_mm),
        nodes: nodes_correspond.then(|| {
            let pairs = result.points_mm.iter().zip(&reference.points_mm);
            pairs.map(|(p, q)| (p - q).norm()).collect()
        }),
        result,
        reference,
    };
    let part = |mask: fn(&Masks) -> Option<&Mask>, inside: bool| {
        let parts = [mask(here), mask(there)].map(|mask| mask.map(|mask| Part { mask, inside }));
        (parts[0].is_some() || parts[1].is_some()).then(|| distances.of(parts))
    };
    let everywhere = [result, reference].map(|surface| Mask {
        points: vec![true; surface.points_mm.len()],
        faces: vec![true; surface.faces.len()],
    });
    let whole = |mask| Some(Part { mask, inside: true });
    let regions = Regions {
        whole: distances.of([whole(&everywhere[0]), whole(&everywhere[1])]),
        visible: part(|masks| masks.visible.as_ref(), true),
        in_contact: part(|masks| masks.contact.as_ref(), true),
        not_in_contact: part(|masks| masks.contact.as_ref(), false),
    };
    (regions, feet)
}

/// What is inside of a mask, or outside.
#[derive(Clone, Copy)]
struct Part<'a> {
    mask: &'a Mask,
    inside: bool,
}

/// Every distance [mm].
struct Distances<'a> {
    /// Of each point of the result.
    there: Vec<f64>,
    /// Of each point of the reference.
    back: Vec<f64>,
    /// Of each face of the result.
    centroids: Vec<f64>,
    /// Of each point of the result.
    nodes: Option<Vec<f64>>,
    result: &'a IndexedSurface<'a>,
    reference: &'a IndexedSurface<'a>,
}

impl Distances<'_> {
    /// Statistics over a part of the result and of the reference.
    fn of(&self, [here, there]: [Option<Part>; 2]) -> Definitions {
        let all = |distances, surface, part| DistanceStatistics::of(&of_points(distances, surface, part?).0);
        let by_area = |distances, surface, part| {
            let (distances, areas) = of_points(distances, surface, part?);
            DistanceStatistics::by_area(distances.into_iter().zip(areas).collect())
        };
        let of_faces = |part: Part| {
            let faces = self.centroids.iter().zip(&part.mask.faces);
            let chosen: Vec<f64> = faces.filter(|f| *f.1 == part.inside).map(|f| *f.0).collect();
            DistanceStatistics::of(&chosen)
        };
        Definitions {
            result_to_reference: all(&self.there, self.result, here),
            result_to_reference_by_area: by_area(&self.there, self.result, here),
            reference_to_result: all(&self.back, self.reference, there),
            reference_to_result_by_area: by_area(&self.back, self.reference, there),
            centroid_to_centroid: here.and_then(of_faces),
            node_to_node: (self.nodes.as_ref()).and_then(|nodes| all(nodes, self.result, here)),
        }
    }
}

/// The distances of a part's points and the areas about them, without points that no face uses.
fn of_points(distances: &[f64], surface: &IndexedSurface, part: Part) -> (Vec<f64>, Vec<f64>) {
    let chosen = |&v: &usize| surface.used[v] && part.mask.points[v] == part.inside;
    let points = (0..distances.len()).filter(chosen);
    points.map(|v| (distances[v], surface.point_area_mm2[v])).unzip()
}

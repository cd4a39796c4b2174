//! A leaflet as a surgeon finds his way on it: along its free margin, and from there toward the annulus.

use std::collections::BTreeMap;

use crate::Vec3;
use crate::energy::chord::WeightedVertices;
use crate::mesh::{polyline, topology};
use crate::model::Model;
use crate::repair::ring_shape::normal_of;
use crate::scene::Fault;

/// A leaflet's free margin and how its faces hang together.
#[derive(Clone, Debug)]
pub struct LeafletMargin<'a> {
    model: &'a Model,
    /// Number of the leaflet.
    pub leaflet: u32,
    /// Vertices along the free margin, from the anterolateral to the posteromedial commissure.
    pub vertices: Vec<u32>,
    /// Where they are in the open valve [mm], shape `[margin vertex]`.
    pub points_mm: Vec<Vec3>,
    /// Arc length at each [mm], shape `[margin vertex]`.
    pub arcs_mm: Vec<f64>,
    /// The leaflet's faces at each of its edges, by its ends, the smaller first.
    faces_at: BTreeMap<[u32; 2], Vec<u32>>,
}

/// The way from a place on the margin toward the annulus, straight across the leaflet.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightLine {
    /// Where it crosses edges: distance from the margin along the leaflet [mm] and the place; ascending.
    pub crossings: Vec<(f64, WeightedVertices)>,
}

impl HeightLine {
    /// How far it goes [mm]: the height of the leaflet, where it ends at the annulus.
    pub fn length_mm(&self) -> f64 {
        self.crossings.last().map_or(0.0, |(distance, _)| *distance)
    }

    /// The place so far from the margin [mm]; its end where that is nearer.
    pub fn at(&self, distance_mm: f64) -> WeightedVertices {
        let after = self.crossings.partition_point(|(d, _)| *d < distance_mm);
        let Some((far, beyond)) = self
            .crossings
            .get(after.min(self.crossings.len().saturating_sub(1)))
        else {
            return Vec::new();
        };
        if after == 0 || after == self.crossings.len() {
            return beyond.clone();
        }
        let (near, before) = &self.crossings[after - 1];
        let share = (distance_mm - near) / (far - near);
        mixed(before, beyond, share)
    }
}

/// One place and, by its share, another.
fn mixed(one: &WeightedVertices, other: &WeightedVertices, share: f64) -> WeightedVertices {
    let mut sum: BTreeMap<u32, f64> = BTreeMap::new();
    for (place, part) in [(one, 1.0 - share), (other, share)] {
        for &(vertex, weight) in place {
            *sum.entry(vertex).or_default() += part * weight;
        }
    }
    sum.into_iter().filter(|&(_, weight)| weight > 0.0).collect()
}

/// The number of the leaflet of that name, in whatever case.
///
/// # Errors
/// There is none, with `place`.
pub fn leaflet_named(model: &Model, name: &str, place: &str) -> Result<u32, Fault> {
    let found = model
        .leaflets
        .iter()
        .position(|leaflet| leaflet.name.eq_ignore_ascii_case(name));
    found.map(|number| number as u32).ok_or_else(|| {
        let names: Vec<String> = model
            .leaflets
            .iter()
            .map(|leaflet| format!("`{}`", leaflet.name))
            .collect();
        let message = format!(
            "is on the leaflet `{name}`, which is none of {}",
            names.join(", ")
        );
        Fault::error(place, message)
    })
}

impl<'a> LeafletMargin<'a> {
    /// The margin of a leaflet: of its pieces of boundary that are not annulus, the longest.
    ///
    /// # Errors
    /// The leaflet has no margin from commissure to commissure, with `place`.
    pub fn new(model: &'a Model, leaflet: u32, place: &str) -> Result<Self, Fault> {
        let mut faces_at: BTreeMap<[u32; 2], Vec<u32>> = BTreeMap::new();
        for (number, face) in (0..).zip(&model.faces) {
            if model.face_leaflet[number as usize] == leaflet {
                for [a, b] in topology::face_edges(*face) {
                    faces_at.entry([a.min(b), a.max(b)]).or_default().push(number);
                }
            }
        }
        let edges: Vec<[u32; 2]> = model
            .margins
            .iter()
            .flat_map(|margin| {
                let count = margin.vertices.len();
                let steps = if margin.closed {
                    count
                } else {
                    count.saturating_sub(1)
                };
                (0..steps).map(move |i| [margin.vertices[i], margin.vertices[(i + 1) % count]])
            })
            .filter(|&[a, b]| faces_at.contains_key(&[a.min(b), a.max(b)]))
            .collect();
        let length = |chain: &topology::Chain| polyline::length(&positions(model, &chain.vertices), false);
        let open = topology::chains(&edges).into_iter().filter(|chain| !chain.closed);
        let longest = open.max_by(|a, b| length(a).total_cmp(&length(b)));
        let Some(chain) = longest else {
            let name = &model.leaflets[leaflet as usize].name;
            let message = format!(
                "the leaflet `{name}` has no free margin that runs from one commissure to the other; expected leaflets \
                 `anterior` and `posterior` that meet, or end, at the commissures"
            );
            return Err(Fault::of_shape(place, message));
        };
        let mut vertices = chain.vertices;
        if !runs_from_the_anterolateral_side(model, &vertices) {
            vertices.reverse();
        }
        let points_mm = positions(model, &vertices);
        let arcs_mm = polyline::arc_lengths(&points_mm, false);
        Ok(Self {
            model,
            leaflet,
            vertices,
            points_mm,
            arcs_mm,
            faces_at,
        })
    }

    /// Length of the margin [mm].
    pub fn length_mm(&self) -> f64 {
        self.arcs_mm.last().copied().unwrap_or(0.0)
    }

    /// The point at an arc length [mm].
    pub fn point_mm(&self, arc_mm: f64) -> Vec3 {
        polyline::point_at_arc(&self.points_mm, false, &self.arcs_mm, arc_mm)
    }

    /// The direction of the margin toward the posteromedial commissure as seen from the atrium, over so many millimetres about
    /// an arc length.
    pub fn tangent(&self, arc_mm: f64, width_mm: f64) -> Vec3 {
        let half = 0.5 * width_mm.max(1e-3 * self.length_mm());
        let along = self.point_mm(arc_mm + half) - self.point_mm(arc_mm - half);
        let atrial = normal_of(&positions(self.model, &self.model.annulus));
        let seen = along - atrial * atrial.dot(&along);
        // A margin that runs straight up, of a leaflet drawn by itself, has no direction seen from there.
        if seen.norm() > 0.1 * along.norm() {
            seen.normalize()
        } else {
            along.normalize()
        }
    }

    /// The way across the leaflet from the margin at `arc_mm`, in the plane perpendicular to `along`, or leaning out of it by
    /// `lean_radians` toward `along`. With [`Self::tangent`] that is the plane of a clip whose arms stand across the line of
    /// closure: it holds the axis of the valve, so that both leaflets are gripped the same way up, however their margins slope.
    pub fn height_line(&self, arc_mm: f64, along: Vec3, lean_radians: f64) -> HeightLine {
        let count = self.arcs_mm.len();
        let edge = self
            .arcs_mm
            .partition_point(|&arc| arc <= arc_mm)
            .clamp(1, count - 1)
            - 1;
        let ends = [self.vertices[edge], self.vertices[edge + 1]];
        let span = self.arcs_mm[edge + 1] - self.arcs_mm[edge];
        // Not at a vertex: there the margin may bend so that a plane meets neither edge.
        let share = ((arc_mm - self.arcs_mm[edge]) / span).clamp(1e-6, 1.0 - 1e-6);
        let start = vec![(ends[0], 1.0 - share), (ends[1], share)];
        let key = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        let Some(&face) = self.faces_at.get(&key).and_then(|faces| faces.first()) else {
            return HeightLine {
                crossings: vec![(0.0, start)],
            };
        };
        let normal = self.normal_near(arc_mm, face);
        let third = self.model.faces[face as usize]
            .into_iter()
            .find(|v| !ends.contains(v));
        let inward = third.map_or(Vec3::zeros(), |v| {
            self.model.rest_mm[v as usize] - self.place_mm(&start)
        });
        let across = normal.cross(&along);
        let across = across.normalize() * across.dot(&inward).signum();
        self.traced(
            start,
            key,
            along * lean_radians.cos() - across * lean_radians.sin(),
        )
    }

    /// The normal of the leaflet about a place on its margin: the mean of the faces within two millimetres, our choice, that
    /// one crooked face does not turn a clip.
    fn normal_near(&self, arc_mm: f64, face: u32) -> Vec3 {
        let at = self.point_mm(arc_mm);
        let area = |face: u32| {
            let [a, b, c] = self.model.faces[face as usize].map(|v| self.model.rest_mm[v as usize]);
            ((b - a).cross(&(c - a)), (a + b + c) / 3.0)
        };
        let mut sum = area(face).0;
        for other in 0..self.model.faces.len() as u32 {
            let (normal, middle) = area(other);
            if self.model.face_leaflet[other as usize] == self.leaflet && (middle - at).norm() < 2.0 {
                sum += normal;
            }
        }
        sum.normalize()
    }

    /// Follows a plane through `start`, which lies on the edge `key`, over the leaflet's faces.
    fn traced(&self, start: WeightedVertices, mut key: [u32; 2], plane: Vec3) -> HeightLine {
        let origin = self.place_mm(&start);
        let side = |vertex: u32| plane.dot(&(self.model.rest_mm[vertex as usize] - origin));
        let mut here = origin;
        let mut crossings = vec![(0.0, start)];
        let mut behind = None;
        // A plane passes each face once.
        for _ in 0..self.model.faces.len() {
            let ahead = self.faces_at[&key]
                .iter()
                .copied()
                .find(|&face| Some(face) != behind);
            let Some(face) = ahead else { break };
            let third = self.model.faces[face as usize]
                .into_iter()
                .find(|v| !key.contains(v));
            let Some(third) = third else { break };
            let Some(&other) = key.iter().find(|&&v| (side(v) >= 0.0) != (side(third) >= 0.0)) else {
                break;
            };
            let (a, b) = (side(third), side(other));
            let share = a / (a - b);
            let place = vec![(third, 1.0 - share), (other, share)];
            let next = self.place_mm(&place);
            let distance = crossings.last().map_or(0.0, |(d, _)| *d) + (next - here).norm();
            crossings.push((distance, place));
            here = next;
            behind = Some(face);
            key = [third.min(other), third.max(other)];
        }
        HeightLine { crossings }
    }

    /// Where a place is in the open valve [mm].
    pub fn place_mm(&self, place: &WeightedVertices) -> Vec3 {
        place
            .iter()
            .map(|&(vertex, weight)| self.model.rest_mm[vertex as usize] * weight)
            .sum()
    }
}

fn positions(model: &Model, vertices: &[u32]) -> Vec<Vec3> {
    vertices.iter().map(|&v| model.rest_mm[v as usize]).collect()
}

/// Whether the first of these vertices lies on the side of the anterolateral commissure, the last on the other.
fn runs_from_the_anterolateral_side(model: &Model, vertices: &[u32]) -> bool {
    let landmark = |index: usize| model.annulus.get(index).map(|&v| model.rest_mm[v as usize]);
    let ends = vertices
        .first()
        .zip(vertices.last())
        .map(|(&a, &b)| [a, b].map(|v| model.rest_mm[v as usize]));
    let commissures = landmark(model.landmarks.commissure_anterolateral)
        .zip(landmark(model.landmarks.commissure_posteromedial));
    ends.zip(commissures)
        .is_none_or(|([first, last], (anterolateral, posteromedial))| {
            (last - first).dot(&(posteromedial - anterolateral)) > 0.0
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::fixtures::{ROWS, built, skirt, skirt_point};

    /// The skirt's margins by hand: the anterior one over columns 2 to 10, the posterior one the others; both begin at
    /// column 10, which is the anterolateral side.
    #[test]
    fn margins_run_from_the_anterolateral_commissure() {
        let model = built(&skirt()).model;
        for (leaflet, columns) in [(0, (2..=10).rev().collect::<Vec<_>>()), (1, (10..=26).collect())] {
            let margin = LeafletMargin::new(&model, leaflet, "here").unwrap();
            let expected: Vec<Vec3> = columns.iter().map(|&c| skirt_point(c, ROWS - 1).into()).collect();
            assert_eq!(margin.points_mm, expected);
        }
    }

    /// In the middle of the anterior leaflet the way up is the column itself, and its length that of the column: the margin's
    /// tangent is that of the ellipse there, so both to rounding and the shift by a millionth of an edge.
    #[test]
    fn the_way_up_is_straight_and_as_long_as_the_leaflet_is_high() {
        let model = built(&skirt()).model;
        let margin = LeafletMargin::new(&model, 0, "here").unwrap();
        let middle = 0.5 * margin.length_mm();
        let line = margin.height_line(middle, margin.tangent(middle, 4.0), 0.0);
        let column: Vec<Vec3> = (0..ROWS).map(|row| skirt_point(6, row).into()).collect();
        let height: f64 = column.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        assert!((line.length_mm() - height).abs() < 1e-4, "{}", line.length_mm());
        let half = margin.place_mm(&line.at(0.5 * height));
        assert!((half - column[1]).norm() < 1e-4, "{half}");
        assert!((margin.place_mm(&line.at(99.0)) - column[0]).norm() < 1e-4);
        // Leaning by 30 degrees it ends toward the posteromedial side, which is +x.
        let leaning = margin.height_line(middle, margin.tangent(middle, 4.0), 0.5);
        assert!(margin.place_mm(&leaning.at(5.0)).x > 2.0);
    }

    #[test]
    fn a_leaflet_that_is_not_there_is_told() {
        let model = built(&skirt()).model;
        let fault = leaflet_named(&model, "septal", "clip.site").unwrap_err();
        assert_eq!(fault.place, "clip.site");
        assert!(
            fault
                .message
                .contains("`septal`, which is none of `anterior`, `posterior`"),
            "{fault:?}"
        );
        assert_eq!(leaflet_named(&model, "Posterior", "x"), Ok(1));
    }
}

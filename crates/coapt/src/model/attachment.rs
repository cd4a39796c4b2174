//! Where chord points belong: to a papillary tip, to a leaflet, or to no other than themselves.

use super::insertion::{self, Foot, Insertion, Spread};
use super::surface::Surface;
use crate::Vec3;
use crate::mesh::point_grid::PointGrid;
use crate::scene::{ChordGroup, Scene};

/// What a chord point is welded to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Anchor {
    /// An insertion in a leaflet.
    Leaflet(u32),
    /// A papillary tip, counted over all muscles.
    Tip(u32),
    /// A chord node, free to move.
    Node(u32),
}

/// A chord segment between anchors.
#[derive(Clone, Debug)]
pub(crate) struct Segment {
    pub(crate) group: u32,
    /// Number in the group's mesh.
    pub(crate) number: u32,
    pub(crate) ends: [Anchor; 2],
}

impl Segment {
    pub(crate) fn name(&self) -> String {
        format!("chordae[{}].mesh segment {}", self.group, self.number)
    }
}

/// All segments, with what their ends are welded to.
#[derive(Clone, Debug, Default)]
pub(crate) struct Attached {
    pub(crate) segments: Vec<Segment>,
    /// Positions of the free chord nodes [mm], shape `[node]`.
    pub(crate) nodes: Vec<Vec3>,
    /// Shape `[insertion]`.
    pub(crate) insertions: Vec<Insertion>,
}

/// Welds chord points to each other (within the weld tolerance, across groups), then to tips and leaflets.
///
/// A chord point takes a tip or the nearest point of a leaflet within the weld tolerance. Within the insertion tolerance
/// it does so if it is the end of a chord, or of several that come from one side, and no neighbour along them is nearer:
/// a finely drawn chord is inserted by its last point only, and may pass a leaflet. Tips go before leaflets.
pub(crate) fn attach(scene: &Scene, leaflet: &Surface, tips: &[Vec3]) -> Attached {
    let (points, segments) = weld(scene);
    let mut neighbours = vec![Vec::new(); points.len()];
    let mut radius_mm = vec![0.0; points.len()];
    for &(group, _, [a, b]) in &segments {
        neighbours[a as usize].push(b);
        neighbours[b as usize].push(a);
        for end in [a, b] {
            radius_mm[end as usize] = scene.chordae[group as usize].insertion_radius_mm;
        }
    }
    let reach = scene.weld.insertion_tolerance_mm.max(scene.weld.tolerance_mm);
    let to_tip = nearest_of_all(&points, tips, reach);
    let to_leaflet: Vec<Option<Foot>> = points
        .iter()
        .map(|&p| insertion::foot(leaflet, p, reach))
        .collect();
    let tip_distance = |node: usize| to_tip[node].map(|(_, distance)| distance);
    let leaflet_distance = |node: usize| to_leaflet[node].as_ref().map(|foot| foot.distance_mm);
    let takes = |away: &dyn Fn(usize) -> Option<f64>, node: usize| {
        away(node).is_some_and(|distance| {
            let others = &neighbours[node];
            let further = |&other: &u32| away(other as usize).is_none_or(|d| d > distance);
            let inserts =
                others.len() <= 1 || (others.iter().all(further) && ends_here(&points, node, others));
            distance <= scene.weld.tolerance_mm || inserts
        })
    };
    let spread = Spread::new(leaflet);
    let mut insertions = Vec::new();
    let mut anchor = |node: usize| match (to_tip[node], &to_leaflet[node]) {
        (Some((tip, _)), _) if takes(&tip_distance, node) => Anchor::Tip(tip),
        (_, Some(foot)) if takes(&leaflet_distance, node) => {
            insertions.push(spread.insertion(foot, radius_mm[node]));
            Anchor::Leaflet(insertions.len() as u32 - 1)
        }
        _ => Anchor::Node(node as u32),
    };
    let anchors: Vec<Anchor> = (0..points.len()).map(&mut anchor).collect();
    let segments = segments.into_iter().map(|(group, number, ends)| Segment {
        group,
        number,
        ends: ends.map(|end| anchors[end as usize]),
    });
    Attached {
        segments: segments.collect(),
        nodes: points,
        insertions,
    }
}

/// Whether all segments at a point leave to one side, each pair at less than a right angle.
fn ends_here(points: &[Vec3], node: usize, neighbours: &[u32]) -> bool {
    let arm = |other: &u32| points[*other as usize] - points[node];
    let pair = |(i, a): (usize, &u32)| neighbours[i + 1..].iter().all(|b| arm(a).dot(&arm(b)) > 0.0);
    neighbours.iter().enumerate().all(pair)
}

/// Group, number in the group's mesh, ends as chord points.
type NumberedEnds = (u32, u32, [u32; 2]);

/// Distinct chord points, and segments between them.
fn weld(scene: &Scene) -> (Vec<Vec3>, Vec<NumberedEnds>) {
    let mut grid = PointGrid::new(scene.weld.tolerance_mm);
    let (mut points, mut segments) = (Vec::new(), Vec::new());
    let meshes = scene.chordae.iter().enumerate();
    for (group, mesh) in meshes.filter_map(|(i, ChordGroup { mesh, .. })| Some((i as u32, mesh.as_ref()?))) {
        for (number, ends) in mesh.segments.iter().enumerate() {
            let ends = ends.map(|end| {
                let at = Vec3::from(mesh.points_mm[end as usize]);
                if let Some(&(node, _)) = grid.within(at).first() {
                    return node;
                }
                grid.insert(points.len() as u32, at);
                points.push(at);
                points.len() as u32 - 1
            });
            segments.push((group, number as u32, ends));
        }
    }
    (points, segments)
}

fn nearest_of_all(points: &[Vec3], targets: &[Vec3], reach: f64) -> Vec<Option<(u32, f64)>> {
    let mut grid = PointGrid::new(reach);
    targets
        .iter()
        .enumerate()
        .for_each(|(i, &p)| grid.insert(i as u32, p));
    points.iter().map(|&p| grid.nearest(p)).collect()
}

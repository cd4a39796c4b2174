//! Where chord points belong: to a papillary tip, to a leaflet point, or to no other than themselves.

use crate::Vec3;
use crate::mesh::point_grid::PointGrid;
use crate::scene::{ChordGroup, Scene};

/// What a chord point is welded to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Anchor {
    /// A leaflet vertex.
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

/// All segments, with the positions of the free chord nodes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Attached {
    pub(crate) segments: Vec<Segment>,
    pub(crate) nodes: Vec<Vec3>,
}

/// Welds chord points to each other (within the weld tolerance, across groups), then to tips and leaflet points.
///
/// A chord point takes a tip or leaflet point within the weld tolerance. Within the insertion tolerance it does
/// so if it is the end of a chord, or of several that come from one side, and no neighbour along them is nearer: a
/// finely drawn chord is inserted by its last point only, and may pass a leaflet. Tips go before leaflet points.
pub(crate) fn attach(scene: &Scene, leaflet: &[Vec3], tips: &[Vec3]) -> Attached {
    let (points, segments) = weld(scene);
    let mut neighbours = vec![Vec::new(); points.len()];
    for &(_, _, [a, b]) in &segments {
        neighbours[a as usize].push(b);
        neighbours[b as usize].push(a);
    }
    let reach = scene.weld.insertion_tolerance_mm.max(scene.weld.tolerance_mm);
    let to_tip = nearest_of_all(&points, tips, reach);
    let to_leaflet = nearest_of_all(&points, leaflet, reach);
    let takes = |near: &[Option<(u32, f64)>], node: usize| {
        let (target, distance) = near[node]?;
        let others = &neighbours[node];
        let further = |&other: &u32| near[other as usize].is_none_or(|(_, d)| d > distance);
        let inserts = others.len() <= 1 || (others.iter().all(further) && ends_here(&points, node, others));
        (distance <= scene.weld.tolerance_mm || inserts).then_some(target)
    };
    let anchor = |node: u32| match (takes(&to_tip, node as usize), takes(&to_leaflet, node as usize)) {
        (Some(tip), _) => Anchor::Tip(tip),
        (None, Some(vertex)) => Anchor::Leaflet(vertex),
        (None, None) => Anchor::Node(node),
    };
    let segments = segments.into_iter().map(|(group, number, ends)| Segment {
        group,
        number,
        ends: ends.map(anchor),
    });
    Attached {
        segments: segments.collect(),
        nodes: points,
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

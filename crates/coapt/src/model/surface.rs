//! The leaflets as one surface, points that lie on each other welded.

use super::faults::Faults;
use crate::Vec3;
use crate::mesh::point_grid::PointGrid;
use crate::scene::{Scene, SurfaceMesh};

/// Largest side of the leaflets' bounding box that is taken for millimetres: the mitral annulus of pigs and
/// people is 20 to 50 mm wide, leaflets hang 10 to 30 mm (our choice of margins).
const EXTENT_MM: std::ops::RangeInclusive<f64> = 10.0..=120.0;

/// All leaflets in one vertex list.
#[derive(Clone, Debug, Default)]
pub(crate) struct Surface {
    pub(crate) points: Vec<Vec3>,
    pub(crate) faces: Vec<[u32; 3]>,
    pub(crate) face_leaflet: Vec<u32>,
    /// Leaflet and face number in the scene, for messages.
    pub(super) face_source: Vec<[u32; 2]>,
    /// Leaflet and point number in the scene, for messages.
    pub(super) point_source: Vec<[u32; 2]>,
    /// Points marked as annulus; nothing if no leaflet has marks.
    pub(crate) marked: Option<Vec<bool>>,
    /// Prescribed motion where the scene gives one.
    pub(crate) displacement: Vec<Option<Vec3>>,
}

impl Surface {
    pub(crate) fn point_name(&self, vertex: u32) -> String {
        let [leaflet, point] = self.point_source[vertex as usize];
        format!("leaflets[{leaflet}].mesh point {point}")
    }

    pub(crate) fn face_name(&self, face: usize) -> String {
        let [leaflet, face] = self.face_source[face];
        format!("leaflets[{leaflet}].mesh face {face}")
    }

    pub(crate) fn corners(&self, face: usize) -> [Vec3; 3] {
        self.faces[face].map(|v| self.points[v as usize])
    }

    pub(super) fn keep_faces(&mut self, keep: &[bool]) {
        let mut flags = keep.iter().copied();
        self.faces.retain(|_| flags.next() == Some(true));
        flags = keep.iter().copied();
        self.face_leaflet.retain(|_| flags.next() == Some(true));
        flags = keep.iter().copied();
        self.face_source.retain(|_| flags.next() == Some(true));
    }
}

/// The faces that are triangles. One that uses a point twice is none: cleaning leaves it out, as readers of meshes do, and a point
/// that only such faces use must not count, lest a scene and the files that it was written to differ in size or in the order of
/// their points.
fn triangles(mesh: &SurfaceMesh) -> impl Iterator<Item = &[u32; 3]> {
    mesh.faces.iter().filter(|[a, b, c]| a != b && b != c && c != a)
}

/// The leaflets are the size of a valve, if their numbers are millimetres.
pub(crate) fn check_units(scene: &Scene, faults: &mut Faults) {
    let meshes = scene.leaflets.iter().filter_map(|leaflet| leaflet.mesh.as_ref());
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for mesh in meshes {
        for &vertex in triangles(mesh).flatten() {
            let point = mesh.points_mm[vertex as usize];
            for axis in 0..3 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
    }
    let extent = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
    // Where there is no triangle at all, cleaning says so.
    if EXTENT_MM.contains(&extent) || low[0] > high[0] {
        return;
    }
    let units = [("metres", 1e3), ("centimetres", 10.0), ("micrometres", 1e-3)];
    let guess = units
        .iter()
        .find(|(_, factor)| EXTENT_MM.contains(&(extent * factor)));
    let guess = guess.map_or(String::new(), |(unit, _)| {
        format!("; the numbers look like {unit}")
    });
    let message = format!(
        "the leaflets measure {extent:.4} mm across, expected {} to {} mm{guess}; the mitral annulus is about \
         20-50 mm wide",
        EXTENT_MM.start(),
        EXTENT_MM.end()
    );
    faults.error("leaflets", message);
}

/// One vertex list, in which points within the weld tolerance are one; the lowest number stands for all.
pub(crate) fn merge(scene: &Scene, faults: &mut Faults) -> Surface {
    let mut surface = Surface::default();
    let mut grid = PointGrid::new(scene.weld.tolerance_mm);
    for (number, leaflet) in scene.leaflets.iter().enumerate() {
        let Some(mesh) = &leaflet.mesh else { continue };
        let mut used = vec![false; mesh.points_mm.len()];
        triangles(mesh).flatten().for_each(|&v| used[v as usize] = true);
        let before = surface.points.len();
        let mut vertex_of = vec![u32::MAX; used.len()];
        let (mut welded, mut farthest) = (0, 0.0_f64);
        for point in (0..used.len()).filter(|&p| used[p]) {
            let at = Vec3::from(mesh.points_mm[point]);
            let twin = grid.within(at).first().copied();
            vertex_of[point] = twin.map_or(surface.points.len() as u32, |(vertex, _)| vertex);
            if let Some((vertex, distance)) = twin {
                welded += usize::from(vertex as usize >= before);
                farthest = if vertex as usize >= before {
                    farthest.max(distance)
                } else {
                    farthest
                };
            } else {
                grid.insert(surface.points.len() as u32, at);
                surface.points.push(at);
                surface.point_source.push([number as u32, point as u32]);
                surface.displacement.push(None);
            }
        }
        let faces = mesh.faces.iter().map(|face| face.map(|v| vertex_of[v as usize]));
        surface.faces.extend(faces);
        surface
            .face_leaflet
            .extend(mesh.faces.iter().map(|_| number as u32));
        surface
            .face_source
            .extend((0..mesh.faces.len() as u32).map(|face| [number as u32, face]));
        marks(scene, number, &vertex_of, &mut surface, faults);
        let place = format!("leaflets[{number}].mesh");
        let unused = used.iter().filter(|&&u| !u).count();
        if unused > 0 {
            faults.warning(
                &place,
                format!("{unused} points belong to no triangle and are left out"),
            );
        }
        if welded > 0 {
            faults.warning(
                place,
                format!("{welded} points lie on others (within {farthest:.2e} mm) and are welded"),
            );
        }
    }
    surface
}

/// Takes over which points are annulus and how they move.
fn marks(scene: &Scene, number: usize, vertex_of: &[u32], surface: &mut Surface, faults: &mut Faults) {
    let Some(mesh) = scene.leaflets[number].mesh.as_ref() else {
        return;
    };
    let count = surface.points.len();
    if let Some(points) = &mesh.annulus_points {
        let marked = surface.marked.get_or_insert_default();
        marked.resize(count, false);
        for &point in points {
            match vertex_of[point as usize] {
                u32::MAX => faults.warning(
                    format!("leaflets[{number}].mesh.annulus_points"),
                    format!("point {point} is marked as annulus but belongs to no triangle"),
                ),
                vertex => marked[vertex as usize] = true,
            }
        }
    }
    if let Some(marked) = &mut surface.marked {
        marked.resize(count, false);
    }
    let moves = mesh.annulus_displacement_mm.iter().flatten().zip(vertex_of);
    for (motion, &vertex) in moves.filter(|(_, vertex)| **vertex != u32::MAX) {
        surface.displacement[vertex as usize].get_or_insert(Vec3::from(*motion));
    }
}

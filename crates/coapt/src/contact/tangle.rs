//! Where surfaces cross, or are so near that the solver could not move them; and bodies that are inside out.

use super::broad::{Box3, SweepAndPrune};
use super::crossing::crossings;
use super::nearest::{edge_edge, point_triangle};
use super::step_bound::LEAST_GAP_MM;
use super::surface::Surface;
use crate::Vec3;
use crate::mesh::topology;

/// A place where two parts of the surface cross or touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Tangle {
    /// A vertex there, of the one part.
    pub vertex: u32,
    /// The face of the other, as an index into the faces.
    pub face: u32,
}

/// All places where faces that share no vertex cross, or are nearer than steps ever let them come, in ascending order. Faces
/// in one plane, one on the other, are among them, though they do not cross.
pub fn tangles(surface: &Surface, positions_mm: &[Vec3]) -> Vec<Tangle> {
    let crossed = crossings(surface, positions_mm);
    let mut found: Vec<Tangle> = crossed
        .iter()
        .map(|crossing| Tangle {
            vertex: crossing.edge[0],
            face: crossing.face,
        })
        .collect();
    let at = |vertex: u32| positions_mm[vertex as usize];
    let touch = |separation_mm: Vec3| separation_mm.norm() <= LEAST_GAP_MM;
    let point_boxes: Vec<Box3> = surface
        .points
        .iter()
        .map(|&point| Box3::around([at(point)], LEAST_GAP_MM))
        .collect();
    let face_boxes: Vec<Box3> = surface
        .faces
        .iter()
        .map(|face| Box3::around(face.map(at), 0.0))
        .collect();
    let edge_boxes: Vec<Box3> = surface
        .edges
        .iter()
        .map(|edge| Box3::around(edge.map(at), 0.5 * LEAST_GAP_MM))
        .collect();
    let mut sweep = SweepAndPrune::default();
    for &pair in &*sweep.between(
        [&point_boxes, &face_boxes],
        [&surface.point_patches, &surface.face_patches],
    ) {
        let [p, a, b, c] = surface.point_and_face(pair);
        if surface.are_apart(surface.faces_of_point(pair))
            && touch(point_triangle(&at(p), &at(a), &at(b), &at(c)).separation_mm)
        {
            found.push(Tangle {
                vertex: p,
                face: pair[1],
            });
        }
    }
    for &pair in &*sweep.among(&edge_boxes, &surface.edge_patches) {
        let [a, b, c, d] = surface.ends(pair);
        if surface.are_apart(surface.faces_of_edges(pair))
            && touch(edge_edge(&at(a), &at(b), &at(c), &at(d)).separation_mm)
        {
            found.push(Tangle {
                vertex: a,
                face: surface.edge_face[pair[1] as usize],
            });
        }
    }
    found.sort_unstable();
    found.dedup();
    found
}

/// Volumes that are a smaller part of what their terms add up to are lost in rounding [1], our choice: terms are right to 1e-15
/// of themselves.
const NO_VOLUME: f64 = 1e-12;

/// Closed bodies that enclose their volume from the other side than at rest, by their first faces, in ascending order.
///
/// Nothing need cross there: a tetrahedron whose apex has gone through its base is a sound one again. But a surface without a
/// margin comes from the one side to the other only through a shape that encloses nothing, where it crosses or lies on itself.
/// Bodies that enclose nothing in one of the two shapes, such as flat bags, have no side and are not told of; nor are surfaces
/// with a margin, of which leaflets are.
pub fn inside_out(surface: &Surface, rest_mm: &[Vec3], positions_mm: &[Vec3]) -> Vec<u32> {
    if rest_mm == positions_mm {
        return Vec::new();
    }
    let bodies = closed_bodies(&surface.faces).into_iter();
    let is_turned = |body: &Vec<u32>| {
        let side =
            |points_mm| side_of_volume(body.iter().map(|&face| surface.faces[face as usize]), points_mm);
        side(rest_mm) * side(positions_mm) < 0.0
    };
    bodies.filter(is_turned).map(|body| body[0]).collect()
}

/// The faces of each part of a surface that has no margin, and whose faces wind alike; ascending, in order of the first.
fn closed_bodies(faces: &[[u32; 3]]) -> Vec<Vec<u32>> {
    let edges = topology::edges(faces);
    let (body_of, count) = topology::components(faces.len(), &edges);
    let mut is_closed = vec![true; count];
    for (edge, ends) in edges.ends.iter().enumerate() {
        let around = edges.faces_of(edge);
        let along = around
            .iter()
            .filter(|&&face| topology::face_edges(faces[face as usize]).contains(ends))
            .count();
        // Every other face goes against it.
        if along != 1 || around.len() != 2 {
            is_closed[body_of[around[0] as usize] as usize] = false;
        }
    }
    let mut bodies = vec![Vec::new(); count];
    for (face, &body) in (0..).zip(&body_of) {
        if is_closed[body as usize] {
            bodies[body as usize].push(face);
        }
    }
    bodies.retain(|body| !body.is_empty());
    bodies
}

/// 1 where faces look away from the volume that they enclose, −1 where they look into it, 0 where there is none.
fn side_of_volume(faces: impl Iterator<Item = [u32; 3]> + Clone, points_mm: &[Vec3]) -> f64 {
    let origin = faces
        .clone()
        .next()
        .map_or(Vec3::zeros(), |[a, ..]| points_mm[a as usize]);
    let (mut sum, mut sizes) = (0.0, 0.0);
    for face in faces {
        let [a, b, c] = face.map(|vertex| points_mm[vertex as usize] - origin);
        sum += a.dot(&b.cross(&c));
        sizes += a.norm() * b.norm() * c.norm();
    }
    // The comparison lets no NaN pass.
    if sum.abs() > NO_VOLUME * sizes {
        sum.signum()
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two tetrahedra far from each other and a single triangle.
    const FACES: [[u32; 3]; 9] = [
        [0, 2, 1],
        [0, 1, 3],
        [1, 2, 3],
        [2, 0, 3],
        [4, 6, 5],
        [4, 5, 7],
        [5, 6, 7],
        [6, 4, 7],
        [8, 9, 10],
    ];

    fn corners_mm() -> Vec<Vec3> {
        let at =
            |x: f64| [Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::z()].map(|corner| corner + Vec3::x() * x);
        let mut points = [at(0.0), at(10.0), at(20.0)].concat();
        points.pop();
        points
    }

    fn turned(faces: &[[u32; 3]], positions_mm: &[Vec3]) -> Vec<u32> {
        let rest_mm = corners_mm();
        inside_out(&Surface::new(faces, &rest_mm), &rest_mm, positions_mm)
    }

    #[test]
    fn an_apex_through_its_base_turns_its_body_inside_out_though_nothing_crosses() {
        let mut points = corners_mm();
        assert!(turned(&FACES, &points).is_empty());
        points[7].z = 5e-4;
        assert!(turned(&FACES, &points).is_empty());
        // In the middle of the base, and beside it: under an edge.
        for aside in [Vec3::new(0.2, 0.2, 0.0), Vec3::new(0.1, -0.1, 0.0)] {
            points[7] = points[4] + aside - Vec3::z() * 5e-4;
            assert!(tangles(&Surface::new(&FACES, &corners_mm()), &points).is_empty());
            assert_eq!(turned(&FACES, &points), [4]);
        }
        points[3].z = -1.0;
        assert_eq!(turned(&FACES, &points), [0, 4]);
    }

    #[test]
    fn what_has_no_side_is_not_inside_out() {
        let mut points = corners_mm();
        // A rigid motion and a triangle turned over leave every side where it was.
        let quarter = |x: &Vec3| Vec3::new(-x.y, x.x, x.z + 3.0);
        assert!(turned(&FACES, &points.iter().map(quarter).collect::<Vec<_>>()).is_empty());
        points.swap(9, 10);
        assert!(turned(&FACES, &points).is_empty());
        // Nor have a flat body, one with a hole, one whose faces do not wind alike, and what is nowhere.
        points[7].z = 0.0;
        assert!(turned(&FACES, &points).is_empty());
        points[7].z = -1.0;
        assert!(turned(&FACES[..7], &points).is_empty());
        let mut faces = FACES;
        faces[5].swap(0, 1);
        assert!(turned(&faces, &points).is_empty());
        points[7].z = f64::NAN;
        assert!(turned(&FACES, &points).is_empty());
    }
}

//! Signed distance from points to the leaflets of a model: positive on the atrial side.

use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};
use parry3d_f64::query::PointQuery;

use crate::Vec3;
use crate::contact::nearest::{Nearest, point_triangle};

/// Where the surface is nearest to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Foot {
    /// Distance from the surface to the point, positive on the side to which its normals point [mm].
    pub(crate) distance_mm: f64,
    /// The nearest place of the surface [mm].
    pub(crate) place_mm: Vec3,
}

/// The nearest place of a surface for each point; nothing where the surface has no faces.
///
/// The sign is that of the normal at the nearest place: of the face, or, on an edge or at a vertex, of the faces around it,
/// each weighted by its angle there; with any other weights points beside an edge get the wrong sign (Bærentzen & Aanæs
/// 2005).
pub(crate) fn feet(faces: &[[u32; 3]], positions_mm: &[Vec3], points_mm: &[Vec3]) -> Vec<Option<Foot>> {
    let corners = |face: u32| faces[face as usize].map(|v| positions_mm[v as usize]);
    let box_of = |face: u32| Aabb::from_points(corners(face).map(Vector::from));
    let boxes: Vec<Aabb> = (0..faces.len() as u32).map(box_of).collect();
    let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
    let around = faces_around(faces, positions_mm.len());
    let normal = |face: u32, features: &[u32]| normal_at(face, features, &around, faces, positions_mm);
    let foot = |point: &Vec3| {
        let place = Vector::from(*point);
        let distance = |face: u32| {
            let [a, b, c] = corners(face);
            point_triangle(point, &a, &b, &c)
        };
        let (face, _) = tree.find_best(
            f64::INFINITY,
            |node, _| node.aabb().distance_to_local_point(place, true),
            |face, best| Some(distance(face).separation_mm.norm()).filter(|&d| d < best),
        )?;
        let nearest = distance(face);
        let side = normal(face, &features(&nearest, faces[face as usize])).dot(&nearest.separation_mm);
        Some(Foot {
            distance_mm: nearest.separation_mm.norm().copysign(side),
            place_mm: point - nearest.separation_mm,
        })
    };
    points_mm.iter().map(foot).collect()
}

/// The corners that the nearest place lies between: three inside the face, two on an edge, one at a vertex.
fn features(nearest: &Nearest, face: [u32; 3]) -> Vec<u32> {
    let counts = |&(k, _): &(usize, u32)| nearest.weights[k + 1] != 0.0;
    (0..).zip(face).filter(counts).map(|(_, vertex)| vertex).collect()
}

/// A vector in the direction of the surface's normal at a place between these corners of a face.
fn normal_at(
    face: u32,
    features: &[u32],
    around: &[Vec<u32>],
    faces: &[[u32; 3]],
    positions_mm: &[Vec3],
) -> Vec3 {
    let unit = |face: u32| {
        let [a, b, c] = faces[face as usize].map(|v| positions_mm[v as usize]);
        (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default()
    };
    match *features {
        [vertex] => {
            let weighted = |&face: &u32| unit(face) * angle_at(vertex, faces[face as usize], positions_mm);
            around[vertex as usize].iter().map(weighted).sum()
        }
        [a, b] => {
            let at_edge = |&&face: &&u32| faces[face as usize].contains(&b);
            let faces_there = around[a as usize].iter().filter(at_edge);
            faces_there.map(|&face| unit(face)).sum()
        }
        _ => unit(face),
    }
}

/// Angle of a face at one of its corners [rad].
fn angle_at(vertex: u32, face: [u32; 3], positions_mm: &[Vec3]) -> f64 {
    let corner = face.iter().position(|&v| v == vertex).unwrap_or(0);
    let [at, next, last] = [0, 1, 2].map(|k| positions_mm[face[(corner + k) % 3] as usize]);
    (next - at).angle(&(last - at))
}

fn faces_around(faces: &[[u32; 3]], vertex_count: usize) -> Vec<Vec<u32>> {
    let mut around = vec![Vec::new(); vertex_count];
    for (number, face) in (0..).zip(faces) {
        face.iter()
            .for_each(|&vertex| around[vertex as usize].push(number));
    }
    around
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A roof of two slopes along x = 0, normals up, as seen from above: z = -|x|.
    fn roof() -> ([[u32; 3]; 4], Vec<Vec3>) {
        let points = [
            [-4.0, -4.0, -4.0],
            [-4.0, 4.0, -4.0],
            [0.0, -4.0, 0.0],
            [0.0, 4.0, 0.0],
            [4.0, -4.0, -4.0],
            [4.0, 4.0, -4.0],
        ];
        let faces = [[0, 2, 1], [2, 3, 1], [2, 4, 3], [4, 5, 3]];
        (faces, points.map(Vec3::from).to_vec())
    }

    fn signed(points: &[[f64; 3]]) -> Vec<f64> {
        let (faces, positions) = roof();
        let points: Vec<Vec3> = points.iter().map(|&p| p.into()).collect();
        let feet = feet(&faces, &positions, &points);
        feet.into_iter().flatten().map(|foot| foot.distance_mm).collect()
    }

    /// Above and below each slope, over the ridge, beside its end and far out; 1e-14 is rounding.
    #[test]
    fn the_side_is_that_of_the_normals() {
        let half = 0.5_f64.sqrt();
        let found = signed(&[
            [-2.0 - half, 0.0, -2.0 + half],
            [2.0 - half, 1.0, -2.0 - half],
            [0.0, 0.0, 3.0],
            [0.1, 0.0, 3.0],
            [0.0, 5.0, 1.0],
            [0.0, -5.0, 1.0],
            [10.0, 0.0, -3.0],
        ]);
        let due = [
            1.0,
            -1.0,
            3.0,
            (9.0 + 0.01_f64).sqrt(),
            2.0_f64.sqrt(),
            2.0_f64.sqrt(),
            37.0_f64.sqrt(),
        ];
        assert!(
            found
                .iter()
                .zip(due)
                .all(|(found, due)| (found - due).abs() < 1e-14),
            "{found:?}"
        );
    }

    /// At a sharp tip with three sides, one of them cut into twenty slivers, unweighted normals point as that side does, and
    /// what lies over the tip on its other side would count as inside.
    #[test]
    fn slivers_do_not_outvote_the_rest() {
        let along = |degrees: f64| {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            Vec3::new(0.1 * cosine, 0.1 * sine, -1.0)
        };
        let (first, second, third) = (along(0.0), along(120.0), along(240.0));
        let cut = (0..=20).map(|k| first + (second - first) * (f64::from(k) / 20.0));
        let positions: Vec<Vec3> = std::iter::once(Vec3::zeros()).chain(cut).chain([third]).collect();
        let mut faces: Vec<[u32; 3]> = (1..21).map(|k| [0, k, k + 1]).collect();
        faces.extend([[0, 21, 22], [0, 22, 1]]);
        let over = Vec3::new(-0.45, -0.78, 0.2);
        let foot = feet(&faces, &positions, &[over])[0].unwrap();
        assert_eq!(foot.distance_mm, over.norm());
    }

    #[test]
    fn nothing_is_near_no_surface() {
        assert_eq!(feet(&[], &[], &[Vec3::zeros()]), [None]);
    }
}

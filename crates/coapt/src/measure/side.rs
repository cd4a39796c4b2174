//! On which side of a surface a point is.

use super::indexed_surface::{Foot, IndexedSurface};
use super::plane::vector_area;
use crate::Vec3;
use crate::mesh::topology::{edges, orient};

/// The distance of each place to its foot, negative on the ventricular side of the surface; none where its faces do not
/// wind alike, so that they have no sides. Without a direction to the atrium they are taken to look there.
///
/// The side is that of the normal of the face; where the foot lies on a side or a corner of it, that of the sum of the
/// normals about it, weighed by their angle there: with any other weight a point before the surface can seem to be
/// behind (Bærentzen & Aanæs 2005). Beyond a rim the surface is taken to go on.
pub(crate) fn signed(
    surface: &IndexedSurface,
    to_atrium: Option<Vec3>,
    places: &[Vec3],
    feet: &[Foot],
) -> Option<Vec<f64>> {
    let mut faces = surface.faces.to_vec();
    let edges = edges(surface.faces);
    if !orient(&mut faces, &edges).is_ok_and(|turned| turned.is_empty()) {
        return None;
    }
    let normals: Vec<Vec3> = (0..faces.len()).map(|f| unit_normal(surface, f)).collect();
    let at_points = point_normals(surface, &normals);
    let across = |a: u32, b: u32| -> Vec3 {
        let edge = edges.ends.binary_search(&[a.min(b), a.max(b)]);
        edge.map_or(Vec3::zeros(), |e| {
            edges.faces_of(e).iter().map(|&f| normals[f as usize]).sum()
        })
    };
    let normal = |foot: &Foot| {
        let face = surface.faces[foot.face];
        let on: Vec<u32> = (0..3)
            .filter(|&k| foot.weights[k] != 0.0)
            .map(|k| face[k])
            .collect();
        match on[..] {
            [v] => at_points[v as usize],
            [a, b] => across(a, b),
            _ => normals[foot.face],
        }
    };
    let turned = to_atrium.is_some_and(|direction| surface.looks_mm2().dot(&direction) < 0.0);
    let one = |(&place, foot): (&Vec3, &Foot)| {
        let height = (place - foot.place).dot(&normal(foot));
        if if turned { height <= 0.0 } else { height >= 0.0 } {
            foot.distance_mm
        } else {
            -foot.distance_mm
        }
    };
    Some(places.iter().zip(feet).map(one).collect())
}

/// Zero for a face without area, which has no side.
fn unit_normal(surface: &IndexedSurface, face: usize) -> Vec3 {
    vector_area(&surface.corners(face))
        .try_normalize(0.0)
        .unwrap_or_default()
}

fn point_normals(surface: &IndexedSurface, normals: &[Vec3]) -> Vec<Vec3> {
    let mut sums = vec![Vec3::zeros(); surface.points_mm.len()];
    for (f, face) in surface.faces.iter().enumerate() {
        let corners = surface.corners(f);
        for k in 0..3 {
            let [here, next, last] = [0, 1, 2].map(|step| corners[(k + step) % 3]);
            sums[face[k] as usize] += normals[f] * (next - here).angle(&(last - here));
        }
    }
    sums
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

    fn distances(faces: &[[u32; 3]], positions: Vec<Vec3>, points: &[Vec3]) -> Vec<f64> {
        let surface = IndexedSurface::new(faces, positions);
        signed(&surface, None, points, &surface.feet(points)).unwrap()
    }

    /// Above and below each slope, over the ridge, beside its end and far out; 1e-14 is rounding.
    #[test]
    fn the_side_is_that_of_the_normals() {
        let half = 0.5_f64.sqrt();
        let (faces, positions) = roof();
        let points = [
            [-2.0 - half, 0.0, -2.0 + half],
            [2.0 - half, 1.0, -2.0 - half],
            [0.0, 0.0, 3.0],
            [0.1, 0.0, 3.0],
            [0.0, 5.0, 1.0],
            [0.0, -5.0, 1.0],
            [10.0, 0.0, -3.0],
        ];
        let found = distances(&faces, positions, &points.map(Vec3::from));
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
        assert_eq!(distances(&faces, positions, &[over]), [over.norm()]);
    }
}

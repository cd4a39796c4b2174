//! Bending stiffness from the leaflets' moduli.

use super::LeafletTissue;
use super::elasticity::Sheet;
use crate::Vec3;
use crate::energy::bending::Hinges;
use crate::mesh::topology::Edges;
use crate::scene::Tissue;

/// Poisson's ratio that springs along edges have built in; membranes bend with it too.
const POISSON_RATIO: f64 = 1.0 / 3.0;

/// One hinge per edge between two faces where tissue resists bending, with the mean plate stiffness of the two.
pub(super) fn hinges(sheet: &Sheet, edges: &Edges) -> Hinges {
    let plates: Vec<f64> = sheet.leaflets.iter().map(plate_stiffness_n_mm).collect();
    let plate_n_mm = |face: u32| plates[sheet.face_leaflet[face as usize] as usize];
    let mut hinges = Hinges::default();
    for (edge, &[a, b]) in edges.ends.iter().enumerate() {
        let &[one, other] = edges.faces_of(edge) else {
            continue;
        };
        let stiffness = 0.5 * (plate_n_mm(one) + plate_n_mm(other));
        let [Some(c), Some(d)] = [one, other].map(|face| {
            let corners = sheet.faces[face as usize];
            corners.into_iter().find(|&v| v != a && v != b)
        }) else {
            continue;
        };
        if stiffness > 0.0 {
            let vertices = [a, b, c, d];
            let (weights, area) = weights_and_area(vertices.map(|vertex| sheet.rest_mm[vertex as usize]));
            hinges.vertices.push(vertices);
            hinges.weights.push(weights);
            hinges.stiffness_n_per_mm.push(stiffness / area);
        }
    }
    hinges
}

/// D = E t³ / (12 (1 − ν²)) [N·mm].
fn plate_stiffness_n_mm(leaflet: &LeafletTissue) -> f64 {
    let modulus_mpa = match leaflet.tissue {
        Tissue::BilinearSprings {
            pre_transition_modulus_mpa,
            bending_modulus_ratio,
            ..
        } => bending_modulus_ratio * pre_transition_modulus_mpa,
        Tissue::AnisotropicSprings {
            bending_modulus_mpa, ..
        }
        | Tissue::StVenantKirchhoff {
            bending_modulus_mpa, ..
        }
        | Tissue::Exponential {
            bending_modulus_mpa, ..
        }
        | Tissue::MayNewman {
            bending_modulus_mpa, ..
        } => bending_modulus_mpa,
    };
    modulus_mpa * leaflet.thickness_mm.powi(3) / (12.0 * (1.0 - POISSON_RATIO * POISSON_RATIO))
}

/// Angles of unloaded triangles below this count as this in a hinge, as a cotangent [1]: 10°. The lever of a needle is its
/// height, and the stiffness of its hinge grows as the inverse square of that: without the limit one needle holds up the
/// solver; at 20° fair meshes would feel it.
const MOST_COTANGENT: f64 = 5.67;

/// The cotangents at both ends of edge ab on the way to c and d, gathered by vertex, and the area of both triangles [mm²].
/// All weights of a needle are smaller by the same factor, so that a flat sheet still stores nothing.
fn weights_and_area([a, b, c, d]: [Vec3; 4]) -> ([f64; 4], f64) {
    let cotangent = |p: Vec3, q: Vec3| p.dot(&q) / p.cross(&q).norm();
    let [at_a, at_b] = [[b - a, c - a, d - a], [a - b, c - b, d - b]]
        .map(|[along, to_c, to_d]| [cotangent(along, to_c), cotangent(along, to_d)]);
    let area = 0.5 * ((b - a).cross(&(c - a)).norm() + (b - a).cross(&(d - a)).norm());
    let area = area.max((b - a).norm_squared() / (2.0 * MOST_COTANGENT));
    let sharpest = at_a.into_iter().chain(at_b).map(f64::abs).fold(0.0, f64::max);
    let part = if sharpest > MOST_COTANGENT {
        MOST_COTANGENT / sharpest
    } else {
        1.0
    };
    let weights = [
        at_b[0] + at_b[1],
        at_a[0] + at_a[1],
        -at_a[0] - at_b[0],
        -at_a[1] - at_b[1],
    ];
    // A triangle without any area has no cotangents: it bends freely.
    let weights = weights.map(|weight| weight * part);
    let finite = weights.iter().all(|weight| weight.is_finite());
    (if finite { weights } else { [0.0; 4] }, area)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::energy::bending;
    use crate::mesh::topology;

    /// 20 rows of 20 pairs of equilateral triangles, sides 1 mm.
    fn lattice() -> (Vec<Vec3>, Vec<[u32; 3]>) {
        const STEPS: u32 = 20;
        let row = STEPS + 1;
        let place = |v: u32| {
            let (i, j) = (f64::from(v % row), f64::from(v / row));
            Vec3::new(i + 0.5 * j, 0.75_f64.sqrt() * j, 0.0)
        };
        let cells = (0..STEPS * STEPS).map(|c| c / STEPS * row + c % STEPS);
        let faces: Vec<[u32; 3]> = cells
            .flat_map(|v| [[v, v + 1, v + row], [v + 1, v + row + 1, v + row]])
            .collect();
        ((0..row * row).map(place).collect(), faces)
    }

    /// The hinges of a lattice of default tissue, 2 mm thick, with some ratio of the bending modulus to the soft one.
    fn hinges_of(points: &[Vec3], faces: &[[u32; 3]], ratio: f64) -> Hinges {
        let mut leaflet = LeafletTissue {
            name: "plate".into(),
            thickness_mm: 2.0,
            tissue: Tissue::default(),
        };
        if let Tissue::BilinearSprings {
            bending_modulus_ratio,
            ..
        } = &mut leaflet.tissue
        {
            *bending_modulus_ratio = ratio;
        }
        let sheet = Sheet {
            rest_mm: points,
            faces,
            face_leaflet: &vec![0; faces.len()],
            annulus: &[],
            leaflets: &[leaflet],
        };
        hinges(&sheet, &topology::edges(faces))
    }

    /// Rolled to a cylinder of radius R, a plate stores D / 2R² per area, in whatever direction. 6 %: two faces in 40 along
    /// each side have a border instead of a hinge.
    #[test]
    fn a_rolled_sheet_stores_what_a_plate_does() {
        let (points, faces) = lattice();
        let hinges = hinges_of(&points, &faces, 6.0);
        let flat = bending::energy(&hinges, &points);
        assert!(flat < 1e-20, "{flat}");
        for (radius, turn) in [(15.0, 0.0), (15.0, 0.7), (-30.0, 1.3_f64)] {
            let (sin, cos) = f64::sin_cos(turn);
            let roll = |p: &Vec3| {
                let (along, across) = (p.x * cos + p.y * sin, p.y * cos - p.x * sin);
                Vec3::new(
                    radius * (along / radius).sin(),
                    across,
                    radius * (along / radius).cos(),
                )
            };
            let rolled: Vec<Vec3> = points.iter().map(roll).collect();
            // Each face is half of a rhomb with sides of 1 mm.
            let area = faces.len() as f64 * 0.75_f64.sqrt() / 2.0;
            let expected = 6.0 * 0.08 * 8.0 / (12.0 * 8.0 / 9.0) * area / (2.0 * radius * radius);
            let found = bending::energy(&hinges, &rolled);
            assert!((found / expected - 1.0).abs() < 0.06, "{found} {expected}");
        }
    }

    #[test]
    fn tissue_without_bending_stiffness_has_no_hinges() {
        let (points, faces) = lattice();
        assert_eq!(hinges_of(&points, &faces, 0.0), Hinges::default());
    }
}

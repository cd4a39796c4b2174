//! How far edge springs are from the isotropic sheet that they stand for, from the shape of their triangles alone.
//!
//! Edge springs are that sheet on equilateral triangles only. Elsewhere they err in two ways. Triangles that are all long
//! in one direction make the network stiffer one way than another: refining such a mesh does not help. Triangles that
//! differ from their neighbours make it too soft, for vertices then move where a sheet would have held them.
//!
//! Strains of the plane are counted in an orthonormal basis of the sheet's energy: all around, and the two shears. Then the
//! sheet's stiffness is the identity, and a spring at an angle φ has elongation per length q·ε with
//! q = (1, √2 cos 2φ, √2 sin 2φ) / √3, |q| = 1. Where vertices follow the strain, springs of stiffness E t A / L² around
//! a vertex of area a have the stiffness Σ ½ A q qᵀ / a, whose trace is that of the identity whatever the mesh. The vertex is
//! pulled by B ε, B = Σ (A / L) u qᵀ with u the spring's direction, gives way by K⁻¹ B ε, K = Σ (A / L²) u uᵀ, and so takes
//! Bᵀ K⁻¹ B off. Its neighbours do likewise, which `GIVING_WAY` accounts for.

use super::Model;
use super::elasticity::Sheet;
use super::faults::Faults;
use super::membranes;
use super::surface::Surface;
use crate::Vec3;
use crate::mesh::topology::{self, Edges};
use nalgebra::{Matrix2, Matrix2x3, Matrix3, Vector2, Vector3};
use std::collections::BTreeSet;

/// How well springs on a leaflet's mesh render the isotropic sheet; what tissue the springs have does not matter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringQuality {
    /// The leaflet.
    pub leaflet: u32,
    /// How far the stiffness is off in the kind of strain that the mesh renders worst, mean over the leaflet [1].
    pub stiffness_error: f64,
    /// How much too soft the springs are, mean over the leaflet and all kinds of strain [1].
    pub softening: f64,
    /// Where the stiffness is most off.
    pub worst_vertex: u32,
    /// By how much there [1].
    pub worst_error: f64,
}

/// Measured on whole lattices of 12 × 12 edges, equilateral ones and squares with diagonals, their vertices moved by
/// 0.05 to 0.35 edges each way: they are softer by 0.75 to 0.91 of the sum of what single vertices take off.
const GIVING_WAY: f64 = 0.85;
/// Rings of neighbours over which stiffness is averaged. What is left of chance then is a third of the error that a disturbed
/// lattice as a whole has; with one ring it is once that error, with more the place is lost.
const RINGS: usize = 2;

/// Above this mean error of stiffness [1] the mesh is told of. Parametric valves have 0.12 to 0.20, squares with diagonals all
/// one way 0.67, with alternating ones 0.31, published valves of quadrilaterals 0.4 to 0.8. Lower, every valve would be
/// told of, and nobody would read it; higher, alternating diagonals would pass.
pub const MOST_STIFFNESS_ERROR: f64 = 0.25;
/// Above this mean softening [1] the mesh is told of: equilateral lattices moved by more than about 0.22 of an edge.
/// Parametric valves have 0.01.
pub const MOST_SOFTENING: f64 = 0.05;

/// The quality of each leaflet that is made of springs and has a vertex whose triangles are all its own.
pub fn spring_quality(sheet: &Sheet, edges: &Edges) -> Vec<SpringQuality> {
    let net = Net::new(sheet, edges);
    let leaflets = 0..sheet.leaflets.len() as u32;
    leaflets.filter_map(|leaflet| of_leaflet(&net, leaflet)).collect()
}

/// [`spring_quality`] of a model.
pub fn of_model(model: &Model) -> Vec<SpringQuality> {
    spring_quality(&Sheet::of(model), &topology::edges(&model.faces))
}

/// Tells of leaflets whose springs are off by more than [`MOST_STIFFNESS_ERROR`] or [`MOST_SOFTENING`].
pub(super) fn tell(sheet: &Sheet, edges: &Edges, surface: &Surface, faults: &mut Faults) {
    for quality in spring_quality(sheet, edges) {
        if quality.stiffness_error <= MOST_STIFFNESS_ERROR && quality.softening <= MOST_SOFTENING {
            continue;
        }
        let message = format!(
            "the mesh is too irregular for springs: in the strain that they render worst their stiffness is {:.0} % off \
             that of the sheet they stand for, mean over the leaflet, {:.0} % here; over all strains they are {:.0} % too \
             soft (expected at most {:.0} % and {:.0} %); a membrane law has no such error, or remesh with triangles \
             that are nearly equilateral",
            100.0 * quality.stiffness_error,
            100.0 * quality.worst_error,
            100.0 * quality.softening,
            100.0 * MOST_STIFFNESS_ERROR,
            100.0 * MOST_SOFTENING
        );
        faults.warning(surface.point_name(quality.worst_vertex), message);
    }
}

fn of_leaflet(net: &Net, leaflet: u32) -> Option<SpringQuality> {
    let mut quality = SpringQuality {
        leaflet,
        stiffness_error: 0.0,
        softening: 0.0,
        worst_vertex: 0,
        worst_error: -1.0,
    };
    let mut whole = 0.0;
    for vertex in (0..net.leaflet.len() as u32).filter(|&v| net.leaflet[v as usize] == Some(leaflet)) {
        let eigenvalues = net.stiffness_about(vertex).symmetric_eigenvalues();
        // No stiffness is below none; where neighbours differ very much the estimate of how they give way may be.
        let off = |ratio: f64| (ratio.max(0.0) - 1.0).abs();
        let error = eigenvalues.iter().copied().map(off).fold(0.0, f64::max);
        let area = net.area_mm2(vertex);
        quality.stiffness_error += area * error;
        quality.softening += area * (1.0 - eigenvalues.map(|ratio| ratio.max(0.0)).mean());
        whole += area;
        if error > quality.worst_error {
            (quality.worst_vertex, quality.worst_error) = (vertex, error);
        }
    }
    quality.stiffness_error /= whole;
    // Rounding alone is below zero.
    quality.softening = (quality.softening / whole).max(0.0);
    (whole > 0.0).then_some(quality)
}

/// Springs of unit modulus and thickness, as each vertex sees them.
struct Net<'a> {
    rest_mm: &'a [Vec3],
    /// Sum of the normals of the faces around, shape `[vertex]`.
    normal: Vec<Vec3>,
    /// The other ends of a vertex's springs, and the area next to each [mm²], shape `[vertex, spring]`.
    neighbours: Vec<Vec<(u32, f64)>>,
    /// The leaflet whose springs surround a vertex; none on a border, or where there are no springs. Shape `[vertex]`.
    leaflet: Vec<Option<u32>>,
}

impl<'a> Net<'a> {
    fn new(sheet: &Sheet<'a>, edges: &Edges) -> Self {
        let count = sheet.rest_mm.len();
        let doubled = |face: usize| {
            let [a, b, c] = sheet.faces[face].map(|vertex| sheet.rest_mm[vertex as usize]);
            (b - a).cross(&(c - a))
        };
        let mut net = Self {
            rest_mm: sheet.rest_mm,
            normal: vec![Vec3::zeros(); count],
            neighbours: vec![Vec::new(); count],
            leaflet: vec![None; count],
        };
        for (face, corners) in sheet.faces.iter().enumerate() {
            let number = sheet.face_leaflet[face];
            let is_sprung = membranes::tissue(sheet.leaflet(face as u32)).is_none();
            for &corner in corners {
                net.normal[corner as usize] += doubled(face);
                net.leaflet[corner as usize] = is_sprung.then_some(number);
            }
        }
        for (edge, &[a, b]) in edges.ends.iter().enumerate() {
            let faces = edges.faces_of(edge);
            let area = faces
                .iter()
                .map(|&face| 0.5 * doubled(face as usize).norm())
                .sum();
            let first = sheet.face_leaflet[faces[0] as usize];
            let is_inside = faces.len() == 2 && sheet.face_leaflet[faces[1] as usize] == first;
            for [vertex, other] in [[a, b], [b, a]] {
                net.neighbours[vertex as usize].push((other, area));
                if !is_inside {
                    net.leaflet[vertex as usize] = None;
                }
            }
        }
        net
    }

    /// A third of the triangles around.
    fn area_mm2(&self, vertex: u32) -> f64 {
        // Each triangle is next to two springs.
        let around = self.neighbours[vertex as usize].iter();
        around.map(|(_, area)| area / 6.0).sum()
    }

    /// The springs' stiffness over the sheet's, mean over a patch about a vertex; the identity where the mesh is perfect.
    fn stiffness_about(&self, vertex: u32) -> Matrix3<f64> {
        let Some(normal) = self.normal[vertex as usize].try_normalize(0.0) else {
            return Matrix3::identity();
        };
        // The axis that lies most nearly in the plane is laid into it.
        let first = Vec3::ith(normal.iamin(), 1.0).cross(&normal).normalize();
        let frame = [first, normal.cross(&first)];
        let (mut stiffness, mut area) = (Matrix3::zeros(), 0.0);
        for member in self.patch(vertex) {
            stiffness += self.stiffness(member, frame);
            area += self.area_mm2(member);
        }
        stiffness / area
    }

    /// The vertex and those around it that lie within the same leaflet.
    fn patch(&self, vertex: u32) -> BTreeSet<u32> {
        let mut patch = BTreeSet::from([vertex]);
        for _ in 0..RINGS {
            let around = patch.iter().flat_map(|&member| &self.neighbours[member as usize]);
            let alike =
                |&&(other, _): &&(u32, f64)| self.leaflet[other as usize] == self.leaflet[vertex as usize];
            let found: Vec<u32> = around.filter(alike).map(|&(other, _)| other).collect();
            patch.extend(found);
        }
        patch
    }

    /// Area times stiffness of the springs at a vertex in a frame of the plane.
    fn stiffness(&self, vertex: u32, [first, second]: [Vec3; 2]) -> Matrix3<f64> {
        let mut following = Matrix3::zeros();
        let (mut pull, mut hold) = (Matrix2x3::zeros(), Matrix2::zeros());
        for &(other, area) in &self.neighbours[vertex as usize] {
            let along = self.rest_mm[other as usize] - self.rest_mm[vertex as usize];
            let laid = Vector2::new(along.dot(&first), along.dot(&second));
            let (length, Some(u)) = (along.norm(), laid.try_normalize(1e-9 * along.norm())) else {
                continue;
            };
            let root = 2.0_f64.sqrt();
            let q =
                Vector3::new(1.0, root * (u.x * u.x - u.y * u.y), root * 2.0 * u.x * u.y) / 3.0_f64.sqrt();
            following += q * q.transpose() * (0.5 * area);
            pull += u * q.transpose() * (area / length);
            hold += u * u.transpose() * (area / (length * length));
        }
        let given_way = hold.try_inverse().map(|give| pull.tr_mul(&(give * pull)));
        following - given_way.unwrap_or_default() * GIVING_WAY
    }
}

#[cfg(test)]
mod tests {
    use super::super::LeafletTissue;
    use super::super::fixtures::{built, skirt, told};
    use super::*;
    use crate::scene::Tissue;

    /// A lattice of n × n pairs of triangles, rows `height_mm` apart and each moved by half an edge of 1 mm if `slanted`.
    fn quality(n: u32, height_mm: f64, slanted: bool, tissue: Tissue) -> Option<SpringQuality> {
        let at = |i: u32| (i % (n + 1), i / (n + 1));
        let shift = |row: u32| if slanted { 0.5 * f64::from(row) } else { 0.0 };
        let point = |(column, row): (u32, u32)| {
            Vec3::new(f64::from(column) - shift(row), 0.0, f64::from(row) * height_mm)
        };
        let rest_mm: Vec<Vec3> = (0..(n + 1).pow(2)).map(|i| point(at(i))).collect();
        let cell = |i: u32| [[i, i + 1, i + n + 2], [i, i + n + 2, i + n + 1]];
        let cells = (0..(n + 1) * n).filter(|&i| at(i).0 < n);
        let faces: Vec<[u32; 3]> = cells.flat_map(cell).collect();
        let sheet = Sheet {
            rest_mm: &rest_mm,
            faces: &faces,
            face_leaflet: &vec![0; faces.len()],
            annulus: &[],
            leaflets: &[LeafletTissue {
                name: String::new(),
                thickness_mm: 1.0,
                tissue,
            }],
        };
        spring_quality(&sheet, &topology::edges(&faces)).first().copied()
    }

    /// Springs along the sides and diagonals of squares, φ = 0, 90 and 45 degrees, each with the area of a square: stretched along
    /// one side or the other 1/3 and 4/3 mix, sheared along the sides it is 4/3; eigenvalues of Σ q qᵀ: 1/3, 4/3, 4/3.
    #[test]
    fn regular_lattices_have_the_error_that_arithmetic_says() {
        let close = |found: f64, expected: f64| (found - expected).abs() < 1e-12;
        let perfect = quality(8, 0.75_f64.sqrt(), true, Tissue::default()).unwrap();
        assert!(
            perfect.stiffness_error < 1e-12 && perfect.softening.abs() < 1e-12,
            "{perfect:?}"
        );
        let squares = quality(8, 1.0, false, Tissue::default()).unwrap();
        assert!(close(squares.stiffness_error, 2.0 / 3.0) && close(squares.worst_error, 2.0 / 3.0));
        assert!(squares.softening.abs() < 1e-12, "{squares:?}");
    }

    #[test]
    fn membranes_and_single_rows_have_none() {
        let membrane = Tissue::StVenantKirchhoff {
            modulus_mpa: 0.4,
            poisson_ratio: 0.5,
            wrinkling: Default::default(),
            bending_modulus_mpa: 0.0,
        };
        assert_eq!(quality(8, 1.0, false, membrane), None);
        assert_eq!(quality(1, 1.0, false, Tissue::default()), None);
    }

    #[test]
    fn a_valve_of_cut_rectangles_is_told_of_and_as_a_membrane_is_not() {
        let mut scene = skirt();
        assert!(told(
            &built(&scene).warnings,
            "leaflets[0].mesh point",
            "too irregular for springs"
        ));
        assert!(told(
            &built(&scene).warnings,
            "leaflets[1].mesh point",
            "too irregular for springs"
        ));
        for leaflet in &mut scene.leaflets {
            leaflet.tissue = Tissue::StVenantKirchhoff {
                modulus_mpa: 0.4,
                poisson_ratio: 0.5,
                wrinkling: Default::default(),
                bending_modulus_mpa: 0.0,
            };
        }
        assert!(built(&scene).warnings.is_empty());
    }
}

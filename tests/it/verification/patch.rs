//! Patch tests: sheets whose boundary is displaced so that the strain should be the same everywhere.
//!
//! Edge springs fail them on anything but the lattice of equilateral triangles; by how much is measured here, so that it can
//! be said. Linear elasticity: what is solved is the tangent at rest.

use coapt::Vec3;
use coapt::energy::bilinear_spring;
use coapt::model::mesh_quality::{self, MOST_SOFTENING, MOST_STIFFNESS_ERROR, SpringQuality};
use coapt_tests::Random;
use nalgebra::{DMatrix, DVector};

use super::{oracle, order, report, settled};
use crate::shapes::{Mesh, SpringTissue, bare, hold, lattice, sprung};

/// Displacements (u, v) of all vertices of a sheet of springs in the plane, those on the rim given, and the energy stored
/// [mm], [N·mm].
fn solved(mesh: &Mesh, tissue: SpringTissue, given: impl Fn(Vec3) -> Vec3) -> (Vec<Vec3>, f64) {
    let count = mesh.points_mm.len();
    let springs = crate::shapes::springs(mesh, tissue);
    let mut tangent = DMatrix::<f64>::zeros(2 * count, 2 * count);
    bilinear_spring::add_hessian(
        &springs,
        &mesh.points_mm,
        &mut |a: u32, b: u32, block: &coapt::Mat3| {
            let (a, b) = (2 * a as usize, 2 * b as usize);
            for i in 0..2 {
                for j in 0..2 {
                    tangent[(a + i, b + j)] += block[(i, j)];
                    if a != b {
                        tangent[(b + j, a + i)] += block[(i, j)];
                    }
                }
            }
        },
    );
    let mut all = DVector::<f64>::zeros(2 * count);
    for &vertex in &mesh.rim {
        let way = given(mesh.points_mm[vertex as usize]);
        all[2 * vertex as usize] = way.x;
        all[2 * vertex as usize + 1] = way.y;
    }
    let inner: Vec<usize> = (0..2 * count)
        .filter(|i| !mesh.rim.contains(&(*i as u32 / 2)))
        .collect();
    let pulled = &tangent * &all;
    let right = DVector::from_iterator(inner.len(), inner.iter().map(|&i| -pulled[i]));
    let square = DMatrix::from_fn(inner.len(), inner.len(), |i, j| tangent[(inner[i], inner[j])]);
    let solution = square.cholesky().expect("sheets are stiff").solve(&right);
    inner
        .iter()
        .zip(&solution)
        .for_each(|(&i, &value)| all[i] = value);
    let energy = 0.5 * (all.transpose() * &tangent * &all)[(0, 0)];
    let ways = (0..count)
        .map(|v| Vec3::new(all[2 * v], all[2 * v + 1], 0.0))
        .collect();
    (ways, energy)
}

/// The plate of `MacNeal` and Harder (1985): 0.24 × 0.12, five quadrilaterals about four inner nodes, each cut along one diagonal or
/// the other; u = 1e-3 (x + y/2), v = 1e-3 (y + x/2).
pub(super) fn macneal_harder(diagonal: usize) -> Mesh {
    let nodes = [
        [0.0, 0.0],
        [0.24, 0.0],
        [0.24, 0.12],
        [0.0, 0.12],
        [0.04, 0.02],
        [0.18, 0.03],
        [0.16, 0.08],
        [0.08, 0.08],
    ];
    let quads = [
        [0, 1, 5, 4],
        [1, 2, 6, 5],
        [2, 3, 7, 6],
        [3, 0, 4, 7],
        [4, 5, 6, 7],
    ];
    let cut = |[a, b, c, d]: [u32; 4]| match diagonal {
        0 => [[a, b, c], [a, c, d]],
        _ => [[a, b, d], [b, c, d]],
    };
    Mesh {
        points_mm: nodes.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec(),
        faces: quads.into_iter().flat_map(cut).collect(),
        rim: vec![0, 1, 2, 3],
    }
}

pub(super) fn macneal_harder_way(x: Vec3) -> Vec3 {
    Vec3::new(x.x + 0.5 * x.y, x.y + 0.5 * x.x, 0.0) * 1e-3
}

const MODULUS_MPA: f64 = 1e6;
const THICKNESS_MM: f64 = 1e-3;

/// Energy per area of an isotropic sheet in plane stress, for strains εx, εy and εxy.
fn energy_density(stiffness: f64, nu: f64, [x, y, xy]: [f64; 3]) -> f64 {
    let trace = x + y;
    0.5 * stiffness / (1.0 - nu * nu) * ((1.0 - nu) * (x * x + y * y + 2.0 * xy * xy) + nu * trace * trace)
}

/// Edge springs fail the test: inner displacements are 37 % off with one diagonal and 81 % with the other, and the energy is
/// 0.91 and 0.64 of the exact one for ν = 0.25. Figures of a failure, held in bands of a percent so that they stay true in
/// the documents.
#[test]
fn springs_fail_macneal_and_harders_patch() {
    let oracle = oracle("spring_patch.json");
    let exact_energy = 0.24 * 0.12 * energy_density(MODULUS_MPA * THICKNESS_MM, 0.25, [1e-3, 1e-3, 5e-4]);
    for (diagonal, displacement, energy) in [(0, 0.37, 0.91), (1, 0.81, 0.64)] {
        let mesh = macneal_harder(diagonal);
        let tissue = SpringTissue::linear(MODULUS_MPA * THICKNESS_MM);
        let (ways, stored) = solved(&mesh, tissue, macneal_harder_way);
        let largest = mesh
            .points_mm
            .iter()
            .map(|&x| macneal_harder_way(x).amax())
            .fold(0.0, f64::max);
        let off = |(x, way): (&Vec3, &Vec3)| (way - macneal_harder_way(*x)).amax() / largest;
        let worst = mesh.points_mm.iter().zip(&ways).map(off).fold(0.0, f64::max);
        report(&format!(
            "MacNeal-Harder, springs, diagonal {diagonal}: inner displacement off {:.1} %, energy {:.3} of the exact one",
            100.0 * worst,
            stored / exact_energy
        ));
        assert!((worst - displacement).abs() < 0.01, "{worst}");
        assert!((stored / exact_energy - energy).abs() < 0.01);
        if let Some(values) = &oracle {
            let row = &values[format!("macneal_harder diag{diagonal} vangelder0")];
            let number = |key: &str| row[key].as_f64().expect("a number");
            assert!((worst - number("max_interior_disp_error_rel")).abs() < 1e-9);
            assert!((stored / exact_energy - number("energy_ratio")).abs() < 1e-6);
        }
    }
}

/// The solver comes to what the linear solution says, up to terms of second order in the displacements: 0.5 and 1.7 % of them at
/// strains of 1e-3, a tenth of that part where they are ten times smaller.
#[test]
fn the_solver_finds_the_patch_that_the_tangent_promises() {
    for diagonal in [0, 1] {
        let [large, small] = [1.0, 0.1].map(|scale| {
            let mesh = macneal_harder(diagonal);
            let tissue = SpringTissue::linear(MODULUS_MPA * THICKNESS_MM);
            let given = |x: Vec3| macneal_harder_way(x) * scale;
            let (ways, _) = solved(&mesh, tissue, given);
            let mut model = sprung(&mesh, tissue, 0.0);
            // Forces are counted in those of a strain of 1e-3; second order is 1e-6 of these.
            model.settings.residual_tolerance = 1e-10;
            hold(&mut model, &mesh.rim);
            for held in &mut model.prescribed {
                held.target_mm += given(held.target_mm);
            }
            let positions = settled("patch", &model, mesh.points_mm.clone())
                .state
                .positions_mm;
            let off = |vertex: usize| (positions[vertex] - mesh.points_mm[vertex] - ways[vertex]).amax();
            (4..8).map(off).fold(0.0, f64::max)
        });
        report(&format!(
            "MacNeal-Harder, springs, diagonal {diagonal}: solver off the linear solution by {large:.1e}, {small:.1e}"
        ));
        assert!(large < 0.02 * 3e-4);
        assert!((order([1.0, 0.1], [large, small]) - 2.0).abs() < 0.05);
    }
}

/// The lattice of equilateral triangles is exact; moved vertices make the network softer, and strains uneven.
#[test]
fn springs_soften_as_their_lattice_is_disturbed() {
    const SHEETS: u32 = 3;
    let strains = [
        ("equibiaxial", [1.0, 1.0, 0.0]),
        ("along x", [1.0, 0.0, 0.0]),
        ("along y", [0.0, 1.0, 0.0]),
        ("shear", [0.0, 0.0, 0.5]),
    ];
    for (jitter_mm, softest, stiffest) in [
        (0.0, 1.0 - 1e-12, 1.0 + 1e-12),
        (0.1, 0.985, 0.997),
        (0.2, 0.95, 0.98),
        (0.3, 0.89, 0.94),
    ] {
        let mut random = Random(1);
        let sheets: Vec<Mesh> = (0..SHEETS).map(|_| lattice(12, jitter_mm, &mut random)).collect();
        for (name, [x, y, xy]) in strains {
            let ratio = |mesh: &Mesh| {
                let way = |at: Vec3| Vec3::new(x * at.x + xy * at.y, xy * at.x + y * at.y, 0.0) * 1e-3;
                let (_, stored) = solved(mesh, SpringTissue::linear(1.0), way);
                stored / (1e-6 * mesh.area_mm2(&mesh.points_mm) * energy_density(1.0, 1.0 / 3.0, [x, y, xy]))
            };
            let mean = sheets.iter().map(ratio).sum::<f64>() / f64::from(SHEETS);
            report(&format!(
                "lattice moved by {jitter_mm} edges, {name}: energy {mean:.4} of the exact one"
            ));
            assert!(mean >= softest && mean <= stiffest, "{name} {jitter_mm}: {mean}");
        }
    }
}

/// What the shape of the triangles says of springs on a mesh.
fn quality(mesh: &Mesh) -> SpringQuality {
    mesh_quality::of_model(&bare(mesh, 0.0))[0]
}

/// How much softer than the isotropic sheet a mesh is, mean of three strains of equal energy that stand on each other.
fn softening(mesh: &Mesh) -> f64 {
    let strains = [[1.0, 1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 0.0, 1.0]];
    let ratio = |[x, y, xy]: [f64; 3]| {
        let way = |at: Vec3| Vec3::new(x * at.x + xy * at.y, xy * at.x + y * at.y, 0.0) * 1e-3;
        let (_, stored) = solved(mesh, SpringTissue::linear(1.0), way);
        stored / (1e-6 * mesh.area_mm2(&mesh.points_mm) * energy_density(1.0, 1.0 / 3.0, [x, y, xy]))
    };
    1.0 - strains.map(ratio).iter().sum::<f64>() / 3.0
}

/// What the mesh alone foretells is what the whole lattice does: a quarter of it is between them, the border having none to give
/// way (a fifth of the vertices) and neighbours giving way together. `coapt check` tells of a lattice moved by 0.3 edges
/// and of the patch, and of none moved by 0.1.
#[test]
fn the_shape_of_triangles_foretells_how_soft_springs_are() {
    for (jitter_mm, is_told) in [(0.0, false), (0.1, false), (0.2, false), (0.3, true)] {
        let mesh = lattice(12, jitter_mm, &mut Random(1));
        let (found, foretold) = (softening(&mesh), quality(&mesh));
        report(&format!(
            "lattice moved by {jitter_mm} edges: {:.2} % too soft, foretold {:.2} %; in the worst strain {:.0} % off",
            100.0 * found,
            100.0 * foretold.softening,
            100.0 * foretold.stiffness_error
        ));
        assert!((found - foretold.softening).abs() < 0.25 * found + 1e-12);
        assert_eq!(tells(&foretold), is_told);
    }
    for diagonal in [0, 1] {
        let foretold = quality(&macneal_harder(diagonal));
        report(&format!(
            "MacNeal-Harder, diagonal {diagonal}: foretold {foretold:?}"
        ));
        assert!(tells(&foretold));
    }
}

fn tells(quality: &SpringQuality) -> bool {
    quality.softening > MOST_SOFTENING || quality.stiffness_error > MOST_STIFFNESS_ERROR
}

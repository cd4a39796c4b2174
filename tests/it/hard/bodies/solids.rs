//! Closed bodies of few faces: a tetrahedron squashed, or begun inside out; cubes on each other; a block on a membrane.

use coapt::Vec3;
use coapt::energy::bilinear_spring::Springs;
use coapt::model::Model;
use coapt::scene::Contact;

use super::assembly::{Body, Matter, assemble, height_field};
use super::begun;
use crate::hard::{HardCase, Jitter};
use crate::shapes::{Mesh, SpringTissue};

pub(super) fn cases() -> Vec<HardCase> {
    let mut cases = Vec::new();
    for (place, part) in [("over", 1.0 - PAST), ("past", 1.0 + PAST)] {
        cases.push(begun(
            format!("tetrahedron, its apex driven to {PAST:e} of its height {place} its base"),
            "four faces, each vertex over the only face that it does not belong to",
            move |jitter| squashed(jitter, part),
        ));
    }
    cases.push(begun(
        format!("tetrahedron begun with its apex {PAST:e} of its edge through its base"),
        "inside out, though no two faces cross: its shape at rest alone tells on which side the apex belongs",
        begun_inside_out,
    ));
    for (name, what, gap_mm, way_mm) in [
        ("far from each other", "nothing to do", 5.0, 0.0),
        (
            "1e-3 mm from each other, pressed on each other",
            "large equal faces, exactly parallel, diagonal over diagonal",
            1e-3,
            -1.0,
        ),
        (
            "begun in each other",
            "all corners of one face are within the other cube",
            -1.0,
            1.5,
        ),
    ] {
        cases.push(begun(format!("two cubes {name}"), what, move |jitter| {
            cubes(jitter, gap_mm, way_mm)
        }));
    }
    cases.push(begun(
        "block pressed on a membrane of 25 x 25 cells",
        "its corners and edges meet a mesh far finer than its own",
        |jitter| {
            let membrane = height_field(25, 12.5, |_, _| 0.0);
            let block = standing(cuboid(Vec3::new(-4.0, -4.0, 1.0), Vec3::new(4.0, 4.0, 9.0)), -3.0);
            assemble(
                &[Body::sheet(membrane, Vec3::zeros()), block],
                &Matter::default(),
                jitter,
            )
        },
    ));
    cases.push(begun(
        "block that lies on a membrane of 25 x 25 cells",
        "nothing else holds it; in FEBio's co30 it falls there and bounces, here it begins as high and comes to rest, and no guide \
         keeps it upright",
        lying,
    ));
    cases
}

/// As a part of its height, or of its edge [1].
const PAST: f64 = 5e-4;

/// Two corners of the base are held; the third may swing out of the apex's way.
fn squashed(jitter: &mut Jitter, part: f64) -> (Model, Vec<Vec3>) {
    const HEIGHT_MM: f64 = 5.0;
    let mesh = Mesh {
        points_mm: vec![
            Vec3::new(-3.0, -2.0, 0.0),
            Vec3::new(3.0, -2.0, 0.0),
            Vec3::new(0.0, 4.0, 0.0),
            Vec3::new(0.0, 0.0, HEIGHT_MM),
        ],
        faces: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
        rim: vec![],
    };
    let body = Body {
        held: vec![0, 1, 3],
        ..Body::free(mesh)
    };
    let (mut model, start_mm) = assemble(&[body], &Matter::default(), jitter);
    for held in model.prescribed.iter_mut().filter(|held| held.vertex == 3) {
        held.target_mm.z -= part * HEIGHT_MM;
    }
    (model, start_mm)
}

/// The "Squash Tet" of the tests of ipc-toolkit, which has the origin and the ends of the axes for corners: there the apex
/// goes to where it begins here, 5e-4 below the base and beside it, so that one edge is below another one.
fn begun_inside_out(jitter: &mut Jitter) -> (Model, Vec<Vec3>) {
    const EDGE_MM: f64 = 5.0;
    let mesh = Mesh {
        points_mm: vec![
            Vec3::zeros(),
            Vec3::x() * EDGE_MM,
            Vec3::y() * EDGE_MM,
            Vec3::z() * EDGE_MM,
        ],
        faces: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
        rim: vec![],
    };
    let base = Body {
        held: vec![0, 1, 2],
        ..Body::free(mesh)
    };
    let (model, mut start_mm) = assemble(&[base.level()], &Matter::default(), jitter);
    start_mm[3] += Vec3::new(0.1, -0.1, -1.0 - PAST) * EDGE_MM;
    (model, start_mm)
}

/// Lengths [mm], weights [N] and moduli [MPa] are co30's numbers: a rigid cube of 1 and of a weight of 1 over a membrane of
/// 5 by 5, 0.1 thick, of a modulus of 500 and a weight of 2.5. There the cube may only rise and sink; here nothing holds it,
/// and springs a hundred times as stiff as the membrane make it all but rigid.
fn lying(jitter: &mut Jitter) -> (Model, Vec<Vec3>) {
    const HALF_MM: f64 = 2.5;
    const CELLS: u32 = 25;
    const BLOCK_N: f64 = 1.0;
    const MEMBRANE_N: f64 = 2.5;
    let low = Vec3::new(-0.5, -0.5, 1.37392);
    let bodies = [
        Body::sheet(height_field(CELLS, HALF_MM, |_, _| 0.0), Vec3::zeros()),
        Body::free(cuboid(low, low + Vec3::repeat(1.0))),
    ];
    let (mut model, start_mm) = assemble(&bodies, &matter_of_co30(), jitter);
    let first_of_block = bodies[0].mesh.points_mm.len() as u32;
    stiffen(&mut model.springs, first_of_block, 100.0);
    // Points at the rim weigh less than others; but these are held.
    let of_point_n = [MEMBRANE_N / f64::from(CELLS * CELLS), BLOCK_N / 8.0];
    let weight = |vertex| {
        (
            vertex,
            -Vec3::z() * of_point_n[usize::from(vertex >= first_of_block)],
        )
    };
    model.dead_loads_n = (0..start_mm.len() as u32).map(weight).collect();
    (model, start_mm)
}

fn matter_of_co30() -> Matter {
    const THICKNESS_MM: f64 = 0.1;
    const MODULUS_MPA: f64 = 500.0;
    const POISSON_RATIO: f64 = 0.4;
    Matter {
        springs: SpringTissue::linear(MODULUS_MPA * THICKNESS_MM),
        plate_n_mm: MODULUS_MPA * THICKNESS_MM.powi(3) / (12.0 * (1.0 - POISSON_RATIO.powi(2))),
        contact: Contact {
            thickness_mm: THICKNESS_MM,
            ..Contact::default()
        },
        ..Matter::default()
    }
}

/// Makes springs from a vertex on so many times as stiff.
fn stiffen(springs: &mut Springs, first: u32, times: f64) {
    for (index, ends) in springs.ends.iter().enumerate() {
        if ends[0] >= first {
            springs.soft_n_per_mm[index] *= times;
            springs.stiff_n_per_mm[index] *= times;
            springs.compression_n_per_mm[index] *= times;
        }
    }
}

/// A cube on its base, and another over it that is held at its top.
fn cubes(jitter: &mut Jitter, gap_mm: f64, way_mm: f64) -> (Model, Vec<Vec3>) {
    const SIDE_MM: f64 = 4.0;
    let cube = |from: f64, side_mm: f64| {
        let half = Vec3::new(0.5 * side_mm, 0.5 * side_mm, 0.0);
        cuboid(-half + Vec3::z() * from, half + Vec3::z() * (from + side_mm))
    };
    let lower = cube(-SIDE_MM, SIDE_MM);
    let lower = Body {
        held: vec![0, 1, 2, 3],
        ..Body::free(lower)
    };
    // In each other they are of two sizes, else sides would be in sides.
    let upper_mm = if gap_mm < 0.0 { 0.5 * SIDE_MM } else { SIDE_MM };
    let upper = standing(cube(gap_mm, upper_mm), way_mm);
    assemble(&[lower.level(), upper.level()], &Matter::default(), jitter)
}

/// A cuboid held at its top, which goes up or down.
fn standing(mesh: Mesh, way_mm: f64) -> Body {
    Body {
        held: vec![4, 5, 6, 7],
        way_mm: Vec3::z() * way_mm,
        ..Body::free(mesh)
    }
}

/// Eight corners, the lower four first, and two faces a side that look outwards.
fn cuboid(low: Vec3, high: Vec3) -> Mesh {
    let corner = |k: usize| {
        let pick = |axis: usize, is_high: bool| if is_high { high[axis] } else { low[axis] };
        Vec3::new(pick(0, k & 1 == 1), pick(1, k & 2 == 2), pick(2, k & 4 == 4))
    };
    let side = |[a, b, c, d]: [u32; 4]| [[a, b, c], [b, d, c]];
    let sides = [
        [0, 2, 1, 3],
        [4, 5, 6, 7],
        [0, 1, 4, 5],
        [2, 6, 3, 7],
        [0, 4, 2, 6],
        [1, 3, 5, 7],
    ];
    Mesh {
        points_mm: (0..8).map(corner).collect(),
        faces: sides.into_iter().flat_map(side).collect(),
        rim: vec![],
    }
}

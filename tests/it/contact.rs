//! Contact: the list of pairs misses nothing, and steps tunnel through nothing.

use coapt::Vec3;
use coapt::contact::crossing::crossings;
use coapt::contact::gather::PairList;
use coapt::contact::nearest::{edge_edge, point_triangle};
use coapt::contact::pairs::{Pair, PairKind, Place};
use coapt::contact::step_bound::bound_steps;
use coapt::contact::surface::Surface;
use coapt_tests::Random;
use std::collections::BTreeSet;

/// Triangles of edge length about `size` scattered in a cube of side 2, sharing vertices in places.
pub(crate) fn scattered_triangles(count: u32, size: f64, random: &mut Random) -> (Vec<[u32; 3]>, Vec<Vec3>) {
    let mut positions = Vec::new();
    for _ in 0..count {
        let centre = random.vector();
        positions.extend((0..3).map(|_| centre + random.vector() * size));
    }
    let mut faces: Vec<[u32; 3]> = (0..count).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    // A tenth of the faces takes over a vertex of the one before.
    for k in (10..count as usize).step_by(10) {
        faces[k][0] = faces[k - 1][2];
    }
    (faces, positions)
}

#[test]
fn the_pair_list_holds_every_pair_in_reach() {
    let mut random = Random(12);
    let (faces, positions) = scattered_triangles(150, 0.15, &mut random);
    // Far apart at rest, so that every pair has the full thickness.
    let rest: Vec<Vec3> = (0..positions.len())
        .map(|k| Vec3::new(100.0 * k as f64, 0.0, 0.0))
        .collect();
    let surface = Surface::new(&faces, &rest);
    let mut list = PairList::default();
    let thickness = 0.1;
    // A step of many thicknesses, then some that a list outlasts: whatever is within the thickness at the end of any of
    // them must be found.
    let mut here = positions;
    for longest in [0.5, 0.005, 0.005, 0.01, 0.005, 0.05] {
        let step: Vec<Vec3> = here.iter().map(|_| random.vector() * longest).collect();
        let place = Place {
            surface: &surface,
            rest_mm: &rest,
            positions_mm: &here,
            thickness_mm: thickness,
            rigid_fraction: 0.5,
            kept_fraction: 0.0,
        };
        let mut found = Vec::new();
        list.gather(&place, &step, &mut found);
        let moved: Vec<Vec3> = here.iter().zip(&step).map(|(x, s)| x + s).collect();
        assert_holds_every_pair_in_reach(&found, &surface, &moved, thickness);
        here = moved;
    }
}

/// Every pair of parts that share no vertex and are nearer than the thickness is among those found.
fn assert_holds_every_pair_in_reach(found: &[Pair], surface: &Surface, moved: &[Vec3], thickness: f64) {
    let listed: BTreeSet<(PairKind, [u32; 4])> =
        found.iter().map(|pair| (pair.kind, pair.vertices)).collect();
    assert_eq!(listed.len(), found.len(), "each pair once");
    let mut near = 0;
    let used: BTreeSet<u32> = surface.faces.iter().flatten().copied().collect();
    for &[a, b, c] in &surface.faces {
        for &vertex in used.iter().filter(|vertex| ![a, b, c].contains(vertex)) {
            let at = |v: u32| &moved[v as usize];
            if point_triangle(at(vertex), at(a), at(b), at(c))
                .separation_mm
                .norm()
                < thickness
            {
                assert!(listed.contains(&(PairKind::PointTriangle, [vertex, a, b, c])));
                near += 1;
            }
        }
    }
    for (index, &[a, b]) in surface.edges.iter().enumerate() {
        for &[c, d] in &surface.edges[index + 1..] {
            let apart = a != c && a != d && b != c && b != d;
            let at = |v: u32| &moved[v as usize];
            if apart && edge_edge(at(a), at(b), at(c), at(d)).separation_mm.norm() < thickness {
                let edges = [[a, b, c, d], [c, d, a, b]];
                assert!(
                    edges
                        .iter()
                        .any(|&edges| listed.contains(&(PairKind::EdgeEdge, edges)))
                );
                near += 1;
            }
        }
    }
    assert!(near > 500, "the test must have something to find: {near}");
}

#[test]
fn bounded_steps_never_tunnel() {
    // Two wavy sheets are thrown at and through each other, with steps of many gaps, again and again.
    for seed in 0..4 {
        let mut random = Random(seed);
        let (faces, mut positions) = two_sheets(6, 0.3, &mut random);
        let surface = Surface::new(&faces, &positions);
        let rest = positions.clone();
        let (mut list, mut found, mut allowances) = (PairList::default(), Vec::new(), Vec::new());
        for _ in 0..20 {
            let mut step: Vec<Vec3> = positions
                .iter()
                .map(|x| Vec3::new(0.0, 0.0, if x.z > 0.0 { -1.0 } else { 1.0 }) + random.vector() * 0.5)
                .collect();
            let place = Place {
                surface: &surface,
                rest_mm: &rest,
                positions_mm: &positions,
                thickness_mm: 0.1,
                rigid_fraction: 0.5,
                kept_fraction: 0.0,
            };
            bound_steps(&mut list, &place, &mut step, &mut found, &mut allowances);
            // Wherever each vertex stops on its way, nothing crosses.
            let partway: Vec<Vec3> = positions.iter().zip(&step).map(|(x, s)| x + s * 0.5).collect();
            assert_eq!(crossings(&surface, &partway), []);
            positions.iter_mut().zip(&step).for_each(|(x, s)| *x += s);
            assert_eq!(crossings(&surface, &positions), []);
        }
    }
}

/// Two sheets of `cells`² squares over [-1, 1]², `gap` apart, slightly rumpled.
fn two_sheets(cells: u32, gap: f64, random: &mut Random) -> (Vec<[u32; 3]>, Vec<Vec3>) {
    let (mut faces, mut positions) = (Vec::new(), Vec::new());
    for height in [-0.5 * gap, 0.5 * gap] {
        let first = positions.len() as u32;
        let row = cells + 1;
        for j in 0..row {
            for i in 0..row {
                let place = |k: u32| 2.0 * f64::from(k) / f64::from(cells) - 1.0;
                positions.push(Vec3::new(place(i), place(j), height) + random.vector() * 0.03);
            }
        }
        for j in 0..cells {
            for i in 0..cells {
                let corner = first + j * row + i;
                faces.push([corner, corner + 1, corner + row]);
                faces.push([corner + 1, corner + row + 1, corner + row]);
            }
        }
    }
    (faces, positions)
}

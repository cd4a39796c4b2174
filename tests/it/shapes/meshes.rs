//! Meshes of shapes with a known answer.

use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_3, TAU};

use coapt::Vec3;
use coapt_tests::Random;
use nalgebra::Complex;

/// A triangle mesh.
#[derive(Clone, Debug, Default)]
pub(crate) struct Mesh {
    pub(crate) points_mm: Vec<Vec3>,
    pub(crate) faces: Vec<[u32; 3]>,
    /// Vertices on the rim, where there is one.
    pub(crate) rim: Vec<u32>,
}

impl Mesh {
    /// Volume of the cone from the origin over the faces [mm³].
    pub(crate) fn volume_mm3(&self, positions_mm: &[Vec3]) -> f64 {
        let of_face = |face: &[u32; 3]| {
            let [a, b, c] = face.map(|vertex| positions_mm[vertex as usize]);
            a.dot(&b.cross(&c)) / 6.0
        };
        self.faces.iter().map(of_face).sum()
    }

    /// Area [mm²].
    pub(crate) fn area_mm2(&self, positions_mm: &[Vec3]) -> f64 {
        let of_face = |face: &[u32; 3]| {
            let [a, b, c] = face.map(|vertex| positions_mm[vertex as usize]);
            0.5 * (b - a).cross(&(c - a)).norm()
        };
        self.faces.iter().map(of_face).sum()
    }

    /// The same mesh elsewhere.
    pub(crate) fn moved(mut self, mut place: impl FnMut(Vec3) -> Vec3) -> Self {
        self.points_mm.iter_mut().for_each(|point| *point = place(*point));
        self
    }
}

/// A flat disk in z = 0, normals along +z, of 6 n² triangles: the regular hexagon of n rings of equilateral triangles,
/// carried to the disk conformally. Small triangles stay equilateral, so that edge springs are the isotropic membrane that
/// they are on a perfect lattice; only at the hexagon's six corners do angles of 120° open to 180°. Towards the rim
/// triangles become smaller. Rim vertices lie on the circle.
///
/// Schwarz and Christoffel: w(z) = ∫ (1 − t⁶)^(−1/3) dt takes the unit disk to a hexagon with corners at ±K, …; the way
/// back is dz/dw = (1 − z⁶)^(1/3), integrated from the centre along rays.
pub(crate) fn disk(rings: i32, radius_mm: f64) -> Mesh {
    let corner = hexagon_corner();
    let turn = Complex::from_polar(1.0, FRAC_PI_3);
    let mut index = BTreeMap::new();
    let mut mesh = Mesh::default();
    for r in -rings..=rings {
        for q in (-rings).max(-rings - r)..=rings.min(rings - r) {
            let vertex = mesh.points_mm.len() as u32;
            let w = (turn * f64::from(r) + f64::from(q)) * (corner / f64::from(rings));
            let mut z = from_hexagon(w);
            if q.abs().max(r.abs()).max((q + r).abs()) == rings {
                z /= z.norm();
                mesh.rim.push(vertex);
            }
            mesh.points_mm.push(Vec3::new(z.re, z.im, 0.0) * radius_mm);
            index.insert((q, r), vertex);
        }
    }
    for &(q, r) in index.keys() {
        let at = |q, r| index.get(&(q, r)).copied();
        for corners in [
            [at(q, r), at(q + 1, r), at(q, r + 1)],
            [at(q, r), at(q, r + 1), at(q - 1, r + 1)],
        ] {
            if let [Some(a), Some(b), Some(c)] = corners {
                mesh.faces.push([a, b, c]);
            }
        }
    }
    mesh
}

/// K = ∫₀¹ (1 − t⁶)^(−1/3) dt by the midpoint rule in s, 1 − t = s^(3/2), which takes the pole out.
fn hexagon_corner() -> f64 {
    const STEPS: u32 = 2000;
    let at = |i: u32| {
        let s = (f64::from(i) + 0.5) / f64::from(STEPS);
        1.5 * s.sqrt() / (1.0 - (1.0 - s.powf(1.5)).powi(6)).cbrt()
    };
    (0..STEPS).map(at).sum::<f64>() / f64::from(STEPS)
}

fn from_hexagon(w: Complex<f64>) -> Complex<f64> {
    const STEPS: u32 = 60;
    let step = w / f64::from(STEPS);
    let slope = |z: Complex<f64>| (Complex::new(1.0, 0.0) - z.powi(6)).powf(1.0 / 3.0) * step;
    let mut z = Complex::new(0.0, 0.0);
    for _ in 0..STEPS {
        let a = slope(z);
        let b = slope(z + a * 0.5);
        let c = slope(z + b * 0.5);
        z += (a + b * 2.0 + c * 2.0 + slope(z + c)) / 6.0;
    }
    z
}

/// The cap of a sphere around the origin, out to a polar angle from +z, normals outwards: a [`disk`] carried over by
/// stereographic projection, which is conformal as well. Its rim is a circle.
pub(crate) fn cap(rings: i32, radius_mm: f64, polar_angle: f64) -> Mesh {
    disk(rings, (0.5 * polar_angle).tan()).moved(|point| {
        let squared = point.norm_squared();
        Vec3::new(2.0 * point.x, 2.0 * point.y, 1.0 - squared) * (radius_mm / (1.0 + squared))
    })
}

/// A geodesic sphere around the origin of 20 n² triangles, normals outwards: the faces of an icosahedron cut into n² each
/// and blown up.
pub(crate) fn sphere(n: i32, radius_mm: f64) -> Mesh {
    let (corners, icosahedron) = icosahedron();
    let mut index = BTreeMap::new();
    let mut mesh = Mesh::default();
    for face in icosahedron {
        let mut vertex = |i: i32, j: i32| {
            let weights = [n - i - j, i, j];
            // A point is known by its share of the corners, whichever face it is seen from.
            let mut key: Vec<(usize, i32)> = face
                .into_iter()
                .zip(weights)
                .filter(|&(_, share)| share > 0)
                .collect();
            key.sort_unstable();
            let point: Vec3 = key
                .iter()
                .map(|&(corner, share)| corners[corner] * f64::from(share))
                .sum();
            *index.entry(key).or_insert_with(|| {
                mesh.points_mm.push(point.normalize() * radius_mm);
                mesh.points_mm.len() as u32 - 1
            })
        };
        let mut found = Vec::new();
        for i in 0..n {
            for j in 0..n - i {
                found.push([vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)]);
                if i + j < n - 1 {
                    found.push([vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
                }
            }
        }
        mesh.faces.extend(found);
    }
    mesh
}

/// Corners, and faces seen from outside counter-clockwise.
fn icosahedron() -> (Vec<Vec3>, Vec<[usize; 3]>) {
    let g = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut corners = Vec::new();
    for (a, b) in [(1.0, g), (1.0, -g), (-1.0, g), (-1.0, -g)] {
        corners.extend([Vec3::new(0.0, a, b), Vec3::new(a, b, 0.0), Vec3::new(b, 0.0, a)]);
    }
    let next = |a: usize, b: usize| ((corners[a] - corners[b]).norm() - 2.0).abs() < 1e-9;
    let mut faces = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if next(a, b) && next(b, c) && next(a, c) {
                    let outwards = corners[a].dot(&corners[b].cross(&corners[c])) > 0.0;
                    faces.push(if outwards { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    (corners, faces)
}

/// A flat lattice of equilateral triangles of edge 1 mm, n × n pairs of them, inner vertices moved by up to `jitter_mm` in
/// each direction of the plane. The rim is everything that was not moved.
pub(crate) fn lattice(n: u32, jitter_mm: f64, random: &mut Random) -> Mesh {
    let mut mesh = Mesh::default();
    for row in 0..=n {
        for column in 0..=n {
            let x = f64::from(column) + 0.5 * f64::from(row % 2);
            let mut point = Vec3::new(x, f64::from(row) * 0.75_f64.sqrt(), 0.0);
            if row > 0 && row < n && column > 0 && column < n {
                point += Vec3::new(random.signed(), random.signed(), 0.0) * jitter_mm;
            } else {
                mesh.rim.push(row * (n + 1) + column);
            }
            mesh.points_mm.push(point);
        }
    }
    for row in 0..n {
        for column in 0..n {
            let a = row * (n + 1) + column;
            let (b, d) = (a + 1, a + n + 1);
            let e = d + 1;
            mesh.faces.extend(if row % 2 == 0 {
                [[a, b, d], [b, e, d]]
            } else {
                [[a, b, e], [a, e, d]]
            });
        }
    }
    mesh
}

/// A closed bag of two flat disks in z = 0 that share their rim, of meridians and parallels: what is inextensible along the
/// meridians is so on this mesh. The first vertex is the lower pole, the last the upper one, the rim is listed.
pub(crate) fn bag(rings: u32, sectors: u32, radius_mm: f64) -> Mesh {
    let on = |ring: u32, sector: u32| 1 + (ring - 1) * sectors + sector % sectors;
    let mut mesh = Mesh::default();
    mesh.points_mm.push(Vec3::zeros());
    // Out from the lower pole to the rim, and in again on the upper side.
    for ring in 1..2 * rings {
        let radius = radius_mm * f64::from(ring.min(2 * rings - ring)) / f64::from(rings);
        mesh.points_mm.extend((0..sectors).map(|sector| {
            let (sin, cos) = (TAU * f64::from(sector) / f64::from(sectors)).sin_cos();
            Vec3::new(radius * cos, radius * sin, 0.0)
        }));
    }
    let upper = mesh.points_mm.len() as u32;
    mesh.points_mm.push(Vec3::zeros());
    mesh.rim = (0..sectors).map(|sector| on(rings, sector)).collect();
    for sector in 0..sectors {
        mesh.faces.push([0, on(1, sector + 1), on(1, sector)]);
        for ring in 1..2 * rings - 1 {
            let (a, b) = (on(ring, sector), on(ring, sector + 1));
            let (c, d) = (on(ring + 1, sector), on(ring + 1, sector + 1));
            mesh.faces.extend([[a, b, d], [a, d, c]]);
        }
        mesh.faces
            .push([upper, on(2 * rings - 1, sector), on(2 * rings - 1, sector + 1)]);
    }
    mesh
}

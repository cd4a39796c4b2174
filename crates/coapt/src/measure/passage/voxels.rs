//! The space around a valve in cubes.

use super::super::distance::point_triangle;
use crate::Vec3;

/// Edge of a cube, in the distance from the middle of the tissue to its surface [1], our choice. Walls two edges thick let no way
/// through from face to face of cubes; above 1.15 (2/√3) of a reach they would. The passages of twelve valves (presets, and `flail` with
/// neochordae) at four meshes differ by 2 mm² at most between 0.6 and 1, at a fifth of the cubes.
const EDGE_PART: f64 = 1.0;
/// Cubes at most, some 20 MB while they are searched: where thin leaflets would need more, tissue is as thick as larger cubes need.
const MOST: usize = 1 << 21;
/// Layers of free cubes above and below the leaflets, the walled outermost one among them.
const LAYERS: f64 = 4.5;

/// Cubes in rows along x, then y, then z: towards the atrium.
pub(super) struct Voxels {
    /// Cubes along each axis.
    pub(super) counts: [usize; 3],
    /// Edge of a cube [mm].
    pub(super) edge_mm: f64,
    /// Whether each is free of tissue, shape `[cube]`. The outermost are not, so that neighbours of a free cube always exist.
    pub(super) free: Vec<bool>,
}

impl Voxels {
    /// How far neighbours along each axis are apart in the list.
    pub(super) fn strides(&self) -> [usize; 3] {
        [1, self.counts[0], self.counts[0] * self.counts[1]]
    }

    /// The cubes that share a face with a free one.
    pub(super) fn neighbours(&self, cube: usize) -> [usize; 6] {
        let [x, y, z] = self.strides();
        [cube - z, cube - y, cube - x, cube + x, cube + y, cube + z]
    }

    /// The cubes of the lowest layer, in the ventricle.
    pub(super) fn bottom(&self) -> std::ops::Range<usize> {
        let layer = self.strides()[2];
        layer..2 * layer
    }

    /// The cubes of the highest layer, in the atrium.
    pub(super) fn top(&self) -> std::ops::Range<usize> {
        let layer = self.strides()[2];
        self.free.len() - 2 * layer..self.free.len() - layer
    }
}

/// The cubes around leaflets, given by the corners of their triangles, whose surfaces are so far from their middle; the annulus, a
/// closed curve, goes on outwards as a wall. All [mm], with z towards the atrium. Nothing where there are no leaflets.
pub(super) fn walled(leaflets: &[[Vec3; 3]], annulus: &[Vec3], reach_mm: f64) -> Option<Voxels> {
    let corners = || leaflets.iter().flatten();
    let first = *corners().next()?;
    let low = corners().fold(first, |low, p| low.inf(p));
    let high = corners().fold(first, |high, p| high.sup(p));
    let mut edge_mm = EDGE_PART * reach_mm;
    let counts_of = |edge_mm: f64| -> [usize; 3] {
        let margin = 1.0 / EDGE_PART + LAYERS;
        std::array::from_fn(|k| ((high[k] - low[k]) / edge_mm + 2.0 * margin).ceil() as usize)
    };
    while counts_of(edge_mm).iter().product::<usize>() > MOST {
        edge_mm *= 1.1;
    }
    let counts = counts_of(edge_mm);
    let size = Vec3::from(counts.map(|count| count as f64 * edge_mm));
    let mut walls = Walls {
        corner: (low + high - size) * 0.5,
        reach_mm: edge_mm / EDGE_PART,
        voxels: Voxels {
            counts,
            edge_mm,
            free: inside(counts),
        },
    };
    for corners in leaflets {
        walls.build(*corners);
    }
    let middle = annulus.iter().sum::<Vec3>() / annulus.len().max(1) as f64;
    let outwards = |p: Vec3| {
        let way = Vec3::new(p.x - middle.x, p.y - middle.y, 0.0);
        p + way * (size.norm() / way.norm().max(edge_mm))
    };
    for (i, &a) in annulus.iter().enumerate() {
        let b = annulus[(i + 1) % annulus.len()];
        walls.build([a, b, outwards(b)]);
        walls.build([a, outwards(b), outwards(a)]);
    }
    Some(walls.voxels)
}

/// All cubes but the outermost.
fn inside([nx, ny, nz]: [usize; 3]) -> Vec<bool> {
    let mut free = vec![false; nx * ny * nz];
    for z in 1..nz - 1 {
        for y in 1..ny - 1 {
            let row = (y + z * ny) * nx;
            free[row + 1..row + nx - 1].fill(true);
        }
    }
    free
}

struct Walls {
    voxels: Voxels,
    /// The lowest corner of all [mm].
    corner: Vec3,
    reach_mm: f64,
}

impl Walls {
    /// Walls the cubes whose middle is within reach of a triangle.
    fn build(&mut self, corners: [Vec3; 3]) {
        let [a, b, c] = corners;
        let Self {
            voxels,
            corner,
            reach_mm,
        } = self;
        let (edge_mm, reach_mm) = (voxels.edge_mm, *reach_mm);
        let low = (a.inf(&b).inf(&c).add_scalar(-reach_mm) - *corner) / edge_mm;
        let high = (a.sup(&b).sup(&c).add_scalar(reach_mm) - *corner) / edge_mm;
        let [xs, ys, zs] = std::array::from_fn(|axis| {
            let count = voxels.counts[axis] as f64;
            low[axis].floor().clamp(0.0, count) as usize..high[axis].ceil().clamp(0.0, count) as usize
        });
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default();
        let [_, row, layer] = voxels.strides();
        for z in zs {
            for y in ys.clone() {
                let start = y * row + z * layer;
                let middle = Vec3::new(0.5, y as f64 + 0.5, z as f64 + 0.5) * edge_mm + *corner;
                for x in xs.clone() {
                    let p = middle + Vec3::new(x as f64 * edge_mm, 0.0, 0.0);
                    // Most are far from the plane of the triangle, or walled by another.
                    if normal.dot(&(p - a)).abs() < reach_mm
                        && voxels.free[start + x]
                        && point_triangle(p, corners) < reach_mm
                    {
                        voxels.free[start + x] = false;
                    }
                }
            }
        }
    }
}

//! The smallest surface that parts two sides.
//!
//! The area of a set's border is the total variation of its indicator u, and the least total variation of any u from 0 to 1 with
//! given values on both sides is that of a set (Chan, Esedoglu & Nikolova 2006): a convex problem, whatever the shape of the walls.
//! It is solved by the primal-dual iteration of Chambolle & Pock (2011) in a band about the throat, which is moved to where the
//! surface lies until that is inside.

use super::throat::Side;
use super::voxels::Voxels;

/// Cubes on either side of the throat in which the surface is sought, our choice: with 5 areas of twelve valves are within 0.9 mm².
const BAND: usize = 4;
/// The band is moved so often at most, our choice.
const MOVES: usize = 12;
/// Iterations to see where the surface goes, and to measure it: twice as many of the first change areas of twelve valves by 0.1 mm² at
/// most; without bands, six times 250 changed none of four by more than 0.2 mm².
const ITERATIONS: usize = 60;
const LAST_ITERATIONS: usize = 120;
/// A passage of fewer faces of cubes is none: whether single cubes are free is chance. Our choice, 1 mm² by default.
const LEAST_FACES: f64 = 3.0;
/// Both steps of the iteration [1]: 1/√12, twelve being the largest square of the norm of the differences.
const STEP: f32 = 0.288_675;
/// No cube of the band.
const NONE: u32 = u32::MAX;

/// Area of the smallest surface near the border of both sides [mm²].
pub(super) fn minimal_cut_mm2(voxels: &Voxels, mut sides: Vec<Side>) -> f64 {
    let mut band = Band::around(voxels, &sides);
    for _ in 0..MOVES {
        band.minimise(ITERATIONS);
        if !band.part(&mut sides) {
            break;
        }
        band = Band::around(voxels, &sides);
    }
    band.minimise(LAST_ITERATIONS);
    let faces = band.variation();
    match faces < LEAST_FACES {
        true => 0.0,
        false => faces * voxels.edge_mm * voxels.edge_mm,
    }
}

/// The free cubes near a throat. Where a cube has no neighbour in it, differences are zero: walls and what lies beyond pull at
/// nothing.
struct Band {
    /// Their numbers; from `inner` on they keep the value of their side.
    cubes: Vec<u32>,
    inner: usize,
    /// The cube of the band that is next along each axis, else the cube itself, shape `[cube][axis]`.
    next: Vec<[u32; 3]>,
    /// The last one, else one more than there are.
    last: Vec<[u32; 3]>,
    /// u: one on the atrium's side, zero on the ventricle's, shape `[cube]`.
    value: Vec<f32>,
    /// The dual variable, shape `[cube][axis]`, and zeros for no cube.
    flow: Vec<[f32; 3]>,
}

impl Band {
    fn around(voxels: &Voxels, sides: &[Side]) -> Self {
        let strides = voxels.strides();
        let mut is_found = vec![false; sides.len()];
        for (cube, &side) in sides.iter().enumerate().filter(|(_, side)| **side != Side::None) {
            for other in strides.map(|stride| cube + stride) {
                if sides[other] != side && sides[other] != Side::None {
                    is_found[cube] = true;
                    is_found[other] = true;
                }
            }
        }
        let mut found: Vec<u32> = (0..sides.len() as u32)
            .filter(|&cube| is_found[cube as usize])
            .collect();
        let mut last_ring = 0;
        for _ in 0..BAND {
            let end = found.len();
            for place in last_ring..end {
                for next in voxels.neighbours(found[place] as usize) {
                    if sides[next] != Side::None && !std::mem::replace(&mut is_found[next], true) {
                        found.push(next as u32);
                    }
                }
            }
            last_ring = end;
        }
        // The ends of the space are what they are.
        let ends = [voxels.bottom(), voxels.top()];
        let is_end = |cube: &u32| ends.iter().any(|end| end.contains(&(*cube as usize)));
        let (mut cubes, kept): (Vec<u32>, Vec<u32>) =
            found.drain(..last_ring).partition(|cube| !is_end(cube));
        let inner = cubes.len();
        cubes.extend(kept);
        cubes.append(&mut found);
        let mut places = vec![NONE; sides.len()];
        for (place, &cube) in cubes.iter().enumerate() {
            places[cube as usize] = place as u32;
        }
        let along = |way: &dyn Fn(usize, usize) -> usize, none: &dyn Fn(usize) -> usize| {
            let of_cube = |(place, &cube): (usize, &u32)| {
                strides.map(|stride| match places[way(cube as usize, stride)] {
                    NONE => none(place) as u32,
                    other => other,
                })
            };
            cubes.iter().enumerate().map(of_cube).collect()
        };
        let value = |&cube: &u32| match sides[cube as usize] {
            Side::Atrium => 1.0,
            _ => 0.0,
        };
        Self {
            next: along(&|cube, stride| cube + stride, &|place| place),
            last: along(&|cube, stride| cube - stride, &|_| cubes.len()),
            value: cubes.iter().map(value).collect(),
            flow: vec![[0.0; 3]; cubes.len() + 1],
            inner,
            cubes,
        }
    }

    fn minimise(&mut self, iterations: usize) {
        let mut ahead = self.value.clone();
        for _ in 0..iterations {
            for (place, next) in self.next.iter().enumerate() {
                let flow = &mut self.flow[place];
                for axis in 0..3 {
                    flow[axis] += STEP * (ahead[next[axis] as usize] - ahead[place]);
                }
                let longer = (flow[0] * flow[0] + flow[1] * flow[1] + flow[2] * flow[2])
                    .sqrt()
                    .max(1.0);
                *flow = flow.map(|part| part / longer);
            }
            for (place, last) in self.last[..self.inner].iter().enumerate() {
                let out = self.flow[place];
                let into: [f32; 3] = std::array::from_fn(|axis| self.flow[last[axis] as usize][axis]);
                let divergence = out[0] - into[0] + out[1] - into[1] + out[2] - into[2];
                let before = self.value[place];
                let value = (before + STEP * divergence).clamp(0.0, 1.0);
                self.value[place] = value;
                ahead[place] = 2.0 * value - before;
            }
        }
    }

    /// Puts each cube of the band on the side that it is more of; whether any next to those that keep theirs has changed.
    fn part(&self, sides: &mut [Side]) -> bool {
        let is_kept = |place: u32| (self.inner..self.cubes.len()).contains(&(place as usize));
        let mut has_come_near = false;
        for place in 0..self.inner {
            let cube = self.cubes[place] as usize;
            let side = match self.value[place] > 0.5 {
                true => Side::Atrium,
                false => Side::Ventricle,
            };
            if side != sides[cube] {
                sides[cube] = side;
                let mut around = self.next[place].into_iter().chain(self.last[place]);
                has_come_near |= around.any(is_kept);
            }
        }
        has_come_near
    }

    /// Total variation [faces of cubes].
    fn variation(&self) -> f64 {
        let of_cube = |(place, next): (usize, &[u32; 3])| {
            let changes = next.map(|next| f64::from(self.value[next as usize] - self.value[place]));
            changes.iter().map(|change| change * change).sum::<f64>().sqrt()
        };
        self.next.iter().enumerate().map(of_cube).sum()
    }
}

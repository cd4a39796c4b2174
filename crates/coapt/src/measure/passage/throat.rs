//! Whether there is a way from the atrium to the ventricle, and where about it is narrowest.

use std::collections::VecDeque;

use super::voxels::Voxels;

/// Which side of the throat a cube lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// Neither: walled, or reached from nowhere.
    None,
    /// Nearer to the atrium.
    Atrium,
    /// Nearer to the ventricle.
    Ventricle,
}

/// The sides of all cubes, shape `[cube]`; nothing where no way leads from the top to the bottom.
///
/// Both sides grow at once, always by the cube farthest from all walls that either borders on (a watershed of the distance to the
/// walls): they meet where the passage is narrowest.
pub(super) fn throat(voxels: &Voxels) -> Option<Vec<Side>> {
    if !leads_through(voxels) {
        return None;
    }
    let depth = depths(voxels);
    let deepest = depth.iter().copied().max().unwrap_or(0);
    let mut sides = vec![Side::None; depth.len()];
    let mut fronts = vec![VecDeque::new(); deepest as usize + 1];
    for (range, side) in [(voxels.top(), Side::Atrium), (voxels.bottom(), Side::Ventricle)] {
        for cube in range.filter(|&cube| voxels.free[cube]) {
            sides[cube] = side;
            fronts[depth[cube] as usize].push_back(cube as u32);
        }
    }
    let mut level = fronts.len();
    while level > 0 {
        let Some(cube) = fronts[level - 1].pop_front() else {
            level -= 1;
            continue;
        };
        for next in voxels.neighbours(cube as usize) {
            if depth[next] > 0 && sides[next] == Side::None {
                sides[next] = sides[cube as usize];
                fronts[depth[next] as usize].push_back(next as u32);
                level = level.max(depth[next] as usize + 1);
            }
        }
    }
    Some(sides)
}

/// Whether the bottom can be reached from the top.
fn leads_through(voxels: &Voxels) -> bool {
    let mut unseen = voxels.free.clone();
    let mut front: Vec<u32> = Vec::new();
    for cube in voxels.top().filter(|&cube| voxels.free[cube]) {
        unseen[cube] = false;
        front.push(cube as u32);
    }
    let bottom = voxels.bottom();
    while let Some(cube) = front.pop() {
        for next in voxels.neighbours(cube as usize) {
            if std::mem::replace(&mut unseen[next], false) {
                if bottom.contains(&next) {
                    return true;
                }
                front.push(next as u32);
            }
        }
    }
    false
}

/// How many steps from cube to cube each is from tissue or the sides of the space, zero for those. Above the highest and below the
/// lowest layer space goes on.
fn depths(voxels: &Voxels) -> Vec<u16> {
    let layers = voxels.bottom().start..voxels.top().end;
    let depth_of = |(cube, &free): (usize, &bool)| match free || !layers.contains(&cube) {
        true => u16::MAX,
        false => 0,
    };
    let mut depth: Vec<u16> = voxels.free.iter().enumerate().map(depth_of).collect();
    let strides = voxels.strides();
    for cube in layers.clone() {
        let nearest = strides.iter().map(|stride| depth[cube - stride]).min();
        depth[cube] = depth[cube].min(nearest.unwrap_or(0).saturating_add(1));
    }
    for cube in layers.rev() {
        let nearest = strides.iter().map(|stride| depth[cube + stride]).min();
        depth[cube] = depth[cube].min(nearest.unwrap_or(0).saturating_add(1));
    }
    for (depth, &free) in depth.iter_mut().zip(&voxels.free) {
        *depth *= u16::from(free);
    }
    depth
}

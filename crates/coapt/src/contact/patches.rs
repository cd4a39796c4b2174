//! What lies side by side, in patches of eight.

use crate::Vec3;

/// Members of a patch: as many single-precision numbers as an AVX register holds.
pub const LANES: usize = 8;
/// In place of a member, in a patch that has fewer.
pub const NOBODY: u32 = u32::MAX;

/// Things in patches of neighbours, each in one patch. How near those of a patch lie decides how much time patches save, and nothing
/// else.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Patches {
    /// The members of each patch; [`NOBODY`] after the last one.
    pub members: Vec<[u32; LANES]>,
}

impl Patches {
    /// Halves what lies at some places [mm] across its longest side, and again, until no part has more than a patch holds.
    pub fn new(places_mm: &[Vec3]) -> Self {
        let mut patches = Self {
            members: Vec::with_capacity(places_mm.len().div_ceil(LANES)),
        };
        let mut all: Vec<u32> = (0..places_mm.len() as u32).collect();
        patches.divide(places_mm, &mut all);
        patches
    }

    fn divide(&mut self, places_mm: &[Vec3], part: &mut [u32]) {
        if part.len() <= LANES {
            if !part.is_empty() {
                let mut members = [NOBODY; LANES];
                members[..part.len()].copy_from_slice(part);
                self.members.push(members);
            }
            return;
        }
        let at = |member: u32| places_mm[member as usize];
        let (mut low, mut high) = (at(part[0]), at(part[0]));
        for &member in &*part {
            (low, high) = (low.inf(&at(member)), high.sup(&at(member)));
        }
        let axis = (high - low).imax();
        // Only the last patch is not full.
        let middle = (part.len() / 2).next_multiple_of(LANES);
        part.select_nth_unstable_by(middle, |&a, &b| {
            at(a)[axis].total_cmp(&at(b)[axis]).then(a.cmp(&b))
        });
        let (first, second) = part.split_at_mut(middle);
        self.divide(places_mm, first);
        self.divide(places_mm, second);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_numbers::Numbers;

    /// Everything is in one patch, no patch but the last has room left, and of places spread over a square those of a patch lie within a
    /// few times the side of the square that is theirs on average.
    #[test]
    fn everything_is_in_one_patch_with_its_neighbours() {
        for count in [0, 1, 7, 8, 9, 15, 16, 17, 100, 1000] {
            let places = Numbers(5).vectors(count).into_iter();
            let places: Vec<Vec3> = places.map(|place| Vec3::new(place.x, place.y, 0.0)).collect();
            let patches = Patches::new(&places);
            assert_eq!(patches.members.len(), count.div_ceil(LANES));
            let members = patches.members.as_flattened();
            let mut sorted: Vec<u32> = members[..count].to_vec();
            sorted.sort_unstable();
            assert_eq!(sorted, (0..count as u32).collect::<Vec<u32>>());
            assert!(members[count..].iter().all(|&member| member == NOBODY));
            let side = |members: &[u32; LANES]| {
                let of_patch = members.iter().filter(|&&member| member != NOBODY);
                let (low, high) = of_patch.map(|&member| places[member as usize]).fold(
                    (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)),
                    |(low, high), place| (low.inf(&place), high.sup(&place)),
                );
                (high - low).max()
            };
            let mean_side = 2.0 * (LANES as f64 / count.max(1) as f64).sqrt();
            assert!(
                patches
                    .members
                    .iter()
                    .all(|members| side(members) < 2.5 * mean_side),
                "{count}"
            );
        }
    }
}

//! A list of pairs that holds for more than one step.

use super::gather::may_touch;
use super::pairs::{Pair, Parts, Place, approach_squared_mm2, nearest_at, unseen};
use crate::Vec3;

/// Pairs, and how the vertices have moved since they were listed.
///
/// Each pair has its slack: how much nearer its parts must have come before they touch. As long as they have not, nobody
/// looks at them; so contact costs next to nothing while the parts are apart.
#[derive(Clone, Debug, Default)]
pub(super) struct Listing {
    listed: Vec<Listed>,
    listed_at_mm: Vec<Vec3>,
    /// How far vertices (ends of edges against each other) may move before the list must be made anew [mm].
    pub(super) budget_mm: f64,
    /// Motion of the vertices since then, at the beginning and at the end of a step [mm].
    start_mm: Vec<Vec3>,
    end_mm: Vec<Vec3>,
}

#[derive(Clone, Copy, Debug)]
struct Listed {
    pair: Pair,
    /// The face of each part.
    faces: [u32; 2],
    /// Distance less activation distance when listed [mm].
    slack_mm: f64,
}

impl Listing {
    pub(super) fn begin(&mut self, positions_mm: &[Vec3], budget_mm: f64) {
        self.listed.clear();
        self.budget_mm = budget_mm;
        self.listed_at_mm.clear();
        self.listed_at_mm.extend_from_slice(positions_mm);
    }

    /// Says that the list holds for no step any more.
    pub(super) fn end(&mut self) {
        self.listed_at_mm.clear();
    }

    /// Lists a pair if it has no more than some slack. Where neighbours at rest begin to touch is found when they are first
    /// looked at; until then it counts as the farthest that they may.
    #[inline]
    pub(super) fn list(&mut self, place: &Place, parts: &Parts, most_mm: f64) {
        let (pair, activation_mm) = match place.are_near_at_rest(parts.faces) {
            true => (unseen(parts), place.longest_of_neighbours_mm()),
            false => (place.pair_of_strangers(parts), place.thickness_mm),
        };
        let limit_mm = activation_mm + most_mm;
        let squared = nearest_at(parts.kind, &parts.vertices, place.positions_mm)
            .separation_mm
            .norm_squared();
        if squared <= limit_mm * limit_mm {
            let slack_mm = squared.sqrt() - activation_mm;
            self.listed.push(Listed {
                pair,
                faces: parts.faces,
                slack_mm,
            });
        }
    }

    /// Notes how the vertices have moved since the pairs were listed, at the beginning and at the end of a step;
    /// returns the larger of both by some measure [mm], infinite if there is no list.
    pub(super) fn follow(
        &mut self,
        place: &Place,
        step_mm: &[Vec3],
        mut measure_mm: impl FnMut(&[Vec3]) -> f64,
    ) -> f64 {
        if self.listed_at_mm.len() != place.positions_mm.len() {
            return f64::INFINITY;
        }
        let moved = place.positions_mm.iter().zip(&self.listed_at_mm);
        self.start_mm.clear();
        self.start_mm.extend(moved.map(|(here, then)| here - then));
        self.end_mm.clear();
        let ends = self.start_mm.iter().zip(step_mm);
        self.end_mm.extend(ends.map(|(start, step)| start + step));
        measure_mm(&self.start_mm).max(measure_mm(&self.end_mm))
    }

    /// Gathers the pairs that may touch during the step followed last, given how much nearer parts of two faces may have come [mm].
    pub(super) fn gather(
        &mut self,
        place: &Place,
        step_mm: &[Vec3],
        most_mm: impl Fn([u32; 2]) -> f64,
        found: &mut Vec<Pair>,
    ) {
        let near = self
            .listed
            .iter_mut()
            .filter(|listed| listed.slack_mm <= most_mm(listed.faces));
        for Listed {
            pair,
            faces,
            slack_mm,
        } in near
        {
            let is_bridged = |motion_mm: &[Vec3]| {
                approach_squared_mm2(pair.kind, &pair.vertices, motion_mm) >= *slack_mm * *slack_mm
            };
            if *slack_mm <= 0.0 || is_bridged(&self.end_mm) || is_bridged(&self.start_mm) {
                if pair.activation_mm == 0.0 {
                    *pair = place.pair_at_rest(&Parts {
                        kind: pair.kind,
                        vertices: pair.vertices,
                        area_mm2: pair.area_mm2,
                        faces: *faces,
                    });
                    *slack_mm += place.longest_of_neighbours_mm() - pair.activation_mm;
                }
                if may_touch(pair, place.positions_mm, step_mm) {
                    found.push(*pair);
                }
            }
        }
    }
}

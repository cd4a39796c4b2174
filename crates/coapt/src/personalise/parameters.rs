//! Which factors are free.

use crate::model::{ChordGroup, ChordKind};

/// Each parameter of a fit is the factor of one group of chordae or of all.
pub(super) struct Parameters {
    /// The parameter of each group; none for what a surgeon put in, whose length is known.
    pub(super) of_group: Vec<Option<usize>>,
    /// How many there are.
    pub(super) count: usize,
}

/// Factors that differ by less are the same [1].
const ROUNDING: f64 = 1e-9;

impl Parameters {
    /// One for each group, or one for all.
    pub(super) fn new(groups: &[ChordGroup], per_group: bool) -> Self {
        let mut count = 0;
        let of_group = groups.iter().map(|group| {
            let parameter = if per_group { count } else { 0 };
            let is_native = group.kind == ChordKind::Chorda;
            count += usize::from(is_native);
            is_native.then_some(parameter)
        });
        Self {
            of_group: of_group.collect(),
            count: if per_group { count } else { 1 },
        }
    }

    /// The factors of the groups after a step of the parameters, within a range.
    pub(super) fn moved(&self, scale: &[f64], step: &[f64], [least, most]: [f64; 2]) -> Vec<f64> {
        let pairs = scale.iter().zip(&self.of_group);
        let moved = pairs.map(|(factor, &parameter)| match parameter {
            Some(parameter) => (factor + step[parameter]).clamp(least, most),
            None => *factor,
        });
        moved.collect()
    }

    /// The same for a step of one parameter, without a range.
    pub(super) fn one_moved(&self, scale: &[f64], parameter: usize, by: f64) -> Vec<f64> {
        let mut step = vec![0.0; self.count];
        step[parameter] = by;
        self.moved(scale, &step, [0.01, f64::INFINITY])
    }

    /// Each parameter moved by a radius down and up, as far as the range goes.
    pub(super) fn around(&self, scale: &[f64], radius: f64, [least, most]: [f64; 2]) -> Vec<Vec<f64>> {
        let both = |parameter| [-radius, radius].map(|by| self.one_moved(scale, parameter, by));
        let all = (0..self.count).flat_map(both);
        let within = |moved: &Vec<f64>| moved.iter().all(|factor| (least..=most).contains(factor));
        all.filter(within).collect()
    }

    /// The value of a parameter.
    pub(super) fn value(&self, parameter: usize, scale: &[f64]) -> f64 {
        let group = self.of_group.iter().position(|&p| p == Some(parameter));
        group.map_or(1.0, |group| scale[group])
    }

    /// The step of the parameters that leads from one set of factors to another; nothing where none does.
    pub(super) fn offsets(&self, from: &[f64], to: &[f64]) -> Option<Vec<f64>> {
        let offset = |parameter| self.value(parameter, to) - self.value(parameter, from);
        let offsets: Vec<f64> = (0..self.count).map(offset).collect();
        let reached = self.moved(from, &offsets, [f64::NEG_INFINITY, f64::INFINITY]);
        let same = reached.iter().zip(to).all(|(a, b)| (a - b).abs() < ROUNDING);
        same.then_some(offsets)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of native chordae, a clip's sutures and native chordae again, the middle group has no parameter and keeps its factor.
    #[test]
    fn what_a_surgeon_put_in_is_not_fitted() {
        let suture = ChordGroup {
            name: "clip".into(),
            kind: ChordKind::Suture,
        };
        let groups = [
            ChordGroup::chordae("marginal"),
            suture,
            ChordGroup::chordae("strut"),
        ];
        let for_all = Parameters::new(&groups, false);
        assert_eq!(
            (for_all.count, for_all.one_moved(&[1.0; 3], 0, 0.25)),
            (1, vec![1.25, 1.0, 1.25])
        );
        let each = Parameters::new(&groups, true);
        assert_eq!(each.of_group, [Some(0), None, Some(1)]);
        assert_eq!(
            (each.count, each.one_moved(&[1.0; 3], 1, 0.25)),
            (2, vec![1.0, 1.0, 1.25])
        );
        assert_eq!(each.value(1, &[1.0, 7.0, 1.25]), 1.25);
    }
}

//! Which points lie near a place: points sorted into cubes as wide as the reach.

use std::collections::BTreeMap;

use crate::Vec3;

/// Points in cubic cells.
#[derive(Clone, Debug)]
pub struct PointGrid {
    cell_mm: f64,
    reach_mm: f64,
    cells: BTreeMap<[i64; 3], Vec<(u32, Vec3)>>,
}

impl PointGrid {
    /// An empty grid for questions up to `reach_mm`.
    pub fn new(reach_mm: f64) -> Self {
        Self {
            // A reach of zero still needs a cell: a nanometre.
            cell_mm: reach_mm.max(1e-6),
            reach_mm,
            cells: BTreeMap::new(),
        }
    }

    /// Adds a point under a number.
    pub fn insert(&mut self, number: u32, point: Vec3) {
        self.cells
            .entry(self.cell(point))
            .or_default()
            .push((number, point));
    }

    /// The points within reach (inclusive), with their distances [mm], in ascending order of number.
    pub fn within(&self, point: Vec3) -> Vec<(u32, f64)> {
        let [x, y, z] = self.cell(point);
        let mut found = Vec::new();
        for i in [x.saturating_sub(1), x, x.saturating_add(1)] {
            for j in [y.saturating_sub(1), y, y.saturating_add(1)] {
                let from = [i, j, z.saturating_sub(1)];
                for (_, members) in self.cells.range(from..=[i, j, z.saturating_add(1)]) {
                    let near = members.iter().map(|&(n, p)| (n, (p - point).norm()));
                    found.extend(near.filter(|&(_, distance)| distance <= self.reach_mm));
                }
            }
        }
        found.sort_unstable_by_key(|&(number, _)| number);
        found
    }

    /// The nearest point within reach and its distance [mm]; the lowest number among equals.
    pub fn nearest(&self, point: Vec3) -> Option<(u32, f64)> {
        self.within(point)
            .into_iter()
            .reduce(|best, next| if next.1 < best.1 { next } else { best })
    }

    fn cell(&self, point: Vec3) -> [i64; 3] {
        [0, 1, 2].map(|axis| (point[axis] / self.cell_mm).floor() as i64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_trying_every_point() {
        // A low-discrepancy cloud (multiples of irrational numbers) in a 4 mm cube.
        let point =
            |i: u32| Vec3::new(0.755, 0.570, 0.430).map(|a: f64| 4.0 * (a * f64::from(i)).fract() - 2.0);
        let mut grid = PointGrid::new(0.5);
        (0..400).for_each(|i| grid.insert(i, point(i)));
        for probe in 1000..1050 {
            let at = point(probe);
            let all = (0..400)
                .map(|i| (i, (point(i) - at).norm()))
                .filter(|&(_, d)| d <= 0.5);
            assert_eq!(grid.within(at), all.collect::<Vec<_>>());
        }
    }

    #[test]
    fn no_reach_finds_equal_points_only() {
        let mut grid = PointGrid::new(0.0);
        grid.insert(7, Vec3::new(1.0, 2.0, 3.0));
        assert_eq!(grid.nearest(Vec3::new(1.0, 2.0, 3.0)), Some((7, 0.0)));
        assert_eq!(grid.nearest(Vec3::new(1.0, 2.0, 3.0 + 1e-9)), None);
    }
}

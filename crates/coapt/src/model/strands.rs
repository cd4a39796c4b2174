//! Polylines of chord become single rods.
//!
//! A thread without weight that nothing touches is straight when it is taut, and carries nothing when it is slack: between
//! two branchings its inner points do not matter. Segments of one law and one cross-section in a row pull as one rod whose
//! unloaded length is the sum of theirs, exactly. What it saves are vertices, in slack polylines such without stiffness.

use std::collections::BTreeMap;

use super::attachment::Anchor;

/// A straight piece of chord between two anchors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rod {
    pub(super) ends: [Anchor; 2],
    pub(super) group: u32,
    pub(super) rest_length_mm: f64,
    pub(super) area_mm2: f64,
}

/// Joins rods that meet two by two in a chord node and are of one make; each stands where the first of its parts stood.
pub(super) fn join(rods: Vec<Rod>) -> Vec<Rod> {
    let mut rods: Vec<Option<Rod>> = rods.into_iter().map(Some).collect();
    let mut at_node: BTreeMap<Anchor, Vec<usize>> = BTreeMap::new();
    for (number, rod) in rods.iter().enumerate() {
        for end in rod.iter().flat_map(|rod| rod.ends) {
            at_node.entry(end).or_default().push(number);
        }
    }
    let nodes: Vec<Anchor> = at_node
        .keys()
        .copied()
        .filter(|end| matches!(end, Anchor::Node(_)))
        .collect();
    for node in nodes {
        let &[one, other] = at_node[&node].as_slice() else {
            continue;
        };
        let (first, second) = (one.min(other), one.max(other));
        let (Some(a), Some(b)) = (rods[first], rods[second]) else {
            continue;
        };
        if first == second || a.group != b.group || a.area_mm2 != b.area_mm2 {
            continue;
        }
        let far = other_end(&b, node);
        rods[first] = Some(Rod {
            ends: a.ends.map(|end| if end == node { far } else { end }),
            rest_length_mm: a.rest_length_mm + b.rest_length_mm,
            ..a
        });
        rods[second] = None;
        // Whoever meets the far end now meets the first rod there.
        if let Some(meeting) = at_node.get_mut(&far) {
            meeting
                .iter_mut()
                .filter(|number| **number == second)
                .for_each(|number| *number = first);
        }
    }
    rods.into_iter().flatten().collect()
}

fn other_end(rod: &Rod, node: Anchor) -> Anchor {
    if rod.ends[0] == node {
        rod.ends[1]
    } else {
        rod.ends[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rod(ends: [Anchor; 2], length: f64, area_mm2: f64) -> Rod {
        Rod {
            ends,
            group: 0,
            rest_length_mm: length,
            area_mm2,
        }
    }

    /// Tip – 0 – 1 – 2, at 2 a fork to two insertions, one of them by way of 3, where the chord grows thinner.
    #[test]
    fn rows_become_rods_and_forks_and_changes_of_make_stay() {
        use Anchor::{Leaflet, Node, Tip};
        let rods = vec![
            rod([Node(1), Node(2)], 1.0, 0.5),
            rod([Tip(0), Node(0)], 2.0, 0.5),
            rod([Node(1), Node(0)], 4.0, 0.5),
            rod([Node(2), Leaflet(0)], 8.0, 0.5),
            rod([Node(2), Node(3)], 16.0, 0.5),
            rod([Node(3), Leaflet(1)], 32.0, 0.4),
        ];
        let mut joined = join(rods.clone());
        joined[0].ends.sort_unstable();
        let expected = [rod([Tip(0), Node(2)], 7.0, 0.5), rods[3], rods[4], rods[5]];
        assert_eq!(joined, expected);
    }
}

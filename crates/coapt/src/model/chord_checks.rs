//! Chordae that cannot be: tied to nothing, to themselves, or round in a cycle. Tested with the chordae as a whole.

use super::attachment::{Anchor, Attached, Segment};
use super::faults::Faults;
use crate::Vec3;
use crate::mesh::topology::DisjointSets;

/// A segment between two tips, or on one point, cannot do anything.
pub(crate) fn refuse_short_circuits(attached: &Attached, faults: &mut Faults) {
    for segment in &attached.segments {
        match segment.ends {
            [a, b] if a == b => {
                let message =
                    "both its ends are welded to the same point: shorter than the tolerances in `weld`";
                faults.error(segment.name(), message);
            }
            [Anchor::Tip(_), Anchor::Tip(_)] => {
                faults.error(
                    segment.name(),
                    "joins two papillary tips: both its ends are prescribed",
                );
            }
            _ => {}
        }
    }
}

/// Every chord must hang on a tip, and branch without coming back to itself. Two branches that meet again in the
/// leaflet or at a tip are no cycle.
pub(crate) fn check_components(attached: &Attached, tips: &[Vec3], faults: &mut Faults) {
    let mut sets = DisjointSets::new(attached.nodes.len());
    for segment in &attached.segments {
        if let [Anchor::Node(a), Anchor::Node(b)] = segment.ends
            && !sets.join(a, b)
        {
            faults.error(segment.name(), "closes a cycle of chords; expected branches only");
        }
    }
    let mut hangs = vec![false; attached.nodes.len()];
    for segment in &attached.segments {
        if let [Anchor::Node(node), Anchor::Tip(_)] | [Anchor::Tip(_), Anchor::Node(node)] = segment.ends {
            hangs[sets.root(node) as usize] = true;
        }
    }
    let mut told = vec![false; attached.nodes.len()];
    for segment in &attached.segments {
        let hanging = match segment.ends {
            [Anchor::Node(node), _] | [_, Anchor::Node(node)] => {
                let root = sets.root(node) as usize;
                hangs[root] || std::mem::replace(&mut told[root], true)
            }
            [Anchor::Leaflet(_), Anchor::Leaflet(_)] => {
                faults.warning(segment.name(), "joins two leaflet points, with no papillary tip");
                true
            }
            _ => true,
        };
        if !hanging {
            let away = nearest_tip(attached, segment, tips);
            faults.error(
                segment.name(),
                format!("its chord is attached to no papillary tip{away}"),
            );
        }
    }
}

fn nearest_tip(attached: &Attached, segment: &Segment, tips: &[Vec3]) -> String {
    let nodes = segment.ends.iter().filter_map(|end| match end {
        Anchor::Node(node) => Some(attached.nodes[*node as usize]),
        _ => None,
    });
    let distances = nodes.flat_map(|node| tips.iter().map(move |tip| (tip - node).norm()));
    distances.reduce(f64::min).map_or(String::new(), |d| {
        format!("; the nearest tip is {d:.2} mm from this segment")
    })
}

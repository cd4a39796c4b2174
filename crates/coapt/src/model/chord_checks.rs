//! Chordae that cannot be: tied to nothing, to themselves, or round in a cycle. Tested with the chordae as a whole.

use super::attachment::{Anchor, Attached, Segment};
use super::faults::Faults;
use crate::Vec3;
use crate::mesh::topology::DisjointSets;
use crate::scene::Readable;

/// Rest lengths outside these multiples of the open end distance are doubted (hard limits of plausible slack and
/// pre-stretch; our choice). Chordae of an open valve hang slack: in the preset of Barlow up to 2.01 times.
const DOUBTFUL_SLACK: f64 = 2.5;
const DOUBTFUL_STRETCH: f64 = 0.5;
/// Below this multiple they are refused. Our choice: drawn twenty times as long no tissue holds, and a valve on such chordae
/// still comes to rest; on ones drawn a thousand times as long it runs into the limit of iterations, minutes later. There is no
/// upper limit: a chord that is far too long is slack, pulls at nothing and costs nothing.
const LEAST_REST: f64 = 0.05;

/// How long a segment is at rest, and how far apart its ends are drawn.
#[derive(Clone, Debug)]
pub(crate) struct Length {
    pub(crate) segment: String,
    pub(crate) rest_mm: f64,
    pub(crate) drawn_mm: f64,
}

/// Refuses rest lengths that no chord has, doubts those that are odd. A factor makes all of a group too short at once: the
/// refused ones are told together.
pub(crate) fn judge_lengths(lengths: &[Length], faults: &mut Faults) {
    let words = |length: &Length| {
        format!(
            "its rest length is {:.3} mm, its ends lie {:.3} mm apart",
            Readable(length.rest_mm),
            Readable(length.drawn_mm)
        )
    };
    let is_refused = |length: &&Length| {
        let Length {
            rest_mm, drawn_mm, ..
        } = **length;
        !(rest_mm.is_finite() && rest_mm > 0.0 && rest_mm >= LEAST_REST * drawn_mm)
    };
    let refused = lengths.iter().filter(is_refused);
    if let Some(first) = refused.clone().next() {
        let message = format!(
            "{}; expected at least {LEAST_REST} of that ({} such)",
            words(first),
            refused.count()
        );
        faults.error(&first.segment, message);
    }
    for length in lengths.iter().filter(|length| !is_refused(length)) {
        let Length {
            rest_mm, drawn_mm, ..
        } = *length;
        if rest_mm > DOUBTFUL_SLACK * drawn_mm || rest_mm < DOUBTFUL_STRETCH * drawn_mm {
            faults.warning(&length.segment, words(length) + "; expected about the same");
        }
    }
}

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

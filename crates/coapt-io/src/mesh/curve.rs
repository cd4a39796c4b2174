//! A curve from a file: Slicer markups, or the lines of a mesh file joined end to end.

use std::collections::BTreeMap;
use std::path::Path;

use coapt::scene::{Fault, Space};

use super::faults::{Faults, Place, Stop};
use super::{PolyData, markups, sniff};

/// A polyline in space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// Points in order [mm], shape `[point]`, in LPS; the first is not repeated where the curve closes.
    pub points_mm: Vec<[f64; 3]>,
    /// Whether the last point joins the first.
    pub closed: bool,
    /// What each point is called, shape `[point]`; empty where the file names none.
    pub labels: Vec<String>,
    /// The frame that the file was marked with; `None`: no mark, taken as LPS.
    pub space: Option<Space>,
}

/// Reads a curve; the second part are the warnings. From Slicer markups (`Curve`, `ClosedCurve`, else `Fiducial`, open)
/// the control points are taken as they stand, where Slicer draws a spline through them. From a mesh file all line
/// cells must join to one curve, in whatever order.
///
/// # Errors
/// All faults found: as for [`super::read_mesh`], and curves that branch, are several, or have one point.
pub fn read_curve(path: &Path) -> Result<(Curve, Vec<Fault>), Vec<Fault>> {
    let mut faults = Faults::new(path.display().to_string());
    let curve = super::read_file(path, &mut faults).and_then(|bytes| {
        let extension = path.extension().and_then(|extension| extension.to_str());
        let text = sniff::without_byte_order_mark(&bytes, &mut faults)?;
        if text.trim_ascii_start().starts_with(b"{") {
            return markups::curve(text, &mut faults);
        }
        let mesh = super::parse_mesh(text, extension, &mut faults)?;
        chain(&mesh, &mut faults)
    });
    faults.finish(curve)
}

/// The segments of a mesh, end to end.
fn chain(mesh: &PolyData, faults: &mut Faults) -> Result<Curve, Stop> {
    if mesh.lines.is_empty() {
        let message = format!(
            "no lines, only {} triangles: a curve is needed",
            mesh.triangles.len()
        );
        return Err(faults.fatal(Place::File, message));
    }
    // Cells may repeat a point where they meet: points at exactly one place are one.
    let mut first_at: BTreeMap<[u64; 3], usize> = BTreeMap::new();
    let mut same = |point: u32| {
        let number = point as usize;
        let key = mesh.points[number].map(|value| (value + 0.0).to_bits());
        *first_at.entry(key).or_insert(number)
    };
    let segments: Vec<[usize; 2]> = mesh.lines.iter().map(|&[a, b]| [same(a), same(b)]).collect();
    let mut at_point: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (number, segment) in segments.iter().enumerate() {
        for &end in segment {
            at_point.entry(end).or_default().push(number);
        }
    }
    if let Some((point, meeting)) = at_point.iter().find(|(_, meeting)| meeting.len() > 2) {
        let message = format!("the curve branches: {} segments meet there", meeting.len());
        return Err(faults.fatal(Place::Element("point", *point), message));
    }
    // In the file's direction: from an end whose segment leaves it, else from any end, else (closed) anywhere.
    let is_end = |point: usize| at_point.get(&point).is_some_and(|meeting| meeting.len() == 1);
    let start = segments.iter().map(|&[from, _]| from).find(|&from| is_end(from));
    let start = start.or_else(|| segments.iter().map(|&[_, to]| to).find(|&to| is_end(to)));
    let closed = start.is_none();
    let order = walk(&segments, &at_point, start.unwrap_or(segments[0][0]));
    let count = order.len() - usize::from(closed);
    let used = order.len() - 1;
    if used < segments.len() {
        let message = format!(
            "the lines are more than one curve: the first has {used} of {} segments",
            segments.len()
        );
        return Err(faults.fatal(Place::File, message));
    }
    if closed && count < 3 {
        return Err(faults.fatal(Place::File, "the curve goes forth and back between two points"));
    }
    let points_mm = order[..count].iter().map(|&point| mesh.points[point]).collect();
    Ok(Curve {
        points_mm,
        closed,
        labels: Vec::new(),
        space: mesh.space,
    })
}

/// The points met from `start` along segments, each taken once; a closed curve ends where it began.
fn walk(segments: &[[usize; 2]], at_point: &BTreeMap<usize, Vec<usize>>, start: usize) -> Vec<usize> {
    let mut used = vec![false; segments.len()];
    let mut order = vec![start];
    let mut here = start;
    // From the start of a closed curve, the first in the file is its direction.
    while let Some(&next) = at_point[&here].iter().find(|&&segment| !used[segment]) {
        used[next] = true;
        let [a, b] = segments[next];
        here = if a == here { b } else { a };
        order.push(here);
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    fn joined(lines: &[[u32; 2]]) -> Result<(Curve, Vec<Fault>), Vec<Fault>> {
        let points: Vec<_> = [0.0, 1.0, 2.0, 3.0, 0.0, 1.0]
            .map(|x: f64| [x, x * x, 0.0])
            .to_vec();
        let mesh = PolyData {
            points,
            lines: lines.to_vec(),
            ..PolyData::default()
        };
        let mut faults = Faults::new("f".into());
        let curve = chain(&mesh, &mut faults);
        faults.finish(curve)
    }

    fn abscissae(lines: &[[u32; 2]]) -> (Vec<f64>, bool) {
        let (curve, _) = joined(lines).unwrap();
        (
            curve.points_mm.iter().map(|point| point[0]).collect(),
            curve.closed,
        )
    }

    #[test]
    fn segments_are_joined_in_the_direction_of_the_file() {
        assert_eq!(
            abscissae(&[[2, 1], [3, 2], [1, 0]]),
            (vec![3.0, 2.0, 1.0, 0.0], false)
        );
        assert_eq!(
            abscissae(&[[0, 1], [2, 1], [2, 3]]),
            (vec![0.0, 1.0, 2.0, 3.0], false)
        );
    }

    #[test]
    fn a_curve_closes_through_a_repeated_point() {
        assert_eq!(
            abscissae(&[[1, 2], [2, 3], [3, 0], [0, 1]]),
            (vec![1.0, 2.0, 3.0, 0.0], true)
        );
        assert_eq!(
            abscissae(&[[0, 1], [1, 2], [2, 4]]),
            (vec![0.0, 1.0, 2.0], true),
            "point 4 lies on point 0"
        );
    }

    #[test]
    fn what_is_no_single_curve_is_refused() {
        for (lines, reason) in [
            (
                &[[0, 1], [1, 2], [1, 3]][..],
                "the curve branches: 3 segments meet there",
            ),
            (
                &[[0, 1], [2, 3]],
                "the lines are more than one curve: the first has 1 of 2 segments",
            ),
            (
                &[[0, 1], [1, 0]],
                "the curve goes forth and back between two points",
            ),
            (&[], "no lines, only 0 triangles: a curve is needed"),
            (&[[0, 4]], "the curve goes forth and back between two points"),
        ] {
            assert_eq!(joined(lines).unwrap_err()[0].message, reason);
        }
    }
}

//! The free margin of a leaflet whose gap or indentation was sewn up: what the stitches hold together is margin no more.

use std::collections::BTreeMap;

use super::distance::point_segment;
use super::gap::threshold_mm;
use super::surface::Surface;
use crate::model::{ChordKind, Margin, Model};

/// The margins without the stretches that stitches of one leaflet hold closed.
///
/// A stretch between the outermost stitches of a seam is closed from its bottom on, as far as each of its vertices is in
/// contact with the opposite edge. What gapes beyond is margin as before.
pub(super) fn free_margins(model: &Model, s: &Surface) -> Vec<Margin> {
    let of_margin = |margin: &Margin| {
        let mut closed = vec![false; margin.vertices.len()];
        for seam in seams(model, s, margin) {
            for i in closed_by(model, s, margin, seam) {
                closed[i] = true;
            }
        }
        let left = margin.vertices.iter().zip(closed).filter(|(_, closed)| !closed);
        Margin {
            vertices: left.map(|(&v, _)| v).collect(),
            closed: margin.closed,
        }
    };
    model.margins.iter().map(of_margin).collect()
}

/// Whether some leaflet is sewn to itself.
pub(super) fn has_seams(model: &Model, s: &Surface) -> bool {
    model
        .margins
        .iter()
        .any(|margin| !seams(model, s, margin).is_empty())
}

/// A seam on a margin, by places counted along it, beyond its end if it is closed.
#[derive(Clone, Copy, Debug)]
struct Seam {
    /// The ends of the stitch nearest to its bottom.
    inner: [usize; 2],
    /// The ends of the one farthest from it.
    outer: [usize; 2],
}

/// The seams of a margin: of each group of sutures those that join two of its places on one leaflet.
fn seams(model: &Model, s: &Surface, margin: &Margin) -> Vec<Seam> {
    let count = margin.vertices.len();
    let place_of: BTreeMap<u32, usize> = margin.vertices.iter().enumerate().map(|(i, &v)| (v, i)).collect();
    let mut found: BTreeMap<u32, Seam> = BTreeMap::new();
    for (segment, &ends) in model.chords.ends.iter().enumerate() {
        let group = model.chords.group[segment];
        if model.chord_groups[group as usize].kind != ChordKind::Suture {
            continue;
        }
        let places = ends.map(|point| place_on(model, s, &place_of, point));
        let [Some((a, of_a)), Some((b, of_b))] = places else {
            continue;
        };
        if of_a & of_b == 0 {
            continue;
        }
        let (from, to) = (a.min(b), a.max(b));
        // Both ends are nearest to one vertex: the stitch holds no stretch of the margin.
        if from == to {
            continue;
        }
        // Around the margin the other way the stitch would hold nearly all of it.
        let stitch = match margin.closed && 2 * (to - from) > count {
            true => [to, from + count],
            false => [from, to],
        };
        let seam = found.entry(group).or_insert(Seam {
            inner: stitch,
            outer: stitch,
        });
        let length = |[from, to]: [usize; 2]| to - from;
        if length(stitch) < length(seam.inner) {
            seam.inner = stitch;
        }
        if length(stitch) > length(seam.outer) {
            seam.outer = stitch;
        }
    }
    found.into_values().collect()
}

/// Which vertex of the margin a chord point is nearest to, and the leaflets there; nothing for a point off the margin.
fn place_on(model: &Model, s: &Surface, place_of: &BTreeMap<u32, usize>, point: u32) -> Option<(usize, u64)> {
    let vertices = &model.chords.points[point as usize];
    if vertices.is_empty() || vertices.len() > 2 || !vertices.iter().all(|(v, _)| place_of.contains_key(v)) {
        return None;
    }
    let &(nearest, _) = vertices.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some((place_of[&nearest], s.vertex_leaflets[nearest as usize]))
}

/// The places strictly within a seam that are closed, from its bottom outward on either side.
fn closed_by(model: &Model, s: &Surface, margin: &Margin, seam: Seam) -> Vec<usize> {
    let Seam { inner, outer } = seam;
    let count = margin.vertices.len();
    let at = |i: usize| margin.vertices[i % count] as usize;
    let touches = |i: usize, opposite: [usize; 2]| {
        let place = s.positions_mm[at(i)];
        let side = |i: usize| [i, (i + 1).min(opposite[1])].map(|i| s.positions_mm[at(i)]);
        let sides = (opposite[0]..opposite[1].max(opposite[0] + 1)).map(side);
        let nearest = sides
            .map(|side| point_segment(place, side))
            .fold(f64::INFINITY, f64::min);
        nearest <= threshold_mm(model, s.vertex_edge_mm[at(i)])
    };
    // The opposite edge goes on beyond the first stitch, to the bottom.
    let before = (outer[0]..=inner[0]).rev();
    let before: Vec<usize> = before
        .take_while(|&i| touches(i, [inner[1] - 1, outer[1]]))
        .collect();
    let after = inner[1]..=outer[1];
    let after: Vec<usize> = after
        .take_while(|&i| touches(i, [outer[0], inner[0] + 1]))
        .collect();
    if before.is_empty() || after.is_empty() {
        return Vec::new();
    }
    let closed = before.into_iter().chain(inner[0] + 1..inner[1]).chain(after);
    closed.filter(|i| !outer.contains(i)).map(|i| i % count).collect()
}

#[cfg(test)]
mod tests {
    use super::super::surface::surface;
    use super::super::test_models::grid_model;
    use super::*;
    use crate::Vec3;
    use crate::energy::chord::Chords;
    use crate::model::ChordGroup;

    /// A sheet of 9 × 5 points that hangs from its upper row, with a slit between its columns 4 and 5 sewn at the margin: three
    /// faces wide, and 0.4 mm wide, or gaping by 2 mm.
    fn slit(wide_mm: f64) -> Model {
        let (columns, rows) = (9_u32, 5_u32);
        let mut model = grid_model(columns as usize, rows as usize, 8.0, 4.0);
        let twins: Vec<u32> = (1..rows).map(|row| row * columns + 4).collect();
        let first = model.rest_mm.len() as u32;
        for &v in &twins {
            let twin = model.rest_mm[v as usize] + Vec3::new(wide_mm, 0.0, 0.0);
            model.rest_mm.push(twin);
        }
        let twin = |v: u32| twins.iter().position(|&t| t == v).map_or(v, |t| first + t as u32);
        for face in &mut model.faces {
            if face.iter().any(|&v| v % columns > 4) {
                *face = face.map(twin);
            }
        }
        model.leaflet_vertex_count = model.rest_mm.len();
        let mut margin: Vec<u32> = (0..=4).map(|column| (rows - 1) * columns + column).collect();
        margin.extend(twins.iter().rev().skip(1));
        margin.push(4);
        margin.extend(twins.iter().map(|&v| twin(v)));
        margin.extend((5..columns).map(|column| (rows - 1) * columns + column));
        model.margins = vec![Margin {
            vertices: margin,
            closed: false,
        }];
        let ends = [twins[3], twin(twins[3])].map(|v| vec![(v, 1.0)]);
        model.chords = Chords {
            points: ends.into(),
            ends: vec![[0, 1]],
            rest_length_mm: vec![0.4],
            area_mm2: vec![0.4],
            group: vec![0],
            ..Chords::default()
        };
        model.chord_groups = vec![ChordGroup {
            name: "seam".into(),
            kind: ChordKind::Suture,
        }];
        model
    }

    /// Found by fuzzing: the stitch is at the first vertex of the margin.
    #[test]
    fn a_stitch_within_the_reach_of_one_vertex_holds_no_margin() {
        let mut model = slit(0.4);
        let first = model.margins[0].vertices[0];
        model.chords.points = [vec![(first, 1.0)], vec![(first, 1.0)]].into();
        let s = surface(&model, &model.rest_mm);
        assert_eq!(free_margins(&model, &s), model.margins);
    }

    #[test]
    fn a_closed_seam_is_no_margin_and_a_gaping_one_is() {
        let model = slit(0.4);
        let s = surface(&model, &model.rest_mm);
        let all = &model.margins[0].vertices;
        let free = &free_margins(&model, &s)[0].vertices;
        assert_eq!(free.len(), 10, "{free:?} of {all:?}");
        assert_eq!((free[4], free[5]), (all[4], all[12]));
        let model = slit(2.0);
        let s = surface(&model, &model.rest_mm);
        let free = &free_margins(&model, &s)[0].vertices;
        assert_eq!(free, all);
        let mut unsewn = slit(0.4);
        unsewn.chord_groups[0].kind = ChordKind::Chorda;
        let s = surface(&unsewn, &unsewn.rest_mm);
        assert_eq!(free_margins(&unsewn, &s), unsewn.margins);
    }
}

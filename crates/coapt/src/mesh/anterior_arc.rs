//! Which stretch of the annulus is anterior: what commissures lie at the ends of.

use crate::Vec3;
use crate::mesh::landmarks::{COMMISSURE_HALF_ANGLE, LandmarkInput, at_angle, nearest_vertex};
use crate::mesh::polyline;
use crate::scene::Fault;

/// First and last vertex of the anterior arc, counter-clockwise.
pub(super) fn anterior_arc(input: &LandmarkInput, warnings: &mut Vec<Fault>) -> (usize, usize) {
    let named = input.named;
    if let (Some(al), Some(pm)) = (
        named.commissure_anterolateral_mm,
        named.commissure_posteromedial_mm,
    ) {
        let al = nearest_vertex(input, al, "commissure_anterolateral_mm", &mut Vec::new());
        let pm = nearest_vertex(input, pm, "commissure_posteromedial_mm", &mut Vec::new());
        if al != pm {
            return arc_between(input, al, pm);
        }
    }
    if let Some(arc) = arc_of_leaflet(input, warnings) {
        return arc;
    }
    let anterior = anterior_from_shape(input, warnings);
    (
        at_angle(input, anterior, -COMMISSURE_HALF_ANGLE),
        at_angle(input, anterior, COMMISSURE_HALF_ANGLE),
    )
}

/// Which of the two arcs between named commissures is anterior: the one with the named anterior middle, the one
/// without the named posterior middle, the one with more edges of the leaflet `anterior`, else as in a human heart.
fn arc_between(input: &LandmarkInput, al: usize, pm: usize) -> (usize, usize) {
    let count = input.annulus_mm.len();
    let inside = |i: usize| (i + count - pm) % count <= (al + count - pm) % count;
    let place = |point| nearest_vertex(input, point, "", &mut Vec::new());
    let edges_of_anterior = |on_arc: bool| {
        let edges = (0..count).filter(|&i| (inside(i) && i != al) == on_arc);
        edges
            .filter(|&i| input.edge_leaflet[i].is_some_and(|l| is_anterior(input, l)))
            .count()
    };
    let normal = match (input.named.mid_anterior_mm, input.named.mid_posterior_mm) {
        (Some(anterior), _) => inside(place(anterior)),
        (None, Some(posterior)) => !inside(place(posterior)),
        (None, None) => edges_of_anterior(true) >= edges_of_anterior(false),
    };
    if normal { (pm, al) } else { (al, pm) }
}

fn is_anterior(input: &LandmarkInput, leaflet: u32) -> bool {
    input
        .leaflet_names
        .get(leaflet as usize)
        .is_some_and(|n| n.eq_ignore_ascii_case("anterior"))
}

/// The longest run of annulus edges on the leaflet `anterior`, or on the first leaflet if none has that name.
fn arc_of_leaflet(input: &LandmarkInput, warnings: &mut Vec<Fault>) -> Option<(usize, usize)> {
    let leaflet_count = input.leaflet_names.len();
    let by_name = (0..leaflet_count as u32).find(|&leaflet| is_anterior(input, leaflet));
    let leaflet = by_name.unwrap_or(0);
    let arc = longest_run(input, leaflet)?;
    if by_name.is_none() {
        let name = input.leaflet_names.first().copied().unwrap_or_default();
        let message = format!("no leaflet is named `anterior`; `{name}` is taken for it");
        warnings.push(Fault::warning("leaflets", message));
    }
    Some(arc)
}

fn longest_run(input: &LandmarkInput, leaflet: u32) -> Option<(usize, usize)> {
    let count = input.annulus_mm.len();
    let on = |i: usize| input.edge_leaflet[i % count] == Some(leaflet);
    let starts = (0..count).filter(|&i| on(i) && !on(i + count - 1));
    let runs = starts.map(|start| {
        (
            start,
            (1..=count).take_while(|&step| on(start + step)).count() + 1,
        )
    });
    let (start, steps) = runs.reduce(|best, next| if next.1 > best.1 { next } else { best })?;
    Some((start, (start + steps) % count)).filter(|_| steps < count)
}

/// The anterior middle where no leaflet border tells: the named one, the saddle's high point, the point away from
/// the papillary muscles, else the first vertex.
fn anterior_from_shape(input: &LandmarkInput, warnings: &mut Vec<Fault>) -> usize {
    if let Some(point) = input.named.mid_anterior_mm {
        return nearest_vertex(input, point, "mid_anterior_mm", &mut Vec::new());
    }
    let centre = polyline::centroid(input.annulus_mm, true);
    let extreme = |direction: Vec3| {
        let reach = |i: usize| (input.annulus_mm[i] - centre).dot(&direction);
        (0..input.annulus_mm.len())
            .max_by(|&a, &b| reach(a).total_cmp(&reach(b)).then(b.cmp(&a)))
            .unwrap_or(0)
    };
    let size = (2.0 * polyline::vector_area(input.annulus_mm).norm()).sqrt();
    let high = extreme(input.atrial);
    let tips =
        input.papillary.iter().map(|&(_, tip)| tip).sum::<Vec3>() / (input.papillary.len().max(1) as f64);
    let away = (centre - tips) - input.atrial * (centre - tips).dot(&input.atrial);
    // A twentieth of the annulus' size tells a saddle, or an offset of the muscles, from noise (our choice).
    let (found, why) = if (input.annulus_mm[high] - centre).dot(&input.atrial) > 0.05 * size {
        (high, "the saddle's high point")
    } else if !input.papillary.is_empty() && away.norm() > 0.05 * size {
        (extreme(away), "the point away from the papillary muscles")
    } else {
        (0, "an arbitrary annulus point")
    };
    let message = format!("no leaflet border shows the commissures; {why} is taken for the anterior middle");
    warnings.push(Fault::warning("landmarks", message));
    found
}

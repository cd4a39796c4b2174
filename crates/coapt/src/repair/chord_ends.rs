//! Where a chord is sewn to a leaflet, and which papillary tip it comes from.

use super::leaflet::{HeightLine, LeafletMargin, leaflet_named};
use super::rods::place_mm;
use super::site::position;
use crate::Vec3;
use crate::model::{Insertion, Model, insertion_near};
use crate::scene::{Fault, Site};

/// A place given as a point is on the leaflet if it is this near [mm]: half an edge of a coarse mesh (our choice).
const REACH_MM: f64 = 2.0;

/// A place on a leaflet as plans give it.
#[derive(Clone, Copy, Debug)]
pub(super) struct LeafletPlace<'a> {
    pub(super) leaflet: &'a str,
    pub(super) site: Option<Site>,
    pub(super) position: Option<f64>,
    pub(super) inset_mm: f64,
    pub(super) point_mm: Option<[f64; 3]>,
}

/// Insertions, evenly over so many millimetres of the margin about the place, each with its share of the margin's arc length,
/// which a place given as a point lacks; `kind` is what faults begin with.
///
/// # Errors
/// No such leaflet or site; a place off the leaflet; more than one way, or none, of saying where.
pub(super) fn insertions(
    model: &Model,
    at: LeafletPlace,
    (count, spread_mm): (u32, f64),
    kind: &str,
) -> Result<Vec<(Insertion, Option<f64>)>, Fault> {
    let leaflet = leaflet_named(model, at.leaflet, &format!("{kind}.leaflet"))?;
    if let Some(point) = at.point_mm {
        let place = format!("{kind}.point_mm");
        if at.site.is_some() || at.position.is_some() {
            return Err(Fault::error(
                place,
                "is given beside a site; expected one of the two",
            ));
        }
        let found = on_leaflet(model, leaflet, point, &place)?;
        return Ok(vec![(found, None); count as usize]);
    }
    let (_, share) = position(at.site, at.position, kind)?;
    let place = format!("{kind}.{}", if at.site.is_some() { "site" } else { "position" });
    let margin = LeafletMargin::new(model, leaflet, &place)?;
    let middle_mm = share * margin.length_mm();
    let steps = f64::from(count.saturating_sub(1).max(1));
    let mut found = Vec::new();
    for strand in 0..count {
        let aside_mm = if count > 1 {
            spread_mm * (f64::from(strand) / steps - 0.5)
        } else {
            0.0
        };
        let arc_mm = middle_mm + aside_mm;
        if !(0.0..=margin.length_mm()).contains(&arc_mm) {
            let message = format!(
                "a strand {:.1} mm to the side would lie beyond the commissure; expected a place farther from it, or a smaller \
                 `spread_mm`",
                aside_mm.abs()
            );
            return Err(Fault::of_shape(place, message));
        }
        let line = margin.height_line(arc_mm, margin.tangent(arc_mm, spread_mm), 0.0);
        let point = inset(model, &line, at, kind)?;
        let insertion = insertion_near(model, leaflet, point, REACH_MM);
        let insertion = insertion.ok_or_else(|| Fault::of_shape(&*place, "is on no face of the leaflet"))?;
        found.push((insertion, Some(arc_mm / margin.length_mm())));
    }
    Ok(found)
}

fn inset(model: &Model, line: &HeightLine, at: LeafletPlace, kind: &str) -> Result<Vec3, Fault> {
    if !(at.inset_mm >= 0.0 && at.inset_mm < line.length_mm()) {
        let message = format!(
            "is {} mm, expected 0 or more and less than the height of the leaflet there, {:.1} mm",
            at.inset_mm,
            line.length_mm()
        );
        return Err(Fault {
            of_shape: at.inset_mm >= 0.0,
            ..Fault::error(format!("{kind}.inset_mm"), message)
        });
    }
    Ok(place_mm(&line.at(at.inset_mm), &model.rest_mm))
}

fn on_leaflet(model: &Model, leaflet: u32, point: [f64; 3], place: &str) -> Result<Insertion, Fault> {
    let [x, y, z] = point;
    let at = Vec3::from(point);
    if !at.iter().all(|coordinate| coordinate.is_finite()) {
        return Err(Fault::error(
            place,
            format!("is ({x}, {y}, {z}) mm, expected finite numbers"),
        ));
    }
    insertion_near(model, leaflet, at, REACH_MM).ok_or_else(|| {
        let away = |&v: &u32| (model.rest_mm[v as usize] - at).norm();
        let faces = model.faces.iter().zip(&model.face_leaflet);
        let of_leaflet = faces.filter(|(_, of)| **of == leaflet).flat_map(|(face, _)| face);
        let nearest = of_leaflet.map(away).fold(f64::INFINITY, f64::min);
        let name = &model.leaflets[leaflet as usize].name;
        let message = format!(
            "is ({x}, {y}, {z}) mm, expected a place within {REACH_MM} mm of the {name} leaflet when open; its nearest vertex \
             is {nearest:.1} mm away"
        );
        Fault::of_shape(place, message)
    })
}

/// A papillary tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tip {
    pub(super) vertex: u32,
    /// Number of its muscle.
    pub(super) muscle: usize,
    /// Its number in the muscle.
    pub(super) number: usize,
}

/// The tip of that muscle and number; of those not excluded so, the one nearest to a point of the open valve.
///
/// # Errors
/// There are no such muscle or tip, or no tips at all.
pub(super) fn tip(
    model: &Model,
    muscle: Option<&str>,
    number: Option<u32>,
    near: Vec3,
    kind: &str,
) -> Result<Tip, Fault> {
    let wanted = muscle
        .map(|name| muscle_named(model, name, &format!("{kind}.muscle")))
        .transpose()?;
    if let (Some(number), None) = (number, wanted) {
        let message =
            format!("is {number}, but there is no `muscle`; expected the name of the muscle whose tip it is");
        return Err(Fault::error(format!("{kind}.tip"), message));
    }
    let all = model
        .papillary
        .iter()
        .enumerate()
        .flat_map(|(muscle, papillary)| {
            let tips = papillary.tips.iter().enumerate();
            tips.map(move |(number, &vertex)| Tip {
                vertex,
                muscle,
                number,
            })
        });
    let candidates: Vec<Tip> = all
        .filter(|tip| wanted.is_none_or(|muscle| tip.muscle == muscle))
        .collect();
    let away = |tip: &Tip| (model.rest_mm[tip.vertex as usize] - near).norm();
    let chosen = match number {
        Some(number) => candidates.get(number as usize),
        None => candidates.iter().min_by(|a, b| away(a).total_cmp(&away(b))),
    };
    chosen.copied().ok_or_else(|| match number {
        Some(number) => {
            let message = format!(
                "is {number}, expected 0 to {}",
                candidates.len().saturating_sub(1)
            );
            Fault::error(format!("{kind}.tip"), message)
        }
        None => Fault::of_shape(
            format!("{kind}.muscle"),
            "the valve has no papillary tip to string a chord from",
        ),
    })
}

/// The number of the papillary muscle of that name, in whatever case.
///
/// # Errors
/// There is none, with `place`.
pub(super) fn muscle_named(model: &Model, name: &str, place: &str) -> Result<usize, Fault> {
    let found = model
        .papillary
        .iter()
        .position(|muscle| muscle.name.eq_ignore_ascii_case(name));
    found.ok_or_else(|| {
        let names: Vec<String> = model
            .papillary
            .iter()
            .map(|muscle| format!("`{}`", muscle.name))
            .collect();
        Fault::error(
            place,
            format!("is `{name}`, expected one of {}", names.join(", ")),
        )
    })
}

//! Films as the page's script reads them: positions in steps of a few micrometres, what is coloured in 255 steps, so that a film of 60
//! frames of 10,000 triangles takes four megabytes.

use coapt::Vec3;
use coapt::measure;
use coapt::model::Model;
use coapt::scene::Fault;
use rayon::prelude::*;
use serde::Serialize;

use super::coded::Coded;
use crate::record::{RecordedFilm, RecordedFrame, Recording, valves};

/// A closing valve.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PageFilm {
    /// Transvalvular pressure [mmHg], shape `[frame]`.
    pub pressures_mmhg: Vec<f64>,
    /// Whether the frame is a balance, shape `[frame]`.
    pub certified: Vec<bool>,
    /// Anatomic orifice [mm²], shape `[frame]`; none where it is not known.
    pub orifice_area_mm2: Vec<Option<f64>>,
    /// Contact area [mm²], shape `[frame]`; none where it is not known.
    pub coaptation_area_mm2: Vec<Option<f64>>,
    /// Where positions are counted from [mm].
    pub low_mm: [f64; 3],
    /// What one step of them is [mm].
    pub step_mm: f64,
    /// Leaflet vertices in steps, shape `[frame][vertex, 3]`.
    pub positions: Vec<Coded<u16>>,
    /// Ends of the chord segments in steps, shape `[frame][segment, 2, 3]`.
    pub chords: Vec<Coded<u16>>,
    /// What one step of `gap` is [mm].
    pub gap_step_mm: f64,
    /// Distance to the other leaflet in steps, shape `[frame][vertex]`.
    pub gap: Vec<Coded<u8>>,
    /// What one step of `strain` is [1].
    pub strain_step: f64,
    /// Strain in steps, shape `[frame][vertex]`.
    pub strain: Vec<Coded<u8>>,
    /// Whether tissue touches tissue, 0 or 1, shape `[frame][vertex]`.
    pub contact: Vec<Coded<u8>>,
}

/// The films of a recording, before and, where it has repairs, after. What colours the leaflets is measured on its valves.
///
/// # Errors
/// A recording that is not of coapt, or of another version.
pub fn page_films(recording: &Recording) -> Result<Vec<PageFilm>, Vec<Fault>> {
    let (before, after) = valves(recording)?;
    let models: Vec<&Model> = std::iter::once(&before)
        .chain(&after)
        .map(|valve| &valve.model)
        .collect();
    let films = recording.films.iter().zip(models);
    films.map(|(film, model)| page_film(film, model)).collect()
}

/// What is known at the vertices of a frame.
struct Known {
    gap_mm: Vec<f64>,
    strain: Vec<f64>,
    contact: Vec<bool>,
}

fn page_film(film: &RecordedFilm, model: &Model) -> Result<PageFilm, Vec<Fault>> {
    let count = model.leaflet_vertex_count;
    if film.frames.iter().any(|frame| frame.positions_mm.len() != count) {
        let message = format!("{} has other vertices than its scene makes", film.topic);
        return Err(vec![Fault::error("recording", message)]);
    }
    let known: Vec<Known> = film.frames.par_iter().map(|frame| known(frame, model)).collect();
    let largest = |of: fn(&Known) -> &[f64]| known.iter().flat_map(of).copied().fold(1e-9, f64::max);
    let gap_step_mm = largest(|known| &known.gap_mm) / f64::from(u8::MAX);
    let strain_step = largest(|known| &known.strain) / f64::from(u8::MAX);
    let (low_mm, step_mm) = steps(film);
    let counted = |points: &mut dyn Iterator<Item = [f64; 3]>| -> Coded<u16> {
        let parts =
            points.flat_map(|point| std::array::from_fn::<f64, 3, _>(|axis| point[axis] - low_mm[axis]));
        Coded(parts.map(|part| (part / step_mm).round() as u16).collect())
    };
    let figures = film.frames.iter().map(|frame| &frame.figures);
    let in_steps =
        |values: &[f64], step: f64| Coded(values.iter().map(|value| (value / step).round() as u8).collect());
    Ok(PageFilm {
        pressures_mmhg: film.frames.iter().map(|frame| frame.pressure_mmhg).collect(),
        certified: film.frames.iter().map(|frame| frame.certified).collect(),
        orifice_area_mm2: figures.clone().map(|figures| figures.orifice_area_mm2).collect(),
        coaptation_area_mm2: figures.map(|figures| figures.coaptation_area_mm2).collect(),
        low_mm,
        step_mm,
        positions: film
            .frames
            .iter()
            .map(|frame| counted(&mut frame.positions_mm.iter().copied()))
            .collect(),
        chords: film
            .frames
            .iter()
            .map(|frame| counted(&mut frame.chords_mm.iter().flatten().copied()))
            .collect(),
        gap_step_mm,
        gap: known
            .iter()
            .map(|known| in_steps(&known.gap_mm, gap_step_mm))
            .collect(),
        strain_step,
        strain: known
            .iter()
            .map(|known| in_steps(&known.strain, strain_step))
            .collect(),
        contact: known
            .iter()
            .map(|known| Coded(known.contact.iter().map(|&touches| u8::from(touches)).collect()))
            .collect(),
    })
}

fn known(frame: &RecordedFrame, model: &Model) -> Known {
    // Nodes of chordae are not recorded, and nothing that is measured here asks for them.
    let mut positions_mm = model.rest_mm.clone();
    for (position, recorded) in positions_mm.iter_mut().zip(&frame.positions_mm) {
        *position = Vec3::from(*recorded);
    }
    let count = model.leaflet_vertex_count;
    let mut known = Known {
        gap_mm: measure::gap_mm(model, &positions_mm),
        strain: measure::vertex_strain(model, &positions_mm),
        contact: measure::in_contact(model, &positions_mm),
    };
    known.gap_mm.truncate(count);
    known.strain.truncate(count);
    known.contact.truncate(count);
    known
}

/// Where positions are counted from and in what steps, so that all are from 0 to 65,535.
fn steps(film: &RecordedFilm) -> ([f64; 3], f64) {
    let points = film
        .frames
        .iter()
        .flat_map(|frame| frame.positions_mm.iter().chain(frame.chords_mm.iter().flatten()));
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for point in points {
        for axis in 0..3 {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
    }
    let widest = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
    match widest.is_finite() && widest > 0.0 {
        true => (low, widest / f64::from(u16::MAX)),
        false => ([0.0; 3], 1.0),
    }
}

//! Making a recording again, and whether it comes out the same.

use coapt::film::{Film, film_watched};
use coapt::model::Model;
use coapt::personalise::Watch;
use coapt::plan::{Applied, apply_all};
use coapt::relax::relax_watched;
use coapt::scene::{Fault, Repair};
use coapt::state::State;

use super::read::{RecordedFilm, RecordedFrame, Recording};
use super::{FRAME_LIMIT, Filmed, Source, read_bytes, recording};

/// How a recording compares with itself made again.
#[derive(Clone, Debug, PartialEq)]
pub struct Replay {
    /// Frames that were compared: all that the recording has.
    pub frames: usize,
    /// Of these, frames that are not the same to the last bit.
    pub different: usize,
    /// The first of these.
    pub first: Option<Difference>,
    /// How far a vertex lies from where it was recorded, at most [mm]; none where nothing can be compared.
    pub farthest_mm: f64,
}

impl Replay {
    /// For people: one line where all agrees, else two.
    pub fn text(&self) -> String {
        let Self {
            frames,
            different,
            first,
            farthest_mm,
        } = self;
        match first {
            None => format!("agrees: {frames} frames, each the same to the last bit\n"),
            Some(first) => format!(
                "DIFFERS: {different} of {frames} frames, vertices up to {farthest_mm:.3e} mm apart\nfirst: {}\n",
                sentence(first)
            ),
        }
    }
}

/// `frame 12 of /valve lies elsewhere: vertex 7 by 1.5e-9 mm`
fn sentence(first: &Difference) -> String {
    let Difference {
        topic,
        frame,
        what,
        vertex,
    } = first;
    let at = vertex.map_or(String::new(), |(vertex, gap_mm)| {
        format!(": vertex {vertex} by {gap_mm:.3e} mm")
    });
    format!("frame {frame} of {topic} {what}{at}")
}

/// The first frame that does not come out the same.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// The film's topic.
    pub topic: String,
    /// Number of the frame.
    pub frame: usize,
    /// What differs in it.
    pub what: String,
    /// The first leaflet vertex that differs, and how far it lies from where it was recorded [mm]; none where vertices agree or are
    /// not as many.
    pub vertex: Option<(usize, f64)>,
}

/// Makes a recording again, from its scene, repairs and number of frames, and compares every frame bit for bit.
///
/// # Errors
/// A scene or repairs that are not those of a valve: the recording is not coapt's, or another version's.
pub fn replay(recorded: &Recording, watch: Watch) -> Result<Replay, Vec<Fault>> {
    let bytes = made_again(recorded, watch)?;
    let made = read_bytes(&bytes).map_err(|fault| vec![fault])?;
    Ok(compare(recorded, &made))
}

/// The recording made again, as bytes.
///
/// # Errors
/// As [`replay`].
pub fn made_again(recorded: &Recording, watch: Watch) -> Result<Vec<u8>, Vec<Fault>> {
    let frames = frames(recorded).map_err(|fault| vec![fault])?;
    let (before, after) = valves(recorded)?;
    let source = Source {
        scene: &recorded.scene,
        repairs_before: &recorded.repairs_before,
        repairs: &recorded.repairs,
    };
    let (first, second) = rayon::join(
        || closed_film(&before.model, frames, watch),
        || {
            after
                .as_ref()
                .map(|after| closed_film(&after.model, frames, watch))
        },
    );
    let second = after.as_ref().zip(second.as_ref());
    let second = second.map(|(after, film)| filmed(after, film));
    recording(source, filmed(&before, &first), second).map_err(|fault| vec![fault])
}

/// The valves of a recording: the first, and where it has repairs the one after them.
///
/// # Errors
/// As [`replay`].
pub(crate) fn valves(recorded: &Recording) -> Result<(Applied, Option<Applied>), Vec<Fault>> {
    let built = Model::build(&recorded.scene)?.model;
    let before = repaired(&built, &recorded.repairs_before)?;
    if recorded.repairs.is_empty() {
        return Ok((before, None));
    }
    let mut after = repaired(&before.model, &recorded.repairs)?;
    after.reports.splice(..0, before.reports.iter().cloned());
    Ok((before, Some(after)))
}

fn repaired(model: &Model, repairs: &[Repair]) -> Result<Applied, Vec<Fault>> {
    apply_all(model, repairs).map_err(|refusal| refusal.faults)
}

fn filmed<'a>(valve: &'a Applied, film: &'a Film) -> Filmed<'a> {
    Filmed {
        model: &valve.model,
        film,
        repairs: &valve.reports,
    }
}

fn frames(recorded: &Recording) -> Result<usize, Fault> {
    let told = recorded.facts.get("frames").map_or("", String::as_str);
    let number = told
        .parse()
        .ok()
        .filter(|number| (2..=FRAME_LIMIT).contains(number));
    let wrong = || {
        Fault::error(
            "frames",
            format!("is {told:?}; expected a number from 2 to {FRAME_LIMIT}"),
        )
    };
    number.map(|number| number as usize).ok_or_else(wrong)
}

fn closed_film(model: &Model, frames: usize, watch: Watch) -> Film {
    let closed = relax_watched(model, &State::open(model), watch);
    film_watched(model, &closed, frames, watch)
}

fn compare(recorded: &Recording, made: &Recording) -> Replay {
    let mut replay = Replay {
        frames: 0,
        different: 0,
        first: None,
        farthest_mm: 0.0,
    };
    for film in &recorded.films {
        let again = made.films.iter().find(|again| again.topic == film.topic);
        for (number, frame) in film.frames.iter().enumerate() {
            replay.frames += 1;
            let difference = difference(film, again, number, frame);
            replay.farthest_mm = replay.farthest_mm.max(farthest_mm(frame, again, number));
            if let Some(difference) = difference {
                replay.different += 1;
                replay.first.get_or_insert(difference);
            }
        }
    }
    replay
}

fn difference(
    film: &RecordedFilm,
    again: Option<&RecordedFilm>,
    number: usize,
    frame: &RecordedFrame,
) -> Option<Difference> {
    let differs = |what: &str, vertex| {
        Some(Difference {
            topic: film.topic.clone(),
            frame: number,
            what: what.to_owned(),
            vertex,
        })
    };
    let Some(other) = again.and_then(|again| again.frames.get(number)) else {
        return differs("is not made again", None);
    };
    if again.is_some_and(|again| again.faces != film.faces)
        || other.positions_mm.len() != frame.positions_mm.len()
    {
        return differs("is of another mesh", None);
    }
    let bits = |point: &[f64; 3]| point.map(f64::to_bits);
    let vertices = frame.positions_mm.iter().zip(&other.positions_mm);
    let moved = vertices
        .enumerate()
        .find(|(_, (here, there))| bits(here) != bits(there));
    if let Some((vertex, (here, there))) = moved {
        return differs("lies elsewhere", Some((vertex, distance_mm(here, there))));
    }
    let ends = |frame: &RecordedFrame| -> Vec<[u64; 3]> {
        frame.chords_mm.as_flattened().iter().map(bits).collect()
    };
    if ends(frame) != ends(other) {
        return differs("has its chordae elsewhere", None);
    }
    // JSON gives numbers back to the last bit.
    (frame.figures != other.figures)
        .then(|| differs("has other figures", None))
        .flatten()
}

/// How far a leaflet vertex of a frame lies from where it was recorded, at most.
fn farthest_mm(frame: &RecordedFrame, again: Option<&RecordedFilm>, number: usize) -> f64 {
    let other = again.and_then(|again| again.frames.get(number));
    let there = other.map_or(&[][..], |other| &other.positions_mm);
    let pairs = frame.positions_mm.iter().zip(there);
    pairs
        .map(|(here, there)| distance_mm(here, there))
        .fold(0.0, f64::max)
}

fn distance_mm(one: &[f64; 3], other: &[f64; 3]) -> f64 {
    let squares = one.iter().zip(other).map(|(one, other)| (one - other).powi(2));
    squares.sum::<f64>().sqrt()
}

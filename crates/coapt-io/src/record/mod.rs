//! Recordings: films of a closing valve that viewers play and that coapt can make again, as MCAP files.
//!
//! | in the file | holds |
//! |---|---|
//! | topic `/valve` | each frame as `foxglove.SceneUpdate`: leaflets coloured by strain, chordae by tension, places of contact; a frame that is no balance is grey and says so |
//! | topic `/supports` | once: annulus, papillary tips, ring; they stand still |
//! | topic `/figures` | each frame's [`Figures`] as JSON |
//! | attachment `scene.json` | the scene with its meshes and settings |
//! | attachment `repairs.json` | the repairs between the two films; absent where there is one |
//! | attachment `repairs_before.json` | repairs that the valve had before all; absent where it had none |
//! | metadata `coapt` | layout of the file, version, case, number of frames, notice |
//! | metadata `film /valve` | the film's `open_gap_mm`; absent where it is not known |
//!
//! With repairs the topics stand twice, below `/before` and `/after`. Log time begins at 0, and a film takes two seconds whatever its
//! number of frames: it is quasi-static and has no time of its own. No clock is read, and equal inputs give equal bytes. Positions
//! are doubles and come back as they were, bit for bit.
//!
//! Foxglove and Lichtblick play these files; beside `closing.mcap` stands `closing.layout.json` for them. Rerun opens MCAP, but
//! knows no `foxglove.SceneUpdate`.

mod again;
mod container;
mod draw;
mod fields;
mod figures;
mod glb;
mod layout;
mod message;
mod read;
mod schema;
mod sequence;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use coapt::film::Film;
use coapt::model::Model;
use coapt::repair;
use coapt::scene::{Fault, Repair, Scene};
use rayon::prelude::*;

pub(crate) use again::valves;
pub use again::{Difference, Replay, made_again, replay};
use container::Container;
pub use figures::Figures;
pub use glb::write_glb;
pub use layout::layout;
pub use read::{RecordedFilm, RecordedFrame, Recording, read, read_bytes};
pub use sequence::write_sequence;

use crate::atomic::Batch;
use crate::report::NOTICE;

/// The layout of recordings.
pub const RECORDING_SCHEMA: &str = "coapt-recording/1";

/// Frames of a film at most, our choice: nobody looks at more, and what says that it has more was not written by coapt.
pub const FRAME_LIMIT: u32 = 10_000;

/// How long a film takes [ns], our choice: a few times slower than a heart closes its valve, to be looked at.
const FILM_NS: u64 = 2_000_000_000;

/// The frame of reference: the patient's, LPS, in mm.
const FRAME_ID: &str = "patient_lps_mm";

const SCENE_FILE: &str = "scene.json";
const REPAIRS_BEFORE_FILE: &str = "repairs_before.json";
const REPAIRS_FILE: &str = "repairs.json";
const FACTS: &str = "coapt";
const FILM_FACTS: &str = "film ";

/// What a recording is made again from.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// The scene, whole: with its meshes, without files.
    pub scene: &'a Scene,
    /// What was done to the valve before all.
    pub repairs_before: &'a [Repair],
    /// What was done between the two films; nothing where there is one.
    pub repairs: &'a [Repair],
}

/// A valve and its film.
#[derive(Clone, Copy, Debug)]
pub struct Filmed<'a> {
    /// The valve, as it was filmed.
    pub model: &'a Model,
    /// The film.
    pub film: &'a Film,
    /// What repairs did to it.
    pub repairs: &'a [repair::Report],
}

/// Writes a recording, and its layout for viewers beside it, both whole or not at all.
///
/// # Errors
/// What the file system says.
pub fn write_recording(
    path: &Path,
    source: Source,
    before: Filmed,
    after: Option<Filmed>,
) -> Result<(), Fault> {
    let bytes = recording(source, before, after)?;
    let mut batch = Batch::default();
    batch.write(path, &bytes)?;
    batch.write(
        &layout_path(path),
        layout(before.model, after.is_some()).as_bytes(),
    )?;
    batch.finish()
}

/// Where the layout of a recording stands: `closing.layout.json` beside `closing.mcap`.
pub fn layout_path(recording: &Path) -> PathBuf {
    recording.with_extension("layout.json")
}

/// A recording as bytes: one film, or with repairs the films before and after.
///
/// # Errors
/// None that the types allow.
pub fn recording(source: Source, before: Filmed, after: Option<Filmed>) -> Result<Vec<u8>, Fault> {
    let fault = |error: binrw::Error| Fault::error("recording", error.to_string());
    let mut container = Container::new().map_err(fault)?;
    attach_source(&mut container, source)?;
    let folder = if after.is_some() { "/before" } else { "" };
    let films: Vec<(&str, Filmed)> = [(folder, before)]
        .into_iter()
        .chain(after.map(|after| ("/after", after)))
        .collect();
    write_films(&mut container, &source.scene.name, &films).map_err(fault)?;
    container.finish().map_err(fault)
}

fn attach_source(container: &mut Container, source: Source) -> Result<(), Fault> {
    let fault = |error: &dyn std::fmt::Display| Fault::error("recording", error.to_string());
    let mut attach = |name: &str, json: serde_json::Result<Vec<u8>>| {
        let json = json.map_err(|error| fault(&error))?;
        let attached = container.attach(name, "application/json", &json);
        attached.map_err(|error| fault(&error))
    };
    attach(SCENE_FILE, serde_json::to_vec(source.scene))?;
    for (name, repairs) in [
        (REPAIRS_BEFORE_FILE, source.repairs_before),
        (REPAIRS_FILE, source.repairs),
    ] {
        if !repairs.is_empty() {
            attach(name, serde_json::to_vec(repairs))?;
        }
    }
    Ok(())
}

fn write_films(container: &mut Container, case: &str, films: &[(&str, Filmed)]) -> container::Result<()> {
    let frames = films
        .iter()
        .map(|(_, filmed)| filmed.film.frames.len())
        .max()
        .unwrap_or(0);
    tell_facts(container, case, frames, films)?;
    let reels = reels(container, films)?;
    for reel in &reels {
        container.message(reel.supports, 0, &reel.supports_message())?;
    }
    // Some at a time: pictures of all frames of a large valve need not be in memory at once.
    for some in (0..frames).collect::<Vec<_>>().chunks(FRAMES_AT_A_TIME) {
        let draw = |&number: &usize| reels.iter().map(|reel| reel.frame(number)).collect();
        let drawn: Vec<Vec<Option<Pictured>>> = some.par_iter().map(draw).collect();
        for (&number, pictures) in some.iter().zip(&drawn) {
            let time_ns = time_ns(number, frames);
            for (reel, pictured) in reels.iter().zip(pictures) {
                let Some(pictured) = pictured else { continue };
                container.message(reel.valve, time_ns, &pictured.valve)?;
                container.message(reel.figures, time_ns, &pictured.figures)?;
            }
            container.end_frame()?;
        }
    }
    Ok(())
}

fn tell_facts(
    container: &mut Container,
    case: &str,
    frames: usize,
    films: &[(&str, Filmed)],
) -> container::Result<()> {
    let facts = [
        ("schema", RECORDING_SCHEMA),
        ("version", env!("CARGO_PKG_VERSION")),
        ("case", case),
        ("frames", &frames.to_string()),
        ("notice", NOTICE),
    ];
    container.tell(FACTS, words(facts))?;
    for (folder, filmed) in films {
        if let Some(gap_mm) = filmed.film.open_gap_mm {
            let name = format!("{FILM_FACTS}{folder}/valve");
            container.tell(&name, words([("open_gap_mm", &*gap_mm.to_string())]))?;
        }
    }
    Ok(())
}

fn reels<'a>(container: &mut Container, films: &[(&str, Filmed<'a>)]) -> container::Result<Vec<Reel<'a>>> {
    let scene = container.schema(schema::SCENE_UPDATE, "protobuf", &schema::scene_update())?;
    let figures = schema::figures().to_string();
    let figures = container.schema(schema::FIGURES, "jsonschema", figures.as_bytes())?;
    let mut reel = |(folder, filmed): &(&str, Filmed<'a>)| {
        let mut channel =
            |schema_id, name, encoding| container.channel(schema_id, &format!("{folder}/{name}"), encoding);
        Ok(Reel {
            filmed: *filmed,
            valve: channel(scene, "valve", "protobuf")?,
            supports: channel(scene, "supports", "protobuf")?,
            figures: channel(figures, "figures", "json")?,
        })
    };
    films.iter().map(&mut reel).collect()
}

/// Frames that are drawn side by side.
const FRAMES_AT_A_TIME: usize = 16;

/// When a frame is shown.
fn time_ns(number: usize, frames: usize) -> u64 {
    FILM_NS * number as u64 / (frames as u64).saturating_sub(1).max(1)
}

/// A film and the channels that it is written to.
struct Reel<'a> {
    filmed: Filmed<'a>,
    valve: u16,
    supports: u16,
    figures: u16,
}

/// The messages of a frame.
struct Pictured {
    valve: Vec<u8>,
    figures: Vec<u8>,
}

impl Reel<'_> {
    fn supports_message(&self) -> Vec<u8> {
        let Filmed { model, film, repairs } = self.filmed;
        let last = film.frames.last();
        let positions_mm = last.map_or(&model.rest_mm, |frame| &frame.equilibrium.state.positions_mm);
        draw::supports(model, positions_mm, repairs)
    }

    fn frame(&self, number: usize) -> Option<Pictured> {
        let Filmed { model, film, .. } = self.filmed;
        let frame = film.frames.get(number)?;
        let figures = Figures::new(model, frame, number);
        Some(Pictured {
            valve: draw::frame(model, frame, time_ns(number, film.frames.len())),
            // Names and numbers: nothing that JSON could not hold.
            figures: serde_json::to_vec(&figures).unwrap_or_default(),
        })
    }
}

fn words<const N: usize>(facts: [(&str, &str); N]) -> BTreeMap<String, String> {
    facts
        .map(|(key, value)| (key.to_owned(), value.to_owned()))
        .into()
}

#[cfg(test)]
mod tests;

//! Films of closing valves, for the verbs that close them: `--record`.

use std::path::{Path, PathBuf};

use clap::{Args, value_parser};
use coapt::film::{FRAMES, Film, film_watched};
use coapt::model::Model;
use coapt::relax::Equilibrium;
use coapt::repair;
use coapt_io::atomic::make_folder;
use coapt_io::record::{FRAME_LIMIT, Filmed, Source, layout_path, write_recording};
use coapt_io::report::Closed;

use crate::interrupt::watching;
use crate::output::{Failure, say};

/// What is filmed, and to where.
#[derive(Debug, Args)]
pub(crate) struct FilmArguments {
    /// Also write how the valve closes, before and after, as an MCAP file to be played in Foxglove or Lichtblick and to be made again by
    /// `coapt replay`; beside FILE.mcap stands FILE.layout.json for viewers
    #[arg(long, value_name = "FILE.mcap")]
    pub(crate) record: Option<PathBuf>,
    /// Frames of the film, from no pressure to all of it; each takes about a tenth of the time of a closure or two
    #[arg(long, value_name = "N", requires = "record", default_value_t = FRAMES as u32, value_parser = value_parser!(u32).range(2..=i64::from(FRAME_LIMIT)))]
    frames: u32,
}

/// A closed valve to be filmed, and what repairs did to it.
#[derive(Clone, Copy)]
pub(crate) struct Scenery<'a> {
    pub(crate) model: &'a Model,
    pub(crate) closed: &'a Equilibrium,
    pub(crate) repairs: &'a [repair::Report],
}

impl<'a> Scenery<'a> {
    pub(crate) fn new(closed: &'a Closed, repairs: &'a [repair::Report]) -> Self {
        Self {
            model: &closed.model,
            closed: &closed.equilibrium,
            repairs,
        }
    }
}

/// Films, before and after.
pub(crate) type Films = (Film, Option<Film>);

impl FilmArguments {
    /// Sees that there is a folder to write to: before minutes of work, not after.
    pub(crate) fn prepare(&self) -> Result<(), Failure> {
        let Some(path) = &self.record else { return Ok(()) };
        match path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            Some(folder) => make_folder(folder).map_err(Failure::Outside),
            None => Ok(()),
        }
    }

    /// Films valves where that is asked for.
    pub(crate) fn shoot(&self, before: Scenery, after: Option<Scenery>) -> Option<Films> {
        self.record.as_ref()?;
        let shoot = |what: &str, valve: Scenery| {
            watching(what, |watch| {
                film_watched(valve.model, valve.closed, self.frames as usize, watch)
            })
        };
        let (first, second) = rayon::join(
            || shoot("the film before repair", before),
            || after.map(|after| shoot("the film after repair", after)),
        );
        Some((first, second))
    }

    /// Writes the films.
    pub(crate) fn write(
        &self,
        source: Source,
        films: Option<&Films>,
        before: Scenery,
        after: Option<Scenery>,
    ) -> Result<(), Failure> {
        let (Some(path), Some((first, second))) = (&self.record, films) else {
            return Ok(());
        };
        let second = second
            .as_ref()
            .zip(after)
            .map(|(film, valve)| filmed(film, valve));
        write_recording(path, source, filmed(first, before), second).map_err(Failure::Outside)?;
        tell(path, first, second.map(|filmed| filmed.film));
        Ok(())
    }
}

fn filmed<'a>(film: &'a Film, valve: Scenery<'a>) -> Filmed<'a> {
    Filmed {
        model: valve.model,
        film,
        repairs: valve.repairs,
    }
}

/// Farther than this from the balance without pressure the first frame is told to be another one [mm]: below, it is the residual
/// that is left (our choice).
const TOLD_GAP_MM: f64 = 0.01;

/// Says what was recorded, and what is doubtful in it.
fn tell(path: &Path, before: &Film, after: Option<&Film>) {
    say(&format!(
        "the film is in {}, its layout for viewers in {}",
        path.display(),
        layout_path(path).display()
    ));
    let films = [("before repair", Some(before)), ("after repair", after)];
    for (what, film) in films {
        let Some(film) = film else { continue };
        let bad = film.frames.iter().filter(|frame| !frame.is_certified()).count();
        if bad > 0 {
            let all = film.frames.len();
            say(&format!(
                "film {what}: {bad} of {all} frames are NOT certified, and grey"
            ));
        }
        match film.open_gap_mm {
            Some(gap_mm) if gap_mm > TOLD_GAP_MM => say(&format!(
                "film {what}: without pressure the valve has several balances; the first frame lies up to {gap_mm:.2} mm \
                 from the one that the open valve comes to"
            )),
            Some(_) => {}
            None => say(&format!("film {what}: no balance without pressure was found")),
        }
    }
}

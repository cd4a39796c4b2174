//! Films of closing valves, for the verbs that close them: `--record`, `--sequence`, `--glb`.

use std::path::{Path, PathBuf};

use clap::{ArgGroup, Args};
use coapt::film::{FRAMES, Film, film_watched};
use coapt::model::Model;
use coapt::relax::Equilibrium;
use coapt::repair;
use coapt::scene::Fault;
use coapt_io::atomic::make_folder;
use coapt_io::record::{
    FRAME_LIMIT, Filmed, Source, layout_path, write_glb, write_recording, write_sequence,
};
use coapt_io::report::Closed;

use crate::interrupt::watching;
use crate::output::{Failure, say};
use crate::whole_number::whole_number;

/// What is filmed, and to where.
#[derive(Debug, Args)]
#[command(group(ArgGroup::new("films").args(["record", "sequence", "glb"]).multiple(true)))]
pub(crate) struct FilmArguments {
    /// Also write how the valve closes, before and after repair (of alternatives: the one that ranks first), as an MCAP file to be played in Foxglove or Lichtblick and to be made again by
    /// `coapt replay`; beside FILE.mcap stands FILE.layout.json for viewers
    #[arg(long, value_name = "FILE.mcap")]
    record: Option<PathBuf>,
    /// Also write how the valve closes as a row of surfaces, each as closed.vtp, with lists for ParaView: valve.pvd, chords.pvd; before
    /// and after stand in folders of their own
    #[arg(long, value_name = "DIR")]
    sequence: Option<PathBuf>,
    /// Also write how the valve closes, after the repairs where there are any, as an animated GLB file for browsers and office programs: to
    /// show, not to measure
    #[arg(long, value_name = "FILE.glb")]
    glb: Option<PathBuf>,
    /// Frames of the film, from no pressure to all of it; 60 take some ten times as long as the closure
    #[arg(long, value_name = "N", requires = "films", default_value_t = FRAMES as u32, value_parser = whole_number(2..=FRAME_LIMIT), allow_negative_numbers = true)]
    frames: u32,
}

/// Sees that a file can have a name: before minutes of work, not after.
pub(crate) fn is_no_folder(option: &str, file: &Path) -> Result<(), Failure> {
    match file.is_dir() {
        true => Err(vec![Fault::error(
            option,
            format!("{} is a folder; expected the name of a file", file.display()),
        )]
        .into()),
        false => Ok(()),
    }
}

/// Makes the folder of a file, if it names one and that is not there.
pub(crate) fn make_folder_of(file: &Path) -> Result<(), Failure> {
    let named = file.parent().filter(|folder| !folder.as_os_str().is_empty());
    named.map_or(Ok(()), make_folder).map_err(Failure::Outside)
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
        for (option, file) in [("--record", &self.record), ("--glb", &self.glb)] {
            file.as_deref()
                .map_or(Ok(()), |file| is_no_folder(option, file))?;
        }
        let mut files = [&self.record, &self.glb].into_iter().flatten();
        files.try_for_each(|file| make_folder_of(file))?;
        self.sequence
            .as_deref()
            .map_or(Ok(()), make_folder)
            .map_err(Failure::Outside)
    }

    /// Whether anything is filmed.
    pub(crate) fn is_asked_for(&self) -> bool {
        self.record.is_some() || self.sequence.is_some() || self.glb.is_some()
    }

    /// Films valves where that is asked for.
    pub(crate) fn shoot(&self, before: Scenery, after: Option<Scenery>) -> Option<Films> {
        if !self.is_asked_for() {
            return None;
        }
        let shoot = |what: &str, valve: Scenery| {
            watching(what, |watch| {
                film_watched(valve.model, valve.closed, self.frames as usize, watch)
            })
        };
        let first_name = match after {
            None => "the film",
            Some(_) => "the film before repair",
        };
        let (first, second) = rayon::join(
            || shoot(first_name, before),
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
        let Some((first, second)) = films else {
            return Ok(());
        };
        let second = second
            .as_ref()
            .zip(after)
            .map(|(film, valve)| filmed(film, valve));
        let first = filmed(first, before);
        if let Some(path) = &self.record {
            write_recording(path, source, first, second).map_err(Failure::Outside)?;
            let layout = layout_path(path);
            say(&format!(
                "the film is in {}, its layout for viewers in {}",
                path.display(),
                layout.display()
            ));
        }
        if let Some(folder) = &self.sequence {
            write_sequence(folder, first, second).map_err(Failure::Outside)?;
            say(&format!("the film as surfaces is in {}", folder.display()));
        }
        if let Some(path) = &self.glb {
            write_glb(path, second.unwrap_or(first)).map_err(Failure::Outside)?;
            say(&format!("the film to be shown is in {}", path.display()));
        }
        tell(first.film, second.map(|filmed| filmed.film));
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

/// Says what is doubtful in films.
fn tell(before: &Film, after: Option<&Film>) {
    match after {
        None => tell_of("the film", before),
        Some(after) => {
            tell_of("the film before repair", before);
            tell_of("the film after repair", after);
        }
    }
}

fn tell_of(what: &str, film: &Film) {
    let all = film.frames.len();
    let bad = film.frames.iter().filter(|frame| !frame.is_certified()).count();
    if bad > 0 {
        say(&format!(
            "{what}: {bad} of {all} frames are NOT certified, and marked"
        ));
    }
    match film.open_gap_mm {
        Some(gap_mm) if gap_mm > TOLD_GAP_MM => say(&format!(
            "{what}: without pressure the valve has several balances; the first frame lies up to {gap_mm:.2} mm from \
             the one that the open valve comes to"
        )),
        Some(_) => {}
        None => say(&format!("{what}: no balance without pressure was found")),
    }
}

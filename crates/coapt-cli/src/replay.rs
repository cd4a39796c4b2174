//! `coapt replay`: makes a recording again and compares every frame.

use std::path::PathBuf;

use clap::{Args, value_parser};
use coapt_io::record::{Difference, Recording, Replay, read, replay};

use crate::closure::on_threads;
use crate::interrupt::watching;
use crate::output::{Failure, Verdict, print, say};

/// What `coapt replay` understands.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// A recording, as `--record` writes it
    file: PathBuf,
    /// How many threads to use; the result does not depend on it [default: one per core]
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

/// Runs the verb.
pub(crate) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    let recording = read(&arguments.file).map_err(|fault| vec![fault])?;
    warn(&recording);
    let found = on_threads(arguments.threads, || {
        watching("the replay", |watch| replay(&recording, watch)).map_err(Failure::Input)
    })?;
    print(&text(&found))?;
    Ok(match found.first {
        None => Verdict::Done,
        Some(_) => Verdict::Uncertified,
    })
}

/// What makes a difference likely.
fn warn(recording: &Recording) {
    let fact = |key: &str| recording.facts.get(key).map_or("", String::as_str);
    let version = env!("CARGO_PKG_VERSION");
    if fact("version") != version {
        say(&format!(
            "recorded by version {}, made again by {version}",
            fact("version")
        ));
    }
    if recording.cut {
        let films = recording.films.iter();
        let frames: Vec<String> = films
            .map(|film| format!("{} of {}", film.frames.len(), film.topic))
            .collect();
        let frames = frames.join(", ");
        let all = fact("frames");
        say(&format!(
            "the recording is cut off; of {all} frames to each film there are {frames}"
        ));
    }
}

fn text(found: &Replay) -> String {
    let Replay {
        frames,
        different,
        first,
        farthest_mm,
    } = found;
    match first {
        None => format!("agrees: {frames} frames, each the same to the last bit\n"),
        Some(first) => format!(
            "DIFFERS: {different} of {frames} frames, vertices up to {farthest_mm:.3e} mm apart\nfirst: {}\n",
            sentence(first)
        ),
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

//! `coapt replay`: makes a recording again and compares every frame.

use std::path::PathBuf;

use clap::Args;
use coapt_io::record::{read, replay};

use crate::closure::on_threads;
use crate::interrupt::watching;
use crate::output::{Failure, Verdict, print, say};
use crate::whole_number::{THREADS_ALLOWED, whole_number};

/// What `coapt replay` understands.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// A recording, as `--record` writes it
    file: PathBuf,
    /// How many threads to use; the result does not depend on it [default: one per core]
    #[arg(long, value_name = "N", value_parser = whole_number(THREADS_ALLOWED), allow_negative_numbers = true)]
    threads: Option<u16>,
}

/// Runs the verb.
pub(crate) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    let recording = read(&arguments.file).map_err(|fault| vec![fault])?;
    recording.doubts().iter().for_each(|doubt| say(doubt));
    let found = on_threads(arguments.threads, || {
        watching("the replay", |watch| replay(&recording, watch)).map_err(Failure::Input)
    })?;
    print(&found.text())?;
    Ok(match found.first {
        None => Verdict::Done,
        Some(_) => Verdict::Uncertified,
    })
}

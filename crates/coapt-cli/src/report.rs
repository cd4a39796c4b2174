//! `coapt report`: one page of a result.

use std::path::PathBuf;

use clap::Args;
use coapt::scene::Severity;
use coapt_io::atomic::write_text_atomically;
use coapt_io::page::{RECORDING, SHOWN_ALTERNATIVES, add_film, page_html, read_page};

use crate::output::{Failure, Verdict, say, tell};
use crate::whole_number::whole_number;

/// What `coapt report` understands.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The folder that `coapt closure --out` or `coapt plan --out --shapes` wrote
    result: PathBuf,
    /// The page, an HTML file; an old one is replaced
    #[arg(short, long, value_name = "FILE", default_value = "report.html")]
    out: PathBuf,
    /// The film of that closure, which `coapt closure --record` wrote [default: closing.mcap in the folder, where it is]
    #[arg(long, value_name = "FILE.mcap")]
    recording: Option<PathBuf>,
    /// Of a plan, show the shapes of so many alternatives, the first-ranked first; the table has all
    #[arg(long, value_name = "N", default_value_t = SHOWN_ALTERNATIVES, value_parser = whole_number(0..=usize::MAX), allow_negative_numbers = true)]
    most: usize,
}

/// Runs the verb.
pub(crate) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    let mut page = read_page(&arguments.result, arguments.most)?;
    let beside = arguments.result.join(RECORDING);
    match &arguments.recording {
        Some(recording) => add_film(&mut page, recording)?,
        // Nobody asked for it: it may be of an earlier run. A page of a plan shows no film.
        None if beside.is_file() && page.plan.is_none() => {
            if let Err(mut faults) = add_film(&mut page, &beside) {
                for fault in &mut faults {
                    fault.severity = Severity::Warning;
                }
                tell(&faults);
                say("the page is made without a film");
            }
        }
        None => {}
    }
    let html = page_html(&page).map_err(Failure::Outside)?;
    write_text_atomically(&arguments.out, html.as_bytes()).map_err(Failure::Outside)?;
    say(&format!(
        "the page is in {}; open it in any browser",
        arguments.out.display()
    ));
    Ok(
        match page.states.iter().all(|state| state.certificate.certified) {
            true => Verdict::Done,
            false => Verdict::Uncertified,
        },
    )
}

//! The program `coapt`: results to standard output, words to standard error. One file per verb; this one alone
//! turns an outcome into an exit status.
//!
//! | status | meaning |
//! |---|---|
//! | 0 | done |
//! | 1 | failed: something outside stood against it, such as a full disk |
//! | 2 | wrong usage or wrong input |
//! | 3 | finished, but the result is not certified; of a replay: it differs |
//! | 129, 130, 143 | interrupted: the terminal was closed (SIGHUP), Ctrl-C, asked to end (SIGTERM) |

mod case;
mod check;
mod closure;
mod compare;
mod export;
mod film;
mod fit_tissue;
mod generate;
mod interrupt;
mod output;
mod personalise;
mod plan;
mod replay;
mod report;
mod study;
mod whole_number;

use std::io::{ErrorKind, Write};
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use coapt_io::atomic::remove_empty_folders;
use coapt_io::escape::escaped_lines;

use output::{Failure, Verdict};

/// How a mitral valve closes, before and after a repair.
#[derive(Debug, Parser)]
#[command(name = "coapt", version, max_term_width = 100, after_help = AFTER_HELP)]
struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

const AFTER_HELP: &str = "\
Exit status: 0 done, 1 failed, 2 wrong usage or wrong input, 3 finished but not certified
(replay: differs), 129, 130 or 143 interrupted.
For research use; not a medical device.";

#[derive(Debug, Subcommand)]
enum Verb {
    /// Close a valve under systolic pressure, before and after a repair, and report
    Closure(closure::Arguments),
    /// Compare many surgical alternatives in one table, ranked
    Plan(plan::Arguments),
    /// Read and validate a scene; list every fault with its line
    Check(check::Arguments),
    /// Measure how far apart two surfaces lie, under every published definition
    Compare(compare::Arguments),
    /// Write a parametric valve as a scene
    Generate(generate::Arguments),
    /// Write a valve as input of another engine (CalculiX, FEBio), or that engine's result as a surface
    Export(export::Arguments),
    /// Fit the lengths of the chordae to an imaged closed valve, and report the error before and after
    Personalise(personalise::Arguments),
    /// Fit the springs of the leaflets to a biaxial curve; print them as a block for a scene
    FitTissue(fit_tissue::Arguments),
    /// Make one page of a result, to open in any browser without a network
    Report(report::Arguments),
    /// Make a recording again and compare every frame, bit for bit
    Replay(replay::Arguments),
    /// Close a valve at many settings; set error against time and find the knee
    Study(study::Arguments),
}

fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            // Help is a result, everything else is wrong usage; a closed pipe changes neither.
            let words = error.render().to_string();
            let printed = match error.use_stderr() && escaped_lines(&words) != words {
                // It repeats arguments, and names of files may be made by others.
                true => std::io::stderr().write_all(escaped_lines(&words).as_bytes()),
                false => error.print(),
            };
            let lost = printed.is_err_and(|error| error.kind() != ErrorKind::BrokenPipe);
            return ExitCode::from(match error.use_stderr() {
                true => 2,
                false => u8::from(lost),
            });
        }
    };
    interrupt::listen();
    let outcome = match &arguments.verb {
        Verb::Closure(arguments) => closure::run(arguments),
        Verb::Plan(arguments) => plan::run(arguments),
        Verb::Check(arguments) => check::run(arguments),
        Verb::Compare(arguments) => compare::run(arguments),
        Verb::Generate(arguments) => generate::run(arguments),
        Verb::Export(arguments) => export::run(arguments),
        Verb::Personalise(arguments) => personalise::run(arguments),
        Verb::FitTissue(arguments) => fit_tissue::run(arguments),
        Verb::Report(arguments) => report::run(arguments),
        Verb::Replay(arguments) => replay::run(arguments),
        Verb::Study(arguments) => study::run(arguments),
    };
    if !matches!(outcome, Ok(Verdict::Done)) {
        remove_empty_folders();
    }
    match outcome {
        Ok(Verdict::Done) => ExitCode::SUCCESS,
        Ok(Verdict::Uncertified) => ExitCode::from(3),
        Err(Failure::Input(faults)) => {
            output::tell(&faults);
            ExitCode::from(2)
        }
        Err(Failure::Outside(fault)) => {
            output::tell(&[fault]);
            ExitCode::from(1)
        }
    }
}

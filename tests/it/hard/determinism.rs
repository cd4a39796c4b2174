//! Equal scenes end in equal bytes: again in this process, with another number of threads, in another process.

use std::io::Write;
use std::process::Command;

use rayon::prelude::*;

use super::{cases, run};

/// Set for a process that is to print the digests of all cases.
const ASKED: &str = "COAPT_PRINT_DIGESTS";

/// A line for each case, presets among them: its name and a number made of every bit of where it ended (FNV-1a).
fn digests() -> Vec<String> {
    let cases = cases();
    let digest = |number: u64, byte: u8| (number ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    let line = |case| {
        let end = run(case, 0).equilibrium;
        let numbers = end.iter().flat_map(|end| {
            let vectors = end.state.positions_mm.iter().chain(&end.reactions_n);
            vectors
                .flat_map(|vector| vector.iter().copied())
                .chain(end.history.iter().map(|iteration| iteration.residual))
        });
        let bytes = numbers.flat_map(f64::to_le_bytes);
        format!(
            "{}: {:016x}",
            case.name,
            bytes.fold(0xcbf2_9ce4_8422_2325, digest)
        )
    };
    cases.par_iter().map(line).collect()
}

#[test]
fn equal_cases_end_in_equal_bytes() {
    let here = digests();
    if std::env::var_os(ASKED).is_some() {
        let text = format!("\n{}\n", here.join("\n"));
        return std::io::stdout()
            .write_all(text.as_bytes())
            .expect("somebody reads");
    }
    let program = std::env::current_exe().expect("a test is a program");
    for threads in ["1", "3"] {
        let mut again = Command::new(&program);
        again.args([
            "--exact",
            "--nocapture",
            "hard::determinism::equal_cases_end_in_equal_bytes",
        ]);
        let output = again
            .env(ASKED, "1")
            .env("RAYON_NUM_THREADS", threads)
            .output()
            .expect("it runs");
        let text = String::from_utf8_lossy(&output.stdout);
        let is_digest = |line: &&str| here.iter().any(|known| name(known) == name(line));
        let there: Vec<&str> = text.lines().filter(is_digest).collect();
        assert_eq!(there, here, "{threads} threads");
    }
}

fn name(line: &str) -> Option<&str> {
    Some(line.rsplit_once(": ")?.0)
}

//! The program killed, interrupted, or run twice at once, at any moment: every file is one of an old and a new one, whole.
#![cfg(unix)]

use std::collections::BTreeSet;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::program::{Folder, Snapshot, fits_its_list, snapshot, stderr, temporaries, with_membranes};

fn start(arguments: &[String]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_coapt"))
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

fn send(signal: &str, child: &Child) {
    let sent = Command::new("kill")
        .args([signal, &child.id().to_string()])
        .status();
    assert!(sent.unwrap().success());
}

/// Two runs that write other files to one place.
struct Rivals {
    out: String,
    runs: [Vec<String>; 2],
    /// What each leaves.
    known: [Snapshot; 2],
    takes: Duration,
}

impl Rivals {
    fn new(out: &str, runs: [&str; 2]) -> Self {
        let runs = runs.map(|run| {
            run.replace("OUT", out)
                .split(' ')
                .map(str::to_owned)
                .collect::<Vec<_>>()
        });
        let mut takes = Duration::MAX;
        let known = runs.each_ref().map(|run| {
            let begun = Instant::now();
            let output = start(run).wait_with_output().unwrap();
            takes = takes.min(begun.elapsed());
            assert!(
                matches!(output.status.code(), Some(0 | 3)),
                "{run:?} {}",
                stderr(&output)
            );
            snapshot(Path::new(out))
        });
        let differ = known[0].keys().all(|name| known[0][name] != known[1][name]);
        assert!(!known[0].is_empty() && known[0].keys().eq(known[1].keys()) && differ);
        let out = out.to_owned();
        Self {
            out,
            runs,
            known,
            takes,
        }
    }

    /// Which runs the files in place are of.
    fn found(&self) -> BTreeSet<usize> {
        let now = snapshot(Path::new(&self.out));
        assert!(now.keys().eq(self.known[0].keys()), "{:?}", now.keys());
        let of = |(name, bytes): (&String, &Vec<u8>)| {
            let run = (0..2).find(|&run| &self.known[run][name] == bytes);
            run.unwrap_or_else(|| {
                panic!(
                    "{name} is neither the old file nor the new one: {} bytes",
                    bytes.len()
                )
            })
        };
        now.iter().map(of).collect()
    }

    /// Stops runs in turns at moments spread over their time, most of them towards the end, where files are written; returns how
    /// many were met.
    fn stop(&self, signal: &str, times: u32, mut look: impl FnMut(&Self)) -> u32 {
        let mut met = 0;
        for number in 0..times {
            // The golden ratio spreads any number of moments evenly.
            let part = (f64::from(number) * 0.618_034).fract();
            let mut child = start(&self.runs[number as usize % 2]);
            std::thread::sleep(self.takes.mul_f64(1.05 * part.sqrt()));
            match signal {
                // Without the time that it takes to start another program.
                "-KILL" => child.kill().unwrap(),
                _ => send(signal, &child),
            }
            met += u32::from(child.wait().unwrap().code().is_none_or(|code| code > 3));
            look(self);
        }
        met
    }
}

fn closures(folder: &Folder) -> Rivals {
    let [small, large] = ["36", "38"]
        .map(|width| folder.preset(width, "healthy", &[&format!("annulus.transverse_mm={width}")]));
    let run = |valve: &str| format!("closure {valve} --ring saddle:30 --out OUT");
    Rivals::new(&folder.path("out"), [&run(&small), &run(&large)])
}

/// What is left under other names stands in nobody's way, and files of two runs do not fit the list of their checksums.
#[test]
#[allow(clippy::print_stderr, reason = "how many kills met their moment is chance")]
fn killed_at_any_moment_every_file_is_the_old_or_the_new_one() {
    let folder = Folder::new("killed");
    let closures = closures(&folder);
    std::fs::create_dir(folder.path("exported")).unwrap();
    let [small, large] = ["36", "38"].map(|width| {
        let settings = [&*format!("annulus.transverse_mm={width}")];
        with_membranes(&folder.preset(&format!("membranes-{width}"), "healthy", &settings))
    });
    let export = |valve: &str| format!("export {valve} --format febio --out OUT/valve.feb");
    let generate = |width: u32| {
        format!("generate --force --set faces=300 --set annulus.transverse_mm={width} --out OUT")
    };
    let [before, after] = ["before", "after"].map(|state| format!("{}/{state}", closures.out));
    let all = [
        Rivals::new(
            &folder.path("compared"),
            [
                &format!("compare {before} {after} --out OUT"),
                &format!("compare {after} {before} --out OUT"),
            ],
        ),
        Rivals::new(&folder.path("exported"), [&export(&small), &export(&large)]),
        Rivals::new(&folder.path("generated"), [&generate(36), &generate(38)]),
        closures,
    ];
    let (mut met, mut half_written, mut mixed) = (0, 0, 0);
    for rivals in &all {
        let out = Path::new(&rivals.out);
        met += rivals.stop("-KILL", 16, |rivals| {
            if rivals.found().len() > 1 {
                mixed += 1;
                assert_ne!(fits_its_list(out), Some(true));
            }
        });
        half_written += temporaries(Path::new(&rivals.out)).len();
        let output = start(&rivals.runs[0]).wait_with_output().unwrap();
        assert!(matches!(output.status.code(), Some(0 | 3)), "{}", stderr(&output));
        assert_eq!(rivals.found(), BTreeSet::from([0]));
        // An export is one file, which needs none.
        let is_set = rivals.known[0].len() > 1;
        assert!(!is_set || fits_its_list(out).unwrap_or(true));
        // Elsewhere they go after an hour.
        if cfg!(target_os = "linux") {
            assert_eq!(temporaries(Path::new(&rivals.out)), Vec::<String>::new());
        }
    }
    eprintln!(
        "{met} of 64 kills came in time, left {half_written} files under other names and {mixed} times files of two runs"
    );
    assert!(met >= 16, "{met} of 64 kills came in time");
}

/// All files are of one run, too, and nothing is left under other names.
#[test]
fn interrupted_at_any_moment_all_files_are_of_one_run() {
    let folder = Folder::new("interrupted");
    let rivals = closures(&folder);
    let met = rivals.stop("-INT", 16, |rivals| {
        assert_eq!(rivals.found().len(), 1);
        assert!(fits_its_list(Path::new(&rivals.out)).unwrap_or(true));
        assert_eq!(temporaries(Path::new(&rivals.out)), Vec::<String>::new());
    });
    assert!(met > 4, "{met} of 16 interruptions came in time");
}

/// In a closure that takes seconds.
#[test]
fn an_interruption_tells_what_was_reached_and_ends_at_once() {
    let folder = Folder::new("told");
    let out = folder.path("out");
    for (signal, status) in [("-INT", 130), ("-TERM", 143), ("-HUP", 129)] {
        let study = "study --faces 20000 --reference-faces 20000 --out OUT".replace("OUT", &out);
        let mut child = start(&study.split(' ').map(str::to_owned).collect::<Vec<_>>());
        let mut words = BufReader::new(child.stderr.take().unwrap());
        let mut told = String::new();
        words.read_line(&mut told).unwrap();
        assert!(told.starts_with("reference: "), "{told}");
        std::thread::sleep(Duration::from_millis(700));
        let sent = Instant::now();
        send(signal, &child);
        let ended = child.wait().unwrap().code();
        let took = sent.elapsed();
        words.read_to_string(&mut told).unwrap();
        assert_eq!(ended, Some(status), "{told}");
        assert!(told.contains("interrupted: the reference "), "{told}");
        assert!(told.ends_with("; nothing was written\n"), "{told}");
        // Within 0.1 s where the machine has nothing else to do; here other tests run beside.
        assert!(took < Duration::from_secs(1), "{took:?}");
    }
    // The folder was made before the work began, and nothing was put into it.
    assert!(!Path::new(&out).exists());
}

/// What was begun with `nohup` outlives its terminal.
#[cfg(target_os = "linux")]
#[test]
fn who_asked_for_hang_ups_to_be_ignored_is_not_interrupted_by_them() {
    let folder = Folder::new("nohup");
    let study = [
        "study",
        "--faces",
        "20000",
        "--reference-faces",
        "20000",
        "--out",
        &folder.path("out"),
    ];
    let mut child = Command::new("sh")
        .args([
            "-c",
            "trap '' HUP; exec \"$0\" \"$@\"",
            env!("CARGO_BIN_EXE_coapt"),
        ])
        .args(study)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut words = BufReader::new(child.stderr.take().unwrap());
    words.read_line(&mut String::new()).unwrap();
    send("-HUP", &child);
    std::thread::sleep(Duration::from_millis(300));
    assert!(child.try_wait().unwrap().is_none());
    send("-INT", &child);
    assert_eq!(child.wait().unwrap().code(), Some(130));
}

/// Of many closures: how many were complete.
#[test]
fn an_interrupted_comparison_tells_how_far_it_came() {
    let folder = Folder::new("alternatives");
    let out = folder.path("out");
    let plan = folder.file(
        "plan.toml",
        "schema_version = 1\n[[repair]]\nkind = \"ring\"\nfamily = \"saddle\"\nsize_mm = { from = 24, to = 34, step = 0.005 }\n",
    );
    let arguments = [
        "plan",
        "dilated",
        &plan,
        "--out",
        &out,
        "--max-alternatives",
        "20000",
    ]
    .map(str::to_owned);
    let child = start(&arguments);
    std::thread::sleep(Duration::from_secs(3));
    send("-INT", &child);
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    let told = stderr(&output);
    assert!(told.starts_with("interrupted: the alternatives with "), "{told}");
    assert!(
        told.contains("closures were complete; nothing was written"),
        "{told}"
    );
    assert!(!Path::new(&out).exists());
}

/// Whether the first is still being answered or not.
#[test]
fn a_second_interruption_does_not_hang() {
    let arguments = ["study", "--out", &Folder::new("twice").path("out")].map(str::to_owned);
    let child = start(&arguments);
    std::thread::sleep(Duration::from_millis(300));
    send("-INT", &child);
    let _ = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .output();
    let begun = Instant::now();
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(130));
    assert!(begun.elapsed() < Duration::from_secs(1));
}

#[test]
fn two_programs_may_write_to_one_folder() {
    let folder = Folder::new("together");
    let rivals = closures(&folder);
    for _ in 0..6 {
        let both = rivals.runs.each_ref().map(|run| start(run));
        for child in both {
            let output = child.wait_with_output().unwrap();
            assert!(matches!(output.status.code(), Some(0 | 3)), "{}", stderr(&output));
        }
        rivals.found();
        assert_eq!(temporaries(Path::new(&rivals.out)), Vec::<String>::new());
    }
}

//! The inputs that are kept keep the promises of each target, and every target of `fuzz/` is one of these.

use std::fs;
use std::path::{Path, PathBuf};

use coapt_fuzz_cases::{closure, mesh, recording, scene, scratch, seeds, tables};

/// As `fuzz/run` has libFuzzer do it: longer inputs are cut.
const LONGEST: usize = 16384;
const LONGEST_RECORDING: usize = 65536;
const LONGEST_CASE: usize = 512;

fn at(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

/// The files of some folders, in the order of their names, each cut to a length.
fn inputs(folders: &[PathBuf], longest: usize) -> Vec<Vec<u8>> {
    let of = |folder: &PathBuf| {
        let entries = fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
        let files = entries.map(|entry| entry.expect("an entry").path());
        let mut files: Vec<PathBuf> = files.filter(|path| path.is_file()).collect();
        files.sort();
        files
    };
    let cut = |path: PathBuf| {
        let mut bytes = fs::read(path).expect("a file that can be read");
        bytes.truncate(longest);
        bytes
    };
    folders.iter().flat_map(of).map(cut).collect()
}

/// One case for each repair that the target makes, on the smallest valve and unchanged: its bytes say 0 changes from their end.
fn repairs() -> Vec<Vec<u8>> {
    (0..9).map(|kind| vec![0, 60, 0, 1, kind, 100]).collect()
}

/// All in one test: they share a folder.
#[test]
fn kept_inputs_keep_what_fuzzing_asks_for() {
    let kept = |name: &str| seeds().join(name);
    let (meshes, bad) = (at("assets/meshes"), at("assets/bad"));
    for bytes in inputs(&[kept("mesh"), meshes.clone(), bad.clone()], LONGEST) {
        mesh(&bytes);
    }
    for bytes in inputs(&[kept("scene"), bad.clone(), bad.join("plans")], LONGEST) {
        scene(&bytes);
    }
    for bytes in inputs(&[kept("tables"), at("tests/it/data")], LONGEST) {
        tables(&bytes);
    }
    for bytes in inputs(&[kept("recording")], LONGEST_RECORDING) {
        recording(&bytes);
    }
    for bytes in inputs(&[meshes], LONGEST_CASE).into_iter().chain(repairs()) {
        closure(&bytes);
    }
    fs::remove_dir_all(scratch()).expect("the folder of this process");
}

/// Nothing is left in a target that this build does not compile but the call itself.
#[test]
fn targets_do_nothing_but_call_these() {
    for name in ["mesh", "scene", "tables", "recording", "closure"] {
        let target =
            fs::read_to_string(at("fuzz/fuzz_targets").join(name).with_extension("rs")).expect("a target");
        let code: Vec<&str> = target.lines().filter(|line| !line.starts_with("//")).collect();
        let call = format!("libfuzzer_sys::fuzz_target!(|bytes: &[u8]| coapt_fuzz_cases::{name}(bytes));");
        assert_eq!(code, ["", "#![no_main]", "", &call], "{name}");
    }
}

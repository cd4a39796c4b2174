//! A process that closes valve after valve, as a server or a notebook does, does not grow.

use coapt::mesh::parametric::Preset;
use coapt::relax::relax;
use coapt::state::State;
use coapt_tests::preset_model;

/// What the allocator may keep on top for chance [bytes]: closures are all the same, and what one of them takes, some 2 MB, is
/// there to be taken again. A leak of 6 kB per closure exceeds it in the last 200 of 300.
const ROOM_BYTES: u64 = 1 << 20;

/// Resident memory [bytes]; nothing where the system does not tell.
fn resident_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kilobytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kilobytes << 10)
}

/// Closes small valves of two presets in turns; resident memory after the warm-up and at the end.
#[allow(clippy::print_stderr, reason = "a skipped test must say so")]
fn growth(closures: usize) -> Option<[u64; 2]> {
    let models = [Preset::Healthy, Preset::Flail].map(|preset| preset_model(preset, 160, 0.0, 0));
    let mut after_warm_up = 0;
    for number in 0..closures {
        let model = &models[number % 2];
        let closed = relax(model, &State::open(model));
        assert!(!closed.history.is_empty());
        if number == closures / 3 {
            after_warm_up = resident_bytes()?;
        }
    }
    let end = resident_bytes()?;
    eprintln!("{closures} closures: {after_warm_up} bytes after a third, {end} at the end");
    Some([after_warm_up, end])
}

#[allow(clippy::print_stderr, reason = "a skipped test must say so")]
fn assert_no_growth(closures: usize) {
    let Some([early, late]) = growth(closures) else {
        eprintln!("skipped: no /proc/self/status");
        return;
    };
    assert!(late <= early + ROOM_BYTES, "from {early} to {late} bytes");
}

#[test]
fn hundreds_of_closures_do_not_grow_the_process() {
    assert_no_growth(300);
}

/// `cargo test -p coapt-tests --test memory -- --ignored`
#[test]
#[ignore = "takes minutes"]
fn ten_thousand_closures_do_not_grow_the_process() {
    assert_no_growth(10_000);
}

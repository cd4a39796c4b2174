//! Real anatomy: tables of a published mitral model become a scene, and the scene closes.
//!
//! The data are not part of the repository; without them the test says that it is skipped.

use std::path::PathBuf;
use std::process::Command;

use crate::program::shared;

#[test]
fn the_kaiser_valves_import_and_close() {
    let Some(kaiser) = shared("data/kaiser_mitral") else {
        return;
    };
    let tool = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../python/tools/tables_to_scene.py"
    );
    for case in ["ct_64", "normal1_64"] {
        let scene = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(case);
        let tables = kaiser.join(case);
        let made = Command::new("python3")
            .args([tool, "kaiser", "--force"])
            .arg(&tables)
            .arg(&scene)
            .output();
        let made = made.expect("python3 runs");
        assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
        let closed = Command::new(env!("CARGO_BIN_EXE_coapt"))
            .arg("closure")
            .arg(&scene)
            .output();
        let closed = closed.expect("coapt runs");
        // Exit status 0: converged, stable and free of crossings.
        assert!(
            closed.status.success(),
            "{case}: {}",
            String::from_utf8_lossy(&closed.stdout)
        );
    }
}

//! What fuzzing of closures found; `fuzz/README.md` says how it is run.

use std::path::Path;

use coapt::model::Model;
use coapt::scene::{Tissue, Wrinkling};
use coapt_io::scene::read_scene;
use coapt_tests::close;

/// A leaflet of next to no stiffness with one point 50 mm away is blown up until its faces lie on each other, 1e-6 mm apart. It
/// was found before nearest points were exact: after 166 iterations an edge had passed through a face.
#[test]
fn nothing_passes_through_a_leaflet_that_is_blown_up() {
    let good = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/bad/parts/good.toml");
    let mut scene = read_scene(&good).unwrap().0;
    let posterior = &mut scene.leaflets[1];
    posterior.mesh.as_mut().unwrap().points_mm[3] =
        [-42.949812616351814, -28.071042207098607, -47.551042207098604];
    posterior.tissue = Tissue::StVenantKirchhoff {
        modulus_mpa: 10_f64.powf(-87.0 / 16.0),
        poisson_ratio: 0.3,
        wrinkling: Wrinkling::TensionField,
        bending_modulus_mpa: 0.1 * 10_f64.powf(-1.0 / 16.0),
    };
    scene.settings.iteration_limit = 256;
    scene.settings.coarse_to_fine = false;
    let closed = close(&Model::build(&scene).unwrap().model);
    assert!(
        closed.certificate.crossings.is_empty(),
        "{:?}",
        closed.certificate
    );
}

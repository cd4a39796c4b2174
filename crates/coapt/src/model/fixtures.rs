//! Small valves made by hand, for tests.

use super::{Built, Model};
use crate::scene::{
    ChordGroup, Fault, Leaflet, LineMesh, Load, PapillaryMuscle, SCHEMA_VERSION, Scene, SurfaceMesh,
};

/// Columns of the skirt, 15 degrees apart.
pub(crate) const COLUMNS: usize = 24;
/// Rows of points from annulus to margin.
pub(crate) const ROWS: usize = 3;

/// A funnel of two leaflets under an elliptic annulus of 38 by 28 mm. Axes as in a human heart: y anterior, z to
/// the atrium, hence -x anterolateral. The anterior leaflet spans 30 to 150 degrees. Two papillary muscles with
/// one tip and two chords each.
pub(crate) fn skirt() -> Scene {
    Scene {
        schema_version: SCHEMA_VERSION,
        name: "skirt".into(),
        space: Default::default(),
        leaflets: vec![leaflet("anterior", 2, 10), leaflet("posterior", 10, 26)],
        annulus: Default::default(),
        papillary: vec![muscle("anterolateral", -12.0), muscle("posteromedial", 12.0)],
        chordae: vec![chords()],
        load: Load::mmhg(100.0),
        contact: Default::default(),
        landmarks: Default::default(),
        weld: Default::default(),
        settings: Default::default(),
    }
}

/// A point of the skirt; row 0 is annulus.
pub(crate) fn skirt_point(column: usize, row: usize) -> [f64; 3] {
    let (sin, cos) = ((column % COLUMNS) as f64 * std::f64::consts::TAU / COLUMNS as f64).sin_cos();
    let shrink = 1.0 - 0.15 * row as f64;
    [19.0 * shrink * cos, 14.0 * shrink * sin, -7.0 * row as f64]
}

fn leaflet(name: &str, first: usize, last: usize) -> Leaflet {
    let mut mesh = SurfaceMesh::default();
    for column in first..=last {
        mesh.points_mm
            .extend((0..ROWS).map(|row| skirt_point(column, row)));
    }
    for column in 0..last - first {
        for row in 0..ROWS - 1 {
            let top = (column * ROWS + row) as u32;
            let next = top + ROWS as u32;
            mesh.faces
                .extend([[top, next, top + 1], [next, next + 1, top + 1]]);
        }
    }
    Leaflet {
        name: name.into(),
        mesh_file: None,
        region: None,
        mesh: Some(mesh),
        thickness_mm: 1.0,
        tissue: Default::default(),
    }
}

fn muscle(name: &str, x: f64) -> PapillaryMuscle {
    PapillaryMuscle {
        name: name.into(),
        tips_mm: vec![[x, -2.0, -28.0]],
        tips_file: None,
        displacements_mm: vec![],
    }
}

/// From each tip through a branch node to two margin points.
fn chords() -> ChordGroup {
    let mut mesh = LineMesh::default();
    for (x, columns) in [(-12.0, [11, 13]), (12.0, [1, 23])] {
        let first = mesh.points_mm.len() as u32;
        mesh.points_mm.extend([[x, -2.0, -28.0], [x, 0.0, -20.0]]);
        mesh.points_mm
            .extend(columns.map(|column| skirt_point(column, ROWS - 1)));
        mesh.segments
            .extend([[first, first + 1], [first + 1, first + 2], [first + 1, first + 3]]);
    }
    ChordGroup {
        name: "marginal".into(),
        mesh_file: None,
        mesh: Some(mesh),
        diameter_mm: 1.0,
        modulus_mpa: Some(30.0),
        law: None,
        rest_length_scale: 1.0,
        insertion_radius_mm: 0.0,
    }
}

/// A leaflet's mesh, which the skirt always has.
pub(crate) fn mesh(scene: &mut Scene, leaflet: usize) -> &mut SurfaceMesh {
    scene.leaflets[leaflet].mesh.get_or_insert_default()
}

/// The chords' mesh.
pub(crate) fn lines(scene: &mut Scene) -> &mut LineMesh {
    scene.chordae[0].mesh.get_or_insert_default()
}

/// The model of a scene that must be good.
pub(crate) fn built(scene: &Scene) -> Built {
    Model::build(scene).unwrap_or_else(|faults| panic!("{faults:#?}"))
}

/// The faults of a scene that must be bad.
pub(crate) fn faults(scene: &Scene) -> Vec<Fault> {
    Model::build(scene)
        .err()
        .unwrap_or_else(|| panic!("{} was accepted", scene.name))
}

/// Whether a fault at this place says this.
pub(crate) fn told(faults: &[Fault], place: &str, words: &str) -> bool {
    let found = faults
        .iter()
        .any(|f| f.place.contains(place) && f.message.contains(words));
    if !found {
        panic!("no fault at `{place}` with `{words}` in {faults:#?}");
    }
    found
}

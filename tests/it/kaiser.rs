//! Mitral valves of an independent mass-spring code (Kaiser et al., "Modeling the mitral valve", arXiv 1902.00018), each with
//! the equilibrium that it found under pressure: ours must be the same.
//!
//! Its leaflets and chordae are springs of one law that carry tension only, as our chordae do, so that all of them become
//! chordae here; nothing touches. Its pressure is a rule of its own: a node on its grid gets
//! p m (x(j+1) − x(j−1)) × (x(k+1) − x(k−1)), a node without a neighbour standing in for it, m = 1/4, twice that where a
//! neighbour in j is missing and twice that where one in k is. Ours acts on triangles. What the two differ by is put on as
//! dead loads, and made anew until it no longer changes: then the valve is in balance under exactly their rule.

use std::collections::HashMap;
use std::path::Path;

use coapt::Vec3;
use coapt::energy::chord::Chords;
use coapt::energy::pressure;
use coapt::model::{AnnulusLandmarks, ChordGroup, LeafletTissue, Model, Prescribed};
use coapt::relax::{Equilibrium, Status, relax};
use coapt::scene::{ChordLaw, Contact, Settings, Tissue};
use coapt::state::State;

use crate::tables::{Row, number, point, shared, table};

/// 1 dyn/cm² [MPa].
const DYN_PER_CM2_MPA: f64 = 1e-7;
/// 1 cm² [mm²].
const CM2_MM2: f64 = 100.0;
/// Corrections of the pressure, at most; seven to nine closures are enough.
const CORRECTIONS: u32 = 20;

/// A valve as its generator left it.
struct Valve {
    model: Model,
    closed_mm: Vec<Vec3>,
    /// Leaflet nodes by their place on the grid; j runs round the annulus.
    grid: HashMap<(i32, i32), u32>,
    around: i32,
}

fn valve(folder: &Path) -> Valve {
    let nodes = table(&folder.join("nodes.csv"));
    let law = law(&folder.join("law.txt"));
    let is_leaflet = |row: &&Row| row["kind"] == "leaflet";
    let rest_mm: Vec<Vec3> = nodes
        .iter()
        .map(|row| point(row, ["xo_mm", "yo_mm", "zo_mm"]))
        .collect();
    let prescribed: Vec<Prescribed> = (0..nodes.len())
        .filter(|&node| nodes[node]["fixed"] == "1" || nodes[node]["kind"] == "papillary")
        .map(|node| Prescribed {
            vertex: node as u32,
            target_mm: rest_mm[node],
        })
        .collect();
    let grid: HashMap<(i32, i32), u32> = nodes
        .iter()
        .enumerate()
        .filter(|(_, row)| is_leaflet(row))
        .map(|(node, row)| ((number(row, "j"), number(row, "k")), node as u32))
        .collect();
    let faces = faces(folder);
    Valve {
        closed_mm: nodes
            .iter()
            .map(|row| point(row, ["xc_mm", "yc_mm", "zc_mm"]))
            .collect(),
        around: grid.keys().map(|(j, _)| *j).max().unwrap_or(0),
        grid,
        model: Model {
            name: folder.display().to_string(),
            leaflet_vertex_count: nodes.iter().filter(is_leaflet).count(),
            face_leaflet: vec![0; faces.len()],
            faces,
            leaflets: vec![LeafletTissue {
                name: "both".into(),
                thickness_mm: 1.0,
                tissue: Tissue::default(),
            }],
            springs: Default::default(),
            membranes: Default::default(),
            hinges: Default::default(),
            chords: chords(folder, rest_mm.len(), &law),
            chord_groups: vec![ChordGroup::chordae("all")],
            // Their pressure is negative against the normals of their grid.
            pressure_mpa: law["p_closed_dyn_cm2"].abs() * DYN_PER_CM2_MPA,
            dead_loads_n: vec![],
            contact: Contact {
                stiffness_mpa: 0.0,
                ..Contact::default()
            },
            annulus: vec![],
            margins: vec![],
            papillary: vec![],
            landmarks: AnnulusLandmarks::default(),
            prescribed,
            settings: Settings {
                residual_tolerance: 1e-9,
                ..Settings::default()
            },
            rest_mm,
        },
    }
}

fn law(path: &Path) -> HashMap<String, f64> {
    let text = std::fs::read_to_string(path).expect("the folder holds its law");
    let pair = |line: &str| {
        let (name, value) = line.split_once(' ')?;
        Some((name.to_owned(), value.trim().parse().ok()?))
    };
    text.lines().filter_map(pair).collect()
}

/// Their quads, cut in two, and turned so that our pressure acts along theirs.
fn faces(folder: &Path) -> Vec<[u32; 3]> {
    let quads = table(&folder.join("quads.csv"));
    let cut = |row: &Row| {
        let [a, b, c, d] = ["a", "b", "c", "d"].map(|name| number::<u32>(row, name));
        let second = (d != c).then_some([a, c, d]);
        [Some([a, b, c]), second].into_iter().flatten()
    };
    quads.iter().flat_map(cut).map(|[a, b, c]| [a, c, b]).collect()
}

/// T = k σ(E) with k in cm² and σ in dyn/cm².
fn chords(folder: &Path, node_count: usize, law: &HashMap<String, f64>) -> Chords {
    let springs = table(&folder.join("springs.csv"));
    Chords {
        points: (0..node_count as u32).map(|node| vec![(node, 1.0)]).collect(),
        ends: springs
            .iter()
            .map(|row| [number(row, "i"), number(row, "j")])
            .collect(),
        rest_length_mm: springs.iter().map(|row| number(row, "rest_mm")).collect(),
        area_mm2: springs
            .iter()
            .map(|row| number::<f64>(row, "k_dyn") * CM2_MM2)
            .collect(),
        group: vec![0; springs.len()],
        laws: vec![ChordLaw::Collagen {
            scale_mpa: law["a"] * DYN_PER_CM2_MPA,
            exponent: law["b"],
            full_recruitment_strain: law["full_recruitment"],
            modulus_mpa: law["eta"] * DYN_PER_CM2_MPA,
        }],
    }
}

/// Their pressure force on each node [N].
fn their_pressure_n(valve: &Valve, positions_mm: &[Vec3]) -> Vec<Vec3> {
    let mut force = vec![Vec3::zeros(); positions_mm.len()];
    for (&(j, k), &node) in &valve.grid {
        let at = |j: i32, k: i32| valve.grid.get(&((j - 1).rem_euclid(valve.around) + 1, k));
        let [ahead, behind, above, below] = [at(j + 1, k), at(j - 1, k), at(j, k + 1), at(j, k - 1)];
        let place = |neighbour: Option<&u32>| positions_mm[*neighbour.unwrap_or(&node) as usize];
        let along = place(ahead) - place(behind);
        let across = place(above) - place(below);
        let both = |one: Option<&u32>, other: Option<&u32>| one.is_some() && other.is_some();
        let part = if both(ahead, behind) { 0.5 } else { 1.0 } * if both(above, below) { 0.5 } else { 1.0 };
        force[node as usize] = along.cross(&across) * (-valve.model.pressure_mpa * part);
    }
    force
}

/// Closes the valve under their pressure from its state without any; how many closures that took.
fn close(valve: &mut Valve) -> (Equilibrium, u32) {
    let mut closed = State::open(&valve.model);
    let mut last: Option<Vec<Vec3>> = None;
    for corrections in 1.. {
        let equilibrium = relax(&valve.model, &closed);
        assert_eq!(equilibrium.status, Status::Converged, "{}", valve.model.name);
        let positions = &equilibrium.state.positions_mm;
        let change = last.map_or(f64::INFINITY, |last| farthest(&last, positions));
        if change < 1e-6 || corrections == CORRECTIONS {
            return (equilibrium, corrections);
        }
        let mut ours = vec![Vec3::zeros(); positions.len()];
        pressure::add_gradient(&valve.model.faces, valve.model.pressure_mpa, positions, &mut ours);
        let theirs = their_pressure_n(valve, positions);
        let missing = theirs
            .iter()
            .zip(&ours)
            .map(|(theirs, minus_ours)| theirs + minus_ours);
        valve.model.dead_loads_n = missing
            .enumerate()
            .map(|(node, force)| (node as u32, force))
            .collect();
        last = Some(positions.clone());
        closed = equilibrium.state;
    }
    unreachable!("corrections are bounded")
}

fn farthest(one: &[Vec3], other: &[Vec3]) -> f64 {
    one.iter()
        .zip(other)
        .map(|(a, b)| (a - b).norm())
        .fold(0.0, f64::max)
}

/// 1e-3 mm: their tables have nine digits and their own residual leaves less; what moves by 7 to 8 mm must come back to it.
#[test]
#[allow(clippy::print_stderr, reason = "measured figures are what the run is for")]
fn equilibria_of_an_independent_mass_spring_code_are_returned() {
    let Some(folder) = shared("kaiser_mitral") else {
        return;
    };
    for case in ["ct_32", "ct_64", "normal1_32", "normal1_64"] {
        let mut valve = valve(&folder.join(case));
        let moved = farthest(&valve.model.rest_mm, &valve.closed_mm);
        let start = std::time::Instant::now();
        let (equilibrium, closures) = close(&mut valve);
        let off = farthest(&equilibrium.state.positions_mm, &valve.closed_mm);
        eprintln!(
            "{case}: farthest node {off:.1e} mm off, after moving by {moved:.1} mm; {closures} closures, {:.0} ms",
            start.elapsed().as_secs_f64() * 1e3
        );
        assert!(off < 1e-3, "{case}: {off} mm");
    }
}

//! A human tricuspid valve closed by Abaqus, node by node: the healthy "Texas `TriValve`" 1.1 (Mathur et al., Engineering with
//! Computers 2022, doi 10.1007/s00366-022-01659-w, CC BY 4.0). Shells of an exponential law, branching chordae that begin
//! slack, an annulus that moves, contact.
//!
//! Two things are not what the input says at first sight, and the published closed state tells which way they are:
//!
//! * Tissue. Its volumetric term, D = 20 /MPa, would let it thin so much that at the published strains it bore 0.37 of the
//!   pressure, median over all nodes free of contact and chordae; without volume change it bears 0.77
//!   ([`the_published_state_is_that_of_incompressible_tissue`]). Stress grows by a factor of two within 1.5 % of strain here.
//! * Contact. `MAXRATIO=0.6` on the surfaces lets shells be no thicker for contact than 0.6 of their edges: 0.24 mm, not
//!   the 0.65 mm of the section. Published nodes in contact are 0.25 mm apart (median).

mod laws;
mod published;

use coapt::Vec3;
use coapt::coarsen::coarsen;
use coapt::contact::gather::PairList;
use coapt::contact::pairs::{Place, rigid_fraction};
use coapt::contact::surface::Surface;
use coapt::contact::touch::touches;
use coapt::measure::{VisibleDistance, in_contact, measure, visible_distance};
use coapt::model::Model;
use coapt::relax::{Equilibrium, load, relax};
use coapt::scene::Scene;
use coapt::state::State;

use laws::{COMPRESSIBILITY_PER_MPA, springs, tissue};
use published::{Published, published};

fn built(scene: &Scene) -> Model {
    Model::build(scene)
        .unwrap_or_else(|faults| panic!("{faults:#?}"))
        .model
}

/// Area of the leaflets in contact [mm²], by the library's own rule, a third of each face for each corner: both leaflets.
fn contact_area_mm2(model: &Model, positions: &[Vec3]) -> f64 {
    area_of_mm2(model, positions, &in_contact(model, positions))
}

/// Which vertices are nearer to other tissue than the contact distance, folds included: what Abaqus flags.
fn touching(model: &Model, positions: &[Vec3]) -> Vec<bool> {
    let surface = Surface::new(&model.faces, &model.rest_mm);
    let thickness_mm = model.contact.thickness_mm;
    let place = Place {
        surface: &surface,
        rest_mm: &model.rest_mm,
        positions_mm: positions,
        thickness_mm,
        rigid_fraction: rigid_fraction(&surface, thickness_mm),
        kept_fraction: 0.0,
    };
    let mut pairs = Vec::new();
    PairList::default().gather(&place, &vec![Vec3::zeros(); positions.len()], &mut pairs);
    let mut touching = vec![false; positions.len()];
    for touch in touches(&pairs, positions) {
        touch
            .pair
            .vertices
            .iter()
            .for_each(|&vertex| touching[vertex as usize] = true);
    }
    touching
}

fn area_of_mm2(model: &Model, positions: &[Vec3], touching: &[bool]) -> f64 {
    let share = |face: &[u32; 3]| {
        let [a, b, c] = face.map(|vertex| positions[vertex as usize]);
        let corners = face.iter().filter(|&&vertex| touching[vertex as usize]).count();
        0.5 * (b - a).cross(&(c - a)).norm() * corners as f64 / 3.0
    };
    model.faces.iter().map(share).sum()
}

/// What a closure is against Abaqus'.
struct Against {
    equilibrium: Equilibrium,
    distance: VisibleDistance,
    contact_area_ratio: f64,
}

#[allow(clippy::print_stderr, reason = "the table is what the run is for")]
fn against(name: &str, model: &Model, full: &Model, closed_mm: &[Vec3]) -> Against {
    let start = std::time::Instant::now();
    let equilibrium = relax(model, &State::open(model));
    let seconds = start.elapsed().as_secs_f64();
    let positions = &equilibrium.state.positions_mm;
    let distance = visible_distance(model, positions, full, closed_mm).expect("both have an annulus");
    let contact_area_ratio = contact_area_mm2(model, positions) / contact_area_mm2(full, closed_mm);
    let measures = measure(model, positions, &equilibrium.reactions_n);
    eprintln!(
        "{name}: {} faces, {:?}, {} iterations, {seconds:.1} s; visible surface {:.3} mm RMS, 95 % {:.3}, largest {:.2}; \
         contact area {:.0} mm2 of both leaflets, {:.2} of Abaqus'; chordae {:.3} N at most, {:.2} N together",
        model.faces.len(),
        equilibrium.status,
        equilibrium.history.len(),
        distance.rms_mm,
        distance.p95_mm,
        distance.max_mm,
        contact_area_mm2(model, positions),
        contact_area_ratio,
        measures.chords.max_force_n,
        measures.chords.total_force_n,
    );
    Against {
        equilibrium,
        distance,
        contact_area_ratio,
    }
}

fn assert_near(row: &Against, rms_mm: f64, p95_mm: f64) {
    let Against {
        equilibrium,
        distance,
        ..
    } = row;
    assert!(
        equilibrium.certificate.is_certified(equilibrium.status),
        "{:?}",
        equilibrium.certificate
    );
    assert!(
        distance.rms_mm < rms_mm && distance.p95_mm < p95_mm,
        "{distance:?}"
    );
}

/// With the published law as a membrane the visible surface comes to within 0.5 mm (root mean square) on a mesh of about
/// 2,000 triangles; all of it (`COAPT_TEXAS=1`, some minutes): within 0.3 mm and 0.8 mm on 95 % of the area on the published mesh,
/// contact area within 15 %. Chordae bear what the pressure leaves them: 4 N act on the leaflets, of which the annulus takes
/// most, and no chord bears more than a tenth of that. The springs and the compressible tissue are for comparison.
#[test]
#[allow(clippy::print_stderr, reason = "the table is what the run is for")]
fn a_tricuspid_valve_closes_as_in_abaqus() {
    let Some(published) = published() else {
        return;
    };
    let full = built(&published.scene(|leaflet| tissue(leaflet, 0.0)));
    let closed_mm = published.closed_mm(&full);
    let thinned = |model: &Model| coarsen(model, 1050).expect("the mesh can be thinned").model;
    let coarse = against("membrane, incompressible", &thinned(&full), &full, &closed_mm);
    assert_near(&coarse, 0.5, 1.5);
    // Which 0.45 mm of the compressible law, and 0.9 mm of springs, would not be.
    assert!(coarse.distance.rms_mm < 0.2, "{:?}", coarse.distance);
    if std::env::var_os("COAPT_TEXAS").is_none() {
        return;
    }
    let fine = against("membrane, incompressible", &full, &full, &closed_mm);
    assert_near(&fine, 0.3, 0.8);
    assert!(
        (fine.contact_area_ratio - 1.0).abs() < 0.15,
        "{}",
        fine.contact_area_ratio
    );
    let positions = &fine.equilibrium.state.positions_mm;
    let ours = published.flagged_area_mm2(&full, positions, &touching(&full, positions));
    eprintln!("quads with three corners in contact: {ours:.0} mm2; quoted of Abaqus: 462 mm2");
    assert!((ours / 462.0 - 1.0).abs() < 0.15, "{ours} mm2");
    let most = measure(
        &full,
        &fine.equilibrium.state.positions_mm,
        &fine.equilibrium.reactions_n,
    )
    .chords
    .max_force_n;
    assert!((0.02..0.4).contains(&most), "{most} N");
    for (name, model) in [
        ("springs fitted to it", built(&published.scene(springs))),
        (
            "membrane, compressible as the input",
            built(&published.scene(|leaflet| tissue(leaflet, COMPRESSIBILITY_PER_MPA))),
        ),
    ] {
        for model in [&thinned(&model), &model] {
            let Against {
                equilibrium,
                distance,
                ..
            } = against(name, model, &full, &closed_mm);
            assert!(
                distance.rms_mm > 2.0 * coarse.distance.rms_mm,
                "{name}: {distance:?}"
            );
            assert!(equilibrium.certificate.is_certified(equilibrium.status), "{name}");
        }
    }
}

/// On nodes where nothing but tissue and pressure acts, the part of the pressure that the law bears at the published
/// strains, along the pressure, median of all.
fn borne(published: &Published, compressibility_per_mpa: f64) -> (f64, usize) {
    let mut model = built(&published.scene(|leaflet| tissue(leaflet, compressibility_per_mpa)));
    let closed_mm = published.closed_mm(&model);
    let contact = published.is_in_contact(&model);
    let mut alone = vec![true; model.rest_mm.len()];
    let with_chords = model.chords.points.iter().flatten().map(|&(vertex, _)| vertex);
    with_chords.for_each(|vertex| alone[vertex as usize] = false);
    model
        .prescribed
        .iter()
        .for_each(|held| alone[held.vertex as usize] = false);
    for vertex in 0..model.leaflet_vertex_count {
        alone[vertex] &= !contact[vertex];
    }
    let lonely = alone.clone();
    for face in model
        .faces
        .iter()
        .filter(|face| face.iter().any(|&vertex| !lonely[vertex as usize]))
    {
        face.iter().for_each(|&vertex| alone[vertex as usize] = false);
    }
    let pressed = load::gradient(&model, &[], &closed_mm);
    model.pressure_mpa = 0.0;
    let tissue_alone = load::gradient(&model, &[], &closed_mm);
    let mut parts: Vec<f64> = (0..model.leaflet_vertex_count)
        .filter(|&vertex| alone[vertex])
        .map(|vertex| {
            let pressure = pressed[vertex] - tissue_alone[vertex];
            -tissue_alone[vertex].dot(&pressure) / pressure.norm_squared()
        })
        .collect();
    parts.sort_by(f64::total_cmp);
    (parts[parts.len() / 2], parts.len())
}

/// In balance all of it would be borne: 1. Incompressible tissue comes near, tissue as compressible as the input says does not.
/// What is left, 0.23, is a strain of a hundredth: stress doubles within 1.5 % of strain. Dynamics and shells instead of
/// membranes may have their part in it.
#[test]
#[allow(clippy::print_stderr, reason = "measured figures are what the run is for")]
fn the_published_state_is_that_of_incompressible_tissue() {
    let Some(published) = published() else {
        return;
    };
    let (incompressible, count) = borne(&published, 0.0);
    let (compressible, _) = borne(&published, COMPRESSIBILITY_PER_MPA);
    eprintln!(
        "pressure borne at {count} nodes: {incompressible:.2} incompressible, {compressible:.2} compressible"
    );
    assert!((0.7..1.1).contains(&incompressible) && compressible < 0.5);
}

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

use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

use coapt::Vec3;
use coapt::coarsen::coarsen;
use coapt::contact::gather::PairList;
use coapt::contact::pairs::{Place, rigid_fraction};
use coapt::contact::surface::Surface;
use coapt::contact::touch::touches;
use coapt::energy::membrane::{Law, exponential};
use coapt::measure::{VisibleDistance, in_contact, measure, visible_distance};
use coapt::model::Model;
use coapt::relax::{Equilibrium, load, relax};
use coapt::scene::{
    Annulus, ChordGroup, ChordLaw, Contact, Leaflet, LineMesh, Load, PapillaryMuscle, Scene, Settings, Space,
    SpringBranches, SurfaceMesh, Tissue, Weld, Wrinkling,
};
use coapt::state::State;
use coapt::tissue_fit::{bilinear_from_curve, curve::curve_of_law};

/// Shell thickness [mm], and the largest that contact makes of it.
const THICKNESS_MM: f64 = 0.65;
const CONTACT_THICKNESS_MM: f64 = 0.24;
const PRESSURE_KPA: f64 = 3.06;
/// D of the input [1/MPa].
const COMPRESSIBILITY_PER_MPA: f64 = 20.066_89;
const C0_MPA: f64 = 0.001;

/// C₁ [MPa] and C₂ [1] of each leaflet.
fn constants(leaflet: &str) -> (f64, f64) {
    match leaflet {
        "anterior" => (0.000_124, 4.568_202),
        "posterior" => (0.000_188, 14.859_590),
        "septal" => (0.000_191, 17.751_490),
        other => panic!("no leaflet {other}"),
    }
}

/// Ogden's μ [MPa] and α of each group of chordae.
fn ogden(group: &str) -> [(f64, f64); 3] {
    match group {
        "anterior" => [
            (18.884_147_8, 98.253_655_1),
            (22.682_992_3, 98.251_894_4),
            (19.502_933_9, 98.253_228_7),
        ],
        "posterior" => [
            (4.241_553_98, 55.914_887_2),
            (2.724_796_15, 55.915_477_2),
            (3.726_567_4e-5, 70.715_073_2),
        ],
        "septal" => [
            (33.753_478_5, 1.531_670_654e-4),
            (1.459_628_6e-5, 3.488_130_193e-4),
            (0.020_343_017, 113.447_386_7),
        ],
        other => panic!("no chordae {other}"),
    }
}

/// Nominal stress of incompressible Ogden tissue under uniaxial stretch s: Σ 2μ/α (s^(α−1) − s^(−α/2−1)), to 3 % strain.
fn chord_law(group: &str) -> ChordLaw {
    let strain: Vec<f64> = (0..=30).map(|point| f64::from(point) * 1e-3).collect();
    let stress = |strain: &f64| {
        let stretch = 1.0 + strain;
        let term = |(mu, alpha): (f64, f64)| {
            2.0 * mu / alpha * (stretch.powf(alpha - 1.0) - stretch.powf(-0.5 * alpha - 1.0))
        };
        ogden(group).into_iter().map(term).sum::<f64>()
    };
    ChordLaw::Table {
        stress_mpa: strain.iter().map(stress).collect(),
        strain,
    }
}

fn tissue(leaflet: &str, compressibility_per_mpa: f64) -> Tissue {
    let (c1_mpa, c2) = constants(leaflet);
    Tissue::Exponential {
        c0_mpa: C0_MPA,
        c1_mpa,
        c2,
        compressibility_per_mpa,
        wrinkling: Wrinkling::TensionField,
        // Of the order of the tangent modulus of unloaded tissue, 3 C₀.
        bending_modulus_mpa: 0.01,
    }
}

/// Springs fitted to the same law under equibiaxial tension, up to the published 99th percentile of stress.
fn springs(leaflet: &str) -> Tissue {
    const WORKING_STRESS_MPA: f64 = 0.152;
    let (c1_mpa, c2) = constants(leaflet);
    let law = Law::Exponential(exponential::Constants {
        c0_mpa: C0_MPA,
        c1_mpa,
        c2,
        compressibility_per_mpa: 0.0,
    });
    fitted(&law, WORKING_STRESS_MPA)
}

type Row = HashMap<String, String>;

fn table(path: &Path) -> Vec<Row> {
    let text = std::fs::read_to_string(path).expect("the folder holds its tables");
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().expect("a head").split(',').collect();
    let row = |line: &str| {
        let cells = line.split(',').map(str::to_owned);
        names.iter().map(|name| (*name).to_owned()).zip(cells).collect()
    };
    lines.map(row).collect()
}

fn number(row: &Row, name: &str) -> f64 {
    row[name].parse().unwrap_or(0.0)
}

fn place(row: &Row, names: [&str; 3]) -> [f64; 3] {
    names.map(|name| number(row, name))
}

/// The tables, read.
struct Published {
    nodes: Vec<Row>,
    quads: Vec<Row>,
    chords: Vec<Row>,
}

fn published() -> Option<Published> {
    let folder: PathBuf =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/texas_trivalve_healthy");
    let read = |name: &str| table(&folder.join(name));
    folder.is_dir().then(|| Published {
        nodes: read("healthy_nodes.csv"),
        quads: read("healthy_quads.csv"),
        chords: read("healthy_chords.csv"),
    })
}

const OPEN: [&str; 3] = ["x0_mm", "y0_mm", "z0_mm"];
const CLOSED: [&str; 3] = ["x20_mm", "y20_mm", "z20_mm"];

impl Published {
    fn scene(&self, tissue: impl Fn(&str) -> Tissue) -> Scene {
        let mut faces: BTreeMap<String, Vec<[u32; 3]>> = BTreeMap::new();
        for quad in &self.quads {
            let corners = ["a", "b", "c", "d"].map(|name| number(quad, name) as u32);
            faces
                .entry(quad["leaflet"].clone())
                .or_default()
                .extend(self.halves(corners));
        }
        let leaflet = |(name, faces): (String, Vec<[u32; 3]>)| Leaflet {
            tissue: tissue(&name),
            mesh: Some(self.mesh(faces)),
            name,
            mesh_file: None,
            region: None,
            thickness_mm: THICKNESS_MM,
        };
        Scene {
            schema_version: 1,
            name: "Texas TriValve healthy".into(),
            space: Space::LPS,
            leaflets: faces.into_iter().map(leaflet).collect(),
            annulus: Annulus::default(),
            papillary: vec![PapillaryMuscle {
                name: "all".into(),
                tips_mm: self.tips(),
                tips_file: None,
                displacements_mm: vec![],
            }],
            chordae: self.chord_groups(),
            load: Load {
                pressure_mmhg: None,
                pressure_kpa: Some(PRESSURE_KPA),
            },
            contact: Contact {
                thickness_mm: CONTACT_THICKNESS_MM,
                stiffness_mpa: 0.5,
            },
            landmarks: Default::default(),
            weld: Weld {
                tolerance_mm: 1e-6,
                insertion_tolerance_mm: 1e-6,
            },
            settings: Settings {
                residual_tolerance: 1e-3,
                ..Settings::default()
            },
        }
    }

    /// A quad cut along its shorter diagonal; one with a corner twice is a triangle.
    fn halves(&self, [a, b, c, d]: [u32; 4]) -> Vec<[u32; 3]> {
        if c == d {
            return vec![[a, b, c]];
        }
        let [p, q, r, s] = [a, b, c, d].map(|node| Vec3::from(place(&self.nodes[node as usize], OPEN)));
        if (p - r).norm() <= (q - s).norm() {
            vec![[a, b, c], [a, c, d]]
        } else {
            vec![[a, b, d], [b, c, d]]
        }
    }

    /// The nodes of some faces, numbered anew.
    fn mesh(&self, faces: Vec<[u32; 3]>) -> SurfaceMesh {
        let mut used: Vec<u32> = faces.iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        let local = |node: &u32| used.binary_search(node).unwrap_or(0) as u32;
        let rows = || used.iter().map(|&node| &self.nodes[node as usize]);
        SurfaceMesh {
            points_mm: rows().map(|row| place(row, OPEN)).collect(),
            faces: faces
                .iter()
                .map(|face| [local(&face[0]), local(&face[1]), local(&face[2])])
                .collect(),
            annulus_points: Some(
                (0..used.len() as u32)
                    .filter(|&at| self.nodes[used[at as usize] as usize]["annulus"] == "1")
                    .collect(),
            ),
            annulus_displacement_mm: Some(
                rows()
                    .map(|row| place(row, ["dx_mm", "dy_mm", "dz_mm"]))
                    .collect(),
            ),
        }
    }

    fn tips(&self) -> Vec<[f64; 3]> {
        let tips = self.nodes.iter().filter(|row| row["bc"] == "papillary");
        tips.map(|row| place(row, OPEN)).collect()
    }

    fn chord_groups(&self) -> Vec<ChordGroup> {
        let mut groups: BTreeMap<&str, (LineMesh, HashMap<u32, u32>)> = BTreeMap::new();
        for chord in &self.chords {
            let (mesh, numbers) = groups.entry(&chord["group"]).or_default();
            let ends = ["a", "b"].map(|name| {
                let node = number(chord, name) as u32;
                *numbers.entry(node).or_insert_with(|| {
                    mesh.points_mm.push(place(&self.nodes[node as usize], OPEN));
                    mesh.points_mm.len() as u32 - 1
                })
            });
            mesh.segments.push(ends);
            mesh.rest_length_mm
                .get_or_insert_default()
                .push(number(chord, "rest_mm"));
            mesh.area_mm2
                .get_or_insert_default()
                .push(number(chord, "area_mm2"));
        }
        let group = |(name, (mesh, _)): (&str, (LineMesh, HashMap<u32, u32>))| ChordGroup {
            name: name.into(),
            mesh_file: None,
            mesh: Some(mesh),
            diameter_mm: 1.0,
            modulus_mpa: 30.0,
            law: Some(chord_law(name)),
            rest_length_scale: 1.0,
            insertion_radius_mm: 0.0,
        };
        groups.into_iter().map(group).collect()
    }

    /// Where Abaqus put each vertex of a model made of these tables, by the place where it began.
    fn closed_mm(&self, model: &Model) -> Vec<Vec3> {
        let key = |p: Vec3| [p.x, p.y, p.z].map(|x| (x * 1e5).round() as i64);
        let places = self
            .nodes
            .iter()
            .map(|row| (key(place(row, OPEN).into()), Vec3::from(place(row, CLOSED))));
        let closed: HashMap<[i64; 3], Vec3> = places.collect();
        model.rest_mm.iter().map(|p| closed[&key(*p)]).collect()
    }

    fn is_in_contact(&self) -> HashMap<[i64; 3], bool> {
        let key = |p: [f64; 3]| p.map(|x| (x * 1e5).round() as i64);
        self.nodes
            .iter()
            .map(|row| (key(place(row, OPEN)), row["contact20"] == "1"))
            .collect()
    }
}

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

/// Area of the quads of which at least three corners are flagged [mm²]: by this rule Abaqus' own flags cover 469 mm², of
/// which 462 are quoted with the data.
fn flagged_area_mm2(published: &Published, model: &Model, positions: &[Vec3], flagged: &[bool]) -> f64 {
    let key = |p: Vec3| [p.x, p.y, p.z].map(|x| (x * 1e5).round() as i64);
    let vertices = 0..model.leaflet_vertex_count;
    let vertex_at: HashMap<[i64; 3], usize> = vertices
        .map(|vertex| (key(model.rest_mm[vertex]), vertex))
        .collect();
    let area = |quad: &Row| {
        let [a, b, c, d] = ["a", "b", "c", "d"].map(|name| {
            let node = &published.nodes[number(quad, name) as usize];
            vertex_at[&key(place(node, OPEN).into())]
        });
        let at = |vertex: usize| positions[vertex];
        let half = |p: usize, q: usize, r: usize| 0.5 * (at(q) - at(p)).cross(&(at(r) - at(p))).norm();
        let corners = [a, b, c, d].iter().filter(|&&corner| flagged[corner]).count();
        if corners >= 3 {
            half(a, b, c) + half(a, c, d)
        } else {
            0.0
        }
    };
    published.quads.iter().map(area).sum()
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
    seconds: f64,
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
        seconds,
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

fn fitted(law: &Law, most_mpa: f64) -> Tissue {
    let curve = curve_of_law(law, [1.0, 1.0], most_mpa, 60);
    let fit =
        bilinear_from_curve(&curve, [0.0, most_mpa], 1.0).unwrap_or_else(|faults| panic!("{faults:#?}"));
    let SpringBranches {
        pre_transition_modulus_mpa,
        transition_strain,
        post_transition_modulus_mpa,
    } = fit.circumferential;
    Tissue::BilinearSprings {
        pre_transition_modulus_mpa,
        transition_strain,
        post_transition_modulus_mpa,
        compression_modulus_ratio: 1.0,
        // As the membranes have: 0.01 MPa.
        bending_modulus_ratio: 0.01 / pre_transition_modulus_mpa,
    }
}

/// With the published law as a membrane the visible surface comes to within 0.5 mm (root mean square) on a mesh of about
/// 2,000 triangles; all of it (`COAPT_TEXAS=1`, some minutes): within 0.3 mm and 0.8 mm on 95 % of the area on the published mesh,
/// contact area within 15 %. Chordae bear what the pressure leaves them: 4 N act on the leaflets, of which the annulus takes
/// most, and no chord bears more than a tenth of that. The springs and the compressible tissue are for comparison.
#[test]
#[allow(clippy::print_stderr, reason = "the table is what the run is for")]
fn a_tricuspid_valve_closes_as_in_abaqus() {
    let Some(published) = published() else {
        eprintln!("skipped: ../shared not present");
        return;
    };
    let full = built(&published.scene(|leaflet| tissue(leaflet, 0.0)));
    let closed_mm = published.closed_mm(&full);
    let thinned = |model: &Model| coarsen(model, 1050).expect("the mesh can be thinned").model;
    let coarse = against("membrane, incompressible", &thinned(&full), &full, &closed_mm);
    assert_near(&coarse, 0.5, 1.5);
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
    let ours = flagged_area_mm2(&published, &full, positions, &touching(&full, positions));
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
            let Against { equilibrium, .. } = against(name, model, &full, &closed_mm);
            assert!(equilibrium.certificate.is_certified(equilibrium.status), "{name}");
        }
    }
    eprintln!("longest: {:.1} s", coarse.seconds.max(fine.seconds));
}

/// On nodes where nothing but tissue and pressure acts, the part of the pressure that the law bears at the published
/// strains, along the pressure, median of all.
fn borne(published: &Published, compressibility_per_mpa: f64) -> (f64, usize) {
    let mut model = built(&published.scene(|leaflet| tissue(leaflet, compressibility_per_mpa)));
    let closed_mm = published.closed_mm(&model);
    let contact = published.is_in_contact();
    let key = |p: Vec3| [p.x, p.y, p.z].map(|x| (x * 1e5).round() as i64);
    let mut alone = vec![true; model.rest_mm.len()];
    let with_chords = model.chords.points.iter().flatten().map(|&(vertex, _)| vertex);
    with_chords.for_each(|vertex| alone[vertex as usize] = false);
    model
        .prescribed
        .iter()
        .for_each(|held| alone[held.vertex as usize] = false);
    for vertex in 0..model.leaflet_vertex_count {
        alone[vertex] &= !contact[&key(model.rest_mm[vertex])];
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
        eprintln!("skipped: ../shared not present");
        return;
    };
    let (incompressible, count) = borne(&published, 0.0);
    let (compressible, _) = borne(&published, COMPRESSIBILITY_PER_MPA);
    eprintln!(
        "pressure borne at {count} nodes: {incompressible:.2} incompressible, {compressible:.2} compressible"
    );
    assert!((0.7..1.1).contains(&incompressible) && compressible < 0.5);
}

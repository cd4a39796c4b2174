//! Models of plain shapes, as verification and the gallery of hard cases need them: tissue on a mesh, and who is held.

mod meshes;

use coapt::Vec3;
use coapt::energy::membrane::{self, Membranes};
use coapt::energy::{bilinear_spring::Springs, chord::Chords};
use coapt::mesh::topology;
use coapt::model::{AnnulusLandmarks, LeafletTissue, Model, Prescribed};
use coapt::scene::{Contact, Settings, Tissue};

pub(crate) use meshes::{Mesh, bag, cap, disk, lattice, sphere};

/// A membrane of edge springs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SpringTissue {
    /// Thickness times the modulus below the knee [N/mm].
    pub(crate) soft_n_per_mm: f64,
    /// Thickness times the modulus beyond it [N/mm].
    pub(crate) stiff_n_per_mm: f64,
    /// Strain at the knee [1].
    pub(crate) knee: f64,
    /// Modulus in compression over that below the knee [1].
    pub(crate) compression_ratio: f64,
}

impl SpringTissue {
    /// The same stiffness in stretch and compression.
    pub(crate) fn linear(stiffness_n_per_mm: f64) -> Self {
        Self {
            soft_n_per_mm: stiffness_n_per_mm,
            stiff_n_per_mm: stiffness_n_per_mm,
            knee: 1.0,
            compression_ratio: 1.0,
        }
    }
}

/// One spring per edge; each face next to it adds E h A / L² (Van Gelder 1998), as `Model::build` does.
pub(crate) fn springs(mesh: &Mesh, tissue: SpringTissue) -> Springs {
    let edges = topology::edges(&mesh.faces);
    let at = |vertex: u32| mesh.points_mm[vertex as usize];
    let mut springs = Springs::default();
    for (edge, &[a, b]) in edges.ends.iter().enumerate() {
        let length = (at(a) - at(b)).norm();
        let area = |&face: &u32| {
            let [p, q, r] = mesh.faces[face as usize].map(at);
            0.5 * (q - p).cross(&(r - p)).norm()
        };
        let width: f64 = edges.faces_of(edge).iter().map(area).sum::<f64>() / (length * length);
        springs.ends.push([a, b]);
        springs.rest_length_mm.push(length);
        springs.transition_length_mm.push(length * (1.0 + tissue.knee));
        springs.soft_n_per_mm.push(tissue.soft_n_per_mm * width);
        springs.stiff_n_per_mm.push(tissue.stiff_n_per_mm * width);
        springs
            .compression_n_per_mm
            .push(tissue.compression_ratio * tissue.soft_n_per_mm * width);
    }
    springs
}

/// Adds a spring that is the same in stretch and compression.
pub(crate) fn add_spring(springs: &mut Springs, ends: [u32; 2], length_mm: f64, stiffness_n_per_mm: f64) {
    springs.ends.push(ends);
    springs.rest_length_mm.push(length_mm);
    springs.transition_length_mm.push(2.0 * length_mm);
    springs.soft_n_per_mm.push(stiffness_n_per_mm);
    springs.stiff_n_per_mm.push(stiffness_n_per_mm);
    springs.compression_n_per_mm.push(stiffness_n_per_mm);
}

/// A model of nothing but a mesh under pressure: no tissue, no chords, nothing held, nothing touches. One mesh only: the coarse ones that open valves are closed on first are made for leaflets.
pub(crate) fn bare(mesh: &Mesh, pressure_mpa: f64) -> Model {
    Model {
        name: "verification".into(),
        leaflet_vertex_count: mesh.points_mm.len(),
        rest_mm: mesh.points_mm.clone(),
        faces: mesh.faces.clone(),
        face_leaflet: vec![0; mesh.faces.len()],
        leaflets: vec![LeafletTissue {
            name: "sheet".into(),
            thickness_mm: 1.0,
            tissue: Tissue::default(),
        }],
        springs: Springs::default(),
        membranes: Membranes::default(),
        hinges: Default::default(),
        chords: Chords::default(),
        chord_groups: vec![],
        pressure_mpa,
        dead_loads_n: vec![],
        contact: Contact {
            stiffness_mpa: 0.0,
            ..Contact::default()
        },
        annulus: vec![],
        margins: vec![],
        papillary: vec![],
        landmarks: AnnulusLandmarks {
            commissure_anterolateral: 0,
            trigone_left: 0,
            mid_anterior: 0,
            trigone_right: 0,
            commissure_posteromedial: 0,
            mid_posterior: 0,
        },
        prescribed: vec![],
        settings: Settings {
            coarse_to_fine: false,
            ..Settings::default()
        },
    }
}

/// [`bare`] with a spring on every edge.
pub(crate) fn sprung(mesh: &Mesh, tissue: SpringTissue, pressure_mpa: f64) -> Model {
    Model {
        springs: springs(mesh, tissue),
        ..bare(mesh, pressure_mpa)
    }
}

/// [`bare`] with a triangle of membrane on every face, fibres along x.
pub(crate) fn skinned(mesh: &Mesh, tissue: membrane::Tissue, thickness_mm: f64, pressure_mpa: f64) -> Model {
    let mut model = bare(mesh, pressure_mpa);
    model.membranes.tissues.push(tissue);
    for &face in &mesh.faces {
        model
            .membranes
            .push(face, 0, thickness_mm, &mesh.points_mm, Vec3::x());
    }
    model
}

/// Holds vertices where they are at rest.
pub(crate) fn hold(model: &mut Model, vertices: &[u32]) {
    let held = |&vertex: &u32| Prescribed {
        vertex,
        target_mm: model.rest_mm[vertex as usize],
    };
    model.prescribed = vertices.iter().map(held).collect();
    model.prescribed.sort_by_key(|held| held.vertex);
}

pub(crate) fn st_venant_kirchhoff(modulus_mpa: f64, poisson_ratio: f64) -> membrane::Law {
    membrane::Law::StVenantKirchhoff(membrane::st_venant_kirchhoff::Constants {
        modulus_mpa,
        poisson_ratio,
    })
}

/// Incompressible: Young's modulus is three times C₀.
pub(crate) fn neo_hookean(c0_mpa: f64) -> membrane::Law {
    membrane::Law::Exponential(membrane::exponential::Constants {
        c0_mpa,
        c1_mpa: 0.0,
        c2: 1.0,
        compressibility_per_mpa: 0.0,
    })
}

pub(crate) fn taut(law: membrane::Law) -> membrane::Tissue {
    membrane::Tissue { law, wrinkles: false }
}

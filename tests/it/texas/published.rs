//! The published tables, and the scene that they make.

use std::collections::{BTreeMap, HashMap};

use coapt::Vec3;
use coapt::model::Model;
use coapt::scene::{
    Annulus, ChordGroup, Contact, Leaflet, LineMesh, Load, PapillaryMuscle, Scene, Settings, Space,
    SurfaceMesh, Tissue, Weld,
};

use super::laws::chord_law;
use crate::tables::{Row, number, point, shared, table};

/// Shell thickness [mm], and the largest that contact makes of it.
const THICKNESS_MM: f64 = 0.65;
const CONTACT_THICKNESS_MM: f64 = 0.24;
const PRESSURE_KPA: f64 = 3.06;

/// The tables, read.
pub(super) struct Published {
    nodes: Vec<Row>,
    quads: Vec<Row>,
    chords: Vec<Row>,
}

pub(super) fn published() -> Option<Published> {
    let folder = shared("texas_trivalve_healthy")?;
    let read = |name: &str| table(&folder.join(name));
    Some(Published {
        nodes: read("healthy_nodes.csv"),
        quads: read("healthy_quads.csv"),
        chords: read("healthy_chords.csv"),
    })
}

const OPEN: [&str; 3] = ["x0_mm", "y0_mm", "z0_mm"];
const CLOSED: [&str; 3] = ["x20_mm", "y20_mm", "z20_mm"];

impl Published {
    pub(super) fn scene(&self, tissue: impl Fn(&str) -> Tissue) -> Scene {
        let mut faces: BTreeMap<String, Vec<[u32; 3]>> = BTreeMap::new();
        for quad in &self.quads {
            let corners = ["a", "b", "c", "d"].map(|name| number::<u32>(quad, name));
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
        let [p, q, r, s] = [a, b, c, d].map(|node| point(&self.nodes[node as usize], OPEN));
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
            points_mm: rows().map(|row| point(row, OPEN).into()).collect(),
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
                    .map(|row| point(row, ["dx_mm", "dy_mm", "dz_mm"]).into())
                    .collect(),
            ),
        }
    }

    fn tips(&self) -> Vec<[f64; 3]> {
        let tips = self.nodes.iter().filter(|row| row["bc"] == "papillary");
        tips.map(|row| point(row, OPEN).into()).collect()
    }

    fn chord_groups(&self) -> Vec<ChordGroup> {
        let mut groups: BTreeMap<&str, (LineMesh, HashMap<u32, u32>)> = BTreeMap::new();
        for chord in &self.chords {
            let (mesh, numbers) = groups.entry(&chord["group"]).or_default();
            let ends = ["a", "b"].map(|name| {
                let node = number::<u32>(chord, name);
                *numbers.entry(node).or_insert_with(|| {
                    mesh.points_mm
                        .push(point(&self.nodes[node as usize], OPEN).into());
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
            modulus_mpa: None,
            law: Some(chord_law(name)),
            rest_length_scale: 1.0,
            insertion_radius_mm: 0.0,
        };
        groups.into_iter().map(group).collect()
    }

    /// The node that each vertex of a model made of these tables is, by the place where it began.
    fn nodes_of(&self, model: &Model) -> Vec<usize> {
        let key = |p: Vec3| [p.x, p.y, p.z].map(|x| (x * 1e5).round() as i64);
        // Chordae have nodes of their own where they meet a leaflet; the leaflet's come first, and stay.
        let places = self.nodes.iter().enumerate().rev();
        let node_at: HashMap<[i64; 3], usize> =
            places.map(|(node, row)| (key(point(row, OPEN)), node)).collect();
        model.rest_mm.iter().map(|place| node_at[&key(*place)]).collect()
    }

    /// Where Abaqus put each vertex [mm].
    pub(super) fn closed_mm(&self, model: &Model) -> Vec<Vec3> {
        let nodes = self.nodes_of(model).into_iter();
        nodes.map(|node| point(&self.nodes[node], CLOSED)).collect()
    }

    /// Whether Abaqus flags each vertex as in contact.
    pub(super) fn is_in_contact(&self, model: &Model) -> Vec<bool> {
        let nodes = self.nodes_of(model).into_iter();
        nodes.map(|node| self.nodes[node]["contact20"] == "1").collect()
    }

    /// Area of the quads of which at least three corners are flagged [mm²]: by this rule Abaqus' own flags cover 469 mm², of
    /// which 462 are quoted with the data.
    pub(super) fn flagged_area_mm2(&self, model: &Model, positions: &[Vec3], flagged: &[bool]) -> f64 {
        let mut vertex_of = vec![0; self.nodes.len()];
        for (vertex, node) in self
            .nodes_of(model)
            .into_iter()
            .enumerate()
            .take(model.leaflet_vertex_count)
        {
            vertex_of[node] = vertex;
        }
        let area = |quad: &Row| {
            let [a, b, c, d] = ["a", "b", "c", "d"].map(|name| vertex_of[number::<usize>(quad, name)]);
            let at = |vertex: usize| positions[vertex];
            let half = |p: usize, q: usize, r: usize| 0.5 * (at(q) - at(p)).cross(&(at(r) - at(p))).norm();
            let corners = [a, b, c, d].iter().filter(|&&corner| flagged[corner]).count();
            if corners >= 3 {
                half(a, b, c) + half(a, c, d)
            } else {
                0.0
            }
        };
        self.quads.iter().map(area).sum()
    }
}

//! The coarse model: the fine one's parts in new numbers.

use super::Prolongation;
use super::thin::{NONE, Thinning};
use crate::Vec3;
use crate::energy::chord::{Chords, WeightedVertices};
use crate::mesh::topology;
use crate::model::elasticity::{Elasticity, Sheet, elasticity};
use crate::model::{AnnulusLandmarks, ChordKind, Margin, Model, Papillary, Prescribed};

/// A chord whose insertion moves is never made shorter than this part of its length [1]: only chords as slack as
/// they are long come near it, and a rest length must stay above 0.
const LEAST_CHORD: f64 = 0.1;

pub(super) fn assemble(
    model: &Model,
    thinning: &Thinning,
    numbers: &[u32],
    prolongation: &Prolongation,
) -> Model {
    let stands = (0..model.faces.len()).filter(|&f| thinning.faces[f][0] != NONE);
    let face_leaflet: Vec<u32> = stands.map(|f| model.face_leaflet[f]).collect();
    let rest_mm: Vec<_> = (0..numbers.len())
        .filter(|&v| numbers[v] != NONE)
        .map(|v| model.rest_mm[v])
        .collect();
    let annulus: Vec<u32> = kept(&model.annulus, numbers).collect();
    let sheet = Sheet {
        rest_mm: &rest_mm,
        faces: &prolongation.faces,
        face_leaflet: &face_leaflet,
        annulus: &annulus,
        leaflets: &model.leaflets,
    };
    let Elasticity {
        springs,
        membranes,
        hinges,
    } = elasticity(&sheet, &topology::edges(&prolongation.faces));
    let renumber = |(vertex, force): &(u32, Vec3)| (numbers[*vertex as usize], *force);
    let loads = model.dead_loads_n.iter().map(renumber);
    Model {
        name: model.name.clone(),
        leaflet_vertex_count: rest_mm.len() - (numbers.len() - model.leaflet_vertex_count),
        springs,
        membranes,
        hinges,
        faces: prolongation.faces.clone(),
        face_leaflet,
        leaflets: model.leaflets.clone(),
        chords: chords(model, prolongation, &rest_mm),
        chord_groups: model.chord_groups.clone(),
        pressure_mpa: model.pressure_mpa,
        dead_loads_n: loads.filter(|(vertex, _)| *vertex != NONE).collect(),
        contact: model.contact,
        annulus,
        margins: model.margins.iter().map(|m| margin(m, numbers)).collect(),
        papillary: model.papillary.iter().map(|m| papillary(m, numbers)).collect(),
        landmarks: landmarks(model, numbers),
        prescribed: prescribed(model, numbers),
        settings: model.settings,
        rest_mm,
    }
}

fn margin(fine: &Margin, numbers: &[u32]) -> Margin {
    Margin {
        vertices: kept(&fine.vertices, numbers).collect(),
        closed: fine.closed,
    }
}

fn papillary(fine: &Papillary, numbers: &[u32]) -> Papillary {
    Papillary {
        name: fine.name.clone(),
        tips: kept(&fine.tips, numbers).collect(),
    }
}

fn prescribed(model: &Model, numbers: &[u32]) -> Vec<Prescribed> {
    let renumber = |p: &Prescribed| Prescribed {
        vertex: numbers[p.vertex as usize],
        target_mm: p.target_mm,
    };
    let all = model.prescribed.iter().map(renumber);
    all.filter(|p| p.vertex != NONE).collect()
}

/// Each landmark goes to the nearest annulus vertex that is left, counted along the annulus.
fn landmarks(model: &Model, numbers: &[u32]) -> AnnulusLandmarks {
    let count = model.annulus.len();
    let left: Vec<usize> = (0..count)
        .filter(|&i| numbers[model.annulus[i] as usize] != NONE)
        .collect();
    let nearest = |landmark: usize| {
        let steps = |&i: &usize| {
            let steps = landmark.abs_diff(left[i]);
            steps.min(count - steps)
        };
        (0..left.len()).min_by_key(steps).unwrap_or(0)
    };
    let fine = &model.landmarks;
    AnnulusLandmarks {
        mid_anterior: nearest(fine.mid_anterior),
        mid_posterior: nearest(fine.mid_posterior),
        commissure_anterolateral: nearest(fine.commissure_anterolateral),
        commissure_posteromedial: nearest(fine.commissure_posteromedial),
        trigone_left: nearest(fine.trigone_left),
        trigone_right: nearest(fine.trigone_right),
    }
}

/// The same chords; where a vertex that shares in an insertion is gone, those stand in that carry it along, and chordae are
/// as slack as they were.
fn chords(model: &Model, prolongation: &Prolongation, coarse_rest_mm: &[Vec3]) -> Chords {
    let fine = &model.chords;
    let mut chords = fine.clone();
    chords.points = fine
        .points
        .iter()
        .map(|point| carried(point, prolongation))
        .collect();
    for (segment, &[a, b]) in fine.ends.iter().enumerate() {
        // A suture's length is that of the stitch, wherever it is set.
        if model.chord_groups[fine.group[segment] as usize].kind == ChordKind::Suture {
            continue;
        }
        let open = |chords: &Chords, rest_mm: &[Vec3]| {
            (chords.point_mm(a, rest_mm) - chords.point_mm(b, rest_mm)).norm()
        };
        let longer = open(&chords, coarse_rest_mm) - open(fine, &model.rest_mm);
        let length = fine.rest_length_mm[segment];
        chords.rest_length_mm[segment] = (length + longer).max(LEAST_CHORD * length);
    }
    chords
}

/// A weighted mean of fine vertices as one of coarse vertices.
fn carried(point: &WeightedVertices, prolongation: &Prolongation) -> WeightedVertices {
    let mut shares: WeightedVertices = Vec::new();
    for &(vertex, share) in point {
        let corners = prolongation.corners[vertex as usize];
        for (corner, weight) in corners.into_iter().zip(prolongation.weights[vertex as usize]) {
            if weight != 0.0 {
                shares.push((corner, share * weight));
            }
        }
    }
    shares.sort_by_key(|&(vertex, _)| vertex);
    shares.dedup_by(|next, first| {
        let same = next.0 == first.0;
        if same {
            first.1 += next.1;
        }
        same
    });
    shares
}

/// What is left of a list of fine vertices.
fn kept<'a>(vertices: &'a [u32], numbers: &'a [u32]) -> impl Iterator<Item = u32> + 'a {
    vertices
        .iter()
        .map(|&v| numbers[v as usize])
        .filter(|&v| v != NONE)
}

//! A piece of a leaflet cut out at its margin, and the gap sewn up.
//!
//! The piece is bounded by planes: those of a triangle go through the ends of its base and its apex and stand on the leaflet,
//! those of a quadrangle stand across the margin, and its upper border keeps a distance from the annulus. Faces are divided
//! exactly there, but for vertices nearby that come to lie on the border. The edges are not welded, for each side keeps the
//! shape it had when cut; stitches draw facing places together, from the bottom of the gap to the margin.

use std::collections::BTreeSet;

use super::excision::{GONE, Reinserted, remade};
use super::incision::{Fields, Mesh, incise, inside};
use super::leaflet::{LeafletMargin, leaflet_named};
use super::plication::plicate;
use super::resect_chords::chords_in_piece;
use super::rods::without;
use super::seam::seam;
use super::site::position;
use super::sutures::{STITCH_N_PER_MM, Sewn, sew};
use crate::Vec3;
use crate::mesh::{polyline, topology};
use crate::model::Model;
use crate::repair::{Repaired, Report};
use crate::scene::{Fault, Resect, ResectionShape};

/// How much of the height a triangle takes if nobody says [1]; usual.
const HEIGHT_FRACTION: f64 = 2.0 / 3.0;

/// What a quadrangle leaves at the annulus if nobody says [mm]; our choice, see [`Resect::strip_mm`].
const STRIP_MM: f64 = 3.0;

/// Less tissue than this between a piece and the annulus does not hold [mm] (our choice: two thicknesses).
const LEAST_STRIP_MM: f64 = 1.0;

/// What was cut out.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ResectReport {
    /// Name of the leaflet.
    pub leaflet: String,
    /// What piece.
    pub shape: ResectionShape,
    /// Share of the margin from the anterolateral commissure [1].
    pub position: f64,
    /// Width of the piece at the margin [mm].
    pub width_mm: f64,
    /// How high it is in its middle [mm].
    pub height_mm: f64,
    /// How high the leaflet is there [mm].
    pub leaflet_height_mm: f64,
    /// Area of the piece [mm²], unloaded.
    pub area_mm2: f64,
    /// Branches of chordae that were cut with it.
    pub chords_cut: usize,
    /// Length of the annulus before and after its plication [mm]; absent without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub annulus_mm: Option<[f64; 2]>,
    /// The stitches.
    #[serde(flatten)]
    pub sewn: Sewn,
}

/// Where a piece is.
struct Piece {
    leaflet: u32,
    position: f64,
    width_mm: f64,
    height_mm: f64,
    leaflet_height_mm: f64,
    /// Middle of its base [mm].
    middle_mm: Vec3,
    /// The ways up from the ends of the base, where they end at the annulus [mm].
    hinges_mm: [Vec3; 2],
    fields: Fields,
}

/// Cuts a piece out and sews the gap up.
///
/// # Errors
/// No such leaflet or site; numbers out of range; a piece that meets a commissure or the annulus, or that holds insertions of
/// chordae which are not to be cut, or an earlier repair's sutures.
pub fn resect(model: &Model, deed: &Resect) -> Result<Repaired, Vec<Fault>> {
    resected(model, deed).map_err(|fault| vec![fault])
}

fn resected(model: &Model, deed: &Resect) -> Result<Repaired, Fault> {
    let piece = piece(model, deed)?;
    let cut = chords_in_piece(model, &piece.fields, deed.cut_chords)?;
    let without_chords = without(model, &cut);
    let Excised {
        model: mut after,
        area_mm2,
        edge,
    } = excised(&without_chords, &piece)?;
    let seam = seam(&after, &edge)?;
    let annulus_mm = match deed.shape {
        ResectionShape::Triangular => None,
        ResectionShape::Quadrangular => Some(plicate(&mut after, piece.hinges_mm, "resect.width_mm")?),
    };
    let name = format!("resection {} {:.2}", deed.leaflet.to_lowercase(), piece.position);
    let sewn = sew(&mut after, &name, seam, STITCH_N_PER_MM);
    Ok(Repaired {
        model: after,
        report: Report::Resect(ResectReport {
            leaflet: model.leaflets[piece.leaflet as usize].name.clone(),
            shape: deed.shape,
            position: piece.position,
            width_mm: piece.width_mm,
            height_mm: piece.height_mm,
            leaflet_height_mm: piece.leaflet_height_mm,
            area_mm2,
            chords_cut: cut.len(),
            annulus_mm,
            sewn,
        }),
        warnings: doubt(deed.shape, piece.width_mm).into_iter().collect(),
    })
}

/// A piece far wider than surgeons cut out: what is left may close, but hardly as a leaflet.
fn doubt(shape: ResectionShape, width_mm: f64) -> Option<Fault> {
    let [from, to] = shape.usual_width_mm();
    let message =
        || format!("is {width_mm} mm, expected about {from} to {to}: little of the leaflet is left to move");
    (width_mm > FAR_WIDER * to).then(|| Fault::warning("resect.width_mm", message()))
}

/// A width so many times the largest usual one is doubted [1], our choice.
const FAR_WIDER: f64 = 1.5;

fn piece(model: &Model, deed: &Resect) -> Result<Piece, Fault> {
    let width_mm = deed.width_mm.unwrap_or(deed.shape.width_mm());
    if !(width_mm > 0.0 && width_mm.is_finite()) {
        return Err(Fault::error(
            "resect.width_mm",
            format!("is {width_mm} mm, expected above 0"),
        ));
    }
    let leaflet = leaflet_named(model, &deed.leaflet, "resect.leaflet")?;
    let (_, position) = position(deed.site, deed.position, "resect")?;
    let margin = LeafletMargin::new(model, leaflet, "resect.leaflet")?;
    let middle_arc_mm = position * margin.length_mm();
    let arcs = [-0.5, 0.5].map(|side| middle_arc_mm + side * width_mm);
    refuse_beyond_commissure(&margin, arcs, width_mm)?;
    let along = margin.tangent(middle_arc_mm, width_mm);
    let line = margin.height_line(middle_arc_mm, along, 0.0);
    let leaflet_height_mm = line.length_mm();
    let height_mm = height(deed, leaflet_height_mm)?;
    let middle_mm = margin.point_mm(middle_arc_mm);
    let base = arcs.map(|arc| margin.point_mm(arc));
    let points = &model.rest_mm[..model.leaflet_vertex_count];
    let mut fields = match deed.shape {
        ResectionShape::Triangular => {
            let apex = margin.place_mm(&line.at(height_mm));
            triangle(points, base, apex, along.cross(&(apex - middle_mm)))
        }
        ResectionShape::Quadrangular => {
            let annulus: Vec<Vec3> = model.annulus.iter().map(|&v| model.rest_mm[v as usize]).collect();
            quadrangle(points, base, along, &annulus, leaflet_height_mm - height_mm)
        }
    };
    let reach_mm = leaflet_height_mm + width_mm;
    let near = near(model, leaflet, middle_mm, reach_mm);
    for field in &mut fields {
        let far = field.iter_mut().zip(&near).filter(|(_, near)| !**near);
        far.for_each(|(value, _)| *value = f64::NAN);
    }
    let hinge = |arc_mm: f64| {
        let line = margin.height_line(arc_mm, along, 0.0);
        margin.place_mm(&line.at(line.length_mm()))
    };
    Ok(Piece {
        leaflet,
        position,
        width_mm,
        height_mm,
        leaflet_height_mm,
        middle_mm,
        hinges_mm: arcs.map(hinge),
        fields,
    })
}

fn refuse_beyond_commissure(
    margin: &LeafletMargin,
    [from, to]: [f64; 2],
    width_mm: f64,
) -> Result<(), Fault> {
    let length_mm = margin.length_mm();
    if from > 0.0 && to < length_mm {
        return Ok(());
    }
    let message = if width_mm >= length_mm {
        format!("is {width_mm} mm, but the margin is {length_mm:.1} mm long; expected less")
    } else {
        let (beyond, side) = match from <= 0.0 {
            true => (-from, "anterolateral"),
            false => (to - length_mm, "posteromedial"),
        };
        format!(
            "is {width_mm} mm, which would reach {beyond:.1} mm beyond the {side} commissure; expected a narrower piece, or one \
             farther from it"
        )
    };
    Err(Fault::of_shape("resect.width_mm", message))
}

/// How high the piece is, of a leaflet so high [mm].
fn height(deed: &Resect, leaflet_height_mm: f64) -> Result<f64, Fault> {
    let misplaced = |key: &str, of: &str| {
        let message = format!("is given, but the piece is {of}; expected it to be left out");
        Err(Fault::error(format!("resect.{key}"), message))
    };
    match (deed.shape, deed.height_fraction, deed.strip_mm) {
        (ResectionShape::Triangular, _, Some(_)) => misplaced("strip_mm", "triangular"),
        (ResectionShape::Quadrangular, Some(_), _) => misplaced("height_fraction", "quadrangular"),
        (ResectionShape::Quadrangular, ..) if deed.leaflet.eq_ignore_ascii_case("anterior") => {
            let message = "is quadrangular on the anterior leaflet, whose annulus is fibrous and takes no plication; expected \
                           triangular";
            Err(Fault::error("resect.shape", message))
        }
        (ResectionShape::Triangular, fraction, None) => {
            let fraction = fraction.unwrap_or(HEIGHT_FRACTION);
            let most = 1.0 - LEAST_STRIP_MM / leaflet_height_mm;
            if !(fraction > 0.0 && fraction <= most) {
                let message = format!(
                    "is {fraction}, expected above 0 and at most {most:.2}, which leaves {LEAST_STRIP_MM} mm of the \
                     {leaflet_height_mm:.1} mm of leaflet"
                );
                return Err(Fault {
                    of_shape: fraction > 0.0 && fraction < 1.0,
                    ..Fault::error("resect.height_fraction", message)
                });
            }
            Ok(fraction * leaflet_height_mm)
        }
        (ResectionShape::Quadrangular, None, strip) => {
            let strip_mm = strip.unwrap_or(STRIP_MM);
            let most_mm = leaflet_height_mm - LEAST_STRIP_MM;
            if !(strip_mm >= LEAST_STRIP_MM && strip_mm <= most_mm) {
                let message = format!(
                    "is {strip_mm} mm, expected {LEAST_STRIP_MM} to {most_mm:.1} of the {leaflet_height_mm:.1} mm of leaflet"
                );
                return Err(Fault {
                    of_shape: strip_mm >= LEAST_STRIP_MM,
                    ..Fault::error("resect.strip_mm", message)
                });
            }
            Ok(leaflet_height_mm - strip_mm)
        }
    }
}

/// Distances from the sides of a triangle, negative within; `normal` is that of the leaflet, of any length.
fn triangle(points: &[Vec3], base: [Vec3; 2], apex: Vec3, normal: Vec3) -> Fields {
    let side = |one: Vec3, other: Vec3| -> Vec<f64> {
        let out = (apex - one).cross(&normal).normalize();
        let out = if out.dot(&(other - one)) > 0.0 { -out } else { out };
        points.iter().map(|p| out.dot(&(p - apex))).collect()
    };
    vec![side(base[0], base[1]), side(base[1], base[0])]
}

/// Distances from the sides of a quadrangle and from a line so far from the annulus, negative within.
fn quadrangle(points: &[Vec3], base: [Vec3; 2], along: Vec3, annulus: &[Vec3], strip_mm: f64) -> Fields {
    let from_annulus =
        |p: &Vec3| polyline::nearest(annulus, true, *p).map_or(f64::NAN, |foot| foot.distance_mm);
    vec![
        points.iter().map(|p| along.dot(&(base[0] - p))).collect(),
        points.iter().map(|p| along.dot(&(p - base[1]))).collect(),
        points.iter().map(|p| strip_mm - from_annulus(p)).collect(),
    ]
}

/// The vertices of a leaflet that hang together with those at a place without ever being so far from it.
fn near(model: &Model, leaflet: u32, middle_mm: Vec3, reach_mm: f64) -> Vec<bool> {
    let away = |v: u32| (model.rest_mm[v as usize] - middle_mm).norm();
    let is_near = |face: &[u32; 3]| face.iter().all(|&v| away(v) <= reach_mm);
    let faces = model.faces.iter().zip(&model.face_leaflet);
    let faces: Vec<[u32; 3]> = faces
        .filter(|(face, of)| **of == leaflet && is_near(face))
        .map(|(face, _)| *face)
        .collect();
    let middle = |face: &[u32; 3]| face.iter().map(|&v| away(v)).fold(0.0, f64::max);
    let of_middle = hanging_together(&faces, middle);
    let mut near = vec![false; model.leaflet_vertex_count];
    let kept = faces.iter().zip(of_middle).filter(|(_, kept)| *kept);
    kept.flat_map(|(face, _)| face)
        .for_each(|&v| near[v as usize] = true);
    near
}

/// Which faces hang together with the one for which a number is least.
fn hanging_together(faces: &[[u32; 3]], number: impl Fn(&[u32; 3]) -> f64) -> Vec<bool> {
    let (part, _) = topology::components(faces.len(), &topology::edges(faces));
    let first = (0..faces.len()).min_by(|&a, &b| number(&faces[a]).total_cmp(&number(&faces[b])));
    part.iter()
        .map(|&of| Some(of) == first.map(|face| part[face]))
        .collect()
}

/// A model without a piece.
struct Excised {
    model: Model,
    /// Area of the piece [mm²].
    area_mm2: f64,
    /// Vertices along the edges of the gap, each with whether it is a corner.
    edge: Vec<(u32, bool)>,
}

fn excised(model: &Model, piece: &Piece) -> Result<Excised, Fault> {
    let mut mesh = Mesh::of(model);
    let mut fields = piece.fields.clone();
    let fixed = fixed(model, piece.leaflet);
    incise(&mut mesh, &mut fields, &fixed);
    let removed = removed(&mesh, &fields, piece)?;
    let taken = mesh.faces.iter().zip(&removed).filter(|(_, removed)| **removed);
    let mut of_piece: BTreeSet<u32> = BTreeSet::new();
    let mut area_mm2 = 0.0;
    for (face, _) in taken {
        let [a, b, c] = face.map(|v| mesh.points_mm[v as usize]);
        area_mm2 += 0.5 * (b - a).cross(&(c - a)).norm();
        of_piece.extend(face);
    }
    if of_piece
        .iter()
        .any(|&v| fixed.get(v as usize).copied().unwrap_or(false))
    {
        let message = format!(
            "is {} mm, with which the piece meets the annulus or the border with the other leaflet; expected a narrower or lower \
             piece, or one farther from the commissure",
            piece.width_mm
        );
        return Err(Fault::of_shape("resect.width_mm", message));
    }
    let moved = |v: u32| mesh.points_mm[v as usize] != model.rest_mm[v as usize] || of_piece.contains(&v);
    let reinserted = reinserted(model, piece.leaflet, moved);
    let mut number = 0..;
    let mut kept = mesh.clone();
    kept.faces
        .retain(|_| number.next().is_some_and(|face: usize| !removed[face]));
    let mut number = 0..;
    kept.face_leaflet
        .retain(|_| number.next().is_some_and(|face: usize| !removed[face]));
    let (after, numbers) = remade(model, &kept, &reinserted, "resect")?;
    let is_corner = |v: u32| fields.iter().filter(|field| field[v as usize] == 0.0).count() > 1;
    let edge = of_piece.iter().filter(|&&v| numbers[v as usize] != GONE);
    let edge = edge.map(|&v| (numbers[v as usize], is_corner(v))).collect();
    Ok(Excised {
        model: after,
        area_mm2,
        edge,
    })
}

/// Which vertices a cut must neither move nor take: what is held, and what other leaflets have too.
pub(super) fn fixed(model: &Model, leaflet: u32) -> Vec<bool> {
    let mut fixed = vec![false; model.leaflet_vertex_count];
    let others = model
        .faces
        .iter()
        .zip(&model.face_leaflet)
        .filter(|(_, of)| **of != leaflet);
    let others = others.flat_map(|(face, _)| face);
    let held = model.prescribed.iter().map(|held| &held.vertex);
    for &vertex in others.chain(held).chain(&model.annulus) {
        if let Some(slot) = fixed.get_mut(vertex as usize) {
            *slot = true;
        }
    }
    fixed
}

/// The faces of the piece: those within its borders that hang together with its base.
fn removed(mesh: &Mesh, fields: &Fields, piece: &Piece) -> Result<Vec<bool>, Fault> {
    let mut removed = inside(mesh, fields);
    let within: Vec<usize> = (0..removed.len()).filter(|&face| removed[face]).collect();
    if within.is_empty() {
        return Err(Fault::of_shape(
            "resect",
            "holds no tissue; expected a larger piece",
        ));
    }
    let faces: Vec<[u32; 3]> = within.iter().map(|&face| mesh.faces[face]).collect();
    let away = |face: &[u32; 3]| {
        let sum: Vec3 = face.iter().map(|&v| mesh.points_mm[v as usize]).sum();
        (sum / 3.0 - piece.middle_mm).norm()
    };
    for (face, kept) in within.into_iter().zip(hanging_together(&faces, away)) {
        removed[face] = kept;
    }
    Ok(removed)
}

/// Chord points that share in vertices which the cut moved or took, with their places.
fn reinserted(model: &Model, leaflet: u32, moved: impl Fn(u32) -> bool) -> Reinserted {
    let touched = |point: &&(u32, &Vec<(u32, f64)>)| {
        let mut vertices = point
            .1
            .iter()
            .filter(|(v, _)| (*v as usize) < model.leaflet_vertex_count);
        vertices.any(|&(v, _)| moved(v))
    };
    let points = (0..).zip(&model.chords.points);
    points
        .filter(|point| touched(&point))
        .map(|(point, _)| (point, (leaflet, model.chords.point_mm(point, &model.rest_mm))))
        .collect()
}

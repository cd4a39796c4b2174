//! The annular planes of plain surfaces, along whose normals they are seen from the atrium.

use super::{CompareSettings, ComparedSurface};
use crate::Vec3;
use crate::measure::indexed_surface::IndexedSurface;
use crate::measure::plane::{AnnularPlane, annular_plane, length_closed, vector_area};
use crate::mesh::topology::{boundary_edges, chains, components, edges};
use crate::scene::Fault;

/// Below this share of the area [1], what the faces enclose has no side that it looks to: a closed surface, such as
/// leaflets segmented with their thickness. The least that an open valve has, a tube, is some five times as much.
const LOOKS_NOWHERE: f64 = 0.01;

/// Directions farther apart than this [degree] are told: annuli of one heart differ by a few degrees.
const DIRECTIONS_APART_DEG: f64 = 30.0;

/// Faces are taken to look to the ventricle if on their side of the annulus tissue stands this many times as far out
/// [1], and this much farther [mm], as on the other. The coapted margin of a closed valve hangs by a centimetre or so; a
/// billow seldom rises as high, and where it does the faces are believed, so that it takes two times to turn them.
const TURNED_TIMES: f64 = 2.0;
const TURNED_MM: f64 = 2.0;

/// The planes of result and reference. Where one surface does not tell, it is seen as the other one is; neither has one
/// where neither tells.
pub(super) fn planes(
    surfaces: [(&ComparedSurface, &IndexedSurface); 2],
    settings: &CompareSettings,
    warnings: &mut Vec<Fault>,
) -> [Option<AnnularPlane>; 2] {
    let found = surfaces.map(|(surface, indexed)| match settings.atrial_direction {
        Some(direction) => plane_across(indexed, direction),
        None => own_plane(surface, indexed, warnings),
    });
    if let [Some(a), Some(b)] = found {
        let apart = a.normal.angle(&b.normal).to_degrees();
        if apart > DIRECTIONS_APART_DEG {
            let message = format!(
                "the atrium lies {apart:.0} degree away from where `{}` has it; expected less than \
                 {DIRECTIONS_APART_DEG}: give the atrial direction, or turn the faces to the atrium",
                surfaces[0].0.name
            );
            warnings.push(Fault::warning(&surfaces[1].0.name, message));
        }
    }
    let borrowed = |own: Option<AnnularPlane>, other: Option<AnnularPlane>, i: usize| {
        own.or_else(|| plane_across(surfaces[i].1, other?.normal))
    };
    let planes = [borrowed(found[0], found[1], 0), borrowed(found[1], found[0], 1)];
    for i in (0..2).filter(|&i| found[i].is_none()) {
        let as_it_is = match planes[i] {
            Some(_) => "it is seen as the other surface is",
            None => "what is visible is not known",
        };
        let message = format!("neither a rim nor its faces tell where the atrium is; {as_it_is}");
        warnings.push(Fault::warning(&surfaces[i].0.name, message));
    }
    planes
}

/// From the annulus, or where no rim can be it, from where the faces look on the whole.
fn own_plane(
    surface: &ComparedSurface,
    indexed: &IndexedSurface,
    warnings: &mut Vec<Fault>,
) -> Option<AnnularPlane> {
    let Some(plane) = annulus(surface).and_then(|curve| annular_plane(&curve, curve[0])) else {
        let looks = indexed.looks_mm2();
        let area: f64 = indexed.face_area_mm2.iter().sum();
        return (looks.norm() > LOOKS_NOWHERE * area).then(|| plane_across(indexed, looks))?;
    };
    let used = indexed.points_mm.iter().zip(&indexed.used).filter(|part| *part.1);
    let (highest, lowest) = used.fold((0.0_f64, 0.0_f64), |(high, low), (&p, _)| {
        let height = plane.local(p).z;
        (high.max(height), low.min(height))
    });
    if highest <= TURNED_TIMES * -lowest + TURNED_MM {
        return Some(plane);
    }
    let message = format!(
        "its faces look to where it stands {highest:.1} mm out of its annulus, {:.1} mm on the other side; taken to \
         look to the ventricle (if this valve billows as far, give the atrial direction)",
        -lowest
    );
    warnings.push(Fault::warning(&surface.name, message));
    plane_across(indexed, -plane.normal)
}

/// The rim that is the annulus: of points marked so, else, in one connected surface, the rim that is largest and
/// roundest, by A² / L² of the area that it encloses and its length. A free margin of a closed valve encloses hardly
/// anything, one of an open valve is scalloped; a hole is round but small. Leaflets that do not hang together have a rim
/// each, half annulus and half margin.
fn annulus(surface: &ComparedSurface) -> Option<Vec<Vec3>> {
    let edges = edges(&surface.faces);
    let mut rim = boundary_edges(&surface.faces, &edges);
    match &surface.annulus {
        Some(on_annulus) => rim.retain(|ends| ends.iter().all(|&v| on_annulus[v as usize])),
        None if components(surface.faces.len(), &edges).1 > 1 => return None,
        None => {}
    }
    let curves = chains(&rim).into_iter().filter(|chain| chain.closed);
    let curves = curves.map(|chain| -> Vec<Vec3> {
        let vertices = chain.vertices.iter();
        vertices.map(|&v| surface.points_mm[v as usize]).collect()
    });
    let size = |curve: &Vec<Vec3>| vector_area(curve).norm() / length_closed(curve);
    curves.max_by(|a, b| size(a).total_cmp(&size(b)))
}

/// The plane through the middle of a surface across a direction.
fn plane_across(surface: &IndexedSurface, direction: Vec3) -> Option<AnnularPlane> {
    let normal = direction.try_normalize(0.0)?;
    let aside = [Vec3::x(), Vec3::y(), Vec3::z()][normal.iamin()];
    let u = (aside - normal * normal.dot(&aside)).try_normalize(0.0)?;
    Some(AnnularPlane {
        origin: surface.middle_mm(),
        u,
        v: normal.cross(&u),
        normal,
    })
}

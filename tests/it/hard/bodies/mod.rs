//! Sheets and bodies rather than valves.

mod assembly;
mod bars;
mod crossed_shapes;
mod inflated;
mod nearest_parts;
mod pressed;
mod scales;
mod sheets;
mod solids;

use coapt::Vec3;
use coapt::energy::membrane;
use coapt::model::Model;
use coapt::relax::Status;
use coapt::relax::load::reference_force_n;
use coapt::state::State;

use super::{End, HardCase, Jitter};
use crate::shapes::Mesh;

pub(super) fn cases() -> Vec<HardCase> {
    let mut cases = Vec::new();
    cases.extend(inflated::cases());
    cases.extend(bars::cases());
    cases.extend(crossed_shapes::cases());
    cases.extend(nearest_parts::cases());
    cases.extend(pressed::cases());
    cases.extend(sheets::cases());
    cases.extend(solids::cases());
    cases.extend(scales::cases());
    cases
}

/// A case that must be certified, of a model and where it begins.
fn begun(
    name: impl Into<String>,
    what: &'static str,
    make: impl Fn(&mut Jitter) -> (Model, Vec<Vec3>) + Send + Sync + 'static,
) -> HardCase {
    HardCase {
        name: name.into(),
        what,
        make: Box::new(move |jitter| {
            let (model, positions_mm) = make(jitter);
            Ok((model, State { positions_mm }))
        }),
        end: End::Certified,
    }
}

/// A case that must be certified, begun at rest.
fn resting(
    name: impl Into<String>,
    what: &'static str,
    make: impl Fn(&mut Jitter) -> Model + Send + Sync + 'static,
) -> HardCase {
    begun(name, what, move |jitter| {
        let model = make(jitter);
        let start_mm = model.rest_mm.clone();
        (model, start_mm)
    })
}

/// The same case, which must end without a certificate.
fn uncertified(case: HardCase, statuses: &'static [Status], why: &'static str) -> HardCase {
    HardCase {
        end: End::Uncertified(statuses, why),
        ..case
    }
}

/// A mesh whose points are moved a little.
fn jittered(mesh: Mesh, jitter: &mut Jitter) -> Mesh {
    let edge_mm = mean_edge_mm(&mesh);
    mesh.moved(|point| jitter.moved(point, edge_mm))
}

/// A flat mesh whose points are moved a little in its plane: it stays exactly flat.
fn jittered_in_plane(mesh: Mesh, jitter: &mut Jitter) -> Mesh {
    let edge_mm = mean_edge_mm(&mesh);
    mesh.moved(|point| {
        let moved = jitter.moved(point, edge_mm);
        Vec3::new(moved.x, moved.y, point.z)
    })
}

fn mean_edge_mm(mesh: &Mesh) -> f64 {
    coapt::contact::surface::Surface::new(&mesh.faces, &mesh.points_mm).mean_edge_mm
}

/// Residuals are counted in the mean nodal pressure force or in what a strain of 1e-3 pulls with, whichever is more. Where
/// pressure is the less, this asks for as small a part of that.
fn count_in_pressure(model: &mut Model) {
    let area_mm2: f64 = model
        .faces
        .iter()
        .map(|face| coapt::contact::surface::face_area_mm2(face, &model.rest_mm))
        .sum();
    let of_pressure_n = model.pressure_mpa * area_mm2 / model.leaflet_vertex_count as f64;
    model.settings.residual_tolerance *= of_pressure_n / reference_force_n(model);
}

/// A membrane that wrinkles finer than its mesh.
fn wrinkling(law: membrane::Law) -> membrane::Tissue {
    membrane::Tissue { law, wrinkles: true }
}

//! Results in memory as a page: the one that [`super::read_page`] makes of their files.

use coapt::Vec3;
use coapt::model::Model;
use coapt::plan::apply_all;
use coapt::scene::Fault;
use serde_json::Value;

use super::Page;
use super::geometry::{Chords, Geometry, curve};
use super::told::{closure_page, plan_page};
use crate::mesh::check_numbers;
use crate::plan::{PlanReport, Shapes};
use crate::report::{Closure, Report, chords, closed_surface, loaded_chords, ring_curves};

/// The page of a closure and its report.
///
/// # Errors
/// A shape that is not finite; an annulus without a plane.
pub fn page_of_closure(closure: &Closure, report: &Report) -> Result<Page, Vec<Fault>> {
    closure_page("report", parsed(report.json())?, |state| {
        let (closed, is_after) = match &closure.after {
            Some(after) if state == "after" => (after, true),
            _ => (&closure.before, false),
        };
        let positions_mm = &closed.equilibrium.state.positions_mm;
        let named = |message: String| vec![Fault::error(state, message)];
        let mut geometry = geometry_of(&closed.model, positions_mm, true).map_err(named)?;
        if is_after {
            geometry.rings = ring_curves(&closure.repairs).iter().map(curve).collect();
        }
        Ok(geometry)
    })
}

/// The page of a comparison of alternatives, with the shapes of so many, the first-ranked first.
///
/// # Errors
/// A comparison that kept no shapes; a shape that is not finite; an annulus without a plane.
pub fn page_of_plan(
    report: &PlanReport,
    model: &Model,
    shapes: &Shapes,
    most_alternatives: usize,
) -> Result<Page, Vec<Fault>> {
    if shapes.before_mm.is_empty() {
        let message = "holds no closed shapes, which a page shows; expected a comparison that keeps them";
        return Err(vec![Fault::error("plan", message)]);
    }
    plan_page(
        "plan",
        parsed(report.json())?,
        most_alternatives,
        |number, name| {
            let named = |message: String| vec![Fault::error(name, message)];
            if number == 0 {
                return geometry_of(model, &shapes.before_mm, false).map_err(named);
            }
            let row = report.alternatives.iter().find(|row| row.number as u64 == number);
            let closed = row.and_then(|row| Some((row, shapes.after_mm.get(&row.number)?)));
            let (row, positions_mm) = closed.ok_or_else(|| named("has no closed shape".to_owned()))?;
            // Models of thousands of alternatives were not kept.
            let applied = apply_all(model, &row.repairs).map_err(|refusal| refusal.faults)?;
            let mut geometry = geometry_of(&applied.model, positions_mm, false).map_err(named)?;
            // There is one at most.
            geometry.rings = ring_curves(&applied.reports).iter().map(curve).collect();
            Ok(geometry)
        },
    )
}

/// A report as its file holds it.
fn parsed(json: Result<String, Fault>) -> Result<Value, Vec<Fault>> {
    let text = json.map_err(|fault| vec![fault])?;
    serde_json::from_str(&text).map_err(|error| vec![Fault::error("report", error.to_string())])
}

/// Where a closed valve lies, with its chords, and where these are in the open valve if that is wanted.
pub(crate) fn geometry_of(
    model: &Model,
    positions_mm: &[Vec3],
    with_open_chords: bool,
) -> Result<Geometry, String> {
    let surface = closed_surface(model, positions_mm);
    check_numbers(&surface)?;
    let mut geometry = Geometry::of_closed_surface(&surface)?;
    if !model.chords.ends.is_empty() {
        let loaded = loaded_chords(model, positions_mm);
        check_numbers(&loaded)?;
        let open = with_open_chords.then(|| chords(model, &model.rest_mm));
        geometry.chords = Some(Chords::new(&loaded, open.as_ref())?);
    }
    Ok(geometry)
}

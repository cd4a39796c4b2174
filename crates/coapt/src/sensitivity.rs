//! How the closed shape and its measures change with a parameter, from the equilibrium's own tangent.

use crate::Vec3;
use crate::measure::{Measures, measure};
use crate::model::Model;
use crate::relax::Equilibrium;
use crate::relax::response::{Change, Response};
use crate::scene::Fault;

/// Forces are differences over this part of a change that matters [1]. Over a thousandth, chordae that are barely taut would
/// go slack; below a millionth of a millionth, forces would drown in rounding.
const FORCE_WIDTH: f64 = 1e-6;
/// Measures are differences of shapes whose fastest vertex moves by this much to either side [mm], our choice. Those that are found
/// on a raster, tenting and billow, step by more than so small a change is worth: their rates are rough.
const SHAPE_WIDTH_MM: f64 = 1e-3;

/// A number that a valve or its repair depends on.
pub struct Parameter<'a> {
    /// The valve with a value of the parameter; vertices, and which are held, must not depend on it.
    pub model_at: &'a (dyn Fn(f64) -> Result<Model, Vec<Fault>> + Sync),
    /// The value.
    pub value: f64,
    /// A change that would matter, such as 1 for a ring size [mm], in the parameter's unit.
    pub scale: f64,
}

/// Rates of change with a parameter.
#[derive(Clone, Debug)]
pub struct Sensitivity {
    /// How fast every vertex moves [mm per unit of the parameter], shape `[vertex]`.
    pub shape_rate_mm: Vec<Vec3>,
    /// Measures half a width below the parameter's value, to first order, or at the value where there is no model below it; forces on
    /// supports are left out and zero.
    pub less: Measures,
    /// Those a width farther.
    pub more: Measures,
    /// The difference of the parameter between the two, in its unit.
    pub width: f64,
}

impl Sensitivity {
    /// How fast a measure changes, in its unit per unit of the parameter.
    pub fn rate(&self, of: impl Fn(&Measures) -> f64) -> f64 {
        (of(&self.more) - of(&self.less)) / self.width
    }
}

/// Rates of change of a closed valve with a parameter; `closed` is the equilibrium of the model at the parameter's value.
///
/// # Errors
/// As [`Response::new`] and [`Response::shape_rate`]; a value for which there is no model on either side.
pub fn sensitivity(
    model: &Model,
    closed: &Equilibrium,
    parameter: &Parameter,
) -> Result<Sensitivity, Vec<Fault>> {
    let around = |width: f64, middle: f64| -> Result<[Model; 2], Vec<Fault>> {
        let at = |side: f64| (parameter.model_at)(parameter.value + (middle + side) * width);
        Ok([at(-0.5)?, at(0.5)?])
    };
    // A value may be the least or the most that there is: 0 mm from the margin.
    let about = |width: f64| {
        let at = |middle: f64| around(width, middle).map(|models| (models, middle));
        at(0.0).or_else(|faults| at(0.5).or_else(|_| at(-0.5)).map_err(|_| faults))
    };
    let force_width = FORCE_WIDTH * parameter.scale;
    let ([less, more], _) = &about(force_width)?;
    let change = Change {
        less,
        more,
        width: force_width,
    };
    let rate = |mut response: Response| response.shape_rate(&change);
    let shape_rate_mm = Response::new(model, closed)
        .and_then(rate)
        .map_err(|fault| vec![fault])?;
    let leaflets = &shape_rate_mm[..model.leaflet_vertex_count];
    let fastest_mm = leaflets.iter().map(Vec3::norm).fold(0.0, f64::max);
    let width = parameter.scale.min(2.0 * SHAPE_WIDTH_MM / fastest_mm);
    let ([less, more], middle) = &about(width)?;
    let measured = |model: &Model, side: f64| {
        let at = closed.state.positions_mm.iter().zip(&shape_rate_mm);
        let shape: Vec<Vec3> = at
            .map(|(position, rate)| position + rate * ((middle + side) * width))
            .collect();
        measure(model, &shape, &[])
    };
    Ok(Sensitivity {
        less: measured(less, -0.5),
        more: measured(more, 0.5),
        width,
        shape_rate_mm,
    })
}

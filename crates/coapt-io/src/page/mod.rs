//! One self-contained page of a result: the valve to turn, before and after, its tables and pictures. It needs no network.
//!
//! | file | holds |
//! |---|---|
//! | `page.html`, `page.css` | the frame of the page; `{{name}}` is filled in |
//! | `viewer/src` (beside `src`) | what moves on it, built to `viewer/built/report.js` with three.js in it |
//! | `read`, `made` | a folder of results, or results in memory, as a [`Page`] |
//! | `told` | what both take of a report |
//! | `geometry`, `film`, `coded` | shapes and films as the numbers that the page draws |
//! | `html` | tables and words, which are there without any script |

pub mod coded;
pub mod film;
pub mod geometry;
mod html;
mod made;
mod read;
#[cfg(test)]
mod tests;
mod told;

use coapt::measure::ValveFrame;
use coapt::scene::Fault;
use serde::Serialize;
use serde_json::Value;

use crate::plan::Trust;
use crate::report::TableRow;

pub(crate) use made::geometry_of;
pub use made::{page_of_closure, page_of_plan};
pub use read::{RECORDING, add_film, read_page};

/// Of a plan, the shapes of so many alternatives are shown unless another number is asked for (our choice: nobody looks through more, and
/// the page stays small enough to be passed on).
pub const SHOWN_ALTERNATIVES: usize = 30;

/// Stands below every drawing of a closed valve.
pub(crate) const MIDDLE_SURFACES: &str = "Drawn are middle surfaces: leaflets in contact and sewn edges lie a thickness apart, so that closed slits stay to be seen.";

/// Everything that a page shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Page {
    /// Name of the case.
    pub case: String,
    /// Name of the plan; none where a result is of a single closure.
    pub plan: Option<String>,
    /// Version of the program that closed the valve.
    pub version: String,
    /// Transvalvular pressure [mmHg].
    pub pressure_mmhg: f64,
    /// Which way is which.
    pub frame: ValveFrame,
    /// The valve as it is, then what is compared with it, the best first.
    pub states: Vec<PageState>,
    /// What is measured of the states.
    pub rows: Vec<TableRow>,
    /// The result as it stands in its file.
    pub report: Value,
}

/// A valve, closed.
#[derive(Clone, Debug, PartialEq)]
pub struct PageState {
    /// What it is called.
    pub name: String,
    /// Its place among the alternatives of a plan; none for the valve as it is, for a single repair and for what is not certified.
    pub rank: Option<u64>,
    /// Whether it only takes chordae away, which is no repair and has no place.
    pub only_takes_chordae: bool,
    /// How far it can be trusted.
    pub certificate: Trust,
    /// Names of the groups of its chords; empty where they are not known.
    pub chord_groups: Vec<String>,
    /// Where it lies.
    pub geometry: geometry::Geometry,
    /// How often valves like it seal that an image could not tell from it, and how many of them were closed; none where
    /// none were.
    pub seals: Option<Seals>,
}

/// What an ensemble says of sealing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seals {
    /// Part of the certified samples that seal, with the ends of its interval (95 %) [1].
    pub probability: [f64; 3],
    /// Samples that closed with a certificate.
    pub samples: u64,
}

/// What the script reads.
#[derive(Serialize)]
struct Data<'a> {
    pressure_mmhg: f64,
    frame: ValveFrame,
    /// Radius about the centre of the annulus in which everything lies [mm].
    reach_mm: f64,
    /// The state that is shown as after at first; none where there is none.
    after: Option<usize>,
    states: Vec<StateData<'a>>,
    rows: &'a [TableRow],
}

#[derive(Serialize)]
struct StateData<'a> {
    name: &'a str,
    certified: bool,
    chord_groups: &'a [String],
    geometry: &'a geometry::Geometry,
}

/// The page as HTML. Equal pages give equal bytes.
///
/// # Errors
/// None that the types allow.
pub fn page_html(page: &Page) -> Result<String, Fault> {
    let data = Data {
        pressure_mmhg: page.pressure_mmhg,
        frame: page.frame,
        reach_mm: reach_mm(page),
        after: (page.states.len() > 1).then_some(1),
        states: page.states.iter().map(state_data).collect(),
        rows: &page.rows,
    };
    let data = serde_json::to_string(&data).map_err(|error| Fault::error("page", error.to_string()))?;
    // `</script>` in a name would end the data.
    let data = data.replace('<', "\\u003c");
    Ok(html::fill(page, &data))
}

fn state_data(state: &PageState) -> StateData<'_> {
    StateData {
        name: &state.name,
        certified: state.certificate.certified,
        chord_groups: &state.chord_groups,
        geometry: &state.geometry,
    }
}

/// Round numbers change less from valve to valve.
fn reach_mm(page: &Page) -> f64 {
    let farthest = page
        .states
        .iter()
        .map(|state| state.geometry.reach_mm(page.frame.centre_mm));
    farthest.fold(1.0, f64::max).ceil()
}

//! What valves are coloured by, in colours that the colour-blind can read.

use super::canvas::Colour;
use crate::page::geometry::Geometry;

/// Steel blue.
pub(super) const TENSE: Colour = [0.25, 0.35, 0.5];
/// Grey.
pub(super) const SLACK: Colour = [0.7, 0.7, 0.7];
/// Green.
pub(super) const RING: Colour = [0.25, 0.49, 0.35];
/// Red.
pub(super) const UNCERTIFIED: Colour = [0.64, 0.13, 0.13];
const LEAFLETS: [Colour; 4] = [
    [0.75, 0.35, 0.29],
    [0.29, 0.5, 0.69],
    [0.44, 0.6, 0.31],
    [0.6, 0.44, 0.69],
];

/// Cividis (Nunez et al. 2018), nine stops, from the file that the page's script is built with: a list of words is written alike in
/// JSON and here.
const CIVIDIS: [u32; 9] = numbers(include!("../../viewer/src/cividis.json"));

const fn numbers(words: [&str; 9]) -> [u32; 9] {
    let mut numbers = [0; 9];
    let mut at = 0;
    while at < numbers.len() {
        numbers[at] = match u32::from_str_radix(words[at], 16) {
            Ok(number) => number,
            Err(_) => panic!("a colour has six hexadecimal digits"),
        };
        at += 1;
    }
    numbers
}

/// What a valve is coloured by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quantity {
    /// Distance to the other leaflet [mm].
    #[default]
    Gap,
    /// Mean strain of the edges at a point [%].
    Strain,
    /// Way from the open valve [mm].
    Displacement,
    /// Which leaflet it is.
    Leaflet,
}

/// Colours of all valves of a picture: equal colours are equal values.
#[derive(Clone, Copy, Debug)]
pub(super) struct Colouring {
    quantity: Quantity,
    top: f32,
}

/// Gaps from here on look alike [mm]: what matters of them is smaller.
const WIDE_GAP_MM: f32 = 6.0;

impl Colouring {
    pub(super) fn new<'a>(quantity: Quantity, geometries: impl Iterator<Item = &'a Geometry>) -> Self {
        let top = match (quantity, quantity.field()) {
            (Quantity::Gap, _) | (_, None) => WIDE_GAP_MM,
            (_, Some(field)) => {
                let values = geometries.filter_map(|geometry| geometry.fields.get(field));
                values.flat_map(|values| &values.0).copied().fold(1e-3, f32::max)
            }
        };
        Self { quantity, top }
    }

    /// The colour of a vertex of a face.
    pub(super) fn of(&self, geometry: &Geometry, face: usize, vertex: usize) -> Colour {
        let Some(field) = self.quantity.field() else {
            let leaflet = geometry
                .face_leaflet
                .0
                .get(face)
                .map_or(0, |&leaflet| leaflet as usize);
            return LEAFLETS[leaflet % LEAFLETS.len()];
        };
        let value = geometry.fields.get(field).and_then(|values| values.0.get(vertex));
        self.at_share(value.map_or(0.0, |value| value / self.top))
    }

    /// The colour of a share of the range.
    pub(super) fn at_share(&self, share: f32) -> Colour {
        if self.quantity.field().is_none() {
            return LEAFLETS[usize::from(share > 0.5)];
        }
        let at = share.clamp(0.0, 1.0) * (CIVIDIS.len() - 1) as f32;
        let low = (at as usize).min(CIVIDIS.len() - 2);
        let [from, to] = [CIVIDIS[low], CIVIDIS[low + 1]].map(parts);
        std::array::from_fn(|part| from[part] + (to[part] - from[part]) * (at - low as f32))
    }

    /// What stands at the ends of the range.
    pub(super) fn ends(&self) -> [String; 2] {
        match self.quantity {
            Quantity::Gap => ["0".to_owned(), format!("{WIDE_GAP_MM} or more")],
            Quantity::Strain => ["0".to_owned(), format!("{:.0}", 100.0 * self.top)],
            Quantity::Displacement => ["0".to_owned(), format!("{:.1}", self.top)],
            Quantity::Leaflet => ["anterior", "posterior"].map(str::to_owned),
        }
    }

    pub(super) fn title(&self) -> &'static str {
        match self.quantity {
            Quantity::Gap => "distance to the other leaflet [mm]",
            Quantity::Strain => "mean strain of the edges [%]",
            Quantity::Displacement => "way from the open valve [mm]",
            Quantity::Leaflet => "leaflet",
        }
    }
}

impl Quantity {
    fn field(self) -> Option<&'static str> {
        match self {
            Self::Gap => Some("gap_mm"),
            Self::Strain => Some("strain"),
            Self::Displacement => Some("displacement_mm"),
            Self::Leaflet => None,
        }
    }
}

fn parts(colour: u32) -> Colour {
    [16, 8, 0].map(|shift| ((colour >> shift) & 0xff) as f32 / 255.0)
}

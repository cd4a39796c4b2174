//! Biaxial curves as comma-separated tables.
//!
//! The first line names the columns. Two are stretches, `stretch_circ` and `stretch_rad`; two are what the tissue bears, in a
//! kind and unit that the name tells, `KIND_circ_UNIT` and `KIND_rad_UNIT`:
//!
//! | kind | what it is | units |
//! |---|---|---|
//! | `cauchy_stress` | force per current section | `kpa`, `mpa` |
//! | `nominal_stress` | force per unloaded section | `kpa`, `mpa` |
//! | `tension` | force per current length of cut | `n_per_m`, `n_per_mm` |
//!
//! Other columns are left alone, as are empty lines and those that begin with `#`.

use std::path::Path;

use coapt::scene::{Fault, Readable};
use coapt::tissue_fit::BiaxialPoint;

use crate::scene::read_text;

/// Reads a biaxial curve; `thickness_mm` is needed where it holds tensions, and refused where it holds stresses.
///
/// # Errors
/// Every fault, with its line; after twenty reading stops.
pub fn read_biaxial(path: &Path, thickness_mm: Option<f64>) -> Result<Vec<BiaxialPoint>, Vec<Fault>> {
    let text = read_text(path).map_err(|fault| vec![fault])?;
    biaxial_from_text(&path.display().to_string(), &text, thickness_mm)
}

/// The same with the text at hand.
///
/// # Errors
/// As [`read_biaxial`].
pub fn biaxial_from_text(
    name: &str,
    text: &str,
    thickness_mm: Option<f64>,
) -> Result<Vec<BiaxialPoint>, Vec<Fault>> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let told = |line: usize, message: String| Fault::error(format!("{name}:{line}"), message);
    let mut lines = (1..).zip(text.lines()).filter(|(_, line)| !is_left_out(line));
    let Some((number, header)) = lines.next() else {
        return Err(vec![Fault::error(
            name,
            "is empty; expected a line with the names of columns",
        )]);
    };
    let columns = Columns::new(header).map_err(|message| vec![told(number, message)])?;
    let wrong = match (columns.load, thickness_mm) {
        (Load::Tension(_), Some(thickness)) if thickness.is_finite() && thickness > 0.0 => None,
        (Load::Tension(_), _) => Some("holds tensions, of which stresses need a positive thickness [mm]"),
        (_, Some(_)) => Some("holds stresses, for which a thickness has no meaning; leave it out"),
        (_, None) => None,
    };
    if let Some(message) = wrong {
        return Err(vec![told(number, message.into())]);
    }
    let (mut points, mut faults) = (Vec::new(), Vec::new());
    for (number, line) in lines {
        if faults.len() == FAULT_LIMIT {
            faults.push(told(
                number,
                format!("{FAULT_LIMIT} errors: reading stopped, there may be more"),
            ));
            break;
        }
        match columns.point(line, thickness_mm.unwrap_or(1.0)) {
            Ok(point) => points.push(point),
            Err(message) => faults.push(told(number, message)),
        }
    }
    if faults.is_empty() {
        Ok(points)
    } else {
        Err(faults)
    }
}

/// Faults after which reading stops: enough to see the pattern.
const FAULT_LIMIT: usize = 20;

fn is_left_out(line: &str) -> bool {
    line.trim().is_empty() || line.trim_start().starts_with('#')
}

/// What the tissue bears; the number turns the table's unit into MPa or N/mm.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Load {
    Cauchy(f64),
    Nominal(f64),
    Tension(f64),
}

const LOADS: [(&str, &str, Load); 6] = [
    ("cauchy_stress", "kpa", Load::Cauchy(1e-3)),
    ("cauchy_stress", "mpa", Load::Cauchy(1.0)),
    ("nominal_stress", "kpa", Load::Nominal(1e-3)),
    ("nominal_stress", "mpa", Load::Nominal(1.0)),
    ("tension", "n_per_m", Load::Tension(1e-3)),
    ("tension", "n_per_mm", Load::Tension(1.0)),
];

const DIRECTIONS: [&str; 2] = ["circ", "rad"];

#[derive(Debug)]
struct Columns {
    names: Vec<String>,
    stretch: [usize; 2],
    force: [usize; 2],
    load: Load,
}

impl Columns {
    fn new(header: &str) -> Result<Self, String> {
        let names: Vec<String> = header.split(',').map(|name| name.trim().to_lowercase()).collect();
        let at = |name: String| names.iter().position(|column| *column == name);
        let stretch = DIRECTIONS.map(|direction| at(format!("stretch_{direction}")));
        let of_load = |&(kind, unit, load): &(&str, &str, Load)| {
            let [around, outward] = DIRECTIONS.map(|direction| at(format!("{kind}_{direction}_{unit}")));
            Some(([around?, outward?], load))
        };
        let found: Vec<([usize; 2], Load)> = LOADS.iter().filter_map(of_load).collect();
        let ([Some(around), Some(outward)], [(force, load)]) = (stretch, &found[..]) else {
            let known = LOADS.map(|(kind, unit, _)| format!("{kind}_circ_{unit}"));
            return Err(format!(
                "has the columns `{}`; expected `stretch_circ`, `stretch_rad` and, once for each direction, exactly one of `{}`",
                names.join("`, `"),
                known.join("`, `")
            ));
        };
        Ok(Self {
            stretch: [around, outward],
            force: *force,
            load: *load,
            names,
        })
    }

    fn point(&self, line: &str, thickness_mm: f64) -> Result<BiaxialPoint, String> {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        if cells.len() != self.names.len() {
            return Err(format!(
                "has {} columns, expected {}",
                cells.len(),
                self.names.len()
            ));
        }
        let number = |column: usize| {
            let value = cells[column]
                .parse::<f64>()
                .ok()
                .filter(|value| value.is_finite());
            value.ok_or_else(|| {
                format!(
                    "`{}` is `{}`, expected a number",
                    self.names[column], cells[column]
                )
            })
        };
        let stretch = [number(self.stretch[0])?, number(self.stretch[1])?];
        if let Some(axis) = (0..2).find(|&axis| stretch[axis] <= 0.0) {
            let name = &self.names[self.stretch[axis]];
            return Err(format!(
                "`{name}` is {}, expected a stretch, 1 at rest",
                Readable(stretch[axis])
            ));
        }
        let force = [number(self.force[0])?, number(self.force[1])?];
        Ok(match self.load {
            Load::Cauchy(unit) => BiaxialPoint::from_cauchy_stress(stretch, force.map(|f| f * unit)),
            Load::Nominal(unit) => BiaxialPoint {
                stretch,
                nominal_stress_mpa: force.map(|f| f * unit),
            },
            Load::Tension(unit) => BiaxialPoint::from_tension(stretch, force.map(|f| f * unit), thickness_mm),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<BiaxialPoint>, Vec<Fault>> {
        let thickness_mm = text.contains("tension").then_some(0.8);
        biaxial_from_text("curve.csv", text, thickness_mm)
    }

    /// The same state in every kind and unit; 1e-15 is rounding.
    #[test]
    fn units_are_told_by_the_names() {
        for (header, forces) in [
            ("cauchy_stress_circ_kpa, cauchy_stress_rad_kpa", "24, 45"),
            ("cauchy_stress_circ_mpa, cauchy_stress_rad_mpa", "0.024, 0.045"),
            ("nominal_stress_circ_kpa, nominal_stress_rad_kpa", "20, 30"),
            ("Nominal_stress_circ_MPa, nominal_stress_rad_mpa", "0.02, 0.03"),
            (
                "tension_circ_n_per_m, tension_rad_n_per_m",
                "10.666666666666666, 20",
            ),
        ] {
            let points = read(&format!(
                "# pig\nstretch_circ,stretch_rad,{header}\n\n1.2,1.5,{forces}\n"
            ))
            .unwrap();
            let [first, second] = points[0].nominal_stress_mpa;
            assert_eq!((points.len(), points[0].stretch), (1, [1.2, 1.5]));
            assert!(
                (first - 0.02).abs() < 1e-15 && (second - 0.03).abs() < 1e-15,
                "{header}: {points:?}"
            );
        }
    }

    #[test]
    fn faults_have_their_lines() {
        let told = |text: &str| -> Vec<String> {
            let faults = read(text).unwrap_err();
            faults
                .into_iter()
                .map(|fault| format!("{}: {}", fault.place, fault.message))
                .collect()
        };
        let header = "stretch_circ,stretch_rad,cauchy_stress_circ_kpa,cauchy_stress_rad_kpa\n";
        let found = told(&format!(
            "{header}1.1,1.1,1,1\n1.1,x,1,1\n1.1,1.1,1\n1.1,-1,1,1\n1.1,1.1,NaN,1\n"
        ));
        let lines: Vec<&str> = found.iter().map(|told| &told[..11]).collect();
        assert_eq!(
            lines,
            ["curve.csv:3", "curve.csv:4", "curve.csv:5", "curve.csv:6"],
            "{found:?}"
        );
        let many = told(&format!("{header}{}", "x\n".repeat(30)));
        assert_eq!((many.len(), &many[20][..12]), (21, "curve.csv:22"), "{many:?}");
        assert!(told("")[0].contains("is empty"));
        assert!(told("stretch,stress\n")[0].contains("expected `stretch_circ`"));
        let both = "stretch_circ,stretch_rad,cauchy_stress_circ_kpa,cauchy_stress_rad_kpa,tension_circ_n_per_m,tension_rad_n_per_m\n";
        assert!(told(both)[0].contains("exactly one"));
        let tension = "stretch_circ,stretch_rad,tension_circ_n_per_m,tension_rad_n_per_m\n";
        assert!(
            biaxial_from_text("c", tension, None).unwrap_err()[0]
                .message
                .contains("thickness")
        );
    }
}

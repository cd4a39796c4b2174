//! How large a valve may be: what closing it will cost is told before it is begun.

use super::faults::Faults;
use crate::scene::Scene;

/// What closing a valve costs, within a factor of three: how much its leaflets touch and how often it must begin anew
/// decide the rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Memory [GB].
    pub memory_gb: f64,
    /// Processor time [s] on a server of 2020.
    pub time_s: f64,
}

/// Cost at this size, and how it rises with size [1]: the geometric mean of restricted valves (0.03 GB and 0.2 s at 2,600
/// triangles, 0.11 GB and 1.5 s at 10,400, 0.66 GB and 12 s at 40,000, 2.8 GB and 41 s at 100,000) and healthy ones (0.04 GB
/// and 0.7 s, 0.18 GB and 5.4 s, 1.1 GB and 53 s).
const MEASURED_FACES: f64 = 40_000.0;
const MEASURED: Cost = Cost {
    memory_gb: 0.85,
    time_s: 25.0,
};
const MEMORY_EXPONENT: f64 = 1.4;
const TIME_EXPONENT: f64 = 1.6;

/// From so many triangles on a person is told what to expect: below, half a minute is not worth a word (our choice).
const TOLD_FROM: usize = 50_000;

/// What a closure of so many triangles may be expected to cost.
pub fn closure_cost(faces: usize) -> Cost {
    let times = faces as f64 / MEASURED_FACES;
    Cost {
        memory_gb: MEASURED.memory_gb * times.powf(MEMORY_EXPONENT),
        time_s: MEASURED.time_s * times.powf(TIME_EXPONENT),
    }
}

/// Why a valve of so many triangles is not closed, and what would help.
pub fn refusal(faces: usize, limit: u32) -> String {
    format!(
        "{}; expected {} at most (settings.face_limit): coarsen the mesh or, where the machine has room for it, raise the \
         limit",
        told(faces),
        grouped(limit as usize)
    )
}

/// What a person should know before closing a valve of so many triangles; nothing of a small one.
pub fn notice(faces: usize) -> Option<String> {
    (faces >= TOLD_FROM).then(|| told(faces))
}

/// `10,000,000 triangles: closing them takes about 1.9 TB of memory and 48 hours`
fn told(faces: usize) -> String {
    let Cost { memory_gb, time_s } = closure_cost(faces);
    let memory = match memory_gb {
        small if small < 1.0 => format!("{:.0} MB", 1e3 * small),
        large if large >= 1e3 => format!("{:.1} TB", 1e-3 * large),
        usual => format!("{usual:.1} GB"),
    };
    let time = match time_s {
        short if short < 120.0 => format!("{short:.0} s"),
        long if long >= 7200.0 => format!("{:.0} hours", long / 3600.0),
        usual => format!("{:.0} minutes", usual / 60.0),
    };
    format!(
        "{} triangles: closing them takes about {memory} of memory and {time}",
        grouped(faces)
    )
}

/// `10,400`
pub fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Refuses a scene beyond its limit, and says of a large one what it will cost.
pub(super) fn check(scene: &Scene, faults: &mut Faults) {
    let meshes = scene.leaflets.iter().filter_map(|leaflet| leaflet.mesh.as_ref());
    let faces = meshes.map(|mesh| mesh.faces.len()).sum();
    let limit = scene.settings.face_limit;
    if faces > limit as usize {
        faults.error("leaflets", refusal(faces, limit));
    } else if let Some(notice) = notice(faces) {
        faults.warning("leaflets", notice);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::parametric::{ValveParameters, generate};
    use crate::model::Model;

    #[test]
    fn what_a_closure_costs_is_told_in_units_that_fit() {
        assert_eq!(
            told(10_000_000),
            "10,000,000 triangles: closing them takes about 1.9 TB of memory and 48 hours"
        );
        assert_eq!(
            told(250_000),
            "250,000 triangles: closing them takes about 11.1 GB of memory and 8 minutes"
        );
        assert_eq!(
            told(10_400),
            "10,400 triangles: closing them takes about 129 MB of memory and 3 s"
        );
        assert_eq!(
            [0, 999, 1000, 1_234_567].map(grouped),
            ["0", "999", "1,000", "1,234,567"]
        );
    }

    #[test]
    fn a_valve_beyond_its_limit_is_refused_with_the_cost() {
        let mut scene = generate(&ValveParameters::default()).unwrap();
        let faces: usize = scene
            .leaflets
            .iter()
            .map(|l| l.mesh.as_ref().unwrap().faces.len())
            .sum();
        scene.settings.face_limit = faces as u32;
        assert!(Model::build(&scene).is_ok());
        scene.settings.face_limit -= 1;
        let faults = Model::build(&scene).unwrap_err();
        assert_eq!(faults.len(), 1, "{faults:?}");
        assert!(faults[0].message.contains("settings.face_limit"), "{faults:?}");
        assert!(faults[0].message.contains(" of memory and "), "{faults:?}");
    }

    #[test]
    fn a_large_valve_is_closed_with_a_warning() {
        let parameters = ValveParameters {
            face_count_target: 60_000,
            ..ValveParameters::default()
        };
        let built = Model::build(&generate(&parameters).unwrap()).unwrap();
        assert!(
            built
                .warnings
                .iter()
                .any(|fault| fault.message.contains("closing them takes about"))
        );
    }
}

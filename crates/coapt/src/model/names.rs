//! Names of parts: what reports, files and the program's own search tell parts apart by.

use std::collections::BTreeMap;

use super::faults::Faults;
use crate::scene::Scene;

/// Tells of parts of one kind that share a name.
pub(crate) fn tell_shared(scene: &Scene, faults: &mut Faults) {
    // The anterior leaflet is found by its name, and so is the material of each leaflet in what other engines read.
    let leaflets = scene.leaflets.iter().map(|leaflet| leaflet.name.as_str());
    for [place, message] in shared("leaflets", leaflets) {
        faults.error(place, message);
    }
    // Left and right are found by the muscles' names, and reports give each muscle's force under its name: of two there is no
    // telling whose force is whose.
    let muscles = scene.papillary.iter().map(|muscle| muscle.name.as_str());
    for [place, message] in shared("papillary", muscles) {
        faults.error(place, message);
    }
    // Reports give each group's tension under its name too, but in the order of the scene, and nothing is looked for by it:
    // one file for each muscle, both named `marginal`, is a valve that closes as it should.
    let groups = scene.chordae.iter().map(|group| group.name.as_str());
    for [place, message] in shared("chordae", groups) {
        faults.warning(place, message + "; reports list both under it");
    }
}

/// Place and message for each part that has the name of an earlier one.
fn shared<'a>(key: &str, names: impl Iterator<Item = &'a str>) -> Vec<[String; 2]> {
    let mut first_of = BTreeMap::new();
    let mut found = Vec::new();
    for (number, name) in names.enumerate() {
        let first = *first_of.entry(name).or_insert(number);
        if first != number {
            found.push([
                format!("{key}[{number}].name"),
                format!("is `{name}`, the name of {key}[{first}] too; expected another"),
            ]);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{built, faults, skirt, told};

    #[test]
    fn two_parts_of_one_name_are_told_and_of_what_tells_parts_apart_refused() {
        let mut scene = skirt();
        scene.leaflets[1].name = scene.leaflets[0].name.clone();
        assert!(told(
            &faults(&scene),
            "leaflets[1].name",
            "is `anterior`, the name of leaflets[0] too"
        ));
        let mut scene = skirt();
        scene.papillary[1].name = scene.papillary[0].name.clone();
        assert!(told(
            &faults(&scene),
            "papillary[1].name",
            "the name of papillary[0] too"
        ));
        let mut scene = skirt();
        let mut other = scene.chordae[0].clone();
        let mesh = [&mut scene.chordae[0], &mut other].map(|group| group.mesh.as_mut().unwrap());
        for (mesh, segments) in mesh.into_iter().zip([0..3, 3..6]) {
            mesh.segments = mesh.segments[segments].to_vec();
        }
        scene.chordae.push(other);
        assert!(told(
            &built(&scene).warnings,
            "chordae[1].name",
            "the name of chordae[0] too"
        ));
    }
}

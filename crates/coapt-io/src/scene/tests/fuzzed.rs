//! What fuzzing found, and what was found by reading for the same reasons. `fuzz/README.md` says how it is run.

use super::*;
use coapt::scene::Fault;

/// To find the line of each fault is to read the text once more: thousands of faults would take the square of its length.
#[test]
fn faults_are_told_up_to_twenty() {
    let muscle = "[[papillary]]\nname = \"a\"\ntips_file = \"nowhere\"\n";
    let text = format!("{}{}", two_leaflets(""), muscle.repeat(3000));
    let folder = Folder::new(
        "many-faults",
        &[("a.obj", SQUARE), ("b.obj", SQUARE), ("scene.toml", &text)],
    );
    let told = messages(&folder.read().unwrap_err(), Severity::Error);
    assert_eq!(told.len(), 21, "{told:#?}");
    assert!(
        told[19].contains("papillary[19].tips_file is `nowhere`"),
        "{told:#?}"
    );
    assert!(told[20].ends_with("and 2980 more like these"), "{told:#?}");
}

#[test]
fn a_fault_quotes_a_long_word_in_part() {
    let word = "a".repeat(5000);
    for text in [
        format!("schema_version = 1\n{word} = 1\n"),
        format!("{{\"schema_version\": 1, \"{word}\": 1}}"),
    ] {
        let faults: Vec<Fault> = plan_from_text(Path::new("plan.toml"), &text).unwrap_err();
        assert!(
            faults.iter().all(|fault| fault.message.chars().count() < 1100),
            "{faults:?}"
        );
    }
}

/// Readers of meshes leave out triangles that use a point twice. In a scene they are left out as well, but a point that only such a
/// triangle uses stood for the point of the next leaflet that lies on it, and the vertices came in another order.
#[test]
fn a_triangle_that_uses_a_point_twice_does_not_count_its_points() {
    let mut scene = valve(Preset::Healthy, 300);
    let far = scene.leaflets[1].mesh.as_ref().unwrap().points_mm.last().copied();
    let mesh = scene.leaflets[0].mesh.as_mut().unwrap();
    // One lies on the last point of the other leaflet, one where no valve reaches.
    for point in [far.unwrap(), [500.0, 0.0, 0.0]] {
        let number = mesh.points_mm.len() as u32;
        mesh.points_mm.push(point);
        mesh.faces.push([0, number, 0]);
    }
    let built = Model::build(&scene).unwrap();
    let told = messages(&built.warnings, Severity::Warning).join("\n");
    assert!(
        told.contains("triangles that use a point twice are left out (2 such)"),
        "{told}"
    );
    assert!(
        told.contains("2 points belong to no triangle and are left out"),
        "{told}"
    );
    let folder = Folder::new("a-point-twice", &[]);
    write_scene(&folder.0, &scene).unwrap();
    let again = Model::build(&folder.read().unwrap().0).unwrap();
    assert!(format!("{:?}", built.model) == format!("{:?}", again.model));
}

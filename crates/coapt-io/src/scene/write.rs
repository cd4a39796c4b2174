//! A scene as a folder: `scene.toml`, and a `.vtp` per leaflet and per chord group.

use std::collections::BTreeMap;
use std::path::Path;

use coapt::scene::{Fault, LineMesh, Scene, Space, SurfaceMesh};

use super::frame::turn_scene;
use super::geometry::{AREA_ARRAY, REST_LENGTH_ARRAY};
use crate::atomic::{Batch, file_fault, make_folder};
use crate::mesh::{Array, PolyData, stage_vtp};

/// Point array that is 1 on the annulus.
const MARKER_ARRAY: &str = "annulus";
/// Point array with the prescribed motion of the annulus [mm].
const DISPLACEMENT_ARRAY: &str = "annulus_displacement_mm";

/// Writes a scene that holds its meshes, in LPS; reading it back gives the same model to the last bit. The folder is
/// made if need be, and files of the same names are replaced. The same scene gives the same bytes.
///
/// # Errors
/// A mesh that no file can hold (a coordinate that is not finite, a point that does not exist), or what the file
/// system says.
pub fn write_scene(folder: &Path, scene: &Scene) -> Result<(), Fault> {
    let mut batch = Batch::default();
    stage_scene(&mut batch, folder, scene)?;
    batch.finish_listed(folder)
}

/// The same as part of a batch.
///
/// # Errors
/// As [`write_scene`].
pub fn stage_scene(batch: &mut Batch, folder: &Path, scene: &Scene) -> Result<(), Fault> {
    make_folder(folder)?;
    let mut scene = scene.clone();
    if scene.space == Space::RAS {
        turn_scene(&mut scene);
    }
    let mut taken = BTreeMap::new();
    for leaflet in &mut scene.leaflets {
        let Some(mesh) = leaflet.mesh.take() else { continue };
        let file = file_name("leaflet", &leaflet.name, &mut taken);
        stage_vtp(batch, &folder.join(&file), &leaflet_data(&mesh))?;
        if mesh.annulus_points.is_some() {
            scene.annulus.marker_array = Some(MARKER_ARRAY.into());
        }
        if mesh.annulus_displacement_mm.is_some() {
            scene.annulus.displacement_array = Some(DISPLACEMENT_ARRAY.into());
        }
        leaflet.mesh_file = Some(file);
    }
    for group in &mut scene.chordae {
        let Some(mesh) = group.mesh.take() else { continue };
        let file = file_name("chords", &group.name, &mut taken);
        stage_vtp(batch, &folder.join(&file), &chord_data(&mesh))?;
        group.mesh_file = Some(file);
    }
    let path = folder.join("scene.toml");
    let text = toml::to_string(&scene).map_err(|error| file_fault(&path, &error))?;
    batch.write(&path, text.as_bytes())
}

/// A name for a file that no other part has; letters that some file system minds become underscores. `taken` holds the
/// names and the last number that was put behind each, so that a thousand parts of one name take no million tries.
fn file_name(kind: &str, name: &str, taken: &mut BTreeMap<String, u32>) -> String {
    let letter = |c: char| {
        if c.is_ascii_alphanumeric() || c == '-' {
            c
        } else {
            '_'
        }
    };
    let word: String = name.chars().take(60).map(letter).collect();
    let plain = format!("{kind}_{word}.vtp");
    // Some file systems tell no case apart.
    let mut number = taken.get(&plain.to_lowercase()).copied().unwrap_or(1);
    let mut free = plain.clone();
    while taken.contains_key(&free.to_lowercase()) {
        number += 1;
        free = format!("{kind}_{word}_{number}.vtp");
    }
    taken.insert(plain.to_lowercase(), number);
    taken.entry(free.to_lowercase()).or_insert(1);
    free
}

fn leaflet_data(mesh: &SurfaceMesh) -> PolyData {
    let mut point_arrays = Vec::new();
    if let Some(points) = &mesh.annulus_points {
        let mut values = vec![0.0; mesh.points_mm.len()];
        for &point in points {
            if let Some(value) = values.get_mut(point as usize) {
                *value = 1.0;
            }
        }
        point_arrays.push(array(MARKER_ARRAY, 1, values));
    }
    if let Some(motion) = &mesh.annulus_displacement_mm {
        point_arrays.push(array(DISPLACEMENT_ARRAY, 3, motion.concat()));
    }
    PolyData {
        points: mesh.points_mm.clone(),
        triangles: mesh.faces.clone(),
        point_arrays,
        ..PolyData::default()
    }
}

fn chord_data(mesh: &LineMesh) -> PolyData {
    let values = [
        (REST_LENGTH_ARRAY, &mesh.rest_length_mm),
        (AREA_ARRAY, &mesh.area_mm2),
    ];
    let given = values
        .into_iter()
        .filter_map(|(name, values)| Some(array(name, 1, values.clone()?)));
    PolyData {
        points: mesh.points_mm.clone(),
        lines: mesh.segments.clone(),
        cell_arrays: given.collect(),
        ..PolyData::default()
    }
}

fn array(name: &str, components: usize, values: Vec<f64>) -> Array {
    Array {
        name: name.into(),
        components,
        values,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compared with all names before it and tried with all numbers, they would take hours.
    #[test]
    fn very_many_parts_of_one_name_get_files_of_their_own() {
        let mut taken = BTreeMap::new();
        let mut names = vec![
            file_name("leaflet", "A", &mut taken),
            file_name("leaflet", "a 2", &mut taken),
        ];
        let start = std::time::Instant::now();
        names.extend((0..20_000).map(|_| file_name("leaflet", "a", &mut taken)));
        assert!(start.elapsed().as_secs() < 10, "{:?}", start.elapsed());
        assert_eq!(
            names[..3],
            ["leaflet_A.vtp", "leaflet_a_2.vtp", "leaflet_a_3.vtp"]
        );
        assert_eq!(names[20_001], "leaflet_a_20002.vtp");
    }
}

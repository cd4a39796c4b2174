//! Leaflets and chordae from what mesh files hold.

use coapt::scene::{Annulus, ChordGroup, Leaflet, LineMesh, SurfaceMesh};

use super::files::Files;
use crate::mesh::{Array, PolyData};

/// Cell array that tells the leaflets of one file apart.
pub(super) const REGION_ARRAY: &str = "leaflet";
/// Cell array with the unloaded length of each chord [mm].
pub(super) const REST_LENGTH_ARRAY: &str = "rest_length_mm";
/// Cell array with the cross-section of each chord [mm²].
pub(super) const AREA_ARRAY: &str = "area_mm2";

/// Reads a leaflet's file into its mesh.
pub(super) fn fill_leaflet(number: usize, leaflet: &mut Leaflet, annulus: &Annulus, files: &mut Files) {
    let place = format!("leaflets[{number}]");
    let Some(file) = leaflet.mesh_file.take() else {
        if leaflet.region.is_some() {
            files.error(
                &format!("{place}.region"),
                "has no meaning without a `mesh_file` to take it from",
            );
        }
        return;
    };
    let key = format!("{place}.mesh_file");
    if leaflet.mesh.is_some() {
        return files.error(&key, "is given beside `mesh`; expected one of the two");
    }
    let is_whole = leaflet.region.is_none();
    // A part of a large file may well be small.
    let face_limit = is_whole.then_some(files.face_limit);
    let Some(data) = files.mesh(&key, &file, face_limit) else {
        return;
    };
    let faces = match leaflet.region.take() {
        None => data.triangles.clone(),
        Some(region) => match of_region(&data, region) {
            Ok(faces) => faces,
            Err(message) => return files.error(&format!("{place}.region"), format!("{message} (`{file}`)")),
        },
    };
    if faces.is_empty() {
        return files.error(&key, format!("is `{file}`, which holds lines and no triangles"));
    }
    let mesh = surface(&data, faces, annulus, &key, files);
    let unused = data.points.len() - mesh.points_mm.len();
    // The other points of a file with several leaflets or with chordae are another's.
    if unused > 0 && is_whole && data.lines.is_empty() {
        let message =
            format!("is `{file}`, in which {unused} points belong to no triangle; they are left out");
        files.warning(&key, message);
    }
    leaflet.mesh = Some(mesh);
}

/// The triangles whose cell array `leaflet` has this value.
fn of_region(data: &PolyData, region: i64) -> Result<Vec<[u32; 3]>, String> {
    let array = data.cell_array(REGION_ARRAY).ok_or_else(|| {
        format!(
            "is {region}, but the file has no cell array `{REGION_ARRAY}`; it has {}",
            names(&data.cell_arrays)
        )
    })?;
    let value = |triangle: usize| data.triangle_value(array, triangle)?.first().copied();
    let faces: Vec<[u32; 3]> = (0..data.triangles.len())
        .filter(|&triangle| value(triangle) == Some(region as f64))
        .map(|triangle| data.triangles[triangle])
        .collect();
    if faces.is_empty() {
        let mut values: Vec<i64> = (0..data.triangles.len())
            .filter_map(value)
            .map(|value| value as i64)
            .collect();
        values.sort_unstable();
        values.dedup();
        return Err(format!(
            "is {region}, but no triangle has this value; there are {values:?}"
        ));
    }
    Ok(faces)
}

/// These triangles with the points they use, in the order of the file.
fn surface(
    data: &PolyData,
    mut faces: Vec<[u32; 3]>,
    annulus: &Annulus,
    place: &str,
    files: &mut Files,
) -> SurfaceMesh {
    let mut number = vec![u32::MAX; data.points.len()];
    let mut kept: Vec<u32> = faces.iter().flatten().copied().collect();
    kept.sort_unstable();
    kept.dedup();
    for (new, &old) in kept.iter().enumerate() {
        number[old as usize] = new as u32;
    }
    faces
        .iter_mut()
        .for_each(|face| *face = face.map(|point| number[point as usize]));
    let array = |name: &Option<String>, files: &mut Files| {
        let name = name.as_ref()?;
        let found = data.point_array(name);
        if found.is_none() {
            let message = format!(
                "has no point array `{name}`, which [annulus] names; it has {}",
                names(&data.point_arrays)
            );
            files.warning(place, message);
        }
        found
    };
    let marker = array(&annulus.marker_array, files);
    let marked = |point: u32, array: &Array| {
        let values = array.tuple(point as usize).unwrap_or_default();
        values.iter().any(|value| *value != 0.0 && !value.is_nan())
    };
    let motion = array(&annulus.displacement_array, files).filter(|array| {
        let vectors = array.components == 3;
        if !vectors {
            let message = format!(
                "has {} components in the point array `{}`; a displacement has 3",
                array.components, array.name
            );
            files.error(place, message);
        }
        vectors
    });
    let vector = |point: u32, array: &Array| match array.tuple(point as usize) {
        Some(&[x, y, z]) => [x, y, z],
        _ => [0.0; 3],
    };
    SurfaceMesh {
        points_mm: kept.iter().map(|&point| data.points[point as usize]).collect(),
        faces,
        annulus_points: marker.map(|array| {
            let on = kept.iter().zip(0_u32..).filter(|&(&old, _)| marked(old, array));
            on.map(|(_, new)| new).collect()
        }),
        annulus_displacement_mm: motion.map(|array| kept.iter().map(|&point| vector(point, array)).collect()),
    }
}

/// Array names for a message.
fn names(arrays: &[Array]) -> String {
    match arrays {
        [] => "none".to_owned(),
        _ => {
            let names: Vec<String> = arrays
                .iter()
                .take(20)
                .map(|array| format!("`{}`", array.name))
                .collect();
            names.join(", ")
        }
    }
}

/// Reads a chord group's file into its mesh.
pub(super) fn fill_chords(number: usize, group: &mut ChordGroup, files: &mut Files) {
    let key = format!("chordae[{number}].mesh_file");
    let Some(file) = group.mesh_file.take() else {
        return;
    };
    if group.mesh.is_some() {
        return files.error(&key, "is given beside `mesh`; expected one of the two");
    }
    let Some(data) = files.mesh(&key, &file, None) else {
        return;
    };
    if data.lines.is_empty() {
        return files.error(&key, format!("is `{file}`, which holds triangles and no lines"));
    }
    let values = |name: &str| {
        let array = data.cell_array(name)?;
        let of_line = |line: usize| data.line_value(array, line)?.first().copied();
        (0..data.lines.len()).map(of_line).collect::<Option<Vec<f64>>>()
    };
    group.mesh = Some(LineMesh {
        rest_length_mm: values(REST_LENGTH_ARRAY).map(|lengths| shared_out(&data, lengths)),
        area_mm2: values(AREA_ARRAY),
        points_mm: data.points,
        segments: data.lines,
    });
}

/// A rest length belongs to a whole polyline; its segments share it in proportion to their lengths.
fn shared_out(data: &PolyData, mut lengths: Vec<f64>) -> Vec<f64> {
    let length = |&[a, b]: &[u32; 2]| {
        let [a, b] = [a, b].map(|point| data.points[point as usize]);
        (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt()
    };
    let mut first = 0;
    while first < lengths.len() {
        let cell = data.line_cell(first);
        let count = (first..lengths.len())
            .take_while(|&line| data.line_cell(line) == cell)
            .count();
        let of_cell = first..first + count;
        let whole: f64 = data.lines[of_cell.clone()].iter().map(length).sum();
        // A single segment keeps its number to the last bit.
        if count > 1 && whole > 0.0 {
            for line in of_cell {
                lengths[line] *= length(&data.lines[line]) / whole;
            }
        }
        first += count;
    }
    lengths
}

//! Surfaces to compare, from files and from folders of results.

use std::path::{Path, PathBuf};

use coapt::Vec3;
use coapt::measure::compare::ComparedSurface;
use coapt::model::size::grouped;
use coapt::scene::Fault;

use crate::mesh::{PolyData, announced_triangles, read_mesh};

/// A surface and the file that it was read from.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadSurface {
    /// As it stands in the file, in LPS.
    pub mesh: PolyData,
    /// What is compared of it, named by its file.
    pub surface: ComparedSurface,
}

/// The closed leaflets in a folder of results.
const CLOSED: &str = "closed.vtp";

/// The point array that marks the annulus in results.
const ANNULUS: &str = "annulus";

/// Reads a surface file, or the closed leaflets in a folder that `coapt closure --out` wrote; the second part are the
/// warnings. Points are in contact where the array `contact_array` is above a half; without that array it is not known
/// where they are.
///
/// # Errors
/// As of [`read_mesh`]; more than `face_limit` triangles, which are not read where the file announces them; a folder that holds no closed valve, or one before and one after a plan; an array of contact
/// that does not have one finite number for each point.
pub fn read_surface(
    path: &Path,
    contact_array: &str,
    face_limit: u32,
) -> Result<(ReadSurface, Vec<Fault>), Vec<Fault>> {
    let path = file_in(path).map_err(|fault| vec![fault])?;
    let name = path.display().to_string();
    let within = |faces: u64| match faces > u64::from(face_limit) {
        true => Err(vec![Fault::error(&name, too_many(faces, face_limit))]),
        false => Ok(()),
    };
    within(announced_triangles(&path).unwrap_or(0))?;
    let (mesh, warnings) = read_mesh(&path)?;
    within(mesh.triangles.len() as u64)?;
    Ok((ReadSurface::new(&name, mesh, contact_array)?, warnings))
}

impl ReadSurface {
    /// A surface that need not be from a file, under any name; contact and annulus as of [`read_surface`].
    ///
    /// # Errors
    /// An array of contact or annulus that does not have one finite number for each point.
    pub fn new(name: &str, mesh: PolyData, contact_array: &str) -> Result<Self, Vec<Fault>> {
        let marks = |array: &str| marks(&mesh, array).map_err(|message| vec![Fault::error(name, message)]);
        let surface = ComparedSurface {
            points_mm: mesh.points.iter().map(|&p| Vec3::from(p)).collect(),
            faces: mesh.triangles.clone(),
            face_cell: mesh.triangle_source.clone(),
            contact: marks(contact_array)?,
            annulus: marks(ANNULUS)?,
            name: name.to_owned(),
        };
        Ok(Self { mesh, surface })
    }
}

fn too_many(faces: u64, face_limit: u32) -> String {
    format!(
        "has {} triangles, expected {} at most: coarsen the mesh or, where the machine has room for it, raise the limit",
        grouped(faces as usize),
        grouped(face_limit as usize)
    )
}

/// The surface file that a path means.
fn file_in(path: &Path) -> Result<PathBuf, Fault> {
    if !path.is_dir() {
        return Ok(path.to_owned());
    }
    if path.join(CLOSED).exists() {
        return Ok(path.join(CLOSED));
    }
    let place = path.display().to_string();
    let [before, after] = ["before", "after"].map(|valve| path.join(valve));
    let message = match before.join(CLOSED).exists() || after.join(CLOSED).exists() {
        true => format!(
            "holds a valve before and after a plan; expected one of them: {} or {}",
            before.display(),
            after.display()
        ),
        false => format!(
            "is a folder without {CLOSED}; expected a surface file, or a folder that `coapt closure --out` wrote"
        ),
    };
    Err(Fault::error(place, message))
}

/// Which points an array marks; none without that array.
fn marks(mesh: &PolyData, name: &str) -> Result<Option<Vec<bool>>, String> {
    let Some(array) = mesh.point_array(name) else {
        return Ok(None);
    };
    if array.components != 1 || array.values.len() != mesh.points.len() {
        let (values, points) = (array.values.len(), mesh.points.len());
        return Err(format!(
            "point array `{name}` has {values} values, expected one for each of {points} points"
        ));
    }
    match array.values.iter().position(|value| !value.is_finite()) {
        Some(point) => Err(format!(
            "point array `{name}` is {} at point {point}, expected finite numbers",
            array.values[point]
        )),
        None => Ok(Some(array.values.iter().map(|&value| value > 0.5).collect())),
    }
}

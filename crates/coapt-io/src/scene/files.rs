//! The files that a scene names: where they may lie, each read once, and which frame they are in.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

use coapt::model::size::refusal;
use coapt::scene::{Fault, Severity, Space};

use super::nearest::nearest;
use crate::mesh::{self, Curve, MarkupPoints, PolyData};

/// The files of one scene or plan.
#[derive(Debug)]
pub(super) struct Files {
    /// What names them: `scene` or `plan`.
    owner: &'static str,
    folder: PathBuf,
    /// The frame of files that do not say theirs.
    space: Space,
    /// Files of more triangles are not read to their end.
    pub(super) face_limit: u32,
    meshes: BTreeMap<PathBuf, Option<PolyData>>,
    unmarked: Vec<String>,
    marked_ras: Vec<String>,
    /// Faults of the files themselves, each with its file.
    pub(super) in_files: Vec<Fault>,
    /// Faults of what the scene says of them, each with its key.
    pub(super) in_scene: Vec<Fault>,
}

impl Files {
    /// No file read yet.
    pub(super) fn new(owner: &'static str, folder: &Path, space: Space, face_limit: u32) -> Self {
        Self {
            owner,
            folder: folder.to_owned(),
            space,
            face_limit,
            meshes: BTreeMap::new(),
            unmarked: Vec::new(),
            marked_ras: Vec::new(),
            in_files: Vec::new(),
            in_scene: Vec::new(),
        }
    }

    pub(super) fn error(&mut self, place: &str, message: impl Into<String>) {
        self.in_scene.push(Fault::error(place, message));
    }

    pub(super) fn warning(&mut self, place: &str, message: impl Into<String>) {
        self.in_scene.push(Fault::warning(place, message));
    }

    /// Whether nothing stands against going on.
    pub(super) fn any_error(&self) -> bool {
        let all = self.in_files.iter().chain(&self.in_scene);
        all.into_iter().any(|fault| fault.severity == Severity::Error)
    }

    /// A mesh in LPS, of so many triangles at most. The same file is read once, however many leaflets are in it.
    pub(super) fn mesh(&mut self, place: &str, file: &str, face_limit: Option<u32>) -> Option<PolyData> {
        let path = self.path(place, file)?;
        if let Some(known) = self.meshes.get(&path) {
            return known.clone();
        }
        let announced = mesh::announced_triangles(&path);
        self.within(place, file, announced, face_limit)?;
        let read = self.keep(mesh::read_mesh(&path));
        if let Some(mesh) = &read {
            self.within(place, file, Some(mesh.triangles.len() as u64), face_limit)?;
        }
        let read = read.map(|mut mesh| {
            if self.must_turn(file, mesh.space) {
                turn_mesh(&mut mesh);
            }
            mesh
        });
        self.meshes.insert(path, read.clone());
        read
    }

    /// Nothing, and a fault, where a file has more triangles than it may.
    fn within(&mut self, place: &str, file: &str, faces: Option<u64>, face_limit: Option<u32>) -> Option<()> {
        let (Some(faces), Some(limit)) = (faces, face_limit) else {
            return Some(());
        };
        if faces > u64::from(limit) {
            self.error(
                place,
                format!("is `{file}` of {}", refusal(faces as usize, limit)),
            );
            return None;
        }
        Some(())
    }

    /// A curve in LPS.
    pub(super) fn curve(&mut self, place: &str, file: &str) -> Option<Curve> {
        let path = self.path(place, file)?;
        let mut curve = self.keep(mesh::read_curve(&path))?;
        if self.must_turn(file, curve.space) {
            turn(&mut curve.points_mm);
        }
        Some(curve)
    }

    /// Points in LPS.
    pub(super) fn points(&mut self, place: &str, file: &str) -> Option<MarkupPoints> {
        let path = self.path(place, file)?;
        let mut points = self.keep(mesh::read_points(&path))?;
        if self.must_turn(file, points.space) {
            turn(&mut points.points_mm);
        }
        Some(points)
    }

    fn keep<T>(&mut self, read: Result<(T, Vec<Fault>), Vec<Fault>>) -> Option<T> {
        let (value, faults) = match read {
            Ok((value, warnings)) => (Some(value), warnings),
            Err(faults) => (None, faults),
        };
        self.in_files.extend(faults);
        value
    }

    /// Notes a file's mark; unmarked files are in the scene's frame, and LPS is what all is turned to.
    fn must_turn(&mut self, file: &str, space: Option<Space>) -> bool {
        match space {
            Some(Space::LPS) => {}
            Some(Space::RAS) => self.marked_ras.push(file.to_owned()),
            None => self.unmarked.push(file.to_owned()),
        }
        space.is_none() && self.space == Space::RAS
    }

    /// One warning in all for files that do not say their frame; an error where others of the scene say RAS.
    pub(super) fn judge_frames(&mut self) {
        let [Some(unmarked), count] = [
            self.unmarked.first().cloned(),
            Some(self.unmarked.len().to_string()),
        ] else {
            return;
        };
        let count = count.unwrap_or_default();
        match (self.space, self.marked_ras.first()) {
            (Space::LPS, Some(ras)) => {
                let message = format!(
                    "is unclear: `{ras}` is marked RAS and `{unmarked}` has no SPACE mark: the parts might not fit together; mark \
                     it, or say `space = \"RAS\"` if unmarked files and coordinates are in RAS too"
                );
                self.error("space", message);
            }
            (Space::LPS, None) => {
                let message = format!("no SPACE mark in {count} files, `{unmarked}` the first: taken as LPS");
                self.warning("space", message);
            }
            (Space::RAS, _) => {
                let message = format!(
                    "no SPACE mark in {count} files, `{unmarked}` the first: taken as RAS, as the scene says"
                );
                self.warning("space", message);
            }
        }
    }

    /// The path of a file in the folder of what names it.
    fn path(&mut self, place: &str, file: &str) -> Option<PathBuf> {
        if let Err(message) = check_name(file, self.owner) {
            self.error(place, format!("is `{file}`, {message}"));
            return None;
        }
        let path = self.folder.join(file);
        // A link that leads nowhere or in circles is no missing file; the reader tells what it is.
        if std::fs::symlink_metadata(&path).is_err() {
            let advice = similar(&path).map_or(String::new(), |name| format!("; did you mean `{name}`?"));
            self.error(place, format!("is `{file}`, which does not exist{advice}"));
            return None;
        }
        if leads_out(&path, &self.folder) {
            self.error(
                place,
                format!(
                    "is `{file}`, a link that leads out of the {}'s folder; put the file into it",
                    self.owner
                ),
            );
            return None;
        }
        Some(path)
    }
}

/// Whether links on the way to a file lead out of the folder. Of what cannot be followed the reader tells why.
fn leads_out(path: &Path, folder: &Path) -> bool {
    match (path.canonicalize(), folder.canonicalize()) {
        (Ok(path), Ok(folder)) => !path.starts_with(folder),
        _ => false,
    }
}

/// Names that Windows takes for devices, with any ending: to read one may wait for ever.
fn is_device(name: &str) -> bool {
    let stem = name
        .split('.')
        .next()
        .unwrap_or_default()
        .trim_end()
        .to_ascii_uppercase();
    let numbered = |kind: &str| {
        let number = stem.strip_prefix(kind).unwrap_or_default();
        number.len() == 1 && number.as_bytes()[0].is_ascii_digit()
    };
    ["CON", "PRN", "AUX", "NUL"].contains(&stem.as_str()) || numbered("COM") || numbered("LPT")
}

/// Only names below the folder of what names them: a scene or a plan from elsewhere must not reach other files.
fn check_name(file: &str, owner: &str) -> Result<(), String> {
    let drive = file.as_bytes().get(1) == Some(&b':');
    if file.is_empty() {
        return Err("expected the name of a file".into());
    }
    if file.contains("://") {
        return Err(format!(
            "an address on a network; expected a file in the {owner}'s folder"
        ));
    }
    if file.starts_with(['/', '\\']) || drive {
        return Err(format!(
            "an absolute path; expected one relative to the {owner}'s folder"
        ));
    }
    let mut depth = 0_i32;
    for component in Path::new(file).components() {
        depth += match component {
            Component::ParentDir => -1,
            Component::Normal(_) => 1,
            _ => 0,
        };
        if depth < 0 {
            return Err(format!(
                "which leads out of the {owner}'s folder; put the file into it"
            ));
        }
    }
    if file.split(['/', '\\']).any(is_device) {
        return Err("the name of a device on Windows; rename the file".into());
    }
    if file.contains('\0') {
        return Err("which has a zero byte in it; expected the name of a file".into());
    }
    Ok(())
}

/// A file in the same folder whose name is nearly the same; where the folder is missing, one like it.
fn similar(path: &Path) -> Option<String> {
    let folder = path.parent()?;
    if !folder.exists() {
        return similar(folder);
    }
    let wanted = path.file_name()?.to_str()?;
    let entries = std::fs::read_dir(folder).ok()?;
    let mut names: Vec<String> = entries
        .take(10_000)
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .collect();
    names.sort_unstable();
    nearest(wanted, names.iter().map(String::as_str)).map(str::to_owned)
}

/// Half a turn about z, between RAS and LPS in either direction.
pub(super) fn turn(points: &mut [[f64; 3]]) {
    for point in points {
        // `0.0 - x` and not `-x`: a zero stays positive.
        *point = [0.0 - point[0], 0.0 - point[1], point[2]];
    }
}

/// Turns points and all arrays of three components, which are taken for vectors, as the readers do.
fn turn_mesh(mesh: &mut PolyData) {
    turn(&mut mesh.points);
    for array in mesh.point_arrays.iter_mut().chain(&mut mesh.cell_arrays) {
        if array.components == 3 {
            turn(array.values.as_chunks_mut().0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_files_below_the_folder_may_be_named() {
        for good in [
            "a.vtp",
            "meshes/a.vtp",
            "meshes/../a.vtp",
            "./a b.vtp",
            "..a.vtp",
            "null.vtp",
            "com.vtp",
        ] {
            assert_eq!(check_name(good, "scene"), Ok(()), "{good}");
        }
        for (bad, reason) in [
            ("", "the name of a file"),
            ("/etc/passwd", "absolute"),
            ("C:\\a.vtp", "absolute"),
            ("\\\\server\\a.vtp", "absolute"),
            ("https://a.b/c.vtp", "network"),
            ("../a.vtp", "out of the scene's folder"),
            ("a/../../b.vtp", "out of the scene's folder"),
            ("NUL", "device"),
            ("meshes/com1.vtp", "device"),
            ("a\0.vtp", "zero byte"),
        ] {
            assert!(check_name(bad, "scene").unwrap_err().contains(reason), "{bad}");
        }
        let of_plan = check_name("../a.vtp", "plan").unwrap_err();
        assert!(of_plan.contains("out of the plan's folder"), "{of_plan}");
    }
}

//! Several bodies in one model: sheets over height fields, who is held and where that goes.

use coapt::Vec3;
use coapt::energy::bending::Hinges;
use coapt::mesh::topology;
use coapt::model::{Model, Prescribed};
use coapt::scene::Contact;

use super::{jittered, jittered_in_plane};
use crate::hard::Jitter;
use crate::shapes::{Mesh, SpringTissue, sprung};

/// A body of the scene.
#[derive(Clone, Debug, Default)]
pub(super) struct Body {
    /// Its mesh where it begins, and in the shape in which it is at rest.
    pub(super) mesh: Mesh,
    /// Vertices that are held.
    pub(super) held: Vec<u32>,
    /// How far these go [mm].
    pub(super) way_mm: Vec3,
    /// Whether its points are moved sideways only, so that gaps over it stay what they are.
    pub(super) is_level: bool,
}

impl Body {
    /// A sheet held along its rim.
    pub(super) fn sheet(mesh: Mesh, way_mm: Vec3) -> Self {
        Self {
            held: mesh.rim.clone(),
            mesh,
            way_mm,
            is_level: false,
        }
    }

    /// A body that nothing holds but what touches it.
    pub(super) fn free(mesh: Mesh) -> Self {
        Self {
            mesh,
            ..Self::default()
        }
    }

    /// The same, its points moved sideways only.
    pub(super) fn level(self) -> Self {
        Self {
            is_level: true,
            ..self
        }
    }

    /// A body that does not give.
    pub(super) fn rigid(mesh: Mesh, way_mm: Vec3) -> Self {
        Self {
            held: (0..mesh.points_mm.len() as u32).collect(),
            mesh,
            way_mm,
            is_level: false,
        }
    }
}

/// What the bodies are made of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Matter {
    /// Springs along edges.
    pub(super) springs: SpringTissue,
    /// Plate stiffness [N·mm].
    pub(super) plate_n_mm: f64,
    pub(super) pressure_mpa: f64,
    pub(super) contact: Contact,
}

impl Default for Matter {
    /// A sheet of a millimetre that is as stiff as tissue beyond its knee.
    fn default() -> Self {
        Self {
            springs: SpringTissue::linear(1.0),
            plate_n_mm: 0.05,
            pressure_mpa: 0.0,
            contact: Contact {
                thickness_mm: 0.5,
                ..Contact::default()
            },
        }
    }
}

/// A model of bodies that are far from each other at rest, and where they begin: as the bodies say, moved a little.
///
/// Parts that are near each other at rest begin to touch at half the distance that they have there. Bodies of their own
/// keep their full thickness, however near they begin.
pub(super) fn assemble(bodies: &[Body], matter: &Matter, jitter: &mut Jitter) -> (Model, Vec<Vec3>) {
    let mut all = Mesh::default();
    let (mut lift_mm, mut prescribed) = (Vec::new(), Vec::new());
    let size_mm = bodies
        .iter()
        .flat_map(|body| &body.mesh.points_mm)
        .map(|x| x.norm())
        .fold(0.0, f64::max);
    for (index, body) in bodies.iter().enumerate() {
        let first = all.points_mm.len() as u32;
        let move_points = if body.is_level {
            jittered_in_plane
        } else {
            jittered
        };
        let mesh = move_points(body.mesh.clone(), jitter);
        for &vertex in &body.held {
            prescribed.push(Prescribed {
                vertex: first + vertex,
                target_mm: mesh.points_mm[vertex as usize] + body.way_mm,
            });
        }
        lift_mm.resize(
            lift_mm.len() + mesh.points_mm.len(),
            Vec3::z() * (4.0 * size_mm * index as f64),
        );
        all.faces
            .extend(mesh.faces.iter().map(|face| face.map(|vertex| first + vertex)));
        all.points_mm.extend(mesh.points_mm);
    }
    prescribed.sort_by_key(|held| held.vertex);
    let mut model = sprung(&all, matter.springs, matter.pressure_mpa);
    model.hinges = hinges(&all, matter.plate_n_mm);
    model.contact = matter.contact;
    model.prescribed = prescribed;
    for (rest, lift) in model.rest_mm.iter_mut().zip(lift_mm) {
        *rest += lift;
    }
    (model, all.points_mm)
}

/// One hinge per inner edge, as `Model::build` makes them.
pub(super) fn hinges(mesh: &Mesh, plate_n_mm: f64) -> Hinges {
    let edges = topology::edges(&mesh.faces);
    let at = |vertex: u32| mesh.points_mm[vertex as usize];
    let mut hinges = Hinges::default();
    for (edge, &[a, b]) in edges.ends.iter().enumerate() {
        let &[one, other] = edges.faces_of(edge) else {
            continue;
        };
        let across =
            [one, other].map(|face| mesh.faces[face as usize].into_iter().find(|&v| v != a && v != b));
        let [Some(c), Some(d)] = across else { continue };
        let cotangent = |p: Vec3, q: Vec3| p.dot(&q) / p.cross(&q).norm();
        let from_a = [c, d].map(|v| cotangent(at(b) - at(a), at(v) - at(a)));
        let from_b = [c, d].map(|v| cotangent(at(a) - at(b), at(v) - at(b)));
        let double_area = |v: u32| (at(b) - at(a)).cross(&(at(v) - at(a))).norm();
        hinges.vertices.push([a, b, c, d]);
        hinges.weights.push([
            from_b[0] + from_b[1],
            from_a[0] + from_a[1],
            -from_a[0] - from_b[0],
            -from_a[1] - from_b[1],
        ]);
        hinges
            .stiffness_n_per_mm
            .push(plate_n_mm / (0.5 * (double_area(c) + double_area(d))));
    }
    hinges
}

/// A sheet over the square of half side `half_mm`, n × n cells, at a height over each place; diagonals run outwards, as the
/// edges of pyramids do. Faces look along +z. The rim is listed.
pub(super) fn height_field(n: u32, half_mm: f64, height_mm: impl Fn(f64, f64) -> f64) -> Mesh {
    let mut mesh = Mesh::default();
    let along = |i: u32| half_mm * (2.0 * f64::from(i) / f64::from(n) - 1.0);
    for j in 0..=n {
        for i in 0..=n {
            if i == 0 || j == 0 || i == n || j == n {
                mesh.rim.push(mesh.points_mm.len() as u32);
            }
            let (x, y) = (along(i), along(j));
            mesh.points_mm.push(Vec3::new(x, y, height_mm(x, y)));
        }
    }
    for j in 0..n {
        for i in 0..n {
            let a = j * (n + 1) + i;
            let (b, c) = (a + 1, a + n + 1);
            let d = c + 1;
            let rises = (2 * i >= n) == (2 * j >= n);
            mesh.faces.extend(if rises {
                [[a, b, d], [a, d, c]]
            } else {
                [[a, b, c], [b, d, c]]
            });
        }
    }
    mesh
}

/// A flat rectangle of two faces, spanned by two sides from a corner.
pub(super) fn rectangle(corner: Vec3, side: Vec3, other: Vec3) -> Mesh {
    Mesh {
        points_mm: vec![corner, corner + side, corner + side + other, corner + other],
        faces: vec![[0, 1, 2], [0, 2, 3]],
        rim: vec![0, 1, 2, 3],
    }
}

/// A roof of two rectangles under or over a ridge.
pub(super) fn roof(ridge: [Vec3; 2], slope: Vec3, other: Vec3) -> Mesh {
    let [a, b] = ridge;
    Mesh {
        points_mm: vec![a, b, a + slope, b + slope, a + other, b + other],
        faces: vec![[0, 1, 3], [0, 3, 2], [1, 0, 4], [1, 4, 5]],
        rim: vec![],
    }
}

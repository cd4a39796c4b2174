//! Sheets blown up: from exactly flat, past limit points, wrinkled, slit.

use coapt::Vec3;
use coapt::model::Model;
use coapt::relax::Status;

use super::assembly::height_field;
use super::{count_in_pressure, jittered, jittered_in_plane, resting, uncertified, wrinkling};
use crate::hard::{HardCase, Jitter};
use crate::shapes::{
    Mesh, SpringTissue, add_spring, bag, cap, disk, hold, neo_hookean, skinned, sphere, sprung,
    st_venant_kirchhoff, taut,
};

pub(super) fn cases() -> Vec<HardCase> {
    let mut cases = disks();
    cases.extend(spheres());
    cases.extend(bags());
    cases.extend(flaps());
    cases
}

const RADIUS_MM: f64 = 10.0;

/// Under p a / (E h), E h being 1 N/mm.
fn disk_model(jitter: &mut Jitter, softness: f64, skin: impl Fn(&Mesh, f64) -> Model) -> Model {
    let mesh = jittered_in_plane(disk(6, RADIUS_MM), jitter);
    let mut model = skin(&mesh, softness / RADIUS_MM);
    hold(&mut model, &mesh.rim);
    count_in_pressure(&mut model);
    model
}

fn disks() -> Vec<HardCase> {
    const WHAT: &str = "exactly flat: pressure meets no stiffness at all at first";
    let mut cases = Vec::new();
    for softness in [1e-4, 1e-2, 0.3] {
        let springs = |mesh: &Mesh, p: f64| sprung(mesh, SpringTissue::linear(1.0), p);
        let stiff = |mesh: &Mesh, p: f64| skinned(mesh, taut(st_venant_kirchhoff(1.0, 0.3)), 1.0, p);
        let rubber = |mesh: &Mesh, p: f64| skinned(mesh, taut(neo_hookean(1.0 / 3.0)), 1.0, p);
        let slack = |mesh: &Mesh, p: f64| skinned(mesh, wrinkling(st_venant_kirchhoff(1.0, 0.3)), 1.0, p);
        cases.push(resting(
            format!("flat disk of springs, p a / E h = {softness}"),
            WHAT,
            move |jitter| disk_model(jitter, softness, springs),
        ));
        cases.push(resting(
            format!("flat disk of St. Venant-Kirchhoff membrane, p a / E h = {softness}"),
            WHAT,
            move |jitter| disk_model(jitter, softness, stiff),
        ));
        cases.push(resting(
            format!("flat disk of neo-Hookean membrane, p a / E h = {softness}"),
            WHAT,
            move |jitter| disk_model(jitter, softness, rubber),
        ));
        cases.push(resting(
            format!("flat disk that carries no compression, p a / E h = {softness}"),
            "exactly flat, and wrinkled wherever it is not taut",
            move |jitter| disk_model(jitter, softness, slack),
        ));
    }
    cases
}

/// A closed sphere held at one point.
fn sphere_model(jitter: &mut Jitter, skin: impl Fn(&Mesh) -> Model) -> Model {
    let mesh = jittered(sphere(3, RADIUS_MM), jitter);
    let mut model = skin(&mesh);
    hold(&mut model, &[0]);
    model
}

/// p R / (E h) that no sphere of linear springs outlasts.
const LIMIT: f64 = 0.75;

fn knee_sphere(jitter: &mut Jitter, ratio: f64, part_of_limit: f64) -> Model {
    let tissue = SpringTissue {
        stiff_n_per_mm: ratio,
        knee: 0.25,
        ..SpringTissue::linear(1.0)
    };
    sphere_model(jitter, |mesh| {
        sprung(mesh, tissue, part_of_limit * LIMIT / RADIUS_MM)
    })
}

fn spheres() -> Vec<HardCase> {
    let mut cases = vec![
        resting(
            "sphere of springs at 0.98 of its limit pressure",
            "next to a limit point: stretch grows without bound with pressure",
            |jitter| knee_sphere(jitter, 1.0, 0.98),
        ),
        uncertified(
            resting(
                "sphere of springs at 1.2 of its limit pressure",
                "past the limit point nothing holds it",
                |jitter| {
                    let mut model = knee_sphere(jitter, 1.0, 1.2);
                    model.settings.iteration_limit = 100;
                    model
                },
            ),
            &[Status::IterationLimit],
            "no sphere is at rest above the limit pressure",
        ),
    ];
    for ratio in [10.0, 100.0, 1000.0] {
        cases.push(resting(
            format!("sphere of springs past its limit point, {ratio} times as stiff beyond the knee"),
            "the soft branch cannot carry the pressure: every spring crosses the knee",
            move |jitter| knee_sphere(jitter, ratio, 2.0),
        ));
    }
    // p R / (mu h) is at most 1.2395, at a stretch of 1.383.
    cases.push(resting(
        "neo-Hookean sphere at 0.98 of its limit pressure",
        "next to a limit point",
        |jitter| {
            sphere_model(jitter, |mesh| {
                skinned(mesh, taut(neo_hookean(1.0)), 1.0, 0.98 * 1.2395 / RADIUS_MM)
            })
        },
    ));
    cases.push(resting(
        "St. Venant-Kirchhoff sphere blown up to twice its size",
        "strains of 150 %",
        |jitter| {
            sphere_model(jitter, |mesh| {
                let pressure_mpa = (2.0 - 0.5) / (1.0 - 0.45) / RADIUS_MM;
                skinned(mesh, taut(st_venant_kirchhoff(1.0, 0.45)), 1.0, pressure_mpa)
            })
        },
    ));
    cases.push(resting(
        "neo-Hookean cap past the limit point, its rim widened threefold",
        "pressure falls with stretch; the rim walks twice the radius",
        |jitter| {
            let stretch = 3.0_f64;
            let mesh = jittered(cap(6, RADIUS_MM, 1.0), jitter);
            let pressure_mpa = 2.0 * (1.0 / stretch - stretch.powi(-7)) / RADIUS_MM;
            let mut model = skinned(&mesh, taut(neo_hookean(1.0)), 1.0, pressure_mpa);
            hold(&mut model, &mesh.rim);
            for held in &mut model.prescribed {
                held.target_mm *= stretch;
            }
            model
        },
    ));
    cases
}

fn bags() -> Vec<HardCase> {
    const WHAT: &str = "exactly flat, hardly stretches, wrinkles everywhere";
    let bag_model = |jitter: &mut Jitter, skin: fn(&Mesh) -> Model| {
        let mesh = jittered_in_plane(bag(4, 16, RADIUS_MM), jitter);
        let mut model = skin(&mesh);
        hold(&mut model, &[0]);
        model
    };
    vec![
        resting("mylar balloon of springs", WHAT, move |jitter| {
            bag_model(jitter, |mesh| {
                let tissue = SpringTissue {
                    compression_ratio: 0.0,
                    ..SpringTissue::linear(1.0)
                };
                sprung(mesh, tissue, 1e-3 / RADIUS_MM)
            })
        }),
        resting("mylar balloon of membrane", WHAT, move |jitter| {
            bag_model(jitter, |mesh| {
                let tissue = wrinkling(st_venant_kirchhoff(1.0, 0.3));
                skinned(mesh, tissue, 1.0, 1e-3 / RADIUS_MM)
            })
        }),
        resting(
            "square airbag of 1.2 m diagonal, 5 kPa, E 588 MPa, 0.6 mm",
            "exactly flat, corners drawn in by wrinkles, p h / E of 1e-5",
            |jitter| {
                let mesh = jittered_in_plane(square_bag(8, 1200.0 / 2.0_f64.sqrt()), jitter);
                let tissue = wrinkling(st_venant_kirchhoff(588.0, 0.4));
                let mut model = skinned(&mesh, tissue, 0.6, 5e-3);
                hold(&mut model, &[0]);
                model
            },
        ),
    ]
}

/// Two flat squares of n × n cells sewn along their rims, vertex 0 a corner.
fn square_bag(n: u32, side_mm: f64) -> Mesh {
    let lower = height_field(n, 0.5 * side_mm, |_, _| 0.0);
    let count = lower.points_mm.len() as u32;
    let mut twin: Vec<u32> = (0..count).collect();
    let mut mesh = Mesh {
        points_mm: lower.points_mm.clone(),
        rim: lower.rim.clone(),
        ..Mesh::default()
    };
    for vertex in (0..count).filter(|vertex| !lower.rim.contains(vertex)) {
        twin[vertex as usize] = mesh.points_mm.len() as u32;
        mesh.points_mm.push(lower.points_mm[vertex as usize]);
    }
    for &[a, b, c] in &lower.faces {
        mesh.faces.push([a, c, b]);
        mesh.faces.push([a, b, c].map(|vertex| twin[vertex as usize]));
    }
    mesh
}

fn flaps() -> Vec<HardCase> {
    vec![
        resting(
            "disk slit to its middle",
            "pressure follows free lips: it has no energy, its tangent no symmetry",
            |jitter| {
                let mesh = jittered_in_plane(slit(disk(6, RADIUS_MM)), jitter);
                let mut model = sprung(&mesh, SpringTissue::linear(1.0), 1e-2 / RADIUS_MM);
                hold(&mut model, &mesh.rim);
                model
            },
        ),
        uncertified(
            resting(
                "triangle hinged on one side under pressure",
                "pressure turns it round and round",
                |jitter| {
                    let mut model = triangle(jitter);
                    model.settings.iteration_limit = 100;
                    model
                },
            ),
            &[Status::IterationLimit],
            "pressure that follows a hinged plate meets nothing",
        ),
        resting(
            "triangle hinged on one side, tied to a wall by a slack thread",
            "one free vertex; it swings until the thread is taut",
            |jitter| {
                let mut model = triangle(jitter);
                let wall = model.rest_mm.len() as u32;
                model.rest_mm.push(Vec3::new(0.0, 10.0, -1.0));
                model.leaflet_vertex_count += 1;
                add_spring(&mut model.springs, [2, wall], 12.0, 1.0);
                if let Some(compression) = model.springs.compression_n_per_mm.last_mut() {
                    *compression = 0.0;
                }
                hold(&mut model, &[0, 1, wall]);
                model
            },
        ),
    ]
}

fn triangle(jitter: &mut Jitter) -> Model {
    let mesh = Mesh {
        points_mm: [(-5.0, 0.0), (5.0, 0.0), (0.0, 10.0)]
            .map(|(x, y)| Vec3::new(x, y, 0.0))
            .to_vec(),
        faces: vec![[0, 1, 2]],
        rim: vec![],
    };
    let mut model = sprung(&jittered(mesh, jitter), SpringTissue::linear(1.0), 1e-3);
    hold(&mut model, &[0, 1]);
    model
}

/// Cuts a disk open along +x from its middle to its rim: lower faces get points of their own there.
fn slit(mut mesh: Mesh) -> Mesh {
    let along: Vec<u32> = (0..mesh.points_mm.len() as u32)
        .filter(|&v| {
            let point = mesh.points_mm[v as usize];
            point.x > 1e-6 && point.y.abs() < 1e-6
        })
        .collect();
    for vertex in along {
        let twin = mesh.points_mm.len() as u32;
        mesh.points_mm.push(mesh.points_mm[vertex as usize]);
        if mesh.rim.contains(&vertex) {
            mesh.rim.push(twin);
        }
        for face in &mut mesh.faces {
            let middle = face.iter().map(|&v| mesh.points_mm[v as usize].y).sum::<f64>();
            if middle < 0.0 {
                face.iter_mut().filter(|v| **v == vertex).for_each(|v| *v = twin);
            }
        }
    }
    mesh
}

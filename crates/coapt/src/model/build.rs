//! From a scene to a model: the steps in order, each refusing what the next could not bear.

use super::annulus::{self, Found};
use super::chordae::{self, LeftOut, Strung};
use super::elasticity::{Elasticity, Sheet, elasticity};
use super::faults::Faults;
use super::surface::{self, Surface};
use super::untangle::{self, Untangled};
use super::{AnnulusLandmarks, ChordGroup, LeafletTissue, Model, Papillary, Prescribed};
use super::{annulus_checks, cleaning, facing, mesh_quality, size, validate};
use crate::Vec3;
use crate::mesh::landmarks::{self, LandmarkInput};
use crate::mesh::polyline;
use crate::mesh::topology::{self, Chain, Edges};
use crate::scene::{Fault, Scene};

/// A model, and what the reader must know of how it came about.
#[derive(Clone, Debug)]
pub struct Built {
    /// The model.
    pub model: Model,
    /// Repairs of the input, guesses, doubts.
    pub warnings: Vec<Fault>,
    /// What crossed in the open valve and was drawn apart; nothing where nothing did.
    pub untangled: Option<Untangled>,
    /// Chordae that were given and are not in the model, by group.
    pub chordae_left_out: Vec<LeftOut>,
}

impl Model {
    /// Checks a scene and makes it ready to be closed.
    ///
    /// Leaflets are welded, cleaned and turned to the atrium, the annulus and its landmarks are found, spring and
    /// chord constants computed. What is repaired or guessed on the way is told in [`Built::warnings`].
    ///
    /// # Errors
    /// All faults found up to the step that cannot go on, at most 20 errors and 20 warnings and how many more.
    /// Mesh files must have been read into the scene (`coapt-io` does).
    pub fn build(scene: &Scene) -> Result<Built, Vec<Fault>> {
        let mut faults = Faults::default();
        size::check(scene, &mut faults);
        faults.stop()?;
        validate::scene(scene, &mut faults);
        faults.stop()?;
        surface::check_units(scene, &mut faults);
        faults.stop()?;
        let mut surface = surface::merge(scene, &mut faults);
        cleaning::clean(&mut surface, &mut faults);
        faults.stop()?;
        let edges = cleaning::check_shape(&mut surface, &mut faults);
        faults.stop()?;
        let tips: Vec<Vec3> = scene
            .papillary
            .iter()
            .flat_map(|m| &m.tips_mm)
            .map(|&t| Vec3::from(t))
            .collect();
        let mut loops = topology::chains(&topology::boundary_edges(&surface.faces, &edges));
        let found = annulus::find(&surface, &loops, scene, &tips, &mut faults);
        faults.stop()?;
        let mut found = found.ok_or_else(Vec::new)?;
        facing::face_atrium(&mut surface, &mut found, &mut loops, &tips, &mut faults);
        let mut strung = chordae::string(scene, &surface, &tips, &mut faults);
        let chordae_left_out = std::mem::take(&mut strung.left_out);
        check_ties(&surface, &edges, &found, &strung, &mut faults);
        annulus_checks::check_insertions(&surface, &found, &strung.chords.points, &mut faults);
        faults.stop()?;
        let mut untangled = None;
        if scene.contact.is_on() {
            // Chordae are tied to the leaflets by now: they were drawn where these stood.
            let thickness_mm = scene.contact.thickness_mm;
            untangled = untangle::untangle(
                &mut surface,
                &edges,
                &found.annulus.vertices,
                thickness_mm,
                &mut faults,
            );
            faults.stop()?;
        }
        annulus_checks::tell_holes(&surface, &found, &loops, &mut faults);
        let model = assemble(scene, &surface, &edges, &found, &loops, strung, &mut faults);
        faults.stop()?;
        Ok(Built {
            model,
            warnings: faults.into_warnings(),
            untangled,
            chordae_left_out,
        })
    }
}

/// Fewer chord ends than this let a piece of tissue turn about the line through them.
const FEWEST_ENDS: usize = 3;

/// Every connected part of the leaflets must hang on the annulus, or on chordae from which it cannot turn away.
fn check_ties(surface: &Surface, edges: &Edges, found: &Found, strung: &Strung, faults: &mut Faults) {
    let (component, count) = topology::components(surface.faces.len(), edges);
    let mut part_of = vec![None; surface.points.len()];
    let mut size = vec![0; count];
    for (face, &part) in component.iter().enumerate() {
        size[part as usize] += 1;
        for &vertex in &surface.faces[face] {
            part_of[vertex as usize] = Some(part as usize);
        }
    }
    let part = |vertex: &u32| part_of.get(*vertex as usize).copied().flatten();
    let mut on_annulus = vec![false; count];
    let held = found.annulus.vertices.iter().filter_map(part);
    held.for_each(|part| on_annulus[part] = true);
    let mut ends = vec![0; count];
    for point in &strung.chords.points {
        if let Some(part) = point.iter().find_map(|(vertex, _)| part(vertex)) {
            ends[part] += 1;
        }
    }
    for part in (0..count).filter(|&part| !on_annulus[part] && ends[part] < FEWEST_ENDS) {
        let first = component.iter().position(|&c| c as usize == part).unwrap_or(0);
        let why = match ends[part] {
            0 => "no annulus and no chord holds it".to_owned(),
            ends => format!("no annulus holds it, and {ends} chord ends let it turn"),
        };
        let message = format!("a component of {} faces is free to fly away: {why}", size[part]);
        faults.error(surface.face_name(first), message);
    }
}

fn assemble(
    scene: &Scene,
    surface: &Surface,
    edges: &Edges,
    found: &Found,
    loops: &[Chain],
    strung: Strung,
    faults: &mut Faults,
) -> Model {
    let mut rest_mm = surface.points.clone();
    rest_mm.extend(strung.nodes);
    let (papillary, tip_targets) = tips(scene, &mut rest_mm);
    let mut prescribed = annulus_targets(surface, found);
    prescribed.extend(tip_targets);
    let leaflet_vertex_count = surface.points.len();
    if found.annulus.vertices.len() == leaflet_vertex_count {
        faults.warning("leaflets", "every leaflet point is annulus: nothing can move");
    }
    let tissue = |leaflet: &crate::scene::Leaflet| LeafletTissue {
        name: leaflet.name.clone(),
        thickness_mm: leaflet.thickness_mm,
        tissue: leaflet.tissue,
    };
    let leaflets: Vec<LeafletTissue> = scene.leaflets.iter().map(tissue).collect();
    let sheet = Sheet {
        rest_mm: &surface.points,
        faces: &surface.faces,
        face_leaflet: &surface.face_leaflet,
        annulus: &found.annulus.vertices,
        leaflets: &leaflets,
    };
    mesh_quality::tell(&sheet, edges, surface, faults);
    let Elasticity {
        springs,
        membranes,
        hinges,
    } = elasticity(&sheet, edges);
    Model {
        name: scene.name.clone(),
        landmarks: find_landmarks(scene, surface, edges, found, faults),
        springs,
        membranes,
        hinges,
        chords: strung.chords,
        rest_mm,
        leaflet_vertex_count,
        faces: surface.faces.clone(),
        face_leaflet: surface.face_leaflet.clone(),
        leaflets,
        chord_groups: scene
            .chordae
            .iter()
            .map(|group| ChordGroup::chordae(&group.name))
            .collect(),
        pressure_mpa: scene.load.pressure_mpa().unwrap_or(0.0),
        dead_loads_n: Vec::new(),
        contact: scene.contact,
        annulus: found.annulus.vertices.clone(),
        margins: annulus::margins(found, loops),
        papillary,
        prescribed,
        settings: scene.settings,
    }
}

/// Appends the tips as vertices; gives each muscle's vertices and each tip's target.
fn tips(scene: &Scene, rest_mm: &mut Vec<Vec3>) -> (Vec<Papillary>, Vec<Prescribed>) {
    let (mut papillary, mut targets) = (Vec::new(), Vec::new());
    for muscle in &scene.papillary {
        let first = rest_mm.len() as u32;
        for (tip, &at) in muscle.tips_mm.iter().enumerate() {
            let motion = muscle.displacements_mm.get(tip).copied().unwrap_or_default();
            let vertex = rest_mm.len() as u32;
            rest_mm.push(Vec3::from(at));
            targets.push(Prescribed {
                vertex,
                target_mm: Vec3::from(at) + Vec3::from(motion),
            });
        }
        papillary.push(Papillary {
            name: muscle.name.clone(),
            tips: (first..rest_mm.len() as u32).collect(),
        });
    }
    (papillary, targets)
}

fn annulus_targets(surface: &Surface, found: &Found) -> Vec<Prescribed> {
    let mut vertices = found.annulus.vertices.clone();
    vertices.sort_unstable();
    let target = |vertex: u32| {
        let motion = surface.displacement[vertex as usize].unwrap_or_else(Vec3::zeros);
        surface.points[vertex as usize] + motion
    };
    let prescribe = |vertex| Prescribed {
        vertex,
        target_mm: target(vertex),
    };
    vertices.into_iter().map(prescribe).collect()
}

fn find_landmarks(
    scene: &Scene,
    surface: &Surface,
    edges: &Edges,
    found: &Found,
    faults: &mut Faults,
) -> AnnulusLandmarks {
    let ring = annulus::positions(surface, &found.ring);
    let mean = |tips: &[[f64; 3]]| tips.iter().map(|&t| Vec3::from(t)).sum::<Vec3>() / tips.len() as f64;
    let muscles = scene.papillary.iter().filter(|muscle| !muscle.tips_mm.is_empty());
    let papillary: Vec<(&str, Vec3)> = muscles.map(|m| (m.name.as_str(), mean(&m.tips_mm))).collect();
    let names: Vec<&str> = scene
        .leaflets
        .iter()
        .map(|leaflet| leaflet.name.as_str())
        .collect();
    let (landmarks, warnings) = landmarks::find(&LandmarkInput {
        annulus_mm: &annulus::positions(surface, &found.annulus.vertices),
        edge_leaflet: &edge_leaflets(surface, edges, &found.annulus.vertices),
        leaflet_names: &names,
        atrial: polyline::vector_area(&ring).normalize(),
        papillary: &papillary,
        named: &scene.landmarks,
    });
    faults.extend(warnings);
    landmarks
}

/// The leaflet at each annulus edge; none where two annulus vertices in order share no boundary edge.
fn edge_leaflets(surface: &Surface, edges: &Edges, annulus: &[u32]) -> Vec<Option<u32>> {
    let next = annulus.iter().cycle().skip(1);
    let leaflet = |(&a, &b): (&u32, &u32)| {
        let edge = edges.ends.binary_search(&[a.min(b), a.max(b)]).ok()?;
        let face = edges.faces_of(edge).first()?;
        Some(surface.face_leaflet[*face as usize])
    };
    annulus.iter().zip(next).map(leaflet).collect()
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{COLUMNS, ROWS, built, faults, lines, mesh, skirt, skirt_point, told};
    use super::*;

    #[test]
    fn a_good_valve_builds_without_a_word() {
        let Built { model, warnings, .. } = built(&skirt());
        // Its rectangles, each cut in two, are no mesh for springs.
        let is_other = |fault: &Fault| !fault.message.contains("too irregular for springs");
        assert!(!warnings.iter().any(is_other), "{warnings:#?}");
        assert_eq!(model.leaflet_vertex_count, COLUMNS * ROWS);
        assert_eq!(model.rest_mm.len(), COLUMNS * ROWS + 2 + 2);
        assert_eq!(model.faces.len(), COLUMNS * (ROWS - 1) * 2);
        assert_eq!(model.annulus.len(), COLUMNS);
        assert_eq!((model.margins.len(), model.margins[0].closed), (1, true));
        assert_eq!(model.margins[0].vertices.len(), COLUMNS);
        assert!(model.prescribed.is_sorted_by(|a, b| a.vertex < b.vertex));
        assert_eq!(model.prescribed.len(), COLUMNS + 2);
        let ring: Vec<Vec3> = model.annulus.iter().map(|&v| model.rest_mm[v as usize]).collect();
        assert!(
            polyline::vector_area(&ring).z > 0.0,
            "counter-clockwise seen from the atrium"
        );
    }

    #[test]
    fn landmarks_come_from_the_leaflet_borders() {
        let model = built(&skirt()).model;
        let at = |index: usize| model.rest_mm[model.annulus[index] as usize];
        let marks = model.landmarks;
        assert_eq!(at(marks.commissure_anterolateral), Vec3::from(skirt_point(10, 0)));
        assert_eq!(at(marks.commissure_posteromedial), Vec3::from(skirt_point(2, 0)));
        assert_eq!(at(marks.mid_anterior), Vec3::from(skirt_point(6, 0)));
        assert_eq!(at(marks.mid_posterior), Vec3::from(skirt_point(18, 0)));
        assert!(at(marks.trigone_left).x < 0.0 && at(marks.trigone_right).x > 0.0);
    }

    #[test]
    fn motions_become_targets() {
        let mut scene = skirt();
        scene.papillary[0].displacements_mm = vec![[0.0, 0.0, 1.5]];
        let count = mesh(&mut scene, 0).points_mm.len();
        mesh(&mut scene, 0).annulus_displacement_mm = Some(vec![[1.0, 0.0, 0.0]; count]);
        let model = built(&scene).model;
        let moved = |v: u32| {
            let target = model.prescribed.iter().find(|p| p.vertex == v).unwrap().target_mm;
            target - model.rest_mm[v as usize]
        };
        assert_eq!(moved(model.papillary[0].tips[0]), Vec3::new(0.0, 0.0, 1.5));
        assert_eq!(moved(model.annulus[model.landmarks.mid_anterior]), Vec3::x());
        assert_eq!(moved(model.annulus[model.landmarks.mid_posterior]), Vec3::zeros());
    }

    #[test]
    fn an_island_is_told() {
        let mut scene = skirt();
        let surface = mesh(&mut scene, 1);
        let first = surface.points_mm.len() as u32;
        surface
            .points_mm
            .extend([[0.0, 0.0, -10.0], [1.0, 0.0, -10.0], [0.0, 1.0, -10.0]]);
        surface.faces.push([first, first + 1, first + 2]);
        assert!(told(
            &faults(&scene),
            "leaflets[1].mesh face 64",
            "component of 1 faces is free to fly away"
        ));
    }

    #[test]
    fn unreadable_units_are_guessed() {
        for (factor, unit) in [(1e-3, "metres"), (0.1, "centimetres"), (1e3, "micrometres")] {
            let mut scene = skirt();
            for leaflet in 0..2 {
                mesh(&mut scene, leaflet)
                    .points_mm
                    .iter_mut()
                    .flatten()
                    .for_each(|c| *c *= factor);
            }
            assert!(told(&faults(&scene), "leaflets", unit));
        }
    }

    #[test]
    fn equal_scenes_give_equal_models() {
        let (a, b) = (built(&skirt()).model, built(&skirt()).model);
        assert_eq!(format!("{a:?}"), format!("{b:?}"));
    }

    /// Numbers that look random and are the same every time (Knuth's multiplier, 64 bit).
    struct Dice(u64);

    impl Dice {
        fn below(&mut self, count: usize) -> usize {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 33) as usize % count
        }

        fn nasty(&mut self) -> f64 {
            let values = [
                f64::NAN,
                f64::INFINITY,
                -1.0,
                0.0,
                1e-320,
                1e300,
                5.0,
                -20.0,
                1e6,
                0.011,
                15.0,
                -14.0,
            ];
            values[self.below(values.len())]
        }

        fn spoil(&mut self, scene: &mut Scene) {
            let leaflet = self.below(2);
            let (point, axis) = (self.below(27), self.below(3));
            match self.below(12) {
                0 => mesh(scene, leaflet).points_mm[point][axis] = self.nasty(),
                1 => mesh(scene, leaflet).faces[point % 14][axis] = self.below(28) as u32,
                2 => mesh(scene, leaflet).faces.truncate(14 + point),
                3 => {
                    mesh(scene, leaflet).annulus_points =
                        Some((0..self.below(9) as u32 * 3).step_by(3).collect())
                }
                4 => lines(scene).points_mm[point % 8][axis] = self.nasty(),
                5 => lines(scene).segments[point % 6][axis % 2] = self.below(9) as u32,
                6 => scene.weld.tolerance_mm = self.nasty(),
                7 => scene.weld.insertion_tolerance_mm = self.nasty(),
                8 => scene.papillary[leaflet].tips_mm[0][axis] = self.nasty(),
                9 => {
                    scene.annulus.curve_mm = Some((0..self.below(30)).map(|c| skirt_point(c, axis)).collect())
                }
                10 => mesh(scene, leaflet).faces[point % 14].swap(0, 1),
                _ => scene.landmarks.mid_anterior_mm = Some([self.nasty(), 0.0, 0.0]),
            }
        }
    }

    #[test]
    fn no_scene_brings_it_down_and_no_model_holds_nonsense() {
        let mut dice = Dice(1);
        let mut good = 0;
        for _ in 0..4000 {
            let mut scene = skirt();
            (0..1 + dice.below(3)).for_each(|_| dice.spoil(&mut scene));
            let Ok(Built { model, .. }) = Model::build(&scene) else {
                continue;
            };
            good += 1;
            let count = model.rest_mm.len() as u32;
            let springs = &model.springs;
            let constants = [
                &springs.rest_length_mm,
                &springs.soft_n_per_mm,
                &model.chords.rest_length_mm,
            ];
            assert!(constants.into_iter().flatten().all(|c| c.is_finite() && *c > 0.0));
            assert!(model.rest_mm.iter().flatten().all(|c| c.is_finite()));
            assert!(
                model
                    .faces
                    .iter()
                    .flatten()
                    .chain(model.chords.ends.iter().flatten())
                    .all(|&v| v < count)
            );
            assert!(model.landmarks.mid_posterior < model.annulus.len());
            assert!(model.prescribed.is_sorted_by(|a, b| a.vertex < b.vertex));
        }
        assert!(
            good > 400,
            "only {good} of 4000 were good: the dice spoil too much to test anything"
        );
    }
}

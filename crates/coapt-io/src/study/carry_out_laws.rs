//! Carrying a study of laws out: every mesh under every law, each against the finest mesh of its law and the first law of its mesh.

use coapt::energy::membrane::may_newman::{ANTERIOR, POSTERIOR};
use coapt::measure::{measure, visible_distance};
use coapt::model::Model;
use coapt::relax::Equilibrium;
use coapt::scene::{Fault, Leaflet, Scene};
use coapt::tissue_fit::each_law::{Told, in_each_law};

use super::{
    Close, ERROR_OF_LAWS_MEANS, LAWS_SCHEMA, LawRow, LawStudy, MODEL_ERROR_MEANS, REFERENCE, median_time,
};
use crate::report::NOTICE;

/// One mesh of the valve.
pub struct MeshOfLaws<'a> {
    /// As it is given.
    pub scene: &'a Scene,
    /// Makes the valve of that scene under another tissue.
    pub build: &'a dyn Fn(Scene) -> Result<Model, Vec<Fault>>,
}

/// The tissues of a valve told in each law.
#[derive(Clone, Debug, PartialEq)]
pub struct Laws {
    anterior: Vec<Told>,
    /// Of whatever is not the anterior leaflet.
    posterior: Vec<Told>,
}

impl Laws {
    /// May-Newman's leaflets in each law.
    ///
    /// # Errors
    /// As of [`in_each_law`]: none with those constants.
    pub fn new() -> Result<Self, Vec<Fault>> {
        Ok(Self {
            anterior: in_each_law(&ANTERIOR)?,
            posterior: in_each_law(&POSTERIOR)?,
        })
    }

    /// How many laws there are: so many times the meshes and the repeats are closed, and each reference once.
    pub fn count(&self) -> usize {
        self.anterior.len()
    }

    fn of(&self, leaflet: &Leaflet, number: usize) -> &Told {
        match leaflet.name.as_str() {
            "anterior" => &self.anterior[number],
            _ => &self.posterior[number],
        }
    }

    /// The valve under a law: all that differs between the closures of a mesh.
    fn model(&self, mesh: &MeshOfLaws, number: usize, say: &dyn Fn(&str)) -> Result<Model, Vec<Fault>> {
        let mut scene = mesh.scene.clone();
        for leaflet in &mut scene.leaflets {
            leaflet.tissue = self.of(leaflet, number).tissue;
        }
        let law = scene.leaflets[0].tissue.law_name();
        let model = (mesh.build)(scene)?;
        say(&format!("{} triangles, {law} ...", model.faces.len()));
        Ok(model)
    }
}

/// Closes one valve under every law, coarsest mesh first; `finest` is the mesh that errors are measured against, `say` is told what is
/// done.
///
/// # Errors
/// A valve that cannot be built under a law.
pub fn carry_out_laws(
    meshes: &[MeshOfLaws],
    finest: Option<&MeshOfLaws>,
    laws: &Laws,
    repeats: u16,
    close: Close,
    say: &dyn Fn(&str),
) -> Result<LawStudy, Vec<Fault>> {
    // Law by law, so that one closed reference at a time is enough.
    let mut of_law: Vec<Vec<LawRow>> = Vec::new();
    let mut firsts: Vec<Closure> = Vec::new();
    let mut reference_faces = None;
    for number in 0..laws.count() {
        let reference = match finest {
            Some(finest) => {
                let model = laws.model(finest, number, say)?;
                let (closed, _) = close(REFERENCE, &model);
                Some(Closure { model, closed })
            }
            None => None,
        };
        reference_faces = reference.as_ref().map(|reference| reference.model.faces.len());
        let mut rows = Vec::new();
        for (place, mesh) in meshes.iter().enumerate() {
            let model = laws.model(mesh, number, say)?;
            let (closed, wall_ms) = median_time(&model, repeats, close);
            let closure = Closure { model, closed };
            let told = mesh.scene.leaflets.iter().map(|leaflet| laws.of(leaflet, number));
            rows.push(LawRow {
                curve_error: told.map(|told| told.relative_error).collect(),
                ..row(&closure, wall_ms, reference.as_ref(), firsts.get(place))
            });
            if number == 0 {
                firsts.push(closure);
            }
        }
        of_law.push(rows);
    }
    let first = meshes.first().map(|mesh| mesh.scene);
    let leaflets = first.into_iter().flat_map(|scene| &scene.leaflets);
    Ok(LawStudy {
        schema: LAWS_SCHEMA.into(),
        version: env!("CARGO_PKG_VERSION").into(),
        notice: NOTICE.into(),
        mesh_error: ERROR_OF_LAWS_MEANS.into(),
        model_error: MODEL_ERROR_MEANS.into(),
        case: first.map(|scene| scene.name.clone()).unwrap_or_default(),
        repeats,
        reference_faces,
        leaflets: leaflets.map(|leaflet| leaflet.name.clone()).collect(),
        rows: (0..meshes.len())
            .flat_map(|place| of_law.iter().map(move |rows| rows[place].clone()))
            .collect(),
    })
}

/// A valve closed under a law.
struct Closure {
    model: Model,
    closed: Equilibrium,
}

impl Closure {
    fn certified(&self) -> bool {
        self.closed.certificate.is_certified(self.closed.status)
    }
}

/// A row but for how far its law is from the tissue's curve.
fn row(closure: &Closure, wall_ms: f64, reference: Option<&Closure>, first: Option<&Closure>) -> LawRow {
    let (model, closed) = (&closure.model, &closure.closed);
    let positions_mm = &closed.state.positions_mm;
    let measures = measure(model, positions_mm, &closed.reactions_n);
    let distance = |other: &Closure| {
        let there = &other.closed.state.positions_mm;
        visible_distance(model, positions_mm, &other.model, there).filter(|_| other.certified())
    };
    LawRow {
        faces: model.faces.len(),
        tissues: model.leaflets.iter().map(|leaflet| leaflet.tissue).collect(),
        curve_error: Vec::new(),
        status: closed.status,
        certified: closure.certified(),
        residual: closed.certificate.residual,
        iterations: closed.history.len(),
        wall_ms,
        mesh_error: reference.and_then(distance),
        model_error: first.and_then(distance),
        coaptation_area_mm2: measures.coaptation.area_mm2,
        orifice_area_mm2: measures.orifice.area_mm2,
        largest_chord_force_n: measures.chords.max_force_n,
    }
}

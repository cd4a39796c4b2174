//! Looking on while a valve closes, and stopping it.

use std::ops::ControlFlow;

use super::Iteration;
use crate::Vec3;
use crate::model::Model;

/// What a watcher is shown after each iteration.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// Iterations so far on all meshes, this one among them.
    pub count: usize,
    /// The iteration that was just made.
    pub iteration: Iteration,
    /// The valve that it worked on: the one given, or the same with softer chordae, or a coarser one.
    pub model: &'a Model,
    /// Where the vertices of that valve now are [mm], shape `[vertex]`.
    pub positions_mm: &'a [Vec3],
}

/// Asked after each iteration whether to go on.
pub(super) type Watch<'w> = &'w mut dyn FnMut(&Moment) -> ControlFlow<()>;

/// The history of a closure, and whoever looks on.
#[derive(Default)]
pub(super) struct Log<'w> {
    pub(super) history: Vec<Iteration>,
    watch: Option<Watch<'w>>,
    /// The watcher has said stop.
    pub(super) interrupted: bool,
}

impl<'w> Log<'w> {
    pub(super) fn watched(watch: Watch<'w>) -> Self {
        Self {
            watch: Some(watch),
            ..Self::default()
        }
    }

    /// Iterations that the settings of a valve still allow on its own mesh.
    pub(super) fn iterations_left(&self, model: &Model) -> u32 {
        let is_own = |iteration: &&Iteration| iteration.faces == model.faces.len();
        let made = self.history.iter().filter(is_own).count();
        let limit = model.settings.iteration_limit;
        limit.saturating_sub(u32::try_from(made).unwrap_or(u32::MAX))
    }

    /// Notes an iteration; breaks where the watcher says so.
    pub(super) fn note(
        &mut self,
        iteration: Iteration,
        model: &Model,
        positions_mm: &[Vec3],
    ) -> ControlFlow<()> {
        self.history.push(iteration);
        let Some(watch) = &mut self.watch else {
            return ControlFlow::Continue(());
        };
        let told = watch(&Moment {
            count: self.history.len(),
            iteration,
            model,
            positions_mm,
        });
        self.interrupted |= told.is_break();
        told
    }
}

//! Contact between mid-surfaces: what may touch, how near it is, and the penalty that keeps it apart.
//!
//! * [`surface`]: the triangles that can touch, with their edges, constant while relaxing.
//! * [`patches`]: what lies side by side, in patches of eight.
//! * [`broad`]: sweep and prune over boxes.
//! * [`nearest`]: closest points of point-triangle and edge-edge pairs.
//! * [`pairs`]: two parts and where they begin to touch.
//! * `reach`: which of many pairs are in reach of each other.
//! * [`gather`]: which pairs may touch during a step.
//! * `listing`: a list of pairs that holds for more than one step.
//! * [`touch`]: the pairs that do touch, and how their closest points slide and fade.
//! * [`penalty`]: energy, gradient and Hessian of those.
//! * [`step_bound`]: how far each vertex may move so that nothing passes through anything.
//! * [`crossing`]: the exact test whether two faces cross.
//! * [`tangle`]: where they cross, or touch, and which bodies are inside out.
//!
//! Law: contact begins at the thickness d̂ and is rigid, nearly, at d₀ < d̂. With s = (d − d₀) / δ, δ = d̂ − d₀, for a pair
//! at distance d, each unit of area stores κ δ (1 − s)³ / s, which begins smoothly (C²) at d̂; below s = 0.2 it goes on as
//! a parabola. Mid-surfaces in one place would push each other apart by a thousand systolic pressures or more, so that no
//! equilibrium has any; and what keeps them from passing through each other is [`step_bound`], not the law.

pub mod broad;
pub mod crossing;
pub mod gather;
mod listing;
pub mod nearest;
pub mod pairs;
pub mod patches;
pub mod penalty;
mod reach;
pub mod step_bound;
pub mod surface;
pub mod tangle;
pub mod touch;

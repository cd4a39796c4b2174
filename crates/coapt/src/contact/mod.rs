//! Contact between mid-surfaces: what may touch, how near it is, and the penalty that keeps it apart.
//!
//! * [`surface`]: the triangles that can touch, with their edges, constant while relaxing.
//! * [`broad`]: sweep and prune over triangle boxes, kept sorted from call to call.
//! * [`nearest`]: closest points of point-triangle and edge-edge pairs (the only file that names parry).
//! * [`pairs`]: the list of near pairs and how long it stays valid.
//! * [`penalty`]: energy, gradient and Hessian of the near pairs.
//! * [`step_bound`]: how far each vertex may move so that nothing passes through anything.
//! * [`crossing`]: the exact test whether two faces cross.
//!
//! Law: with s = d / d̂ for a pair at distance d and contact thickness d̂, each unit of area stores
//! κ d̂ (1 − s)³ / s. It begins smoothly (C²) at d = d̂ and grows without bound as d → 0, so that an equilibrium
//! never has two mid-surfaces in one place.

pub mod broad;
pub mod crossing;
pub mod nearest;
pub mod pairs;
pub mod penalty;
pub mod step_bound;
pub mod surface;

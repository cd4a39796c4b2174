//! Triangles, edges, loops, landmarks; the parametric valve.

mod anterior_arc;
pub mod landmarks;
pub mod parametric;
pub mod point_grid;
pub mod polyline;
pub mod topology;
pub(crate) mod ways;

//! Triangles, edges, loops, landmarks; the parametric valve.

pub mod parametric;

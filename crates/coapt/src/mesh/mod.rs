//! Triangles, edges, loops, landmarks; the parametric valve.

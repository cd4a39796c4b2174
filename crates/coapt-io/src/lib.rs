//! Reading and writing.

pub mod atomic;

pub mod mesh;

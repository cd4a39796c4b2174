//! Reading and writing.

pub mod atomic;

pub mod biaxial;

pub mod mesh;

pub mod scene;

pub mod report;

pub mod study;

//! Reading and writing.

pub mod atomic;

pub mod compare;

pub mod biaxial;

pub mod mesh;

pub mod scene;

pub mod export;

pub mod report;

pub mod study;

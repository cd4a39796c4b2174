//! Reading and writing.

pub mod atomic;

mod encoding;

pub mod escape;

pub mod mesh;

pub mod scene;

pub mod biaxial;

pub mod export;

pub mod report;

pub mod check;

pub mod tissue;

pub mod record;

pub mod compare;

pub mod study;

pub mod plan;

pub mod page;

pub mod picture;

pub mod personalise;

//! The forces, one file per law: value, gradient and Hessian blocks.

pub mod bilinear_spring;
pub mod chord;

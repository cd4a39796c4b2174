//! coapt predicts how a mitral valve closes.
//!
//! The modules stand in the order of the data flow, and each uses only those above it:
//!
//! ```text
//! Scene --build--> Model --apply(Repair)*--> Model' --relax(State)--> Equilibrium --measure--> Measures
//! ```
//!
//! Units everywhere: mm, N, MPa (= N/mm²). Only pressure also has clinical units, and then in its name.
//! Face normals point to the atrium, which is where systolic pressure pushes.

pub mod scene;

pub mod simd;

pub mod mesh;

pub mod energy;

pub mod contact;

pub mod model;

pub mod repair;

pub mod state;

pub mod coarsen;

pub mod relax;

pub mod measure;

pub mod film;

pub mod sensitivity;

pub mod search;

pub mod plan;

pub mod personalise;

pub mod tissue_fit;

#[cfg(test)]
mod test_numbers;

/// A point or a vector in space [mm] unless said otherwise.
pub type Vec3 = nalgebra::Vector3<f64>;
/// A 3×3 matrix, the size of one block of a Hessian [N/mm].
pub type Mat3 = nalgebra::Matrix3<f64>;

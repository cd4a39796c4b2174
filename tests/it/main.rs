//! The integration tests: one binary, a module per subject.

mod bad_inputs;
mod closure;
mod contact;
mod derivatives;

//! The integration tests: one binary, a module per subject.

mod closure;
mod contact;
mod derivatives;

//! The integration tests: one binary, a module per subject.

mod allocation;
mod bad_inputs;
mod calculix;
mod closure;
mod coarsen;
mod contact;
mod derivatives;
mod fuzzed;
mod hard;
mod kaiser;
mod laws;
mod personalise;
mod roads;
mod stress;
mod tables;
mod texas;
mod verification;

//! The integration tests: one binary, a module per subject.

mod allocation;
mod bad_inputs;
mod calculix;
mod closure;
mod coarsen;
mod contact;
mod derivatives;
mod distances;
mod film;
mod fuzzed;
mod hard;
mod kaiser;
mod laws;
mod personalise;
mod properties;
mod repairs;
mod roads;
mod sensitivity;
mod shapes;
mod tables;
mod texas;
mod verification;
mod watch;

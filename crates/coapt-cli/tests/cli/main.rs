//! The program as its users meet it, a module per verb.

mod closure;
mod compare;
mod export;
mod faults;
mod film;
mod hard;
mod interruption;
mod limits;
mod personalise;
mod plan;
mod program;
mod real_data;
mod study;
mod words;

//! Distances, crossings and boxes against exact arithmetic, which is written here: whole numbers without end.

mod broad;
mod configurations;
mod crossing;
mod exact;
mod moving;
mod nearest;

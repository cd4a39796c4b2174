//! What is wrong with a file, each fault with its place; up to twenty before reading stops.

use coapt::scene::{Fault, Severity};

/// Reading goes no further; why is already among the [`Faults`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Stop;

/// Where in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// Nowhere in particular.
    File,
    /// Line of a text file, from 1.
    Line(usize),
    /// Offset in a binary file, from 0.
    Byte(usize),
    /// A point, face or line cell, and its number from 0 in the order of the file.
    Element(&'static str, usize),
}

/// The faults of one file.
#[derive(Debug)]
pub(super) struct Faults {
    /// Path of the file, as the user gave it.
    pub(super) file: String,
    /// In the order of reading.
    pub(super) list: Vec<Fault>,
    warnings: usize,
}

/// Errors after which reading stops, and warnings after which they are only counted: enough to see the pattern.
const ERROR_LIMIT: usize = 20;
const WARNING_LIMIT: usize = 20;

impl Faults {
    /// No faults yet.
    pub(super) fn new(file: String) -> Self {
        Self {
            file,
            list: Vec::new(),
            warnings: 0,
        }
    }

    /// Notes an error and lets reading go on to find more, unless there are enough.
    pub(super) fn error(&mut self, place: Place, message: impl Into<String>) -> Result<(), Stop> {
        let place = self.place(place);
        self.list.push(Fault::error(place, message));
        if self.error_count() < ERROR_LIMIT {
            return Ok(());
        }
        let place = self.file.clone();
        self.list.push(Fault::error(
            place,
            format!("{ERROR_LIMIT} errors: reading stopped, there may be more"),
        ));
        Err(Stop)
    }

    /// Notes an error after which the rest of the file makes no sense.
    pub(super) fn fatal(&mut self, place: Place, message: impl Into<String>) -> Stop {
        let place = self.place(place);
        self.list.push(Fault::error(place, message));
        Stop
    }

    /// Notes something that was repaired or assumed.
    pub(super) fn warning(&mut self, place: Place, message: impl Into<String>) {
        self.warnings += 1;
        if self.warnings <= WARNING_LIMIT {
            let place = self.place(place);
            self.list.push(Fault::warning(place, message));
        }
    }

    /// How many errors there are.
    pub(super) fn error_count(&self) -> usize {
        self.list
            .iter()
            .filter(|fault| fault.severity == Severity::Error)
            .count()
    }

    /// The result with its warnings, or all faults if one of them is an error.
    pub(super) fn finish<T>(mut self, result: Result<T, Stop>) -> Result<(T, Vec<Fault>), Vec<Fault>> {
        if let more @ 1.. = self.warnings.saturating_sub(WARNING_LIMIT) {
            let place = self.file.clone();
            self.list
                .push(Fault::warning(place, format!("and {more} more warnings")));
        }
        match result {
            Ok(value) if self.error_count() == 0 => Ok((value, self.list)),
            _ => Err(self.list),
        }
    }

    fn place(&self, place: Place) -> String {
        let file = &self.file;
        match place {
            Place::File => file.clone(),
            Place::Line(line) => format!("{file}:{line}"),
            Place::Byte(byte) => format!("{file}: byte {byte}"),
            Place::Element(noun, number) => format!("{file}: {noun} {number}"),
        }
    }
}

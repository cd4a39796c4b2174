//! Collects what is wrong, so that a person sees all of it at once.

use crate::scene::{Fault, Severity};

/// More errors, or warnings, than this are counted only.
pub(crate) const LIMIT: usize = 20;

/// Faults found so far.
#[derive(Debug, Default)]
pub(crate) struct Faults {
    errors: Vec<Fault>,
    warnings: Vec<Fault>,
}

impl Faults {
    pub(crate) fn error(&mut self, place: impl Into<String>, message: impl Into<String>) {
        self.errors.push(Fault::error(place, message));
    }

    pub(crate) fn warning(&mut self, place: impl Into<String>, message: impl Into<String>) {
        self.warnings.push(Fault::warning(place, message));
    }

    /// A warning that no others may crowd out: what was given is not what is computed.
    pub(crate) fn warning_above_others(&mut self, place: impl Into<String>, message: impl Into<String>) {
        self.warnings.insert(0, Fault::warning(place, message));
    }

    pub(crate) fn extend(&mut self, faults: Vec<Fault>) {
        for fault in faults {
            match fault.severity {
                Severity::Error => self.errors.push(fault),
                Severity::Warning => self.warnings.push(fault),
            }
        }
    }

    pub(crate) fn any_error(&self) -> bool {
        !self.errors.is_empty()
    }

    /// Ends here if there is an error; the warnings come along, they may tell why.
    pub(crate) fn stop(&mut self) -> Result<(), Vec<Fault>> {
        if self.errors.is_empty() {
            return Ok(());
        }
        let mut faults = capped(std::mem::take(&mut self.errors), Fault::error);
        faults.extend(capped(std::mem::take(&mut self.warnings), Fault::warning));
        Err(faults)
    }

    pub(crate) fn into_warnings(self) -> Vec<Fault> {
        capped(self.warnings, Fault::warning)
    }
}

fn capped(mut faults: Vec<Fault>, more: fn(String, String) -> Fault) -> Vec<Fault> {
    let surplus = faults.len().saturating_sub(LIMIT);
    if surplus > 0 {
        faults.truncate(LIMIT);
        faults.push(more("scene".into(), format!("and {surplus} more like these")));
    }
    faults
}

/// The first few ids, for a message.
pub(crate) fn some(ids: impl ExactSizeIterator<Item = String>) -> String {
    let count = ids.len();
    let mut text = ids.take(5).collect::<Vec<_>>().join(", ");
    if count > 5 {
        text += &format!(" and {} more", count - 5);
    }
    text
}

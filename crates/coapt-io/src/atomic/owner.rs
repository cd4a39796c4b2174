//! Whose a file under another name is, and whether that process is gone for certain.

use std::ffi::OsStr;
use std::fs::Metadata;
use std::path::Path;
use std::sync::OnceLock;

/// The process that began a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Owner<'a> {
    process: &'a str,
    /// As [`machine`] has it there; none where it had none.
    machine: Option<&'a str>,
}

/// The owner that a file's name tells, if it is called `.NAME.PROCESS-COUNT-MACHINE.tmp`, or so without the machine, after a
/// path.
pub(super) fn of_temporary<'a>(file: &'a OsStr, path: &Path) -> Option<Owner<'a>> {
    let name = path.file_name()?.to_str()?;
    let rest = file.to_str()?.strip_prefix('.')?.strip_prefix(name)?;
    let middle = rest.strip_prefix('.')?.strip_suffix(".tmp")?;
    let (process, rest) = middle.split_once('-')?;
    let (count, machine) = match rest.split_once('-') {
        Some((count, machine)) => (count, Some(machine)),
        None => (rest, None),
    };
    let digits = |word: &str| !word.is_empty() && word.bytes().all(|byte| byte.is_ascii_digit());
    (digits(process) && digits(count)).then_some(Owner { process, machine })
}

impl Owner<'_> {
    /// Whether the process is known to be gone: it ran here, and the system lists no such process. Processes of another user may
    /// be hidden, so that nothing is known of who began a file of theirs.
    pub(super) fn is_gone(self, of_file: &Metadata) -> bool {
        let listed = || Path::new("/proc").join(self.process).try_exists();
        self.machine.is_some()
            && self.machine == machine()
            && is_own(of_file)
            && matches!(listed(), Ok(false))
    }
}

#[cfg(unix)]
fn is_own(of_file: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    std::fs::metadata("/proc/self").is_ok_and(|own| own.uid() == of_file.uid())
}

#[cfg(not(unix))]
fn is_own(_: &Metadata) -> bool {
    false
}

/// What tells apart where numbers of processes mean the same: the machine, since it was started, and the list of processes that
/// this one sees, as containers have their own. None where the system does not say.
pub(super) fn machine() -> Option<&'static str> {
    static MACHINE: OnceLock<Option<String>> = OnceLock::new();
    let read = || {
        let start = std::fs::read("/proc/sys/kernel/random/boot_id").ok()?;
        let list = std::fs::read_link("/proc/self/ns/pid").ok()?;
        let bytes = start.iter().chain(list.as_os_str().as_encoded_bytes());
        // FNV-1a, 64 bits: short enough for a name.
        let step = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        Some(format!("{:016x}", bytes.fold(0xcbf2_9ce4_8422_2325, step)))
    };
    MACHINE.get_or_init(read).as_deref()
}

//! How much memory this machine has.

use std::fs::read_to_string;
use std::num::NonZero;
use std::thread;

/// Bytes of address space that the process takes beside its data: its program and libraries, and what allocators and
/// stacks reserve for each of its threads, of which there are some for each core. On two cores 0.6 GB were measured.
const PROGRAM: u64 = 400_000_000;
const OF_CORE: u64 = 150_000_000;

/// Bytes of memory that a process may have at most: the machine's, or those of its control group or of its limit of
/// address space if they are fewer; none where none of them is known.
#[must_use]
pub fn available() -> Option<u64> {
    let machine = read_to_string("/proc/meminfo");
    let machine = machine.ok().and_then(|text| of_machine(&text));
    let group = read_to_string("/sys/fs/cgroup/memory.max");
    let group = group.ok().and_then(|text| text.trim().parse().ok());
    let limits = read_to_string("/proc/self/limits");
    let cores = thread::available_parallelism().map_or(1, NonZero::get) as u64;
    let limit = limits.ok().and_then(|text| of_limits(&text));
    let limit = limit.map(|bytes| bytes.saturating_sub(PROGRAM + cores * OF_CORE));
    machine.into_iter().chain(group).chain(limit).min()
}

/// The soft limit of the address space (`ulimit -v`), bytes, if there is one.
fn of_limits(text: &str) -> Option<u64> {
    let line = text
        .lines()
        .find_map(|line| line.strip_prefix("Max address space"))?;
    line.split_whitespace().next()?.parse().ok()
}

/// What the kernel says of the machine.
fn of_machine(text: &str) -> Option<u64> {
    let line = text
        .lines()
        .find_map(|line| line.strip_prefix("MemTotal:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kib.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_kernels_words_are_read_and_others_are_not() {
        let text = "MemTotal:       24586712 kB\nMemFree:        20000000 kB\n";
        assert_eq!(of_machine(text), Some(24_586_712 * 1024));
        assert_eq!(of_machine("MemFree: 1 kB\n"), None);
        assert_eq!(of_machine("MemTotal: much kB\n"), None);
    }

    #[test]
    fn a_limit_of_the_address_space_is_read_where_there_is_one() {
        let limits = |soft: &str| {
            format!(
                "Limit                     Soft Limit           Hard Limit           Units\n\
                 Max cpu time              7                    unlimited            seconds\n\
                 Max address space         {soft}           unlimited            bytes\n"
            )
        };
        assert_eq!(of_limits(&limits("1048576000")), Some(1_048_576_000));
        assert_eq!(of_limits(&limits("unlimited")), None);
        assert_eq!(of_limits(""), None);
    }
}

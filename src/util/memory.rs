//! How much memory this machine has.

use std::fs::read_to_string;

/// Bytes of memory that a process may have at most: the machine's, or those of its control group if they are fewer;
/// none where neither is known.
#[must_use]
pub fn available() -> Option<u64> {
    let machine = read_to_string("/proc/meminfo");
    let machine = machine.ok().and_then(|text| of_machine(&text));
    let group = read_to_string("/sys/fs/cgroup/memory.max");
    let group = group.ok().and_then(|text| text.trim().parse().ok());
    machine.into_iter().chain(group).min()
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
}

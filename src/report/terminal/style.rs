//! The few styles of what is printed. Whoever prints takes them out where there is no terminal.

use anstyle::{AnsiColor, Style};

/// A heading.
const HEADING: Style = Style::new().bold();
/// What does not hold or went wrong.
pub const BAD: Style = AnsiColor::Red.on_default().bold();
/// What holds.
const GOOD: Style = AnsiColor::Green.on_default();

/// A heading.
pub(super) fn heading(text: &str) -> String {
    format!("{HEADING}{text}{HEADING:#}")
}

/// A word for what holds, or one for what does not.
pub(super) fn judged(holds: bool, good: &str, bad: &str) -> String {
    if holds {
        format!("{GOOD}{good}{GOOD:#}")
    } else {
        self::bad(bad)
    }
}

/// A word for what went wrong.
pub(super) fn bad(text: &str) -> String {
    format!("{BAD}{text}{BAD:#}")
}

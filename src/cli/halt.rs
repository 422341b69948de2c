//! What asks a run to end before it has flown all: signals of people and schedulers, and time.

use super::exit::{Code, Failure};
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag::{register, register_conditional_shutdown};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Asks a run to end soon.
pub(super) struct Halt {
    signalled: Arc<AtomicBool>,
    until: Option<Instant>,
    /// Whether somebody has asked before.
    begun: AtomicBool,
}

impl Halt {
    /// From now on; a signal that comes a second time ends the program at once.
    pub(super) fn after(longest: Option<Duration>) -> Result<Self, Failure> {
        let signalled = Arc::new(AtomicBool::new(false));
        let listen = || {
            for signal in [SIGINT, SIGTERM] {
                register_conditional_shutdown(signal, 128 + signal, signalled.clone())?;
                register(signal, signalled.clone())?;
            }
            // What schedulers send some time before the end.
            #[cfg(unix)]
            register(signal_hook::consts::SIGUSR1, signalled.clone())?;
            Ok::<(), std::io::Error>(())
        };
        listen().map_err(|error| {
            let said = format!("signals cannot be waited for ({error}); run it elsewhere");
            Failure::new(Code::Other, said)
        })?;
        Ok(Self {
            signalled,
            until: longest.and_then(|longest| Instant::now().checked_add(longest)),
            begun: AtomicBool::new(false),
        })
    }

    /// Whether to end. However short the time is, a batch is flown in it: a process that is begun again and again comes
    /// to an end.
    pub(super) fn is_asked(&self) -> bool {
        let begun = self.begun.swap(true, Ordering::Relaxed);
        let is_over = self.until.is_some_and(|until| Instant::now() >= until);
        is_over && begun || self.signalled.load(Ordering::Relaxed)
    }
}

/// A length of time such as "3h50m", "90s" or "1d".
pub(super) fn duration(text: &str) -> Result<Duration, String> {
    let wrong = || "write it as 3h50m, 90s or 1d, with d, h, m and s in this order".to_string();
    let (mut seconds, mut rest, mut last) = (0_u64, text.trim(), u64::MAX);
    while !rest.is_empty() {
        let digits = rest.find(|own: char| !own.is_ascii_digit());
        let (number, after) = rest.split_at(digits.ok_or_else(wrong)?);
        let number: u64 = number.parse().map_err(|_| wrong())?;
        let mut letters = after.chars();
        let unit = match letters.next() {
            Some('d') => 86_400,
            Some('h') => 3_600,
            Some('m') => 60,
            Some('s') => 1,
            _ => return Err(wrong()),
        };
        if unit >= last {
            return Err(wrong());
        }
        let more = number.checked_mul(unit).ok_or_else(wrong)?;
        seconds = seconds.checked_add(more).ok_or_else(wrong)?;
        (last, rest) = (unit, letters.as_str());
    }
    match seconds {
        0 => Err(wrong()),
        _ => Ok(Duration::from_secs(seconds)),
    }
}

#[cfg(test)]
mod tests {
    use super::duration;
    use std::time::Duration;

    #[test]
    fn lengths_of_time_are_sums_of_units_in_order() {
        let seconds = |text| duration(text).ok().map(|own: Duration| own.as_secs());
        for (text, expected) in [
            ("90s", 90),
            ("3h50m", 13_800),
            ("1d2h3m4s", 93_784),
            ("2m", 120),
        ] {
            assert_eq!(seconds(text), Some(expected), "{text}");
        }
        for text in [
            "",
            "0s",
            "5",
            "m",
            "3m2h",
            "1h1h",
            "-1s",
            "1.5h",
            "99999999999999999999d",
        ] {
            assert_eq!(seconds(text), None, "{text}");
        }
    }
}

//! What the program is doing, shown on a terminal while it does it.

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use std::fmt::Write;
use std::io::{IsTerminal, stderr};
use std::time::Duration;
use urts_mc::campaign::Campaign;
use urts_mc::run::Progress;
use urts_mc::run::tune::Evaluation;

/// A line on standard error that says what goes on, with rate and time left of a simulation. It is shown on a terminal
/// only, and taken away at the end.
pub(super) struct ProgressLine {
    bar: ProgressBar,
    /// Whether the simulation may end before its last episode.
    may_stop: bool,
}

impl ProgressLine {
    /// A run, which begins with its gains.
    pub(super) fn of_run(campaign: &Campaign, quiet: bool) -> Self {
        Self {
            bar: line(u64::from(campaign.episodes), quiet),
            may_stop: campaign.stop.is_some(),
        }
    }

    /// A search among so many candidates.
    pub(super) fn of_search(budget: u32, quiet: bool) -> Self {
        let bar = line(u64::from(budget), quiet);
        bar.set_message("synthesizing gains");
        Self {
            bar,
            may_stop: false,
        }
    }

    /// Shows how far a search is.
    pub(super) fn tell_best(&self, tried: u32, best: &Evaluation) {
        let limits = match best.holds_all() {
            true => "all limits hold".to_string(),
            false => format!("limits exceeded by {:.2} in logarithms", best.excess),
        };
        self.bar.set_style(of_search());
        self.bar.set_position(u64::from(tried));
        self.bar
            .set_message(format!("best {:.4e}, {limits}", best.objective));
    }

    /// Work of unknown length.
    pub(super) fn of_work(doing: &'static str, quiet: bool) -> Self {
        let bar = line(0, quiet);
        bar.set_message(doing);
        Self {
            bar,
            may_stop: false,
        }
    }

    /// Shows what a run is at.
    pub(super) fn tell(&self, at: Progress) {
        match at {
            Progress::Gains => self.bar.set_message("synthesizing gains"),
            Progress::Simulation => {
                self.bar.reset();
                self.bar.set_style(of_flight(self.may_stop));
            }
            Progress::Kept(episodes) => {
                self.bar.set_position(u64::from(episodes));
                self.bar.reset_eta();
            }
            Progress::Simulated(episodes) => self.bar.inc(u64::from(episodes)),
            Progress::Tables => self.work("tables of what was flown"),
            Progress::CrossCheck => self.work("comparing with f64 on the CPU"),
            Progress::Statistics => self.work("intervals, tests and rankings"),
            Progress::Writing => self.work("writing tables"),
        }
    }

    fn work(&self, doing: &'static str) {
        self.bar.set_style(of_work());
        self.bar.set_message(doing);
        self.bar.reset_elapsed();
    }
}

impl Drop for ProgressLine {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

fn line(length: u64, quiet: bool) -> ProgressBar {
    if quiet || !stderr().is_terminal() {
        return ProgressBar::with_draw_target(Some(length), ProgressDrawTarget::hidden());
    }
    let bar = ProgressBar::new(length).with_style(of_work());
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}

fn of_work() -> ProgressStyle {
    ProgressStyle::with_template("{spinner} {msg}, {elapsed}")
        .unwrap_or_else(|_| ProgressStyle::default_spinner())
}

fn of_search() -> ProgressStyle {
    ProgressStyle::with_template(
        "{spinner} {bar:32} {human_pos}/{human_len} candidates, {msg}, {eta} left",
    )
    .unwrap_or_else(|_| ProgressStyle::default_bar())
}

fn of_flight(may_stop: bool) -> ProgressStyle {
    let rate = |state: &ProgressState, text: &mut dyn Write| {
        // Writing to a terminal's line cannot fail here; the next drawing replaces it.
        let _ = match state.pos() {
            0 => write!(text, "simulating"),
            _ => write!(text, "{:.0} a second", state.per_sec()),
        };
    };
    let left = move |state: &ProgressState, text: &mut dyn Write| {
        if state.pos() == 0 {
            return;
        }
        let at_most = if may_stop { "at most " } else { "" };
        let _ = write!(text, ", {at_most}{:#} left", HumanDuration(state.eta()));
    };
    ProgressStyle::with_template(
        "{spinner} {bar:32} {human_pos}/{human_len} episodes, {rate}{left}",
    )
    .unwrap_or_else(|_| ProgressStyle::default_bar())
    .with_key("rate", rate)
    .with_key("left", left)
}

//! What is watched of every candidate of a search: what is to be small, what is limited, and what the trade-off is
//! drawn over.

use crate::campaign::{
    Campaign, EpisodeNumber, Limit, LoopNumber, Measure, MeasuredChannels, Tune,
};

/// The measures of a search, each once.
#[derive(Debug, Clone)]
pub(super) struct Watched {
    /// All of them.
    pub(super) measures: Vec<Measure>,
    /// What is to be small: which measure, and by how much it counts.
    pub(super) objective: Vec<(usize, f64)>,
    /// What has to hold: of which measure.
    pub(super) limits: Vec<(usize, Limit)>,
}

impl Watched {
    pub(super) fn new(campaign: &Campaign, tune: &Tune) -> Self {
        let mut watched = Self {
            measures: Vec::new(),
            objective: Vec::new(),
            limits: Vec::new(),
        };
        for term in &tune.objective {
            let place = watched.place(term.measure.clone());
            watched.objective.push((place, term.factor));
        }
        for limit in &tune.limits {
            let place = watched.place(limit.measure.clone());
            watched.limits.push((place, limit.clone()));
        }
        for channels in all_channels(campaign) {
            watched.place(peak_command(channels.clone()));
            watched.place(delay_margin(channels));
        }
        watched
    }

    /// The place of a measure, which is added if it is not there.
    fn place(&mut self, measure: Measure) -> usize {
        let known = self.measures.iter().position(|own| *own == measure);
        known.unwrap_or_else(|| {
            self.measures.push(measure);
            self.measures.len() - 1
        })
    }
}

/// What a smaller error is paid with: the largest commands.
pub(super) fn peak_command(channels: MeasuredChannels) -> Measure {
    Measure::Episodes {
        number: EpisodeNumber::PeakCommand,
        channels,
        share: 0.95,
    }
}

/// What a smaller error is paid with: the delay margin.
pub(super) fn delay_margin(channels: MeasuredChannels) -> Measure {
    Measure::Loop {
        number: LoopNumber::DelayMargin,
        channels,
    }
}

/// The channel groups of a campaign.
fn all_channels(campaign: &Campaign) -> Vec<MeasuredChannels> {
    let all = campaign.channel_groups().into_iter().enumerate();
    all.map(|(index, own)| MeasuredChannels {
        index,
        name: own.name,
    })
    .collect()
}

//! The random quantities of episodes: sampling designs and strata in campaigns.

mod designs;
mod strata;

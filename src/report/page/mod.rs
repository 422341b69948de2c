//! How a report looks: the document as HTML and Markdown, and plots as SVG.

pub(crate) mod clip_ids;
pub(crate) mod document;
pub(crate) mod html;
pub(crate) mod markdown;
pub(crate) mod plot;
pub(crate) mod plot_grid;
mod ticks;

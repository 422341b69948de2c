//! How a report or what a command prints looks: the document as HTML, Markdown and text, and plots as SVG.

pub(crate) mod clip_ids;
pub(crate) mod document;
pub(crate) mod html;
pub(crate) mod markdown;
pub(crate) mod plot;
pub(crate) mod plot_grid;
pub(crate) mod text;
mod ticks;

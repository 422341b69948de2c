//! Panels in one drawing that stands alone: a figure for a paper, or for a README.

use super::clip_ids::renumbered;
use super::document::{LegendEntry, Swatch};
use super::plot::{Plot, SIZE, escaped};

/// Height of title and explanation, px.
const TITLE: f64 = 50.0;
/// Height of a line of the legend, px.
const LINE: f64 = 20.0;
/// Width of a letter of the legend, px.
const LETTER: f64 = 7.4;
/// The colours that a page gives its panels.
const COLOURS: &str = include_str!("colours.css");

/// Panels in rows of so many, under a title and a line of explanation, with a legend.
pub(crate) fn plot_grid(
    title: &str,
    subtitle: &str,
    panels: &[Plot],
    columns: usize,
    legend: &[LegendEntry],
) -> String {
    let columns = columns.clamp(1, panels.len().max(1));
    let rows = panels.len().div_ceil(columns);
    let width = SIZE.0 * columns as f64;
    let (entries, head) = legend_of(legend, width);
    let height = SIZE.1 * rows as f64 + head;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" role=\"img\" \
         aria-label=\"{title}\" font-family=\"system-ui, sans-serif\"><style>{COLOURS}</style>\
         <rect width=\"{width}\" height=\"{height}\" fill=\"var(--page)\"/>\
         <text x=\"20\" y=\"24\" font-size=\"16\" font-weight=\"600\" fill=\"var(--text)\">{title}</text>\
         <text x=\"20\" y=\"44\" font-size=\"12\" fill=\"var(--quiet)\">{}</text>{entries}",
        escaped(subtitle),
        title = escaped(title),
    );
    for (index, panel) in panels.iter().enumerate() {
        let place = format!(
            "<svg x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" ",
            SIZE.0 * (index % columns) as f64,
            head + SIZE.1 * (index / columns) as f64,
            SIZE.0,
            SIZE.1
        );
        svg.push_str(&panel.svg().replacen("<svg ", &place, 1));
    }
    svg.push_str("</svg>\n");
    renumbered(&svg)
}

/// The legend in as many lines as it takes, and where it ends, px.
fn legend_of(legend: &[LegendEntry], width: f64) -> (String, f64) {
    let mut svg = String::new();
    let (mut x, mut y) = (20.0, TITLE + 0.5 * LINE);
    for LegendEntry {
        swatch,
        color,
        text,
    } in legend
    {
        let own = 45.0 + LETTER * text.chars().count() as f64;
        if x > 20.0 && x + own > width {
            (x, y) = (20.0, y + LINE);
        }
        let drawn = match swatch {
            Swatch::Line => "stroke-width=\"4\"",
            Swatch::Dashes => "stroke-width=\"3\" stroke-dasharray=\"6 3\"",
            Swatch::Shade => "stroke-width=\"12\" opacity=\"0.3\"",
        };
        svg.push_str(&format!(
            "<line x1=\"{x}\" x2=\"{}\" y1=\"{middle}\" y2=\"{middle}\" stroke=\"{}\" {drawn}/>\
             <text x=\"{}\" y=\"{}\" font-size=\"12\" fill=\"var(--text)\">{}</text>",
            x + 18.0,
            color.css(),
            x + 25.0,
            y,
            escaped(text),
            middle = y - 4.0,
        ));
        x += own;
    }
    (svg, y + 0.5 * LINE)
}

//! A document as a page that needs nothing else: styles and drawings inside, no scripts.

use super::clip_ids::renumbered;
use super::document::{Block, Card, Cell, Document, Figure, Grid, Scale, Section, Spread, Swatch};
use super::plot::Color;
use maud::{DOCTYPE, Markup, PreEscaped, html};

const STYLE: &str = concat!(include_str!("colours.css"), include_str!("style.css"));
/// Width and height of a drawn value, px.
const BAR: (f64, f64) = (190.0, 16.0);
/// Letters beyond which the text of a cell is wrapped.
const LONG: usize = 44;
/// Room at both ends of it, px.
const MARGIN: f64 = 5.0;

/// The page.
pub(crate) fn html(document: &Document) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (document.title) }
                // Without it a browser asks for one.
                link rel="icon" href="data:,";
                style { (PreEscaped(STYLE)) }
            }
            body {
                header {
                    h1 { (document.title) }
                    p.subtitle { (document.subtitle) }
                    @if !document.about.is_empty() { p.about { (document.about) } }
                }
                main {
                    @if !document.lead.is_empty() {
                        div.lead { @for sentence in &document.lead { p { (sentence) } } }
                    }
                    @if !document.band.is_empty() {
                        div.band { @for card in &document.band { (of_card(card)) } }
                    }
                    @for warning in &document.warnings { p.warning role="alert" { (warning) } }
                    nav aria-label="Contents" {
                        @for (index, section) in document.sections.iter().enumerate() {
                            a href={ "#s" (index) } { (section.heading) }
                        }
                    }
                    @for (index, section) in document.sections.iter().enumerate() {
                        (of_section(index, section))
                    }
                }
            }
        }
    };
    renumbered(&page.into_string())
}

fn of_card(card: &Card) -> Markup {
    let color = card.color.map_or("var(--line)".to_string(), Color::css);
    html! {
        div.card style={ "border-top-color:" (color) } {
            @match card.holds {
                Some(true) => span.badge.holds { "✓ holds" },
                Some(false) => span.badge.fails { "✗ not proved" },
                None => {}
            }
            strong { (card.name) }
            @if !card.note.is_empty() { span.note { (card.note) } }
            @for (number, label) in &card.numbers {
                div { b { (number) } " " span { (label) } }
            }
        }
    }
}

fn of_section(index: usize, section: &Section) -> Markup {
    html! {
        section id={ "s" (index) } {
            h2 { (section.heading) (section.note) }
            @for block in &section.blocks { (of_block(block)) }
        }
    }
}

fn of_block(block: &Block) -> Markup {
    match block {
        Block::Text(text) => html! { p { (text) } },
        Block::Code(text) => html! { pre tabindex="0" { code { (text) } } },
        Block::Grid(grid) => of_grid(grid),
        Block::Figure(figure) => of_figure(figure),
        Block::Folded(summary, blocks) => html! {
            details { summary { (summary) } @for block in blocks { (of_block(block)) } }
        },
    }
}

fn of_figure(figure: &Figure) -> Markup {
    html! {
        figure class=[(figure.panels.len() > 1).then_some("wide")] {
            @if !figure.legend.is_empty() {
                div.legend {
                    @for key in &figure.legend {
                        span { i class=(of_swatch(key.swatch)) style={ "color:" (key.color.css()) } {} (key.text) }
                    }
                }
            }
            div.panels.four[figure.panels.iter().all(|panel| panel.width.is_some())] { @for panel in &figure.panels { (PreEscaped(panel.svg())) } }
            figcaption { (figure.caption) }
        }
    }
}

fn of_swatch(swatch: Swatch) -> &'static str {
    match swatch {
        Swatch::Line => "line",
        Swatch::Dashes => "dashes",
        Swatch::Shade => "shade",
    }
}

fn of_grid(grid: &Grid) -> Markup {
    let numeric = |column: usize| {
        let cell = grid.rows.first().and_then(|row| row.get(column));
        matches!(cell, Some(Cell::Number(_)))
    };
    let scale = |column: usize| match grid.rows.first().and_then(|row| row.get(column)) {
        Some(Cell::Spreads(spreads)) => spreads.first().map(|spread| spread.scale),
        _ => None,
    };
    html! {
        div.scroll tabindex="0" {
            table {
                thead { tr { @for (column, name) in grid.head.iter().enumerate() {
                    th scope="col" class=[numeric(column).then_some("number")] {
                        (name)
                        @if let Some(scale) = scale(column) { (of_scale(scale)) }
                    }
                } } }
                tbody { @for row in &grid.rows { tr { @for cell in row { (of_cell(cell)) } } } }
            }
        }
    }
}

fn of_cell(cell: &Cell) -> Markup {
    match cell {
        Cell::Text(text) => html! { td.long[text.chars().count() > LONG] { (text) } },
        Cell::Number(text) => html! { td.number { (text) } },
        Cell::Code(text) => html! { td { code { (text) } } },
        Cell::Verdict(true, text) => html! { td.holds { "✓ " (text) } },
        Cell::Verdict(false, text) => html! { td.fails { "✗ " (text) } },
        Cell::Spreads(spreads) => {
            html! { td.spreads { @for spread in spreads { (of_spread(spread)) } } }
        }
    }
}

/// Where a value lies on a drawn scale, px.
fn place(scale: Scale, value: f64) -> f64 {
    let (low, high) = scale.ends();
    let share = ((value - low) / (high - low)).clamp(0.0, 1.0);
    MARGIN + (BAR.0 - 2.0 * MARGIN) * share
}

/// A value as a point with its interval on its scale, and in digits.
fn of_spread(spread: &Spread) -> Markup {
    let (width, height) = BAR;
    let at = |value: f64| place(spread.scale, value);
    let middle = height / 2.0;
    let color = spread.color.css();
    let (low, high) = spread.scale.ends();
    html! {
        div {
            svg width=(width) height=(height) viewBox={ "0 0 " (width) " " (height) } aria-hidden="true" {
                @for quarter in [0.0, 0.25, 0.5, 0.75, 1.0] {
                    @let x = at(low + quarter * (high - low));
                    line x1=(x) x2=(x) y1="0" y2=(height) stroke="var(--grid)" {}
                }
                @if let Some([lower, upper]) = spread.interval {
                    line x1=(at(lower)) x2=(at(upper)) y1=(middle) y2=(middle) stroke=(color) stroke-width="2.5" {}
                }
                @if spread.value.is_finite() { circle cx=(at(spread.value)) cy=(middle) r="4" fill=(color) {} }
            }
            span { (spread.text()) }
        }
    }
}

/// The scale of a column of drawn values, in its head.
fn of_scale(scale: Scale) -> Markup {
    let (width, height) = BAR;
    let (low, high) = scale.ends();
    let ticks = [low, 0.5 * (low + high), high]
        .into_iter()
        .zip(scale.labels());
    html! {
        br;
        svg.scale width=(width) height=(height) viewBox={ "0 0 " (width) " " (height) } aria-hidden="true" {
            @for (index, (value, label)) in ticks.enumerate() {
                text x=(place(scale, value)) y=(height - 4.0) text-anchor=(["start", "middle", "end"][index]) { (label) }
            }
        }
    }
}

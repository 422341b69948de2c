//! A pair of axes with marks, as SVG. Colours are CSS variables, so that one drawing serves light and dark.

use super::ticks::{format_of, longest_label};
use kuva::backend::svg::SvgBackend;
use kuva::plot::{BandPlot, LinePlot, ScatterPlot};
use kuva::render::annotations::{ReferenceLine, ShadedRegion};
use kuva::render::layout::Layout;
use kuva::render::plots::Plot as Layer;
use kuva::render::render::render_multiple;
use kuva::render::theme::Theme;

/// Width and height of a panel, px: one is as wide as a phone, and three stand side by side on a screen.
pub(crate) const SIZE: (f64, f64) = (380.0, 250.0);
/// Points that a line keeps: more than one per pixel.
const MOST_POINTS: usize = 400;
/// Width of a letter of a tick's label, px.
const LETTER: f64 = 6.6;

/// A colour by what it means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Color {
    /// A controller, by its place in the campaign; or any other series that is one of several.
    Series(usize),
    /// What the others are compared with: a reference, the truth.
    Truth,
    /// A limit.
    Limit,
    /// A fault.
    Fault,
}

impl Color {
    /// The colour in CSS.
    pub(crate) fn css(self) -> String {
        match self {
            Self::Series(index) => format!("var(--series-{})", index % 6),
            Self::Truth => "var(--truth)".into(),
            Self::Limit => "var(--limit)".into(),
            Self::Fault => "var(--fault)".into(),
        }
    }
}

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stroke {
    Solid,
    Dashed,
    /// Constant from each point to the next.
    Steps,
}

/// What is drawn between the axes. Points that are not finite are left out, and interrupt a line.
#[derive(Debug, Clone)]
pub(crate) enum Mark {
    Line(Vec<(f64, f64)>, Color, Stroke),
    /// Between two values at each x.
    Band(Vec<(f64, f64, f64)>, Color),
    Dots(Vec<(f64, f64)>, Color),
}

impl Mark {
    pub(crate) fn color(&self) -> Color {
        match self {
            Self::Line(_, color, _) | Self::Band(_, color) | Self::Dots(_, color) => *color,
        }
    }
}

/// One axis.
#[derive(Debug, Clone, Default)]
pub(crate) struct Axis {
    /// What it shows, with the unit.
    pub(crate) label: String,
    pub(crate) logarithmic: bool,
    /// Ends of the axis; those of the marks if not given.
    pub(crate) range: Option<(f64, f64)>,
}

impl Axis {
    pub(crate) fn new(label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            ..Self::default()
        }
    }
}

/// A pair of axes with what is drawn between them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Plot {
    pub(crate) title: String,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    pub(crate) marks: Vec<Mark>,
    /// Spans of x that are shaded.
    pub(crate) spans: Vec<(f64, f64)>,
    /// Values of y with a line across.
    pub(crate) levels: Vec<f64>,
    /// Values of x with a line down.
    pub(crate) moments: Vec<(f64, Color)>,
    /// Whether a unit is as long along x as along y.
    pub(crate) equal: bool,
    /// Width, px; that of [`SIZE`] if not given.
    pub(crate) width: Option<f64>,
    /// Height, px; that of [`SIZE`] if not given.
    pub(crate) height: Option<f64>,
}

impl Plot {
    /// The drawing; of nothing but a sentence where no mark has a finite point.
    pub(crate) fn svg(&self) -> String {
        let (width, height) = self.size();
        let ends = (self.ends(|x, _| x, &self.x), self.ends(|_, y| y, &self.y));
        let (Some(x_range), Some(mut y_range)) = ends else {
            return self.blank();
        };
        for &level in self.levels.iter().filter(|level| level.is_finite()) {
            y_range = (y_range.0.min(level), y_range.1.max(level));
        }
        let (x_range, y_range) = (padded(x_range, &self.x), padded(y_range, &self.y));
        let plots: Vec<Layer> = self
            .marks
            .iter()
            .flat_map(|mark| self.plots(mark))
            .collect();
        let y_labels = longest_label(y_range, self.y.logarithmic);
        let margin = y_labels * LETTER + 44.0;
        let mut layout = Layout::new(x_range, y_range)
            .with_width(width)
            .with_height(height)
            .with_theme(theme())
            .with_title(self.title.clone())
            .with_x_label(self.x.label.clone())
            .with_y_label(self.y.label.clone())
            .with_title_size(13)
            .with_label_size(12)
            .with_tick_size(11)
            .with_axis_line_width(1.0)
            .with_grid_line_width(0.7)
            .with_ticks(5)
            .with_force_margins(margin, 20.0)
            .with_x_tick_format(format_of(x_range, self.x.logarithmic))
            .with_y_tick_format(format_of(y_range, self.y.logarithmic));
        if !self.equal {
            layout = layout
                .with_x_axis_min(x_range.0)
                .with_x_axis_max(x_range.1)
                .with_y_axis_min(y_range.0)
                .with_y_axis_max(y_range.1);
        } else {
            layout = layout.with_equal_aspect();
        }
        if self.x.logarithmic {
            layout = layout.with_log_x();
        }
        if self.y.logarithmic {
            layout = layout.with_log_y();
        }
        for &(from, to) in &self.spans {
            let (from, to) = (from.max(x_range.0), to.min(x_range.1));
            if from < to {
                let span = ShadedRegion::vertical(from, to).with_color(Color::Fault.css());
                layout = layout.with_shaded_region(span.with_opacity(0.16));
            }
        }
        for &level in self.levels.iter().filter(|level| level.is_finite()) {
            let line = ReferenceLine::horizontal(level).with_color(Color::Limit.css());
            layout = layout.with_reference_line(line);
        }
        for (moment, color) in self.moments.iter().filter(|(moment, _)| moment.is_finite()) {
            let line = ReferenceLine::vertical(*moment).with_color(color.css());
            layout = layout.with_reference_line(line);
        }
        let drawn = SvgBackend::new().render_scene(&render_multiple(plots, layout));
        self.scalable(&drawn)
    }

    /// Whole pixels, as the drawing writes them.
    fn size(&self) -> (f64, f64) {
        let whole = |given: Option<f64>, usual: f64| given.unwrap_or(usual).round();
        (whole(self.width, SIZE.0), whole(self.height, SIZE.1))
    }

    /// The drawing without a size of its own, and with a name for those who cannot see it.
    fn scalable(&self, drawn: &str) -> String {
        let (width, height) = self.size();
        let fixed = format!("width=\"{width}\" height=\"{height}\"");
        let label = format!("{}: {} over {}", self.title, self.y.label, self.x.label);
        let free = format!(
            "viewBox=\"0 0 {width} {height}\" class=\"panel\" role=\"img\" aria-label=\"{}\"",
            escaped(&label)
        );
        drawn.replacen(&fixed, &free, 1)
    }

    /// A panel without anything to show, which says so.
    fn blank(&self) -> String {
        let (width, height) = self.size();
        let text = |y: f64, text: &str| {
            format!(
                "<text x=\"{}\" y=\"{y}\" text-anchor=\"middle\" font-size=\"12\" fill=\"var(--text)\">{}</text>",
                width / 2.0,
                escaped(text)
            )
        };
        let drawn = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\">{}{}</svg>",
            text(24.0, &self.title),
            text(height / 2.0, "no finite values to show")
        );
        self.scalable(&drawn)
    }

    /// The smallest and largest finite value of the marks along an axis.
    fn ends(&self, pick: fn(f64, f64) -> f64, axis: &Axis) -> Option<(f64, f64)> {
        let mut ends: Option<(f64, f64)> = None;
        let mut take = |x: f64, y: f64| {
            let usable =
                |value: f64, axis: &Axis| value.is_finite() && (!axis.logarithmic || value > 0.0);
            if usable(x, &self.x) && usable(y, &self.y) {
                let value = pick(x, y);
                let (low, high) = ends.unwrap_or((value, value));
                ends = Some((low.min(value), high.max(value)));
            }
        };
        for mark in &self.marks {
            match mark {
                Mark::Line(points, ..) | Mark::Dots(points, _) => {
                    points.iter().for_each(|&(x, y)| take(x, y));
                }
                Mark::Band(points, _) => points.iter().for_each(|&(x, low, high)| {
                    take(x, low);
                    take(x, high);
                }),
            }
        }
        ends.map(|ends| axis.range.unwrap_or(ends))
    }

    fn plots(&self, mark: &Mark) -> Vec<Layer> {
        match mark {
            Mark::Line(points, color, stroke) => self
                .pieces(points)
                .map(|piece| {
                    let line = LinePlot::new()
                        .with_data(thinned(piece, MOST_POINTS))
                        .with_color(color.css())
                        .with_stroke_width(1.6);
                    Layer::Line(match stroke {
                        Stroke::Solid => line,
                        Stroke::Dashed => line.with_dashed(),
                        Stroke::Steps => line.with_step(),
                    })
                })
                .collect(),
            Mark::Band(points, color) => {
                let finite: Vec<&(f64, f64, f64)> = points
                    .iter()
                    .filter(|(x, low, high)| x.is_finite() && low.is_finite() && high.is_finite())
                    .collect();
                if finite.is_empty() {
                    return Vec::new();
                }
                let column = |pick: fn(&(f64, f64, f64)) -> f64| -> Vec<f64> {
                    finite.iter().map(|point| pick(point)).collect()
                };
                let band = BandPlot::new(
                    column(|point| point.0),
                    column(|point| point.1),
                    column(|point| point.2),
                );
                vec![Layer::Band(band.with_color(color.css()).with_opacity(0.22))]
            }
            Mark::Dots(points, color) => {
                let finite: Vec<(f64, f64)> = self.pieces(points).flatten().copied().collect();
                if finite.is_empty() {
                    return Vec::new();
                }
                let dots = ScatterPlot::new().with_data(finite).with_color(color.css());
                vec![Layer::Scatter(dots.with_size(3.0))]
            }
        }
    }

    /// The longest runs of points that can be drawn.
    fn pieces<'a>(
        &'a self,
        points: &'a [(f64, f64)],
    ) -> impl Iterator<Item = &'a [(f64, f64)]> + 'a {
        let usable = |&(x, y): &(f64, f64)| {
            x.is_finite()
                && y.is_finite()
                && (!self.x.logarithmic || x > 0.0)
                && (!self.y.logarithmic || y > 0.0)
        };
        points
            .split(move |point| !usable(point))
            .filter(|piece| !piece.is_empty())
    }
}

/// A line with no more points than can be seen: of each stretch its lowest and its highest, so that no peak is lost.
pub(crate) fn thinned(points: &[(f64, f64)], most: usize) -> Vec<(f64, f64)> {
    if points.len() <= most {
        return points.to_vec();
    }
    let stretch = points.len().div_ceil((most / 2).max(1));
    let mut kept = Vec::with_capacity(most + 1);
    for stretch in points.chunks(stretch) {
        let by_height = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        let ends = (
            stretch.iter().min_by(by_height),
            stretch.iter().max_by(by_height),
        );
        if let (Some(&low), Some(&high)) = ends {
            let (first, second) = if low.0 <= high.0 {
                (low, high)
            } else {
                (high, low)
            };
            kept.extend([first, second]);
        }
    }
    kept.extend(points.last());
    kept
}

/// A range with room around the marks, unless it was asked for.
fn padded((low, high): (f64, f64), axis: &Axis) -> (f64, f64) {
    if axis.range.is_some() && low < high {
        return (low, high);
    }
    if axis.logarithmic {
        return (low / 1.25, high * 1.25);
    }
    let room = 0.05 * (high - low);
    // What does not vary gets an axis that shows so.
    let room = if room > 1e-9 * low.abs().max(high.abs()) {
        room
    } else {
        (0.05 * high.abs()).max(1e-9)
    };
    (low - room, high + room)
}

fn theme() -> Theme {
    Theme {
        background: "none".into(),
        axis_color: "var(--axis)".into(),
        grid_color: "var(--grid)".into(),
        tick_color: "var(--axis)".into(),
        text_color: "var(--text)".into(),
        font_family: Some("system-ui, sans-serif".into()),
        ..Theme::light()
    }
}

/// Text that may stand in markup.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_every_peak_and_both_ends() {
        let mut points: Vec<(f64, f64)> = (0..20_000).map(|k| (f64::from(k), 0.0)).collect();
        points[7_777].1 = 5.0;
        points[12_345].1 = -3.0;
        let kept = thinned(&points, MOST_POINTS);
        assert!(kept.len() <= MOST_POINTS + 1, "{}", kept.len());
        assert!(kept.contains(&(7_777.0, 5.0)) && kept.contains(&(12_345.0, -3.0)));
        assert_eq!(kept.first(), points.first());
        assert_eq!(kept.last(), points.last());
        assert!(kept.windows(2).all(|pair| pair[0].0 <= pair[1].0));
    }

    #[test]
    fn a_panel_without_finite_points_says_so_and_others_have_no_size_of_their_own() {
        let of = |points: Vec<(f64, f64)>| Plot {
            title: "a < b".into(),
            x: Axis::new("time, s"),
            y: Axis::new("e, m"),
            marks: vec![Mark::Line(points, Color::Series(0), Stroke::Solid)],
            ..Plot::default()
        };
        let blank = of(vec![(f64::NAN, 1.0), (2.0, f64::INFINITY)]).svg();
        assert!(blank.contains("no finite values to show") && blank.contains("a &lt; b"));
        let drawn = of(vec![(0.0, 1.0), (1.0, f64::NAN), (2.0, 3.0), (3.0, 2.0)]).svg();
        let high = Plot {
            height: Some(309.098),
            ..of(vec![(0.0, 1.0), (2.0, 3.0)])
        };
        for (svg, height) in [(blank, 250), (drawn, 250), (high.svg(), 309)] {
            assert!(svg.starts_with("<svg") && svg.ends_with("</svg>"), "{svg}");
            let free = format!("viewBox=\"0 0 380 {height}\" class=\"panel\"");
            assert!(svg.contains(&free), "{svg}");
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        }
    }
}

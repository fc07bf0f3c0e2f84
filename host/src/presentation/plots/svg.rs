//! Figures as SVG files.

use super::figure::{Band, Curve, Figure, Ink, Legend, Mark, Marks, Panel};
use super::ticks::{decades, quarter_turns};
use plotters::coord::Shift;
use plotters::coord::ranged1d::ValueFormatter;
use plotters::prelude::*;
use std::error::Error;

const WIDTH: u32 = 960;
const PANEL_HEIGHT: u32 = 380;
const TITLE_HEIGHT: u32 = 44;
/// Height of a line in a legend, as a share of what a panel has for curves.
const LEGEND_LINE: f64 = 38.0;
const FONT: &str = "sans-serif";

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type DrawResult = Result<(), Box<dyn Error>>;

/// Draws a figure.
///
/// # Errors
/// When the drawing library fails, which it does not do on finite numbers.
pub fn draw(figure: &Figure) -> Result<String, Box<dyn Error>> {
    let mut text = String::new();
    let panels = figure.panels.len();
    let height = TITLE_HEIGHT + PANEL_HEIGHT * panels as u32;
    {
        let root = SVGBackend::with_string(&mut text, (WIDTH, height)).into_drawing_area();
        root.fill(&WHITE)?;
        let rest = root.titled(&figure.title, (FONT, 22))?;
        for (panel, area) in figure.panels.iter().zip(rest.split_evenly((panels, 1))) {
            draw_panel(figure, panel, &area)?;
        }
        root.present()?;
    }
    Ok(text)
}

/// Colours that people with any colour vision can distinguish (Okabe and Ito).
fn colour(ink: Ink) -> RGBColor {
    match ink {
        Ink::Reference => RGBColor(0, 0, 0),
        Ink::Measured => RGBColor(0, 114, 178),
        Ink::Model => RGBColor(213, 94, 0),
        Ink::SecondModel => RGBColor(0, 158, 115),
        Ink::Third => RGBColor(204, 121, 167),
        Ink::Fourth => RGBColor(146, 112, 0),
    }
}

fn draw_panel<'a>(figure: &Figure, panel: &Panel, area: &Area<'a>) -> DrawResult {
    let (Some((_, (y0, y1))), Some((x0, x1))) = (panel.extent(), figure.x_range(panel)) else {
        return Ok(());
    };
    // Room above the highest and below the lowest point, and an axis even for a flat line.
    let margin = if y1 > y0 { (y1 - y0) * 0.06 } else { 1.0 };
    let lines = panel.bands.len()
        + panel.curves.iter().filter(|c| !c.name.is_empty()).count()
        + panel.marks.iter().filter(|m| !m.name.is_empty()).count();
    let legend = match panel.legend {
        Legend::Above => (y1 - y0) * lines as f64 * LEGEND_LINE / f64::from(PANEL_HEIGHT),
        Legend::LowerRight | Legend::UpperRight => 0.0,
    };
    let y = (y0 - margin)..(y1 + margin + legend);
    let x1 = if x1 > x0 { x1 } else { x0 + 1.0 };
    let mut builder = ChartBuilder::on(area);
    builder
        .margin(12)
        .x_label_area_size(46)
        .y_label_area_size(72);
    match (panel.x_logarithmic && x0 > 0.0, panel.is_phase()) {
        (true, true) => {
            let (x, y) = (decades(x0..x1), quarter_turns(y));
            draw_in(panel, builder.build_cartesian_2d(x, y)?)
        }
        (true, false) => draw_in(panel, builder.build_cartesian_2d(decades(x0..x1), y)?),
        (false, _) => draw_in(panel, builder.build_cartesian_2d(x0..x1, y)?),
    }
}

/// A panel's axes, plain or logarithmic along x.
type Chart<'a, X, Y> = ChartContext<'a, SVGBackend<'a>, Cartesian2d<X, Y>>;

fn draw_in<'a, X, Y>(panel: &Panel, mut chart: Chart<'a, X, Y>) -> DrawResult
where
    X: Ranged<ValueType = f64> + ValueFormatter<f64>,
    Y: Ranged<ValueType = f64> + ValueFormatter<f64>,
{
    chart
        .configure_mesh()
        .x_desc(&panel.x_label)
        .y_desc(&panel.y_label)
        .max_light_lines(1)
        .x_labels(8)
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .axis_desc_style((FONT, 16))
        .label_style((FONT, 14))
        .draw()?;
    for band in &panel.bands {
        draw_band(&mut chart, band)?;
    }
    for curve in &panel.curves {
        draw_curve(&mut chart, curve)?;
    }
    for marks in &panel.marks {
        draw_marks(&mut chart, marks)?;
    }
    chart
        .configure_series_labels()
        .position(match panel.legend {
            Legend::LowerRight => SeriesLabelPosition::LowerRight,
            Legend::UpperRight | Legend::Above => SeriesLabelPosition::UpperRight,
        })
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.2))
        .label_font((FONT, 14))
        .draw()?;
    Ok(())
}

fn draw_band<X, Y>(chart: &mut Chart<'_, X, Y>, band: &Band) -> DrawResult
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    let Band { name, ink, points } = band;
    let fill = colour(*ink).mix(0.18);
    let upper = points.iter().map(|&(x, _, upper)| (x, upper));
    let lower = points.iter().rev().map(|&(x, lower, _)| (x, lower));
    let mut outline: Vec<_> = upper.chain(lower).collect();
    outline.retain(|(x, y)| x.is_finite() && y.is_finite());
    chart
        .draw_series(std::iter::once(Polygon::new(outline, fill)))?
        .label(name)
        .legend(move |(x, y)| Rectangle::new([(x, y - 5), (x + 22, y + 5)], fill.filled()));
    Ok(())
}

fn draw_curve<X, Y>(chart: &mut Chart<'_, X, Y>, curve: &Curve) -> DrawResult
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    // A bound is thinner than the curve that it bounds.
    let (width, length) = if curve.dashed { (1, 8) } else { (2, 22) };
    let style = ShapeStyle::from(colour(curve.ink)).stroke_width(width);
    // A line breaks where a sample is missing; only its first piece is named in the legend.
    let mut label = (!curve.name.is_empty()).then_some(&curve.name);
    let pieces = curve
        .points
        .split(|(x, y)| !(x.is_finite() && y.is_finite()));
    for piece in pieces.filter(|piece| !piece.is_empty()) {
        let piece = piece.iter().copied();
        let drawn = if curve.dashed {
            chart.draw_series(DashedLineSeries::new(piece, 7, 5, style))?
        } else {
            chart.draw_series(LineSeries::new(piece, style))?
        };
        if let Some(name) = label.take() {
            drawn
                .label(name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + length, y)], style));
        }
    }
    Ok(())
}

fn draw_marks<X, Y>(chart: &mut Chart<'_, X, Y>, marks: &Marks) -> DrawResult
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    let Marks { name, ink, points } = marks;
    let colour = colour(*ink);
    let thin = colour.stroke_width(1);
    let stems = points.iter().filter_map(|mark| {
        let (low, high) = mark.line?;
        Some(PathElement::new([(mark.x, low), (mark.x, high)], thin))
    });
    chart.draw_series(stems)?;
    let dot = |mark: &Mark| Circle::new((mark.x, mark.y), 4, colour.filled());
    let dots = points.iter().map(dot);
    let drawn = chart.draw_series(dots)?;
    if !name.is_empty() {
        drawn
            .label(name)
            .legend(move |(x, y)| Circle::new((x + 11, y), 4, colour.filled()));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_with_gaps_and_odd_panels_is_drawn() {
        let curve = Curve::solid(
            "a & <b>",
            Ink::Model,
            [(1.0, 2.0), (2.0, f64::NAN), (3.0, 1.0)],
        );
        let band = Band {
            name: "99 %".into(),
            ink: Ink::Model,
            points: vec![(1.0, 0.0, 3.0), (3.0, 0.0, 3.0)],
        };
        let panel = Panel {
            x_logarithmic: true,
            curves: vec![curve],
            bands: vec![band],
            marks: vec![Marks {
                name: "marks".into(),
                ink: Ink::Measured,
                points: vec![Mark {
                    x: 2.0,
                    y: 1.0,
                    line: Some((0.5, 2.5)),
                }],
            }],
            ..Panel::default()
        };
        let flat = Curve::dashed("flat", Ink::Reference, [(0.0, 5.0)]);
        let odd = Panel {
            curves: vec![flat],
            ..Panel::default()
        };
        let figure = Figure {
            name: "x".into(),
            title: "t".into(),
            panels: vec![panel, odd, Panel::default()],
        };
        let svg = draw(&figure).unwrap();
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
        assert!(
            !svg.contains("NaN") && svg.contains("a &amp; &lt;b&gt;"),
            "{svg}"
        );
    }
}

//! Figures for plotly.js: zoom, values under the pointer, saving as a picture.
//!
//! Colours are names here ("ink-model", "area-model"): the page gives them a value for light, dark
//! and paper.

use crate::presentation::plots::{Band, Curve, Figure, Ink, Mark, Marks, Panel};
use serde_json::{Value, json};
use servoid_identification::results::six_digits;

/// The plotting library itself, as a `<script>` element: it travels inside the report, so that the
/// report needs no network. It is the basic bundle, which has scatter plots.
pub(super) fn library() -> String {
    let source = include_str!("plotly-basic-3.0.1.min.js");
    format!("<script>{source}</script>")
}

/// Data and layout of a figure, as plotly.js wants them; `panels` is their number. Where panels and
/// their legends lie depends on the width of the page, so the page's script sets that.
pub(super) fn plotly_json(figure: &Figure) -> Value {
    let mut traces = Vec::new();
    let mut layout = json!({
        "hovermode": "x unified",
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "rgba(0,0,0,0)",
    });
    for (index, panel) in figure.panels.iter().enumerate() {
        let suffix = axis_suffix(index);
        // Panels over the same quantity are zoomed together.
        let mut before = figure.panels.iter().take(index);
        let like = before.position(|other| other.x_label == panel.x_label);
        let matches = like.map(|first| format!("x{}", axis_suffix(first)));
        let x_axis = json!({
            "matches": matches,
            "title": { "text": text(&panel.x_label), "standoff": 8 },
            "type": if panel.x_logarithmic { "log" } else { "linear" },
            "anchor": format!("y{suffix}"),
            // The last tick and the value under the pointer carry the unit.
            "dtick": ticks(panel),
            "ticksuffix": unit(&panel.x_label),
            // Without a format the library writes 0.5 as 5 between decades.
            "tickformat": panel.x_logarithmic.then_some("~g"),
            "showticksuffix": "last",
            "hoverformat": ".4~g",
        });
        let y_axis = json!({
            "title": { "text": text(&panel.y_label), "standoff": 8 },
            "anchor": format!("x{suffix}"),
            "automargin": true,
            // A phase is read against quarters of a turn.
            "dtick": panel.is_phase().then_some(90),
        });
        put(&mut layout, &format!("xaxis{suffix}"), x_axis);
        put(&mut layout, &format!("yaxis{suffix}"), y_axis);
        // The legend names what the panels above have not named.
        let named: Vec<&str> = figure.panels.iter().take(index).flat_map(names).collect();
        traces.extend(panel_traces(panel, &suffix, &named, traces.len()));
    }
    let panels = figure.panels.len();
    json!({ "data": traces, "layout": layout, "name": figure.name, "panels": panels })
}

/// Where ticks lie, unless the plotting library is to choose: at 2, 5 and 10 of a decade, and at each of a
/// few whole numbers.
fn ticks(panel: &Panel) -> Option<Value> {
    if panel.x_logarithmic {
        return Some(json!("D2"));
    }
    let ((low, high), _) = panel.extent()?;
    let curves = panel.curves.iter().flat_map(|curve| &curve.points);
    let marks = panel.marks.iter().flat_map(|marks| &marks.points);
    let mut x = curves.map(|p| p.0).chain(marks.map(|p| p.x));
    (high - low <= FEW && x.all(|x| x.fract() == 0.0)).then(|| json!(1))
}

/// So many ticks have room on a telephone.
const FEW: f64 = 12.0;

/// Sets one entry of an object.
fn put(object: &mut Value, key: &str, value: impl Into<Value>) {
    if let Value::Object(entries) = object {
        entries.insert(key.to_owned(), value.into());
    }
}

/// "" for the first panel, "2" for the second.
fn axis_suffix(index: usize) -> String {
    match index {
        0 => String::new(),
        _ => (index + 1).to_string(),
    }
}

fn names(panel: &Panel) -> impl Iterator<Item = &str> {
    let bands = panel.bands.iter().map(|band| band.name.as_str());
    let curves = panel.curves.iter().map(|curve| curve.name.as_str());
    let marks = panel.marks.iter().map(|marks| marks.name.as_str());
    bands.chain(curves).chain(marks)
}

/// " deg" of "position (deg)", "" where there is none.
fn unit(label: &str) -> String {
    let unit = label
        .rsplit_once('(')
        .and_then(|(_, rest)| rest.strip_suffix(')'));
    let unit = unit.map(|unit| text(unit.trim_end_matches(" of the step")));
    unit.map_or_else(String::new, |unit| format!(" {unit}"))
}

/// The plotting library reads texts as a small markup, which names from files must not become.
fn text(plain: &str) -> String {
    let text = plain.replace('&', "&amp;");
    text.replace('<', "&lt;").replace('>', "&gt;")
}

/// The traces of one panel; `named` has been in the legend before, and `before` traces are in the figure already.
fn panel_traces(panel: &Panel, suffix: &str, named: &[&str], before: usize) -> Vec<Value> {
    let unit = unit(&panel.y_label);
    let hover = format!("%{{y:.4~g}}{unit}");
    let hover_in_band =
        format!("%{{y:.4~g}} (%{{customdata[0]:.4~g}} .. %{{customdata[1]:.4~g}}){unit}");
    let complete = |mut trace: Value, name: &str, in_legend: bool| {
        put(&mut trace, "xaxis", format!("x{suffix}"));
        put(&mut trace, "yaxis", format!("y{suffix}"));
        put(&mut trace, "name", text(name));
        put(&mut trace, "legend", format!("legend{suffix}"));
        put(&mut trace, "legendgroup", text(name));
        let shown = in_legend && !name.is_empty() && !named.contains(&name);
        put(&mut trace, "showlegend", shown);
        // A curve without a name is the other edge of a named one, or a line to guide the eye.
        match name {
            "" => put(&mut trace, "hoverinfo", "skip"),
            _ if trace.get("within").is_some() => {
                put(&mut trace, "hovertemplate", hover_in_band.clone());
            }
            _ if trace.get("hoverinfo").is_some() => {}
            _ => put(&mut trace, "hovertemplate", hover.clone()),
        }
        trace
    };
    let logarithmic = panel.x_logarithmic;
    let mut traces = Vec::new();
    let mut add = |mut trace: Value, x: Vec<f64>, name: &str, in_legend: bool| {
        place(&mut trace, x, logarithmic);
        traces.push(complete(trace, name, in_legend));
    };
    let claimed = |index: usize| {
        panel
            .curves
            .iter()
            .any(|c| band_of(c, panel) == Some(index))
    };
    for (index, band) in panel.bands.iter().enumerate() {
        let x = || band.points.iter().map(|p| p.0).collect();
        for upper in [false, true] {
            let mut edge = edge(band, upper);
            if claimed(index) {
                put(&mut edge, "hoverinfo", "skip");
            }
            add(edge, x(), &band.name, upper);
        }
    }
    for curve in &panel.curves {
        let mut drawn = line(curve);
        if let Some(band) = band_of(curve, panel) {
            // A band has two traces, the lower edge first.
            put(&mut drawn, "within", before + 2 * band);
        }
        add(
            drawn,
            curve.points.iter().map(|p| p.0).collect(),
            &curve.name,
            true,
        );
    }
    for marks in &panel.marks {
        add(
            dots(marks),
            marks.points.iter().map(|p| p.x).collect(),
            &marks.name,
            true,
        );
    }
    traces
}

/// The band of a curve among those of its panel: the one of its colour, over the same x.
fn band_of(curve: &Curve, panel: &Panel) -> Option<usize> {
    let own = |band: &Band| !curve.dashed && band.ink == curve.ink;
    let found = panel.bands.iter().position(own)?;
    let points = panel.bands.get(found).map(|band| band.points.len());
    (points == Some(curve.points.len())).then_some(found)
}

/// The lower edge of a band, or the upper one with the area between the two. Where the band has a curve, the pointer reads the
/// edges there: the page's script gives them to the curve.
fn edge(band: &Band, upper: bool) -> Value {
    let bound = |&(_, low, high): &(f64, f64, f64)| rounded(if upper { high } else { low });
    json!({
        "y": band.points.iter().map(bound).collect::<Vec<_>>(),
        "mode": "lines",
        "line": { "width": 0, "color": colour(band.ink) },
        "fill": if upper { "tonexty" } else { "none" },
        "fillcolor": format!("area-{}", ink_name(band.ink)),
    })
}

fn line(curve: &Curve) -> Value {
    let (width, dash) = match curve.dashed {
        true => (1.2, "dash"),
        false => (1.8, "solid"),
    };
    json!({
        "y": curve.points.iter().map(|p| rounded(p.1)).collect::<Vec<_>>(),
        "mode": "lines",
        "line": { "width": width, "color": colour(curve.ink), "dash": dash },
    })
}

/// Dots with their intervals.
fn dots(marks: &Marks) -> Value {
    let each = |of: &dyn Fn(&Mark) -> f64| -> Vec<Value> {
        marks.points.iter().map(|p| rounded(of(p))).collect()
    };
    json!({
        "y": each(&|p| p.y),
        "mode": "markers",
        "marker": { "size": 6, "color": colour(marks.ink) },
        "error_y": {
            "type": "data",
            "array": each(&|p| p.line.map_or(0.0, |(_, high)| high - p.y)),
            "arrayminus": each(&|p| p.line.map_or(0.0, |(low, _)| p.y - low)),
            "width": 0,
            "thickness": 1.2,
            "color": colour(marks.ink),
        },
    })
}

/// Where points lie along x: as a start and a step where they are evenly spaced, which is most of the
/// file otherwise.
fn place(trace: &mut Value, x: Vec<f64>, logarithmic: bool) {
    if let [first, second, ..] = x[..] {
        let step = second - first;
        let off = |(k, x): (usize, &f64)| (x - first - k as f64 * step).abs();
        let even = x.iter().enumerate().all(|at| off(at) <= 1e-6 * step.abs());
        if even && !logarithmic && step > 0.0 {
            // The step counts as often as there are points, so it is not rounded.
            (trace["x0"], trace["dx"]) = (json!(first), json!(step));
            return;
        }
    }
    trace["x"] = x.into_iter().map(rounded).collect();
}

/// More digits than any screen shows; JSON has no NaN, and null breaks a line where a sample is missing.
fn rounded(value: f64) -> Value {
    json!(six_digits(value))
}

fn colour(ink: Ink) -> String {
    format!("ink-{}", ink_name(ink))
}

fn ink_name(ink: Ink) -> &'static str {
    match ink {
        Ink::Reference => "reference",
        Ink::Measured => "measured",
        Ink::Model => "model",
        Ink::SecondModel => "second",
        Ink::Third => "third",
        Ink::Fourth => "fourth",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_library_is_one_script() {
        let library = library();
        assert!(library.starts_with("<script") && library.ends_with("</script>"));
        assert_eq!(library.matches("</script>").count(), 1);
    }

    #[test]
    fn units_even_steps_and_gaps_survive() {
        let hostile = "<b>%{x}";
        let panel = Panel {
            x_label: "time (s)".into(),
            y_label: "way (% of the step)".into(),
            curves: vec![
                Curve::solid(
                    hostile,
                    Ink::Model,
                    [(0.5, 1.0 / 3.0), (1.0, f64::NAN), (1.5, 2.0)],
                ),
                Curve::solid("", Ink::Model, [(0.0, 1.0), (1.0, 1.0), (1.5, 1.0)]),
            ],
            ..Panel::default()
        };
        let figure = Figure {
            name: "x".into(),
            title: "x".into(),
            panels: vec![panel],
        };
        let drawn = plotly_json(&figure);
        let even = &drawn["data"][0];
        assert_eq!((&even["x0"], &even["dx"]), (&json!(0.5), &json!(0.5)));
        assert_eq!(even["y"], json!([0.333333, null, 2.0]));
        assert_eq!(even["name"], "&lt;b&gt;%{x}");
        assert!(even["hovertemplate"].as_str().unwrap().ends_with(" %"));
        assert_eq!(drawn["data"][1]["x"], json!([0.0, 1.0, 1.5]));
        assert_eq!(drawn["layout"]["xaxis"]["ticksuffix"], " s");
        assert!(drawn["layout"]["xaxis"]["tickformat"].is_null());
    }

    #[test]
    fn ticks_between_decades_are_whole_numbers_of_their_own() {
        let panel = Panel {
            x_label: "frequency (Hz)".into(),
            x_logarithmic: true,
            curves: vec![Curve::solid("a", Ink::Model, [(0.4, 1.0), (30.0, 0.1)])],
            ..Panel::default()
        };
        let figure = Figure {
            name: "x".into(),
            title: "x".into(),
            panels: vec![panel],
        };
        let axis = &plotly_json(&figure)["layout"]["xaxis"];
        // The library has the digit alone without a format: 5 for 0.5.
        assert_eq!(
            (&axis["dtick"], &axis["tickformat"]),
            (&json!("D2"), &json!("~g"))
        );
    }
}

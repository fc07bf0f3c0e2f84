//! Figures for plotly.js: zoom, values under the pointer, saving as a picture.

use crate::plots::figure::{Band, Curve, Figure, Ink, Panel};
use serde_json::{Value, json};

/// Room for one panel in the page (pixels).
const PANEL_HEIGHT: usize = 340;

/// Share of the height that lies between two panels.
const GAP: f64 = 0.12;

/// The plotting library itself, as a `<script>` element: it travels inside the report, so that the
/// report needs no network.
pub(super) fn library() -> String {
    let scripts = plotly::Plot::offline_js_sources();
    // The library comes with one for formulas, which the report has none of.
    let end = scripts
        .find("</script>")
        .map_or(scripts.len(), |at| at + "</script>".len());
    scripts.get(..end).unwrap_or_default().to_owned()
}

/// Data and layout of a figure, as plotly.js wants them.
pub(super) fn plotly_json(figure: &Figure) -> Value {
    let count = figure.panels.len().max(1);
    let mut traces = Vec::new();
    let mut layout = json!({
        "height": PANEL_HEIGHT * count + 60,
        "margin": { "l": 70, "r": 20, "t": 20, "b": 60 },
        "hovermode": "x unified",
        "legend": { "orientation": "h", "y": -0.18 / count as f64, "x": 0 },
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "rgba(0,0,0,0)",
        "modebar": { "bgcolor": "rgba(0,0,0,0)", "color": "rgba(128,128,128,.8)" },
    });
    for (index, panel) in figure.panels.iter().enumerate() {
        let suffix = if index == 0 {
            String::new()
        } else {
            (index + 1).to_string()
        };
        let height = (1.0 - GAP * (count - 1) as f64) / count as f64;
        let top = 1.0 - index as f64 * (height + GAP);
        // Panels over the same quantity are zoomed together.
        let like = figure
            .panels
            .iter()
            .position(|other| other.x_label == panel.x_label);
        let matches = like
            .filter(|&first| first < index)
            .map(|first| match first {
                0 => "x".to_owned(),
                first => format!("x{}", first + 1),
            });
        layout[format!("xaxis{suffix}")] = json!({
            "matches": matches,
            "title": { "text": panel.x_label },
            "type": if panel.x_logarithmic { "log" } else { "linear" },
            "anchor": format!("y{suffix}"),
        });
        layout[format!("yaxis{suffix}")] = json!({
            "title": { "text": panel.y_label },
            "domain": [(top - height).max(0.0), top],
            "anchor": format!("x{suffix}"),
        });
        traces.extend(panel_traces(panel, &suffix, index == 0));
    }
    json!({ "data": traces, "layout": layout, "name": figure.name })
}

/// The traces of one panel; the legend names those of the first panel, as the others share them.
fn panel_traces(panel: &Panel, suffix: &str, in_legend: bool) -> Vec<Value> {
    let axes = |mut trace: Value| {
        trace["xaxis"] = format!("x{suffix}").into();
        trace["yaxis"] = format!("y{suffix}").into();
        trace
    };
    let mut traces = Vec::new();
    for Band { name, ink, points } in &panel.bands {
        let edge = |of: fn(&(f64, f64, f64)) -> f64, fill: bool| {
            axes(json!({
                "x": points.iter().map(|p| p.0).collect::<Vec<_>>(),
                "y": points.iter().map(of).collect::<Vec<_>>(),
                "mode": "lines",
                "line": { "width": 0, "color": rgba(*ink, 0.0) },
                "fill": if fill { "tonexty" } else { "none" },
                "fillcolor": rgba(*ink, 0.18),
                "name": if fill { name.clone() } else { format!("{name}, lower") },
                "legendgroup": name,
                "showlegend": false,
                "hovertemplate": "%{y:.5g}",
            }))
        };
        traces.push(edge(|p| p.1, false));
        let mut area = edge(|p| p.2, true);
        area["showlegend"] = in_legend.into();
        traces.push(area);
    }
    for Curve {
        name,
        ink,
        dashed,
        points,
    } in &panel.curves
    {
        // JSON has no NaN; null breaks the line where a sample is missing.
        let number = |value: f64| {
            if value.is_finite() {
                json!(value)
            } else {
                Value::Null
            }
        };
        traces.push(axes(json!({
            "x": points.iter().map(|p| number(p.0)).collect::<Vec<_>>(),
            "y": points.iter().map(|p| number(p.1)).collect::<Vec<_>>(),
            "mode": "lines",
            "line": {
                "width": if *dashed { 1.2 } else { 1.8 },
                "color": rgba(*ink, 1.0),
                "dash": if *dashed { "dash" } else { "solid" },
            },
            "name": name,
            "legendgroup": name,
            "showlegend": in_legend && !name.is_empty(),
            "hovertemplate": "%{y:.5g}",
        })));
    }
    traces
}

/// The colours of the static plots; what is black there follows the page's text colour, which the
/// page's script puts in, because black cannot be read on a dark page.
fn rgba(ink: Ink, opacity: f64) -> String {
    let (r, g, b) = match ink {
        Ink::Reference => return "currentColor".to_owned(),
        Ink::Measured => (0, 114, 178),
        Ink::Model => (213, 94, 0),
        Ink::SecondModel => (0, 158, 115),
    };
    format!("rgba({r},{g},{b},{opacity})")
}

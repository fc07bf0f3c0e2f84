//! A figure as data: panels with bands, curves and marks.

use servoid_identification::results::Model;

/// Panels one above the other, all as wide as the figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Name of its file, without folder and ending.
    pub name: String,
    /// Title above the panels.
    pub title: String,
    /// The panels, from the top.
    pub panels: Vec<Panel>,
}

/// One pair of axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Panel {
    /// Quantity to the right, with its unit.
    pub x_label: String,
    /// Whether the axis to the right is logarithmic.
    pub x_logarithmic: bool,
    /// Quantity upwards, with its unit.
    pub y_label: String,
    /// Place of the legend.
    pub legend: Legend,
    /// Areas, drawn first.
    pub bands: Vec<Band>,
    /// Lines.
    pub curves: Vec<Curve>,
    /// Points, drawn last.
    pub marks: Vec<Marks>,
}

/// Where the curves of a panel leave room.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Legend {
    /// The curves rise to the right.
    #[default]
    LowerRight,
    /// The curves fall to the right.
    UpperRight,
    /// The curves fill the panel: room is made above them.
    Above,
}

/// A line.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Name in the legend; empty for none.
    pub name: String,
    /// Its colour.
    pub ink: Ink,
    /// Whether it is dashed.
    pub dashed: bool,
    /// Its points; the line breaks where a coordinate is NaN.
    pub points: Vec<(f64, f64)>,
}

/// An area between two lines.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// Name in the legend.
    pub name: String,
    /// Its colour.
    pub ink: Ink,
    /// (x, lower, upper)
    pub points: Vec<(f64, f64, f64)>,
}

/// Points.
#[derive(Clone, Debug, PartialEq)]
pub struct Marks {
    /// Name in the legend; empty for none.
    pub name: String,
    /// Their colour.
    pub ink: Ink,
    /// The points.
    pub points: Vec<Mark>,
}

/// One point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// Place to the right.
    pub x: f64,
    /// Place upwards.
    pub y: f64,
    /// The ends of a vertical line through it: an interval, or the foot of a stem.
    pub line: Option<(f64, f64)>,
}

/// The meaning of a line, which decides its colour in every figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// The command.
    Reference,
    /// The measurement.
    Measured,
    /// The first model.
    Model,
    /// The second model.
    SecondModel,
    /// The fourth of several runs.
    Third,
    /// The fifth of several runs.
    Fourth,
}

/// A model with the name of its curves.
#[derive(Clone, Copy, Debug)]
pub struct Named<'a> {
    /// Name in the legend.
    pub name: &'a str,
    /// The model.
    pub model: &'a Model,
}

/// Colours of the first model and of the second.
pub(super) const INKS: [Ink; 2] = [Ink::Model, Ink::SecondModel];

/// "angle (deg)", or the quantity alone where the unit is not known.
pub(super) fn with_unit(quantity: &str, unit: Option<&str>) -> String {
    unit.map_or_else(
        || quantity.to_owned(),
        |unit| format!("{quantity} ({unit})"),
    )
}

impl Figure {
    pub(crate) fn new(name: &str, title: &str, panels: Vec<Panel>) -> Self {
        let (name, title) = (name.to_owned(), title.to_owned());
        Self {
            name,
            title,
            panels,
        }
    }

    /// The range of x that a panel is drawn over: panels with the same x share it. `None` without points.
    pub(super) fn x_range(&self, panel: &Panel) -> Option<(f64, f64)> {
        let alike = self
            .panels
            .iter()
            .filter(|other| other.x_label == panel.x_label);
        let ranges = alike.filter_map(Panel::extent).map(|(x, _)| x);
        ranges.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }
}

/// The label of an axis of time after an edge.
pub(crate) const SINCE_EDGE_LABEL: &str = "time since the edge of the command (ms)";

/// A time in the unit of [`SINCE_EDGE_LABEL`].
pub(crate) fn milliseconds(seconds: f64) -> f64 {
    1e3 * seconds
}

/// The label of a phase.
pub(crate) const PHASE_LABEL: &str = "phase (deg)";

impl Panel {
    /// Whether its values are angles of a frequency response.
    pub(crate) fn is_phase(&self) -> bool {
        self.y_label == PHASE_LABEL
    }

    /// Axes without curves.
    pub(crate) fn new(x_label: &str, y_label: impl Into<String>, legend: Legend) -> Self {
        let (x_label, y_label) = (x_label.to_owned(), y_label.into());
        Self {
            x_label,
            y_label,
            legend,
            ..Self::default()
        }
    }

    /// The smallest and largest finite coordinates of everything in it: ((x, x), (y, y)). `None` without points.
    pub(crate) fn extent(&self) -> Option<((f64, f64), (f64, f64))> {
        let curves = self.curves.iter().flat_map(|c| c.points.iter().copied());
        let bands = self.bands.iter().flat_map(|b| &b.points);
        let edges = bands.flat_map(|&(x, lower, upper)| [(x, lower), (x, upper)]);
        let marks = self.marks.iter().flat_map(|m| &m.points).flat_map(|mark| {
            let (low, high) = mark.line.unwrap_or((mark.y, mark.y));
            [(mark.x, mark.y), (mark.x, low), (mark.x, high)]
        });
        let all = curves.chain(edges).chain(marks);
        let finite = all.filter(|(x, y)| x.is_finite() && y.is_finite());
        finite
            .map(|(x, y)| ((x, x), (y, y)))
            .reduce(|((a, b), (c, d)), ((x, _), (y, _))| {
                ((a.min(x), b.max(x)), (c.min(y), d.max(y)))
            })
    }
}

impl Curve {
    /// A solid line.
    pub(crate) fn solid(
        name: impl Into<String>,
        ink: Ink,
        points: impl IntoIterator<Item = (f64, f64)>,
    ) -> Self {
        let (name, points) = (name.into(), points.into_iter().collect());
        Self {
            name,
            ink,
            dashed: false,
            points,
        }
    }

    /// A dashed line.
    pub(crate) fn dashed(
        name: impl Into<String>,
        ink: Ink,
        points: impl IntoIterator<Item = (f64, f64)>,
    ) -> Self {
        Self {
            dashed: true,
            ..Self::solid(name, ink, points)
        }
    }
}

impl Band {
    /// The area between two lines over the same x.
    pub(crate) fn between(
        name: String,
        ink: Ink,
        x: impl IntoIterator<Item = f64>,
        lower: &[f64],
        upper: &[f64],
    ) -> Self {
        let edges = lower.iter().zip(upper);
        let points = x
            .into_iter()
            .zip(edges)
            .map(|(x, (&low, &high))| (x, low, high));
        Self {
            name,
            ink,
            points: points.collect(),
        }
    }
}

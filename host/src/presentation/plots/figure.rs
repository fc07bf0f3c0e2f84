//! What a picture shows, as data.

/// A picture: panels one above the other, all as wide as the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Name of its file, without folder and ending.
    pub name: String,
    /// What it says above the panels.
    pub title: String,
    /// The panels, from the top.
    pub panels: Vec<Panel>,
}

/// One pair of axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Panel {
    /// What runs to the right, with its unit.
    pub x_label: String,
    /// Whether it runs logarithmically.
    pub x_logarithmic: bool,
    /// What runs upwards, with its unit.
    pub y_label: String,
    /// Where the legend hides nothing.
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
    /// They rise to the right.
    #[default]
    LowerRight,
    /// They fall to the right.
    UpperRight,
    /// They fill the panel: room is made above them.
    Above,
}

/// A line.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// What the legend calls it; empty for none.
    pub name: String,
    /// How it is drawn.
    pub ink: Ink,
    /// Whether it is dashed.
    pub dashed: bool,
    /// Its points; the line breaks where a coordinate is NaN.
    pub points: Vec<(f64, f64)>,
}

/// An area between two lines.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// What the legend calls it.
    pub name: String,
    /// How it is drawn.
    pub ink: Ink,
    /// (x, lower, upper)
    pub points: Vec<(f64, f64, f64)>,
}

/// Points.
#[derive(Clone, Debug, PartialEq)]
pub struct Marks {
    /// What the legend calls them; empty for none.
    pub name: String,
    /// How they are drawn.
    pub ink: Ink,
    /// The points.
    pub points: Vec<Mark>,
}

/// One point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// Where.
    pub x: f64,
    /// Where.
    pub y: f64,
    /// The ends of a vertical line through it: an interval, or the foot of a stem.
    pub line: Option<(f64, f64)>,
}

/// What a line stands for decides its colour, the same in every picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// What was commanded.
    Reference,
    /// What was measured.
    Measured,
    /// The first model.
    Model,
    /// The second model.
    SecondModel,
    /// Further lines, where runs have to be told apart.
    Third,
    /// And one more.
    Fourth,
}

impl Ink {
    /// Runs beside each other; from the sixth on the colours come again.
    #[must_use]
    pub fn of_run(index: usize) -> Self {
        match index % 5 {
            0 => Ink::Measured,
            1 => Ink::Model,
            2 => Ink::SecondModel,
            3 => Ink::Third,
            _ => Ink::Fourth,
        }
    }
}

impl Panel {
    /// The smallest and largest finite coordinates of everything in it: ((x, x), (y, y)).
    /// `None` where there is nothing to show.
    #[must_use]
    pub fn extent(&self) -> Option<((f64, f64), (f64, f64))> {
        let curves = self.curves.iter().flat_map(|c| c.points.iter().copied());
        let bands = self.bands.iter().flat_map(|b| &b.points);
        let edges = bands.flat_map(|&(x, lower, upper)| [(x, lower), (x, upper)]);
        let mut extent: Option<((f64, f64), (f64, f64))> = None;
        let marks = self.marks.iter().flat_map(|m| &m.points).flat_map(|mark| {
            let (low, high) = mark.line.unwrap_or((mark.y, mark.y));
            [(mark.x, mark.y), (mark.x, low), (mark.x, high)]
        });
        for (x, y) in curves
            .chain(edges)
            .chain(marks)
            .filter(|(x, y)| x.is_finite() && y.is_finite())
        {
            let ((x0, x1), (y0, y1)) = extent.get_or_insert(((x, x), (y, y)));
            (*x0, *x1, *y0, *y1) = (x0.min(x), x1.max(x), y0.min(y), y1.max(y));
        }
        extent
    }
}

impl Figure {
    /// The range of x that a panel is drawn over: panels with the same x share it, so that what
    /// happens at one time is at one place in all of them. `None` where there is nothing to show.
    #[must_use]
    pub fn x_range(&self, panel: &Panel) -> Option<(f64, f64)> {
        let alike = self
            .panels
            .iter()
            .filter(|other| other.x_label == panel.x_label);
        let ranges = alike.filter_map(Panel::extent).map(|(x, _)| x);
        ranges.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }
}

impl Curve {
    /// A solid line.
    pub fn solid(
        name: impl Into<String>,
        ink: Ink,
        points: impl IntoIterator<Item = (f64, f64)>,
    ) -> Self {
        Self {
            name: name.into(),
            ink,
            dashed: false,
            points: points.into_iter().collect(),
        }
    }

    /// A dashed line.
    pub fn dashed(
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

//! Figures of recordings and models.
//!
//! A [`Figure`] is data. The functions here make figures from records and models: the paper's figures, and those
//! that show whether the results can be trusted. [`draw`] turns a figure into SVG; the report turns the same
//! figures into interactive ones.

mod answer;
mod difference;
mod figure;
mod held_out;
mod outliers;
mod paper_figures;
mod residuals;
mod response;
mod run_scatter;
mod signals;
mod strokes;
mod structure;
mod svg;
mod ticks;

pub use answer::{DrawnAnswer, answer};
pub use difference::difference;
pub use figure::{Band, Curve, Figure, Ink, Legend, Mark, Marks, Named, Panel};
pub use held_out::{held_out, held_out_caption};
pub use outliers::left_out;
pub use paper_figures::{PaperFigure, PaperFigureKind, Subject, identification, paper};
pub use residuals::residuals;
pub use response::{bode, servo_frequency, shown_frequencies, step_response};
pub use run_scatter::run_scatter;
pub use signals::{input_output, predicted, validation};
pub use strokes::NamedServo;
pub use structure::structure;
pub use svg::draw;

pub(crate) use figure::{SINCE_EDGE_LABEL, milliseconds};
pub(crate) use signals::MOST_RUNS;

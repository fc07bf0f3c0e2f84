//! Least squares on D-filtered rows. Its cost does not depend on the length of the record.
//!
//! For a bank with impulse map T and a noise filter D the rows D(z)[φ', 1] and D(z)y have
//!
//! ```text
//! A = sum_ij d_i d_j T' R[i:i+N, j:j+N] T     b = sum_ij d_i d_j T' r[i:i+N, j]     c = d' Y d
//! ```
//!
//! and the residuals v of a solution h = Tθ, c have the moments E\[i,j\] that the noise model needs.
//! The rows are kept in one of two forms:
//!
//! * **moments** (the fast path): inner products of the rows, solved by an equilibrated Cholesky
//!   factorisation. Its error grows with the condition number of A.
//! * **triangular factor** (the fallback): the factor R of the rows themselves by blocked QR. Its
//!   error grows with the square root of that condition number; the pass over the data is slower.

mod coordinates;
mod normal_equations;
mod residual_moments;
mod row_information;
mod solution;
mod triangular;

pub use coordinates::Coordinates;
pub(crate) use normal_equations::{
    Edges, NormalEquations, complete_bank_rss, filtered_input_moments, lower_input_moments,
    solve_moments,
};
pub(crate) use residual_moments::residual_moments_of_lags;
pub use row_information::{RowInformation, Solver};
pub use solution::Solution;

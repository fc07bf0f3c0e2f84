//! Numbers that carry their derivatives (forward-mode differentiation).
//!
//! The same generic code then gives a value (`f64`) or a value with its derivatives by `W` variables ([`Dual`]).
//! A branch is taken by the value alone.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// What code needs of a number to be differentiated.
pub trait Scalar:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Mul<f64, Output = Self>
{
    /// A constant: all derivatives are zero.
    fn constant(value: f64) -> Self;

    /// The value alone.
    fn value(self) -> f64;

    /// Its sine \[rad\].
    fn sin(self) -> Self;

    /// e to its power.
    fn exp(self) -> Self;

    /// Its size.
    #[must_use]
    #[inline(always)]
    fn abs(self) -> Self {
        if self.value() < 0.0 { -self } else { self }
    }
}

impl Scalar for f64 {
    #[inline]
    fn constant(value: f64) -> Self {
        value
    }

    #[inline]
    fn value(self) -> f64 {
        self
    }

    #[inline]
    fn sin(self) -> Self {
        f64::sin(self)
    }

    #[inline]
    fn exp(self) -> Self {
        f64::exp(self)
    }
}

/// A value and its derivatives by `W` variables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const W: usize> {
    /// The value.
    pub value: f64,
    /// The derivatives, in the order of the variables.
    pub slope: [f64; W],
}

impl<const W: usize> Dual<W> {
    /// The variable number `index`: its derivative by itself is 1.
    pub fn variable(value: f64, index: usize) -> Self {
        let mut slope = [0.0; W];
        slope[index] = 1.0;
        Self { value, slope }
    }

    /// A function of `self` with the value `value` and the derivative `by_self`.
    #[inline(always)]
    fn chained(mut self, value: f64, by_self: f64) -> Self {
        self.value = value;
        for slope in &mut self.slope {
            *slope *= by_self;
        }
        self
    }
}

impl<const W: usize> Scalar for Dual<W> {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self {
            value,
            slope: [0.0; W],
        }
    }

    #[inline(always)]
    fn value(self) -> f64 {
        self.value
    }

    #[inline]
    fn sin(self) -> Self {
        let (sin, cos) = self.value.sin_cos();
        self.chained(sin, cos)
    }

    #[inline]
    fn exp(self) -> Self {
        let exp = self.value.exp();
        self.chained(exp, exp)
    }
}

impl<const W: usize> Add for Dual<W> {
    type Output = Self;

    #[inline(always)]
    fn add(mut self, other: Self) -> Self {
        self.value += other.value;
        for i in 0..W {
            self.slope[i] += other.slope[i];
        }
        self
    }
}

impl<const W: usize> Sub for Dual<W> {
    type Output = Self;

    #[inline(always)]
    fn sub(mut self, other: Self) -> Self {
        self.value -= other.value;
        for i in 0..W {
            self.slope[i] -= other.slope[i];
        }
        self
    }
}

impl<const W: usize> Mul for Dual<W> {
    type Output = Self;

    #[inline(always)]
    fn mul(mut self, other: Self) -> Self {
        for i in 0..W {
            self.slope[i] = self.slope[i] * other.value + self.value * other.slope[i];
        }
        self.value *= other.value;
        self
    }
}

impl<const W: usize> Div for Dual<W> {
    type Output = Self;

    #[inline(always)]
    fn div(mut self, other: Self) -> Self {
        let reciprocal = 1.0 / other.value;
        let quotient = self.value * reciprocal;
        for i in 0..W {
            self.slope[i] = (self.slope[i] - quotient * other.slope[i]) * reciprocal;
        }
        self.value = quotient;
        self
    }
}

impl<const W: usize> Neg for Dual<W> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.chained(-self.value, -1.0)
    }
}

impl<const W: usize> Mul<f64> for Dual<W> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        self.chained(self.value * factor, factor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn formula<S: Scalar>(x: S, y: S) -> S {
        (x * y - (x / y).exp()) * 0.5 + (-(y * x)).sin() + S::constant(3.0) * y
    }

    /// Against differences: their error is of the order of the cube root of the rounding, squared.
    #[test]
    fn derivatives_are_those_of_differences() {
        let (x, y, step) = (0.7, 1.3, 1e-5);
        let found = formula(Dual::<2>::variable(x, 0), Dual::variable(y, 1));
        assert_eq!(found.value(), formula(x, y));
        let by_x = (formula(x + step, y) - formula(x - step, y)) / (2.0 * step);
        let by_y = (formula(x, y + step) - formula(x, y - step)) / (2.0 * step);
        for (slope, difference) in found.slope.into_iter().zip([by_x, by_y]) {
            assert!((slope - difference).abs() < 1e-8, "{slope} {difference}");
        }
    }
}

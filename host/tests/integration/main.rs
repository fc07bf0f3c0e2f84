//! The program as a user meets it.

mod capture;
mod demo;
mod errors;
mod identify;
mod support;

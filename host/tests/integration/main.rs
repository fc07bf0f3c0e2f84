//! The program as a user meets it.

mod browser;
mod capture;
mod chaos;
mod demo;
mod errors;
mod files;
mod hostile;
mod identify;
mod report;
mod support;
mod verdicts;

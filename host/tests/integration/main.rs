//! The program as a user meets it.

mod capture;
mod chaos;
mod demo;
mod errors;
mod export;
mod files;
mod help;
mod hostile;
mod identify;
mod plan;
mod references;
mod support;

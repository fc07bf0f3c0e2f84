//! The program as a user meets it.

#[cfg(unix)]
mod browser;
mod calibrate;
mod capture;
mod chaos;
mod damage;
mod demo;
mod doubts;
mod errors;
mod export;
mod few_levels;
mod files;
mod finite;
mod first_sentence;
mod flash;
mod foreign;
mod help;
mod hostile;
#[cfg(unix)]
mod hostile_surroundings;
mod identify;
mod init;
mod linearity;
#[cfg(unix)]
mod mixes;
mod models;
mod no_bounds;
mod own_pulses;
#[cfg(unix)]
mod pages;
mod plan;
mod references;
mod release;
mod report;
mod results;
mod safekeeping;
mod same_data;
#[cfg(target_os = "linux")]
mod scope;
mod sensor_delay;
mod servo_model;
mod servo_model_uses;
mod sessions;
mod sides;
mod strokes;
mod support;
mod sweeps;
#[cfg(target_os = "linux")]
mod terminal;
mod trains;
mod travel;
mod units;
mod validation;
mod verdicts;
mod wording;

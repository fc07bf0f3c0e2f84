//! The conversation with the firmware's own rig, in memory and in a time that the tests give: none of
//! them waits.

mod bad_lines;
mod bench;
mod late;
mod lies;
mod line;
mod runs;
mod sessions;
mod time;
mod trains;

//! Tests across the rooms.

mod direct;
mod truth;

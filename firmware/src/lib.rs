//! The rig's behaviour, over a [`Board`] and a [`Link`].
//!
//! The same code runs on the STM32F103 and, inside the simulator, on a PC.

#![cfg_attr(not(test), no_std)]

pub mod board;

pub use board::{Board, CapturedFrame, Identity, Link};

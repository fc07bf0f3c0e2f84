//! A virtual STM32F103 board: runs the flash image, byte for byte, in closed loop with a simulated servo.
//!
//! ```text
//!            +--------------------- chip -----------------------+
//!  image --> | core <--> bus <--> RCC GPIO TIM ADC DMA USART ... | <--> line <--> host
//!            +----------------- PA1 | ^ PA4 --------------------+
//!                                   v |
//!                            servo --> shaft --> sensor
//! ```
//!
//! The board advances a core instruction by instruction, and the chip event by event. Each peripheral is one model,
//! written from the reference manual. What the program does that a real chip would not allow goes into the record, as
//! do its pulses, conversions and log.
//!
//! A function that is not modelled is reported when the program uses it. Not modelled at all: most analog effects,
//! contention on the buses, the few cycles from one timer to another.

mod bootloader;
mod bus;
mod chip;
mod flash_memory;
mod line;
mod loop_wire;
mod options;
mod peripherals;
mod plant;
mod rtt;
mod supply;

pub mod board;
pub mod cpu;
pub mod fault;
pub mod image;
pub mod memory;
pub mod record;
pub mod server;
pub mod time;

pub use board::VirtualBoard;
pub use fault::Fault;
pub use image::Image;
pub use loop_wire::LoopWire;
pub use options::BoardOptions;

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
//! | module          | content                                                            |
//! |-----------------|--------------------------------------------------------------------|
//! | [`board`]       | the whole board, and the loop that advances its time                |
//! | [`cpu`]         | the trait of a core, and its implementation                         |
//! | [`bus`]         | from addresses to registers                                         |
//! | [`chip`]        | the peripherals and the wires between them                          |
//! | [`peripherals`] | one model each, written from the reference manual                   |
//! | [`plant`]       | servo and sensor on the board's pins                                |
//! | [`mod@line`]      | the serial line                                                     |
//! | [`fault`]       | injected faults                                                     |
//! | [`image`], [`rtt`] | the program, and its log                                         |
//! | [`record`]      | events and irregularities                                           |
//! | [`memory`], [`time`] | the memory map, and the unit of time                           |
//! | [`server`]      | the board as a serial port of this machine                          |
//!
//! A function that is not modelled is reported when the program uses it. Not modelled at all: analog effects, wait
//! states of the flash, contention on the buses, the few cycles from a trigger to its effect, and a debugger.

pub mod board;
pub mod bus;
pub mod chip;
pub mod cpu;
pub mod fault;
pub mod image;
pub mod line;
pub mod memory;
pub mod peripherals;
pub mod plant;
pub mod record;
pub mod rtt;
pub mod server;
pub mod time;

pub use board::{BoardOptions, VirtualBoard};
pub use fault::Fault;
pub use image::Image;

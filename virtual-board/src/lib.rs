//! A virtual STM32F103 board: runs the very image that is flashed, in closed loop with a simulated
//! servo.
//!
//! ```text
//!            +--------------------- chip -----------------------+
//!  image --> | core <--> bus <--> RCC GPIO TIM ADC DMA USART ... | <--> line <--> host
//!            +----------------- PA1 | ^ PA4 --------------------+
//!                                   v |
//!                            servo --> shaft --> sensor
//! ```
//!
//! | module          | what it holds                                                      |
//! |-----------------|--------------------------------------------------------------------|
//! | [`board`]       | the whole board, and the loop that lets its time pass               |
//! | [`cpu`]         | what a core has to do, and the one that is used                     |
//! | [`bus`]         | from addresses to registers                                         |
//! | [`chip`]        | the peripherals and the wires between them                          |
//! | [`peripherals`] | one model each, written from the reference manual                   |
//! | [`plant`]       | servo and sensor on the board's pins                                |
//! | [`mod@line`]      | the serial line                                                     |
//! | [`fault`]       | what may go wrong on purpose                                        |
//! | [`image`], [`rtt`] | the program, and its log                                         |
//! | [`record`]      | what happened, and what should not have happened                    |
//! | [`memory`], [`time`] | the memory map, and the unit of time                           |
//! | [`server`]      | the board as a serial port of this machine                          |
//!
//! What is not modelled is reported when the program asks for it. What no model here knows: analog
//! effects, wait states of the flash, contention on the buses, the few cycles from a trigger to what
//! it triggers, and a debugger.

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

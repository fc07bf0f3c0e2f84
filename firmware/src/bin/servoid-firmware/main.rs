//! The rig on an STM32F103C8.
//!
//! ```text
//!  TIM2  20 ms, or as the rig is armed, 1 µs steps --- CH2, compare preloaded ---> PA1  pulse to the servo
//!   | started by one write
//!   v TRGO = enable
//!  TIM3  2 ms, or the whole fraction of the pulses' period near it, half a millisecond late
//!   | TRGO = update ----------------------------------> TIM4  counts the samples
//!   v
//!  ADC1  PA4 four times <--- Hall sensor
//!   v
//!  DMA1 channel 1, a ring of two frames --- half done ---> one wake-up, one frame
//! ```
//!
//! The processor is not in the timing path. A frame is one pulse, or several equal ones, with ten samples. 1.4 ms before each
//! frame's edge (0.7 ms with pulses at 333 Hz) it takes the samples of the last frame and
//! prepares the pulse of the next one. Then the ADC measures the chip's reference voltage, between two samples; in a
//! self-test it takes a probe of PA4 instead, which channel 1 of TIM2 starts.
//!
//! Section numbers in the comments are those of the reference manual RM0008; docs/hardware.md has what was held against
//! other sources.
//!
//! | pin  | use                               |
//! |------|-----------------------------------|
//! | PA1  | TIM2_CH2: pulse to the servo      |
//! | PA4  | ADC_IN4: Hall sensor, behind a divider from 5 V to 3.3 V |
//! | PA9  | USART1_TX: to the host            |
//! | PA10 | USART1_RX: from the host          |
//! | PC13 | LED to the supply: on while pulses are on; blinks on a chip with half the memory |
//!
//! # Interrupts
//!
//! | handler         | when            | longest latency                                                 |
//! |-----------------|-----------------|-----------------------------------------------------------------|
//! | `DMA1_CHANNEL1` | each frame      | 1.4 ms (0.7 ms at 333 Hz), or the frame counts as lost                              |
//! | `USART1`        | each byte       | one byte time, 87 µs, or a byte is lost and its request repeated |
//!
//! Both keep the priority of the reset, so neither interrupts the other. Each takes a few microseconds, less than
//! the other's longest latency, and one stack depth is enough. The voltage detector sets a pending bit, which is read in
//! each frame, and interrupts nothing.

#![no_std]
#![no_main]
#![allow(unsafe_code)] // registers; each block names the section of the manual that allows it

mod awake;
mod clock;
mod debugger;
mod identity;
mod injected;
mod last_fault;
mod line;
mod pulse;
mod safety;
mod sampling;
mod serial;
mod small_part;
mod stack;
mod supply;
mod timing;
mod watchdog;

use defmt_rtt as _;
use servoid_firmware::{Board, CapturedFrame, Identity, serve};
use servoid_protocol::hello::{ClockSource, ResetCause};
use servoid_protocol::loopback::Vitals;
use servoid_protocol::{PulseTrain, PulseWidth};
use stm32f1xx_hal::gpio::{Output, PC13, PushPull};
use stm32f1xx_hal::pac::Peripherals;
use stm32f1xx_hal::prelude::*;
use stm32f1xx_hal::watchdog::IndependentWatchdog;

/// The board as the rig sees it.
struct Stm32f103 {
    identity: Identity,
    led: PC13<Output<PushPull>>,
    watchdog: IndependentWatchdog,
    /// Number of the newest frame.
    newest: Option<u32>,
}

impl Board for Stm32f103 {
    fn identity(&self) -> Identity {
        self.identity
    }

    async fn next_frame(&mut self) -> CapturedFrame {
        let frame = sampling::next_frame().await;
        let lost = self.newest.map_or(0, |before| frame.lost_since(before));
        if lost > 0 {
            defmt::warn!("{=u32} frames lost before {=u32}", lost, frame.number);
        }
        self.newest = Some(frame.number);
        frame
    }

    fn set_train(&mut self, train: PulseTrain) {
        pulse::set_train(train);
    }

    fn set_pulse(&mut self, pulse: Option<PulseWidth>) {
        pulse::set(pulse);
    }

    fn set_probe(&mut self, at_us: Option<u16>) {
        injected::ask(at_us);
    }

    fn vitals(&mut self) -> Vitals {
        let (stack_bytes, stack_unused) = stack::room_and_unused();
        Vitals {
            frames: self.newest.map_or(0, |newest| newest.wrapping_add(1)),
            awake_us: awake::awake_us(),
            stack_bytes,
            stack_unused,
        }
    }

    fn feed_watchdog(&mut self) {
        self.watchdog.feed();
    }

    fn show_armed(&mut self, armed: bool) {
        self.led.set_state((!armed).into()); // the LED lies between the supply and the pin
    }
}

#[cortex_m_rt::entry]
fn main() -> ! {
    match program() {
        Ok(token) => awake::run(token),
        // It is the first one, so there is room.
        Err(_) => safety::give_up(),
    }
}

/// Starts the hardware in the order of the timing chain, then serves for ever.
#[embassy_executor::task]
async fn program() {
    let Some(p) = Peripherals::take() else {
        safety::give_up()
    };
    let watchdog = watchdog::start(p.IWDG);
    stack::paint();
    let start = identity::Start {
        reset_cause: identity::take_reset_cause(&p.RCC),
        last_fault: last_fault::take(),
    };
    debugger::prepare(&p.DBGMCU);
    clock::as_after_reset(&p.RCC);
    let signature = identity::read_signature(&p.DBGMCU);
    let (mut rcc, source) = clock::start(p.RCC, p.FLASH);
    supply::watch(&p.PWR, &p.EXTI, &mut rcc);

    // SAFETY: but for PA1, which is low since the first instructions and becomes the timer's below, all pins are as a
    // reset leaves them. A reset here would let go of the pulse line.
    let mut gpioa = unsafe { p.GPIOA.split_without_reset(&mut rcc) };
    let mut gpioc = p.GPIOC.split(&mut rcc);
    let led = gpioc
        .pc13
        .into_push_pull_output_with_state(&mut gpioc.crh, true.into());
    gpioa.pa4.into_analog(&mut gpioa.crl);

    let chain = timing::prepare(p.TIM2, p.TIM3, p.TIM4, &mut rcc);
    // Not earlier: from here on the timer holds the line low, as the port did before.
    gpioa.pa1.into_alternate_push_pull(&mut gpioa.crl);
    sampling::arm(p.ADC1, p.DMA1, &mut rcc);
    let tx = gpioa.pa9.into_alternate_push_pull(&mut gpioa.crh);
    let rx = gpioa.pa10.into_pull_up_input(&mut gpioa.crh);
    let mut link = serial::open(p.USART1, tx, rx, &mut rcc);

    let mut board = Stm32f103 {
        identity: identity::of(signature, source, start, &rcc.clocks),
        led,
        watchdog,
        newest: None,
    };
    defmt::info!(
        "servoid {=str}: crystal {=bool}, after a watchdog reset {=bool}",
        env!("CARGO_PKG_VERSION"),
        source == ClockSource::Crystal,
        start.reset_cause == ResetCause::Watchdog,
    );
    if let Some(fault) = start.last_fault {
        defmt::error!(
            "the last program ended by {=str} {=u32:#x} {=str}",
            last_fault::name(fault.kind),
            fault.detail,
            fault.place.as_str()
        );
    }
    chain.start();
    serve(&mut board, &mut link).await
}

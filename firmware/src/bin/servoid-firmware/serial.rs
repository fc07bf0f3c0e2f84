//! The byte link: USART1, by interrupt, through two rings.

use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::pipe::Pipe;
use servoid_firmware::Link;
use servoid_protocol::framing::MAX_WIRE;
use servoid_protocol::timing::FRAME_US;
use stm32f1xx_hal::gpio::{Alternate, Input, PA9, PA10, PullUp};
use stm32f1xx_hal::pac::{Interrupt, NVIC, USART1, interrupt};
use stm32f1xx_hal::prelude::*;
use stm32f1xx_hal::rcc::Rcc;
use stm32f1xx_hal::serial::{Config, Serial};

/// Bits per second, in frames of ten: start, eight data, stop.
const BAUD: u32 = 115_200;

/// Capacity of the line in one frame of the usual train (bytes).
const BYTES_PER_FRAME: usize = (BAUD as u64 / 10 * FRAME_US as u64).div_ceil(1_000_000) as usize;

/// Received bytes of a whole frame, should the rig ever be that late.
const RX_RING: usize = BYTES_PER_FRAME.next_power_of_two();

/// The rig fills this ring at least once in each frame. With room for one frame and one message, the line is never
/// idle while data wait.
const TX_RING: usize = (BYTES_PER_FRAME + MAX_WIRE).next_power_of_two();

static RX: Pipe<CriticalSectionRawMutex, RX_RING> = Pipe::new();
static TX: Pipe<CriticalSectionRawMutex, TX_RING> = Pipe::new();

/// The link.
pub struct Usart(());

/// Opens the link: 8 data bits, no parity, one stop bit. An idle line is high, so with the pull-up an unplugged
/// cable is silence, not noise.
pub fn open(usart: USART1, tx: PA9<Alternate>, rx: PA10<Input<PullUp>>, rcc: &mut Rcc) -> Usart {
    let config = Config::default().baudrate(BAUD.bps());
    let (_, mut rx) = Serial::new(usart, (tx, rx), config, rcc).split();
    rx.listen();
    // SAFETY: everything that the handler below uses is set up.
    unsafe { NVIC::unmask(Interrupt::USART1) };
    Usart(())
}

impl Link for Usart {
    async fn receive(&mut self, buffer: &mut [u8]) -> usize {
        RX.read(buffer).await
    }

    fn try_send(&mut self, bytes: &[u8]) -> bool {
        if TX.free_capacity() < bytes.len() {
            return false;
        }
        // In at most two parts: the ring takes what fits before its end, then the rest.
        let mut rest = bytes;
        while let Ok(written) = TX.try_write(rest) {
            rest = rest.get(written..).unwrap_or_default();
            if rest.is_empty() {
                break;
            }
        }
        // The handler clears this bit when the ring is empty, so it must not run in between.
        critical_section::with(|_| {
            // SAFETY: in a critical section nothing else writes this register.
            let usart = unsafe { USART1::steal() };
            usart.cr1().modify(|_, w| w.txeie().set_bit()); // 27.6.4
        });
        true
    }
}

/// A byte was received, or the next one can be sent.
#[interrupt]
fn USART1() {
    // SAFETY: the only other user changes one bit of CR1, in a critical section.
    let usart = unsafe { USART1::steal() };
    let status = usart.sr().read();
    if status.rxne().bit_is_set() || status.ore().bit_is_set() {
        // Reading DR after SR clears both flags, and those of noise and framing (27.6.1). A damaged byte is passed on:
        // the CRC of the frame finds it.
        let byte = usart.dr().read().dr().bits() as u8;
        if status.rxne().bit_is_set() {
            // A full ring loses the byte; the CRC fails, and the host repeats its request.
            let _ = RX.try_write(&[byte]);
        }
    }
    if status.txe().bit_is_set() && usart.cr1().read().txeie().bit_is_set() {
        let mut byte = [0];
        if TX.try_read(&mut byte).is_ok() {
            usart.dr().write(|w| w.dr().set(byte[0].into()));
        } else {
            usart.cr1().modify(|_, w| w.txeie().clear_bit());
        }
    }
}

//! Sampling: ADC1 by trigger, DMA into a ring of two frames, one interrupt for each frame.

use crate::injected::{Injected, SENSOR_CHANNEL};
use crate::{pulse, supply, timing};
use core::cell::UnsafeCell;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::channel::Channel;
use servoid_firmware::{CapturedFrame, FrameTiming};
use servoid_protocol::Counts;
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use stm32f1xx_hal::pac::{ADC1, DMA1, Interrupt, NVIC, interrupt};
use stm32f1xx_hal::rcc::{Clocks, Enable, Rcc, Reset};

/// Conversions summed into one sample: as many as still fit two bytes on the wire.
pub const OVERSAMPLING: usize = 4;

/// Counts of a sensor at the supply rail: 12 bits each (11.1).
pub const FULL_SCALE: Counts = Counts(OVERSAMPLING as u16 * 4_095);

const _: () = assert!(FULL_SCALE.0 <= Counts::MAX_TWO_BYTES.0);

/// Half ADC clock cycles of one conversion: 239.5 for sampling and 12.5 for converting (11.6). The
/// longest sampling time there is, because the divider before the pin has a high impedance.
const HALF_CYCLES: u32 = 479 + 25;

/// From the start of a sample's first conversion to the end of its last one (µs), rounded up.
pub fn aperture_us(clocks: &Clocks) -> u16 {
    let half_cycles = HALF_CYCLES * OVERSAMPLING as u32;
    (half_cycles * 1_000).div_ceil(2 * clocks.adcclk().to_kHz()) as u16
}

/// The conversions of one frame.
type RawFrame = [[u16; OVERSAMPLING]; SAMPLES_PER_FRAME];

/// Two frames: the DMA fills one while the other is read.
struct Ring(UnsafeCell<[RawFrame; 2]>);

// SAFETY: the DMA writes; only the interrupt handler reads, and only the half that is complete.
unsafe impl Sync for Ring {}

static RING: Ring = Ring(UnsafeCell::new([[[0; OVERSAMPLING]; SAMPLES_PER_FRAME]; 2]));

/// Transfers in the ring.
const TRANSFERS: u16 = (2 * SAMPLES_PER_FRAME * OVERSAMPLING) as u16;

/// Queue of frames for the rig, which takes each one within a millisecond. A frame that does not fit is lost; the
/// gap in the frame numbers shows it.
static FRAMES: Channel<CriticalSectionRawMutex, CapturedFrame, 4> = Channel::new();

/// Waits for the next frame.
pub async fn next_frame() -> CapturedFrame {
    FRAMES.receive().await
}

/// Prepares the ADC and the DMA for the first trigger. The timers must be prepared and stopped.
///
/// Not with the HAL: it would start the ADC by software, and the ring would be off by one sample for ever.
pub fn arm(adc: ADC1, dma: DMA1, rcc: &mut Rcc) {
    ADC1::enable(rcc);
    ADC1::reset(rcc);
    DMA1::enable(rcc);
    calibrate(&adc, rcc.clocks.sysclk().to_MHz());
    adc.cr1().write(|w| w.scan().set_bit()); // 11.3.8
    adc.smpr2().write(|w| w.smp4().cycles239_5());
    // 11.12.9, 11.12.11: the same channel four times in a row.
    // SAFETY: channel 4 exists.
    adc.sqr3()
        .write(|w| unsafe { (0..OVERSAMPLING as u8).fold(w, |w, n| w.sq(n).bits(SENSOR_CHANNEL)) });
    adc.sqr1().write(|w| w.l().set(OVERSAMPLING as u8 - 1));
    supply::prepare_bandgap(&adc);
    arm_dma(&adc, dma);
    // In one write, with ADON unchanged: a write that only sets ADON = 1 again would start a conversion (11.12.3).
    adc.cr2().modify(|_, w| {
        w.dma().set_bit();
        w.extsel().tim3trgo();
        w.exttrig().set_bit();
        w.jextsel().jswstart();
        w.jexttrig().set_bit();
        w.tsvrefe().set_bit()
    });
    // SAFETY: everything that the handler below uses is set up.
    unsafe { NVIC::unmask(Interrupt::DMA1_CHANNEL1) };
}

/// Powers the ADC up and runs its calibration (11.4).
fn calibrate(adc: &ADC1, cycles_per_microsecond: u32) {
    adc.cr2().write(|w| w.adon().set_bit());
    // Stabilisation, 1 µs (datasheet, tSTAB); twice that, which is also two ADC cycles and more.
    cortex_m::asm::delay(2 * cycles_per_microsecond);
    adc.cr2().modify(|_, w| w.rstcal().set_bit());
    while adc.cr2().read().rstcal().bit_is_set() {}
    adc.cr2().modify(|_, w| w.cal().set_bit());
    while adc.cr2().read().cal().bit_is_set() {}
}

/// DMA1 channel 1 belongs to ADC1 (13.3.7).
fn arm_dma(adc: &ADC1, dma: DMA1) {
    let channel = dma.ch1();
    // SAFETY: both addresses stay valid for ever, and the ring has room for all transfers (13.4.5,
    // 13.4.6).
    unsafe {
        channel
            .par()
            .write(|w| w.pa().bits(adc.dr().as_ptr() as u32));
        channel.mar().write(|w| w.ma().bits(RING.0.get() as u32));
    }
    channel.ndtr().write(|w| w.ndt().set(TRANSFERS));
    channel.cr().write(|w| {
        w.pl().very_high();
        w.msize().bits16();
        w.psize().bits16();
        w.minc().set_bit();
        w.circ().set_bit();
        w.htie().set_bit();
        w.tcie().set_bit();
        w.en().set_bit()
    });
}

/// A frame is complete: its half of the ring is full.
#[interrupt]
fn DMA1_CHANNEL1() {
    // Frames that were complete at the last call.
    static mut COMPLETE: u32 = 0;
    static mut INJECTED: Injected = Injected::new();

    // SAFETY: only this handler clears the flags of channel 1 (13.4.2), by writing 1 to them.
    let dma = unsafe { DMA1::steal() };
    let flags = dma.isr().read();
    let (first, second) = (flags.htif1().bit_is_set(), flags.tcif1().bit_is_set());
    dma.ifcr().write(|w| {
        if first {
            w.chtif1().clear();
        }
        if second {
            w.ctcif1().clear();
        }
        w
    });
    let half = match (first, second) {
        (true, false) => 0,
        (false, true) => 1,
        // Both: a whole frame late or more, and the ring may hold any frame. The next one shows by its number how many
        // are lost.
        _ => return,
    };
    *COMPLETE = complete(*COMPLETE, half);
    let number = COMPLETE.wrapping_sub(1);
    // Called in any case, because each frame edge must be seen.
    let now = critical_section::with(pulse::now);
    // If the next frame has begun already, the pulse is not that of this frame. Its first sample may be under way, too.
    if now.since_edge_us >= pulse::last_sample_us(&now.train) {
        // SAFETY: after the start only this handler changes the ADC, and only its injected conversion: one that is over long
        // before the next sample.
        let adc = unsafe { ADC1::steal() };
        let injected = INJECTED.next(&adc);
        // A full queue loses the frame; the gap in the numbers shows it.
        let _ = FRAMES.try_send(CapturedFrame {
            number,
            train: now.train,
            pulse: now.pulse,
            samples: samples(half),
            supply: supply::of_frame(injected.bandgap),
            timing: FrameTiming {
                sampled_us: now.since_edge_us,
                probe: injected.probe,
            },
        });
        pulse::end_frame();
    }
}

/// Frames that are complete now, when `before` were at the last call and the newest is in `half` of the ring: counted by
/// the timer, however many have passed.
fn complete(before: u32, half: usize) -> u32 {
    let counted = timing::frames_triggered();
    // The conversions of a frame's last sample may be under way. Then the count is one ahead of the ring.
    let ahead = u16::from(usize::from(counted) % 2 == half);
    let known = (before % u32::from(timing::FRAMES_COUNTED)) as u16;
    let passed = (counted + timing::FRAMES_COUNTED - ahead - known) % timing::FRAMES_COUNTED;
    before.wrapping_add(u32::from(passed))
}

/// The samples in one half of the ring.
fn samples(half: usize) -> [Counts; SAMPLES_PER_FRAME] {
    // SAFETY: `half` is 0 or 1, and the DMA is in the other half for the next nine samples.
    let raw: RawFrame = unsafe { RING.0.get().cast::<RawFrame>().add(half).read_volatile() };
    raw.map(|conversions| Counts(conversions.iter().sum()))
}

//! The timers: TIM2 for the pulses, TIM3 for the samples, TIM4 to count them.

use servoid_protocol::PulseTrain;
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use stm32f1xx_hal::pac::{TIM2, TIM3, TIM4};
use stm32f1xx_hal::rcc::{BusTimerClock, Enable, Rcc, Reset};

/// Frames after which the count of samples begins anew. An even number, so a frame's number says which half of the
/// memory of the converter it is in.
pub const FRAMES_COUNTED: u16 = 6_000;

/// Samples in so many frames.
const SAMPLES_COUNTED: u16 = FRAMES_COUNTED * SAMPLES_PER_FRAME as u16;

/// The timers, prepared and stopped.
#[must_use]
pub struct Chain {
    tim2: TIM2,
}

/// Prepares the timers: TIM2 makes the pulses, TIM3 waits to be started by it, TIM4 counts its samples.
///
/// Both count microseconds of the same bus clock, and a frame is a whole number of samples, so their
/// phase never changes.
pub fn prepare(tim2: TIM2, tim3: TIM3, tim4: TIM4, rcc: &mut Rcc) -> Chain {
    TIM2::enable(rcc);
    TIM2::reset(rcc);
    TIM3::enable(rcc);
    TIM3::reset(rcc);
    let per_microsecond = TIM2::timer_clock(&rcc.clocks).to_MHz() as u16;
    prepare_pulses(&tim2, per_microsecond - 1);
    prepare_samples(&tim3, per_microsecond - 1);
    TIM4::enable(rcc);
    TIM4::reset(rcc);
    prepare_count(&tim4);
    Chain { tim2 }
}

/// Section 15.4.
fn prepare_pulses(tim2: &TIM2, prescaler: u16) {
    tim2.psc().write(|w| w.psc().set(prescaler));
    tim2.arr()
        .write(|w| w.arr().set(PulseTrain::USUAL.period_us - 1));
    // URS: the UG below is not a frame edge, and must not set the flag of one.
    tim2.cr1().write(|w| w.arpe().set_bit().urs().set_bit());
    // Output while the count is below the compare value; 0 is no pulse (15.3.9). With preload, a
    // value written now applies from the next frame edge on.
    tim2.ccmr1_output()
        .write(|w| w.oc2m().pwm_mode1().oc2pe().set_bit());
    tim2.ccr2().write(|w| w.ccr().set(0));
    tim2.ccer().write(|w| w.cc2e().set_bit());
    // Loads prescaler, period and compare value. Nothing listens to its trigger yet.
    tim2.egr().write(|w| w.ug().set_bit());
    // From here on the trigger output is the counter's enable (15.3.15).
    tim2.cr2().write(|w| w.mms().enable());
}

/// The samples of a train, on the stopped timer. The prescaler begins anew with UG (15.3.1), so the phase to the pulses is
/// the same after every start.
fn prepare_period(tim3: &TIM3, train: &PulseTrain) {
    tim3.arr().write(|w| w.arr().set(train.sample_us() - 1));
    // While the trigger output is the counter's enable, and the counter stands, UG triggers nothing (15.4.2).
    tim3.cr2().write(|w| w.mms().enable());
    tim3.egr().write(|w| w.ug().set_bit());
    let head_start = train.sample_us() - train.first_sample_us();
    tim3.cnt().write(|w| w.cnt().set(head_start));
    tim3.cr2().write(|w| w.mms().update());
}

fn prepare_samples(tim3: &TIM3, prescaler: u16) {
    tim3.psc().write(|w| w.psc().set(prescaler));
    prepare_period(tim3, &PulseTrain::USUAL);
    // ITR1 of TIM3 is TIM2 (table "TIMx internal trigger connection"). The source must be chosen
    // before the mode that listens to it (SMCR, bits TS).
    tim3.smcr().write(|w| w.ts().itr1());
    tim3.smcr().modify(|_, w| w.sms().trigger_mode());
}

/// TIM4 counts the triggers of TIM3 in external clock mode 1 (15.3.12), so frames that the processor misses are counted
/// all the same. ITR2 of TIM4 is TIM3 (table "TIMx internal trigger connection").
fn prepare_count(tim4: &TIM4) {
    tim4.arr().write(|w| w.arr().set(SAMPLES_COUNTED - 1));
    tim4.smcr().write(|w| w.ts().itr2());
    tim4.smcr().modify(|_, w| w.sms().ext_clock_mode());
    tim4.cr1().write(|w| w.cen().set_bit());
}

/// Frames whose samples have all been triggered, modulo [`FRAMES_COUNTED`].
pub fn frames_triggered() -> u16 {
    // SAFETY: nothing uses this timer but to read its count (15.4.10).
    let tim4 = unsafe { TIM4::steal() };
    tim4.cnt().read().cnt().bits() / SAMPLES_PER_FRAME as u16
}

/// Samples that were triggered, modulo what TIM4 counts, and microseconds since the newest one.
fn newest_sample() -> (u16, u16) {
    // SAFETY: nothing but reads of their counts (15.4.10).
    let (tim3, tim4) = unsafe { (TIM3::steal(), TIM4::steal()) };
    let triggered = || tim4.cnt().read().cnt().bits();
    let since_us = || tim3.cnt().read().cnt().bits();
    let (before, since, after) = (triggered(), since_us(), triggered());
    // A sample was triggered in between: then its own time is at its beginning.
    let since = if before == after { since } else { since_us() };
    (after, since)
}

/// Microseconds since some instant, which is another one when the count of samples or the train begins anew.
pub fn instant_us() -> u32 {
    // SAFETY: as above.
    let tim3 = unsafe { TIM3::steal() };
    let sample_us = u32::from(tim3.arr().read().arr().bits()) + 1;
    let (triggered, since_us) = newest_sample();
    u32::from(triggered) * sample_us + u32::from(since_us)
}

/// Microseconds from the edge of the present frame of `train` to now: from the frame's first sample to its newest one by the
/// count of samples, and from there by TIM3. TIM2 alone does not say which pulse of a frame it is.
pub fn since_frame_edge_us(train: &PulseTrain) -> u16 {
    let (triggered, since_us) = newest_sample();
    let samples = SAMPLES_PER_FRAME as u16;
    let newest = (triggered % samples + samples - 1) % samples;
    let in_frame = train.first_sample_us() + newest * train.sample_us() + since_us;
    // Behind the last sample may be the beginning of the next frame.
    in_frame % train.frame_us() as u16
}

/// Stops the timers, and starts them anew with another train. No pulse may be on the line, and the next sample must be some
/// time away: then the memory of the converter, the count of samples and the numbers of frames go on as if the present frame
/// had ended here.
pub fn change(tim2: &TIM2, train: &PulseTrain) {
    // SAFETY: nothing else uses this timer but to read its count.
    let tim3 = unsafe { TIM3::steal() };
    tim2.cr1().modify(|_, w| w.cen().clear_bit());
    tim3.cr1().modify(|_, w| w.cen().clear_bit());
    prepare_period(&tim3, train);
    tim2.arr().write(|w| w.arr().set(train.period_us - 1));
    // Loads the period and begins prescaler and count anew; URS keeps it from setting the flag (15.3.1, 15.4.1).
    tim2.egr().write(|w| w.ug().set_bit());
    tim2.cr1().modify(|_, w| w.cen().set_bit());
}

/// Begins to trigger the ADC by channel 1, at this time after each frame edge from the next one on: the reference of PWM mode 2
/// rises there (15.3.9, 11.7). The channel's pin is no output, so nothing comes out.
pub fn begin_trigger(tim2: &TIM2, at_us: u16) {
    move_trigger(tim2, at_us);
    tim2.ccmr1_output()
        .modify(|_, w| w.oc1m().pwm_mode2().oc1pe().set_bit());
    tim2.ccer().modify(|_, w| w.cc1e().set_bit());
}

/// Moves the trigger; preloaded, so it takes effect at the next frame edge.
pub fn move_trigger(tim2: &TIM2, at_us: u16) {
    tim2.ccr1().write(|w| w.ccr().set(at_us)); // 15.4.13
}

/// Ends the triggers.
pub fn end_trigger(tim2: &TIM2) {
    tim2.ccer().modify(|_, w| w.cc1e().clear_bit());
}

impl Chain {
    /// Starts both timers with one write. Sampling has to be armed before.
    ///
    /// TIM3 follows by a few cycles of the bus clock, some 50 ns, always the same.
    pub fn start(self) {
        self.tim2.cr1().modify(|_, w| w.cen().set_bit());
    }
}

use super::*;
use crate::peripherals::testing::Bench;
use crate::record::Irregularity;

/// Writes, as a program would: 72 MHz from the crystal, PCLK1 halved, ADC divided by six.
const CFGR_72_MHZ: u32 = 7 << 18 | 1 << 16 | 2 << 14 | 4 << 8;

#[test]
fn out_of_reset_the_internal_oscillator_runs() {
    let rcc = Rcc::new(Sources::default());
    // 7.3.1 and 7.3.6: 0x0000 XX83, 0x14.
    assert_eq!(rcc.read(0x00, 0).unwrap() & 0xff, 0x83);
    assert_eq!(rcc.read(0x14, 0), Some(0x14));
    assert_eq!(rcc.clocks().hclk, 7_200);
}

#[test]
fn a_crystal_and_the_pll_make_72_mhz() {
    let (mut rcc, mut bench) = (Rcc::new(Sources::default()), Bench::default());
    let (mut now, start) = (1_000, 1_000);
    rcc.write(0x00, 0x1_0083, &mut bench.at(now));
    while !bit(rcc.read(0x00, now).unwrap(), 17) {
        now += 1_000;
    }
    assert!(now - start >= HSE_STARTUP && now - start < HSE_STARTUP + 1_000);
    rcc.write(0x04, CFGR_72_MHZ, &mut bench.at(now));
    rcc.write(0x00, 0x101_0083, &mut bench.at(now));
    assert!(!bit(rcc.read(0x00, now).unwrap(), 25));
    now += PLL_LOCK;
    assert!(bit(rcc.read(0x00, now).unwrap(), 25));
    rcc.write(0x04, CFGR_72_MHZ | 2, &mut bench.at(now));
    let sws = |rcc: &Rcc| field(rcc.read(0x04, 0).unwrap(), 2, 2);
    assert_eq!((sws(&rcc), rcc.clocks().hclk), (0, 7_200));
    let at = rcc.next_event().unwrap();
    assert!(at > now && rcc.advance(at));
    assert_eq!(sws(&rcc), 2, "SWS follows SW");
    let expected = Clocks {
        hclk: 800,
        pclk1: 1_600,
        pclk2: 800,
        timers: 800,
        adc: 4_800,
    };
    assert_eq!(rcc.clocks(), expected);
    assert_eq!(bench.reported(), []);
}

#[test]
fn without_a_crystal_its_flag_never_comes() {
    let sources = Sources::new(false, true, 0.0, 0);
    let (mut rcc, mut bench) = (Rcc::new(sources), Bench::default());
    rcc.write(0x00, 0x1_0083, &mut bench.at(0));
    assert!(!bit(rcc.read(0x00, TICKS_PER_SECOND).unwrap(), 17));
    // 64 MHz from the internal oscillator: 8 MHz / 2 * 16.
    rcc.write(0x04, 14 << 18 | 4 << 8 | 2 << 14, &mut bench.at(0));
    rcc.write(0x00, 0x100_0083, &mut bench.at(0));
    rcc.write(
        0x04,
        14 << 18 | 4 << 8 | 2 << 14 | 2,
        &mut bench.at(PLL_LOCK),
    );
    rcc.advance(PLL_LOCK);
    let clocks = rcc.clocks();
    assert_eq!((clocks.hclk, clocks.timers, clocks.adc), (900, 900, 5_400));
    assert_eq!(bench.reported(), []);
}

/// 7.2.7.
#[test]
fn the_security_system_falls_back_and_raises_the_nmi() {
    let (mut rcc, mut bench) = (Rcc::new(Sources::default()), Bench::default());
    rcc.write(0x00, 0x1_0083, &mut bench.at(0));
    let now = HSE_STARTUP;
    rcc.write(0x04, CFGR_72_MHZ, &mut bench.at(now));
    rcc.write(0x00, 0x109_0083, &mut bench.at(now));
    rcc.write(0x04, CFGR_72_MHZ | 2, &mut bench.at(now + PLL_LOCK));
    rcc.advance(now + PLL_LOCK + HSE_STARTUP);
    assert!(!rcc.nmi());
    let now = now + 2 * PLL_LOCK;
    rcc.stop_crystal(&mut bench.at(now));
    assert!(rcc.nmi());
    assert_eq!(
        (rcc.clocks().hclk, field(rcc.read(0x04, now).unwrap(), 2, 2)),
        (7_200, 0)
    );
    assert_eq!(
        rcc.read(0x00, now).unwrap() & 0x030b_0000,
        0,
        "PLL, CSS and HSE are off"
    );
    rcc.write(0x08, 1 << 23, &mut bench.at(now));
    assert!(!rcc.nmi());
    assert_eq!(bench.reported(), []);
}

#[test]
fn every_reset_shows_the_pin_and_its_own_flag() {
    let (mut rcc, mut bench) = (Rcc::new(Sources::default()), Bench::default());
    rcc.reset(ResetReason::PowerOn);
    assert_eq!(rcc.read(0x24, 0), Some(0x0c00_0000)); // 7.3.10
    rcc.write(0x24, 1 << 24, &mut bench.at(0));
    assert_eq!(rcc.read(0x24, 0), Some(0));
    rcc.reset(ResetReason::Watchdog);
    assert_eq!(rcc.read(0x24, 0), Some(0x2400_0000));
    // Flags stay until they are cleared, or the supply goes.
    rcc.reset(ResetReason::Software);
    assert_eq!(rcc.read(0x24, 0), Some(0x3400_0000));
    rcc.reset(ResetReason::PowerOn);
    assert_eq!(rcc.read(0x24, 0), Some(0x0c00_0000));
}

#[test]
fn a_reset_bit_resets_when_it_rises() {
    let (mut rcc, mut bench) = (Rcc::new(Sources::default()), Bench::default());
    assert_eq!(
        rcc.write(0x10, 3, &mut bench.at(0)),
        Some((Domain::Apb1, 3))
    );
    assert_eq!(
        rcc.write(0x10, 2, &mut bench.at(0)),
        Some((Domain::Apb1, 0))
    );
}

#[test]
fn what_the_manual_forbids_is_reported() {
    let (mut rcc, mut bench) = (Rcc::new(Sources::default()), Bench::default());
    rcc.write(0x04, 2, &mut bench.at(0));
    assert!(matches!(
        bench.reported()[..],
        [Irregularity::NotModelled(_)]
    ));
    assert_eq!(rcc.clocks().hclk, 7_200, "still on the internal oscillator");
    rcc.write(0x00, 0, &mut bench.at(0));
    assert!(matches!(
        bench.reported()[..],
        [Irregularity::AgainstTheManual(_)]
    ));
    // 72 MHz with PCLK1 undivided.
    rcc.write(0x00, 0x1_0083, &mut bench.at(0));
    let now = HSE_STARTUP;
    rcc.write(0x04, 7 << 18 | 1 << 16, &mut bench.at(now));
    rcc.write(0x00, 0x101_0083, &mut bench.at(now));
    rcc.write(0x04, 7 << 18 | 1 << 16 | 2, &mut bench.at(now + PLL_LOCK));
    assert!(matches!(
        bench.reported()[..],
        [Irregularity::AgainstTheManual(_)]
    ));
}

/// 7.3.2: SWS shows the switch; before that, a second one has no outcome that the manual gives.
#[test]
fn the_system_clock_is_not_switched_twice_at_once() {
    let (mut rcc, mut bench) = (Rcc::new(Sources::default()), Bench::default());
    rcc.write(0x00, 0x1_0083, &mut bench.at(0));
    rcc.write(0x04, 1, &mut bench.at(HSE_STARTUP));
    assert_eq!(bench.reported(), []);
    rcc.write(0x04, 0, &mut bench.at(HSE_STARTUP));
    assert_eq!(bench.reported().len(), 1);
    rcc.advance(2 * HSE_STARTUP);
    rcc.write(0x04, 1, &mut bench.at(2 * HSE_STARTUP));
    assert_eq!(bench.reported(), []);
}

/// DS5319: the internal oscillator is off by -2 to +2.5 %.
#[test]
fn the_internal_oscillator_is_as_inexact_as_it_is() {
    for (error, cycle) in [(-0.02, 7_344), (0.0, 7_200), (0.025, 7_024)] {
        let rcc = Rcc::new(Sources::new(true, true, error, 0));
        assert_eq!(rcc.clocks().hclk, cycle, "{error}");
    }
}

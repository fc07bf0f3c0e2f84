//! The timing chain of timers, ADC and DMA, tick by tick.

use servoid::data::recording::Ending;
use servoid_protocol::hello::{ClockSource, ResetCause};
use servoid_protocol::message::{Command, Request, Start};
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use servoid_protocol::{Frame, framing};
use servoid_test_support::virtual_board::{
    FIRST_SAMPLE, FRAME, OVERSAMPLING, SharedBoard, arm, capture, image, options, staircase,
};
use std::time::Duration;
use virtual_board::BoardOptions;
use virtual_board::memory::{RAM_BYTES, RAM_START};
use virtual_board::record::{Conversion, Pulse, Record};
use virtual_board::time::{Ticks, microseconds, milliseconds};

/// How long a conversion takes: 252 cycles of 12 MHz.
const CONVERSION: Ticks = microseconds(21);
const SAMPLE: Ticks = milliseconds(2);

/// When the first frame began: half a millisecond before the first conversion.
fn beginning(conversions: &[Conversion]) -> Ticks {
    conversions[0].start - FIRST_SAMPLE
}

fn assert_on_the_grid(conversions: &[Conversion]) {
    let start = beginning(conversions);
    for (n, conversion) in conversions.iter().enumerate() {
        let (sample, part) = (n / OVERSAMPLING, n % OVERSAMPLING);
        let expected = start + FIRST_SAMPLE + sample as Ticks * SAMPLE + part as Ticks * CONVERSION;
        assert_eq!(conversion.start, expected, "conversion {n}");
    }
}

/// Every pulse on a frame edge, none left out between the first and the last. Returns the number of
/// the frame that the first one is in.
fn assert_on_the_edges(pulses: &[Pulse], start: Ticks) -> usize {
    let first = (pulses[0].rise - start) / FRAME;
    for (n, pulse) in (first..).zip(pulses) {
        assert_eq!(pulse.rise, start + n * FRAME, "pulse {n}");
    }
    first as usize
}

/// The conversions of the model in frame `number`.
fn samples(conversions: &[Conversion], number: usize) -> Option<[u16; SAMPLES_PER_FRAME]> {
    let per_frame = SAMPLES_PER_FRAME * OVERSAMPLING;
    let frame = conversions.get(number * per_frame..(number + 1) * per_frame)?;
    let mut sums = frame
        .chunks(OVERSAMPLING)
        .map(|sample| sample.iter().map(|c| c.code).sum());
    Some(std::array::from_fn(|_| sums.next().unwrap()))
}

/// The board's number of the run's first frame: the only one with the samples and the pulse of all
/// its frames.
fn find_run(frames: &[Frame], record: &Record, first_pulse: usize) -> usize {
    let conversions = &record.conversions;
    let fits = |start: usize| {
        frames.iter().enumerate().all(|(n, frame)| {
            let number = start + n;
            let pulse = number
                .checked_sub(first_pulse)
                .and_then(|n| record.pulses.get(n));
            samples(conversions, number) == Some(frame.samples.map(|counts| counts.0))
                && pulse.map(|pulse| pulse.width) == Some(microseconds(frame.pulse.0.into()))
        })
    };
    let last = conversions.len() / (SAMPLES_PER_FRAME * OVERSAMPLING);
    let found: Vec<usize> = (0..last).filter(|&start| fits(start)).collect();
    assert_eq!(found.len(), 1, "places that the stream fits: {found:?}");
    found[0]
}

/// However long the processor takes: it is not in the timing path.
#[test]
fn the_staircase_is_on_the_line_and_in_the_stream_to_the_tick() {
    for slow_flash in [false, true] {
        let mut options = options("linear?seed=3", &[]);
        options.slow_flash = slow_flash;
        the_staircase_is_exact(&options);
    }
}

fn the_staircase_is_exact(options: &BoardOptions) {
    let board = SharedBoard::new(options);
    let mut client = board.connect();
    let hello = *client.hello();
    assert_eq!(
        (hello.clock, hello.reset_cause),
        (ClockSource::Crystal, ResetCause::PowerOn)
    );
    let stated = microseconds(hello.first_sample_us.into());
    assert!(stated.abs_diff(FIRST_SAMPLE) < microseconds(1));
    assert_eq!(
        microseconds(hello.aperture_us.into()),
        OVERSAMPLING as Ticks * CONVERSION
    );

    let job = staircase();
    let folder = tempfile::tempdir().unwrap();
    let (end, frames) = capture(&mut client, &job, &folder.path().join("run.csv"));
    let end = end.unwrap();
    assert_eq!(end.ending, Ending::Complete);
    assert_eq!(end.rejects, 0);
    assert_eq!(end.asked_again, 0);
    assert_eq!(frames.len() as u32, job.start.frames());
    assert!(board.with(|board| board.chip().led()), "armed, at neutral");
    client.request(Command::Disarm).unwrap();
    board.pass(Duration::from_millis(40));
    assert!(!board.with(|board| board.chip().led()));
    let status = client.status().unwrap();
    assert_eq!((status.frames_lost_on_board, status.rejects), (0, 0));

    board.with(|board| {
        let chip = board.chip();
        let record = &chip.record;
        let start = beginning(&record.conversions);
        assert_on_the_grid(&record.conversions);
        let first_pulse = assert_on_the_edges(&record.pulses, start);
        // The stream holds what the models saw, frame by frame, and the pulse of just that frame.
        find_run(&frames, record, first_pulse);
        // And that is what was commanded.
        for (index, frame) in frames.iter().enumerate() {
            let offset = job.start.offset_us(index as u32).unwrap();
            assert_eq!(
                Some(frame.pulse),
                servoid_protocol::PulseWidth::NEUTRAL.offset_by(offset)
            );
        }
        for line in &record.log {
            println!("{line}");
        }
    });
    assert_eq!(board.violations(), [""; 0]);
}

/// Prints the figures of the README, and holds them to generous limits.
#[test]
fn load_and_memory() {
    let image = image();
    let (flash, ram) = (image.flash_used, image.ram_used);
    let (least, _) = load(false);
    let (most, memory) = load(true);
    // The stack grows down from the middle; what it never reached has the program's pattern.
    let words: Vec<_> = memory.chunks(4).collect();
    let untouched = words.iter().take_while(|&&word| word == words[0]);
    let stack = RAM_BYTES / 2 - 4 * untouched.count() as u32;
    let percent = |cycles: u64| 100.0 * cycles as f64 / 1_440_000.0;
    println!(
        "processor: {least} to {most} cycles per frame while a run is under way, {:.2} to {:.2} %",
        percent(least),
        percent(most)
    );
    println!("flash {flash} bytes, static memory {ram} bytes, stack {stack} bytes at most");
    assert!(percent(most) < 5.0, "{most}");
    // 3 kB are left for what a path that this run did not take needs beyond it.
    assert!(stack < RAM_BYTES / 2 - 3_072, "stack {stack}");
}

/// Cycles of a frame of a run, and the memory after it.
fn load(slow_flash: bool) -> (u64, Vec<u8>) {
    let mut options = options("bench", &[]);
    options.slow_flash = slow_flash;
    let board = SharedBoard::new(&options);
    let mut client = board.connect();
    let job = staircase();
    job.arm(&mut client).unwrap();
    client.request(Command::Start(job.start)).unwrap();
    let before = board.with(|board| board.awake_cycles());
    let frames = 50u64;
    board.pass(Duration::from_millis(20 * frames));
    board.with(|board| {
        assert!(board.chip().record.violations.is_empty());
        ((board.awake_cycles() - before) / frames, memory_of(board))
    })
}

fn memory_of(board: &mut virtual_board::VirtualBoard) -> Vec<u8> {
    let ram = board.ram();
    assert!(ram.read(RAM_START, 1).is_some());
    ram.snapshot()
}

/// The wiring guide's arithmetic: up to 256 kΩ the ADC settles to a quarter of a step within its sampling time, and
/// what it measured before, the reference voltage, is not seen.
#[test]
fn the_sampling_time_suffices_for_the_source() {
    let first_samples = |source_ohms: f64| {
        let mut options = options("linear?noise=none&seed=1", &[]);
        options.source_ohms = source_ohms;
        let board = SharedBoard::new(&options);
        board.with(|board| {
            let conversions = &board.chip().record.conversions;
            conversions.iter().map(|c| c.code).collect::<Vec<_>>()
        })
    };
    let ideal = first_samples(0.0);
    assert_eq!(first_samples(3_377.0), ideal);
    let worst = |codes: Vec<u16>| {
        let pairs = codes.iter().zip(&ideal);
        pairs.map(|(a, b)| a.abs_diff(*b)).max().unwrap()
    };
    assert!(worst(first_samples(256e3)) <= 1);
    assert!(worst(first_samples(2e6)) > 100, "a model that sees nothing");
}

/// Equal options and equal bytes give equal signals.
#[test]
fn two_boards_alike_do_the_same_to_the_tick() {
    let signals = || {
        let board = SharedBoard::new(&options("aircraft?seed=5", &[]));
        let requests = [
            Command::Hello,
            Command::Arm(arm()),
            Command::Start(Start {
                run: 1,
                ..staircase().start
            }),
        ];
        for (id, command) in (0..).zip(requests) {
            let request = Request {
                session: 1,
                id,
                command,
            };
            let mut wire = [0; framing::MAX_WIRE];
            let wire = framing::encode(&request, &mut wire).unwrap();
            board.with(|board| board.write(wire));
            board.pass(Duration::from_millis(50));
        }
        board.pass(Duration::from_millis(1_500));
        board.with(|board| {
            let chip = board.chip();
            (
                chip.record.pulses.clone(),
                chip.record.conversions.clone(),
                board.awake_cycles(),
            )
        })
    };
    let (first, second) = (signals(), signals());
    assert!(
        first
            .0
            .iter()
            .any(|pulse| pulse.width == microseconds(1_550))
    );
    assert!(first == second);
}

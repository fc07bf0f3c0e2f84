//! Writing the image by the chip's bootloader: `servoid flash`, and stm32flash as a host that knows nothing of us.

use crate::ports::{serving, servoid};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use servoid::instrument::flash::{
    BootLines, FlashError, FlashProgress, Flashed, Hand, Start, State, flash,
};
use servoid::instrument::port::{ControlLine, Port};
use servoid_flash_image::{ERASED, FLASH_START, FlashImage, PAGE_BYTES};
use servoid_test_support::tools::missing;
use servoid_test_support::virtual_board::{SharedBoard, options};
use std::cell::Cell;
use std::io;
use std::process::Command;
use std::time::Duration;
use virtual_board::board::VirtualBoard as Board;
use virtual_board::cpu::Core as _;
use virtual_board::record::ResetReason;
use virtual_board::server::PseudoTerminal;
use virtual_board::time::milliseconds;
use virtual_board::{BoardOptions, Image, VirtualBoard};

/// The image, as a chip gets it.
fn the_image() -> FlashImage {
    let elf = std::fs::read(servoid_firmware_image::build().unwrap()).unwrap();
    FlashImage::from_file(&elf).unwrap()
}

/// A program of a page and a third that stays where it starts, at the place behind its two words.
fn small_image(seed: u64) -> FlashImage {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut bytes: Vec<u8> = (0..PAGE_BYTES + 350).map(|_| random.random()).collect();
    bytes[..4].copy_from_slice(&0x2000_2000u32.to_le_bytes());
    bytes[4..8].copy_from_slice(&(FLASH_START + 9).to_le_bytes());
    // b .
    bytes[8..10].copy_from_slice(&[0xfe, 0xe7]);
    FlashImage::from_file(&bytes).unwrap()
}

fn with_boot0(faults: &[&str]) -> BoardOptions {
    let mut options = options("linear?seed=1", faults);
    options.boot0 = true;
    options.keeps_signals = true;
    options
}

fn erased(options: &BoardOptions) -> SharedBoard {
    VirtualBoard::new(Image::erased(), options).unwrap().into()
}

/// Flashes by a port.
fn flash_by(
    port: &mut dyn Port,
    image: &FlashImage,
    lines: BootLines,
    unlock: bool,
) -> Result<Flashed, FlashError> {
    let mut hand = Hand {
        show: &mut |_| {},
        stop: &|| false,
    };
    flash(port, image, lines, unlock, &mut hand)
}

fn flash_board(board: &SharedBoard, image: &FlashImage) -> Result<Flashed, FlashError> {
    flash_by(&mut board.port(), image, BootLines::default(), false)
}

/// Whether the flash begins with the image.
fn holds(board: &mut Board, image: &FlashImage) -> bool {
    board.chip().flash().starts_with(image.bytes())
}

/// The bootloader leaves its clocks and its vector table behind: the image starts all the same, and does all that it
/// does after a reset.
#[test]
fn the_image_is_written_compared_and_started() {
    let (board, image) = (erased(&with_boot0(&[])), the_image());
    let mut written = Vec::new();
    let mut hand = Hand {
        show: &mut |progress| {
            if let FlashProgress::Written(bytes) = progress {
                written.push(bytes);
            }
        },
        stop: &|| false,
    };
    let port = &mut board.port();
    let done = flash(port, &image, BootLines::default(), false, &mut hand).unwrap();
    assert_eq!(done.start, Start::ByBootloader);
    assert_eq!(done.chip.flash_kib, Some(64));
    assert_eq!(done.written_again, 0);
    assert_eq!(written.last(), Some(&image.bytes().len()));
    assert_eq!(written.len() as u32, image.pages());
    let seconds = board.port().now().as_secs_f64();
    println!("flash: {} bytes in {seconds:.1} s", image.bytes().len());
    // 11 bits a byte, written and read; erased at 40 ms a page; the commands around each block of 256.
    assert!(seconds < 12.0, "{seconds}");
    board.with(|board| assert!(holds(board, &image)));
    board.pass(Duration::from_millis(500));
    assert_eq!(board.violations(), [""; 0]);
    let mut client = board.connect();
    assert!(client.has_equal_schema());
    client.status().unwrap();
    board.with(|board| {
        assert!(!board.chip().in_bootloader());
        assert!(!board.chip().record.conversions.is_empty());
        assert_eq!(board.chip().record.pulses, []);
    });
}

/// A port whose lines are at the board's pins, as those of most adapters: a pin is low while its line is set.
struct Wired(SharedBoard);

impl Port for Wired {
    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> io::Result<usize> {
        self.0.read(buffer, timeout)
    }
    fn write_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.0.write_all(bytes)
    }
    fn now(&self) -> Duration {
        self.0.now()
    }
    fn set_control_line(&mut self, line: ControlLine, set: bool) -> io::Result<()> {
        self.0.with(|board| match line {
            ControlLine::Rts => board.set_boot0(!set),
            ControlLine::Dtr => board.hold_reset(set),
        });
        Ok(())
    }
}

/// The first byte after a reset shows the bit rate: where the line disturbs it, the board is reset again.
#[test]
fn lines_of_the_adapter_set_boot0_and_reset() {
    for faults in [&[][..], &["to-board-flip:0.01", "to-host-drop:0.002"]] {
        let mut options = options("linear?seed=3", faults);
        options.boot0 = false;
        let board = erased(&options);
        let lines = BootLines {
            boot0: Some("!rts".parse().unwrap()),
            reset: Some("dtr".parse().unwrap()),
        };
        let image = small_image(1);
        let done = flash_by(&mut Wired(board.port()), &image, lines, false).unwrap();
        assert_eq!(done.start, Start::ByReset);
        board.pass(Duration::from_millis(1));
        board.with(|board| {
            assert!(holds(board, &image));
            let resets: Vec<_> = board.chip().record.resets.iter().map(|r| r.1).collect();
            assert_eq!(resets.last(), Some(&ResetReason::Pin));
            assert_eq!(board.core().registers().r[15] & !1, FLASH_START + 8);
        });
    }
}

/// What makes a board another one.
type Change = fn(&mut BoardOptions);

#[test]
fn what_is_no_good_board_is_left_as_it_was_and_named() {
    let image = small_image(2);
    let board = |change: Change| {
        let mut options = with_boot0(&[]);
        change(&mut options);
        let held = Image::parse(small_image(1).bytes()).unwrap();
        SharedBoard::from(VirtualBoard::new(held, &options).unwrap())
    };
    let changes: [(Change, &str); 4] = [
        (
            |o| o.product_id = 0x413,
            "STM32F405 or STM32F407 (product id 0x413)",
        ),
        (
            |o| o.flash_kib = 1,
            "needs 2 KiB of flash, and this chip has 1 KiB",
        ),
        (
            |o| o.read_protected = true,
            "'--unlock' removes that, and erases all",
        ),
        (|o| o.boot0 = false, "set the board's BOOT0 to 1"),
    ];
    for (change, expected) in changes {
        let board = board(change);
        let held = board.with(|board| board.chip().flash().to_vec());
        let error = flash_board(&board, &image).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
        board.with(|board| assert!(board.chip().flash() == held));
    }
}

#[test]
fn somebody_may_end_it() {
    let board = erased(&with_boot0(&[]));
    let asked = Cell::new(false);
    let mut hand = Hand {
        show: &mut |progress| asked.set(matches!(progress, FlashProgress::Written(4096..))),
        stop: &|| asked.get(),
    };
    let port = &mut board.port();
    let result = flash(port, &the_image(), BootLines::default(), false, &mut hand);
    assert!(matches!(result, Err(FlashError::Stopped(State::Empty))));
    board.with(|board| assert_eq!(board.chip().flash()[..8], [ERASED; 8]));
}

#[test]
fn a_board_that_falls_silent_is_named() {
    let board = erased(&with_boot0(&["host-silent@1"]));
    let error = flash_board(&board, &the_image()).unwrap_err();
    assert!(
        matches!(error, FlashError::FellSilent(State::Empty)),
        "{error}"
    );
}

#[test]
fn a_protected_chip_is_unlocked_where_that_is_asked_for() {
    let mut options = with_boot0(&[]);
    options.read_protected = true;
    let (board, image) = (erased(&options), small_image(3));
    let done = flash_by(&mut board.port(), &image, BootLines::default(), true).unwrap();
    assert_eq!(done.start, Start::ByBootloader);
    board.with(|board| assert!(holds(board, &image)));
}

/// A port whose cable is pulled after so many bytes to the board.
struct Pulled(SharedBoard, usize);

impl Port for Pulled {
    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> io::Result<usize> {
        match self.1 {
            0 => Err(io::ErrorKind::BrokenPipe.into()),
            _ => self.0.read(buffer, timeout),
        }
    }
    fn write_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        let some = &bytes[..bytes.len().min(self.1)];
        self.1 -= some.len();
        self.0.write_all(some)
    }
    fn now(&self) -> Duration {
        self.0.now()
    }
}

/// Wherever the cable is pulled: what the next reset starts is the old program, the new one, or nothing.
#[test]
fn a_cable_that_is_pulled_half_way_leaves_no_half_program_that_starts() {
    let (old, new) = (small_image(4), small_image(5));
    let mut left = [0; 3];
    let held = || Image::parse(old.bytes()).unwrap();
    for bytes in (0..120).step_by(8).chain((120..2_100).step_by(60)) {
        let board = VirtualBoard::new(held(), &with_boot0(&[])).unwrap();
        let board = SharedBoard::from(board);
        let mut port = Pulled(board.port(), bytes);
        let result = flash_by(&mut port, &new, BootLines::default(), false);
        // What it has begun, it ends.
        board.with(|board| board.run_until(board.now() + milliseconds(100)));
        board.with(|board| {
            let head = board.chip().flash()[..8] == [ERASED; 8];
            let kind = match (holds(board, &old), holds(board, &new)) {
                (true, _) => 0,
                (_, true) => 1,
                _ => 2,
            };
            left[kind] += 1;
            assert!(kind < 2 || head, "after {bytes} bytes: {result:?}");
            if let Err(FlashError::Broken(State::Untouched, _)) = result {
                // Before an erasure has been acknowledged it may have happened.
                assert!(kind != 1, "after {bytes} bytes");
            }
        });
    }
    println!("flash: cable pulled: {left:?} old, new, none");
    assert!(left.iter().all(|count| *count > 0), "{left:?}");
}

/// What became of a run.
#[derive(Debug, Default)]
struct Outcomes {
    started: u32,
    ended_with_a_sentence: u32,
    written_again: u32,
    longest_s: f64,
}

/// So many runs over lines that disturb each byte, in both directions: up to one in two hundred flipped, lost and inserted
/// each, and one in eight hundred late by up to half a second. No run may start anything but the whole program, or end
/// without a word.
fn runs_over_bad_lines(count: u32) {
    let mut outcomes = Outcomes::default();
    for seed in 0..count {
        let rate = [0.0, 2e-4, 5e-4, 1e-3, 5e-3][seed as usize % 5];
        run_over_bad_line(seed.into(), rate, &mut outcomes);
    }
    println!("flash: {outcomes:?}");
    assert_eq!(outcomes.started + outcomes.ended_with_a_sentence, count);
    // A bootloader whose first byte was disturbed hears nothing any more: somebody has to press reset.
    assert!(outcomes.started > count * 19 / 20, "{outcomes:?}");
    assert!(outcomes.written_again > 0, "{outcomes:?}");
}

#[test]
fn runs_over_bad_lines_start_nothing_wrong_and_all_end() {
    runs_over_bad_lines(100);
}

#[test]
#[ignore = "a quarter of a minute: cargo test -p virtual-board --test integration -- --ignored --nocapture a_thousand_runs"]
fn a_thousand_runs_over_bad_lines() {
    runs_over_bad_lines(1_000);
}

fn run_over_bad_line(seed: u64, rate: f64, outcomes: &mut Outcomes) {
    let faults = [
        format!("flip:{rate}"),
        format!("drop:{rate}"),
        format!("inject:{rate}"),
        format!("late:{}", rate / 4.0),
    ];
    let faults: Vec<&str> = faults.iter().map(String::as_str).collect();
    let mut options = with_boot0(&faults);
    options.simulation.seed = seed;
    let board = erased(&options);
    let image = small_image(seed);
    let begin = board.port().now();
    let result = flash_board(&board, &image);
    let seconds = (board.port().now() - begin).as_secs_f64();
    outcomes.longest_s = outcomes.longest_s.max(seconds);
    assert!(seconds < 600.0, "{seed}: {seconds} s");
    board.pass(Duration::from_millis(5));
    board.with(|board| {
        let started = !board.chip().in_bootloader();
        let whole = holds(board, &image);
        let head_is_erased = board.chip().flash()[..8] == [ERASED; 8];
        assert!(
            whole || head_is_erased,
            "{seed}: half a program would start"
        );
        if started {
            assert!(whole, "{seed}: started half a program");
            let at = board.core().registers().r[15] & !1;
            assert_eq!(at, FLASH_START + 8, "{seed}: started elsewhere");
        }
        match result {
            Ok(done) => {
                assert!(started, "{seed}: {done:?}");
                outcomes.started += 1;
                outcomes.written_again += done.written_again;
            }
            Err(error) => {
                assert!(error.to_string().len() > 40, "{seed}: {error}");
                outcomes.ended_with_a_sentence += 1;
            }
        }
    });
}

/// stm32flash writes, compares and starts the image. Over a pseudo-terminal there is no parity, hence 8n1.
#[cfg(unix)]
#[test]
fn stm32flash_writes_compares_and_starts_the_image() {
    const TEST: &str = "stm32flash on the bootloader's model";
    if Command::new("stm32flash").arg("-h").output().is_err() {
        return missing(TEST, "there is no stm32flash");
    }
    let folder = tempfile::tempdir().unwrap();
    let (file, image) = (folder.path().join("image.bin"), the_image());
    std::fs::write(&file, image.bytes()).unwrap();
    let terminal = PseudoTerminal::open().unwrap();
    let port = terminal.path().display().to_string();
    let mut board = VirtualBoard::new(Image::erased(), &with_boot0(&[])).unwrap();
    // It hears nothing before its supply is up.
    board.run_until(milliseconds(10));
    let mut board = serving(board, terminal, || {
        let output = Command::new("timeout")
            .args(["28", "stm32flash", "-m", "8n1", "-b", "115200", "-f", "-w"])
            .arg(&file)
            .args(["-v", "-g", "0x0", &port])
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{said}{errors}");
        assert!(said.contains("STM32F10xxx Medium-density"), "{said}");
        assert!(said.contains("Wrote and verified"), "{said}");
        let shown = servoid(&format!("info --port {port}")).unwrap();
        assert!(shown.contains("STM32F103C8"), "{shown}");
    });
    assert!(holds(&mut board, &image));
    board.run_until(board.now() + milliseconds(100));
    assert_eq!(board.chip().record.violations, []);
}

/// The command, over the host's own serial port.
#[cfg(unix)]
#[test]
fn the_command_flashes_a_board_at_a_serial_port() {
    let folder = tempfile::tempdir().unwrap();
    let (file, image) = (folder.path().join("image.bin"), the_image());
    std::fs::write(&file, image.bytes()).unwrap();
    let terminal = PseudoTerminal::open().unwrap();
    let port = terminal.path().display().to_string();
    let options = with_boot0(&["to-host-drop:0.0001", "to-board-flip:0.0001"]);
    let board = VirtualBoard::new(Image::erased(), &options).unwrap();
    let mut board = serving(board, terminal, || {
        let line = format!("flash --port {port} --image {} --quiet", file.display());
        let said = servoid(&line).unwrap();
        assert!(said.contains(&image.sha256()), "{said}");
        assert!(said.contains("started   by the bootloader"), "{said}");
        assert!(said.contains("set its jumper back to 0"), "{said}");
    });
    assert!(holds(&mut board, &image));
}

//! The virtual board as a serial port.

use anyhow::{Context, Result, bail};
use clap::Parser;
use servoid_simulator::{LineSpeed, SimulationOptions};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use virtual_board::server::{HostEnd, Pace, TcpServer, serve};
use virtual_board::{BoardOptions, Fault, Image, LoopWire, VirtualBoard};

/// A virtual STM32F103 with a simulated servo, which runs the flash image
///
/// Prints the name of its port and runs until Ctrl-C. The log of the image, and operations that a real chip does not
/// allow, go to standard error.
#[derive(Debug, Parser)]
#[command(
    version,
    after_help = "Example:
  cargo fw
  virtual-board --servo aircraft --seed 7 --tcp 127.0.0.1:5000
  servoid capture --port tcp:127.0.0.1:5000 -o aircraft.csv"
)]
struct Cli {
    /// Servo on its pins: bench, aircraft or linear, with options as after sim: (bench?noise=none)
    #[arg(long, default_value = "bench")]
    servo: SimulationOptions,
    /// Seed of the noise
    #[arg(long)]
    seed: Option<u64>,
    /// The image to run; without it, the one that 'cargo fw' has built
    #[arg(long, value_name = "FILE", conflicts_with = "erased")]
    elf: Option<PathBuf>,
    /// Begin without a program in the flash
    #[arg(long)]
    erased: bool,
    /// Hold BOOT0 high, so that a reset starts the chip's bootloader: for 'servoid flash', or stm32flash -m 8n1
    #[arg(long)]
    boot0: bool,
    /// Protect the flash against reading it out
    #[arg(long)]
    read_protected: bool,
    /// What the bootloader says that the chip is, such as 0x413
    #[arg(long, value_name = "ID", value_parser = product_id)]
    product_id: Option<u16>,
    /// Run in real time; without it, up to twice as fast
    #[arg(long)]
    realtime: bool,
    /// Fault to inject: no-crystal, no-pll, crystal-stops@S, sensor-open@S, sensor-short@S, host-silent@S, cpu-stuck@S,
    /// brown-out@S, supply-sags@S, reset-pin@S, hard-fault@S, stray-interrupt@S, debugger-halts@S (S in seconds), flip:P,
    /// drop:P, inject:P, late:P (P for each byte; with to-board- or to-host- before it, in one direction). May be given several
    /// times
    #[arg(long, value_name = "FAULT")]
    fault: Vec<Fault>,
    /// Wire of the self-test from PA1 to PA4, in the sensor's place: divider, straight, open or 3v3, and behind commas noise=MV,
    /// capacitor=NF, falls-late=US
    #[arg(long, value_name = "WIRE")]
    loopback: Option<LoopWire>,
    /// Listen at this network address instead of a pseudo-terminal
    #[arg(long, value_name = "HOST:PORT")]
    tcp: Option<String>,
}

fn main() -> Result<()> {
    let cli = Cli::parse();
    let mut options = BoardOptions::new(simulation(&cli)?);
    let image = match cli.erased {
        true => Image::erased(),
        false => Image::read(&find_image(cli.elf.as_deref())?)?,
    };
    options.faults.clone_from(&cli.fault);
    options.keeps_signals = false;
    options.loop_wire.clone_from(&cli.loopback);
    options.boot0 = cli.boot0;
    options.read_protected = cli.read_protected;
    options.product_id = cli.product_id.unwrap_or(options.product_id);
    let mut board = VirtualBoard::new(image, &options)?;

    let stop = Arc::new(AtomicBool::new(false));
    let handler = stop.clone();
    ctrlc::set_handler(move || handler.store(true, Ordering::Relaxed))?;
    let bootloader = cli.boot0;
    let mut end = open(cli.tcp.as_deref(), bootloader)?;
    let pace = if cli.realtime || options.simulation.realtime {
        Pace::REAL_TIME
    } else {
        Pace::FASTEST
    };
    let should_stop = || stop.load(Ordering::Relaxed);
    serve(&mut board, end.as_mut(), pace, &should_stop, &mut report).context("the port is gone")
}

fn product_id(text: &str) -> Result<u16, String> {
    let digits = text.strip_prefix("0x");
    let id = digits.and_then(|digits| u16::from_str_radix(digits, 16).ok());
    id.ok_or_else(|| "it must be a hexadecimal number such as 0x410".to_owned())
}

fn simulation(cli: &Cli) -> Result<SimulationOptions> {
    let mut simulation = cli.servo.clone();
    let usual = SimulationOptions::new(simulation.servo);
    if simulation.line != LineSpeed::Baud(115_200)
        || simulation.first_sample_us != usual.first_sample_us
    {
        bail!(
            "leave out baud and first-sample-us: the image itself sets the baud rate and the sample times"
        );
    }
    simulation.seed = cli.seed.unwrap_or(simulation.seed);
    Ok(simulation)
}

/// Where `cargo fw` leaves the image, beside this program or below the working directory.
fn find_image(named: Option<&Path>) -> Result<PathBuf> {
    const IMAGE: &str = "thumbv7m-none-eabi/firmware/servoid-firmware";
    if let Some(path) = named {
        return Ok(path.into());
    }
    let program = std::env::current_exe().ok();
    // target/release/virtual-board
    let beside = program.and_then(|program| Some(program.ancestors().nth(2)?.join(IMAGE)));
    let configured =
        std::env::var_os("CARGO_TARGET_DIR").map(|target| Path::new(&target).join(IMAGE));
    let candidates = [configured, beside, Some(Path::new("target").join(IMAGE))];
    let found = candidates.into_iter().flatten().find(|path| path.is_file());
    match found {
        Some(path) => Ok(path),
        None => no_image(),
    }
}

/// Ends the program with what gives the board a program. An error would have a backtrace, and its user has made no mistake.
fn no_image() -> ! {
    eprintln!(
        "error: this board has no program: no image was found\n  'cargo fw' in the sources of servoid builds it, and --elf FILE names one;\n  or start the board with --erased --boot0, and write the program that servoid has in it: servoid flash --port PORT"
    );
    std::process::exit(1)
}

fn open(tcp: Option<&str>, bootloader: bool) -> Result<Box<dyn HostEnd>> {
    if let Some(address) = tcp {
        let server = TcpServer::listen(address).with_context(|| {
            format!("cannot listen at {address}: write HOST:PORT, with a free port")
        })?;
        announce(&format!("tcp:{}", server.address()?), bootloader);
        return Ok(Box::new(server));
    }
    pseudo_terminal(bootloader)
}

#[cfg(unix)]
fn pseudo_terminal(bootloader: bool) -> Result<Box<dyn HostEnd>> {
    let terminal = virtual_board::server::PseudoTerminal::open()
        .context("no pseudo-terminal can be opened: use --tcp 127.0.0.1:5000")?;
    announce(&terminal.path().display().to_string(), bootloader);
    Ok(Box::new(terminal))
}

#[cfg(not(unix))]
fn pseudo_terminal(_bootloader: bool) -> Result<Box<dyn HostEnd>> {
    bail!("this system has no pseudo-terminals: use --tcp 127.0.0.1:5000")
}

/// The port goes to standard output alone, for scripts; beside it, what can be typed next.
fn announce(port: &str, bootloader: bool) {
    println!("{port}");
    match bootloader {
        true => eprintln!(
            "servoid flash --port {port}\n  writes the program and starts it, by which the board leaves its bootloader; it has no reset button: start it again without --boot0 and --erased, and the program runs at once"
        ),
        false => eprintln!(
            "servoid init --yes --port {port} --sensor-delay 0 --sensor-delay-uncertainty 0\n  writes a rig file of this board: its simulated sensor does not lag, as a real one does\nservoid capture --port {port} -o recording.csv"
        ),
    }
}

/// Prints new log lines and irregularities, and drops them.
fn report(board: &mut VirtualBoard) {
    let record = &mut board.chip().record;
    for line in record.log.drain(..) {
        eprintln!("{line}");
    }
    for violation in record.violations.drain(..) {
        eprintln!("{violation}");
    }
}

//! `servoid flash`

use super::completion_values;
use super::ctrl_c;
use super::info::explain;
use super::output::Talk;
use super::rig_args::RigFileArgs;
use crate::data::input_file;
use crate::instrument::flash::{
    BootLines, FlashError, FlashProgress, Flashed, Hand, Start, Switch, embedded_image, flash,
};
use crate::instrument::port::{self, Port};
use crate::instrument::rig::{Mismatch, RigClient, mismatches};
use anyhow::{Context, Result, bail};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;
use servoid_flash_image::FlashImage;
use std::path::PathBuf;

/// Write the firmware into a board, over the wires of the rig
#[derive(Debug, Args)]
#[command(
    after_help = "Unplug the servo: its signal line is not driven meanwhile. Set the board's jumper BOOT0 to 1, press \
its reset, and start: the chip's own bootloader does it. Afterwards set BOOT0 back to 0, or the next \
reset starts the bootloader again.

Where lines of the adapter are at BOOT0 and reset, --boot0 and --reset name them, and no hand is needed.

Examples:
  servoid flash                                                  the port of rig.toml
  servoid flash --port /dev/ttyUSB0
  servoid flash --port /dev/ttyUSB0 --boot0 '!rts' --reset dtr
  servoid flash --dry-run                                        the image inside, with its SHA-256"
)]
pub(super) struct Flash {
    /// Port of the board: a serial device, or tcp:HOST:PORT (with even parity behind it); without it, that of the rig file
    #[arg(long, short, value_parser = completion_values::port(), hide_possible_values = true)]
    port: Option<String>,
    #[command(flatten)]
    rig: RigFileArgs,
    /// Image to write, an ELF file or the bytes of the flash; without it, the one inside this program
    #[arg(long, value_name = "FILE")]
    image: Option<PathBuf>,
    /// Line by which BOOT0 is high while it is set: rts or dtr; '!rts' or '!dtr': while it is cleared
    #[arg(long, value_name = "LINE")]
    boot0: Option<Switch>,
    /// Line by which the board is held in reset while it is set, or with '!' while it is cleared
    #[arg(long, value_name = "LINE")]
    reset: Option<Switch>,
    /// Remove the read protection of a chip, which erases all that it holds
    #[arg(long)]
    unlock: bool,
    /// Only show the image and its SHA-256
    #[arg(long)]
    dry_run: bool,
    #[command(flatten)]
    talk: Talk,
}

/// The image that is written.
#[derive(Serialize)]
struct ImageFacts {
    bytes: usize,
    sha256: String,
}

#[derive(Serialize)]
struct Done<'a> {
    image: &'a ImageFacts,
    seconds: f64,
    #[serde(flatten)]
    flashed: Flashed,
    /// The build that answers, if it does.
    firmware: Option<&'a str>,
    mismatches: &'a [Mismatch],
}

impl Flash {
    pub(super) fn run(self) -> Result<String> {
        let image = self.image()?;
        let facts = ImageFacts {
            bytes: image.bytes().len(),
            sha256: image.sha256(),
        };
        if self.dry_run {
            return self.talk.result(describe_image(&facts), &facts);
        }
        let address = self.rig.address(self.port.as_deref(), self.talk)?;
        self.write(&address, &image, &facts)
    }

    fn image(&self) -> Result<FlashImage> {
        let Some(file) = &self.image else {
            return embedded_image().context(
                "this program was built without an image: 'cargo fw' builds one and the next build of servoid has it inside, or name one by --image FILE",
            );
        };
        let content = input_file::read(file);
        let content = content.with_context(|| format!("{file:?} cannot be read"))?;
        let image = FlashImage::from_file(&content);
        let image = image.with_context(|| format!("{file:?} cannot be written"))?;
        if !image.is_rigs() {
            bail!(
                "{file:?} is a program for such a chip, but not the firmware of a rig, which names its board: build that with 'cargo fw', and write other programs with another tool"
            );
        }
        Ok(image)
    }

    fn write(&self, address: &str, image: &FlashImage, facts: &ImageFacts) -> Result<String> {
        if port::is_simulated(address) {
            bail!("{address} is a simulated rig and has no flash: name the port of a board");
        }
        ctrl_c::listen()?;
        let mut port = port::open(address)?;
        let begin = port.now();
        let lines = BootLines {
            boot0: self.boot0,
            reset: self.reset,
        };
        let mut shown = Shown::new(self.talk, self.reset.is_some(), facts.bytes);
        let result = flash(
            port.as_mut(),
            image,
            lines,
            self.unlock,
            &mut Hand {
                show: &mut |progress| shown.show(progress),
                stop: &ctrl_c::asked,
            },
        );
        shown.finish();
        let flashed = match result {
            Err(FlashError::NoAnswer) => return Err(no_answer(port, address)),
            other => other?,
        };
        let seconds = (port.now() - begin).as_secs_f64();
        let rig = RigClient::connect(port, address);
        let rig = rig.context(
            "the program is written and compared, but does not answer: set BOOT0 to 0 and press reset, then 'servoid info' shows it, unless the image is not servoid's",
        )?;
        let mismatches = mismatches(rig.hello());
        let done = Done {
            image: facts,
            seconds,
            flashed,
            firmware: Some(rig.hello().build.as_str()),
            mismatches: &mismatches,
        };
        let mut text = describe(&done);
        if self.boot0.is_none() {
            text += "BOOT0 is still at 1: set its jumper back to 0 now, or the next reset starts the bootloader\n";
        }
        text += &self
            .talk
            .next(format_args!("servoid info --port {address}"));
        self.talk.result(text, &done)
    }
}

/// Why no bootloader answers: perhaps the program does.
fn no_answer(mut port: Box<dyn Port>, address: &str) -> anyhow::Error {
    let bootloader_is_silent = FlashError::NoAnswer.into();
    if port.set_even_parity(false).is_err() {
        return bootloader_is_silent;
    }
    match RigClient::probe(port, address) {
        Ok(rig) => anyhow::anyhow!(
            "the board runs its program ({}), not its bootloader: set its BOOT0 to 1, press reset, and start again",
            rig.hello().build.as_str()
        ),
        Err(_) => bootloader_is_silent,
    }
}

fn describe_image(facts: &ImageFacts) -> String {
    let ImageFacts { bytes, sha256 } = facts;
    format!("image     {bytes} bytes of flash\nSHA-256   {sha256}\n")
}

fn describe(done: &Done<'_>) -> String {
    let Flashed {
        chip,
        written_again,
        start,
    } = done.flashed;
    let (major, minor) = (chip.bootloader >> 4, chip.bootloader & 0xf);
    let flash = chip.flash_kib;
    let flash = flash.map_or("of unknown size".to_owned(), |kib| format!("{kib} KiB"));
    let start = match start {
        Start::ByBootloader | Start::Unconfirmed => "by the bootloader",
        Start::ByReset => "by a reset",
    };
    let again = match written_again {
        0 => String::new(),
        times => format!("; {times} times a page had to be written again: the line is bad"),
    };
    let stale = explain(done.mismatches);
    format!(
        "chip      product id {:#05x}, bootloader {major}.{minor}, flash {flash}\n{}written   and compared in {:.1} s{again}\nstarted   {start}: firmware {}\n{stale}",
        chip.product_id,
        describe_image(done.image),
        done.seconds,
        done.firmware.unwrap_or_default(),
    )
}

/// What a person sees meanwhile.
struct Shown {
    talk: Talk,
    /// Nobody has to press reset.
    resets: bool,
    waits: bool,
    bar: ProgressBar,
}

impl Shown {
    fn new(talk: Talk, resets: bool, bytes: usize) -> Self {
        let bar = match talk.quiet {
            true => ProgressBar::hidden(),
            false => ProgressBar::new(bytes as u64),
        };
        let template = "{bar:30} {bytes} of {total_bytes} written and compared, {eta} left";
        // Should the library ever refuse the template, its own style would do.
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        Self {
            talk,
            resets,
            waits: false,
            bar,
        }
    }

    fn show(&mut self, progress: FlashProgress) {
        match progress {
            FlashProgress::Waiting if !self.waits && !self.resets => {
                self.waits = true;
                self.say("no bootloader answers yet: set BOOT0 to 1 and press the board's reset");
            }
            FlashProgress::Waiting => {}
            FlashProgress::Found(_) => self.bar.tick(),
            FlashProgress::Unlocking => self.say("removing the read protection"),
            FlashProgress::Written(bytes) => self.bar.set_position(bytes as u64),
            FlashProgress::Starting => self.finish(),
        }
    }

    fn say(&self, remark: &str) {
        self.bar.suspend(|| self.talk.say(remark));
    }

    fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

//! Builds the flash image for tests.
//!
//! As `cargo fw`, but into a target directory of its own: the cargo that runs the tests may hold the lock of the
//! usual one. Where the variable `SERVOID_IMAGE` names an ELF file, that is the image: continuous integration tests the very
//! file that everybody gets, and does not build a second one.

use std::env;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::sync::OnceLock;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// A clean build takes about a minute on two cores; one that takes ten hangs.
const LONGEST_BUILD: Duration = Duration::from_secs(600);

/// Time between two checks whether the build is done.
const POLL: Duration = Duration::from_millis(50);

/// Builds the image, once in each process, and returns the path of its ELF file. Fast when it is up to date. Nothing is
/// built where the variable `SERVOID_IMAGE` has the path.
///
/// # Errors
/// The output of cargo, where the build fails or takes more than ten minutes.
pub fn build() -> Result<PathBuf, String> {
    static BUILT: OnceLock<Result<PathBuf, String>> = OnceLock::new();
    BUILT
        .get_or_init(|| env::var_os("SERVOID_IMAGE").map_or_else(build_now, |path| Ok(path.into())))
        .clone()
}

fn build_now() -> Result<PathBuf, String> {
    let root = workspace_root()?;
    let target = target_dir(&root);
    let log = target.join(format!("build-{}.log", std::process::id()));
    let built = run(&root, &target, &log);
    let said = fs::read_to_string(&log).unwrap_or_default();
    // A log that stays harms nothing.
    let _ = fs::remove_file(&log);
    match built {
        Ok(Some(status)) if status.success() => {
            Ok(target.join("thumbv7m-none-eabi/firmware/servoid-firmware"))
        }
        Ok(Some(status)) => Err(format!(
            "the image cannot be built ({status}); is the target there? \
             (rustup target add thumbv7m-none-eabi)\n{said}"
        )),
        Ok(None) => Err(format!(
            "building the image takes longer than {} s\n{said}",
            LONGEST_BUILD.as_secs()
        )),
        Err(error) => Err(format!("cannot run cargo: {error}")),
    }
}

fn workspace_root() -> Result<PathBuf, String> {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.ancestors()
        .nth(2)
        .map(Path::to_path_buf)
        .ok_or_else(|| format!("no workspace above {}", here.display()))
}

fn target_dir(root: &Path) -> PathBuf {
    let usual = env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into());
    root.join(usual).join("image")
}

/// Runs cargo; `None` where it had to be stopped.
fn run(root: &Path, target: &Path, log: &Path) -> io::Result<Option<ExitStatus>> {
    fs::create_dir_all(target)?;
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut child = Command::new(cargo)
        .current_dir(root)
        .arg("fw")
        .arg("--target-dir")
        .arg(target)
        // Flags for the host, such as its processor or coverage, are wrong for the board.
        .env_remove("RUSTFLAGS")
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(File::create(log)?)
        .spawn()?;
    let deadline = Instant::now() + LONGEST_BUILD;
    while Instant::now() < deadline {
        if let Some(status) = child.try_wait()? {
            return Ok(Some(status));
        }
        sleep(POLL);
    }
    child.kill()?;
    child.wait()?;
    Ok(None)
}

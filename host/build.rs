//! Puts the image for the board into the program, where it has been built before: `servoid flash` writes it.
//!
//! It is the file that the variable `SERVOID_IMAGE` names, or else the one that `cargo fw` leaves in the target folder. The
//! image is not built here: a build of the program needs neither the board's target nor a second cargo.

use servoid_flash_image::FlashImage;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;
use std::{env, fs, io};

const VARIABLE: &str = "SERVOID_IMAGE";
/// Where `cargo fw` leaves it, in the target folder.
const FOLDER: &str = "thumbv7m-none-eabi/firmware";
const NAME: &str = "servoid-firmware";

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-env-changed={VARIABLE}");
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets it"));
    let named = env::var_os(VARIABLE).map(PathBuf::from);
    let bytes = match &named {
        Some(file) => read(file).unwrap_or_else(|error| panic!("{VARIABLE}: {error}")),
        None => target_folder(&out).map_or_else(Vec::new, |target| built(&target)),
    };
    fs::write(out.join("image.bin"), bytes).expect("the folder of the build can be written");
}

/// Above `[TRIPLE/]PROFILE/build/servoid-HASH/out`.
fn target_folder(out: &Path) -> Option<PathBuf> {
    let above = out.ancestors().nth(4)?;
    let triple = env::var_os("TARGET").is_some_and(|triple| above.file_name() == Some(&triple));
    Some(if triple { above.parent()? } else { above }.to_path_buf())
}

/// The image in the target folder; nothing where there is none, or no good one.
fn built(target: &Path) -> Vec<u8> {
    let folder = target.join(FOLDER);
    let file = folder.join(NAME);
    if !file.is_file() {
        // A file that is not there counts as changed, always. The folder changes when the image comes.
        if folder.is_dir() || make_old(&folder).is_ok() {
            println!("cargo:rerun-if-changed={}", folder.display());
        }
        return Vec::new();
    }
    println!("cargo:rerun-if-changed={}", file.display());
    read(&file).unwrap_or_else(|error| {
        println!("cargo:warning=the program has no image inside: {error}");
        Vec::new()
    })
}

/// Makes a folder that has not changed since this build began, as cargo sees it: or the next build would run this again.
fn make_old(folder: &Path) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    // Where a system does not do this for folders, the next build takes longer once.
    let _not_everywhere = File::open(folder).and_then(|it| it.set_modified(UNIX_EPOCH));
    Ok(())
}

fn read(file: &Path) -> Result<Vec<u8>, String> {
    let content = fs::read(file).map_err(|e| format!("{}: {e}", file.display()))?;
    let image = FlashImage::from_file(&content);
    let image = image.map_err(|e| format!("{}: {e}", file.display()))?;
    Ok(image.bytes().to_vec())
}

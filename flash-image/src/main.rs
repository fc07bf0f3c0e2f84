//! Prints the SHA-256 of what a chip gets of an image, as `servoid flash --dry-run` does for the image inside it.

use servoid_flash_image::FlashImage;
use std::process::ExitCode;

fn main() -> ExitCode {
    let Some(path) = std::env::args_os().nth(1) else {
        eprintln!("name the file of an image");
        return ExitCode::from(2);
    };
    let read = std::fs::read(&path).map_err(|e| e.to_string());
    match read.and_then(|file| FlashImage::from_file(&file).map_err(|e| e.to_string())) {
        Ok(image) => {
            println!("{}  {} bytes of flash", image.sha256(), image.bytes().len());
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{}: {error}", path.display());
            ExitCode::FAILURE
        }
    }
}

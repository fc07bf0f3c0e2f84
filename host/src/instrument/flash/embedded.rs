//! The image inside this program.

use servoid_flash_image::FlashImage;

/// What the build found; empty where it found none (`build.rs`).
const BYTES: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/image.bin"));

/// The image that was there when this program was built.
#[must_use]
pub fn embedded_image() -> Option<FlashImage> {
    FlashImage::from_file(BYTES).ok()
}

//! Tells the linker how the image lies in memory.
//!
//! Here and not in rustflags, because an environment variable `RUSTFLAGS` would replace those
//! without a word, and the link would succeed with an empty image.

use std::env;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=../memory.x");
    // The library's own builds for the host have no linker script.
    let bare = env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "none");
    if bare && env::var_os("CARGO_FEATURE_STM32F103").is_some() {
        // No page alignment: sections lie where the script says, and nothing but them is flashed.
        println!("cargo:rustc-link-arg-bins=--nmagic");
        println!("cargo:rustc-link-arg-bins=-Tlink.x");
        println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
    }
}

//! Passes the memory layout to the linker.
//!
//! Not in rustflags: an environment variable `RUSTFLAGS` would silently replace them, and the link would succeed
//! with an empty image.

use std::env;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=../memory.x");
    // Builds of the library for the host need no linker script.
    let bare = env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "none");
    if bare && env::var_os("CARGO_FEATURE_STM32F103").is_some() {
        // No page alignment: only the sections are flashed, at the addresses of the script.
        println!("cargo:rustc-link-arg-bins=--nmagic");
        println!("cargo:rustc-link-arg-bins=-Tlink.x");
        println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
    }
}

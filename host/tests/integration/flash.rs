//! `servoid flash` without a board: the image, and what is refused before anything is written. With one, the virtual
//! board's tests do it.

use crate::support::{arg, refusal, run};

/// A stack, a start, and nothing else.
const SMALLEST: [u8; 8] = [0, 0x50, 0, 0x20, 9, 0, 0, 8];

#[test]
fn a_dry_run_shows_the_image_and_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("image.bin");
    std::fs::write(&file, SMALLEST).unwrap();
    let text = run(&["flash", "--dry-run", "--image", arg(&file)]);
    assert!(text.contains("8 bytes of flash"), "{text}");
    let json = run(&["flash", "--dry-run", "--json", "--image", arg(&file)]);
    let facts: serde_json::Value = serde_json::from_str(&json).unwrap();
    // That of sha256sum for these eight bytes.
    assert_eq!(
        facts["sha256"],
        "fc2a456909271a53258a25474c80071f7ab848cc2c84def574b99d1551346489"
    );
}

/// A program that was built before the image says how to get one; built after it, it has it.
#[test]
fn the_image_inside_is_whole_or_its_lack_is_named() {
    match servoid::instrument::flash::embedded_image() {
        Some(image) => {
            let text = run(&["flash", "--dry-run"]);
            assert!(text.contains(&image.sha256()), "{text}");
        }
        None => {
            let error = refusal(&["flash", "--dry-run"]);
            assert!(error.contains("'cargo fw' builds one"), "{error}");
        }
    }
}

#[test]
fn what_cannot_be_flashed_is_said_in_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let (good, text) = (folder.path().join("good.bin"), folder.path().join("text"));
    std::fs::write(&good, SMALLEST).unwrap();
    std::fs::write(&text, "no program").unwrap();
    let nowhere = folder.path().join("nowhere");
    for (port, image, expected) in [
        ("sim:bench", &good, "is a simulated rig and has no flash"),
        ("nowhere", &good, "there is no port"),
        ("nowhere", &text, "no image for an STM32F103C8"),
        ("nowhere", &nowhere, "nowhere"),
    ] {
        let error = refusal(&["flash", "--port", port, "--image", arg(image)]);
        assert!(error.contains(expected), "{error}");
    }
    let error = refusal(&["flash", "--port", "nowhere", "--boot0", "cts"]);
    assert!(error.contains("it must be rts or dtr"), "{error}");
}

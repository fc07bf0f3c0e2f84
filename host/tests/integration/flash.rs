//! `servoid flash` without a board: the image, and what is refused before anything is written. With one, the virtual
//! board's tests do it.

use crate::support::{arg, refusal, run};

/// A stack, a start, and the name of the board.
const SMALLEST: &[u8; 19] = b"\x00\x50\x00\x20\x09\x00\x00\x08STM32F103C8";

#[test]
fn a_dry_run_shows_the_image_and_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("image.bin");
    std::fs::write(&file, SMALLEST).unwrap();
    let text = run(&["flash", "--dry-run", "--image", arg(&file)]);
    assert!(text.contains("19 bytes of flash"), "{text}");
    let json = run(&["flash", "--dry-run", "--json", "--image", arg(&file)]);
    let facts: serde_json::Value = serde_json::from_str(&json).unwrap();
    // That of sha256sum for these bytes.
    assert_eq!(
        facts["sha256"],
        "df6acb82b1ca675cac0c36ffdf494425fd98becce8e8ee9d4f5a1d1560e0813d"
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
    let others = folder.path().join("others.bin");
    std::fs::write(&others, &SMALLEST[..8]).unwrap();
    let nowhere = folder.path().join("nowhere");
    for (port, image, expected) in [
        ("sim:bench", &good, "is a simulated rig and has no flash"),
        ("nowhere", &good, "there is no port"),
        ("nowhere", &text, "no image for an STM32F103C8"),
        ("nowhere", &others, "but not the firmware of a rig"),
        ("nowhere", &nowhere, "nowhere"),
    ] {
        let error = refusal(&["flash", "--port", port, "--image", arg(image)]);
        assert!(error.contains(expected), "{error}");
    }
    let error = refusal(&["flash", "--port", "nowhere", "--boot0", "cts"]);
    assert!(error.contains("it must be rts or dtr"), "{error}");
}

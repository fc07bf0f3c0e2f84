//! The flash image, as a flash tool and the chip would see it.
//!
//! Run with `--nocapture` to see the figures that the README states.

// A test says by a panic what is wrong.
#![allow(clippy::indexing_slicing, clippy::panic, clippy::unwrap_used)]

use object::elf::{PT_LOAD, SHF_ALLOC};
use object::read::elf::{ElfFile32, ProgramHeader};
use object::{Endianness, Object, ObjectSection, ObjectSymbol, SectionFlags};
use std::ops::Range;

/// STM32F103C8 (datasheet DS5319, section 4: memory mapping).
const FLASH: Range<u32> = 0x0800_0000..0x0801_0000;
const RAM: Range<u32> = 0x2000_0000..0x2000_5000;

/// The rest of the flash is room for features; half of the RAM is the stack.
const FLASH_LIMIT: u32 = 36 * 1024;
const RAM_LIMIT: u32 = 10 * 1024;

/// Exceptions before the first interrupt (ARMv7-M Architecture Reference Manual, B1.5.2).
const EXCEPTIONS: usize = 16;

type Elf<'a> = ElfFile32<'a, Endianness>;

fn with_image(check: impl FnOnce(&Elf<'_>)) {
    let path = servoid_firmware_image::build().unwrap();
    let bytes = std::fs::read(path).unwrap();
    check(&ElfFile32::parse(&*bytes).unwrap());
}

fn vectors(elf: &Elf<'_>) -> Vec<u32> {
    let table = elf.section_by_name(".vector_table").unwrap();
    assert_eq!(table.address(), u64::from(FLASH.start));
    let words = table.data().unwrap().chunks_exact(4);
    words
        .map(|word| u32::from_le_bytes(word.try_into().unwrap()))
        .collect()
}

fn symbol(elf: &Elf<'_>, name: &str) -> u32 {
    let symbol = elf.symbol_by_name(name);
    let symbol = symbol.unwrap_or_else(|| panic!("no symbol {name}"));
    symbol.address() as u32
}

#[test]
fn the_chip_starts_with_a_stack_in_ram_and_a_program_in_flash() {
    with_image(|elf| {
        let vectors = vectors(elf);
        let stack = vectors[0];
        assert!(stack > RAM.start && stack <= RAM.end, "{stack:#x}");
        assert_eq!(stack % 8, 0, "the stack is aligned to 8 bytes");
        // Below the stack there is nothing: one that is full cannot overwrite a variable.
        let variables = sections_in_ram(elf).map(|range| range.start).min();
        assert!(variables.unwrap() >= stack, "{variables:x?}");
        for (number, &vector) in vectors.iter().enumerate().skip(1) {
            // 0 is reserved; an odd address says Thumb, the only instructions that there are.
            let good = vector == 0 || (vector % 2 == 1 && FLASH.contains(&vector));
            assert!(good, "vector {number} is {vector:#x}");
        }
        assert_ne!(vectors[1], 0, "the reset vector");
        // The program's headers are no part of what is flashed: the table comes first.
        let first = loaded(elf).into_iter().map(|range| range.start).min();
        assert_eq!(first, Some(FLASH.start));
    });
}

#[test]
fn each_interrupt_that_is_used_has_its_own_handler() {
    with_image(|elf| {
        let vectors = vectors(elf);
        // Positions of RM0008, table "Vector table for other STM32F10xxx devices".
        for (position, name) in [(11, "DMA1_CHANNEL1"), (37, "USART1")] {
            assert_eq!(vectors[EXCEPTIONS + position], symbol(elf, name), "{name}");
        }
        assert_eq!(vectors[1], symbol(elf, "Reset"));
    });
}

#[test]
fn flash_and_ram_are_within_their_limits() {
    with_image(|elf| {
        let flash: u32 = loaded(elf)
            .into_iter()
            .inspect(|range| {
                assert!(
                    range.start >= FLASH.start && range.end <= FLASH.end,
                    "{range:x?} is not in flash"
                );
            })
            .map(|range| range.end - range.start)
            .sum();
        let ram: u32 = sections_in_ram(elf)
            .map(|range| range.end - range.start)
            .sum();
        println!(
            "flash {flash} bytes of {}, static RAM {ram} of {RAM_LIMIT}, the stack's half apart",
            FLASH.end - FLASH.start,
        );
        // A lower bound as well: an image without its linker script is two bytes long.
        assert!(
            (8 * 1024..=FLASH_LIMIT).contains(&flash),
            "{flash} bytes of flash"
        );
        assert!(
            (4 * 1024..=RAM_LIMIT).contains(&ram),
            "{ram} bytes of static RAM"
        );
    });
}

/// The variables.
fn sections_in_ram<'a>(elf: &'a Elf<'a>) -> impl Iterator<Item = Range<u32>> + 'a {
    let sections = elf.sections().filter(|section| {
        let SectionFlags::Elf { sh_flags } = section.flags() else {
            return false;
        };
        sh_flags & u64::from(SHF_ALLOC) != 0 && RAM.contains(&(section.address() as u32))
    });
    sections.map(|section| {
        let start = section.address() as u32;
        start..start + section.size() as u32
    })
}

/// What a flash tool writes, by its place in flash: initial values of variables included.
fn loaded(elf: &Elf<'_>) -> Vec<Range<u32>> {
    let endian = elf.endian();
    elf.elf_program_headers()
        .iter()
        .filter(|header| header.p_type(endian) == PT_LOAD && header.p_filesz(endian) > 0)
        .map(|header| {
            let start = header.p_paddr(endian);
            start..start + header.p_filesz(endian)
        })
        .collect()
}

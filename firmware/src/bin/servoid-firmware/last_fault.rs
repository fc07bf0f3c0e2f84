//! The record of a fault, which outlives the reset that it leads to.
//!
//! It lies in memory that a start leaves as it is. After a loss of the supply that memory is random, so a check sum says
//! whether there is a record.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;
use servoid_protocol::health::{FaultKind, LastFault};
use servoid_protocol::hello::Text16;

/// Mixed into the check sum, so that memory of zeros is no record.
const MARK: u32 = 0x5e4f_01d5;

/// Kind, detail, four words of the place, check sum.
type Words = [u32; 7];

struct Store(UnsafeCell<MaybeUninit<Words>>);

// SAFETY: read once, before interrupts are on; written by handlers that never return, with interrupts off.
unsafe impl Sync for Store {}

#[unsafe(link_section = ".uninit.last_fault")]
static STORE: Store = Store(UnsafeCell::new(MaybeUninit::uninit()));

fn check_sum(words: &Words) -> u32 {
    let [kind, detail, place @ .., _] = words;
    place
        .iter()
        .chain([detail, kind])
        .fold(MARK, |sum, word| sum.rotate_left(5) ^ word)
}

/// Writes the record.
pub fn record(kind: FaultKind, detail: u32, place: Text16) {
    let mut words: Words = [number(kind), detail, 0, 0, 0, 0, 0];
    for (word, bytes) in words.iter_mut().skip(2).zip(place.0.chunks_exact(4)) {
        *word = bytes
            .iter()
            .rev()
            .fold(0, |word, &byte| word << 8 | u32::from(byte));
    }
    let sum = check_sum(&words);
    let [.., last] = &mut words;
    *last = sum;
    // SAFETY: the place is valid for ever, and nothing else uses it while a handler runs.
    unsafe { STORE.0.get().write_volatile(MaybeUninit::new(words)) };
}

/// Takes the record of the fault that led to this start, if there is one.
pub fn take() -> Option<LastFault> {
    // SAFETY: the place is valid for ever, and any content is a valid array of words; interrupts are off or unused yet.
    let words: Words = unsafe { STORE.0.get().cast::<Words>().read_volatile() };
    // SAFETY: as above. Whatever it was, it is no record any more.
    unsafe { STORE.0.get().cast::<Words>().write_volatile([0; 7]) };
    let [kind, detail, place @ .., sum] = words;
    let mut bytes = place.iter().flat_map(|word| word.to_le_bytes());
    let place = Text16(core::array::from_fn(|_| bytes.next().unwrap_or(0)));
    let kind = kinds().into_iter().find(|k| number(*k) == kind)?;
    (sum == check_sum(&words)).then_some(LastFault {
        kind,
        detail,
        place,
    })
}

/// The kind in words, for the log.
pub fn name(kind: FaultKind) -> &'static str {
    match kind {
        FaultKind::Panic => "a panic at line",
        FaultKind::HardFault => "a hard fault at",
        FaultKind::CrystalStopped => "a stopped crystal",
        FaultKind::StrayInterrupt => "a stray interrupt",
    }
}

fn kinds() -> [FaultKind; 4] {
    [
        FaultKind::Panic,
        FaultKind::HardFault,
        FaultKind::CrystalStopped,
        FaultKind::StrayInterrupt,
    ]
}

fn number(kind: FaultKind) -> u32 {
    match kind {
        FaultKind::Panic => 1,
        FaultKind::HardFault => 2,
        FaultKind::CrystalStopped => 3,
        FaultKind::StrayInterrupt => 4,
    }
}

//! The stack's high-water mark: what lies below the deepest call so far still has the pattern of the start.

const PATTERN: u32 = 0x5afe_57ac;

/// Left alone below the present call (words): the frames of the functions here, and of an interrupt.
const MARGIN: usize = 64;

unsafe extern "C" {
    static mut _stack_start: u32;
    static mut _stack_end: u32;
}

/// The stack, from its lower end on (words).
fn bounds() -> (*mut u32, usize) {
    let (low, high) = (&raw mut _stack_end, &raw mut _stack_start);
    (low, (high as usize - low as usize) / size_of::<u32>())
}

/// Writes the pattern below the present call. Once, at the start.
pub fn paint() {
    let (low, words) = bounds();
    let here = cortex_m::register::msp::read() as usize;
    let used = (low as usize + words * size_of::<u32>()).saturating_sub(here) / size_of::<u32>();
    for word in 0..words.saturating_sub(used + MARGIN) {
        // SAFETY: within the stack, and below everything on it. An interrupt that came now would find room in the margin.
        unsafe { low.add(word).write_volatile(PATTERN) };
    }
}

/// Room of the stack, and what of it was never used (bytes). Takes a fifth of a millisecond.
pub fn room_and_unused() -> (u16, u16) {
    let (low, words) = bounds();
    // SAFETY: within the stack; what is being written there is read as it is at some moment.
    let is_unused = |&word: &usize| unsafe { low.add(word).read_volatile() } == PATTERN;
    let unused = (0..words).take_while(is_unused).count();
    let bytes = |words: usize| (words * size_of::<u32>()) as u16;
    (bytes(words), bytes(unused))
}

use super::offset::*;
use super::*;
use crate::peripherals::testing::Bench;

/// 72 MHz and 115200 baud: 625 cycles of 8 ticks.
const BIT: Ticks = 5_000;

struct Rig {
    usart: Usart,
    bench: Bench,
    now: Ticks,
}

impl Rig {
    fn new() -> Self {
        let mut rig = Self {
            usart: Usart::new(8),
            bench: Bench::default(),
            now: 0,
        };
        assert_eq!(rig.read(SR), TXE | TC); // 27.6.1: reset value 0x00C0
        rig.write(BRR, 625);
        rig.write(CR1, 1 << UE | 1 << TE | 1 << RE);
        rig.run_to(FRAME_BITS * BIT); // the idle frame
        rig
    }

    fn write(&mut self, offset: u32, value: u32) {
        let mut moment = self.bench.at(self.now);
        self.usart.write(offset, value, &mut moment).unwrap();
    }

    fn read(&mut self, offset: u32) -> u32 {
        self.usart.read(offset).unwrap()
    }

    fn receive(&mut self, byte: u8) {
        self.usart
            .receive(byte, false, &mut self.bench.at(self.now));
    }

    fn run_to(&mut self, now: Ticks) -> Vec<(Ticks, u8)> {
        let mut sent = Vec::new();
        while let Some(event) = self.usart.next_event().filter(|&event| event <= now) {
            sent.extend(self.usart.advance(event).map(|byte| (event, byte)));
        }
        self.now = now;
        sent
    }
}

/// 27.3.2: two bytes written one after the other leave back to back, ten bits each.
#[test]
fn bytes_leave_one_frame_apart() {
    let mut rig = Rig::new();
    let start = rig.now;
    rig.write(DR, 0x55);
    assert_eq!(rig.read(SR) & (TXE | TC), TXE, "room for one more at once");
    rig.write(DR, 0xaa);
    assert_eq!(rig.read(SR) & (TXE | TC), 0);
    let frame = FRAME_BITS * BIT;
    let sent = rig.run_to(start + 3 * frame);
    assert_eq!(sent, [(start + frame, 0x55), (start + 2 * frame, 0xaa)]);
    assert_eq!(rig.read(SR) & (TXE | TC), TXE | TC);
    assert_eq!(rig.bench.reported(), []);
}

#[test]
fn enabling_the_transmitter_sends_an_idle_frame_first() {
    let mut rig = Rig::new();
    rig.write(CR1, 1 << UE | 1 << RE);
    rig.write(CR1, 1 << UE | 1 << TE);
    let start = rig.now;
    rig.write(DR, 1);
    let sent = rig.run_to(start + 10 * FRAME_BITS * BIT);
    assert_eq!(sent, [(start + 2 * FRAME_BITS * BIT, 1)]);
}

#[test]
fn a_third_byte_is_written_over_the_second() {
    let mut rig = Rig::new();
    for byte in 1..=3 {
        rig.write(DR, byte);
    }
    assert_eq!(rig.bench.reported().len(), 1);
    let bytes: Vec<u8> = rig.run_to(u64::MAX / 2).iter().map(|s| s.1).collect();
    assert_eq!(bytes, [1, 3]);
}

/// 27.3.3, 27.6.1: reading DR clears RXNE; a byte more before that is lost and sets ORE, which
/// reading SR and then DR clears.
#[test]
fn an_overrun_keeps_the_first_byte() {
    let mut rig = Rig::new();
    rig.receive(1);
    rig.receive(2);
    assert_eq!(rig.bench.reported(), [Irregularity::ReceiverOverrun]);
    assert_eq!(rig.read(SR) & (RXNE | ORE), RXNE | ORE);
    assert_eq!(rig.read(DR), 1);
    assert_eq!(rig.read(SR) & (RXNE | ORE), 0);
    rig.receive(3);
    assert_eq!((rig.read(DR), rig.read(SR) & RXNE), (3, 0));
}

#[test]
fn each_enable_has_its_flags() {
    const ON: u32 = 1 << UE | 1 << TE | 1 << RE;
    let mut rig = Rig::new();
    assert!(!rig.usart.interrupt());
    rig.write(CR1, ON | 1 << 7);
    assert!(rig.usart.interrupt(), "TXE");
    rig.write(CR1, ON | 1 << 5);
    assert!(!rig.usart.interrupt());
    rig.receive(1);
    assert!(rig.usart.interrupt(), "RXNE");
    rig.read(SR);
    rig.read(DR);
    assert!(!rig.usart.interrupt());
    rig.write(CR1, ON | 1 << 4);
    rig.run_to(rig.now + 2 * FRAME_BITS * BIT);
    assert!(rig.usart.interrupt(), "IDLE, a frame after the last byte");
}

#[test]
fn nothing_is_received_while_the_receiver_is_off() {
    let mut rig = Rig::new();
    rig.write(CR1, 1 << UE | 1 << TE);
    rig.receive(1);
    assert_eq!(rig.read(SR) & RXNE, 0);
}

#[test]
fn a_damaged_byte_says_so() {
    let mut rig = Rig::new();
    rig.usart.receive(7, true, &mut rig.bench.at(rig.now));
    assert_eq!(rig.read(SR) & (RXNE | FE), RXNE | FE);
    rig.read(DR);
    assert_eq!(rig.read(SR) & FE, 0);
}

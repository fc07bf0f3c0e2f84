use super::*;
use servoid_flash_image::ERASED;

/// A bootloader with its memories, and a clock that goes on while it works.
struct Bench {
    bootloader: Bootloader,
    flash: FlashMemory,
    ram: Ram,
    signature: Signature,
    now: Ticks,
}

impl Bench {
    fn new(protected: bool) -> Self {
        let mut bench = Self {
            bootloader: Bootloader::new(0x410),
            flash: FlashMemory::new(&[0xaa; 2048], 64, protected),
            ram: Ram::default(),
            signature: Signature::new(*b"abcdefghijkl", 64, true),
            now: 0,
        };
        assert_eq!(bench.say(&[SYNC]), [ACK]);
        bench
    }

    /// Sends bytes one after the other, and lets it answer; the time ends with the last byte.
    fn say(&mut self, bytes: &[u8]) -> Vec<u8> {
        let mut memories = Memories {
            flash: &mut self.flash,
            ram: &self.ram,
            signature: &self.signature,
        };
        for byte in bytes {
            self.now += BYTE;
            self.bootloader.receive(*byte, self.now, &mut memories);
        }
        let mut answer = Vec::new();
        while let Some(at) = self.bootloader.next_event() {
            self.now = self.now.max(at);
            answer.extend(self.bootloader.advance(self.now, &mut memories));
        }
        answer
    }

    fn command(&mut self, code: u8) -> Vec<u8> {
        self.say(&[code, !code])
    }

    /// A message with its checksum.
    fn summed(&mut self, bytes: &[u8]) -> Vec<u8> {
        let sum = bytes.iter().fold(0, |sum, byte| sum ^ byte);
        self.say(&[bytes, &[sum]].concat())
    }

    fn at(&mut self, code: u8, address: u32) -> Vec<u8> {
        assert_eq!(self.command(code), [ACK]);
        self.summed(&address.to_be_bytes())
    }

    fn read(&mut self, address: u32, length: u8) -> Vec<u8> {
        assert_eq!(self.at(0x11, address), [ACK]);
        let answer = self.say(&[length - 1, !(length - 1)]);
        assert_eq!(answer.first(), Some(&ACK));
        answer[1..].to_vec()
    }
}

#[test]
fn it_says_who_it_is() {
    let mut bench = Bench::new(false);
    let commands = [0, 1, 2, 0x11, 0x21, 0x31, 0x43, 0x63, 0x73, 0x82, 0x92];
    let expected = [&[ACK, 11, 0x22][..], &commands, &[ACK]].concat();
    assert_eq!(bench.command(0), expected);
    assert_eq!(bench.command(1), [ACK, 0x22, 0, 0, ACK]);
    assert_eq!(bench.command(2), [ACK, 1, 4, 0x10, ACK]);
    assert_eq!(bench.read(SIGNATURE, 2), [64, 0]);
}

#[test]
fn what_is_wrong_is_refused_and_the_next_command_is_heard() {
    let mut bench = Bench::new(false);
    assert_eq!(bench.say(&[0x02, 0x02]), [NACK]);
    assert_eq!(bench.command(0x55), [NACK]);
    assert_eq!(bench.at(0x11, 0x0900_0000), [NACK]);
    assert_eq!(bench.command(0x11), [ACK]);
    assert_eq!(bench.say(&[8, 0, 0, 0, 9]), [NACK]);
    assert_eq!(bench.at(0x31, OWN_RAM - 4), [NACK]);
    assert_eq!(bench.command(2).len(), 5);
}

#[test]
fn flash_is_erased_by_pages_or_whole_and_takes_its_time() {
    let mut bench = Bench::new(false);
    assert_eq!(bench.command(0x43), [ACK]);
    let before = bench.now;
    assert_eq!(bench.summed(&[1, 1, 200]), [ACK]);
    // Page 200 is not there.
    assert_eq!(bench.now - before, ERASE + 5 * BYTE);
    assert_eq!(
        bench.read(FLASH_START + 1022, 4),
        [0xaa, 0xaa, ERASED, ERASED]
    );
    assert_eq!(bench.command(0x43), [ACK]);
    assert_eq!(bench.say(&[0xff, 0]), [ACK]);
    assert_eq!(bench.read(FLASH_START, 2), [ERASED; 2]);
}

#[test]
fn a_write_to_flash_that_is_not_erased_is_acknowledged_and_has_no_effect() {
    let mut bench = Bench::new(false);
    assert_eq!(bench.at(0x31, FLASH_START + 2048), [ACK]);
    let before = bench.now;
    assert_eq!(bench.summed(&[3, 1, 2, 3, 4]), [ACK]);
    assert_eq!(bench.now - before, 2 * WRITE_HALF_WORD + 7 * BYTE);
    assert_eq!(bench.at(0x31, FLASH_START + 2048), [ACK]);
    assert_eq!(bench.summed(&[3, 9, 9, 9, 9]), [ACK]);
    assert_eq!(bench.read(FLASH_START + 2048, 4), [1, 2, 3, 4]);
    assert_eq!(bench.at(0x31, FLASH_START + 2052), [ACK]);
    assert_eq!(bench.say(&[3, 9, 9, 9, 9, 0]), [NACK]);
}

#[test]
fn a_protected_chip_says_who_it_is_and_lets_itself_be_erased() {
    let mut bench = Bench::new(true);
    assert_eq!(bench.command(2).len(), 5);
    for code in [0x11, 0x21, 0x31, 0x43, 0x63, 0x82] {
        assert_eq!(bench.command(code), [NACK], "{code:#x}");
    }
    assert_eq!(bench.command(0x92), [ACK, ACK]);
    assert_eq!(bench.bootloader.end(bench.now), Some(End::Reset));
    assert!(!bench.flash.protected);
    assert_eq!(bench.flash.read(FLASH_START, 1), Some(&[ERASED][..]));
}

#[test]
fn it_jumps_to_programs_only() {
    let mut bench = Bench::new(false);
    assert_eq!(bench.at(0x21, SYSTEM_MEMORY), [NACK]);
    assert_eq!(bench.at(0x21, FLASH_START), [ACK]);
    assert_eq!(
        bench.bootloader.end(bench.now),
        Some(End::Jump(FLASH_START))
    );
}

#[test]
fn a_wrong_first_byte_leaves_it_deaf() {
    let mut bench = Bench::new(false);
    bench.bootloader = Bootloader::new(0x410);
    assert!(bench.say(&[0x3f, SYNC, SYNC]).is_empty());
}

/// It sends five bytes; of those that come meanwhile one is kept, and it is the first half of a command.
#[test]
fn what_comes_while_it_sends_waits_in_one_register() {
    let mut bench = Bench::new(false);
    let answer = bench.say(&[0x02, 0xfd, 0x02, 0xfd, 0x02]);
    assert_eq!(answer.len(), 5);
    assert_eq!(bench.say(&[0xfd]).len(), 5);
}

//! Random numbers: one seed, one independent stream for each use.
//!
//! With a stream for each use, switching one source of chance on or off does not change the others.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// The use of a stream. The numbers are streams of ChaCha; they must not change, so recordings stay reproducible.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Stream {
    White = 1,
    Coloured = 2,
    Scatter = 3,
}

/// The stream of `seed` for one use.
pub(crate) fn stream(seed: u64, which: Stream) -> ChaCha8Rng {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(which as u64);
    random
}

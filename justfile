# The commands that one types. `just` lists them; each is one line that also works without just.

_list:
    @just --list

# all tests, the flash image included
test *ARGS:
    cargo test {{ARGS}}

# the long tests, after .ci/run
long:
    .ci/long

# what the continuous integration requires
ci:
    .ci/run

# the compiler's and clippy's opinion, without building programs
lint:
    cargo fmt --all --check
    cargo clippy --workspace --all-targets -- -D warnings

# the paper on simulated rigs, into demo/
demo:
    cargo run --release --bin servoid -- demo

# the image for the board
image:
    cargo fw

# take over texts that changed on purpose
wording:
    INSTA_UPDATE=always cargo test -p servoid --test integration wording

# the Python package and its tests
python:
    .ci/python

# what the parts cost; one alone: just bench --bench identify
bench *ARGS:
    cargo bench -p servoid-benches {{ARGS}}

# licences, duplicate versions and sources of all dependencies
deny:
    cargo deny check licenses bans sources

# the licences and bills of materials of what is linked, after a change of Cargo.lock
third-party:
    .ci/third_party

# undefined behaviour in what reads the wire, without the tests that are too long for an interpreter
miri:
    rustup toolchain install nightly --profile minimal --component miri,rust-src
    PROPTEST_CASES=8 MIRIFLAGS=-Zmiri-disable-isolation CARGO_TARGET_DIR=target/miri cargo +nightly miri test -p servoid-protocol --lib -- --skip reference --skip every_pattern --skip no_changed_byte --skip no_junk

"""The time of servoid.identify beside that of the library alone, on the same recording of 3600 samples.

Build both first, in the same profile:

    maturin build --release --manifest-path python/Cargo.toml --out target/wheel
    cargo build --release -p servoid-python --example identify_time

then run this with the wheel installed, with the example as its argument.
"""

import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import servoid

TIMES = 30
# Turn about, so that whatever else the machine does slows both.
ROUNDS = 5


def of_package(recording: servoid.Recording) -> list[float]:
    """Milliseconds of each identification from the two arrays."""
    u, y = recording.runs[0]
    found = []
    for _ in range(TIMES):
        began = time.perf_counter()
        servoid.identify(u, y, period=recording.sample_period_s, phase=recording.sample_phase_s)
        found.append(1e3 * (time.perf_counter() - began))
    return found


def of_library(program: str, file: Path) -> list[float]:
    """Milliseconds of each identification by the library."""
    printed = subprocess.run([program, str(file), str(TIMES)], check=True, capture_output=True, text=True).stdout
    return [float(line) for line in printed.split()]


def main() -> None:
    """Print the smallest and the middle time of each, and what the package adds."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "bench.csv"
        recording = servoid.simulate("bench", out=file)
        library: list[float] = []
        package: list[float] = []
        for _ in range(ROUNDS):
            library += of_library(sys.argv[1], file)
            package += of_package(recording)
    for name, times in (("library", library), ("package", package)):
        print(f"{name}: smallest {min(times):.2f} ms, middle {statistics.median(times):.2f} ms")
    print(f"the package adds {min(package) - min(library):.2f} ms")


if __name__ == "__main__":
    main()

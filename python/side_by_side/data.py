"""What is identified: recordings of this repository, and a simulated servo whose response is a formula."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

DATA = Path(__file__).parents[2] / "host" / "tests" / "data"

# The simulated servo: a second-order system behind a delay of whole samples.
PERIOD_S = 0.002
OMEGA_RAD_S = 60.0
DAMPING = 0.7
DELAY_SAMPLES = 10
SAMPLES = 3600
NOISE_SD = 0.1


@dataclass(frozen=True)
class Task:
    """Runs to identify from, and runs that no tool has seen."""

    name: str
    period_s: float
    # Samples after which a response is over, for tools that ask for it.
    settling: int
    # Input (and output) at rest before each run, where they are known.
    before: float | None
    # Whether the drive is known to come to its limit, for tools that ask for it.
    limited: bool
    seen: list[tuple[np.ndarray, np.ndarray]]
    unseen: list[tuple[np.ndarray, np.ndarray]]


def true_step(samples):
    """The exact step response of the simulated servo, at samples 0, 1, ..."""
    t = PERIOD_S * np.maximum(np.arange(samples) - DELAY_SAMPLES, 0)
    swing = OMEGA_RAD_S * np.sqrt(1.0 - DAMPING**2)
    decay = np.exp(-DAMPING * OMEGA_RAD_S * t)
    return 1.0 - decay * (np.cos(swing * t) + DAMPING * OMEGA_RAD_S / swing * np.sin(swing * t))


def simulated(seed, colour):
    """Levels of ±5 held for 60 to 400 ms, and noise with a pole at ``colour``: 0 is white."""
    random = np.random.default_rng(seed)
    holds = random.integers(30, 200, size=SAMPLES // 30)
    u = np.repeat(5.0 * (-1.0) ** np.arange(len(holds)), holds)[:SAMPLES]
    noise = random.normal(scale=NOISE_SD * np.sqrt(1.0 - colour**2), size=SAMPLES)
    noise[0] /= np.sqrt(1.0 - colour**2)
    for k in range(1, SAMPLES):
        noise[k] += colour * noise[k - 1]
    impulse = np.diff(true_step(SAMPLES), prepend=0.0)
    return u, np.convolve(u, impulse)[:SAMPLES] + noise


def _columns(file, *names):
    header = (DATA / file).open().readline().strip().split(",")
    return np.loadtxt(DATA / file, delimiter=",", skiprows=1, usecols=[header.index(name) for name in names]).T


def motor():
    """A DC motor: voltage and speed; the first half identifies, the second is held back."""
    u, y = _columns("dcmotor_speed_prbs.csv", "u", "y")
    half = len(u) // 2
    return Task("DC motor", 0.02, 50, None, False, [(u[:half], y[:half])], [(u[half:], y[half:])])


def servo():
    """An R/C servo under large strokes: odd runs identify, even runs are held back. Before each it was centred for two seconds."""
    u, y, run = _columns("miuzei_rc_servo_large.csv", "u", "y", "run")
    runs = {number: (u[run == number], y[run == number]) for number in np.unique(run)}
    odd = [columns for number, columns in runs.items() if number % 2 == 1]
    even = [columns for number, columns in runs.items() if number % 2 == 0]
    return Task("R/C servo", 0.02, 40, 0.0, True, odd, even)


def linear(seed=1, colour=0.9):
    """The simulated servo; another seed is held back."""
    runs = [[simulated(one, colour)] for one in (seed, seed + 100_000)]
    return Task("simulated servo", PERIOD_S, 100, 0.0, False, *runs)

"""The response to a sine that is asked for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ._arrays import number
from ._interval import Interval
from ._servoid import ServoidError
from ._withdrawn import Withdrawn

#: Value, lower and upper bound.
_Ends = tuple[float | None, float | None, float | None]


@dataclass(frozen=True)
class SineResponse:
    """What becomes of a sine of the command.

    Attributes
    ----------
    hertz : float
        Its frequency (Hz).
    amplitude : float or None
        How far it goes to each side (unit of the command); ``None`` for the linear model, which has the same response to all.
    of_strokes : float or None
        The size of the strokes in the recording of a linear model, where all have one (unit of the command): no servo is shown to answer others, or a
        sine of another amplitude, likewise. ``None`` where there are several sizes, and for the servo as a machine.
    gain : Interval
        Amplitude of the motion over that of the command (output per input).
    phase_deg : Interval
        Phase (degrees); a lag is negative. What the times of the recording leave open is in its bounds. ``None`` throughout where the sine does not move
        the servo, as one within its dead band: then the gain is 0.
    phase_at_rest_deg : float
        Phase of the slowest sines (degrees), from which a lag counts: 0, or a half turn where the position goes against the command.
    level : float or None
        Level of both intervals; ``None`` where bounds are withdrawn.
    withdrawn : Withdrawn or None
        Why there are no bounds; ``None`` where they hold.
    """

    hertz: float
    amplitude: float | None
    of_strokes: float | None
    gain: Interval
    phase_deg: Interval
    phase_at_rest_deg: float
    level: float | None
    withdrawn: Withdrawn | None

    @property
    def late_ms(self) -> float | None:
        """By how much the motion is later than the command, or than the command with its sign changed where it goes against it (ms)."""
        degrees = self.phase_deg.value
        return None if degrees is None else (self.phase_at_rest_deg - degrees) / 360.0 / self.hertz * 1e3


def sine_argument(name: str, value: object) -> float:
    """A frequency or an amplitude."""
    found = number(name, value)
    if not (np.isfinite(found) and found > 0.0):
        raise ServoidError(f"{name} is {found}: give a number above 0")
    return found


def sine(
    hertz: float,
    amplitude: float | None,
    of_strokes: float | None,
    found: tuple[_Ends, _Ends, float],
    level: float | None,
    because: Withdrawn | None,
) -> SineResponse:
    """A response with the level of its bounds, where it has some."""
    gain, phase_deg, at_rest_deg = found
    return SineResponse(hertz, amplitude, of_strokes, Interval(*gain), Interval(*phase_deg), at_rest_deg, None if because else level, because)

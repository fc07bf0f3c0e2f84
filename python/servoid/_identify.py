"""Identification."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from . import _servoid
from ._model import Model
from ._arrays import flag, flag_or_none, number, number_or_word, one_of, unexpected
from ._recording import ARRAYS, READ_OPTIONS, array_runs, as_recording


def identify(
    u: Any,
    y: Any = None,
    *,
    period: float | None = None,
    phase: float = 0.0,
    at_rest: float | Sequence[float | None] | None = None,
    polled: bool = False,
    exact_command: bool = False,
    controllers: Sequence[float] | None = None,
    input_unit: str | None = None,
    output_unit: str | None = None,
    settling: int | str = "auto",
    frequencies: int | str = "auto",
    noise_order: int | str = "auto",
    level: float = 0.99,
    detrend: str = "auto",
    prior: str = "none",
    explain: bool = False,
    flight_model: bool = False,
    servo_model: bool | None = None,
    limits: bool = False,
    **reading: Any,
) -> Model:
    """Identify the servo behind input and output, with bounds.

    Parameters
    ----------
    u, y : array_like, or lists of them
        Command and measured motion, evenly sampled; NaN or masked where a sample is missing. Each command is taken as held until the
        next sample, as a servo holds its pulse: of a command that moves between samples, delays are wrong by up to half a period. Several
        runs of the same servo are lists of arrays; runs are never joined end to end. A moving command in even steps may have been
        rounded, and the bounds allow for that: give it with all its digits. The values of a pandas Series are taken in their order,
        whatever its index. Without ``y``, ``u`` is a :class:`Recording`, the path of a file, a
        list of paths, which are its runs, or a table of pandas.
    period : float
        Time between samples (s).
    phase : float
        From an edge of the command to the first sample that follows it (s).
    at_rest : float, or one for each run, optional
        The input during at least the settling time before the run. A wrong value is far worse than none.
    polled : bool
        Another clock polled the commands, so that each changed up to a period before the sample that has it.
    exact_command : bool
        The servo was sent the command as it is given, with its noise, to its last digit and with its sample; else the bounds allow for
        commands that may have been rounded or measured, and comparisons for commands that wait for pulses.
    controllers : sequence of float, optional
        Name or gain of the controller that drove each run, where several drove the same mechanism.
    input_unit, output_unit : str, optional
        Units, such as ``"deg"``.
    settling : int or "auto"
        Settling time N (samples).
    frequencies : int, "auto" or "narrow"
        Number n of frequencies, odd and at most N. "auto" takes all that the input excites and has the narrowest bounds;
        "narrow" leaves high frequencies out, as the paper does, and has wider ones.
    noise_order : int or "auto"
        Order d of the noise model; 0 is white noise.
    level : float
        Confidence level of every bound, from 0.5 to 0.99999.
    detrend : {"auto", "none", "offset", "linear"}
        What is taken out of the output of each run.
    prior : {"none", "stable"}
        What is known of the response before the data: that it is over after N, or that it dies out and is smooth. In white
        noise bounds are then 1.5 to 4 times narrower, and they hold for such responses.
    explain, flight_model, limits : bool
        Also: why this structure, a low-order model, and motion that is not linear. A low-order model is found by itself where
        bounds hold in a band of frequencies alone.
    servo_model : bool, optional
        Also the servo as a machine. Without it that is looked for where the servo is not linear, or may not be, or the linear model has no
        bounds, which takes some seconds, and minutes of long recordings; ``False`` leaves it out.
    **reading
        Options of :func:`read`, where ``u`` names files.

    Returns
    -------
    Model

    Raises
    ------
    ServoidError
        The data do not determine a model, or an option does not fit; the text names the remedy.

    Examples
    --------
    >>> import servoid
    >>> u, y = servoid.simulate("linear").runs[0]
    >>> model = servoid.identify([u[:1800], u[1800:]], [y[:1800], y[1800:]], period=0.002)
    >>> 0.9 < model.metrics.dc_gain.lower < model.metrics.dc_gain.upper < 1.1
    True
    >>> servoid.identify(u, y[:-1], period=0.002)
    Traceback (most recent call last):
        ...
    servoid.ServoidError: run 1: the input has 3600 samples and the output 3599: give one input value for each ...
    """
    _refuse_seconds(settling, period)
    wanted = {
        "settling": number_or_word("settling", settling, ("auto",), "a number of samples"),
        "frequencies": number_or_word("frequencies", frequencies, ("auto", "narrow"), "an odd number"),
        "noise_order": number_or_word("noise_order", noise_order, ("auto",), "a number"),
        "detrend": one_of("detrend", detrend, ("auto", "none", "offset", "linear")),
        "prior": one_of("prior", prior, ("none", "stable")),
        "level": number("level", level, "a level such as 0.99"),
        "explain": flag("explain", explain),
        "flight_model": flag("flight_model", flight_model),
        "servo_model": flag_or_none("servo_model", servo_model),
        "limits": flag("limits", limits),
    }
    polled, exact_command = flag("polled", polled), flag("exact_command", exact_command)
    unknown = reading.keys() - set(READ_OPTIONS)
    if unknown:
        raise unexpected("identify", unknown)
    if y is None:
        _refuse_options_of_arrays(phase, controllers, input_unit, output_unit)
        options = {"period": period, "at_rest": at_rest, "polled": polled, "exact_command": exact_command, **reading}
        recording = as_recording(u, {name: value for name, value in options.items() if value is not None})
        return Model(_servoid.identify(recording._data, wanted))
    if reading:
        raise TypeError(f"{sorted(reading)[0]} is of files and tables, and here are arrays: leave it out")
    runs, of_arrays = array_runs(
        u,
        y,
        period=period,
        phase=phase,
        at_rest=at_rest,
        polled=polled,
        exact_command=exact_command,
        controllers=controllers,
        input_unit=input_unit,
        output_unit=output_unit,
    )
    return Model(_servoid.identify_arrays(runs, ARRAYS, of_arrays, wanted))


def _refuse_seconds(settling: Any, period: Any) -> None:
    """A settling time in seconds, which people give first."""
    if not isinstance(settling, (float, np.floating)):
        return
    known = isinstance(period, (int, float, np.number)) and period > 0.0 and np.isfinite(settling)
    samples = f": {settling:g} s are {settling / period:.0f} samples here" if known else ""
    raise _servoid.ServoidError(f'settling is {settling!r}: give "auto" or a number of samples, not seconds{samples}')


def _refuse_options_of_arrays(phase: float, *others: Any) -> None:
    if phase != 0.0 or any(other is not None for other in others):
        raise _servoid.ServoidError(
            "phase, controllers, input_unit and output_unit are of arrays: a recording has its own, and files and tables name a column with controller=, and their columns with their units"
        )

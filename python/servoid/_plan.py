"""The forecast of a run."""

from __future__ import annotations

import os
from typing import Any

from . import _servoid
from ._arrays import as_given, flag, number, number_or_none, whole, word
from ._document import Printed
from ._withdrawn import Withdrawn, withdrawn


class Plan(Printed):
    """The forecast of a run: the width of its band, and the questions that it cannot answer. :func:`plan` gives it."""

    def __init__(self, document: str, text: str, figure: str) -> None:
        super().__init__(document, text)
        self.__dict__["_figure"] = figure

    @property
    def run_s(self) -> float:
        """Length of a run with its rest (s)."""
        return float(self._fields["run_s"])

    @property
    def widest_percent(self) -> float | None:
        """Half width of the band where it is widest (% of the step); ``None`` where there will be no bounds."""
        found: float | None = (self._fields["band"] or {}).get("widest_percent")
        return found

    @property
    def withdrawn(self) -> Withdrawn | None:
        """Why there will be no bounds; ``None`` where there will be."""
        return withdrawn(self._fields)

    @property
    def runs_needed(self) -> int | None:
        """Number of runs that reach the band that is wanted; ``None`` where none is wanted, or a hundred do not."""
        found = self._fields["needed"]
        return None if found is None else int(found["runs"])

    def __reduce__(self) -> tuple[Any, ...]:
        return (Plan, (self._text, self.summary, self.__dict__["_figure"]))

    def __repr__(self) -> str:
        band = "no bounds" if self.widest_percent is None else f"band ±{self.widest_percent:.2g} % of the step"
        return f"<Plan: {self._fields['description']}; {band}>"

    def _repr_html_(self) -> str:
        return str(self.__dict__["_figure"])


def plan(
    servo: str | os.PathLike[str] = "bench",
    *,
    model: str | os.PathLike[str] | None = None,
    noise: float | None = None,
    band: float | None = None,
    repeat: int = 1,
    level: float = 0.99,
    servo_model: bool = False,
    reference: str = "staircase",
    amplitude: float | None = None,
    hold: float | None = None,
    length: float | None = None,
    levels: int | None = None,
    prbs_seed: int | None = None,
    frequencies: tuple[float, float] | None = None,
) -> Plan:
    """Forecast a run before it takes place.

    Parameters
    ----------
    servo : str or path
        The servo that is assumed: bench, aircraft or linear, or the file of a model with a servo model.
    model : path, optional
        Take the linear part of the servo and its noise from this model file instead.
    noise : float, optional
        Standard deviation of white noise that is assumed instead (degrees).
    band : float, optional
        Half width of the band that is wanted (% of the step).
    repeat : int
        Number of runs.
    level : float
        Confidence level of every bound.
    servo_model : bool
        Also identify a simulated run as a machine.
    reference, amplitude, hold, length, levels, prbs_seed, frequencies
        The reference, as in :func:`simulate`.

    Returns
    -------
    Plan

    Raises
    ------
    ServoidError
        There is no such servo or reference, or such a run could not be identified.

    Examples
    --------
    >>> import servoid
    >>> servoid.plan("linear").widest_percent < 2
    True
    """
    options = {
        "model": None if model is None else named("model", model),
        "servo": named("servo", servo),
        "noise": number_or_none("noise", noise, "a number of degrees"),
        "band": number_or_none("band", band, "a number of percent of the step"),
        "repeat": whole("repeat", repeat, 1, 99),
        "level": number("level", level, "a level such as 0.99"),
        "servo_model": flag("servo_model", servo_model),
    }
    run = reference_options(reference, amplitude, hold, length, levels, prbs_seed, frequencies)
    return Plan(*_servoid.plan(run, options))


def named(argument: str, value: Any) -> str:
    """The name of a simulated servo, or the path of a model's file."""
    if isinstance(value, (str, os.PathLike)):
        return str(os.fspath(value))
    raise TypeError(
        f"{argument} is of the type {type(value).__name__} and must be the path of a file: "
        f'save a model with model.save("servo.json") and give {argument}="servo.json"'
    )


def reference_options(
    reference: str,
    amplitude: float | None,
    hold: float | None,
    length: float | None,
    levels: int | None,
    prbs_seed: int | None,
    frequencies: tuple[float, float] | None,
) -> dict[str, Any]:
    """The options of a reference, by name."""
    return {
        "reference": word("reference", os.fspath(reference) if hasattr(reference, "__fspath__") else reference, REFERENCES),
        "amplitude": number_or_none("amplitude", amplitude, "a number of degrees"),
        "hold": number_or_none("hold", hold, "a number of seconds"),
        "length": number_or_none("length", length, "a number of seconds"),
        "levels": None if levels is None else whole("levels", levels, 2, 16),
        "prbs_seed": None if prbs_seed is None else whole("prbs_seed", prbs_seed, 1, 2**16 - 1),
        "frequencies": None if frequencies is None else _two(frequencies),
    }


REFERENCES = "staircase, stairs, prbs, sweep, multisine, or the path of a table of steps"
"""What a reference is."""


def _two(frequencies: Any) -> tuple[float, float]:
    """The lowest and the highest frequency."""
    what = "the lowest and the highest frequency in Hz, such as (0.2, 15)"
    if isinstance(frequencies, (str, bytes)) or not hasattr(frequencies, "__len__") or len(frequencies) != 2:
        raise TypeError(f"frequencies is {as_given(frequencies)}: give {what}")
    low, high = (number("frequencies", one, "two numbers of Hz") for one in frequencies)
    return low, high

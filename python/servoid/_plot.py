"""Figures by matplotlib, which is optional."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ._arrays import as_given
from ._servoid import ServoidError

if TYPE_CHECKING:
    from ._comparison import Comparison
    from ._model import FrequencyResponse, Model
    from ._servo_model import ServoModel, ServoResponse

NO_BOUNDS = ": no bounds can be given"
"""What stands in a legend behind the name of a curve without a band."""


PICTURE = ": linear picture of this recording, no bounds can be given"
"""The same of a servo that is not linear."""


def pyplot() -> Any:
    """What figures are made by."""
    try:
        import matplotlib.pyplot as plt
    except ImportError:
        raise ServoidError("a figure needs matplotlib: pip install matplotlib") from None
    return plt


def ratio(model: Model) -> str:
    """The unit of the output per that of the input, in brackets."""
    of = model.units
    return f"({of['output']} per {of['input']})" if {"input", "output"} <= of.keys() else "(output per input)"


def axes_or_new(ax: Any) -> Any:
    """These axes, or those of a new figure."""
    plt = pyplot()
    if ax is not None and not hasattr(ax, "fill_between"):
        raise TypeError(f"ax is {as_given(ax)}: give Axes of matplotlib, such as matplotlib.pyplot.gca(), or leave ax out")
    return plt.subplots()[1] if ax is None else ax


def servo_response(servo: ServoModel, found: ServoResponse, ax: Any, label: str) -> Any:
    """A simulated response with its band."""
    ax = axes_or_new(ax)
    time_s = np.arange(len(found.value)) * servo.sample_period_s
    if found.lower is None or found.upper is None:
        label += NO_BOUNDS
    (line,) = ax.plot(time_s, found.value, label=label)
    if found.lower is not None and found.upper is not None and servo.level is not None:
        band = f"{100 * servo.level:g} % at each time by itself"
        ax.fill_between(time_s, found.lower, found.upper, alpha=0.2, color=line.get_color(), label=band)
    ax.set_xlabel("time (s)")
    ax.set_ylabel("output")
    ax.legend()
    return ax


def step(model: Model, ax: Any, label: str) -> Any:
    """The step response with its band."""
    ax = axes_or_new(ax)
    response = model.step
    time_s = response.time_s + model.sample_phase_s
    if response.level is None or response.lower is None or response.upper is None:
        label += NO_BOUNDS if model.linear else PICTURE
    (line,) = ax.plot(time_s, response.value, label=label)
    if response.level is not None and response.lower is not None and response.upper is not None:
        band = f"the whole curve, {100 * response.level:g} %{of_motion(model)}"
        ax.fill_between(time_s, response.lower, response.upper, alpha=0.2, color=line.get_color(), label=band)
    ax.set_xlabel("time since the edge of the command (s)")
    ax.set_ylabel(f"response to a unit step {ratio(model)}")
    ax.legend()
    return ax


def differences(comparison: Comparison, ax: Any, label: str) -> Any:
    """The difference of the step responses with its band, of each direction where they differ."""
    ax = axes_or_new(ax)
    for stroke, curve in comparison.curves.items():
        name = label if stroke == "both" else f"{label}, strokes {stroke}"
        if curve.lower is None or curve.upper is None:
            name += NO_BOUNDS
        (line,) = ax.plot(1e3 * curve.time_s, curve.percent, label=name)
        if curve.lower is not None and curve.upper is not None and comparison.level is not None:
            band = f"the whole curve, {100 * comparison.level:g} %"
            ax.fill_between(1e3 * curve.time_s, curve.lower, curve.upper, alpha=0.2, color=line.get_color(), label=band)
    for margin in (-comparison.margin_percent, comparison.margin_percent):
        ax.axhline(margin, color="grey", linestyle=":", label="margin" if margin > 0 else None)
    ax.set_xlabel("time since the edge of the command (ms)")
    ax.set_ylabel("difference of the step responses (% of the step)")
    ax.legend()
    return ax


def of_motion(model: Model) -> str:
    """What a band is of: another motion of a servo that is not linear may be farther off, and strokes of one size do not show whether one is."""
    stroke = model._fields.get("only_stroke")
    of_strokes = "" if stroke is None else f", strokes of {stroke:g}"
    return of_strokes if model.linear else ", of this motion"


# How far below the lowest magnitude a bound is drawn (dB): where zero is possible, minus infinity would flatten everything else.
FLOOR_DB = 10.0


def bode(model: Model, response: FrequencyResponse, shown: slice, axes: Any, label: str) -> Any:
    """Magnitude and phase of a response with their bounds, at these of its frequencies."""
    plt = pyplot()
    if axes is not None and not (hasattr(axes, "__len__") and len(axes) == 2 and all(hasattr(ax, "fill_between") for ax in axes)):
        raise TypeError(f"axes is {as_given(axes)}: give two Axes of matplotlib, such as matplotlib.pyplot.subplots(2)[1], or leave axes out")
    magnitude, phase = plt.subplots(2, sharex=True, layout="constrained")[1] if axes is None else axes
    hertz = response.omega_rad_s[shown] / (2 * np.pi)
    panels = [
        (magnitude, response.magnitude_db, response.magnitude_db_lower, response.magnitude_db_upper),
        (phase, response.phase_deg, response.phase_deg_lower, response.phase_deg_upper),
    ]
    if response.level is None:
        label += NO_BOUNDS if model.linear else PICTURE
    for ax, value, lower, upper in panels:
        (line,) = ax.semilogx(hertz, value[shown], label=label)
        if response.level is None or lower is None or upper is None:
            continue
        lower = lower[shown]
        if ax is magnitude:
            lower = np.maximum(lower, min(0.0, value[shown].min()) - FLOOR_DB)
        band = f"{100 * response.level:g} % at each frequency by itself{of_motion(model)}"
        ax.fill_between(hertz, lower, upper[shown], alpha=0.2, color=line.get_color(), label=band)
    for ax in (magnitude, phase):
        ticks_of_frequency(ax.xaxis)
    # Two lines: one is longer than half a figure is high.
    magnitude.set_ylabel(f"magnitude\n(dB of {ratio(model)[1:-1]})")
    phase.set_ylabel("phase (degrees)")
    phase.set_xlabel("frequency (Hz)")
    magnitude.legend()
    return magnitude, phase


def ticks_of_frequency(axis: Any) -> None:
    """Ticks at 1, 2 and 5, as in reports: those of matplotlib overlap within a decade."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter(FuncFormatter(lambda hertz, _: f"{hertz:g}"))
    axis.set_minor_formatter(NullFormatter())

"""Figures by matplotlib, which is optional."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._servoid import ServoidError

if TYPE_CHECKING:
    from ._model import Model


def step(model: Model, ax: Any, label: str) -> Any:
    """The step response with its band."""
    try:
        import matplotlib.pyplot as plt
    except ImportError:
        raise ServoidError("a figure needs matplotlib: pip install matplotlib") from None
    ax = plt.subplots()[1] if ax is None else ax
    response = model.step
    time_s = response.time_s + model.sample_phase_s
    if response.level is None or response.lower is None or response.upper is None:
        label += ": no bounds can be given"
    (line,) = ax.plot(time_s, response.value, label=label)
    if response.level is not None and response.lower is not None and response.upper is not None:
        band = f"the whole curve, {100 * response.level:g} %"
        ax.fill_between(time_s, response.lower, response.upper, alpha=0.2, color=line.get_color(), label=band)
    ax.set_xlabel("time since the edge of the command (s)")
    ax.set_ylabel("response to a unit step")
    ax.legend()
    return ax

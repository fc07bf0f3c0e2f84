"""The low-order model."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ._document import Column, column_or_none
from ._draws import normal
from ._interval import Interval, interval, interval_or_none
from ._withdrawn import Withdrawn, withdrawn


class FlightModel(dict[str, Any]):
    """A transfer function of first to third order: ``model.flight_model`` with ``flight_model=True``.

    It is K exp(-L s) / ((1 + 2 ζ s/ω + s²/ω²) (1 + T s)), of which a low order lacks one factor or the other. The delay L counts
    from the edge of the command. It is the document's dictionary, too (docs/results.md), with the attributes below, intervals
    among them: ``flight.delay_s.value``, ``flight.gain.lower``.

    Examples
    --------
    >>> import servoid
    >>> flight = servoid.identify(servoid.simulate("linear"), flight_model=True).flight_model
    >>> flight.coordinates
    ('gain', 'delay_s', 'ln_omega_rad_s', 'ln_damping')
    >>> sorted(flight.sd)
    ['damping', 'delay_s', 'gain', 'omega_rad_s']
    """

    def __init__(self, fields: Mapping[str, Any], summary: str = "") -> None:
        super().__init__(fields)
        self.__dict__["_summary"] = summary

    @property
    def summary(self) -> str:
        """The text that the command line prints of it."""
        return str(self.__dict__["_summary"])

    def __str__(self) -> str:
        return self.summary.strip("\n") or repr(self)

    def __repr__(self) -> str:
        parameters = [
            _in_words("gain", self.gain, 1.0, ""),
            _in_words("delay", self.delay_s, 1e3, " ms"),
            _in_words("omega", self.omega_rad_s, 1.0, " rad/s"),
            _in_words("damping", self.damping, 1.0, ""),
            _in_words("lag", self.lag_s, 1e3, " ms"),
        ]
        level = "no bounds" if self.level is None else f"bounds at {100 * self.level:g} %"
        return f"<FlightModel of order {self.order} ({level}): {', '.join(filter(None, parameters))}>"

    @property
    def order(self) -> int:
        """Number of poles, 1 to 3."""
        return int(self["order"])

    @property
    def gain(self) -> Interval:
        """K (output per input)."""
        return interval(self["gain"])

    @property
    def delay_s(self) -> Interval:
        """L (s)."""
        return interval(self["delay_s"])

    @property
    def omega_rad_s(self) -> Interval | None:
        """ω (rad/s); ``None`` in first order."""
        return interval_or_none(self["omega_rad_s"])

    @property
    def damping(self) -> Interval | None:
        """ζ, a ratio; ``None`` in first order."""
        return interval_or_none(self["damping"])

    @property
    def lag_s(self) -> Interval | None:
        """T (s); ``None`` in second order."""
        return interval_or_none(self["lag_s"])

    @property
    def band_hz(self) -> tuple[float, float] | None:
        """Ends of the band that it was fitted to (Hz), below and above which its order is assumed; ``None`` where all is known."""
        found = self.get("band_hz")
        return None if found is None else (float(found[0]), float(found[1]))

    @property
    def approximation(self) -> bool:
        """Whether no order fits the identified response within its errors, so that this is the order that is closest to it."""
        return bool(self["approximation"])

    @property
    def level(self) -> float | None:
        """Level of the intervals; ``None`` where bounds are withdrawn."""
        level: float | None = (self["bounds"] or {}).get("level")
        return level

    @property
    def withdrawn(self) -> Withdrawn | None:
        """Why no bounds can be given; ``None`` where they hold."""
        return withdrawn(self)

    @property
    def coordinates(self) -> tuple[str, ...]:
        """What rows and columns of :attr:`covariance` are of; ``ln_`` stands before those whose natural logarithm it is."""
        oscillator = () if self["omega_rad_s"] is None else ("ln_omega_rad_s", "ln_damping")
        lag = () if self["lag_s"] is None else ("ln_lag_s",)
        return ("gain", "delay_s", *oscillator, *lag)

    @property
    def covariance(self) -> Column | None:
        """Covariance of :attr:`coordinates`, which is [K, L, ln ω, ln ζ, ln T], as far as the order has them; ``None`` without bounds.

        K is in output per input and L in s; the logarithms are of numbers in rad/s, of a ratio, and of numbers in s, so that their
        standard deviations are relative errors. It is that of the noise for a servo of this order: the intervals hold servos of up to
        three poles, and are wider. An uncertain delay of the sensor is in the interval of L alone.
        """
        return column_or_none((self["bounds"] or {}).get("covariance"))

    def draws(self, count: int, *, seed: int | None = None) -> dict[str, Column]:
        """Each parameter at random, as the recording leaves them open together: for a simulation of many servos (Monte Carlo).

        They are normally distributed in :attr:`coordinates`, with :attr:`covariance`, so that they are those of a servo of this order; a delay
        below zero is cut off. The intervals are wider: they hold servos of up to three poles.

        Parameters
        ----------
        count : int
            How many.
        seed : int, optional
            For the same draws again.

        Returns
        -------
        dict of ndarray
            ``gain``, ``delay_s``, ``omega_rad_s``, ``damping`` and ``lag_s``, as far as the order has them, each with `count` values.

        Raises
        ------
        ServoidError
            Bounds are withdrawn, so there is no covariance.

        Examples
        --------
        >>> import servoid
        >>> flight = servoid.identify(servoid.simulate("linear"), flight_model=True).flight_model
        >>> sorted(flight.draws(100, seed=1))
        ['damping', 'delay_s', 'gain', 'omega_rad_s']
        """
        names = [coordinate.removeprefix("ln_") for coordinate in self.coordinates]
        is_logarithm = [name != coordinate for name, coordinate in zip(names, self.coordinates, strict=True)]
        values = np.array([self[name]["value"] for name in names])
        mean = np.where(is_logarithm, np.log(np.where(is_logarithm, values, 1.0)), values)
        rows = normal(mean, self.covariance, count, seed, self.withdrawn)
        found = {name: np.exp(row) if is_ln else row for name, is_ln, row in zip(names, is_logarithm, rows.T, strict=True)}
        found["delay_s"] = found["delay_s"].clip(0.0)
        return found

    @property
    def sd(self) -> dict[str, float] | None:
        """Standard deviation of each parameter in its own unit, by the first order of the logarithm; ``None`` without bounds."""
        covariance = self.covariance
        if covariance is None:
            return None
        found = {}
        for name, deviation in zip(self.coordinates, np.sqrt(np.diag(covariance)), strict=True):
            parameter = name.removeprefix("ln_")
            scale = 1.0 if parameter == name else self[parameter]["value"]
            found[parameter] = float(deviation * scale)
        return found


def _in_words(name: str, found: Interval | None, scale: float, unit: str) -> str:
    """A parameter with its interval; nothing where the order has it not."""
    if found is None or found.value is None:
        return ""
    ends = ["-" if end is None else f"{scale * end:.4g}" for end in (found.lower, found.upper)]
    bounds = "" if ends == ["-", "-"] else f" ({ends[0]} .. {ends[1]})"
    return f"{name} {scale * found.value:.4g}{unit}{bounds}"

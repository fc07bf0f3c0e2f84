"""What a comparison says of two servos."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ._document import Column, column, column_or_none
from ._interval import Interval, interval
from ._withdrawn import Withdrawn, withdrawn


@dataclass(frozen=True)
class LargestDifference:
    """The largest difference of two step responses.

    Attributes
    ----------
    at_least, at_most : float
        Its bounds (% of the step).
    at_s : float
        When it is surest (s after the edge of the command).
    stroke : {"both", "up", "down"}
        On which strokes.
    """

    at_least: float
    at_most: float
    at_s: float
    stroke: str


@dataclass(frozen=True)
class MetricDifference:
    """One metric of both sides, in the unit that it has in :class:`Metrics`.

    Attributes
    ----------
    a, b : Interval
        The metric of either side.
    difference : Interval
        b - a. It may be surer than the intervals of both sides say.
    """

    a: Interval
    b: Interval
    difference: Interval

    @property
    def ratio(self) -> float | None:
        """b / a, such as that of the gains; it has no interval. ``None`` where a side has no value, or a is 0."""
        a, b = self.a.value, self.b.value
        return b / a if a and b is not None else None


@dataclass(frozen=True, eq=False)
class DifferenceCurve:
    """Difference of the step responses, second less first.

    Attributes
    ----------
    stroke : {"both", "up", "down"}
        Of which strokes.
    time_s, percent : ndarray
        Time since the edge of the command (s), and the difference (% of the step, by the size of the gain of the first side: a servo
        that turns the other way has its sign).
    lower, upper : ndarray or None
        Bounds of the whole curve; ``None`` where they are withdrawn.
    withdrawn : Withdrawn or None
        Why there are none.
    delay_shift_s : Interval
        By how much the second is later (s).
    shift_leaves_percent : float or None
        What such a delay leaves unexplained by the estimates, without bounds (% of the final value).
    shift_between_rows_percent : float or None
        By how much more that may be, as nobody knows a response between its samples.
    """

    stroke: str
    time_s: Column
    percent: Column
    lower: Column | None
    upper: Column | None
    withdrawn: Withdrawn | None
    delay_shift_s: Interval
    shift_leaves_percent: float | None
    shift_between_rows_percent: float | None


@dataclass(frozen=True)
class OverPrediction:
    """By how much the model of the first side predicts more motion than the second has, at rest.

    Attributes
    ----------
    plus_percent, minus_percent, travel_percent : Interval
        At the largest and the least command, and between them (% of what is predicted).
    definition : str
        At which commands, and from when after an edge.
    """

    plus_percent: Interval
    minus_percent: Interval
    travel_percent: Interval
    definition: str


@dataclass(frozen=True)
class Asymmetry:
    """Up and down strokes of one side.

    Attributes
    ----------
    p : float or None
        Probability of such a difference by noise alone; ``None``, as the other, where the data have no answer.
    largest_percent : float or None
        The largest difference, up less down (% of the stroke).
    """

    p: float | None
    largest_percent: float | None


def bounded(value: Any, bounds: Any) -> Interval:
    """A value with a pair of bounds, where it has one."""
    lower, upper = bounds or (None, None)
    return Interval(value, lower, upper)


def metric_difference(fields: dict[str, Any]) -> MetricDifference:
    """A row of the document's differences."""
    difference = Interval(fields["difference"], fields["lower"], fields["upper"])
    a, b = (bounded(fields[side], fields[f"{side}_bounds"]) for side in "ab")
    return MetricDifference(a, b, difference)


def difference_curve(fields: dict[str, Any]) -> DifferenceCurve:
    """A curve of the document."""
    bounds = fields["bounds"] or {}
    return DifferenceCurve(
        fields["stroke"],
        column(fields["time_s"]),
        column(fields["percent"]),
        column_or_none(bounds.get("lower")),
        column_or_none(bounds.get("upper")),
        withdrawn(fields),
        interval(fields["delay_shift_s"]),
        fields["shift_leaves_percent"],
        fields["shift_between_rows_percent"],
    )


def over_prediction(fields: dict[str, Any] | None) -> OverPrediction | None:
    """That of the document, where it has one."""
    if fields is None:
        return None
    plus, minus, travel = (interval(fields[f"{name}_percent"]) for name in ("plus", "minus", "travel"))
    return OverPrediction(plus, minus, travel, fields["definition"])

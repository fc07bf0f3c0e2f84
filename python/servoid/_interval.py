"""Values between two bounds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Interval:
    """A value between two bounds at the level of its model.

    Attributes
    ----------
    value : float or None
        Best estimate; ``None`` where the data do not determine it.
    lower, upper : float or None
        Bounds; ``None`` where they are withdrawn, or where nothing bounds the value on that side.
    """

    value: float | None
    lower: float | None
    upper: float | None


def interval(fields: dict[str, Any]) -> Interval:
    """A value with its bounds, where it has some."""
    return Interval(fields.get("value"), fields.get("lower"), fields.get("upper"))


def interval_or_none(fields: dict[str, Any] | None) -> Interval | None:
    """The same, and ``None`` where there is nothing."""
    return None if fields is None else interval(fields)

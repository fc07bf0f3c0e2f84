"""Arrays of callers as the library takes them: one dimension, float64, NaN where a sample is missing."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._document import Column
from ._servoid import ServoidError


def samples(name: str, values: Any) -> Column:
    """One column of samples. Arrays of float64 are taken as they are, others are converted; masked samples become NaN."""
    if isinstance(values, np.ma.MaskedArray):
        values = np.ma.filled(values.astype(np.float64), np.nan)
    try:
        found = np.asarray(values)
        if found.dtype.kind not in "biufO":
            raise TypeError(f"its values are of type {found.dtype}")
        found = found.astype(np.float64, copy=False)
    except (TypeError, ValueError) as error:
        raise ServoidError(
            f"the {name} holds something else than numbers ({error}): give an array of numbers, NaN where a sample is missing"
        ) from None
    if found.ndim != 1:
        raise ServoidError(
            f"the {name} has the shape {found.shape}: give one value for each sample, and several runs as a list of arrays"
        )
    return found


def number(name: str, value: Any, what: str = "a number") -> float:
    """One number of an argument; text is none, also where it looks like one."""
    if isinstance(value, (str, bytes)) or not (hasattr(value, "__float__") or hasattr(value, "__index__")):
        raise TypeError(f"{name} is {value!r}: give {what}")
    return float(value)


def number_or_none(name: str, value: Any, what: str = "a number") -> float | None:
    """The same, and ``None`` where there is nothing."""
    return None if value is None else number(name, value, what)


def is_list_of_runs(values: Any) -> bool:
    """Whether these are several columns, and not one column of numbers."""
    return (
        isinstance(values, (list, tuple))
        and len(values) > 0
        and all(np.ndim(value) > 0 for value in values)
    )

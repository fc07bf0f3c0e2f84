"""Arrays of callers as the library takes them: one dimension, float64, NaN where a sample is missing."""

from __future__ import annotations

import operator
import os
from collections.abc import Iterable
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
        raise ServoidError(f"the {name} {_shape_in_words(found.shape)}")
    return found


def _shape_in_words(shape: tuple[int, ...]) -> str:
    if not shape:
        return "is one value: give an array, with one value for each sample"
    if len(shape) == 2 and shape[1] == 1:
        return f"is a column with the shape {shape}: give its values with one dimension, such as column[:, 0] of an array or table[name] of pandas"
    return f"has the shape {shape}: give one value for each sample, and several runs as a list of arrays"


def as_given(value: Any) -> str:
    """An argument in a sentence: as it is written, or by its type where that is long."""
    written = repr(value)
    return written if len(written) <= 40 and "\n" not in written else f"of the type {type(value).__name__}"


def number(name: str, value: Any, what: str = "a number") -> float:
    """One number of an argument; text is none, also where it looks like one, and neither is an array of one."""
    is_array = getattr(value, "ndim", 0) != 0
    no_number = (str, bytes, bool, np.bool_)
    if isinstance(value, no_number) or is_array or not (hasattr(value, "__float__") or hasattr(value, "__index__")):
        raise TypeError(f"{name} is {as_given(value)}: give {what}")
    return float(value)


def number_or_none(name: str, value: Any, what: str = "a number") -> float | None:
    """The same, and ``None`` where there is nothing."""
    return None if value is None else number(name, value, what)


def command_or_none(name: str, value: Any) -> float | None:
    """A value of the command, where one is given."""
    found = number_or_none(name, value)
    if found is not None and not np.isfinite(found):
        raise ServoidError(f"{name} is {found}: give the command before the run, or leave {name} out where it is not known")
    return found


def whole(name: str, value: Any, least: int, most: int) -> int:
    """A whole number of an argument, between both ends."""
    try:
        if isinstance(value, (bool, np.bool_)):
            raise TypeError
        found = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} is {as_given(value)}: give a whole number from {least} to {most}") from None
    if not least <= found <= most:
        raise ServoidError(f"{name} is {found}: give a whole number from {least} to {most}")
    return found


def flag(name: str, value: Any) -> bool:
    """A switch of an argument."""
    if not isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{name} is {as_given(value)}: give True or False")
    return bool(value)


def flag_or_none(name: str, value: Any) -> bool | None:
    """The same, and ``None`` where nothing is asked for."""
    return None if value is None else flag(name, value)


def word(name: str, value: Any, what: str = "a text") -> str:
    """A text of an argument."""
    if not isinstance(value, str):
        raise TypeError(f"{name} is {as_given(value)}: give {what}")
    return value


def word_or_none(name: str, value: Any, what: str = "a text") -> str | None:
    """The same, and ``None`` where there is nothing."""
    return None if value is None else word(name, value, what)


def one_of(name: str, value: Any, words: tuple[str, ...]) -> str:
    """One of these words."""
    listed = " or ".join(", ".join(f'"{one}"' for one in words).rsplit(", ", 1))
    if word(name, value, listed) not in words:
        raise ServoidError(f"{name} is {as_given(value)}: give {listed}")
    return str(value)


def number_or_word(name: str, value: Any, words: tuple[str, ...], what: str) -> str:
    """A whole number or one of these words, as the program takes both."""
    if isinstance(value, str) and value in words:
        return value
    listed = ", ".join(f'"{one}"' for one in words)
    try:
        if isinstance(value, (bool, np.bool_)):
            raise TypeError
        found = int(value) if isinstance(value, str) else operator.index(value)
    except (TypeError, ValueError) as error:
        wrong = TypeError if isinstance(error, TypeError) else ServoidError
        raise wrong(f"{name} is {as_given(value)}: give {listed} or {what}") from None
    if found < 0:
        raise ServoidError(f"{name} is {found}: give {listed} or {what}")
    return str(found)


def path_of(name: str, value: Any, what: str) -> str:
    """The path of a file."""
    if not isinstance(value, (str, os.PathLike)):
        raise TypeError(f"{name} is {as_given(value)}: give {what}")
    return str(os.fspath(value))


_PERIODS = ("dt", "ts", "tsample", "sample_time", "sample_period", "sampling_period", "period_s", "sample_period_s")
_RATES = ("fs", "rate", "sample_rate", "sampling_rate", "freq", "frequency", "hz")


def unexpected(function: str, names: Iterable[str]) -> TypeError:
    """What to say of arguments that a function has not."""
    first = sorted(names)[0]
    asked = first.lower()
    if asked in _PERIODS:
        instead = ": give the time between samples in seconds as period="
    elif asked in _RATES:
        instead = ": give the time between samples in seconds, 1 / rate, as period="
    else:
        instead = f": help(servoid.{function}) has those it takes"
    return TypeError(f"{function}() has no argument {first}{instead}")


def is_list_of_runs(values: Any) -> bool:
    """Whether these are several columns, and not one column of numbers."""
    return (
        isinstance(values, (list, tuple))
        and len(values) > 0
        and all(np.ndim(value) > 0 for value in values)
    )

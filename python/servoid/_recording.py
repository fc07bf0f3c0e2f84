"""Recordings: files, tables in memory, and arrays of samples."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import _servoid
from ._arrays import (
    as_given,
    command_or_none,
    flag,
    is_list_of_runs,
    number,
    number_or_none,
    samples,
    unexpected,
    word,
    word_or_none,
)
from ._document import Column

if TYPE_CHECKING:
    from ._model import Model

Path = str | os.PathLike[str]

SECONDS = "a number of seconds"
"""What a time between samples is."""

ARRAYS = "arrays"
"""What data are called that come as arrays, and have no other name."""


class Run(NamedTuple):
    """One uninterrupted experiment.

    Attributes
    ----------
    input, output : ndarray
        Command and measured motion, one value for each sample, NaN where one is missing; read-only.
    """

    input: Column
    output: Column


class Recording:
    """The runs of one servo under one condition. :func:`read` and :func:`simulate` give them.

    Examples
    --------
    >>> import servoid
    >>> recording = servoid.simulate("bench")
    >>> recording.sample_period_s
    0.002
    >>> recording.runs[0].input.shape
    (3600,)
    """

    __slots__ = ("_data",)
    _data: _servoid.Data

    def __init__(self, data: _servoid.Data) -> None:
        object.__setattr__(self, "_data", data)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError("a Recording cannot be changed")

    @property
    def name(self) -> str:
        """The files, for sentences."""
        return self._data.name

    @property
    def sample_period_s(self) -> float:
        """Time between samples (s)."""
        return self._data.sample_period_s

    @property
    def sample_phase_s(self) -> float:
        """From an edge of the command to the first sample that follows it (s)."""
        return self._data.sample_phase_s

    @property
    def samples(self) -> int:
        """Number of samples of all runs, missing ones included."""
        return self._data.samples[0]

    @property
    def samples_missing(self) -> int:
        """Number of samples that lack the input or the output."""
        return self._data.samples[1]

    @property
    def input_unit(self) -> str | None:
        """The unit of the command, where it is known."""
        return self._data.units[0]

    @property
    def output_unit(self) -> str | None:
        """The unit of the motion, where it is known."""
        return self._data.units[1]

    @property
    def remarks(self) -> tuple[str, ...]:
        """What a user should know about the files: guessed periods, gaps, partial recordings."""
        return tuple(self._data.remarks)

    @property
    def runs(self) -> tuple[Run, ...]:
        """The runs, as new arrays (the library keeps its own)."""
        runs = tuple(Run(*columns) for columns in self._data.runs())
        for run in runs:
            run.input.flags.writeable = False
            run.output.flags.writeable = False
        return runs

    def __repr__(self) -> str:
        runs = len(self._data.runs()) if self.samples else 0
        missing = f", {self.samples_missing} missing" if self.samples_missing else ""
        return (
            f"<Recording {self.name}: {runs} run{'s' if runs != 1 else ''}, {self.samples} samples{missing}, "
            f"every {1e3 * self.sample_period_s:g} ms>"
        )


def read(
    *paths: Path,
    input: str | None = None,
    output: str | None = None,
    period: float | None = None,
    time: str | None = None,
    time_unit: str | None = None,
    run: str | None = None,
    controller: str | None = None,
    at_rest: float | None = None,
    polled: bool = False,
    exact_command: bool = False,
    with_rest: bool = False,
) -> Recording:
    """Read recordings of servoid, CSV files of other programs, or a table of pandas.

    Several files are several runs of the same servo under the same condition. The options are those of the command line.

    Parameters
    ----------
    *paths : path or DataFrame
        Files, or one table.
    input, output : str, optional
        Columns of command and motion, for files that servoid has not recorded.
    period : float, optional
        Time between rows (s); without it, from a column of time.
    time : str, optional
        Column of time, where its name is not recognised.
    time_unit : {"s", "ms", "us", "ns"}, optional
        Unit of a column of time whose name does not have it.
    run : str, optional
        Column whose value changes where a new run begins.
    controller : str, optional
        Column with the name or gain of the controller that drove the run.
    at_rest : float, optional
        The input during at least the settling time before each run. A wrong value is far worse than none.
    polled : bool
        The command changed between rows, as a logger with a clock of its own sees it: times are corrected by half a row.
    exact_command : bool
        The servo was sent the command as it is written, with the noise of its holds, to its last digit and with its row.
    with_rest : bool
        Use the rest around the reference of servoid's recordings too.

    Returns
    -------
    Recording

    Raises
    ------
    ServoidError
        A file cannot be read as a recording; the text names the remedy.

    Examples
    --------
    >>> import pandas, servoid
    >>> table = pandas.DataFrame({"time_s": [0.0, 0.01, 0.02, 0.03], "u": [0, 1, 1, 1], "y": [0.0, 0.0, 0.4, 0.9]})
    >>> servoid.read(table, input="u", output="y")
    <Recording table: 1 run, 4 samples, every 10 ms>
    """
    options = checked(
        {
            "input": input,
            "output": output,
            "period": period,
            "time": time,
            "time_unit": time_unit,
            "run": run,
            "controller": controller,
            "at_rest": at_rest,
            "polled": polled,
            "exact_command": exact_command,
            "with_rest": with_rest,
        }
    )
    if not paths:
        raise TypeError("no file is named: give the path of a recording, the paths of several runs, or a table of pandas")
    if any(hasattr(path, "to_csv") for path in paths):
        if len(paths) != 1:
            raise _servoid.ServoidError(
                "several runs of tables are one table with a column that names the run: give pandas.concat({1: first, 2: second}, names=[\"part\"]) "
                'with run="part", or write the tables to files and give their paths'
            )
        return Recording(_of_table(paths[0], options))
    for path in paths:
        if not isinstance(path, (str, os.PathLike)):
            raise TypeError(
                f"a recording is the path of a file or a table of pandas, and here {type(path).__name__}: "
                "give several files one behind the other, and make a recording of arrays with servoid.recording(u, y, period=...)"
            )
    return Recording(_servoid.Data.read([os.fspath(path) for path in paths], options))


def checked(options: dict[str, Any]) -> dict[str, Any]:
    """The options of :func:`read`, each of the type that it must have."""
    found: dict[str, Any] = {name: word_or_none(name, options[name], "the name of a column") for name in COLUMNS}
    found["time_unit"] = word_or_none("time_unit", options["time_unit"], '"s", "ms", "us" or "ns"')
    found["period"] = number_or_none("period", options["period"], SECONDS)
    found["at_rest"] = command_or_none("at_rest", options["at_rest"])
    return found | {name: flag(name, options[name]) for name in FLAGS}


def of_bytes(content: bytes, name: str) -> Recording:
    """The content of a recording of servoid, which is called ``name``."""
    options = dict.fromkeys(READ_OPTIONS) | dict.fromkeys(FLAGS, False)
    return Recording(_servoid.Data.of_table(content, name, options))


def _of_table(table: Any, options: dict[str, Any]) -> _servoid.Data:
    # An index with a name is a column; one without is the number of the row.
    text = table.to_csv(index=any(name is not None for name in table.index.names))
    return _servoid.Data.of_table(text.encode(), "table", options)


def recording(
    u: Any,
    y: Any,
    *,
    period: float | None = None,
    phase: float = 0.0,
    at_rest: float | Sequence[float | None] | None = None,
    polled: bool = False,
    exact_command: bool = False,
    controllers: Sequence[float] | None = None,
    input_unit: str | None = None,
    output_unit: str | None = None,
    name: str = ARRAYS,
) -> Recording:
    """Make a recording of arrays, as :func:`compare` takes them.

    Parameters
    ----------
    u, y : array_like, or lists of them
        Command and measured motion, one array for each run; NaN or masked where a sample is missing.
    period, phase, at_rest, polled, exact_command, controllers, input_unit, output_unit
        As those of :func:`identify`.
    name : str
        What it is called in texts, such as the summary of a comparison: "free", or "loaded".

    Returns
    -------
    Recording

    Raises
    ------
    ServoidError
        The arrays do not fit each other, or the period is missing.

    Examples
    --------
    >>> import servoid
    >>> u, y = servoid.simulate("linear").runs[0]
    >>> len(servoid.recording([u, u], [y, y], period=0.002).runs)
    2
    """
    runs, options = array_runs(
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
    return Recording(_servoid.Data.of_arrays(runs, word("name", name, "a word, such as \"free\""), options))


def array_runs(
    u: Any,
    y: Any,
    *,
    period: float | None,
    phase: float,
    at_rest: float | Sequence[float | None] | None,
    polled: bool,
    exact_command: bool,
    controllers: Sequence[float] | None,
    input_unit: str | None,
    output_unit: str | None,
) -> tuple[list[tuple[Column, Column]], dict[str, Any]]:
    """The columns of each run, and what the library wants to know of them. Arrays of float64 are not copied."""
    if period is None:
        raise _servoid.ServoidError(
            "say how far apart the samples are: period=, in seconds"
        )
    several = is_list_of_runs(u)
    inputs, outputs = (u, y) if several else ([u], [y])
    if several and not (is_list_of_runs(y) and len(y) == len(u)):
        raise _servoid.ServoidError(
            "u has several runs: give y as a list of as many arrays"
        )
    runs = [
        (samples("input", one), samples("output", other))
        for one, other in zip(inputs, outputs)
    ]
    if all(len(column) == 0 for run in runs for column in run):
        raise _servoid.ServoidError(
            "there are no samples: u and y are empty, so give the command and the motion that were recorded"
        )
    each = [command_or_none("at_rest", one) for one in _of_each(at_rest, len(runs))]
    names = _names_of(controllers)
    period, phase = number("period", period, SECONDS), number("phase", phase, SECONDS)
    for name, values in (("at_rest", each), ("controllers", names or each)):
        if len(values) != len(runs):
            there_are = "there is 1 run" if len(runs) == 1 else f"there are {len(runs)} runs"
            raise _servoid.ServoidError(f"{there_are}, and {name} has {len(values)} values: give one for each run")
    if not phase >= 0.0 or phase == float("inf"):
        raise _servoid.ServoidError(
            f"a phase of {phase} s is not a time after an edge: it must be 0 or more"
        )
    options = {
        "period": period,
        "phase": phase,
        "at_rest": each,
        "polled": flag("polled", polled),
        "exact_command": flag("exact_command", exact_command),
        "controllers": names,
        "input_unit": word_or_none("input_unit", input_unit, 'a unit such as "deg"'),
        "output_unit": word_or_none("output_unit", output_unit, 'a unit such as "deg"'),
    }
    return runs, options


def _of_each(at_rest: Any, runs: int) -> list[Any]:
    """The input before each run: one value for all, or one for each."""
    several = isinstance(at_rest, (Sequence, np.ndarray)) and not isinstance(at_rest, str)
    return list(at_rest) if several and np.ndim(at_rest) else [at_rest] * runs


def _names_of(controllers: Any) -> list[float]:
    """The controllers by their numbers; none where none are named."""
    if controllers is None:
        return []
    if isinstance(controllers, str) or not hasattr(controllers, "__iter__"):
        raise TypeError(f"controllers is {as_given(controllers)}: give a list with a number for each run")
    names = [number("controllers", name, "a number for each run") for name in controllers]
    if not all(np.isfinite(names)):
        raise _servoid.ServoidError("controllers has a value that is no number: give a number for each run")
    return names


def as_recording(source: Any, options: dict[str, Any], like: Model | None = None) -> Recording:
    """A recording: itself, or the files that are named."""
    unknown = options.keys() - set(READ_OPTIONS)
    if unknown:
        raise unexpected("read", unknown)
    if isinstance(source, Recording):
        if any(value not in (None, False) for value in options.values()):
            raise _servoid.ServoidError(
                "a recording has been read already: give the options on reading to servoid.read"
            )
        return source
    if hasattr(source, "to_csv"):
        return read(source, **options)
    paths = [source] if isinstance(source, (str, os.PathLike)) else source
    if isinstance(paths, Sequence) and any(hasattr(path, "to_csv") for path in paths):
        return read(*paths, **options)
    if not (isinstance(paths, Sequence) and paths and all(isinstance(path, (str, os.PathLike)) for path in paths)):
        raise _servoid.ServoidError(
            f"a recording is a file, a list of files or a table of pandas, and here {_called(source)}: "
            "make one of arrays with servoid.recording(u, y, period=...)"
        )
    if like is None:
        return read(*paths, **options)
    given = checked({**dict.fromkeys(READ_OPTIONS), **dict.fromkeys(FLAGS, False), **options})
    return Recording(
        _servoid.Data.read_as([os.fspath(path) for path in paths], given, like._core)
    )


def _called(source: Any) -> str:
    empty = isinstance(source, Sequence) and len(source) == 0
    return f"an empty {type(source).__name__}" if empty else type(source).__name__


READ_OPTIONS = (
    "input",
    "output",
    "period",
    "time",
    "time_unit",
    "run",
    "controller",
    "at_rest",
    "polled",
    "exact_command",
    "with_rest",
)
COLUMNS = ("input", "output", "time", "run", "controller")
FLAGS = ("polled", "exact_command", "with_rest")

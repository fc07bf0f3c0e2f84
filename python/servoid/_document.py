"""Results as documents: the JSON of the command line, and the values in it."""

from __future__ import annotations

import json
import os
from functools import cached_property
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

Column = NDArray[np.float64]


def column(values: Any) -> Column:
    """A read-only array of numbers; ``None`` becomes NaN."""
    array = np.array(values, dtype=np.float64)
    array.flags.writeable = False
    return array


def column_or_none(values: Any) -> Column | None:
    """The same, and ``None`` where there are no values."""
    return None if values is None else column(values)


def write_new(path: str | os.PathLike[str], text: str, force: bool) -> None:
    """Write a file; one that exists is replaced with ``force`` alone."""
    try:
        with Path(path).open("w" if force else "x", encoding="utf-8", newline="\n") as file:
            file.write(text)
    except FileExistsError as error:
        raise FileExistsError(error.errno, "the file exists: force=True replaces it", error.filename) from None


class Document:
    """A frozen result: a JSON document, and objects made of it."""

    _text: str

    def __init__(self, text: str) -> None:
        self.__dict__["_text"] = text

    @cached_property
    def _fields(self) -> dict[str, Any]:
        fields: dict[str, Any] = json.loads(self._text)
        return fields

    def __setattr__(self, name: str, value: object) -> NoReturn:
        raise AttributeError(f"a {type(self).__name__} is a result and cannot be changed")

    def __delattr__(self, name: str) -> NoReturn:
        raise AttributeError(f"a {type(self).__name__} is a result and cannot be changed")

    def __eq__(self, other: object) -> bool:
        return isinstance(other, type(self)) and self._text == other._text

    def __hash__(self) -> int:
        return hash(self._text)

    def to_dict(self) -> dict[str, Any]:
        """All fields, as the command line has them with ``--json``.

        Returns
        -------
        dict
            A new dictionary of lists, numbers and texts; docs/results.md describes each field.
        """
        fields: dict[str, Any] = json.loads(self._text)
        return fields

    def save(self, path: str | os.PathLike[str], *, force: bool = False) -> None:
        """Write the JSON that the command line writes with ``-o``.

        Parameters
        ----------
        path : path
            The file.
        force : bool
            Replace a file that exists.

        Raises
        ------
        FileExistsError
            The file exists, and ``force`` is not set.
        """
        write_new(path, self._text, force)


class Printed(Document):
    """A document with the text that the command line prints of it."""

    def __init__(self, document: str, text: str) -> None:
        super().__init__(document)
        self.__dict__["_summary"] = text

    @property
    def summary(self) -> str:
        """The text that the command line prints."""
        return str(self.__dict__["_summary"])

    def __reduce__(self) -> tuple[Any, ...]:
        return (type(self), (self._text, self.summary))

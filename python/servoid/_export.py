"""Models for other programs."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from ._document import write_new

if TYPE_CHECKING:
    from ._servoid import Model as Core


@dataclass(frozen=True)
class Export:
    """A file for another program. :meth:`Model.export` gives it.

    Attributes
    ----------
    target : str
        The program.
    text : str
        The file.
    remarks, warnings : tuple of str
        What whoever uses the file must know, and what limits its use.
    largest_difference : float or None
        How far the position may be from that of the servo model (unit of the output), under the command that the file names; ``None``
        of a linear model.
    document : dict
        What ``servoid export --json`` prints, without the text (docs/results.md).
    """

    target: str
    text: str = field(repr=False)
    remarks: tuple[str, ...]
    warnings: tuple[str, ...]
    largest_difference: float | None
    document: dict[str, Any] = field(repr=False)

    def save(self, path: str | os.PathLike[str], *, force: bool = False) -> None:
        """Write the file.

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
        write_new(path, self.text, force)


def export(core: Core, options: dict[str, Any]) -> Export:
    """The model for another program."""
    text, remarks, warnings, printed = core.export(options)
    document = json.loads(printed)
    return Export(document["target"], text, tuple(remarks), tuple(warnings), document.get("largest_difference"), document)

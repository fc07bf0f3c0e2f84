"""Why bounds are withdrawn."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Withdrawn:
    """Why no bounds can be given.

    Attributes
    ----------
    reason : str
        A stable name, such as ``"errors_not_noise"``.
    because : str
        The reason in a few words.
    """

    reason: str
    because: str

    def warn(self, what: str = "") -> None:
        """Warn whoever called the method that gives numbers without bounds, as ``servoid export`` does."""
        warnings.warn(f"no bounds{what} can be given, as {self.because}", stacklevel=3)


def withdrawn(fields: dict[str, Any]) -> Withdrawn | None:
    """The reason that stands beside bounds."""
    found = fields.get("withdrawn")
    return None if found is None else Withdrawn(found["reason"], found["because"])

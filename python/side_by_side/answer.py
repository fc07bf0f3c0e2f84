"""What a tool gives."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Answer:
    """A model that has been identified.

    Attributes
    ----------
    simulate : callable
        The output for an input, from the input alone.
    lower, upper : ndarray or None
        Bounds of the step response for each sample by itself, at 99 %; ``None`` where the tool has none.
    """

    simulate: Callable[[np.ndarray], np.ndarray]
    lower: np.ndarray | None = None
    upper: np.ndarray | None = None


def padded(u, task):
    """An input with the rest before it; without change where that is not known."""
    return u if task.before is None else np.concatenate([np.full(task.settling, task.before), u])


def joined(task):
    """All runs end to end, with the rest between them where it is known, for tools that take one run."""
    return tuple(np.concatenate([padded(run, task) for run in column]) for column in zip(*task.seen))

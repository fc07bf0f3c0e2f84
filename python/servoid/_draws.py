"""Random numbers with a covariance, for simulations of what a recording leaves open."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import _servoid
from ._document import Column
from ._withdrawn import Withdrawn


#: Behind the name of a drawn servo, whose summary and file have much of the estimate.
DRAWN = " (one of the possible servos; intervals and fit are those of the estimate)"


def require_draws(covariance: Any, count: int, withdrawn: Withdrawn | None) -> None:
    """Refuses what nothing can be drawn from, and a count that is none.

    Raises
    ------
    ServoidError
        There is no covariance, because bounds are withdrawn; or the count is no number of rows.
    """
    if covariance is None:
        because = "bounds are withdrawn" if withdrawn is None else withdrawn.because
        raise _servoid.ServoidError(f"there is no covariance to draw from: {because}")
    if isinstance(count, bool) or not isinstance(count, int) or count < 0:
        raise _servoid.ServoidError(f"count must be a number of draws, such as 100, and is {count!r}")


def normal(mean: Any, covariance: Any, count: int, seed: int | None, withdrawn: Withdrawn | None) -> Column:
    """`count` rows of a normal distribution.

    Raises
    ------
    ServoidError
        There is no covariance, because bounds are withdrawn; or the count is no number of rows.
    """
    require_draws(covariance, count, withdrawn)
    # A coordinate that the recording does not show has no variance, which Cholesky's factor does not take.
    variances, directions = np.linalg.eigh(np.asarray(covariance))
    spread = directions * np.sqrt(np.clip(variances, 0.0, None))
    numbers = np.random.default_rng(seed).standard_normal((count, len(variances)))
    found: Column = np.asarray(mean) + numbers @ spread.T
    return found

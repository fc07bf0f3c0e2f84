"""Recordings of simulated servos."""

from __future__ import annotations

import os
import tempfile

from . import _servoid
from ._arrays import flag, number_or_none, path_of, whole
from ._plan import named, reference_options
from ._recording import Recording, of_bytes, read


def simulate(
    servo: str | os.PathLike[str] = "bench",
    *,
    seed: int = 1,
    controller: float | None = None,
    reference: str = "staircase",
    amplitude: float | None = None,
    hold: float | None = None,
    length: float | None = None,
    levels: int | None = None,
    prbs_seed: int | None = None,
    frequencies: tuple[float, float] | None = None,
    out: str | os.PathLike[str] | None = None,
    force: bool = False,
) -> Recording:
    """Record a simulated servo on a simulated rig, as fast as the computer allows.

    Parameters
    ----------
    servo : str or path
        bench (free), aircraft (loaded by a rotor), linear (exactly), or the file of a model with a servo model.
    seed : int
        Seed of the noise; equal seeds give equal recordings.
    controller : float, optional
        The controller that drives it, where the model has several.
    reference : {"staircase", "stairs", "prbs", "sweep", "multisine"} or path
        The reference, or a table of steps in a CSV file.
    amplitude : float, optional
        Amplitude to each side of neutral (degrees).
    hold, length : float, optional
        Hold of each level of stairs or each chip of prbs, and length of the reference (s); the staircase has a length of its own.
    levels, prbs_seed : int, optional
        Number of levels of stairs; start of prbs in its sequence.
    frequencies : (float, float), optional
        Lowest and highest frequency of sweep and multisine (Hz).
    out : path, optional
        Keep the recording in this file.
    force : bool
        Replace ``out`` where it exists.

    Returns
    -------
    Recording

    Raises
    ------
    ServoidError
        There is no such servo, or the reference goes beyond the limits of the rig.

    Examples
    --------
    >>> import servoid
    >>> servoid.simulate("aircraft", seed=3, reference="prbs", length=20)
    <Recording aircraft.csv: 1 run, 10000 samples, every 2 ms>
    """
    servo, seed = named("servo", servo), whole("seed", seed, 0, 2**64 - 1)
    controller, force = number_or_none("controller", controller), flag("force", force)
    run = reference_options(reference, amplitude, hold, length, levels, prbs_seed, frequencies)
    if out is not None:
        _servoid.simulate(servo, controller, seed, run, path_of("out", out, "the path of the file to write"), force)
        return read(out)
    name = os.path.splitext(os.path.basename(servo.split("?")[0]))[0]
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, f"{name}.csv")
        _servoid.simulate(servo, controller, seed, run, file, False)
        with open(file, "rb") as recorded:
            return of_bytes(recorded.read(), f"{name}.csv")

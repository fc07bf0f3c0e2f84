"""Models as objects of python-control."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ._servoid import ServoidError

if TYPE_CHECKING:
    from ._model import Model
    from ._withdrawn import Withdrawn

# Order of the Padé approximation of a delay: to a tenth of a degree up to the bandwidth of a servo.
PADE_ORDER = 3


def to_control(model: Model, kind: str) -> tuple[Any, Withdrawn | None, str]:
    """The object of this kind, why it has no bounds, where it has none, and of what."""
    if kind == "frd":
        found = _frequency_response(model)
        return found, model.withdrawn if model.frequency.level is None else None, ""
    if kind == "flight":
        found, flight = _flight(model), model.flight_model
        return found, None if flight is None else flight.withdrawn, ""
    # Beside the bounds of a band, those of the step response are missing.
    what = "" if model.frequency.level is None else " of the step response"
    return _of_samples(model, kind), model.withdrawn, what


def _frequency_response(model: Model) -> Any:
    """Of the servo in continuous time, as the object is: the hold of the samples would be a lag that no continuous loop has."""
    found = model.servo_frequency
    if found.level is None:
        known, why = model._core.sine(found.omega_rad_s[0] / (2.0 * np.pi))
        if known is None:
            raise ServoidError(f"there is no frequency response: {why}")
    return _python_control().FRD(found.response, found.omega_rad_s)


def _of_samples(model: Model, kind: str) -> Any:
    """The discrete system that the step response is."""
    control = _python_control()
    impulse, period = model.impulse_response, model.sample_period_s
    last = len(impulse) - 1
    if kind == "tf":
        return control.TransferFunction(impulse, [1.0] + [0.0] * last, period)
    if kind == "ss":
        # A shift register of past inputs.
        past = np.eye(last, k=-1)
        newest = np.eye(last, 1)
        return control.StateSpace(past, newest, impulse[np.newaxis, 1:], impulse[:1, np.newaxis], period)
    raise ServoidError(f"there is no kind {kind!r}: choose frd, tf, ss or flight")


def _python_control() -> Any:
    try:
        import control
    except ImportError as error:
        raise ImportError("to_control() needs python-control: pip install control") from error
    return control


def _flight(model: Model) -> Any:
    control = _python_control()
    found = model.flight_model
    if found is None:
        raise ServoidError("the model has no low-order model: identify with flight_model=True, and where that finds none, the summary says why")
    transfer = found["transfer"]
    system = control.TransferFunction([transfer["gain"]], [1.0])
    if transfer.get("oscillator") is not None:
        omega, damping = transfer["oscillator"]["omega_rad_s"], transfer["oscillator"]["damping"]
        system = system * control.TransferFunction([omega**2], [1.0, 2.0 * damping * omega, omega**2])
    if transfer.get("lag_s") is not None:
        system = system * control.TransferFunction([1.0], [transfer["lag_s"], 1.0])
    delay = control.TransferFunction(*control.pade(transfer["delay_s"], PADE_ORDER))
    return system * delay

"""The servo as a machine."""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _servoid
from ._arrays import command_or_none, number_or_none, samples
from ._document import Column, column, column_or_none
from ._draws import DRAWN, normal, require_draws
from ._sine import SineResponse, sine, sine_argument
from ._withdrawn import Withdrawn, withdrawn

if TYPE_CHECKING:
    from ._model import Model

#: What makes a servo, of coordinates that not all numbers do: the least and the largest.
_POSSIBLE = {
    "delay": (0.0, np.inf),
    "motor_share": (1e-5, 1.0),
    "dead_band": (0.0, np.inf),
    "play": (0.0, np.inf),
    "friction": (0.0, np.inf),
    "friction_at_rest": (0.0, np.inf),
    "friction_of_gears": (0.0, 0.9),
}

#: Strokes by which draws are held against the band last so long (s): servos come to rest in that.
_HELD_S = 0.5

#: So many times as many servos as are asked for are drawn at the most.
_ROUNDS = 50

#: The share of the top speed at which half of the excess of friction at rest is gone, where a document does not say another.
_FRICTION_SPEED_SHARE = 0.05


@dataclass(frozen=True)
class Quantity:
    """A property of the servo as a machine.

    Its bounds are of these recordings: they contain their noise, and not what differs from run to run.

    Attributes
    ----------
    name, unit : str
        What it is; units as in the document, such as ``"per_second_squared"``.
    determined : bool
        Whether the recording determines it.
    value : float or None
        Best estimate; ``None`` of what the recording does not determine.
    lower, upper : float or None
        Bounds; ``None`` where they are withdrawn, or nothing bounds the value on that side.
    other_fits : tuple of float or None
        The least and the most among fits with other terms that predict as well and fits to each quarter of the
        recording, where bounds are withdrawn. Not an interval.
    """

    name: str
    unit: str
    determined: bool
    value: float | None
    lower: float | None
    upper: float | None
    other_fits: tuple[float, float] | None = None


@dataclass(frozen=True, eq=False)
class ServoResponse:
    """A simulated response with its band, which is that of the servo's motion, without the noise of a sensor.

    Attributes
    ----------
    value : ndarray
        The output, one value for each sample.
    lower, upper : ndarray or None
        Bounds for each sample by itself; ``None`` where they are withdrawn.
    withdrawn : Withdrawn or None
        Why there is no band; ``None`` where there is one.
    """

    value: Column
    lower: Column | None
    upper: Column | None
    withdrawn: Withdrawn | None


class ServoModel:
    """A nonlinear model of motor, controller and load: ``model.servo_model``, where it was found.

    Examples
    --------
    >>> import servoid
    >>> stairs = servoid.simulate("bench", reference="stairs", amplitude=20, length=20)
    >>> servo = servoid.identify(stairs, servo_model=True).servo_model
    >>> response = servo.simulate([0.0] * 10 + [10.0] * 90)
    >>> response.value.shape
    (100,)
    """

    __slots__ = ("_core", "_fields")
    _core: _servoid.Model
    _fields: dict[str, Any]

    def __init__(self, fields: dict[str, Any], core: _servoid.Model) -> None:
        object.__setattr__(self, "_fields", fields)
        object.__setattr__(self, "_core", core)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError("a ServoModel is a result and cannot be changed")

    @property
    def sample_period_s(self) -> float:
        """Time between samples (s)."""
        return float(self._fields["sample_period_s"])

    @property
    def terms(self) -> dict[str, Any]:
        """The terms of the equation that prediction needs, as in the document."""
        return dict(self._fields["terms"])

    @property
    def controllers(self) -> tuple[float, ...]:
        """Names of the controllers; empty where all runs had the same one."""
        return tuple(self._fields["controller_names"])

    @property
    def level(self) -> float | None:
        """Level of the intervals; ``None`` where bounds are withdrawn."""
        level: float | None = (self._fields["bounds"] or {}).get("level")
        return level

    @property
    def withdrawn(self) -> Withdrawn | None:
        """Why no bounds can be given; ``None`` where they hold."""
        return withdrawn(self._fields)

    @property
    def coordinates(self) -> tuple[str, ...]:
        """What :attr:`values`, and rows and columns of :attr:`covariance`, are of; docs/servo-model.md has what each is in the equation."""
        return tuple(_name(found) for found in self._fields["coordinates"])

    @property
    def values(self) -> Column:
        """Best estimate of :attr:`coordinates`."""
        return column(self._fields["values"])

    @property
    def covariance(self) -> Column | None:
        """Covariance of :attr:`coordinates`; ``None`` where bounds are withdrawn."""
        return column_or_none((self._fields["bounds"] or {}).get("rows"))

    def draws(self, count: int, *, seed: int | None = None) -> list[Model]:
        """Models with other servos in them, at random as the recording leaves them open: for a simulation of many (Monte Carlo).

        Each is this model with another servo: simulate with its ``servo_model.simulate(u).value``, or export it. The values of its
        ``servo_model.quantities`` are its own. All else in it, intervals included, is that of the estimate.

        A recording does not always say which terms a servo has. So each draw takes one of the possible servos first, this one or one of the other
        sets of terms that predict as well, all equally often. Its :attr:`terms` and :attr:`coordinates` are that servo's. It is normally
        distributed in these, with that servo's covariance; what no servo has, such as a negative friction, is cut off. A draw that leaves the
        band of this model by as much again, in strokes over the commands of the recording, is a servo that the recording does not allow:
        another one is drawn in its place. Far from the estimate coordinates change the motion otherwise than the covariance has it.

        Not in the draws: the uncertainty of a sensor's delay and of how a command was sent, coordinates that have no variance because the recording
        does not show them, and ends of an interval that are cut off. So quantities that the recording does not determine, such as a top speed that
        no stroke reached, stay near the estimate in all draws. A ``UserWarning`` names them.

        Parameters
        ----------
        count : int
            How many.
        seed : int, optional
            For the same draws again.

        Returns
        -------
        list of Model

        Raises
        ------
        ServoidError
            Bounds are withdrawn, so there is no covariance.

        Examples
        --------
        >>> import servoid
        >>> stairs = servoid.simulate("bench", reference="stairs", amplitude=20, length=20)
        >>> servo = servoid.identify(stairs, servo_model=True).servo_model
        >>> responses = [draw.servo_model.simulate([0.0] * 10 + [10.0] * 90).value for draw in servo.draws(20, seed=1)]
        >>> len(responses), responses[0].shape
        (20, (100,))
        """
        from ._model import Model

        require_draws(self.covariance, count, self.withdrawn)
        document = json.loads(self._core.document)
        servo = document["servo_model"]
        found: list[Model] = []
        is_allowed = self._is_allowed()
        # Every round has numbers of its own, whatever became of those before.
        seeds = (None if seed is None else seed + 1009 * further for further in range(_ROUNDS))
        for drawn in (drawn for of_round in seeds for drawn in self._draws(count, of_round)):
            if len(found) == count:
                break
            servo.update(drawn, alternatives=[], drawn=True)
            name = f"draw {len(found) + 1} of {self._core.name}{DRAWN}"
            another = Model(_servoid.Model.parse(json.dumps(document), name))
            drawn_servo = another.servo_model
            if drawn_servo is not None and is_allowed(drawn_servo):
                found.append(another)
        if len(found) < count:
            raise _servoid.ServoidError("hardly any servo that is drawn moves as the recording has it: its covariance is no use far from the estimate")
        if undetermined := [quantity["name"] for quantity in servo["quantities"] if not quantity["determined"]]:
            names = ", ".join(undetermined)
            warnings.warn(f"the recording does not determine {names}: the draws have fewer values of that than it allows", stacklevel=2)
        return found

    def _is_allowed(self) -> Callable[[ServoModel], bool]:
        """Whether another servo moves within twice the band of this one, in strokes over the commands of the recording."""
        commands = self._fields.get("commands")
        if commands is None:
            return lambda other: True
        least, largest = commands["least"], commands["largest"]
        controller = self.controllers[0] if self.controllers else None
        held = max(1, round(_HELD_S / self._fields["sample_period_s"]))
        # Where the largest strokes are beyond the recording, smaller ones are not.
        for share in (1.0, 0.7, 0.5, 0.3, 0.1):
            middle, half = (least + largest) / 2, share * (largest - least) / 2
            strokes = np.repeat([middle, middle + half, middle - half, middle, middle - half / 4, middle + half / 4], held)
            band = self.simulate(strokes, controller=controller)
            if band.upper is not None:
                break
        else:
            return lambda other: True
        width = band.upper - band.value + 1e-9 * (largest - least)

        def is_allowed(other: ServoModel) -> bool:
            apart = np.abs(other.simulate(strokes, controller=controller).value - band.value)
            return bool(np.all(apart <= 2.0 * width))

        return is_allowed

    def _draws(self, count: int, seed: int | None) -> list[dict[str, Any]]:
        """What is another in the document of each draw."""
        bounds = self._fields["bounds"]
        own = {name: self._fields.get(name) for name in ("terms", "coordinates", "values", "friction_speed_share")}
        own["covariance"] = None if bounds is None else bounds["rows"]
        possible = [own, *self._fields["alternatives"]]
        # Each servo has as many rows as there are draws, so that those of one do not depend on how often another is taken.
        rows = [
            normal(servo["values"], servo["covariance"], count, None if seed is None else seed + place, self.withdrawn)
            for place, servo in enumerate(possible)
        ]
        taken = np.random.default_rng(seed).integers(len(possible), size=count)
        found = []
        for number, place in enumerate(taken):
            servo = possible[place]
            values = [
                float(np.clip(value, *_POSSIBLE.get(str(name), (-np.inf, np.inf))))
                for name, value in zip(servo["coordinates"], rows[place][number])
            ]
            share = servo.get("friction_speed_share") or _FRICTION_SPEED_SHARE
            found.append(
                {
                    "terms": servo["terms"],
                    "coordinates": servo["coordinates"],
                    "values": values,
                    "friction_speed_share": share,
                    "bounds": {**bounds, "rows": servo["covariance"]},
                }
            )
        return found

    @property
    def quantities(self) -> dict[str, Quantity]:
        """A dictionary of delay, top speed, dead band and the like: each :class:`Quantity` by its name."""
        found = {}
        for fields in self._fields["quantities"]:
            determined = fields["determined"]
            # What the fit has there is a number of its own, which the recording may not know by a factor of a thousand.
            bounds = (fields.get("bounds") or {}) if determined else {}
            others = fields.get("other_fits") if determined else None
            found[fields["name"]] = Quantity(
                fields["name"],
                fields["unit"],
                determined,
                fields["value"] if determined else None,
                bounds.get("lower"),
                bounds.get("upper"),
                None if others is None else (others["least"], others["most"]),
            )
        return found

    @property
    def run_offsets(self) -> tuple[float, ...]:
        """What the offset of each run is above their mean; empty where the runs have one offset."""
        return tuple(self._fields.get("run_offsets", ()))

    @property
    def fit(self) -> dict[str, float]:
        """How well it follows the record, and what it had not seen of it, as in the document."""
        return dict(self._fields["fit"])

    def to_dict(self) -> dict[str, Any]:
        """The part ``servo_model`` of the document."""
        import copy

        return copy.deepcopy(self._fields)

    def simulate(self, u: Any, *, at_rest: float | None = None, controller: float | None = None) -> ServoResponse:
        """The response to an input, from rest.

        Parameters
        ----------
        u : array_like
            The input at the model's sample period.
        at_rest : float, optional
            The input before the first sample, at which the servo had come to rest; without it, the first value of ``u``.
        controller : float, optional
            The controller, where the model has several.

        Returns
        -------
        ServoResponse
            The position, ``value``, and a band about it, at each sample by itself. At first the servo is in the middle of where friction, a dead band or play may
            hold it, and the band has all of that. The band is withdrawn where the command runs further ahead of the servo than in the recording.

        Raises
        ------
        ServoidError
            The input is no column of numbers or lacks a sample; there is no such controller.
        """
        column = samples("input", u)
        at_rest, controller = command_or_none("at_rest", at_rest), number_or_none("controller", controller)
        if at_rest is not None:
            column = np.concatenate([[at_rest], column])
        value, half_width, reason = self._core.servo_response(column, controller)
        if at_rest is not None:
            value, half_width = value[1:], None if half_width is None else half_width[1:]
        if half_width is None:
            return ServoResponse(value, None, None, None if reason is None else Withdrawn(*reason))
        return ServoResponse(value, value - half_width, value + half_width, None)

    def plot(
        self, u: Any, ax: Any = None, *, at_rest: float | None = None, controller: float | None = None, label: str = "servo model"
    ) -> Any:
        """Draw the response to an input with its band, as :meth:`simulate` gives them. Needs matplotlib.

        Parameters
        ----------
        u : array_like
            The input at the model's sample period.
        ax : matplotlib Axes, optional
            Where to draw; a new figure without it.
        at_rest, controller : float, optional
            As in :meth:`simulate`.
        label : str
            Name in the legend.

        Returns
        -------
        matplotlib Axes

        Examples
        --------
        >>> import servoid
        >>> stairs = servoid.simulate("bench", reference="stairs", amplitude=20, length=20)
        >>> servo = servoid.identify(stairs, servo_model=True).servo_model
        >>> ax = servo.plot([0.0] * 10 + [10.0] * 90)
        """
        from ._plot import servo_response

        return servo_response(self, self.simulate(u, at_rest=at_rest, controller=controller), ax, label)

    def at(self, hertz: float, amplitude: float, *, controller: float | None = None) -> SineResponse:
        """How much of a sine of the command arrives, and how late: gain and phase, as ``servoid identify --at HZ:AMPLITUDE`` prints them.

        A servo that is limited has others for each amplitude. Both are of the first harmonic of the motion, about the middle of the recorded commands. The sine is
        smooth: one that is held for frames is half a frame later.

        Parameters
        ----------
        hertz : float
            Frequency (Hz).
        amplitude : float
            How far the sine goes to each side (unit of the command).
        controller : float, optional
            The controller, where the model has several.

        Returns
        -------
        SineResponse
            Its bounds are withdrawn where the command runs further ahead of the servo than in the recording, and where that leaves the phase open by a
            turn or more.

        Raises
        ------
        ServoidError
            Frequency or amplitude are not above 0; there is no such controller.

        Examples
        --------
        >>> import servoid
        >>> stairs = servoid.simulate("bench", reference="stairs", amplitude=20, length=20)
        >>> servo = servoid.identify(stairs, servo_model=True).servo_model
        >>> small, large = servo.at(8, 1), servo.at(8, 20)
        >>> large.gain.value < small.gain.value
        True
        """
        asked = sine_argument("hertz", hertz), sine_argument("amplitude", amplitude)
        found, reason = self._core.servo_sine(*asked, number_or_none("controller", controller))
        because = self.withdrawn if reason is None else Withdrawn(*reason)
        return sine(*asked, None, found, self.level, because)

    def __reduce__(self) -> tuple[Any, ...]:
        return (_of_document, (self._core.document,))

    def __repr__(self) -> str:
        names = ", ".join(name for name, found in self.quantities.items() if found.determined)
        reason = self.withdrawn
        known = f"determined: {names}" if reason is None else f"no intervals, because {reason.because}; values of: {names}"
        return f"<ServoModel: predicts {self.fit['held_out_percent']:.1f} % of what it had not seen; {known}>"


def _name(coordinate: str | dict[str, int]) -> str:
    """A coordinate in one word: that of a further controller has its number."""
    if isinstance(coordinate, str):
        return coordinate
    return "_".join(f"{word}_{number}" for word, number in coordinate.items())


def _of_document(text: str) -> ServoModel:
    """The servo model in the document of a model."""
    return ServoModel(json.loads(text)["servo_model"], _servoid.Model.parse(text, "the document"))

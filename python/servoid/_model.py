"""The model of an identification, and its parts."""

from __future__ import annotations

import json
import os
import warnings
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _servoid
from ._arrays import (
    command_or_none,
    flag,
    is_list_of_runs,
    number_or_none,
    path_of,
    samples,
    word,
    word_or_none,
)
from ._document import Column, Document, column, column_or_none, write_new
from ._draws import DRAWN, normal
from ._export import Export, export
from ._flight_model import FlightModel
from ._interval import Interval, interval
from ._servo_model import ServoModel
from ._sine import SineResponse, sine, sine_argument
from ._withdrawn import Withdrawn, withdrawn

if TYPE_CHECKING:
    from ._comparison import Validation

NOT_LINEAR = "the servo is not linear: these are responses to motion as it was recorded, and other motion has others"


@dataclass(frozen=True)
class Metrics:
    """Gain, times and frequencies of the response, each with its interval; times count from the edge of the command.

    Attributes
    ----------
    dc_gain : Interval
        Final value of the step response (output per input).
    delay_s, t50_s, rise_time_s, settling_time_s : Interval
        Time to 5 %, to 50 %, from 10 to 90 %, and until the response stays within 2 % (s).
    overshoot_percent : Interval
        Highest point above the final value (% of it).
    bandwidth_rad_s, phase_minus_90_rad_s : Interval
        Where the magnitude has fallen by 3 dB, and where the phase reaches -90 degrees (rad/s).
    withheld : str or None
        Why metrics are left out.
    level : float or None
        Level of the intervals; ``None`` where bounds are withdrawn.
    """

    dc_gain: Interval
    delay_s: Interval
    t50_s: Interval
    rise_time_s: Interval
    settling_time_s: Interval
    overshoot_percent: Interval
    bandwidth_rad_s: Interval
    phase_minus_90_rad_s: Interval
    withheld: str | None
    level: float | None


@dataclass(frozen=True, eq=False)
class StepResponse:
    """Response to a unit step of the command.

    Attributes
    ----------
    time_s, value : ndarray
        Time since the step, counted in samples (s), and the response (output per input). The last value is the final one, the gain, to which
        the response goes after that time, and not the response at it. Time since the edge of the command is
        ``time_s + model.sample_phase_s``, as in :meth:`Model.plot` and in all metrics.
    level : float or None
        Level of the bounds; ``None`` where they are withdrawn, and with it all that follows.
    lower, upper : ndarray or None
        Bounds for the whole curve at once. The last ones hold the final value and the response at that time.
    pointwise_lower, pointwise_upper : ndarray or None
        Bounds for each point by itself. The last ones are those of the final value alone.
    sd : ndarray or None
        Standard deviation of each value.
    """

    time_s: Column
    value: Column
    level: float | None
    lower: Column | None
    upper: Column | None
    pointwise_lower: Column | None
    pointwise_upper: Column | None
    sd: Column | None


@dataclass(frozen=True, eq=False)
class FrequencyResponse:
    """Response of the samples to sines.

    Attributes
    ----------
    omega_rad_s : ndarray
        Frequencies (rad/s).
    response : ndarray of complex
        Gain and phase as complex numbers (output per input).
    magnitude_db, phase_deg : ndarray
        The same in decibels and in degrees of phase, with the hold of the command between two samples; :attr:`Model.servo_frequency` is
        without.
    level : float or None
        Level of the bounds, which hold at each frequency by itself, those of the phase but for whole turns; ``None`` where they are withdrawn, and with it the bounds of magnitude and phase.
    """

    omega_rad_s: Column
    response: NDArray[np.complex128]
    magnitude_db: Column
    phase_deg: Column
    level: float | None
    magnitude_db_lower: Column | None
    magnitude_db_upper: Column | None
    phase_deg_lower: Column | None
    phase_deg_upper: Column | None


@dataclass(frozen=True)
class Structure:
    """Settling time N (samples), number of frequencies n, noise order d, and who chose them."""

    settling_samples: int
    frequencies: int
    noise_order: int
    selected_by: str


@dataclass(frozen=True)
class Fit:
    """How well the model reproduces its record: 100 (1 - norm(y - ŷ) / norm(y - mean of y)), and the error (rms, unit of the output)."""

    simulation_percent: float
    one_step_percent: float
    rmse: float
    samples_used: int
    samples_missing: int


@dataclass(frozen=True)
class Noise:
    """Autoregressive noise 1/D(z): d_1, d_2, ... of D, and the standard deviation of its white part."""

    ar: tuple[float, ...]
    sigma: float


@dataclass(frozen=True)
class Residuals:
    """Probabilities of the tests of the residuals; ``None`` where a test was not possible."""

    whiteness_p: float | None
    input_correlation_p: float | None
    linearity_p: float | None


@dataclass(frozen=True)
class Advice:
    """A finding about data or model.

    Attributes
    ----------
    check : str
        A stable name.
    finding, do : str
        What was found, and what to do.
    value, threshold : float or None
        What was measured, and the limit that it is beyond.
    """

    check: str
    finding: str
    value: float | None
    threshold: float | None
    do: str


def advice(fields: dict[str, Any]) -> tuple[Advice, ...]:
    """The findings of a document."""
    said = _servoid.with_arguments_for_options
    return tuple(
        Advice(item["check"], said(item["finding"]), item.get("value"), item.get("threshold"), said(item["do"]))
        for item in fields.get("advice", ())
    )


_METRICS = (
    "dc_gain",
    "delay_s",
    "t50_s",
    "rise_time_s",
    "settling_time_s",
    "overshoot_percent",
    "bandwidth_rad_s",
    "phase_minus_90_rad_s",
)


def metrics(fields: dict[str, Any]) -> Metrics:
    """The metrics of a document."""
    level = (fields["bounds"] or {}).get("level")
    intervals = {name: interval(fields[name]) for name in _METRICS}
    return Metrics(**intervals, withheld=fields["withheld"], level=level)


def step_response(fields: dict[str, Any]) -> StepResponse:
    """The step response of a document."""
    bounds = fields["bounds"] or {}
    whole, each = bounds.get("simultaneous", {}), bounds.get("pointwise", {})
    return StepResponse(
        column(fields["time_s"]),
        column(fields["value"]),
        bounds.get("level"),
        column_or_none(whole.get("lower")),
        column_or_none(whole.get("upper")),
        column_or_none(each.get("lower")),
        column_or_none(each.get("upper")),
        column_or_none(bounds.get("sd")),
    )


def frequency_response(found: dict[str, Any]) -> FrequencyResponse:
    """The frequency response of a document."""
    bounds = found["bounds"] or {}
    response = np.array(found["re"]) + 1j * np.array(found["im"])
    response.flags.writeable = False
    return FrequencyResponse(
        column(found["omega_rad_s"]),
        response,
        column(found["magnitude_db"]),
        column(found["phase_deg"]),
        bounds.get("level"),
        column_or_none(bounds.get("magnitude_db_lower")),
        column_or_none(bounds.get("magnitude_db_upper")),
        column_or_none(bounds.get("phase_deg_lower")),
        column_or_none(bounds.get("phase_deg_upper")),
    )


class Model(Document):
    """A servo as it was identified. :func:`identify` gives it, and :meth:`load` reads it from a file.

    Attributes are those of the document (docs/results.md), as objects with arrays.

    Examples
    --------
    >>> import servoid
    >>> model = servoid.identify(servoid.simulate("bench"))
    >>> model.level, model.withdrawn
    (0.99, None)
    >>> bool((model.step.lower <= model.step.upper).all())
    True
    """

    _core: _servoid.Model

    def __init__(self, core: _servoid.Model) -> None:
        super().__init__(core.document)
        self.__dict__["_core"] = core

    @property
    def remarks(self) -> tuple[str, ...]:
        """How the data were read, and what became of a prior that is not used."""
        return tuple(_servoid.with_arguments_for_options(remark) for remark in self._fields.get("remarks", ()))

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Model:
        """Read a model that :meth:`save` or ``servoid identify -o`` has written.

        Parameters
        ----------
        path : path
            The file.

        Returns
        -------
        Model

        Raises
        ------
        ServoidError
            The file is no model, contradicts itself, or was made by a newer servoid.
        """
        return cls(_servoid.Model.read(path_of("path", path, "the path of a file that model.save() has written")))

    @classmethod
    def from_json(cls, text: str) -> Model:
        """The model of a document, as :meth:`load` reads it from a file.

        Parameters
        ----------
        text : str
            The document.

        Returns
        -------
        Model

        Raises
        ------
        ServoidError
            As :meth:`load`.
        """
        return cls(_servoid.Model.parse(word("text", text, "the JSON of a model as a text"), "the document"))

    def __reduce__(self) -> tuple[Any, ...]:
        return (Model.from_json, (self._text,))

    @property
    def sample_period_s(self) -> float:
        """Time between samples (s)."""
        return float(self._fields["sample_period_s"])

    @property
    def sample_phase_s(self) -> float:
        """From an edge of the command to the first sample that follows it (s)."""
        return float(self._fields.get("sample_phase_s", 0.0))

    @property
    def units(self) -> dict[str, str]:
        """Units of ``input`` and ``output``, where they are known."""
        return dict(self._fields.get("units", {}))

    @property
    def structure(self) -> Structure:
        """Settling time, number of frequencies and noise order."""
        return Structure(**self._fields["structure"])

    @cached_property
    def theta(self) -> Column:
        """G_0, Re G_1, Im G_1, ... (output per input)."""
        return column(self._fields["theta"])

    @cached_property
    def covariance(self) -> Column | None:
        """Covariance of :attr:`theta`; ``None`` where bounds are withdrawn."""
        return column_or_none((self._fields["bounds"] or {}).get("covariance"))

    @property
    def level(self) -> float | None:
        """Level of all bounds; ``None`` where they are withdrawn."""
        level: float | None = (self._fields["bounds"] or {}).get("level")
        return level

    @property
    def withdrawn(self) -> Withdrawn | None:
        """Why no bounds can be given; ``None`` where they hold."""
        return withdrawn(self._fields)

    @property
    def linear(self) -> bool:
        """Whether the servo is called linear.

        It is not where something was found that makes the response one of this motion alone (``linear`` of the document), nor where
        a servo model that is not linear predicts the recording better.
        """
        return self._core.linear

    @property
    def offset(self) -> float:
        """Output with the input at 0."""
        return float(self._fields["offset"])

    @property
    def noise(self) -> Noise:
        """The noise of the output."""
        found = self._fields["noise"]
        return Noise(tuple(found["ar"]), found["sigma"])

    @cached_property
    def step(self) -> StepResponse:
        """Response to a unit step."""
        return step_response(self._fields["step"])

    @cached_property
    def frequency(self) -> FrequencyResponse:
        """Frequency response."""
        return frequency_response(self._fields["frequency"])

    @cached_property
    def _servo_frequency(self) -> tuple[FrequencyResponse, slice]:
        document, shown = self._core.servo_frequency()
        return frequency_response(json.loads(document)), slice(*shown)

    @property
    def servo_frequency(self) -> FrequencyResponse:
        """Frequency response of the servo alone, without the hold of the command and the phase of the samples, as in reports.

        The phase goes on from point to point without jumps. Behind frequencies at which noise hides the magnitude, as where its lower bound is 0
        or far below the value, it may be off by whole turns; :meth:`plot_bode` leaves those out.
        """
        return self._servo_frequency[0]

    @cached_property
    def metrics(self) -> Metrics:
        """Gain, delay, rise time and the like, with intervals."""
        return metrics(self._fields["metrics"])

    @property
    def fit(self) -> Fit:
        """How well the model reproduces its record."""
        return Fit(**{name: self._fields["fit"][name] for name in Fit.__dataclass_fields__})

    @property
    def residuals(self) -> Residuals:
        """Tests of the residuals."""
        found = self._fields["residuals"]
        return Residuals(*(found.get(name) for name in Residuals.__dataclass_fields__))

    @property
    def advice(self) -> tuple[Advice, ...]:
        """Findings, and what to do about them."""
        return advice(self._fields)

    @cached_property
    def servo_model(self) -> ServoModel | None:
        """The servo as a machine, where it was looked for and found."""
        found = self._fields.get("servo_model")
        return None if found is None else ServoModel(found, self._core)

    @property
    def no_servo_model(self) -> str | None:
        """Why there is no servo model though one was looked for."""
        reason = self._fields.get("no_servo_model")
        return None if reason is None else _servoid.with_arguments_for_options(reason)

    @property
    def flight_model(self) -> FlightModel | None:
        """The low-order model (``flight_model=True``; of a sweep it is fitted by itself), with its intervals.

        Its covariance is that of [K, L, ln ω, ln ζ, ln T].
        """
        found: dict[str, Any] | None = self.to_dict().get("flight_model")
        return None if found is None else FlightModel(found, self._core.flight_summary or "")

    @property
    def explanation(self) -> dict[str, Any] | None:
        """The choice of the structure (``explain=True``), as in the document."""
        found: dict[str, Any] | None = self.to_dict().get("explanation")
        return found

    @property
    def limits(self) -> dict[str, Any] | None:
        """Rate limits, hysteresis and ends of the travel (``limits=True``), as in the document."""
        found: dict[str, Any] | None = self.to_dict().get("limits")
        return found

    @property
    def impulse_response(self) -> Column:
        """Differences of the step response from sample to sample (output per input)."""
        return column(np.diff(self.step.value, prepend=0.0))

    def draws(self, count: int, *, seed: int | None = None) -> Column:
        """Step responses at random, as the recording leaves them open: for a simulation of many servos (Monte Carlo).

        They are normally distributed in :attr:`theta`, with :attr:`covariance`. The bounds are wider by what left-out frequencies and the steps of
        the sensor may hide. A position is the convolution of a command with the differences of a response from sample to sample.

        Parameters
        ----------
        count : int
            How many.
        seed : int, optional
            For the same draws again.

        Returns
        -------
        ndarray
            `count` rows, each as :attr:`step` has its values.

        Raises
        ------
        ServoidError
            Bounds are withdrawn, so there is no covariance.

        Examples
        --------
        >>> import numpy as np, servoid
        >>> model = servoid.identify(servoid.simulate("linear"))
        >>> draws = model.draws(1000, seed=1)
        >>> bool(np.allclose(draws.std(axis=0)[40:60], model.step.sd[40:60], rtol=0.1))
        True
        """
        rows = normal(self.theta, self.covariance, count, seed, self.withdrawn)
        if not self.linear:
            warnings.warn(NOT_LINEAR, stacklevel=2)
        taps = len(self.step.value)
        harmonics = np.arange(1, (rows.shape[1] + 1) // 2)
        turned = 2.0 * np.pi * np.outer(harmonics, np.arange(taps)) / taps
        cosines, sines = (2.0 * of(turned) / taps for of in (np.cos, np.sin))
        impulse = rows[:, :1] / taps + rows[:, 1::2] @ cosines - rows[:, 2::2] @ sines
        found: Column = np.cumsum(impulse, axis=1)
        return found

    @property
    def summary(self) -> str:
        """The text that the command line prints."""
        return self._core.summary

    def simulate(self, u: Any, *, at_rest: float | None = None) -> Any:
        """The output that the linear model gives for an input.

        Each command is held until the next sample. Where :attr:`linear` is ``False``, or :attr:`withdrawn` is not ``None``, this is a
        picture of the recording, and the servo may answer otherwise: take ``servo_model.simulate()`` where there is a servo model.

        Parameters
        ----------
        u : array_like, or list of them
            The input at the model's sample period, NaN where it is missing; several runs as a list.
        at_rest : float, optional
            The input during at least the settling time before the first sample.

        Returns
        -------
        ndarray, or list of them
            The output, NaN where the history of the input is not known: at the beginning without ``at_rest``.

        Raises
        ------
        ServoidError
            The input is no column of numbers.

        Examples
        --------
        >>> import servoid
        >>> model = servoid.identify(servoid.simulate("linear"))
        >>> y = model.simulate([1.0] * len(model.step.value), at_rest=0.0)
        >>> bool(abs(y - model.offset - model.step.value).max() < 1e-9)
        True
        """
        if self._is_drawn():
            warnings.warn("the linear model of a draw is that of the estimate: draw.servo_model.simulate has the servo that was drawn", stacklevel=2)
        if is_list_of_runs(u):
            return [self.simulate(one, at_rest=at_rest) for one in u]
        return self._core.simulate(samples("input", u), command_or_none("at_rest", at_rest))

    def at(self, hertz: float) -> SineResponse:
        """How much of a sine of the command arrives, and how late: gain and phase, as ``servoid identify --at HZ`` prints them.

        They are those of the servo in continuous time, as :attr:`servo_frequency` is. Of a servo that is not linear
        they are those of the recorded motion: ``servo_model.at(hertz, amplitude)`` has those of an amplitude. Whether a servo is linear, strokes of one
        size do not show: theirs is what these are then (``of_strokes``), and a sine is answered so by a linear servo alone. Without bounds it warns,
        and says why there are none.

        Parameters
        ----------
        hertz : float
            Frequency (Hz).

        Returns
        -------
        SineResponse

        Raises
        ------
        ServoidError
            The frequency is not above 0, or the recording does not show the response there.

        Examples
        --------
        >>> import servoid
        >>> found = servoid.identify(servoid.simulate("linear")).at(3)
        >>> found.gain.lower < found.gain.value < found.gain.upper, found.late_ms > 0
        (True, True)
        """
        hertz = sine_argument("hertz", hertz)
        found, why = self._core.sine(hertz)
        if found is None:
            of_amplitude = "" if self.servo_model is None else "; servo_model.at(hertz, amplitude) has that of the servo as a machine"
            raise _servoid.ServoidError(f"there is no response at {hertz:g} Hz: {why}{of_amplitude}")
        bounds = self.frequency.level
        withdrawn = self.withdrawn if bounds is None else None
        if withdrawn is not None:
            withdrawn.warn()
        elif not self.linear:
            warnings.warn(f"{NOT_LINEAR}: servo_model.at(hertz, amplitude) has those of an amplitude", stacklevel=2)
        return sine(hertz, None, self._fields.get("only_stroke"), found, bounds, withdrawn)

    def predict(self, u: Any, y: Any = None, *, at_rest: float | None = None) -> Any:
        """The output predicted one step ahead from the input and the measured output; without ``y``, :meth:`simulate`.

        Parameters
        ----------
        u, y : array_like, or lists of them
            Input and measured output at the model's sample period, NaN where a sample is missing.
        at_rest : float, optional
            The input during at least the settling time before the first sample.

        Returns
        -------
        ndarray, or list of them
            The predicted output, NaN where the past is not known.

        Raises
        ------
        ServoidError
            The columns have different lengths, or are no numbers.
        """
        if y is None:
            return self.simulate(u, at_rest=at_rest)
        if is_list_of_runs(u):
            if not (is_list_of_runs(y) and len(y) == len(u)):
                raise _servoid.ServoidError("u has several runs: give y as a list of as many arrays")
            return [self.predict(one, other, at_rest=at_rest) for one, other in zip(u, y)]
        return self._core.predict(samples("input", u), samples("output", y), command_or_none("at_rest", at_rest))

    def validate(self, *source: Any, **options: Any) -> Validation:
        """Compare the model with data that it was not identified from; see :func:`servoid.validate`."""
        from ._comparison import validate

        return validate(self, *source, **options)

    def plot(self, ax: Any = None, *, label: str = "step response") -> Any:
        """Draw the step response with its band. Needs matplotlib.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Where to draw; a new figure without it.
        label : str
            Name in the legend.

        Returns
        -------
        matplotlib Axes
        """
        from ._plot import step

        return step(self, ax, label)

    def plot_bode(self, axes: Any = None, *, label: str = "servo") -> Any:
        """Draw magnitude and phase of :attr:`servo_frequency` over the frequency in Hz, with their bounds. Needs matplotlib.

        Frequencies from the first one on at which any phase is possible are left out.

        Parameters
        ----------
        axes : pair of matplotlib Axes, optional
            Where to draw magnitude and phase; a new figure without it.
        label : str
            Name in the legend.

        Returns
        -------
        pair of matplotlib Axes
        """
        from ._plot import bode

        response, shown = self._servo_frequency
        return bode(self, response, shown, axes, label)

    def report(self, path: str | os.PathLike[str], *, title: str | None = None, force: bool = False) -> None:
        """Write the page of ``servoid report`` on this model: one HTML file that needs no network.

        A page on a recording, which ``servoid report RECORDING.csv`` writes, also has what needs the samples: the fit, the residuals and
        the scatter of runs.

        Parameters
        ----------
        path : path
            The file.
        title : str, optional
            Title of the page.
        force : bool
            Replace a file that exists.

        Raises
        ------
        FileExistsError
            The file exists, and ``force`` is not set.
        """
        write_new(path, self._core.report(self._stem(), word_or_none("title", title)), force)

    def export(
        self,
        to: str,
        path: str | os.PathLike[str] | None = None,
        *,
        servo_model: bool | None = None,
        controller: float | None = None,
        step_ms: float | None = None,
        full_command: float | None = None,
        frame_ms: float | None = None,
        name: str | None = None,
        force: bool = False,
    ) -> Export:
        """The model as a file for another program, as ``servoid export`` writes it.

        Parameters
        ----------
        to : {"matlab", "python", "julia", "c", "csv", "jsbsim", "ardupilot", "mujoco"}
            The program; the last two take the servo model.
        path : path, optional
            Where to write the file; without it, the text is in the result alone.
        servo_model : bool, optional
            The servo as a machine in place of the linear model; without it, that of a draw of a servo model alone.
        controller : float, optional
            The controller of the servo model, where it has several.
        step_ms : float, optional
            Step of time of the servo model in the file (ms).
        full_command : float, optional
            The command that fully deflects a servo of ArduPilot (unit of the command).
        frame_ms : float, optional
            Pulse frame, which holds a command (ms); 0 where commands take effect at once.
        name : str, optional
            Name of the servo in the file; without it, that of the model's file or data.
        force : bool
            Replace a file that exists.

        Returns
        -------
        Export
            The text, and what to know of it: remarks, warnings and the largest difference.

        Raises
        ------
        ServoidError
            There is no such target, no such model, or the options do not fit.
        FileExistsError
            The file exists, and ``force`` is not set.

        Examples
        --------
        >>> import servoid
        >>> header = servoid.identify(servoid.simulate("linear")).export("c", name="rudder")
        >>> "rudder_impulse" in header.text
        True
        """
        found = export(
            self._core,
            {
                "to": word("to", to, 'the name of a program, such as "matlab"'),
                "servo_model": self._is_drawn() if servo_model is None else flag("servo_model", servo_model),
                "controller": number_or_none("controller", controller),
                "step_ms": number_or_none("step_ms", step_ms, "a number of milliseconds"),
                "full_command": number_or_none("full_command", full_command),
                "frame_ms": number_or_none("frame_ms", frame_ms, "a number of milliseconds"),
                "name": word_or_none("name", name) or self._stem(),
                "source": os.path.basename(self._core.name),
            },
        )
        if path is not None:
            found.save(path, force=force)
        return found

    def _is_drawn(self) -> bool:
        """Whether it is one of the servos that a servo model leaves open: its linear model is that of the estimate."""
        return self._core.name.endswith(DRAWN)

    def _stem(self) -> str:
        return os.path.splitext(os.path.basename(self._core.name.removesuffix(DRAWN)))[0]

    def to_control(self, kind: str = "frd") -> Any:
        """The model as an object of python-control.

        Parameters
        ----------
        kind : {"frd", "tf", "ss", "flight"}
            ``"frd"``: the frequency response of the servo alone, for continuous loops (:attr:`servo_frequency`). ``"tf"`` and ``"ss"``: the step response's own discrete system, as a transfer
            function and in state space. ``"flight"``: the continuous low-order model, its delay by a Padé approximation of third
            order (identify with ``flight_model=True``). What has no bounds comes with a warning that says why.

        Returns
        -------
        control.FRD, control.TransferFunction or control.StateSpace
            Output per input; the offset is left out.

        Raises
        ------
        ServoidError
            There is no such kind, no low-order model, or, of ``"frd"``, no frequency response that the recording shows.
        """
        from ._control import to_control

        found, withdrawn, what = to_control(self, kind)
        if withdrawn is not None:
            withdrawn.warn(what)
        return found

    def __repr__(self) -> str:
        if self.withdrawn:
            bounds = f"no bounds: {self.withdrawn.because}"
        else:
            bounds = f"bounds at {100 * float(self.level or 0):g} %"
        findings = len(self.advice)
        notes = f", {findings} finding{'s' if findings != 1 else ''} in .advice" if findings else ""
        lines = [f"<Model of {self._core.name} ({bounds}{notes})>"]
        if self._core.servo_sentence is not None:
            lines.append(self._core.servo_sentence + " It is in .servo_model.")
        lines += [self._core.sentence, *self.remarks]
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        return f"<pre>{_escaped(repr(self))}</pre>\n{self._core.step_svg()}"


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")

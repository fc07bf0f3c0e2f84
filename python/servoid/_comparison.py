"""Comparison of two sides, and validation of a model."""

from __future__ import annotations

from typing import Any

from . import _servoid
from ._arrays import flag_or_none, number, number_or_none, unexpected
from ._difference import (
    Asymmetry,
    DifferenceCurve,
    LargestDifference,
    MetricDifference,
    OverPrediction,
    bounded,
    difference_curve,
    metric_difference,
    over_prediction,
)
from ._document import Printed
from ._interval import Interval
from ._model import Advice, Model, advice
from ._recording import READ_OPTIONS, as_recording
from ._recording import recording as of_arrays
from ._withdrawn import Withdrawn, withdrawn


class Comparison(Printed):
    """The comparison of two servos, or of one under two conditions. :func:`compare` gives it.

    Servos that are compared as machines alone have :attr:`servo_model`, and no curves, metrics or differences.

    Examples
    --------
    >>> import servoid
    >>> found = servoid.compare(servoid.simulate("bench"), servoid.simulate("aircraft"))
    >>> found.largest_difference.at_least > found.margin_percent
    True
    >>> found.differences["dc_gain"].difference.upper < 0
    True
    """

    @property
    def verdict(self) -> str:
        """``"different"``, ``"same"`` or ``"undecided"``, against :attr:`margin_percent`: of the step responses alone.

        How the servos differ as machines is in :attr:`servo_model`, and in the text of ``print(comparison)``.
        Sides with different references are never ``"different"``: that may be the reference and not the servo. A difference that
        waits for pulses may make is ``"undecided"``, too: :attr:`may_be_waits`.
        """
        return str(self._fields["verdict"])

    @property
    def may_be_waits(self) -> bool:
        """Whether the responses may differ by the wait for pulses alone, of up to a frame, that each recording may have in all of its times.

        Three runs a side have bounds that contain these; ``exact_command=True`` states that no command waits.
        """
        return bool(self._fields.get("may_be_waits"))

    @property
    def margin_percent(self) -> float:
        """The largest difference that still counts as the same (% of the step)."""
        return float(self._fields["margin_percent"])

    @property
    def level(self) -> float | None:
        """Level of every bound; ``None`` where they are withdrawn."""
        level: float | None = (self._fields["bounds"] or {}).get("level")
        return level

    @property
    def withdrawn(self) -> Withdrawn | None:
        """Why there are no bounds, and so no verdict; ``None`` where they hold."""
        return withdrawn(self._fields)

    @property
    def difference_percent(self) -> tuple[float, float] | None:
        """The largest difference of the step responses is at least and at most this (% of the step); ``None`` without bounds."""
        bounds = self._fields["bounds"]
        if bounds is None:
            return None
        found = bounds["difference_percent"]
        return found["at_least"], found["at_most"]

    @property
    def largest_difference(self) -> LargestDifference | None:
        """The same with its time and its strokes; ``None`` without bounds."""
        bounds = self._fields["bounds"]
        return None if bounds is None else LargestDifference(**bounds["difference_percent"])

    @property
    def delay_shift_s(self) -> Interval | None:
        """By how much the second side is later (s): the delay that brings the step responses closest; ``None`` where there are none."""
        value = self._fields.get("delay_shift_s")
        bounds = (self._fields["bounds"] or {}).get("delay_shift_s")
        return None if value is None else bounded(value, bounds)

    @property
    def differences(self) -> dict[str, MetricDifference]:
        """The metrics of both sides and their differences b - a, by the names that they have in :class:`Metrics`."""
        return {row["metric"]: metric_difference(row) for row in self._fields.get("differences", ())}

    @property
    def curves(self) -> dict[str, DifferenceCurve]:
        """Difference of the step responses: of ``"both"`` directions together, or of ``"up"`` and ``"down"`` apart where they differ."""
        return {fields["stroke"]: difference_curve(fields) for fields in self._fields.get("curves", ())}

    @property
    def over_prediction(self) -> OverPrediction | None:
        """By how much the first model predicts more motion than the second side has; ``None`` where that cannot be said."""
        return over_prediction(self._fields.get("over_prediction"))

    @property
    def asymmetry(self) -> dict[str, Asymmetry]:
        """How up and down strokes of the sides ``"a"`` and ``"b"`` differ; empty of models, and without bounds."""
        found = self._fields.get("asymmetry") or {}
        return {side: Asymmetry(**fields) for side, fields in found.items()}

    @property
    def runs(self) -> tuple[int, int] | None:
        """Number of runs of either side; ``None`` where servos are compared as machines alone."""
        found = self._fields.get("runs")
        return None if found is None else (found[0], found[1])

    @property
    def same_data(self) -> bool:
        """Whether both sides have samples in common: then the comparison says nothing about the servos."""
        return bool(self._fields.get("same_data"))

    @property
    def turns_the_other_way(self) -> bool:
        """Whether the second side surely turns the other way under the same command."""
        return bool(self._fields.get("turns_the_other_way"))

    @property
    def descriptions_of_different_motions(self) -> bool:
        """Whether the sides were asked for different motions, so that the difference may be that of the motions."""
        return bool(self._fields.get("descriptions_of_different_motions"))

    @property
    def servo_model(self) -> dict[str, Any] | None:
        """The servo models of both sides, where they are compared, as in the document.

        ``["bounds"]["differences"]`` is a list with the intervals of ``"a"``, of ``"b"`` and of their ``"difference"`` for each quantity (``"name"``);
        ``["bounds"]`` is ``None`` where a side has no intervals.
        """
        found: dict[str, Any] | None = self.to_dict().get("servo_model")
        return found

    @property
    def no_servo_model(self) -> str | None:
        """Why servo models are not compared though they were looked for."""
        reason: str | None = self._fields.get("no_servo_model")
        return reason

    @property
    def of(self) -> str:
        """What the verdict is of: ``"runs"`` (these recordings), or ``"servos"`` with three or more runs a side."""
        return str(self._fields["of"])

    @property
    def advice(self) -> tuple[Advice, ...]:
        """What the recordings cannot answer."""
        return advice(self._fields)

    def plot(self, ax: Any = None, *, label: str = "second less first") -> Any:
        """Draw the :attr:`curves`: the difference of the step responses, with its band. Needs matplotlib.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Where to draw; a new figure without it.
        label : str
            Name in the legend.

        Returns
        -------
        matplotlib Axes

        Raises
        ------
        ServoidError
            The servos were compared as machines alone: ``a.servo_model.plot(u)`` and ``b.servo_model.plot(u, ax)`` draw how these move.
        """
        from ._plot import differences

        if not self.curves:
            raise _servoid.ServoidError(
                "servos that are compared as machines alone have no curves of step responses: draw both under one command with servo_model.plot(u)"
            )
        return differences(self, ax, label)

    def __repr__(self) -> str:
        of_models = self._fields.get("motions", ()) is None
        of = "the servos" if self.of == "servos" else "these models" if of_models else "these recordings"
        head = f"<Comparison: {self.verdict} (of {of}; margin {self.margin_percent:g} %)>"
        # Where machines say more than step responses, they come first.
        answer = next((part for part in self.summary.split("\n\n") if not part.startswith("A  ")), self._fields["summary"])
        return f"{head}\n{' '.join(answer.split())}"


class Validation(Printed):
    """How well a model predicts data that it was not identified from. :func:`validate` gives it."""

    def __init__(self, document: str, text: str, unit: str | None = None) -> None:
        super().__init__(document, text)
        self.__dict__["_unit"] = unit

    def __reduce__(self) -> tuple[Any, ...]:
        return (Validation, (self._text, self.summary, self._unit))

    @property
    def _unit(self) -> str | None:
        """The unit of the output, where it is known."""
        unit: str | None = self.__dict__["_unit"]
        return unit

    def _linear(self, field: str) -> float | None:
        found = self._fields.get(field)
        return None if found is None else float(found)

    @property
    def fit_percent(self) -> float | None:
        """100 for a perfect prediction, 0 for one no better than the mean (%).

        None, as the others, where the servo model alone can be validated."""
        return self._linear("fit_percent")

    @property
    def rmse(self) -> float | None:
        """Root mean square of the error (unit of the output)."""
        return self._linear("rmse")

    @property
    def bias(self) -> float | None:
        """Mean of measured less predicted (unit of the output)."""
        return self._linear("bias")

    @property
    def samples_used(self) -> int | None:
        """Number of samples with a prediction."""
        found = self._fields.get("samples_used")
        return None if found is None else int(found)

    @property
    def servo_model(self) -> dict[str, Any] | None:
        """The same of the servo model, where there is one."""
        found: dict[str, Any] | None = self.to_dict().get("servo_model")
        return found

    @property
    def error_by_octave(self) -> list[dict[str, float]]:
        """Up to which frequency the models hold: for each octave ``from_hz``, ``to_hz``, ``motion_rms`` of what was measured there, and the errors
        ``linear_rms`` and ``servo_rms``, as far as the file has these models (unit of the output).

        Offsets are left out, and the noise of the sensor is in it. Octaves below ten periods of a run are left out, too; empty where there is none.

        Examples
        --------
        >>> import servoid
        >>> first, second = (servoid.simulate("linear", seed=seed) for seed in (1, 2))
        >>> below_1_hz = servoid.validate(servoid.identify(first), second).error_by_octave[0]
        >>> below_1_hz["linear_rms"] < 0.05 * below_1_hz["motion_rms"]
        True
        """
        found: list[dict[str, float]] = self.to_dict().get("error_by_octave", [])
        return found

    @property
    def advice(self) -> tuple[Advice, ...]:
        """That the model comes from these very samples, and what the files ask for."""
        return advice(self._fields)

    def __repr__(self) -> str:
        advice = "".join(f"\n{item.finding} {item.do}" for item in self.advice)
        return f"<Validation: {'; '.join(self._lines())}>{advice}"

    def _lines(self) -> list[str]:
        linear, servo = (self._fields if "fit_percent" in self._fields else None), self._fields.get("servo_model")
        if servo is None:
            return [self._line(linear)]
        named = (("servo model: ", servo), ("linear model: ", linear))
        return [name + self._line(found) for name, found in named if found is not None]

    def _line(self, found: Any) -> str:
        unit = f" {self._unit}" if self._unit else ""
        error, bias = f"{found['rmse']:.3g}{unit}", f"{found['bias']:+.3g}{unit}"
        return f"fit {found['fit_percent']:.2f} %, error {error} rms, bias {bias}, {found['samples_used']} samples"


def compare(
    a: Any,
    b: Any,
    *,
    margin: float = 5.0,
    level: float = 0.99,
    zero_sd: float = 0.0,
    servo_model: bool | None = None,
    **reading: Any,
) -> Comparison:
    """Compare two servos, or one servo under two conditions.

    Parameters
    ----------
    a, b : Recording, path, list of paths, or Model
        The reference condition and the other: recordings on both sides, or models on both. Recordings give more: up and down
        strokes apart, the rest positions, and with three or more runs a side the scatter of the runs. :func:`recording` makes one
        of arrays.
    margin : float
        The largest difference that still counts as the same (% of the step).
    level : float
        Confidence level of every bound.
    zero_sd : float
        Standard deviation of the sensor's zero between the two sides (unit of the output).
    servo_model : bool, optional
        Also compare the servos as machines. Without it that is done where the step responses leave the verdict open; ``False``
        leaves it out.
    **reading
        Options of :func:`read`, where the sides name files.

    Returns
    -------
    Comparison

    Raises
    ------
    ServoidError
        A side cannot be identified, or the two have different units or sample periods.

    Examples
    --------
    >>> import servoid
    >>> found = servoid.compare(servoid.simulate("bench"), servoid.simulate("aircraft"))
    >>> found.verdict
    'different'
    """
    options = {
        "margin": number("margin", margin, "a number of percent of the step"),
        "level": number("level", level, "a level such as 0.99"),
        "zero_sd": number("zero_sd", zero_sd),
        "servo_model": flag_or_none("servo_model", servo_model),
    }
    unknown = reading.keys() - set(READ_OPTIONS)
    if unknown:
        raise unexpected("compare", unknown)
    if isinstance(a, Model) and isinstance(b, Model):
        return Comparison(*_servoid.compare_models(a._core, b._core, options))
    if isinstance(a, Model) or isinstance(b, Model):
        raise _servoid.ServoidError(
            "one side is a model: compare two models, or recordings on both sides"
        )
    sides = [as_recording(side, dict(reading))._data for side in (a, b)]
    return Comparison(*_servoid.compare(sides[0], sides[1], options))


def validate(
    model: Model, u: Any, y: Any = None, *, at_rest: float | None = None, frame_ms: float | None = None, **reading: Any
) -> Validation:
    """Compare a model with data that it was not identified from.

    Parameters
    ----------
    model : Model
        The model.
    u, y : array_like, or lists of them
        Command and measured motion at the model's sample period. Without ``y``, ``u`` is a :class:`Recording`, or what
        :func:`read` takes; files are read as those of the model were, where the options leave it open.
    at_rest : float, optional
        The input during at least the settling time before each run.
    frame_ms : float, optional
        Time between pulses (ms), where commands waited for them, as in a flight log: each acts from the next pulse on, and the moments of the pulses
        with which the model is closest are taken.
    **reading
        Options of :func:`read`, where ``u`` names files.

    Returns
    -------
    Validation

    Raises
    ------
    ServoidError
        The data have other units or another sample period, or are shorter than the history that the model needs.

    Examples
    --------
    >>> import servoid
    >>> model = servoid.identify(servoid.simulate("bench", seed=1))
    >>> servoid.validate(model, servoid.simulate("bench", seed=2)).fit_percent > 95
    True
    """
    if not isinstance(model, Model):
        raise TypeError(f"a model comes first, and here {type(model).__name__}: read its file with servoid.Model.load(path)")
    if y is None:
        options = dict(reading) if at_rest is None else {"at_rest": at_rest, **reading}
        recording = as_recording(u, options, like=model)
    else:
        if reading:
            raise TypeError(f"validate() of arrays has no argument {sorted(reading)[0]}: they are taken at the period and the phase of the model")
        units = model.units
        recording = of_arrays(
            u,
            y,
            period=model.sample_period_s,
            phase=model.sample_phase_s,
            at_rest=at_rest,
            polled=False,
            exact_command=False,
            controllers=None,
            input_unit=units.get("input"),
            output_unit=units.get("output"),
        )
    unit = recording.output_unit or model.units.get("output")
    return Validation(*_servoid.validate(model._core, recording._data, number_or_none("frame_ms", frame_ms)), unit)

"""Measures how an R/C servo really moves, and says how sure it is.

Two arrays in, a model with bounds out:

>>> import servoid
>>> recording = servoid.simulate("bench", seed=1)
>>> u, y = recording.runs[0]
>>> model = servoid.identify(u, y, period=0.002)
>>> model.metrics.t50_s
Interval(value=0.061..., lower=0.061..., upper=0.061...)

Times are in seconds, frequencies in rad/s, angles in the unit of the recording; units stand in the names. Bounds are `None`
where they do not hold, and `withdrawn` beside them has the reason.
"""

from importlib.metadata import version as _version

from ._comparison import Comparison, Validation, compare, validate
from ._difference import Asymmetry, DifferenceCurve, LargestDifference, MetricDifference, OverPrediction
from ._export import Export
from ._flight_model import FlightModel
from ._interval import Interval
from ._model import (
    Advice,
    Fit,
    FrequencyResponse,
    Metrics,
    Model,
    Noise,
    Residuals,
    StepResponse,
    Structure,
)
from ._plan import Plan, plan
from ._recording import Recording, Run, read, recording
from ._servo_model import Quantity, ServoModel, ServoResponse
from ._servoid import ServoidError
from ._sine import SineResponse
from ._simulate import simulate
from ._identify import identify
from ._withdrawn import Withdrawn

__version__ = _version("servoid")

__all__ = [
    "Advice",
    "Asymmetry",
    "Comparison",
    "DifferenceCurve",
    "Export",
    "Fit",
    "FlightModel",
    "FrequencyResponse",
    "Interval",
    "LargestDifference",
    "MetricDifference",
    "Metrics",
    "Model",
    "Noise",
    "OverPrediction",
    "Plan",
    "Quantity",
    "Recording",
    "Residuals",
    "Run",
    "ServoModel",
    "ServoResponse",
    "ServoidError",
    "SineResponse",
    "StepResponse",
    "Structure",
    "Validation",
    "Withdrawn",
    "compare",
    "identify",
    "plan",
    "read",
    "recording",
    "simulate",
    "validate",
]

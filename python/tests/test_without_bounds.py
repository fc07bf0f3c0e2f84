"""What has no bounds is given with a warning that says why, and what the recording does not show is not given."""

import re
import warnings

import numpy as np
import pytest
import servoid


@pytest.fixture(scope="module")
def short():
    """A settling time that is too short for the servo."""
    return servoid.identify(servoid.simulate("linear"), settling=52)


@pytest.fixture(scope="module")
def sweep():
    """A sweep of pulses of whole microseconds, held for two rows."""
    rows = np.arange(2000)
    u = np.round(1500 + 100 * np.sin(2 * np.pi * 4 / np.log(40) * (40 ** (rows / 2000) - 1)))
    u = np.repeat(u[::2], 2)
    y = np.zeros(len(u))
    for k in rows[1:]:
        y[k] = y[k - 1] + 0.25 * (0.0017 * (u[k - 1] - 1500) - y[k - 1])
    return servoid.identify(u, y + 0.0005 * np.random.default_rng(1).standard_normal(len(u)), period=0.01)


def test_numbers_without_bounds_come_with_the_reason(short, needed):
    assert short.withdrawn is not None and short.metrics.withheld is None
    with pytest.warns(UserWarning, match=short.withdrawn.because) as found:
        assert short.at(3).level is None
    assert found[0].filename == __file__
    needed("control")
    for kind in ("frd", "tf", "ss"):
        with pytest.warns(UserWarning, match=short.withdrawn.because) as found:
            short.to_control(kind)
        assert found[0].filename == __file__


def test_what_the_reference_does_not_excite_is_not_given(sweep, needed):
    assert sweep.withdrawn.reason == "input_unexcited"
    assert sweep.metrics.dc_gain.value is None
    with pytest.raises(servoid.ServoidError, match="leaves part of the response open"):
        sweep.at(2)
    needed("control")
    with pytest.raises(servoid.ServoidError, match="leaves part of the response open"):
        sweep.to_control("frd")
    with pytest.warns(UserWarning, match="does not excite"):
        sweep.to_control("tf")
    assert "there is no low-order model: the reference does not excite" in " ".join(sweep.export("csv").warnings)


def test_what_has_bounds_comes_without_a_warning():
    model = servoid.identify(servoid.simulate("linear"))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        model.at(3)


def test_a_small_gain_has_the_digits_of_its_interval():
    """Of a position in rad for pulses in us, as others are."""
    stairs = servoid.simulate("linear")
    u, y = stairs.runs[0]
    pulses = servoid.recording(1500 + 10 * u, 0.0175 * y, period=stairs.sample_period_s)
    flight = servoid.identify(pulses, flight_model=True).flight_model
    printed = next(line for line in str(flight).splitlines() if "gain K" in line)
    value, lower, upper = re.findall(r"0\.[0-9]+", printed)
    assert float(lower) < float(value) < float(upper), printed
    assert abs(float(value) - flight.gain.value) < 0.1 * (flight.gain.upper - flight.gain.lower)

"""What people see: texts, figures, objects of other packages."""

import numpy as np
import pytest

import servoid


@pytest.fixture(scope="module")
def model():
    return servoid.identify(servoid.simulate("linear"), flight_model=True)


def test_a_model_shows_itself(model):
    assert "99 %" in repr(model) and repr(model).count("\n") <= 3
    html = model._repr_html_()
    assert "<svg" in html and "the whole curve" in html
    assert model.summary.startswith("linear.csv")


def test_a_figure_has_the_band(model, needed):
    needed("matplotlib").use("Agg")
    ax = model.plot()
    (band,) = ax.collections
    highest = band.get_paths()[0].vertices[:, 1].max()
    assert highest == pytest.approx(model.step.upper.max(), rel=1e-12)


def test_control_simulates_as_the_model_does(model, needed):
    control = needed("control")
    u = np.concatenate([np.zeros(5), np.ones(100), np.full(100, -2.0)])
    expected = model.simulate(u, at_rest=0.0) - model.offset
    for kind in ("tf", "ss"):
        found = control.forced_response(model.to_control(kind), inputs=u).outputs
        # Sums of some hundred products of numbers about one.
        np.testing.assert_allclose(found, expected, atol=1e-9)
    frd = model.to_control("frd")
    discrete = model.to_control("tf")
    omega = model.frequency.omega_rad_s
    np.testing.assert_allclose(frd(1j * omega), discrete(np.exp(1j * omega * model.sample_period_s)), atol=1e-6)
    flight = model.to_control("flight")
    assert flight.dcgain() == pytest.approx(model.flight_model["transfer"]["gain"])
    with pytest.raises(servoid.ServoidError, match="choose frd"):
        model.to_control("zpk")


def test_prediction_is_closer_than_simulation():
    u, y = servoid.simulate("bench", seed=3).runs[0]
    model = servoid.identify(servoid.simulate("bench"))
    simulated, predicted = model.simulate(u), model.predict(u, y)
    known = ~np.isnan(simulated) & ~np.isnan(predicted)
    assert np.std((y - predicted)[known]) < np.std((y - simulated)[known])

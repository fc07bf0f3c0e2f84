"""Random servos, as a recording leaves them open."""

import json
import warnings

import numpy as np
import pytest
import servoid
from servoid._draws import normal


@pytest.fixture(scope="module")
def stairs():
    return servoid.simulate("bench", reference="stairs", amplitude=20, length=20)


@pytest.fixture(scope="module")
def model(stairs):
    return servoid.identify(stairs, servo_model=True)


def test_draws_have_mean_and_covariance_and_repeat():
    covariance = np.array([[4.0, 1.0, 0.0], [1.0, 0.5, 0.0], [0.0, 0.0, 0.0]])
    rows = normal([1.0, -2.0, 3.0], covariance, 20000, 5, None)
    assert np.allclose(rows.mean(axis=0), [1.0, -2.0, 3.0], atol=0.05)
    assert np.allclose(np.cov(rows.T), covariance, atol=0.1)
    assert np.all(rows[:, 2] == 3.0)
    assert np.array_equal(rows, normal([1.0, -2.0, 3.0], covariance, 20000, 5, None))


def test_a_servo_model_is_drawn_in_the_coordinates_of_a_possible_servo(model):
    servo = model.servo_model
    fields = servo._fields
    own = {**fields, "covariance": fields["bounds"]["rows"]}
    possible = [own, *fields["alternatives"]]
    assert len(possible) > 1
    taken = set()
    for draw in servo.draws(60, seed=3):
        drawn = draw.servo_model._fields
        like = [
            place
            for place, other in enumerate(possible)
            if other["terms"] == drawn["terms"] and other["covariance"] == drawn["bounds"]["rows"]
        ]
        assert len(like) == 1
        other = possible[like[0]]
        taken.add(like[0])
        assert drawn["coordinates"] == other["coordinates"]
        sd = np.sqrt(np.maximum(np.diag(other["covariance"]), 0.0))
        off = np.abs(np.array(drawn["values"]) - other["values"])
        # Cut off at zero, a friction is on one side of it; nothing is off by five standard deviations.
        assert np.all(off <= 5.0 * sd + 1e-12)
    assert len(taken) > 1


def test_a_draw_is_exported_and_its_linear_model_is_doubted(model):
    first, second = model.servo_model.draws(2, seed=3)
    files = [draw.export("python", name="servo").text for draw in (first, second)]
    assert files[0] != files[1]
    with pytest.warns(UserWarning, match="draw.servo_model.simulate"):
        first.simulate([0.0] * 10)
    # What the recording determines is the estimate's, offset and accelerations included.
    assert "Not determined" not in first.export("python", name="servo", servo_model=True).text
    with pytest.warns(UserWarning, match="the servo is not linear"):
        model.draws(1, seed=1)


def test_the_quantities_of_a_draw_are_its_own(model):
    draws = model.servo_model.draws(20, seed=3)
    for name in ("gain", "damping ratio", "bandwidth at small signals"):
        estimate = model.servo_model.quantities[name]
        drawn = [draw.servo_model.quantities[name] for draw in draws]
        assert len({found.value for found in drawn}) == 20, name
        assert {(found.lower, found.upper) for found in drawn} == {(estimate.lower, estimate.upper)}, name
        assert sum(estimate.lower <= found.value <= estimate.upper for found in drawn) >= 18, name
    for draw in draws:
        values = dict(zip(draw.servo_model.coordinates, draw.servo_model.values))
        assert draw.servo_model.quantities["delay"].value == pytest.approx(values["delay"], rel=1e-9)


def test_draws_have_the_range_of_the_intervals(model):
    servo = model.servo_model
    drawn = servo._draws(4000, seed=5)
    values = [dict(zip(map(str, one["coordinates"]), one["values"])) for one in drawn]
    for name, of in {
        "gain": lambda v: v["gain"],
        "damping ratio": lambda v: np.exp(v["ln_damping"] - v["ln_stiffness"] / 2) / 2,
    }.items():
        quantity = servo.quantities[name]
        found = np.array([of(v) for v in values])
        inside = (quantity.lower <= found) & (found <= quantity.upper)
        width = quantity.upper - quantity.lower
        assert inside.mean() > 0.985, name
        assert found.max() - found.min() > 0.9 * width, name
    for v in values:
        assert min(v[name] for name in ("delay", "dead_band", "play", "friction", "friction_at_rest") if name in v) >= 0.0


def test_a_drawn_servo_is_exported_and_simulated_with_its_own_constants(model):
    draw = model.servo_model.draws(1, seed=4)[0]
    values = dict(zip(draw.servo_model.coordinates, draw.servo_model.values))
    module: dict = {}
    exec(draw.export("python", servo_model=True).text, module)
    # Beside a spring, stiffness and gain among the coordinates are those of drive and spring together.
    share = values.get("spring", 0.0)
    constants = {
        "STIFFNESS": np.exp(values["ln_stiffness"]) * (1.0 - share),
        "DAMPING": np.exp(values["ln_damping"]),
        "GAIN": values["gain"] / (1.0 - share),
        "OFFSET": values["offset"],
    }
    for name, expected in constants.items():
        assert module[name] == pytest.approx(expected, rel=1e-9), name
    assert "one of the possible servos" in draw.summary and "one of the possible servos" in module["__doc__"]
    command = [0.0] * 20 + [10.0] * 100
    own, estimate = (found.servo_model.simulate(command).value for found in (draw, model))
    assert 0.0 < np.abs(own - estimate).max() < 1.0


def test_linear_draws_are_step_responses_with_the_standard_deviations_of_the_model():
    model = servoid.identify(servoid.simulate("linear"), flight_model=True)
    draws = model.draws(4000, seed=1)
    assert np.allclose(draws.mean(axis=0), model.step.value, atol=5 * np.max(model.step.sd) / np.sqrt(4000))
    assert np.allclose(draws.std(axis=0), model.step.sd, rtol=0.1, atol=1e-12)
    flight = model.flight_model
    parameters = flight.draws(4000, seed=1)
    for name, sd in flight.sd.items():
        assert parameters[name].std() == pytest.approx(sd, rel=0.1), name
        assert parameters[name].mean() == pytest.approx(flight[name]["value"], abs=5 * sd / np.sqrt(4000)), name


def test_nothing_is_drawn_without_bounds(model):
    with pytest.raises(servoid.ServoidError, match="no covariance to draw from"):
        normal([0.0], None, 3, None, model.withdrawn)
    document = model.to_dict()
    document["servo_model"]["quantities"][0]["determined"] = False
    undetermined = servoid.Model(servoid._servoid.Model.parse(json.dumps(document), "undetermined")).servo_model
    with pytest.warns(UserWarning, match="does not determine"):
        undetermined.draws(1, seed=1)
    # A warning of what draws lack is none where there are no draws.
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(servoid.ServoidError, match="count"):
            undetermined.draws(-1)


def test_every_draw_moves_as_the_recording_has_it(model):
    command = np.repeat([0.0, 15.0, -15.0, 5.0], 250)
    own = model.servo_model.simulate(command)
    for draw in model.servo_model.draws(100, seed=2):
        apart = np.abs(draw.servo_model.simulate(command).value - own.value)
        # The band of the trial is twice that of the model, and other strokes than those of the trial may have somewhat more.
        assert apart.max() < 3.0 * (own.upper - own.value).max()

"""Gain and phase under a sine that is asked for: those that the command line prints."""

import math
import re

import numpy as np
import pytest
import servoid


@pytest.fixture(scope="module")
def model():
    stairs = servoid.simulate("bench", reference="stairs", amplitude=20, length=20)
    return servoid.identify(stairs, servo_model=True)


def printed(tmp_path, capfd, at):
    """Value, lower and upper bound of gain and phase, as ``servoid identify --at`` prints them."""
    path = tmp_path / "stairs.csv"
    run = ["simulate", "--servo", "bench", "--reference", "stairs", "--amplitude", "20", "--length", "20", "-o", str(path), "-q"]
    assert servoid._servoid.run_program(["servoid", *run]) == 0
    capfd.readouterr()
    assert servoid._servoid.run_program(["servoid", "identify", str(path), "--at", at, "--servo-model", "-q"]) == 0
    number = r"(-?[0-9.]+)"
    row = rf" at [0-9.]+ Hz +{number} (?:deg)? *(?:{number} \.\. {number})?"
    return [[float(end) if end else None for end in found] for found in re.findall(row, capfd.readouterr().out)]


def ends(interval):
    return [interval.value, interval.lower, interval.upper]


def test_both_models_say_what_the_command_line_prints(model, tmp_path, capfd):
    rows = printed(tmp_path, capfd, "3:8")
    with pytest.warns(UserWarning, match="the servo is not linear"):
        linear = model.at(3)
    machine = model.servo_model.at(3, 8)
    assert len(rows) == 4, rows
    # The servo is not linear, so that the servo model comes first.
    for row, interval in zip(rows, [machine.gain, machine.phase_deg, linear.gain, linear.phase_deg]):
        for said, found in zip(row, ends(interval)):
            assert (said is None) == (found is None)
            assert said is None or abs(said - found) <= 0.06 if abs(found) > 1.5 else abs(said - found) < 1e-3
    assert machine.level == model.servo_model.level == 0.99
    assert machine.withdrawn is None and machine.gain.lower < machine.gain.value < machine.gain.upper
    assert math.isclose(machine.late_ms, -machine.phase_deg.value / 360 / 3 * 1e3)


def test_a_servo_against_its_command_is_as_late():
    u, y = servoid.simulate("linear").runs[0]
    both = [servoid.identify(u, sign * y, period=0.002) for sign in (1.0, -1.0)]
    along, against = [found.at(4).late_ms for found in both]
    # A change of the sign is none of the numbers.
    assert math.isclose(along, against, rel_tol=1e-9)


def test_a_servo_that_is_limited_answers_a_large_sine_less(model):
    gains = [model.servo_model.at(8, amplitude).gain.value for amplitude in (2.0, 10.0, 20.0)]
    assert gains[2] < 0.9 * gains[0], gains


def test_a_sine_of_the_servo_model_is_that_of_its_simulation(model):
    servo, hertz, amplitude = model.servo_model, 2.0, 5.0
    at = np.arange(2000) * servo.sample_period_s
    y = servo.simulate(amplitude * np.sin(2 * np.pi * hertz * at)).value
    last = at >= at[-1] - 1 / hertz
    harmonic = 2 * np.mean(y[last] * np.exp(-2j * np.pi * hertz * at[last])) * 1j / amplitude
    found = servo.at(hertz, amplitude)
    assert abs(abs(harmonic) / found.gain.value - 1) < 0.02
    # A command that is held for a row is late by half of one.
    row_deg = 360 * hertz * servo.sample_period_s
    assert abs(np.degrees(np.angle(harmonic)) - found.phase_deg.value) < 1.5 * row_deg


def test_what_cannot_be_asked_for_is_said(model):
    for wrong in (0, -1, math.nan, math.inf):
        with pytest.raises(servoid.ServoidError, match="give a number above 0"):
            model.at(wrong)
        with pytest.raises(servoid.ServoidError, match="give a number above 0"):
            model.servo_model.at(3, wrong)
    with pytest.raises(TypeError):
        model.at("3")
    with pytest.raises(servoid.ServoidError, match="above half of the rows"):
        model.at(400)
    with pytest.raises(servoid.ServoidError, match="controller"):
        model.servo_model.at(3, 5, controller=7)

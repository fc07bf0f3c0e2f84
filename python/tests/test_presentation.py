"""What people see: texts, figures, objects of other packages."""

import json
import pickle
import subprocess
import sys

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


@pytest.fixture(scope="module")
def machine():
    """A model with a servo model of a servo that is not linear."""
    return servoid.identify(servoid.simulate("bench", reference="stairs", amplitude=20, length=20), servo_model=True)


def test_a_loaded_model_says_what_the_identified_one_says(machine, tmp_path):
    machine.save(tmp_path / "model.json")
    loaded = servoid.Model.load(tmp_path / "model.json")

    def said(model):
        # The first line has the name of file or data.
        return repr(model).split("\n", 1)[1]

    assert said(loaded) == said(machine)
    first, second = said(loaded).splitlines()
    assert first.startswith("This servo") and first.endswith("It is in .servo_model.") and not second.startswith("This servo")
    # The text of the program is the same, too, but for the name.
    text = machine.summary.replace(f"{machine._core.name}\n", f"{loaded._core.name}\n", 1)
    assert loaded.summary == text and text.startswith("This servo") and "servo model:" in text


@pytest.fixture(scope="module")
def explained(tmp_path_factory):
    """A model of a file of another program, with all that can be asked for beside it."""
    u, y = servoid.simulate("linear").runs[0]
    file = tmp_path_factory.mktemp("explained") / "rows.csv"
    rows = (f"{1e-3 * 2 * k:.3f},{a},{b}" for k, (a, b) in enumerate(zip(u, y)))
    file.write_text("t,u,y\n" + "\n".join(rows) + "\n")
    beside = {"explain": True, "flight_model": True, "limits": True, "servo_model": True}
    return servoid.identify(file, input="u", output="y", time_unit="s", **beside)


def test_a_loaded_model_says_how_it_was_read_and_explains_itself(explained, tmp_path):
    explained.save(tmp_path / "model.json")
    loaded = servoid.Model.load(tmp_path / "model.json")
    assert explained.remarks and loaded.remarks == explained.remarks and explained.remarks[0] in repr(loaded)
    assert not any("--" in remark for remark in explained.remarks)
    text = explained.summary.replace(f"{explained._core.name}\n", f"{loaded._core.name}\n", 1)
    assert loaded.summary == text
    for part in ("how the structure came about", "low-order model: ", "limits of a linear model", "terms that were tried"):
        assert part in loaded.summary, part


def test_a_low_order_model_is_a_text(explained):
    flight = explained.flight_model
    printed = str(flight)
    assert printed.startswith("low-order model: K exp(-L s)") and "natural frequency w" in printed and "rad/s" in printed
    # It is that of the program.
    assert all(line in explained.summary for line in printed.splitlines())
    value, lower, upper = (f"{1e3 * number:.4g}" for number in (flight.delay_s.value, flight.delay_s.lower, flight.delay_s.upper))
    assert f"delay {value} ms ({lower} .. {upper})" in repr(flight)
    assert repr(flight).startswith("<FlightModel of order 2 (bounds at 99 %): gain ") and "lag" not in repr(flight)
    again = pickle.loads(pickle.dumps(flight))
    assert again == flight and str(again) == printed


def test_sentences_have_arguments_where_the_program_has_options(machine):
    u, y = servoid.simulate("linear").runs[0]
    halves = [[column[:1800], column[1800:]] for column in (u, y)]
    found = servoid.identify(*halves, period=0.002, controllers=[1.0, 2.0])
    (written,) = (item["do"] for item in found.to_dict()["advice"] if "--" in item["do"])
    said = [item.do for item in found.advice]
    assert "--servo-model" in written and written.replace("'--servo-model'", "servo_model=True") in said
    linear = machine.export("c")
    assert any("--servo-model" in warning for warning in linear.document["warnings"])
    assert any("servo_model=True" in warning for warning in linear.warnings) and not any("--" in warning for warning in linear.warnings)


def test_a_servo_model_can_be_pickled(machine):
    servo = machine.servo_model
    again = pickle.loads(pickle.dumps(servo))
    assert again.to_dict() == servo.to_dict() and repr(again) == repr(servo)
    u = np.repeat([0.0, 10.0], 50)
    np.testing.assert_array_equal(again.simulate(u).value, servo.simulate(u).value)


def test_a_low_order_model_says_of_what_its_covariance_is(model):
    flight = model.flight_model
    assert flight == model.to_dict()["flight_model"] and flight.order == 2 and flight.lag_s is None
    assert len(flight.covariance) == len(flight.coordinates) == 4
    assert flight.level == 0.99 and flight.withdrawn is None
    # An interval of 99 % is at least 2.58 standard deviations to each side, of the logarithm where the covariance is of that: it holds servos of more poles, too.
    omega = flight.omega_rad_s
    assert np.log(omega.upper / omega.value) > 0.99 * 2.576 * flight.covariance[2, 2] ** 0.5
    assert omega.upper - omega.value > 0.95 * 2.576 * flight.sd["omega_rad_s"]
    assert flight.gain.upper - flight.gain.value > 0.99 * 2.576 * flight.sd["gain"]


def test_a_bode_plot_is_of_the_servo_and_has_bounds_where_they_hold(model, needed):
    matplotlib = needed("matplotlib")
    matplotlib.use("Agg")
    axes = model.plot_bode()
    magnitude, phase = axes
    assert [ax.get_ylabel() for ax in axes] == ["magnitude\n(dB of deg per deg)", "phase (degrees)"]
    assert phase.get_xlabel() == "frequency (Hz)" and len(magnitude.collections) == len(phase.collections) == 1
    # The samples lag by the hold and are early by their phase.
    shift = np.degrees(model.frequency.omega_rad_s * (model.sample_period_s / 2 - model.sample_phase_s))
    np.testing.assert_allclose(model.servo_frequency.phase_deg[:5], (model.frequency.phase_deg + shift)[:5], atol=0.05)
    hertz = phase.lines[0].get_xdata()
    own = model.servo_frequency
    above = own.omega_rad_s > 0.0
    np.testing.assert_array_equal(phase.lines[0].get_ydata(), own.phase_deg[above][: len(hertz)])
    np.testing.assert_allclose(hertz, own.omega_rad_s[above][: len(hertz)] / (2 * np.pi))

    random = np.random.default_rng(5)
    u = np.repeat(random.integers(-1, 2, size=25).astype(float), 20)
    y = np.convolve(u, np.full(10, 0.1))[: len(u)]
    stuck = np.where(np.abs(y - 0.5) < 0.3, np.roll(y, 7), y) ** 3 + 1e-6 * random.normal(size=len(u))
    without = servoid.identify(np.cumsum(u - 0.5) * 0.02, stuck, period=0.01)
    assert without.servo_frequency.level is None, "the case no longer has what it is for"
    both = matplotlib.pyplot.subplots(2)[1]
    drawn = without.plot_bode(both)
    assert drawn[0] is both[0] and not drawn[0].collections and not drawn[1].collections
    assert "no bounds can be given" in drawn[0].get_legend().get_texts()[0].get_text()
    assert drawn[0].get_ylabel() == "magnitude\n(dB of output per input)"


def test_the_labels_of_a_bode_plot_are_in_the_picture(needed):
    needed("matplotlib").use("Agg")
    # The label is longest where no unit is known.
    u, y = servoid.simulate("linear").runs[0]
    axes = servoid.identify(u, y, period=0.002).plot_bode()
    figure = axes[0].figure
    figure.draw_without_rendering()
    for ax in axes:
        label, panel = ax.yaxis.label.get_window_extent(), ax.get_window_extent()
        assert figure.bbox.x0 <= label.x0
        assert panel.y0 <= label.y0 and label.y1 <= panel.y1, ax.get_ylabel()


@pytest.mark.parametrize("hertz", [(0.3, 6.0), (1.0, 4.0), (0.01, 200.0)])
def test_ticks_of_frequency_do_not_overlap(needed, hertz):
    needed("matplotlib").use("Agg")
    _, phase = servoid.identify(servoid.simulate("linear")).plot_bode()
    phase.set_xlim(*hertz)
    phase.figure.draw_without_rendering()
    left, right = phase.bbox.x0, phase.bbox.x1
    boxes = [label.get_window_extent() for label in phase.get_xticklabels(which="both") if label.get_text()]
    boxes = sorted((box for box in boxes if left <= box.x0 + box.width / 2 <= right), key=lambda box: box.x0)
    assert len(boxes) >= 2
    assert all(one.x1 < other.x0 for one, other in zip(boxes, boxes[1:]))


def test_a_comparison_has_what_its_document_has():
    found = servoid.compare(servoid.simulate("bench"), servoid.simulate("aircraft", seed=2))
    document = found.to_dict()
    largest = found.largest_difference
    assert (largest.at_least, largest.at_most) == found.difference_percent
    assert largest.stroke in found.curves and found.runs == (1, 1)
    delay = found.delay_shift_s
    assert [delay.lower, delay.upper] == document["bounds"]["delay_shift_s"] and delay.lower < delay.value < delay.upper
    gain = found.differences["dc_gain"]
    assert gain.ratio == gain.b.value / gain.a.value < 1.0
    assert gain.difference.lower < gain.difference.value == gain.b.value - gain.a.value < gain.difference.upper < 0.0
    assert gain.a.lower < gain.a.value < gain.a.upper
    assert list(found.differences) == [row["metric"] for row in document["differences"]]
    for stroke, curve in found.curves.items():
        assert curve.stroke == stroke and (curve.lower <= curve.percent).all() and curve.withdrawn is None
    assert found.over_prediction.plus_percent.value > 10.0
    assert found.asymmetry["b"].largest_percent == document["asymmetry"]["b"]["largest_percent"]
    assert not (found.same_data or found.turns_the_other_way or found.descriptions_of_different_motions)
    assert found.servo_model is None and found.no_servo_model is None


def test_sides_of_arrays_are_called_by_their_names():
    u, y = machine_runs()
    sides = [servoid.recording(u, y, period=0.002, name=name) for name in ("free", "loaded")]
    found = servoid.compare(*sides, servo_model=False)
    assert found.summary.startswith("A  free\nB  loaded\n")
    with pytest.raises(TypeError, match='such as "free"'):
        servoid.recording(u, y, period=0.002, name=1)


def test_a_comparison_of_machines_alone_has_no_curves(machine):
    u, y = machine_runs()
    coarse = servoid.identify(u[::2], y[::2], period=0.004, input_unit="deg", output_unit="deg", servo_model=True)
    found = servoid.compare(machine, coarse)
    assert found.servo_model is not None and found.verdict == "undecided"
    assert found.largest_difference is None and found.delay_shift_s is None and found.over_prediction is None
    assert found.differences == found.curves == found.asymmetry == {} and found.runs is None


def machine_runs():
    return servoid.simulate("bench", reference="stairs", amplitude=20, length=20, seed=4).runs[0]


def test_a_report_and_exports_are_those_of_the_program(machine, tmp_path):
    def program(*arguments):
        command = [sys.executable, "-m", "servoid", *map(str, arguments), "--quiet"]
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout

    file, page = tmp_path / "servo.json", tmp_path / "package.html"
    machine.save(file)
    loaded = servoid.Model.load(file)
    loaded.report(page, title="A servo")
    with pytest.raises(FileExistsError):
        loaded.report(page)
    program("report", file, "--title", "A servo", "-o", tmp_path / "program.html")
    assert page.read_bytes() == (tmp_path / "program.html").read_bytes()
    for to, options, keywords in [
        ("c", (), {}),
        ("python", ("--name", "rudder", "--frame-ms", "20"), {"name": "rudder", "frame_ms": 20.0}),
        ("c", ("--servo-model", "--step-ms", "1"), {"servo_model": True, "step_ms": 1.0}),
        ("mujoco", (), {}),
        ("ardupilot", ("--full-command", "30"), {"full_command": 30.0}),
    ]:
        printed = json.loads(program("export", file, "--to", to, *options, "--json"))
        found = loaded.export(to, **keywords)
        assert found.text == printed.pop("text") and found.document == printed
        assert found.target == to and len(found.warnings) == len(printed["warnings"])
        assert found.largest_difference == printed.get("largest_difference")
    written = tmp_path / "servo.xml"
    found = loaded.export("mujoco", written)
    assert written.read_text() == found.text and found.remarks[0].startswith("largest difference from the servo model: ")
    with pytest.raises(FileExistsError, match="force=True"):
        loaded.export("mujoco", written)
    loaded.export("jsbsim", written, force=True)
    assert "<system" in written.read_text()


@pytest.mark.parametrize(
    ("to", "options", "sentence"),
    [
        ("simulink", {}, "choose matlab, python, julia, c, csv, jsbsim, ardupilot, mujoco"),
        ("c", {"step_ms": 1.0}, "step_ms are for a servo model: add servo_model=True"),
        ("c", {"servo_model": True, "step_ms": 0.0}, "step_ms must be"),
        ("c", {"frame_ms": float("nan")}, "frame_ms must be"),
        ("c", {"full_command": 3.0}, 'full_command is for to="ardupilot"'),
        ("mujoco", {}, "no servo model"),
    ],
)
def test_exports_that_are_not_possible_are_refused(model, to, options, sentence):
    with pytest.raises(servoid.ServoidError) as raised:
        model.export(to, **options)
    assert sentence in str(raised.value) and "--" not in str(raised.value).split("'servoid ")[0]


def test_a_figure_has_the_band(model, needed):
    needed("matplotlib").use("Agg")
    ax = model.plot()
    assert ax.get_ylabel() == "response to a unit step (deg per deg)"
    (band,) = ax.collections
    highest = band.get_paths()[0].vertices[:, 1].max()
    assert highest == pytest.approx(model.step.upper.max(), rel=1e-12)


def test_a_servo_model_is_drawn_with_its_band(needed):
    needed("matplotlib").use("Agg")
    stairs = servoid.simulate("bench", reference="stairs", amplitude=20, length=20)
    servo = servoid.identify(stairs, servo_model=True).servo_model
    u = np.repeat([0.0, 10.0], [10, 90])
    ax = servo.plot(u)
    (line,) = ax.lines
    np.testing.assert_array_equal(line.get_ydata(), servo.simulate(u).value)
    assert line.get_xdata()[-1] == pytest.approx(99 * servo.sample_period_s)
    (band,) = ax.collections
    assert band.get_paths()[0].vertices[:, 1].max() == pytest.approx(servo.simulate(u).upper.max(), rel=1e-12)
    with pytest.raises(TypeError, match="ax is 3: give Axes of matplotlib"):
        servo.plot(u, 3)


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
    omega = model.servo_frequency.omega_rad_s
    np.testing.assert_allclose(frd(1j * omega), model.servo_frequency.response, atol=1e-6)
    # That of the samples has the hold besides: half a sample late, less what samples follow their edges by.
    of_samples = discrete(np.exp(1j * omega * model.sample_period_s))
    hold = model.sample_period_s / 2 - model.sample_phase_s
    late = np.angle(of_samples / frd(1j * omega))
    slow = omega * model.sample_period_s < 0.3
    np.testing.assert_allclose(late[slow], -omega[slow] * hold, atol=1e-3)
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


def telegraph(seed):
    """A servo of 280 a second at the most, between two levels: command and motion."""
    random = np.random.default_rng(seed)
    u = np.repeat(np.where(random.random(100) < 0.5, -60.0, 60.0), 30)
    at, y = 0.0, np.empty(len(u))
    for k, command in enumerate(u):
        y[k] = at
        at += np.clip(0.3 * (command - at), -2.8, 2.8)
    return u, y + 0.2 * random.normal(size=len(u))


def test_a_servo_without_intervals_is_not_called_determined():
    u, y = telegraph(9)
    model = servoid.identify(u, y, period=0.01, servo_model=True)
    servo = model.servo_model
    assert servo.withdrawn.reason == "few_levels", "the case no longer has what it is for"
    assert "determined" not in repr(servo) and servo.withdrawn.because in repr(servo)
    for found in servo.quantities.values():
        assert (found.value is not None) == found.determined
        assert found.determined or (found.lower, found.upper, found.other_fits) == (None, None, None)
    assert not model.linear
    # The gain of the linear model is not that of the servo, and is not said to be.
    said = repr(model)
    assert "the servo passes" not in said and "the servo ends" not in said
    assert "does not excite" not in said and "fewer than three levels" in said
    # No speed is beyond the limit for the noise of the sensor.
    assert "moves as if limited to 280 units/s" in said and "moved at more than" not in said


def test_a_validation_has_units_and_what_to_do():
    model = servoid.identify(servoid.simulate("linear"))
    assert " deg rms, bias " in repr(model.validate(servoid.simulate("linear", seed=5)))
    again = model.validate(servoid.simulate("linear"))
    assert all(item.do in repr(again) for item in again.advice) and again.advice
    assert repr(pickle.loads(pickle.dumps(again))) == repr(again)


def test_models_are_compared_as_models():
    models = [servoid.identify(servoid.simulate("linear", seed=seed)) for seed in (1, 2)]
    assert "of these models" in repr(servoid.compare(*models))


def test_a_low_order_model_says_whether_it_is_an_approximation(model):
    assert model.flight_model.approximation is model.to_dict()["flight_model"]["approximation"]


def test_a_comparison_is_drawn_with_its_band_and_margin(needed):
    needed("matplotlib").use("Agg")
    found = servoid.compare(servoid.simulate("bench"), servoid.simulate("aircraft"), servo_model=False)
    ax = found.plot(label="aircraft less bench")
    legend = [text.get_text() for text in ax.get_legend().get_texts()]
    assert any(text.startswith("aircraft less bench") for text in legend) and "margin" in legend
    assert any(text.startswith("the whole curve, 99 %") for text in legend)
    drawn = ax.lines[0].get_ydata()
    first = next(iter(found.curves.values()))
    assert list(drawn) == list(first.percent)

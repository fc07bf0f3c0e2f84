"""Wrong arguments are exceptions with sentences; nothing panics."""

import json
import sys
import time

import numpy as np
import pytest

import servoid

RANDOM = np.random.default_rng(18)
U = np.repeat(RANDOM.integers(-1, 2, size=25).astype(float), 20)
Y = np.convolve(U, np.full(10, 0.1))[: len(U)] + 1e-3 * RANDOM.normal(size=len(U))


@pytest.mark.parametrize(
    ("u", "y", "options", "sentence"),
    [
        (U, Y[:-1], {}, "the input has 500 samples and the output 499"),
        (U, np.full(500, np.nan), {}, "the output has no value that is a number"),
        (U, np.zeros(500), {}, "the output never moves"),
        (np.zeros(500), Y, {}, "the input never moves"),
        (U, np.where(U > 0, np.inf, Y), {}, "infinite"),
        (U.reshape(10, 50), Y, {}, "shape"),
        (U, ["a"] * 500, {}, "something else than numbers"),
        (U, Y + 1j, {}, "something else than numbers"),
        ([], [], {}, "no samples"),
        ([U, U], [Y], {}, "as many arrays"),
        (U, Y, {"period": np.nan}, "sample period"),
        (U, Y, {"period": 0.0}, "sample period"),
        (U, Y, {"period": -1.0}, "sample period"),
        (U, Y, {"period": None}, "period="),
        (U, Y, {"phase": -1.0}, "phase"),
        (U, Y, {"phase": np.nan}, "phase"),
        (U, Y, {"level": 1.5}, "confidence level"),
        (U, Y, {"level": np.nan}, "confidence level"),
        (U, Y, {"settling": 2}, "settling time of 2"),
        (U, Y, {"settling": "long"}, "settling is 'long': give \"auto\" or a number of samples"),
        (U, Y, {"settling": -4}, "settling is -4"),
        (U, Y, {"settling": 0.5}, "settling is 0.5: give \"auto\" or a number of samples, not seconds: 0.5 s are 50 samples here"),
        (U, Y, {"frequencies": "wide"}, "frequencies is 'wide': give \"auto\", \"narrow\" or an odd number"),
        (U, Y, {"noise_order": -1}, "noise_order is -1"),
        (U, Y, {"detrend": "quadratic"}, "detrend is 'quadratic': give \"auto\", \"none\", \"offset\" or \"linear\""),
        (U, Y, {"prior": "flat"}, "prior is 'flat': give \"none\" or \"stable\""),
        (U, Y, {"at_rest": np.nan}, "at_rest is nan: give the command before the run, or leave at_rest out"),
        (U, Y, {"controllers": [np.nan]}, "a number for each run"),
        (U[:, None], Y[:, None], {}, "a column with the shape"),
        (3.0, 4.0, {}, "is one value: give an array"),
        (U, Y, {"frequencies": 4, "settling": 9}, "odd"),
        (U, Y, {"noise_order": 99}, "noise order"),
        (U, Y, {"at_rest": [0.0, 0.0]}, "there is 1 run, and at_rest has 2 values: give one for each run"),
        (U, Y, {"controllers": [1.0, 2.0]}, "each"),
        (U[:40], Y[:40], {}, "samples"),
    ],
)
def test_wrong_arguments_are_sentences(u, y, options, sentence):
    with pytest.raises(servoid.ServoidError, match=sentence):
        servoid.identify(u, y, **{"period": 0.01, **options})


@pytest.mark.parametrize(
    ("table", "options", "sentence"),
    [
        ("a,b\n0,1\n1,2\n", {"input": "a", "output": "b"}, "time=COLUMN, or say how far apart the rows are with period=SECONDS"),
        ("u,Meas angle\n0,1\n1,2\n", {}, 'add: input="u", output="Meas angle", period=SECONDS'),
        ("t,u,y\n0,1,1\n5,2,2\n10,3,3\n", {"input": "u", "output": "y"}, 'time_unit="ms", time_unit="us" or time_unit="s"'),
        ("t_s,u,y\n0,1,1\n0.005,2,2\n0.01,3,3\n", {"input": "u", "output": "y", "period": 5.0}, "leave period out"),
    ],
)
def test_sentences_name_arguments_and_not_options_of_the_command_line(tmp_path, table, options, sentence):
    file = tmp_path / "mine.csv"
    file.write_text(table)
    with pytest.raises(servoid.ServoidError) as raised:
        servoid.read(file, **options)
    assert sentence in str(raised.value)
    assert "--" not in str(raised.value)


def test_milliseconds_for_seconds_are_answered_at_once():
    started = time.monotonic()
    model = servoid.identify(np.tile(U, 6), np.tile(Y, 6) + 0.1 * np.sin(np.arange(3000) / 7.0) ** 3, period=5.0, servo_model=True)
    assert time.monotonic() - started < 20.0
    assert any(advice["check"] == "period" for advice in model.to_dict()["advice"])


def test_without_python_control_it_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "control", None)
    with pytest.raises(ImportError, match="pip install control"):
        servoid.identify(U, Y, period=0.01).to_control()


def test_wrong_types_are_type_errors():
    with pytest.raises(TypeError):
        servoid.identify(U, Y, period=0.01, colour="red")
    with pytest.raises(TypeError):
        servoid.identify(U, Y, period=0.01, detrend=7)


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: servoid.read(), "no file is named: give the path"),
        (lambda: servoid.read([]), "give several files one behind the other"),
        (lambda: servoid.identify(U, Y, period="0.01"), "period is '0.01': give a number of seconds"),
        (lambda: servoid.identify(U, Y, period="10ms"), "period is '10ms': give a number of seconds"),
        (lambda: servoid.identify(U, Y, period=0.01, phase="0"), "phase is '0': give a number of seconds"),
        (lambda: servoid.identify(U, Y, period=0.01, at_rest="0"), "at_rest is '0': give a number"),
        (lambda: servoid.identify(U, Y, period=0.01, level="99"), "level is '99': give a level such as 0.99"),
        (lambda: servoid.identify(U, Y, period=0.01, controllers=["P"]), "controllers is 'P': give a number for each run"),
        (lambda: servoid.recording(U, Y, period="0.01"), "period is '0.01'"),
        (lambda: servoid.read("a.csv", input="u", output="y", period="0.01"), "period is '0.01'"),
        (lambda: servoid.compare("a.csv", "b.csv", margin="5"), "margin is '5'"),
        (lambda: servoid.identify(U, Y, period=0.01, prior=None), 'prior is None: give "none" or "stable"'),
        (lambda: servoid.identify(U, Y, period=0.01, explain="yes"), "explain is 'yes': give True or False"),
        (lambda: servoid.identify(U, Y, period=True), "period is True: give a number of seconds"),
        (lambda: servoid.identify(U, Y, period=[0.01]), r"period is \[0.01\]: give a number of seconds"),
        (lambda: servoid.identify(U, Y, period=0.01, controllers=5), "controllers is 5: give a list"),
        (lambda: servoid.identify(U, Y, period=0.01, input_unit=5), 'input_unit is 5: give a unit such as "deg"'),
        (lambda: servoid.identify(U, Y, dt=0.01), r"identify\(\) has no argument dt: .* as period="),
        (lambda: servoid.identify(U, Y, fs=100), r"identify\(\) has no argument fs: .* 1 / rate, as period="),
        (lambda: servoid.identify("a.csv", dt=0.01), r"has no argument dt: .* as period="),
        (lambda: servoid.identify(U, Y, period=0.01, colour="red"), r"has no argument colour: help\(servoid.identify\)"),
        (lambda: servoid.identify(U, Y, period=0.01, input="u"), "input is of files and tables"),
        (lambda: servoid.read("a.csv", input=3), "input is 3: give the name of a column"),
        (lambda: servoid.read("a.csv", polled="yes"), "polled is 'yes': give True or False"),
        (lambda: servoid.compare("a.csv", "b.csv", dt=1), r"compare\(\) has no argument dt"),
        (lambda: servoid.simulate(seed=1.5), "seed is 1.5: give a whole number from 0 to"),
        (lambda: servoid.simulate(length="3"), "length is '3': give a number of seconds"),
        (lambda: servoid.simulate(reference="stairs", levels=2.5), "levels is 2.5: give a whole number from 2 to 16"),
        (lambda: servoid.simulate(reference="sweep", frequencies=3), "frequencies is 3: give the lowest and the highest frequency"),
        (lambda: servoid.plan(noise="x"), "noise is 'x': give a number of degrees"),
        (lambda: servoid.Model.load(3), r"path is 3: give the path of a file that model.save\(\) has written"),
        (lambda: servoid.Model.from_json({}), "text is {}: give the JSON of a model"),
        (lambda: servoid.plan(model=servoid.identify(U, Y, period=0.01)), r'save a model with model\.save\("servo\.json"\)'),
        (lambda: servoid.simulate(servoid.identify(U, Y, period=0.01)), r'give servo="servo\.json"'),
        (lambda: servoid.validate("a.json", U, Y), r"servoid\.Model\.load\(path\)"),
    ],
)
def test_wrong_types_are_answered_by_what_to_give(call, sentence):
    with pytest.raises(TypeError, match=sentence):
        call()


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda model: servoid.simulate(seed=-1), "seed is -1: give a whole number from 0 to"),
        (lambda model: servoid.simulate(length=5), "^length is not for the reference staircase"),
        (lambda model: servoid.simulate(hold=5), "^hold is not for the reference staircase"),
        (lambda model: servoid.plan(repeat=0), "repeat is 0: give a whole number from 1 to 99"),
        (lambda model: model.export("mujoco"), "identify its recording with servo_model=True"),
        (lambda model: servoid.Model.from_json("nothing"), r"write it with model.save\(path\)"),
        (lambda model: servoid.Model.from_json("{}"), r"is no model as model.save\(\) writes it"),
        (lambda model: model.simulate(U, at_rest=np.nan), "at_rest is nan"),
        (lambda model: model.predict([U, U], [Y]), "as many arrays"),
        (lambda model: servoid.compare(servoid.recording(U, Y, period=0.01), servoid.recording(U, Y, period=0.02)), "servo_model=True"),
    ],
)
def test_sentences_name_what_python_has(call, sentence):
    with pytest.raises(servoid.ServoidError, match=sentence) as raised:
        call(servoid.identify(U, Y, period=0.01))
    assert "'servoid " not in str(raised.value) and "--" not in str(raised.value)


def test_a_model_is_no_recording(tmp_path):
    model = servoid.identify(U, Y, period=0.01)
    model.save(tmp_path / "model.json")
    with pytest.raises(servoid.ServoidError, match=r"read it with servoid.Model.load\(path\)"):
        servoid.compare(tmp_path / "model.json", tmp_path / "model.json")


def test_only_axes_are_drawn_on(needed):
    needed("matplotlib").use("Agg")
    model = servoid.identify(U, Y, period=0.01)
    with pytest.raises(TypeError, match="ax is 3: give Axes of matplotlib"):
        model.plot(3)
    with pytest.raises(TypeError, match="axes is 3: give two Axes of matplotlib"):
        model.plot_bode(3)


@pytest.mark.parametrize("nothing", [[], np.array([])])
def test_empty_arrays_and_lists_are_answered(nothing):
    for call in (
        lambda: servoid.identify(nothing, nothing, period=0.01),
        lambda: servoid.recording(nothing, nothing, period=0.01),
    ):
        with pytest.raises(servoid.ServoidError, match="there are no samples: u and y are empty"):
            call()
    with pytest.raises(servoid.ServoidError, match="and here an empty list"):
        servoid.compare([], [])


def test_a_servo_model_without_names_of_controllers_takes_none():
    servo = servoid.identify(servoid.simulate("linear"), servo_model=True).servo_model
    with pytest.raises(servoid.ServoidError, match="one controller, which has no name: leave controller out"):
        servo.simulate(U, controller=3)
    with pytest.raises(servoid.ServoidError, match="the input is empty"):
        servo.simulate([])


def test_no_doc_string_has_a_backslash():
    for name in servoid.__all__:
        assert "\\" not in (getattr(servoid, name).__doc__ or ""), name


def test_arrays_of_any_layout_and_number_are_taken():
    usual = servoid.identify(U, Y, period=0.01)
    both = np.stack([U, Y], axis=1)
    assert servoid.identify(both[:, 0], both[:, 1], period=0.01) == usual
    assert servoid.identify(U[::-1][::-1], Y.astype(">f8"), period=0.01) == usual
    assert servoid.identify(U.astype(np.int8), Y, period=0.01) == usual


def test_files_that_are_no_recordings_are_refused(tmp_path):
    with pytest.raises(servoid.ServoidError, match="nowhere.csv"):
        servoid.read(tmp_path / "nowhere.csv")
    strange = tmp_path / "strange.csv"
    strange.write_bytes(bytes(range(256)))
    with pytest.raises(servoid.ServoidError, match="strange.csv"):
        servoid.read(strange, input="u", output="y")
    with pytest.raises(servoid.ServoidError, match="unit of time"):
        servoid.read(strange, time_unit="h")
    with pytest.raises(servoid.ServoidError, match="no simulated servo"):
        servoid.simulate("rudder")
    with pytest.raises(servoid.ServoidError, match="limits"):
        servoid.simulate("bench", amplitude=80)


def test_models_of_other_versions_and_damaged_ones_are_refused():
    document = servoid.identify(U, Y, period=0.01).to_dict()
    with pytest.raises(servoid.ServoidError, match="newer servoid"):
        servoid.Model.from_json(json.dumps({**document, "schema": 99}))
    for damage in ({"theta": [1.0]}, {"step": None}, {"sample_period_s": -1.0}, {"structure": {}}):
        with pytest.raises(servoid.ServoidError):
            servoid.Model.from_json(json.dumps({**document, **damage}))
    with pytest.raises(servoid.ServoidError, match="no model"):
        servoid.Model.from_json("[1, 2]")


def test_results_cannot_be_changed():
    model = servoid.identify(U, Y, period=0.01)
    with pytest.raises(AttributeError):
        model.offset = 1.0
    with pytest.raises(ValueError, match="read-only"):
        model.step.value[0] = 1.0
    with pytest.raises(AttributeError):
        model.metrics.dc_gain = None


def test_bounds_that_are_withdrawn_are_none_everywhere():
    # A servo that follows a random walk of its own: its errors are no noise.
    generator = np.random.default_rng(5)
    y = np.convolve(U, np.full(10, 0.1))[: len(U)]
    stuck = np.where(np.abs(y - 0.5) < 0.3, np.roll(y, 7), y) ** 3 + 1e-6 * generator.normal(size=len(U))
    model = servoid.identify(np.cumsum(U - 0.5) * 0.02, stuck, period=0.01)
    assert model.withdrawn is not None, "the case no longer has what it is for"
    assert model.level is None and model.covariance is None and model.metrics.level is None
    step, frequency = model.step, model.frequency
    for bound in (step.lower, step.upper, step.pointwise_lower, step.pointwise_upper, step.sd, frequency.phase_deg_lower):
        assert bound is None
    assert model.metrics.dc_gain.lower is None and model.metrics.dc_gain.upper is None
    assert model.withdrawn.because in repr(model)


def test_sides_that_are_arrays_are_refused_with_the_remedy() -> None:
    u, y = servoid.simulate("linear").runs[0]
    with pytest.raises(servoid.ServoidError, match=r"servoid\.recording\(u, y, period="):
        servoid.compare((u, y), (u, y))
    a, b = (servoid.recording(*servoid.simulate("linear", seed=seed).runs[0], period=0.002) for seed in (1, 2))
    assert servoid.compare(a, b).of == "runs"


def test_a_prior_that_is_not_used_is_said() -> None:
    # The response of a servo that goes on beyond the record has no such prior.
    u = np.repeat(RANDOM.integers(-1, 2, size=25).astype(float), 6)
    y = np.cumsum(u) * 1e-3 + 1e-4 * RANDOM.normal(size=len(u))
    model = servoid.identify(u, y, period=0.02, prior="stable")
    assert any(remark.startswith("Prior: not used, because") for remark in model.remarks)

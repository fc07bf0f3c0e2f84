"""The package and the program give the same documents, byte by byte."""

import json
import pickle
import subprocess
import sys

import numpy as np
import pytest

import servoid


def program(*arguments: str) -> str:
    """What the program prints."""
    command = [sys.executable, "-m", "servoid", *arguments]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    """A recording of the simulated bench servo."""
    file = tmp_path_factory.mktemp("bench") / "bench.csv"
    program("simulate", "--servo", "bench", "-o", str(file), "--quiet")
    return file


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    """The same motion as a table of another program, with a gap."""
    u, y = (np.array(column) for column in servoid.simulate("bench").runs[0])
    y[700:703] = np.nan
    file = tmp_path_factory.mktemp("table") / "table.csv"
    rows = (f"{a!r},{'' if np.isnan(b) else repr(b)}" for a, b in zip(u.tolist(), y.tolist()))
    file.write_text("u,y\n" + "\n".join(rows) + "\n")
    return file, u, y


@pytest.mark.parametrize(
    ("options", "keywords"),
    [
        ((), {}),
        (("--level", "95", "--explain"), {"level": 0.95, "explain": True}),
        (("--flight-model", "--limits"), {"flight_model": True, "limits": True}),
        (("--settling", "60", "--noise-order", "2"), {"settling": 60, "noise_order": 2}),
        (("--detrend", "linear", "--frequencies", "narrow"), {"detrend": "linear", "frequencies": "narrow"}),
    ],
)
def test_a_model_is_that_of_the_program(bench, tmp_path, options, keywords):
    out = tmp_path / "program.json"
    printed = program("identify", str(bench), "-o", str(out), "--json", *options)
    model = servoid.identify(bench, **keywords)
    saved = tmp_path / "package.json"
    model.save(saved)
    assert saved.read_bytes() == out.read_bytes() == printed.encode()
    assert model.to_dict() == json.loads(printed)


def test_arrays_and_tables_give_the_numbers_of_the_file(table, needed):
    file, u, y = table
    printed = program("identify", str(file), "--input", "u", "--output", "y", "--period", "0.002", "--json")
    options = {"input": "u", "output": "y", "period": 0.002}
    assert servoid.identify(file, **options).to_dict() == json.loads(printed)
    without = {name: value for name, value in json.loads(printed).items() if name != "read_as"}
    masked = np.ma.masked_invalid(y)
    for output in (y, masked, y.tolist()):
        assert servoid.identify(u, output, period=0.002).to_dict() == without
    pandas = needed("pandas")
    frame = pandas.DataFrame({"u": u, "y": y})
    assert servoid.identify(frame, **options).to_dict() == json.loads(printed)


def test_several_runs_are_lists_and_files(bench, tmp_path):
    other = tmp_path / "other.csv"
    program("simulate", "--servo", "bench", "--seed", "2", "-o", str(other), "--quiet")
    printed = program("identify", str(bench), str(other), "--json")
    recording = servoid.read(bench, other)
    assert servoid.identify(recording).to_dict() == json.loads(printed)
    assert len(recording.runs) == 2
    u, y = zip(*recording.runs)
    found = servoid.identify(
        list(u), list(y), period=0.002, phase=recording.sample_phase_s, input_unit="deg", output_unit="deg"
    )
    # The rest around the reference is what files have and arrays have not: it judges the noise alone.
    assert found.to_dict()["theta"] == json.loads(printed)["theta"]


def test_several_tables_are_one_with_a_column_of_runs(table, needed):
    pandas = needed("pandas")
    file, u, y = table
    options = {"input": "u", "output": "y", "period": 0.002}
    half = len(u) // 2
    tables = [pandas.DataFrame({"u": u[part], "y": y[part]}) for part in (slice(half), slice(half, None))]
    for call in (lambda: servoid.read(*tables), lambda: servoid.identify(tables, **options)):
        with pytest.raises(servoid.ServoidError, match="pandas.concat"):
            call()
    joined = pandas.concat({1: tables[0], 2: tables[1]}, names=["part"])
    found = servoid.read(joined, run="part", **options).runs
    assert [len(run.input) for run in found] == [half, len(u) - half]
    assert np.array_equal(found[1].output, y[half:], equal_nan=True)


def test_a_comparison_a_validation_and_a_plan_are_those_of_the_program(bench, tmp_path):
    other, model = tmp_path / "aircraft.csv", tmp_path / "bench.json"
    program("simulate", "--servo", "aircraft", "-o", str(other), "--quiet")
    program("identify", str(bench), "-o", str(model), "--quiet")
    compared = servoid.compare(bench, other)
    assert compared.to_dict() == json.loads(program("compare", str(bench), str(other), "--json"))
    assert compared.verdict == "different"
    validated = servoid.validate(servoid.Model.load(model), other)
    assert validated.to_dict() == json.loads(program("validate", str(model), str(other), "--json"))
    with pytest.raises(servoid.ServoidError, match="need no frame_ms"):
        servoid.validate(servoid.Model.load(model), other, frame_ms=20)
    rows = [line.split(",") for line in other.read_text().splitlines() if line[:1].isdigit()]
    log = tmp_path / "log.csv"
    log.write_text("t_s,u_deg,y_deg\n" + "".join(f"{t},{u},{y}\n" for _, t, u, y, *_ in rows))
    columns = {"input": "u_deg", "output": "y_deg", "time": "t_s"}
    options = [f"--{name}={value}" for name, value in columns.items()]
    held = servoid.validate(servoid.Model.load(model), log, frame_ms=20, **columns)
    assert held.to_dict() == json.loads(program("validate", str(model), str(log), "--frame-ms", "20", "--json", *options))
    pulses = held.to_dict()["pulses"]
    assert pulses["stated_frame_s"] == 0.02
    # The length is looked for: at the end of the log the pulses are still where they are, to half a row.
    frames = len(rows) * 0.002 / 0.02
    assert abs(pulses["frame_s"] - 0.02) * frames < 0.001
    planned = servoid.plan("linear", repeat=2)
    assert planned.to_dict() == json.loads(program("plan", "--servo", "linear", "--repeat", "2", "--no-rig", "--json"))


def test_a_simulation_is_that_of_the_program(bench, tmp_path):
    out = tmp_path / "again.csv"
    servoid.simulate("bench", out=out)

    def rows(file):
        # The header has the time of the run and its number, which is in the checks in the last column too.
        lines = file.read_text().splitlines()
        return [line.rsplit(",", 1)[0] for line in lines if not line.startswith("#")]

    assert rows(out) == rows(bench)
    assert servoid.identify(servoid.simulate("bench")) == servoid.identify(bench)
    with pytest.raises(servoid.ServoidError, match="exists"):
        servoid.simulate("bench", out=out)


def test_a_saved_model_is_the_model(bench, tmp_path):
    model = servoid.identify(bench)
    model.save(tmp_path / "model.json")
    loaded = servoid.Model.load(tmp_path / "model.json")
    assert loaded == model == pickle.loads(pickle.dumps(model))
    with pytest.raises(FileExistsError):
        model.save(tmp_path / "model.json")
    u, _ = servoid.read(bench).runs[0]
    np.testing.assert_array_equal(loaded.simulate(u), model.simulate(u))


def test_a_servo_model_is_that_of_the_program(tmp_path):
    file, out = tmp_path / "stairs.csv", tmp_path / "stairs.json"
    servoid.simulate("bench", reference="stairs", amplitude=20, length=24, seed=3, out=file)
    program("identify", str(file), "--servo-model", "-o", str(out), "--quiet")
    model = servoid.identify(file, servo_model=True)
    assert model.to_dict() == json.loads(out.read_text())
    servo = model.servo_model
    assert servo is not None and (servo.quantities["delay"].value or 0.0) > 0.0
    response = servo.simulate([0.0] * 50 + [10.0] * 150)
    assert response.lower is not None and (response.lower <= response.value).all()
    stepped = servo.simulate([10.0] * 150, at_rest=0.0)
    known = servo.simulate([0.0] + [10.0] * 150)
    np.testing.assert_array_equal(stepped.value, known.value[1:])
    np.testing.assert_array_equal(stepped.lower, known.lower[1:])
    assert stepped.value[0] == pytest.approx(0.0, abs=0.1) and stepped.value[-1] == pytest.approx(10.0, abs=0.1)
    beyond = servo.simulate([0.0] * 50 + [500.0] * 150)
    assert beyond.lower is None and beyond.withdrawn is not None and beyond.withdrawn.reason == "beyond_record"


def test_arrays_are_read_alike_wherever_their_values_lie():
    u, y = servoid.simulate("linear").runs[0]
    whole = servoid.identify(u, y, period=0.002)
    table = np.column_stack([u, y])
    assert servoid.identify(table[:, 0], table[:, 1], period=0.002).to_dict() == whole.to_dict()
    recorded = servoid.recording(u, y, period=0.002)
    assert servoid.identify(recorded).to_dict() == whole.to_dict()


def test_arrays_have_the_options_of_files(tmp_path):
    # A noisy command: where the servo was sent the noise, the bounds need not allow for it.
    generator = np.random.default_rng(3)
    u = np.repeat(generator.uniform(-10, 10, size=60), 20) + 0.3 * generator.normal(size=1200)
    y = np.convolve(u, np.full(10, 0.1))[: len(u)] + 0.05 * generator.normal(size=len(u))
    file = tmp_path / "noisy.csv"
    file.write_text("u,y\n" + "\n".join(f"{a!r},{b!r}" for a, b in zip(u.tolist(), y.tolist())) + "\n")
    usual = servoid.identify(u, y, period=0.01)
    for option in ({"exact_command": True}, {"polled": True}):
        of_file = servoid.identify(file, input="u", output="y", period=0.01, **option).to_dict()
        of_arrays = servoid.identify(u, y, period=0.01, **option)
        assert of_arrays.to_dict()["metrics"] == of_file["metrics"]
        assert of_arrays.metrics.dc_gain != usual.metrics.dc_gain or of_arrays.metrics.delay_s != usual.metrics.delay_s
        assert servoid.identify(servoid.recording(u, y, period=0.01, **option)).to_dict() == of_arrays.to_dict()

"""Threads, memory, Ctrl-C and the program."""

import os
import signal
import subprocess
import sys
import threading
import time
import tracemalloc

import numpy as np
import pytest

import servoid


def test_a_million_samples_are_not_copied_by_python():
    u = np.tile(np.repeat([0.0, 1.0], 200), 2500)
    y = np.convolve(u, np.full(20, 0.05))[: len(u)] + 1e-3 * np.random.default_rng(1).normal(size=len(u))
    # The first call imports what it needs, which takes memory of its own.
    servoid.identify(u[:4000], y[:4000], period=0.002, settling=40).to_dict()
    tracemalloc.start()
    model = servoid.identify(u, y, period=0.002, settling=40)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert model.fit.samples_used > 999_000
    # A copy of one column is 8 MB, and numpy reports its arrays to tracemalloc. The document is below one.
    assert peak < 4e6


def test_other_threads_go_on():
    recording = servoid.simulate("bench", reference="stairs", length=20)
    turns = 0
    ended = threading.Event()

    def count():
        nonlocal turns
        while not ended.wait(0.001):
            turns += 1

    counter = threading.Thread(target=count)
    counter.start()
    began = time.monotonic()
    servoid.identify(recording, servo_model=True)
    took = time.monotonic() - began
    ended.set()
    counter.join()
    # A turn takes some milliseconds on a loaded machine; with the lock held there would be none.
    assert turns > 10 * took


@pytest.mark.skipif(os.name == "nt", reason="signals are others there")
def test_ctrl_c_ends_a_search_at_once():
    code = (
        "import servoid, sys\n"
        "recording = servoid.simulate('bench', reference='stairs', amplitude=20)\n"
        "print('searching', flush=True)\n"
        "try:\n"
        "    servoid.identify(recording, servo_model=True)\n"
        "except KeyboardInterrupt:\n"
        "    sys.exit(7)\n"
    )
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None and process.stdout.readline() == "searching\n"
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    began = time.monotonic()
    assert process.wait(timeout=30) == 7
    # It looks every 50 ms; the rest is the end of the interpreter on a loaded machine.
    assert time.monotonic() - began < 3.0


def run(*arguments: str) -> "subprocess.CompletedProcess[str]":
    program = os.path.join(os.path.dirname(sys.executable), "servoid")
    return subprocess.run([program, *arguments], capture_output=True, text=True)


def test_the_program_comes_with_the_package(tmp_path):
    assert run("--version").stdout == f"servoid {servoid.__version__}\n"
    assert run("identify", "nowhere.csv").returncode == 1
    wrong = run("identify")
    assert wrong.returncode == 2 and "Usage: servoid identify" in wrong.stderr
    demo = run("demo", "--out", str(tmp_path / "demo"))
    assert demo.returncode == 0 and (tmp_path / "demo" / "report.html").exists()


@pytest.mark.skipif(os.name == "nt", reason="signals are others there")
def test_ctrl_c_ends_the_program():
    program = os.path.join(os.path.dirname(sys.executable), "servoid")
    arguments = [program, "plan", "--no-rig", "--servo-model", "--reference", "stairs", "--amplitude", "20"]
    process = subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    time.sleep(1.0)
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=10) == -signal.SIGINT

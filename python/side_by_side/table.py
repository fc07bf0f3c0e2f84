"""Identify the same recordings with several tools, and print the table of docs/side-by-side.md.

    pip install servoid -r python/side_by_side/requirements.txt
    python python/side_by_side/table.py                  # all tools, 100 seeds; some minutes
    python python/side_by_side/table.py --seeds 20 servoid numpy
"""

import argparse
import contextlib
import importlib
import inspect
import io
import time
from importlib.metadata import version

import data
import numpy as np
from answer import padded

# Name of the package that a tool comes in.
TOOLS = {
    "servoid": "servoid",
    "numpy": "numpy",
    "control": "control",
    "sysidentpy": "sysidentpy",
    "sippy": "sippy_unipi",
    "mujoco": "mujoco",
}
# A machine needs the motion of a shaft; a motor's speed is none.
NOT_OF_A_SHAFT = {"mujoco"}
# MuJoCo takes seconds for each recording.
FEWER_SEEDS = {"mujoco": 5}


def lines(module):
    """Lines of code of a tool, without empty ones and texts."""
    source = inspect.getsource(module).replace(f'"""{module.__doc__}"""', "")
    return sum(bool(line.strip()) and not line.strip().startswith("#") for line in source.splitlines())


def fit_percent(answer, task):
    """100 for a perfect simulation of what was held back, 0 for one no better than the mean."""
    # Where the rest before a run is not known, its first samples answer an input that nobody has seen.
    skipped = 3 * task.settling if task.before is None else 0
    errors, measured = [], []
    for u, y in task.unseen:
        found = np.asarray(answer.simulate(padded(u, task)))[-len(y) :]
        errors.append((y - found)[skipped:])
        measured.append(y[skipped:])
    error, y = np.concatenate(errors), np.concatenate(measured)
    return 100.0 * (1.0 - np.linalg.norm(error) / np.linalg.norm(y - y.mean()))


def identify(module, task):
    """The answer, and the processor's seconds."""
    began = time.process_time()
    # Some tools talk while they work.
    with contextlib.redirect_stdout(io.StringIO()):
        answer = module.identify(task)
    return answer, time.process_time() - began


def held(module, colour, seeds):
    """Share of the points of the step response that 99 % bounds hold, and their mean half width (% of the step)."""
    inside, half = [], []
    for seed in range(seeds):
        answer, _ = identify(module, data.linear(1000 + seed, colour))
        if answer.lower is None:
            return None
        truth = data.true_step(len(answer.lower))
        # Before the servo moves every bound is about zero; what counts is the motion.
        moving = slice(data.DELAY_SAMPLES, None)
        inside.append(np.mean(((answer.lower <= truth) & (truth <= answer.upper))[moving]))
        half.append(50.0 * np.mean((answer.upper - answer.lower)[moving]))
    return 100.0 * float(np.mean(inside)), float(np.mean(half))


def row(name, seeds):
    """What the table says of a tool, as a dictionary."""
    module = importlib.import_module(f"by_{name}")
    found = {"tool": f"{name} {version(TOOLS[name])}", "lines": lines(module)}
    for task in (data.motor(), data.servo(), data.linear()):
        if task.before is None and name in NOT_OF_A_SHAFT:
            found[task.name] = None
            continue
        answer, seconds = identify(module, task)
        found[task.name] = fit_percent(answer, task), seconds
    for label, colour in (("white", 0.0), ("coloured", 0.9)):
        found[label] = held(module, colour, max(1, seeds // FEWER_SEEDS.get(name, 1)))
    return found


def text(value, form):
    """One cell."""
    return "–" if value is None else form.format(*value)


def printed(found):
    """The row in Markdown."""
    fits = [text(found[task], "{:.1f} %, {:.1f} s") for task in ("DC motor", "R/C servo", "simulated servo")]
    bounds = [text(found[noise], "{:.1f} % (±{:.2f})") for noise in ("white", "coloured")]
    return f"| {' | '.join([found['tool'], str(found['lines']), *fits, *bounds])} |"


HEAD = """| tool | lines | DC motor | R/C servo | simulated servo | bounds hold, white noise | bounds hold, coloured noise |
|---|---|---|---|---|---|---|"""


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tools", nargs="*", metavar="TOOL", help=f"which tools: {', '.join(TOOLS)} (all)")
    parser.add_argument("--seeds", type=int, default=100, help="recordings for each share of bounds (100)")
    options = parser.parse_args()
    unknown = set(options.tools) - set(TOOLS)
    if unknown:
        parser.error(f"there is no tool {', '.join(sorted(unknown))}: choose from {', '.join(TOOLS)}")
    print(HEAD)
    for name in options.tools or TOOLS:
        try:
            found = row(name, options.seeds)
        except ModuleNotFoundError as missing:
            remedy = "pip install -r python/side_by_side/requirements.txt"
            parser.exit(1, f"the row of {name} cannot be made, since the package {missing.name} is not installed: {remedy}\n")
        print(printed(found), flush=True)


if __name__ == "__main__":
    main()

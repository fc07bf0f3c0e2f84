"""The notebooks run as they stand, and print what is stored in them."""

import re
from pathlib import Path

import pytest

NOTEBOOKS = Path(__file__).parent.parent / "notebooks"
NEEDED = ("ipykernel", "jsbsim", "matplotlib", "nbclient")
# One run takes some seconds; a kernel that hangs ends here.
LIMIT_S = 100
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?")
# Sums in another order, as of another processor, change the ninth digit of what is fitted. Nothing is known to six.
ROUNDING = 1e-6


def printed(cell):
    """What a cell has printed and shown, without its figures: their pixels are matplotlib's."""
    texts = [output["text"] for output in cell.get("outputs", []) if output["output_type"] == "stream"]
    results = [
        output["data"]["text/plain"] for output in cell.get("outputs", []) if output["output_type"] == "execute_result"
    ]
    return "".join(texts + results)


def assert_the_same(after, before, source):
    """The same text, with the same numbers but for rounding."""
    assert NUMBER.sub("#", after) == NUMBER.sub("#", before), source
    after, before = (list(map(float, NUMBER.findall(text))) for text in (after, before))
    assert after == pytest.approx(before, rel=ROUNDING, abs=0), source


def figures(cell):
    """Number of figures of a cell."""
    return sum("image/png" in output.get("data", {}) for output in cell.get("outputs", []))


@pytest.mark.parametrize("name", ["tutorial", "paper"])
def test_a_notebook_prints_what_is_stored_in_it(name, tmp_path, needed):
    for module in NEEDED:
        needed(module)
    import nbclient
    import nbformat
    from jupyter_client.manager import AsyncKernelManager

    stored = nbformat.read(NOTEBOOKS / f"{name}.ipynb", as_version=4)
    run = nbformat.from_dict(stored)
    for cell in run.cells:
        cell.pop("outputs", None)
        if cell.cell_type == "code":
            cell.outputs = []
    # A kernel behind files and not ports: nothing of it can be reached from elsewhere.
    manager = AsyncKernelManager(kernel_name="python3", transport="ipc", ip=str(tmp_path / "kernel"))
    nbclient.NotebookClient(run, km=manager, timeout=LIMIT_S).execute()
    for before, after in zip(stored.cells, run.cells, strict=True):
        assert_the_same(printed(after), printed(before), before.source)
        assert figures(after) == figures(before), before.source
    assert sum(map(figures, run.cells)) > 3


@pytest.mark.parametrize("name", ["tutorial", "paper"])
def test_a_notebook_is_small(name):
    assert (NOTEBOOKS / f"{name}.ipynb").stat().st_size < 300_000

"""The comparison with other tools, in short: those that the tests have anyway, and few seeds."""

import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).parent.parent / "side_by_side"
SEEDS = 10


@pytest.fixture(scope="module")
def table(needed):
    needed("control")
    sys.path.insert(0, str(FOLDER))
    try:
        import table

        yield {name: table.row(name, SEEDS) for name in ("servoid", "numpy", "control")}
    finally:
        sys.path.remove(str(FOLDER))


def test_a_linear_servo_is_found_by_all(table):
    for name, found in table.items():
        for task in ("DC motor", "simulated servo"):
            # The page has 96.6 and 97.7 % for the least of them.
            assert found[task][0] > 96.0, (name, task)


def test_large_strokes_need_a_servo_model(table):
    # 86.5 % and 45 %.
    assert table["servoid"]["R/C servo"][0] > table["numpy"]["R/C servo"][0] + 30.0


def test_bounds_hold_under_coloured_noise_where_its_colour_is_estimated(table):
    for noise in ("white", "coloured"):
        # Points of one curve stand and fall together. Over ten recordings the share scatters by about 1.5 %.
        assert table["servoid"][noise][0] > 95.0, noise
    assert table["numpy"]["white"][0] > 95.0
    assert table["control"]["white"] is None

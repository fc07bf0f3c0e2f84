"""What the tests share."""

import importlib
import os

import pytest


@pytest.fixture(scope="session")
def needed():
    """Imports a module that a test needs. Where it is missing the test is skipped, and fails in continuous integration."""

    def module(name):
        if "CI" not in os.environ:
            pytest.importorskip(name, reason=f"SKIPPED: the test needs {name}")
        return importlib.import_module(name)

    return module

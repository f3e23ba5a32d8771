"""The notebook of the guide that needs Mitsuba; skipped without it."""
import importlib.util

import pytest

from conftest import NOTEBOOK_FOLDER, run_notebook


@pytest.mark.skipif(not importlib.util.find_spec("mitsuba"), reason="Mitsuba is not installed")
def test_the_notebook_runs():
    run_notebook(NOTEBOOK_FOLDER / "beside_mitsuba.ipynb")

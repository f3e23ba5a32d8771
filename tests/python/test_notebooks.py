"""The notebooks of the guide run, and hold their outputs with pictures. test_beside_mitsuba.py runs the one that needs Mitsuba."""
import json

import pytest

from conftest import NOTEBOOK_FOLDER as FOLDER, run_notebook

NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))


@pytest.mark.parametrize("file", [f for f in NOTEBOOKS if f.stem != "beside_mitsuba"], ids=lambda f: f.stem)
def test_a_notebook_runs(file):
    run_notebook(file)


@pytest.mark.parametrize("file", NOTEBOOKS, ids=lambda f: f.stem)
def test_a_notebook_holds_its_outputs(file):
    text = file.read_text()
    assert len(text) < 300_000
    cells = json.loads(text)["cells"]
    outputs = [o for c in cells for o in c.get("outputs", [])]
    assert all(c["execution_count"] for c in cells if c["cell_type"] == "code")
    assert not [o for o in outputs if o["output_type"] == "error" or o.get("name") == "stderr"]
    assert "data:image/png;base64," in text or '"image/png"' in text
    assert f"[{file.stem}]({file.name})" in (FOLDER / "README.md").read_text()


def test_all_are_there():
    assert len(NOTEBOOKS) >= 5

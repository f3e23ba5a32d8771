"""The notebooks of the guide run, and hold their outputs with pictures."""
import importlib.util
import json
import os
import pathlib

import pytest

import burnish

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "docs" / "guide" / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))


def has_mitsuba():
    return importlib.util.find_spec("mitsuba") is not None


@pytest.mark.parametrize("file", NOTEBOOKS, ids=lambda f: f.stem)
def test_a_notebook_runs(file):
    nbformat = pytest.importorskip("nbformat", reason="nbformat is not installed")
    nbclient = pytest.importorskip("nbclient", reason="nbclient is not installed")
    pytest.importorskip("ipykernel", reason="ipykernel is not installed")
    if file.stem == "beside_mitsuba" and not has_mitsuba():
        pytest.skip("Mitsuba is not installed")
    notebook = nbformat.read(file, as_version=4)
    with_package = os.pathsep.join([str(pathlib.Path(burnish.__file__).parents[1]), os.environ.get("PYTHONPATH", "")])
    client = nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": file.parent}})
    client.execute(env={**os.environ, "PYTHONPATH": with_package})


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

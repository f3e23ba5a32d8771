"""What the tests share: a small goblet, its target, and the program to compare with."""
import os
import pathlib
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from threading import Barrier

import burnish
import pytest

NAME = "mat-goblet.roughness"
ROOT = pathlib.Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples" / "python"
NOTEBOOK_FOLDER = ROOT / "docs" / "guide" / "notebooks"


def two_ranks() -> list[burnish.Ranks]:
    """Those of two processes, which are threads here."""
    barrier, boxes = Barrier(2), [[], []]

    def ranks_of(rank):
        def exchange(messages):
            boxes[rank] = messages
            barrier.wait(60)
            came = [box[rank] for box in boxes]
            barrier.wait(60)
            return came

        return burnish.Ranks(rank, 2, exchange)

    return [ranks_of(0), ranks_of(1)]


def in_two_ranks(work):
    """What work(ranks) returns in each of two processes."""
    with ThreadPoolExecutor(2) as threads:
        return list(threads.map(work, two_ranks()))


def losses_of(example, small, iterations):
    """What an example prints, which recovers the texture of a scene of the fixture `small`."""
    done = subprocess.run([sys.executable, EXAMPLES / example, small / "scene.xml", small / "target.exr", NAME, small / "found.exr",
                           str(iterations)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert burnish.read_image(small / "found.exr").shape[:2] == (32, 32)
    return [float(x) for x in re.findall(r"(?:loss|->) ([0-9.e+-]+)", done.stdout)]


def run_notebook(file):
    nbformat = pytest.importorskip("nbformat", reason="nbformat is not installed")
    nbclient = pytest.importorskip("nbclient", reason="nbclient is not installed")
    pytest.importorskip("ipykernel", reason="ipykernel is not installed")
    notebook = nbformat.read(file, as_version=4)
    with_package = os.pathsep.join([str(pathlib.Path(burnish.__file__).parents[1]), os.environ.get("PYTHONPATH", "")])
    client = nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": file.parent}})
    client.execute(env={**os.environ, "PYTHONPATH": with_package})


@pytest.fixture(scope="session")
def scene(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    folder = tmp_path_factory.mktemp("goblet")
    burnish.write_scene("goblet", folder, texture_size=32)
    return folder / "scene.xml"


@pytest.fixture(scope="session")
def renderer(scene: pathlib.Path) -> burnish.Renderer:
    return burnish.load(scene, size=(32, 32))


@pytest.fixture(scope="session")
def target(renderer: burnish.Renderer):
    return renderer.render(spp=256, seed=7)


@pytest.fixture(scope="session")
def small(tmp_path_factory, renderer, target):
    """A scene whose film is as small as the target, and the target's file."""
    folder = tmp_path_factory.mktemp("small")
    burnish.write_scene("goblet", folder, texture_size=32)
    text = (folder / "scene.xml").read_text()
    text, count = re.subn(r'(<default name="res[xy]" value=)"\d+"', r'\1"32"', text)
    assert count == 2
    (folder / "scene.xml").write_text(text)
    burnish.write_image(folder / "target.exr", target)
    return folder


@pytest.fixture
def problem(renderer, target) -> burnish.Problem:
    return burnish.Problem(renderer, target, burnish.Unknown(NAME, start=0.5))


@pytest.fixture(scope="session")
def program() -> str:
    path = os.environ.get("BURNISH_BINARY")
    if not path:
        pytest.skip("BURNISH_BINARY does not name the program")
    return path

"""What the tests share: a small goblet, its target, and the program to compare with."""
import os
import pathlib
from concurrent.futures import ThreadPoolExecutor
from threading import Barrier

import burnish
import pytest

NAME = "mat-goblet.roughness"


def in_two_ranks(work):
    """What work(ranks) returns in each of two processes, which are threads here."""
    barrier, boxes = Barrier(2), [[], []]

    def run(rank):
        def exchange(messages):
            boxes[rank] = messages
            barrier.wait(60)
            came = [box[rank] for box in boxes]
            barrier.wait(60)
            return came

        return work(burnish.Ranks(rank, 2, exchange))

    with ThreadPoolExecutor(2) as threads:
        return list(threads.map(run, range(2)))


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


@pytest.fixture
def problem(renderer, target) -> burnish.Problem:
    return burnish.Problem(renderer, target, burnish.Unknown(NAME, start=0.5))


@pytest.fixture(scope="session")
def program() -> str:
    path = os.environ.get("BURNISH_BINARY")
    if not path:
        pytest.skip("BURNISH_BINARY does not name the program")
    return path

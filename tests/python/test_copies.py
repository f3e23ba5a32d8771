"""Copies and pickles of what is made of values, and how it shows itself in text."""
import copy
import pickle

import numpy as np
import pytest

import burnish

from conftest import NAME

TO_WORLD = [[0, 0, 1, 1], [0, 1, 0, 2], [-1, 0, 0, 3], [0, 0, 0, 1]]
IMAGE = np.linspace(0.1, 0.9, 24, dtype=np.float32).reshape(2, 4, 3)
ENVIRONMENT = burnish.Environment(IMAGE, scale=2, to_world=TO_WORLD)


def copies(value):
    yield from (copy.copy(value), copy.deepcopy(value), *(pickle.loads(pickle.dumps(value, p)) for p in range(2, pickle.HIGHEST_PROTOCOL + 1)))


@pytest.mark.parametrize("value", [
    burnish.Sensor(), burnish.Sensor("first", 8, 6), burnish.Lens(), burnish.Lens("fisheye", [0.1, 0.2]),
    burnish.Lens("brown_conrady", [0.1] * 8), burnish.Camera(8, 6, 9), burnish.Environment(), ENVIRONMENT,
    burnish.Camera(8, 6, 9, 10, 3, 4, TO_WORLD, burnish.Lens("fisheye", [0.1])), burnish.Lighting(),
    burnish.Lighting([]), burnish.Lighting(["lamp"], ENVIRONMENT),
], ids=repr)
def test_copies_are_equal(value):
    for other in copies(value):
        assert other == value and other is not value and type(other) is type(value)


def test_the_copy_of_a_renderer_is_the_renderer(renderer):
    assert copy.copy(renderer) is renderer and copy.deepcopy([renderer])[0] is renderer
    with pytest.raises(TypeError):
        pickle.dumps(renderer)


@pytest.mark.parametrize("view", [
    burnish.View(IMAGE), burnish.View(IMAGE, np.ones((2, 4)), "left", burnish.Camera(4, 2, 5), burnish.Lighting(["lamp"], ENVIRONMENT), "fit_rgb", True),
    burnish.View(IMAGE, camera=burnish.Sensor(1), exposure=(0.1, 2, 3)),
], ids=["few", "all", "sensor"])
def test_copies_of_views(view):
    for other in copies(view):
        np.testing.assert_array_equal(other.image, view.image)
        np.testing.assert_array_equal(other.mask, view.mask)
        for name in ("name", "camera", "lighting", "exposure", "held_out"):
            assert getattr(other, name) == getattr(view, name), name


@pytest.mark.parametrize("start, rate", [(None, None), (0.3, 0.01), (IMAGE, None)], ids=["searched", "number", "image"])
def test_copies_of_unknowns(start, rate):
    unknown = burnish.Unknown(NAME, start, rate)
    for other in (unknown, *copies(unknown)):
        assert (other.name, other.learning_rate) == (NAME, rate)
        if start is None:
            assert other.start is None
        else:
            np.testing.assert_array_equal(other.start, np.float32(start))


def test_a_changed_copy_leaves_the_original_alone():
    camera = burnish.Camera(8, 6, 9)
    view = burnish.View(IMAGE, camera=camera)
    for other in copies(camera):
        other.width = 7
    for other in copies(view):
        other.camera.width = 7
    assert camera.width == view.camera.width == 8
    for other in copies(burnish.Sensor("a")):
        other.name = "b"
        assert other == burnish.Sensor("b")


def test_a_subclass_is_copied_without_its_constructor():
    class Front(burnish.Sensor):
        def __init__(self):
            super().__init__("front", 8, 6)

    other = copy.deepcopy(Front())
    assert type(other) is Front and other == burnish.Sensor("front", 8, 6)


def test_a_broken_state_is_refused():
    for state in [(1, 2), ("sphere", []), 3]:
        with pytest.raises((TypeError, burnish.InputError)):
            burnish.Lens.__new__(burnish.Lens).__setstate__(state)


def test_texts(problem):
    assert repr(burnish.Lighting()) == "Lighting(emitters=None, environment=None)"
    assert repr(ENVIRONMENT) == "Environment(4 x 2 pixels, scale=2.0)" and repr(burnish.Environment()) == "Environment(None, scale=None)"
    assert repr(burnish.Lighting(["lamp"], ENVIRONMENT)) == "Lighting(emitters=('lamp',), environment=Environment(4 x 2 pixels, scale=2.0))"
    assert repr(burnish.Lens("fisheye", [0.5])) == "Lens('fisheye', (0.5, 0.0, 0.0, 0.0))"
    solver = burnish.Solver(problem)
    solver.step()
    assert repr(solver.state) == "State(1 iteration)"


def test_environments_share_an_image():
    turned = burnish.Environment(ENVIRONMENT, to_world=TO_WORLD)
    assert turned.image.__array_interface__["data"] == ENVIRONMENT.image.__array_interface__["data"]
    assert turned.scale is None and burnish.Environment(burnish.Environment()).image is None


def test_a_pickle_has_an_image_that_environments_share_once():
    sky = burnish.Environment(np.ones((64, 128, 3)))
    views = [burnish.View(IMAGE, lighting=burnish.Lighting(environment=burnish.Environment(sky, scale=scale))) for scale in (1, 2)]
    pickled = pickle.dumps(views)
    assert len(pickled) < 1.5 * sky.image.nbytes
    for others in (pickle.loads(pickled), copy.deepcopy(views)):
        places = {view.lighting.environment.image.__array_interface__["data"] for view in others}
        assert len(places) == 1 and [view.lighting.environment.scale for view in others] == [1, 2]

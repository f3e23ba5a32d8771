"""No input ends the interpreter: every one is an exception with a sentence."""
import fractions
import importlib.util
import itertools
import json
import math
import os
import shutil
import warnings

import numpy as np
import pytest

import burnish

from conftest import NAME


def test_the_family_of_exceptions():
    assert issubclass(burnish.InputError, burnish.Error) and issubclass(burnish.InputError, ValueError)
    assert issubclass(burnish.ResourceError, burnish.Error) and issubclass(burnish.ResourceError, RuntimeError)


def test_the_sentence_is_that_of_the_library(scene, tmp_path):
    with pytest.raises(burnish.InputError, match=r"missing\.xml"):
        burnish.load(tmp_path / "missing.xml")
    bad = tmp_path / "bad.xml"
    bad.write_text("<scene version='3.0.0'>\n  <shape type='blob'/>\n</scene>")
    with pytest.raises(burnish.InputError, match=r"bad\.xml:2:\d+: .*blob"):
        burnish.load(bad)
    for wrong in [None, 3, object(), "a\0b", b"\0"]:
        with pytest.raises((TypeError, ValueError)):
            burnish.load(wrong)


def test_a_size_belongs_to_the_constants_of_a_renderer(renderer, target):
    for name, expected in [("mat-goblet.metallic:16", r"brdf_0\.metallic\.value is a constant: expected a renderer that was loaded with "
                                                      "mat-goblet.metallic:16 among its constants"),
                           ("mat-goblet.roughness:16", "expected no size, which is for constants that a renderer is loaded with"),
                           ("mat-goblet.metalic:16", r"did you mean: mat-goblet\.brdf_0\.metallic\.value")]:
        with pytest.raises(burnish.InputError, match=expected):
            burnish.solve(burnish.Problem(renderer, target, burnish.Unknown(name, 0.5)), iterations=1)


def test_paths_need_not_be_utf8(scene, tmp_path):
    for path in (tmp_path / os.fsdecode(b"caf\xe9"), os.fsencode(tmp_path) + b"/caf\xe9"):
        with pytest.raises(burnish.InputError, match=r"caf\\xe9"):
            burnish.load(path)
    with pytest.raises(burnish.OutputError, match=r"caf\\xe9"):
        burnish.write_image(tmp_path / os.fsdecode(b"caf\xe9") / "picture.png", np.zeros((2, 2, 3)))
    folder = tmp_path / os.fsdecode(b"caf\xe8")
    shutil.copytree(scene.parent, folder)
    burnish.write_image(folder / "view.exr", np.ones((256, 256, 3)))
    (folder / "capture.json").write_text(json.dumps({"version": 1, "scene": "scene.xml",
                                                     "views": [{"image": "view.exr", "camera": {"sensor": 0}}]}))
    capture = burnish.read_capture(folder / "capture.json")
    assert os.path.samefile(capture.scene, folder / "scene.xml") and "caf" in repr(capture) and "View(" in repr(capture.views[0])
    assert burnish.load(capture.scene).width > 0


def test_odd_numbers_and_texts_have_a_sentence(renderer, target, problem):
    for call in (lambda: renderer.render({NAME: 10**400}), lambda: burnish.View(target, exposure=10**400),
                 lambda: burnish.Unknown(NAME, 10**400), lambda: burnish.read_photograph("a.png", 10**400),
                 lambda: burnish.Solver(problem, learning_rate=10**400)):
        with pytest.raises(burnish.InputError, match="expected a"):
            call()
    for call in (lambda: renderer.render({"\ud800": 0.5}), lambda: renderer.gradient(target, "\ud800"),
                 lambda: renderer.gradient(target, ["\ud800"]), lambda: burnish.View(target, exposure="\ud800"),
                 lambda: burnish.read_photograph("a.png", "\ud800"), lambda: burnish.Solver(problem, estimator="\ud800"),
                 lambda: burnish.Solver(burnish.Problem(renderer, target, "\ud800"))):
        with pytest.raises(burnish.InputError, match="ud800"):
            call()
    for call, message in [(lambda: renderer.gradient(target, 3), "parameters: expected names of parameters, found 3"),
                          (lambda: burnish.Problem(renderer, target, 3), "unknowns: expected names or Unknowns, found 3")]:
        with pytest.raises(TypeError, match=message):
            call()
    with pytest.raises(burnish.InputError, match="spp: expected a whole number from 2 to 1048576, found 1048577"):
        burnish.Solver(problem, pyramid_levels=1).evaluate(2**20 + 1)
    for spp in (0, 2**20 + 1, 2**40):
        with pytest.raises(burnish.InputError, match=f"^spp: expected a whole number from 1 to 1048576, found {spp}$"):
            renderer.render(spp=spp)
    assert "\ud800" not in renderer.parameters
    with pytest.raises(TypeError, match="has no option"):
        burnish.Solver(problem, **{"\ud800": 1})
    for ranks in (3, burnish.Ranks("0", 1, list), burnish.Ranks(0, 10**400, list)):
        with pytest.raises(TypeError, match="expected a burnish.Ranks of whole numbers"):
            burnish.Problem(renderer, target, NAME, ranks=ranks)


@pytest.mark.parametrize("call, message", [
    (lambda r, p, t: burnish.solve(p, callback=3), "callback: expected a function, found 3"),
    (lambda r, p, t: burnish.solve(p, progress="bar"), "progress: expected a function, found 'bar'"),
    (lambda r, p, t: burnish.Problem(r, t, NAME, ranks=burnish.Ranks(0, 1, 3)),
     "Ranks.exchange: expected a function of a list of bytes, found 3"),
    (lambda r, p, t: burnish.Problem(r, t, NAME, "l1"),
     "loss: expected a function of an image and the number of a view, found 'l1'; losses by name are options of solve"),
    (lambda r, p, t: burnish.load("a.xml", definitions=["a"]), "definitions: expected a mapping of names to values, found list"),
    (lambda r, p, t: r.gradient(t, [NAME, 3]), "parameters: expected names of parameters, found 3 among them"),
    (lambda r, p, t: r.render(t), "textures: expected a mapping of names to arrays, found ndarray"),
])
def test_messages_say_what_was_found(renderer, problem, target, call, message):
    with pytest.raises(TypeError) as raised:
        call(renderer, problem, target)
    assert str(raised.value) == message


def test_values_in_the_place_of_names_are_refused(renderer, target, problem):
    found = burnish.solve(problem, iterations=1, evaluation_spp=2).textures
    for values in ({NAME: 0.9}, {}, found, renderer.parameters):
        with pytest.raises(TypeError, match=r"^unknowns: found \w+, expected names or Unknowns; .* Unknown\(name, start=\.\.\.\)$"):
            burnish.Problem(renderer, target, values)
        with pytest.raises(TypeError, match=r"^parameters: found \w+, expected names of parameters; .* textures=\{\.\.\.\}$"):
            renderer.gradient(target, values, spp=1)
    assert list(renderer.gradient(target, {NAME: 0.9}.keys(), spp=1)) == [NAME]


def test_misspelled_options_are_guessed(problem):
    for call in (burnish.solve, burnish.Solver):
        with pytest.raises(TypeError, match="did you mean 'iterations'"):
            call(problem, itertions=3)


@pytest.mark.parametrize("options, message", [
    (dict(spp=0), "spp: expected a whole number from 1 to 4096, found '0'"),
    (dict(spp=1.5), "spp: expected"),
    (dict(spp="many"), "spp: expected"),
    (dict(spp=10**30), "spp: expected"),
    (dict(iterations=-1), "iterations: expected"),
    (dict(time=math.inf), "time: expected"),
    (dict(time=math.nan), "time: expected"),
    (dict(learning_rate=0), "learning_rate: expected"),
    (dict(learning_rate=1e-46), "learning_rate: expected a number above 1e-36"),
    (dict(estimator="best"), "estimator: expected one of path_cache, mc"),
    (dict(loss=lambda image: 0), "loss: expected one of relmse"),
    (dict(adam_gate=2), "adam_gate: expected"),
    (dict(path_cache_window=[1]), "path_cache_window: expected"),
    (dict(estimator="mc", path_cache_window=3), "path_cache_window needs the estimator path_cache"),
    (dict(gradient_spp=3), "gradient_spp needs the estimator mc"),
    (dict(estimator="ris", reservoirs_merge="balance"), "reservoirs_merge needs"),
])
def test_options_out_of_range(problem, options, message):
    with pytest.raises((burnish.InputError, TypeError), match=message):
        burnish.solve(problem, **options)


def own_loss(image, view):
    return float((image**2).mean()), 2 * image / image.size


IMAGE = np.full((32, 32), 0.5)


@pytest.mark.parametrize("name, value, start, rate, loss, needs", [
    ("loss", "l1", 0.5, None, own_loss, "a problem without a loss of its own"),
    ("learning_rate", 0.1, 0.5, 0.01, None, "an unknown without a learning rate of its own"),
    ("search_again", 8, 0.5, None, None, "an unknown whose start is searched"),
    ("search_again", 8, None, None, own_loss, "an unknown whose start is searched"),
    ("search_effort", 2, IMAGE, None, None, "an unknown whose start is searched"),
    ("unvisited", "keep", IMAGE, None, None, "a start that is searched or a number"),
    ("batch", 2, 0.5, None, None, "several views"),
])
def test_options_without_effect_are_refused(renderer, target, name, value, start, rate, loss, needs):
    problem = burnish.Problem(renderer, target, burnish.Unknown(NAME, start, rate), loss)
    for call in (burnish.solve, burnish.Solver):
        with pytest.raises(burnish.InputError, match=f"^{name} needs {needs}$"):
            call(problem, **{name: value})
    burnish.Solver(problem, **{name: None})


def test_options_with_an_effect_are_taken(renderer, target):
    options = dict(loss="l1", learning_rate=0.1, search_again=8, search_effort=1, unvisited="keep", batch=2)
    unknowns = [burnish.Unknown(NAME), burnish.Unknown("mat-goblet.base_color", IMAGE, 0.01)]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        burnish.Solver(burnish.Problem(renderer, [target, target], unknowns), **options)
        burnish.Solver(burnish.Problem(renderer, target, burnish.Unknown(NAME, 0.5), own_loss), learning_rate=0.1, unvisited="keep")


def test_options_that_the_scene_and_the_views_leave_without_effect_are_warned_of(renderer, target):
    views = [burnish.View(target), burnish.View(target, held_out=True)]
    with pytest.warns(UserWarning, match="batch has no effect above 1, the number of views that are fitted: found 2"):
        burnish.Solver(burnish.Problem(renderer, views, burnish.Unknown(NAME, 0.5)), batch=2)
    with pytest.warns(UserWarning, match="search_again has no effect: it needs a texture, not a constant, whose start is searched and whose"):
        burnish.Solver(burnish.Problem(renderer, target, [NAME, "mat-goblet.base_color"]), search_again=8)
    with pytest.warns(UserWarning, match="search_again has no effect in 2 iterations: the first search comes after 2, a quarter of 8"):
        burnish.Solver(burnish.Problem(renderer, target, NAME), search_again=8, iterations=2)
    with pytest.warns(UserWarning, match="levels has no effect above .*: found 30"):
        burnish.Solver(burnish.Problem(renderer, target, burnish.Unknown(NAME, 0.5)), pyramid_levels=30)


def test_rates_of_an_unknown_out_of_range(renderer, target):
    for rate in (math.inf, 1e39, 2e6, 1e-46):
        with pytest.raises(burnish.InputError, match=f"learning rate of {NAME} is .*, expected one above 1e-36, at most 1e.06"):
            burnish.Solver(burnish.Problem(renderer, target, burnish.Unknown(NAME, 0.5, learning_rate=rate)))


def test_none_is_the_default(problem):
    default = [i.loss for i in burnish.Solver(problem, iterations=1)]
    assert [i.loss for i in burnish.Solver(problem, iterations=1, spp=None, adam_gate=None, seed=0, estimator="path_cache")] == default
    assert [i.loss for i in burnish.Solver(problem, iterations=1, seed=np.uint8(1))] != default


def scalars(value):
    yield from (np.float32(value), np.float64(value), np.float16(value), np.array(value), fractions.Fraction(value))
    if importlib.util.find_spec("torch"):
        import torch

        yield torch.tensor(value)


def test_any_scalar_is_a_number(renderer, target, problem, tmp_path):
    expected = renderer.render({NAME: 0.5}, spp=1)
    picture = tmp_path / "picture.png"
    burnish.write_image(picture, target)
    for half in scalars(0.5):
        np.testing.assert_array_equal(renderer.render({NAME: half}, spp=1), expected)
        assert burnish.View(target, exposure=half).exposure == (0.5, 0.5, 0.5)
        assert burnish.Solver(burnish.Problem(renderer, target, burnish.Unknown(NAME, half))).textures[NAME].mean() == 0.5
        np.testing.assert_array_equal(burnish.read_photograph(picture, half)[0], burnish.read_photograph(picture, 0.5)[0])
        burnish.Solver(problem, learning_rate=half)
        with pytest.raises(burnish.InputError, match="spp: expected"):
            burnish.Solver(problem, spp=half)
    assert burnish.Solver(problem, spp=np.array(4), iterations=np.int64(1)).step().number == 0
    renderer.render({NAME: np.int64(1)}, spp=1)
    for true in (np.bool_(True), np.array(True)):
        burnish.Solver(problem, adam_gate=true)
        for progress in (np.logical_not(true), true):
            burnish.solve(problem, iterations=1, evaluation_spp=2, progress=progress)
        assert burnish.View(target, held_out=true).held_out


class OnlyArray:
    """As a tensor: no sequence, but numpy makes an array of it."""

    def __init__(self, values):
        self.values = values

    def __array__(self, *arguments, **keywords):
        return np.array(self.values, np.float32)


def rows(values):
    """The same numbers in several guises, as float32 has them."""
    yield from (values, np.array(values, np.float32), OnlyArray(values), np.array(values, np.float32).tolist())
    if importlib.util.find_spec("torch"):
        import torch

        yield torch.tensor(values)


def test_any_array_is_a_row_of_numbers(target):
    for exposure in rows((0.5, 1.0, 2.0)):
        assert burnish.View(target, exposure=exposure).exposure == (0.5, 1, 2)
    for coefficients in rows((0.5, 0.25)):
        assert burnish.Lens("fisheye", coefficients).coefficients == (0.5, 0.25, 0, 0)
    for matrix in rows(np.diag((1.0, -1.0, -1.0, 1.0)).tolist()):
        assert burnish.Camera(8, 8, 1, camera_to_world=matrix).camera_to_world.tolist() == np.diag((1, -1, -1, 1)).tolist()
    half = fractions.Fraction(1, 2)
    assert burnish.Lens("fisheye", [half]).coefficients[0] == burnish.View(target, exposure=[half] * 3).exposure[0] == 0.5


@pytest.mark.parametrize("make, expected", [
    (lambda target, wrong: burnish.View(target, exposure=wrong), "a number, three numbers, 'fit' or 'fit_rgb'"),
    (lambda target, wrong: burnish.Lens("fisheye", wrong), "a row of numbers"),
    (lambda target, wrong: burnish.Camera(8, 8, 1, camera_to_world=wrong), "four rows of four numbers"),
])
def test_what_is_no_row_of_numbers_is_said(target, make, expected):
    for wrong, error, found in [(np.zeros((2, 3)), burnish.InputError, r"found the shape \(2, 3\), expected {0}"),
                                (["a", "b", "c"], TypeError, "expected {0}, found an array of <U1"), (set(), TypeError, "expected {0}, found set$"),
                                ([[1], [1, 2]], TypeError, "expected {0}, found list"), (Exploding(), TypeError, "expected {0}, found Exploding")]:
        with pytest.raises(error, match=f": {found.format(expected)}"):
            make(target, wrong)


def test_masked_arrays(renderer, target):
    masked = np.ma.masked_array(target.copy(), mask=np.zeros(target.shape, bool))
    np.testing.assert_array_equal(burnish.View(masked).image, target)
    masked[:8] = np.ma.masked
    rows = list(masked)
    for call in (lambda: burnish.View(masked), lambda: burnish.View(target, mask=masked), lambda: burnish.encode_png(masked),
                 lambda: burnish.View(rows), lambda: burnish.View(tuple(rows)), lambda: burnish.View([list(row) for row in rows]),
                 lambda: renderer.gradient(masked, NAME, spp=1)):
        with pytest.raises(burnish.InputError, match=r"found a masked array, whose mask would be lost; expected its \.data or \.filled\(\), "
                                                     r"and for a View mask=~array\.mask$"):
            call()
    view = burnish.View(masked.data, mask=~masked.mask)
    assert view.mask[:8].max() == 0 and view.mask[8:].min() == 1


def test_none_has_a_sentence(target):
    for call, message in [(lambda: burnish.View(target, exposure=None), "exposure: expected a number, three numbers, 'fit' or 'fit_rgb', found NoneType"),
                          (lambda: burnish.read_views("transforms.json", exposure=None),
                           "exposure: expected a number, three numbers, 'fit' or 'fit_rgb', found NoneType"),
                          (lambda: burnish.View(target, held_out=None), "held_out: expected True or False, found None"),
                          (lambda: burnish.Sensor(None), "name: expected the id of a sensor or its number, found None")]:
        with pytest.raises((burnish.InputError, TypeError), match=f"^{message}"):
            call()
    assert burnish.View(target, lighting=None).lighting == burnish.Lighting()


def test_a_sensor_is_no_truth(target):
    for wrong in (True, False, 1.0):
        with pytest.raises(TypeError, match=f"^name: expected the id of a sensor or its number, found {wrong}$"):
            burnish.Sensor(wrong)
    with pytest.raises(burnish.InputError, match="^name: expected a whole number from 0"):
        burnish.Sensor(-1)
    assert burnish.Sensor(np.int64(2)) == burnish.Sensor("2")


class Liar:
    """Says that it is an array, and is none."""

    __array_interface__ = {"shape": (2, 2, 3), "typestr": "<f4", "version": 3, "data": None}


class Exploding:
    def __array__(self, *arguments, **keywords):
        raise RuntimeError("exploded")

    def __dlpack__(self, *arguments, **keywords):
        raise RuntimeError("exploded")


NOT_ARRAYS = [None, "text", b"bytes", {}, set(), object(), [], [[]], [[1, 2], [3]], np.array("x"), np.array([[object()]]),
              np.zeros((2, 2), complex), Liar(), Exploding(), lambda: 0, np.datetime64("2020")]
NUMBERS = [3, 3.0, np.zeros(())]  # for all texels, in the place of an array
WRONG_SHAPES = [np.zeros(shape, np.float32) for shape in [(3,), (0, 0, 3), (0, 4, 3), (4, 0, 3), (4, 4, 0), (4, 4, 2), (4, 4, 4),
                                                          (1, 2, 3, 4), (5, 5, 3), (5, 5), (40000, 1, 1)]]
WRONG_VALUES = [np.full((32, 32, 3), v, np.float32) for v in (np.nan, np.inf, -np.inf)] + [np.zeros((32, 32, 3), np.uint8),
                                                                                       np.zeros((32, 32, 3), bool)]


@pytest.mark.parametrize("wrong", NOT_ARRAYS + NUMBERS + WRONG_SHAPES + WRONG_VALUES, ids=lambda w: type(w).__name__ + str(getattr(w, "shape", "")))
def test_arrays_that_do_not_fit(renderer, wrong):
    def refused(call):
        with pytest.raises((TypeError, ValueError, AttributeError, burnish.Error)) as raised:
            call()
        assert len(str(raised.value)) > 10

    refused(lambda: renderer.gradient(wrong, NAME, spp=1))
    refused(lambda: burnish.Solver(burnish.Problem(renderer, [wrong], NAME)))
    if not any(wrong is number for number in NUMBERS):
        refused(lambda: renderer.render({NAME: wrong}, spp=1))
        if wrong is not None:  # searched
            refused(lambda: burnish.Solver(burnish.Problem(renderer, np.ones((32, 32, 3)), burnish.Unknown(NAME, wrong))))


@pytest.mark.parametrize("make, what", [
    (lambda renderer, wrong: burnish.View(wrong), "the image of the view"),
    (lambda renderer, wrong: renderer.gradient(wrong, NAME, spp=1), "the adjoint"),
    (lambda renderer, wrong: burnish.Environment(wrong), "the environment"),
])
def test_colours_have_three_channels(renderer, make, what):
    for shape in [(32, 32), (32, 32, 1), (3, 32, 32)]:
        with pytest.raises(burnish.InputError) as raised:
            make(renderer, np.ones(shape))
        assert str(raised.value) == f"{what}: found the shape {shape}, expected (height, width, 3)"


def test_anything_that_is_an_array(renderer):
    values = np.random.default_rng(0).uniform(0.2, 0.8, (32, 32)).astype(np.float32)
    expected = renderer.render({NAME: values}, spp=1)
    for same in [values[..., None], np.asfortranarray(values), values[::-1][::-1], np.repeat(values, 2, 1)[:, ::2], values.tolist(),
                 values.astype(float), memoryview(values), values.astype(">f4"), np.lib.stride_tricks.as_strided(values, values.shape,
                                                                                                              values.strides)]:
        np.testing.assert_array_equal(renderer.render({NAME: same}, spp=1), expected)

    picture = renderer.render(spp=1)
    for views, count in [(picture.tolist(), 1), (list(picture), 1), ([picture.tolist()] * 2, 2), ([picture, picture.tolist()], 2),
                         ((list(picture), picture), 2)]:
        text = "Problem(1 view, 1 unknown)" if count == 1 else "Problem(2 views, 1 unknown)"
        assert repr(burnish.Problem(renderer, views, NAME)) == text
        burnish.Solver(burnish.Problem(renderer, views, burnish.Unknown(NAME, 0.5)))
    endless = []
    endless.append(endless)
    with pytest.raises((TypeError, burnish.InputError)):
        burnish.Problem(renderer, endless, NAME)

    class OnlyDlpack:
        def __dlpack__(self, **keywords):
            return values.__dlpack__(**keywords)

        def __dlpack_device__(self):
            return values.__dlpack_device__()

    np.testing.assert_array_equal(renderer.render({NAME: OnlyDlpack()}, spp=1), expected)
    grey = np.float16(values)
    assert renderer.render({NAME: grey}, spp=1).shape == (32, 32, 3)


WILD = [None, -1, 0, 1, 2**40, -(2**70), 1.5, math.nan, "", "x", b"y", [], {}, (), object(), np.zeros((2, 2, 3)), np.nan, lambda *a: 1]


def test_wild_arguments(renderer, problem, target):
    """Every combination of odd values: an exception or a result, never the end of the process."""
    calls = [lambda a, b: renderer.render(a, b), lambda a, b: renderer.render(spp=1, seed=a, textures={b: a} if isinstance(b, str) else b),
             lambda a, b: renderer.gradient(target, a, b, spp=1), lambda a, b: renderer.gradient(a, spp=b),
             lambda a, b: burnish.View(a, b), lambda a, b: burnish.View(target, exposure=a, name=b),
             lambda a, b: burnish.View(target, camera=a, lighting=b), lambda a, b: burnish.Unknown(a, b),
             lambda a, b: burnish.Unknown(NAME, learning_rate=a), lambda a, b: burnish.Problem(renderer, a, b),
             lambda a, b: burnish.Problem(a, b, NAME), lambda a, b: burnish.Problem(renderer, target, NAME, a),
             lambda a, b: burnish.Solver(a, b), lambda a, b: burnish.Solver(problem, a, seed=b),
             lambda a, b: burnish.solve(problem, callback=a, progress=b, iterations=1, evaluation_spp=2),
             lambda a, b: burnish.load(a, size=b), lambda a, b: burnish.Camera(a, b, 1), lambda a, b: burnish.Lens(a, b),
             lambda a, b: burnish.Camera(8, 8, a, camera_to_world=b), lambda a, b: burnish.Environment(a, b),
             lambda a, b: burnish.Lighting(a, b), lambda a, b: burnish.State.from_bytes(a), lambda a, b: burnish.State.load(a),
             lambda a, b: burnish.Solver(problem, iterations=1).evaluate(a), lambda a, b: burnish.Solver(problem).image(a),
             lambda a, b: renderer.with_camera(burnish.Camera(8, 8, a)), lambda a, b: renderer.parameters[a],
             lambda a, b: burnish.read_image(a), lambda a, b: burnish.read_photograph(a, b), lambda a, b: renderer.with_camera(a)]
    for call, (a, b) in itertools.product(calls, itertools.product(WILD, WILD[::3])):
        try:
            call(a, b)
        except Exception as error:
            assert str(error), repr(error)


@pytest.mark.filterwarnings("ignore:nanobind")
def test_uninitialised_objects():
    for type_ in (burnish.Renderer, burnish.Solver, burnish.State, burnish.Problem, burnish.View, burnish.Summary):
        empty = type_.__new__(type_)
        for name in dir(empty):
            if name.startswith("__"):
                continue
            with pytest.raises(Exception):
                if callable(getattr(type_, name)):
                    getattr(empty, name)()
                else:
                    getattr(empty, name)


def test_what_is_equal_by_value_has_no_hash(problem):
    for make in (burnish.Sensor, burnish.Lens, burnish.Lighting, burnish.Environment, lambda: burnish.Camera(8, 8, 1),
                 lambda: burnish.Solver(problem).state):
        assert make() == make()
        with pytest.raises(TypeError, match="unhashable"):
            hash(make())


def test_a_camera_out_of_range(renderer):
    for camera in [burnish.Camera(0, 0, 1), burnish.Camera(-1, 5, 1), burnish.Camera(8, 8, math.nan), burnish.Camera(10**6, 10**6, 1),
                   burnish.Camera(8, 8, 1, camera_to_world=np.zeros((4, 4)))]:
        with pytest.raises(burnish.InputError):
            renderer.with_camera(camera)


def test_forks_are_refused(renderer):
    renderer.render(spp=1)
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            renderer.render(spp=1)
            os.write(write, b"rendered")
        except burnish.Error as error:
            os.write(write, str(error).encode())
        finally:
            os._exit(0)
    os.close(write)
    assert b"forked" in os.read(read, 1000)
    os.waitpid(child, 0)
    assert renderer.render(spp=1).max() > 0

"""Gradients against finite differences of pictures from the same random numbers."""
import pathlib
import sys

import numpy as np
import pytest

import burnish

from conftest import NAME

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "scenes"))
from agree_with_mitsuba import t_tail

ALPHA = 1e-6  # of each comparison: seven and two of a tenth, which kPythonAlpha of tests/ledger.h counts


@pytest.fixture(scope="module")
def adjoint(renderer):
    return np.random.default_rng(1).uniform(-1, 1, (renderer.height, renderer.width, 3)).astype(np.float32)


def test_shapes_and_names(renderer, adjoint):
    everything = renderer.gradient(adjoint, spp=1)
    assert list(everything) == list(renderer.parameters)
    for name, gradient in everything.items():
        assert gradient.shape == renderer.parameters.shapes[name]
    one = renderer.gradient(adjoint, NAME, spp=1)
    assert list(one) == [NAME]
    np.testing.assert_array_equal(one[NAME], renderer.gradient(adjoint, (n for n in [NAME]), spp=1)[NAME])
    assert (one[NAME] != renderer.gradient(adjoint, NAME, spp=1, seed=1)[NAME]).any()


SCENE = """<scene version="3.0.0">
    <integrator type="path"/>
    <sensor type="perspective"><film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="8"/></film>
        <transform name="to_world"><lookat origin="0, 0, 5" target="0, 0, 0" up="0, 1, 0"/></transform></sensor>
    <emitter type="constant"/>
    <texture type="bitmap" id="color"><string name="filename" value="color.exr"/><boolean name="raw" value="true"/></texture>
    <texture type="bitmap" id="other"><string name="filename" value="color.exr"/><boolean name="raw" value="true"/></texture>
    {}
</scene>"""


def scene_of(folder, *bsdfs):
    burnish.write_image(folder / "color.exr", np.full((4, 4, 3), 0.5, np.float32))
    (folder / "scene.xml").write_text(SCENE.format("".join(f'<shape type="sphere">{bsdf}</shape>' for bsdf in bsdfs)))
    return burnish.load(folder / "scene.xml")


def test_textures_that_are_given_are_no_unknowns(tmp_path):
    bsdf = '<bsdf type="diffuse" id="inner"><ref name="reflectance" id="color"/></bsdf>'
    weight = '<texture type="bitmap" name="weight"><string name="filename" value="color.exr"/><boolean name="raw" value="true"/></texture>'
    for k in range(6):  # more than can be recovered together
        bsdf = f'<bsdf type="blendbsdf" id="blend{k}">{weight}<bsdf type="diffuse"/>{bsdf}</bsdf>'
    renderer = scene_of(tmp_path, bsdf)
    name, = (n for n in renderer.parameters if "reflectance" in n)
    adjoint = np.ones((8, 8, 3), np.float32)
    expected = renderer.gradient(adjoint, name, spp=64)[name]  # one sample in 64 comes to it
    assert (expected != 0).any()
    np.testing.assert_array_equal(renderer.gradient(adjoint, name, textures=dict(renderer.parameters), spp=64)[name], expected)


def test_textures_of_emitters_are_not_replaced(tmp_path):
    lamp = '<emitter type="area"><ref name="radiance" id="color"/></emitter><bsdf type="diffuse" id="lamp"/>'
    renderer = scene_of(tmp_path, lamp, '<bsdf type="diffuse" id="floor"><ref name="reflectance" id="color"/></bsdf>')
    name, = renderer.parameters
    with pytest.raises(burnish.InputError, match="floor.* is a texture that an emitter reads, too"):
        renderer.render({name: 1.0}, spp=1)
    with pytest.raises(burnish.InputError, match="an emitter reads, too"):
        renderer.gradient(np.ones((8, 8, 3), np.float32), name, textures={name: 1.0}, spp=1)


def test_all_parameters_can_be_given(tmp_path):
    lamp = ('<point name="center" value="0, 3, 0"/><emitter type="area"><ref name="radiance" id="other"/></emitter>'
            '<bsdf type="diffuse" id="lamp"><ref name="reflectance" id="other"/></bsdf>')
    bsdfs = [f'<bsdf type="diffuse" id="{name}"><ref name="reflectance" id="color"/></bsdf>' for name in ("first", "second")]
    renderer = scene_of(tmp_path, lamp, *bsdfs)
    light, first, second = renderer.parameters
    adjoint = np.ones((8, 8, 3), np.float32)
    expected = renderer.gradient(adjoint, first, spp=1)[first]
    burnish.write_model(tmp_path / "expected.glb", renderer)
    everything = dict(renderer.parameters)
    for textures in (renderer.parameters, everything):
        np.testing.assert_array_equal(renderer.render(textures, spp=1), renderer.render(spp=1))
        np.testing.assert_array_equal(renderer.gradient(adjoint, first, textures, spp=1)[first], expected)
        burnish.write_model(tmp_path / "model.glb", renderer, textures)
        assert (tmp_path / "model.glb").read_bytes() == (tmp_path / "expected.glb").read_bytes()
    both = renderer.render({**everything, first: 0.2, second: 0.2}, spp=1)
    np.testing.assert_array_equal(both, renderer.render({second: 0.2}, spp=1))
    assert (both != renderer.render(spp=1)).any()
    with pytest.raises(burnish.InputError, match="first.* and second.* are one texture"):
        renderer.render({**everything, second: 0.2}, spp=1)
    with pytest.raises(burnish.InputError, match="lamp.* is a texture that an emitter reads, too"):
        renderer.render({**everything, light: 0.2}, spp=1)


def test_all_that_can_be_recovered_is_differentiated(tmp_path):
    first, second = (f'<bsdf type="diffuse" id="{name}"><ref name="reflectance" id="color"/></bsdf>' for name in ("first", "second"))
    smooth = '<bsdf type="plastic" id="smooth"><ref name="diffuse_reflectance" id="other"/></bsdf>'
    renderer = scene_of(tmp_path, first, second, smooth)
    names = list(renderer.parameters)
    assert len(names) == 3 and "smooth" in names[2]
    adjoint = np.ones((8, 8, 3), np.float32)
    everything = renderer.gradient(adjoint, spp=2)
    assert list(everything) == names[:1]
    np.testing.assert_array_equal(everything[names[0]], renderer.gradient(adjoint, names[1], spp=2)[names[1]])
    with pytest.raises(burnish.InputError, match="no texture that can be recovered"):
        scene_of(tmp_path, smooth).gradient(adjoint)


def two_sides(renderer, name, base, h, spp, seeds):
    """Independent estimates of both sides of <dL/dtheta, 1> = d/dh <A, I(theta + h)>, A = 1: no sum cancels."""
    adjoint = np.ones((renderer.height, renderer.width, 3), np.float32)
    gradients, differences = [], []
    for seed in range(seeds):
        gradient = renderer.gradient(adjoint, name, {name: base}, spp=spp, seed=1000 + seed)[name]
        gradients.append(gradient.sum(dtype=float))
        # Common random numbers: the pictures differ by their textures alone.
        plus, minus = (renderer.render({name: base + step}, spp=spp, seed=seed).sum(dtype=float) for step in (h, -h))
        differences.append((plus - minus) / (2 * h))
    return np.array(gradients), np.array(differences)


def welch(a, b):
    """The p-value that the means of a and b are the same."""
    va, vb = a.var(ddof=1) / len(a), b.var(ddof=1) / len(b)
    df = (va + vb) ** 2 / (va**2 / (len(a) - 1) + vb**2 / (len(b) - 1))
    return t_tail(abs(a.mean() - b.mean()) / (va + vb) ** 0.5, df)


@pytest.mark.parametrize("name, h, spp", [("mat-goblet.base_color", 0.1, 16), (NAME, 0.04, 64)])
def test_gradients_are_those_of_finite_differences(renderer, name, h, spp):
    gradients, differences = two_sides(renderer, name, 0.4, h, spp, seeds=24)
    assert welch(gradients, differences) > ALPHA, f"{gradients.mean()} and {differences.mean()}"
    # A gradient that is 20 % too large is not taken.
    assert welch(1.2 * gradients, differences) < ALPHA


SCENES = pathlib.Path(__file__).resolve().parents[1] / "data" / "scenes"


def test_weights_of_blends_have_the_slopes_of_pictures():
    """The pictures of either side take the weight for known, and are affine in it, beyond 0 and 1, too."""
    renderer = burnish.load(SCENES / "blend.xml", size=(24, 24))
    gradients, differences = two_sides(renderer, "weight", 0.5, 0.4, 48, seeds=24)
    assert welch(gradients, differences) > ALPHA, f"{gradients.mean()} and {differences.mean()}"
    assert welch(1.2 * gradients, differences) < ALPHA
    for end in (0, 1):
        _, differences = two_sides(renderer, "weight", end, 0.4, 48, seeds=24)
        assert welch(gradients, differences) > ALPHA / 10, f"{gradients.mean()} and {differences.mean()} at {end}"
        assert welch(1.2 * gradients, differences) < ALPHA / 10


DATA = pathlib.Path(__file__).resolve().parents[1] / "data" / "gradients"


BLENDS = DATA.parent / "blends"  # made by tests/scenes/blend_gradients.py


@pytest.mark.parametrize("scene, adjoint, derivative, name, spp", [
    (DATA / "gradient_nearest.xml", DATA / "gradient_nearest_adjoint.exr", DATA / "gradient_nearest_d_roughness", "mat.roughness", 48),
    (DATA / "gradient_bilinear.xml", DATA / "gradient_bilinear_adjoint.exr", DATA / "gradient_bilinear_d_metallic", "mat.metallic", 48),
    (BLENDS / "direct.xml", BLENDS / "adjoint.exr", BLENDS / "direct_d_weight", "two.weight", 256),
    (BLENDS / "path.xml", BLENDS / "adjoint.exr", BLENDS / "path_d_weight", "two.weight", 256)])
def test_gradients_are_those_of_mitsuba(scene, adjoint, derivative, name, spp):
    """Against the means of 16 runs of Mitsuba 3.9.1: each texel by Welch's t, with Bonferroni's correction."""
    renderer = burnish.load(scene)
    pixels = burnish.read_image(adjoint)
    expected, error = (burnish.read_image(f"{derivative}{part}.exr") for part in ("", "_stderr"))
    runs = np.stack([renderer.gradient(pixels, name, spp=spp, seed=s)[name] for s in range(16)]).astype(float)
    expected, error = (x.astype(float)[..., : runs.shape[-1]] for x in (expected, error))
    assert np.isfinite(runs).all()  # a texel that is not a number would not count as seen

    def p_value(factor):
        mean, own = factor * runs.mean(0), factor * runs.std(0, ddof=1) / 4
        seen = error + own > 0
        t = np.abs(mean - expected)[seen] / np.hypot(error, own)[seen]
        return t_tail(t.max(), 15) * seen.sum()  # 15: the fewest degrees of freedom that Welch's may have

    assert p_value(1) > ALPHA
    assert p_value(1.2) < ALPHA

"""burnish.jax; skipped without JAX."""
import re
import sys
import time

import numpy as np
import pytest

from conftest import NAME

try:
    import jax
    import jax.numpy as jnp
except ImportError:
    jax = None

pytestmark = pytest.mark.skipif(jax is None, reason="JAX is not installed")
COLOR = "mat-goblet.base_color"


def test_pictures_and_gradients_are_those_of_the_renderer(renderer):
    import burnish.jax

    adjoint = np.linspace(-1, 1, 32 * 32 * 3, dtype=np.float32).reshape(32, 32, 3)

    def loss(texels, seed):
        picture = burnish.jax.render(renderer, {NAME: texels}, spp=4, gradient_spp=2, seed=seed)
        return (picture * adjoint).sum(), picture

    texels = jnp.full((32, 32, 1), 0.4)
    for function in (jax.grad(loss, has_aux=True), jax.jit(jax.grad(loss, has_aux=True))):
        gradient, picture = function(texels, 3)
        np.testing.assert_array_equal(picture, renderer.render({NAME: 0.4}, spp=4, seed=3))
        np.testing.assert_array_equal(gradient, renderer.gradient(adjoint, NAME, {NAME: 0.4}, spp=2, seed=3)[NAME])


def test_later_calls_keep_nothing(renderer):
    import burnish.jax

    gradient = jax.grad(lambda texels, seed: burnish.jax.render(renderer, {NAME: texels}, spp=1, seed=seed).sum())
    texels = jnp.full((32, 32, 1), 0.4)
    jax.block_until_ready(gradient(texels, 0))
    kept = sys.getrefcount(renderer)
    for seed in range(1, 4):
        jax.block_until_ready(gradient(texels, seed))
    deadline = time.monotonic() + 10
    while sys.getrefcount(renderer) > kept and time.monotonic() < deadline:
        time.sleep(0.01)  # JAX lets go of a call after its result is there
    assert sys.getrefcount(renderer) <= kept


def test_bfloat16_is_a_type_of_numbers(renderer):
    import burnish.jax

    texels = jnp.full((32, 32, 1), 0.5, jnp.bfloat16)
    np.testing.assert_array_equal(renderer.render({NAME: texels}, spp=1), renderer.render({NAME: 0.5}, spp=1))
    gradient = jax.grad(lambda t: burnish.jax.render(renderer, {NAME: t}, spp=1, seed=3).sum())(texels)
    assert gradient.dtype == jnp.bfloat16
    expected = renderer.gradient(np.ones((32, 32, 3), np.float32), NAME, {NAME: 0.5}, spp=1, seed=3)[NAME]
    np.testing.assert_allclose(gradient.astype(jnp.float32), expected, rtol=0.01)


def test_each_texture_has_its_gradient(renderer):
    import burnish.jax

    textures = {NAME: jnp.full((32, 32), 0.4), COLOR: jnp.full((32, 32, 3), 0.4)}
    gradients = jax.grad(lambda t: burnish.jax.render(renderer, t, spp=1).mean())(textures)
    assert {n: g.shape for n, g in gradients.items()} == {NAME: (32, 32), COLOR: (32, 32, 3)}
    assert all(np.abs(g).max() > 0 for g in gradients.values())


def test_what_cannot_be_recovered_may_be_held_constant(scene):
    import burnish.jax

    color = (scene.parent / "textures" / "goblet_base_color.png").as_posix()
    ball = ('<shape type="sphere"><bsdf type="conductor" id="ball"><texture type="bitmap" name="specular_reflectance">'
            f'<string name="filename" value="{color}"/></texture></bsdf></shape></scene>')
    file = scene.parent / "with_ball.xml"
    file.write_text(scene.read_text().replace("</scene>", ball))
    renderer = burnish.load(file, size=(16, 16))
    held = {"ball.specular_reflectance": jnp.full((32, 32, 3), 0.7)}
    texels = jnp.full((32, 32, 1), 0.4)
    found = jax.grad(lambda t: burnish.jax.render(renderer, {NAME: t} | held, spp=1, seed=3).sum())(texels)
    adjoint = np.ones((16, 16, 3), np.float32)
    np.testing.assert_array_equal(found, renderer.gradient(adjoint, NAME, {NAME: 0.4} | held, spp=1, seed=3)[NAME])


def test_pictures_are_mapped_over_seeds_and_textures(renderer):
    import burnish.jax

    def picture(texels, seed):
        return burnish.jax.render(renderer, {NAME: texels}, spp=1, seed=seed)

    texels, seeds = jnp.stack([jnp.full((32, 32, 1), v) for v in (0.3, 0.6)]), jnp.arange(2)
    gradient = jax.grad(lambda t, seed: picture(t, seed).sum())
    expected = jnp.stack([gradient(t, int(s)) for t, s in zip(texels, seeds)])
    np.testing.assert_array_equal(jax.vmap(gradient)(texels, seeds), expected)
    np.testing.assert_array_equal(jax.vmap(picture, (None, 0))(texels[0], seeds), [picture(texels[0], s) for s in range(2)])


def test_seeds_are_whole_numbers(renderer):
    import burnish.jax

    def picture(seed):
        return burnish.jax.render(renderer, {NAME: jnp.full((32, 32, 1), 0.4)}, spp=1, seed=seed)

    for same in (3, np.int32(3), np.uint8(3), jnp.asarray(3)):
        np.testing.assert_array_equal(picture(same), renderer.render({NAME: 0.4}, spp=1, seed=3))
    for wrong in (1.7, jnp.asarray(1.7)):
        with pytest.raises(TypeError, match="seed: expected a whole number from 0 to 4294967295, found"):
            picture(wrong)
        with pytest.raises(TypeError, match="seed: expected a whole number from 0 to 4294967295, found one of float32"):
            jax.jit(picture)(wrong)
    for wrong in (-1, np.int32(-1), 2**32, np.int64(2**32)):
        with pytest.raises(burnish.InputError, match=f"seed: expected a whole number from 0 to 4294967295, found {wrong}"):
            picture(wrong)
    for call in (picture, jax.jit(picture)):
        with pytest.raises(TypeError, match="^seed: expected a whole number"):
            call(jnp.arange(2))
    with pytest.raises(Exception, match="seed: expected a whole number from 0 to 4294967295, found -1"):
        jax.jit(picture)(-1).block_until_ready()


def test_numbers_and_one_channel_are_for_all_texels_and_channels(renderer):
    import burnish.jax

    full = {NAME: jnp.full((32, 32, 1), 0.4), COLOR: jnp.full((32, 32, 3), 0.4)}
    few = {NAME: jnp.asarray(0.4), COLOR: jnp.full((32, 32), 0.4)}
    expected, found = (jax.grad(lambda t: burnish.jax.render(renderer, t, spp=1).mean())(textures) for textures in (full, few))
    np.testing.assert_allclose(found[NAME], expected[NAME].sum(), rtol=1e-4)
    np.testing.assert_allclose(found[COLOR], expected[COLOR].sum(-1), rtol=1e-4)
    with pytest.raises(burnish.InputError, match=r"found the shape \(32, 32, 3\), expected a number, \(32, 32\), \(32, 32, 1\)$"):
        burnish.jax.render(renderer, {NAME: full[COLOR]}, spp=1)


def test_what_does_not_fit_is_said(renderer):
    import burnish.jax

    texels = jnp.full((32, 32), 0.4)
    wrong = [({NAME: jnp.zeros((3, 3, 1))}, {}, burnish.InputError, f"{NAME}: found the shape (3, 3, 1), expected"),
             ({"nothing": texels}, {}, burnish.InputError, "no parameter is called 'nothing'"),
             ({NAME: texels, "roughness": texels}, {}, burnish.InputError, f"the texture roughness is the same as {NAME}"),
             ({NAME: texels}, {"spp": 0}, burnish.InputError, "spp: expected a whole number from 1 to 1048576, found 0"),
             ({NAME: texels}, {"spp": 2**20 + 1}, burnish.InputError, "spp: expected a whole number from 1 to 1048576, found 1048577"),
             ({NAME: texels}, {"spp": 1.5}, TypeError, "spp: expected a whole number from 1 to 1048576, found 1.5"),
             ({NAME: texels}, {"spp": True}, TypeError, "spp: expected a whole number from 1 to 1048576, found True"),
             ({NAME: texels}, {"gradient_spp": 0}, burnish.InputError, "gradient_spp: expected a whole number from 1"),
             ({NAME: texels.astype(jnp.uint8)}, {}, burnish.InputError, f"{NAME}: found uint8, expected linear values"),
             ({NAME: texels > 0}, {}, burnish.InputError, f"{NAME}: found bool, expected linear values"),
             ({NAME: texels + 1j}, {}, TypeError, f"{NAME}: expected an array of numbers, found one of complex64")]
    for textures, numbers, error, message in wrong:
        def picture(values):
            return burnish.jax.render(renderer, values, **{"spp": 1, **numbers})

        for call in (picture, jax.jit(picture)):
            with pytest.raises(error, match=f"^{re.escape(message)}"):
                call(textures)

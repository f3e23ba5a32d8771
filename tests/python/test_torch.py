"""burnish.torch, and the examples that use it; skipped without PyTorch."""
import numpy as np
import pytest

import burnish

from conftest import NAME, losses_of


@pytest.fixture(scope="session")
def torch():
    return pytest.importorskip("torch", reason="PyTorch is not installed")


def test_example_perceptual_loss(small, torch):
    losses = losses_of("perceptual_loss.py", small, 60)
    assert losses[-1] < 0.8 * losses[-2], losses


def test_example_neural_texture(small, torch):
    losses = losses_of("neural_texture.py", small, 100)
    assert losses[-1] < 0.8 * losses[0], losses


def test_pictures_and_gradients_are_those_of_the_renderer(renderer, torch):
    import burnish.torch

    texels = torch.full((32, 32, 1), 0.4, requires_grad=True)
    picture = burnish.torch.render(renderer, {NAME: texels}, spp=4, gradient_spp=2, seed=3)
    np.testing.assert_array_equal(picture.detach().numpy(), renderer.render({NAME: 0.4}, spp=4, seed=3))
    adjoint = torch.linspace(-1, 1, 32 * 32 * 3).reshape(32, 32, 3)
    (picture * adjoint).sum().backward()
    expected = renderer.gradient(adjoint, NAME, {NAME: 0.4}, spp=2, seed=3)[NAME]
    np.testing.assert_array_equal(texels.grad.numpy(), expected)


def test_bfloat16_is_a_type_of_numbers(renderer, torch):
    import burnish.torch

    texels = torch.full((32, 32, 1), 0.5, dtype=torch.bfloat16, requires_grad=True)
    picture = burnish.torch.render(renderer, {NAME: texels}, spp=1, seed=3)
    picture.sum().backward()
    assert picture.dtype == texels.grad.dtype == torch.bfloat16
    expected = renderer.gradient(np.ones((32, 32, 3), np.float32), NAME, {NAME: 0.5}, spp=1, seed=3)[NAME]
    np.testing.assert_allclose(texels.grad.float().numpy(), expected, rtol=0.01)


def test_only_what_is_wanted_is_differentiated(renderer, torch):
    import burnish.torch

    fixed = torch.full((32, 32), 0.4, dtype=torch.float64)
    color = torch.full((32, 32, 3), 0.4, dtype=torch.float64, requires_grad=True)
    picture = burnish.torch.render(renderer, {NAME: fixed, "mat-goblet.base_color": color}, spp=1)
    assert picture.dtype == torch.float64
    picture.mean().backward()
    assert fixed.grad is None and color.grad.shape == color.shape and color.grad.abs().max() > 0
    with torch.no_grad():
        assert not burnish.torch.render(renderer, {NAME: fixed}, spp=1).requires_grad
    with pytest.raises(burnish.InputError):
        burnish.torch.render(renderer, {NAME: torch.zeros(3, 3, 1, requires_grad=True)}, spp=1)


def test_numbers_and_one_channel_are_for_all_texels_and_channels(renderer, torch):
    import burnish.torch

    color = "mat-goblet.base_color"
    full = {NAME: torch.full((32, 32, 1), 0.4, requires_grad=True), color: torch.full((32, 32, 3), 0.4, requires_grad=True)}
    few = {NAME: torch.tensor(0.4, requires_grad=True), color: torch.full((32, 32), 0.4, requires_grad=True)}
    for textures in (full, few):
        burnish.torch.render(renderer, textures, spp=1).mean().backward()
    np.testing.assert_allclose(few[NAME].grad.numpy(), full[NAME].grad.numpy().sum(), rtol=1e-4)
    np.testing.assert_allclose(few[color].grad.numpy(), full[color].grad.numpy().sum(-1), rtol=1e-4)
    with pytest.raises(burnish.InputError, match=r"found the shape \(32, 32, 3\), expected a number, \(32, 32\), \(32, 32, 1\)$"):
        burnish.torch.render(renderer, {NAME: full[color]}, spp=1)


def test_a_tensor_that_requires_grad_says_what_to_do(renderer, torch):
    with pytest.raises(TypeError, match="expected an array of numbers, found Tensor") as raised:
        renderer.render({NAME: torch.zeros(32, 32, 1, requires_grad=True)}, spp=1)
    assert "detach" in str(raised.value.__cause__)
    tensor = torch.full((32, 32, 1), 0.4)
    np.testing.assert_array_equal(renderer.render({NAME: tensor}, spp=1), renderer.render({NAME: 0.4}, spp=1))


def test_texels_that_were_changed_since_are_not_used_silently(renderer, torch):
    import burnish.torch

    texels = torch.full((32, 32, 1), 0.4, requires_grad=True)
    picture = burnish.torch.render(renderer, {NAME: texels}, spp=1)
    with torch.no_grad():
        texels.fill_(0.1)
    with pytest.raises(RuntimeError, match="modified by an inplace operation"):
        picture.sum().backward()


def test_there_are_no_second_derivatives(renderer, torch):
    import burnish.torch

    def loss(texels):
        return (burnish.torch.render(renderer, {NAME: texels}, spp=1) ** 2).sum()

    weight = torch.tensor(0.2, requires_grad=True)
    for texels in [weight, torch.sigmoid(weight)]:
        [gradient] = torch.autograd.grad(loss(texels), weight, create_graph=True)
        with pytest.raises(RuntimeError, match="no second derivatives"):
            torch.autograd.grad(gradient, weight, retain_graph=True)
        with pytest.raises(RuntimeError, match="no second derivatives"):
            gradient.backward()
    with pytest.raises(RuntimeError, match="no second derivatives"):
        torch.autograd.functional.hessian(loss, torch.tensor(0.4))


def test_tensors_that_are_stored_negated_are_taken(renderer, torch):
    import burnish.torch

    stored = torch.complex(torch.zeros(32, 32, 1), torch.full((32, 32, 1), -0.4)).conj().imag
    assert stored.is_neg()
    own, other = (burnish.torch.render(renderer, {NAME: t}, spp=1) for t in (stored, stored.clone()))
    assert torch.equal(own, other)


def test_what_does_not_fit_is_said(renderer, torch):
    import burnish.torch

    texels = torch.full((32, 32, 1), 0.4, requires_grad=True)
    for options, name in [({"spp": 0}, "spp"), ({"spp": 1, "gradient_spp": 0}, "gradient_spp"), ({"spp": 1, "seed": -1}, "seed")]:
        with pytest.raises(burnish.InputError, match=f"^{name}: expected a whole number from [01] to "):
            burnish.torch.render(renderer, {NAME: texels}, **options)
    for spp in (0, 2**20 + 1):
        with pytest.raises(burnish.InputError, match=f"^spp: expected a whole number from 1 to 1048576, found {spp}$"):
            burnish.torch.render(renderer, {NAME: texels}, spp=spp)
    with pytest.raises(TypeError, match="^gradient_spp: expected a whole number from 1 "):
        burnish.torch.render(renderer, {NAME: texels}, spp=1, gradient_spp=1.5)
    with pytest.raises(TypeError, match="^textures: expected a mapping from names, found Tensor"):
        burnish.torch.render(renderer, texels)
    with pytest.raises(TypeError, match="^renderer: expected a Renderer, found str"):
        burnish.torch.render("scene.xml", {NAME: texels})
    with pytest.raises(burnish.InputError, match=f"^the texture roughness is the same as {NAME}$"):
        burnish.torch.render(renderer, {NAME: texels, "roughness": texels}, spp=1)
    with pytest.raises(TypeError, match=f"{NAME}: expected a tensor, found float"):
        burnish.torch.render(renderer, {NAME: 0.4}, spp=1)
    whole = {NAME: torch.ones(32, 32, dtype=torch.int32), "mat-goblet.base_color": torch.full((32, 32, 3), 0.4, dtype=torch.float64)}
    assert burnish.torch.render(renderer, whole, spp=1).dtype == torch.float64

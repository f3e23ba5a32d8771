"""Pictures as a function of PyTorch: `render` differentiates by the textures.

The picture comes from fresh samples, and its derivative from others that are independent of them. The gradient of a loss whose
derivative is affine in the picture, as the mean squared error is, is unbiased. Other losses see the noise of the picture: the more
samples, the less bias.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy.typing as npt
import torch

from ._checks import MAX_PICTURE_SPP, check_kinds, check_names, full_shape, whole_number
from ._core import Renderer

__all__ = ["render"]


def _array(tensor: torch.Tensor) -> npt.NDArray[Any]:
    """Of any type: numpy has no bfloat16."""
    own = tensor.detach().cpu().resolve_neg()
    return (own.float() if own.is_floating_point() else own).numpy()


def _values(names: tuple[str, ...], textures: Iterable[torch.Tensor]) -> dict[str, npt.NDArray[Any]]:
    return {n: _array(t) for n, t in zip(names, textures)}


def _full(renderer: Renderer, name: str, texture: torch.Tensor) -> torch.Tensor:
    """As large as the texture of the scene, so that its gradient fits; autograd sums up that of what was broadcast."""
    shape = full_shape(renderer, name, tuple(texture.shape))
    if shape == tuple(texture.shape):
        return texture
    return (texture[..., None] if texture.ndim == 2 else texture).expand(shape)


class _Render(torch.autograd.Function):
    @staticmethod
    def forward(
        ctx: Any, renderer: Renderer, names: tuple[str, ...], spp: int, gradient_spp: int, seed: int, *textures: torch.Tensor
    ) -> torch.Tensor:
        ctx.renderer, ctx.names, ctx.gradient_spp, ctx.seed = renderer, names, gradient_spp, seed
        ctx.save_for_backward(*textures)
        picture = torch.from_numpy(renderer.render(_values(names, textures), spp, seed))
        floating = [t for t in textures if t.is_floating_point()]
        return picture.to(floating[0]) if floating else picture

    @staticmethod
    def backward(ctx: Any, *adjoints: torch.Tensor) -> tuple[torch.Tensor | None, ...]:
        textures = ctx.saved_tensors  # raises where one was changed in place
        wanted = [name for name, needed in zip(ctx.names, ctx.needs_input_grad[5:]) if needed]
        found = _Gradient.apply(ctx.renderer, ctx.names, wanted, ctx.gradient_spp, ctx.seed, adjoints[0], *textures)
        gradients = dict(zip(wanted, found))
        return (None, None, None, None, None, *map(gradients.get, ctx.names))


class _Gradient(torch.autograd.Function):
    """A function of the adjoint and the textures: who differentiates it meets an error, not a derivative of 0."""

    @staticmethod
    def forward(
        ctx: Any, renderer: Renderer, names: tuple[str, ...], wanted: list[str], spp: int, seed: int,
        adjoint: torch.Tensor, *textures: torch.Tensor
    ) -> tuple[torch.Tensor, ...]:
        own = dict(zip(names, textures))
        gradients = renderer.gradient(_array(adjoint), wanted, _values(names, textures), spp, seed)
        return tuple(torch.from_numpy(gradients[n]).reshape(own[n].shape).to(own[n]) for n in wanted)

    @staticmethod
    def backward(ctx: Any, *adjoints: torch.Tensor) -> tuple[torch.Tensor | None, ...]:
        raise RuntimeError("burnish.torch.render has no second derivatives")


def render(
    renderer: Renderer,
    textures: Mapping[str, torch.Tensor],
    spp: int = 16,
    gradient_spp: int | None = None,
    seed: int = 0,
) -> torch.Tensor:
    """The picture [height, width, 3] of textures {name: [height, width, channels]}, which autograd differentiates.

    A texture may be a number for all texels, or have one channel that is all of them. spp: samples per pixel of the
    picture; gradient_spp: of its derivative; None: as many. seed: of both, whose samples are independent of each other;
    give each step another one. The picture has the type and the device of the first texture of floating-point numbers.
    Tensors of a GPU are copied: the work is done by the CPU. There are no second derivatives.
    """
    check_kinds(renderer, textures)
    for name, texture in textures.items():
        if not isinstance(texture, torch.Tensor):
            raise TypeError(f"{name}: expected a tensor, found {type(texture).__name__}")
    check_names(renderer, textures)
    samples, number = whole_number("spp", spp, 1, MAX_PICTURE_SPP), whole_number("seed", seed, 0)
    own = samples if gradient_spp is None else whole_number("gradient_spp", gradient_spp, 1)
    full = [_full(renderer, name, texture) for name, texture in textures.items()]
    picture = _Render.apply(renderer, tuple(textures), samples, own, number, *full)
    assert isinstance(picture, torch.Tensor)
    return picture

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
from torch.autograd.function import once_differentiable

from ._checks import full_shape, whole_number
from ._core import Renderer

__all__ = ["render"]


def _array(tensor: torch.Tensor) -> npt.NDArray[Any]:
    """Of any type: numpy has no bfloat16."""
    own = tensor.detach().cpu()
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
    @once_differentiable  # type: ignore[misc,untyped-decorator,unused-ignore]
    def backward(ctx: Any, *adjoints: torch.Tensor) -> tuple[torch.Tensor | None, ...]:
        textures = ctx.saved_tensors  # raises where one was changed in place
        wanted = [name for name, needed in zip(ctx.names, ctx.needs_input_grad[5:]) if needed]
        values, adjoint = _values(ctx.names, textures), _array(adjoints[0])
        gradients = ctx.renderer.gradient(adjoint, wanted, values, ctx.gradient_spp, ctx.seed) if wanted else {}
        found: list[torch.Tensor | None] = [
            torch.from_numpy(gradients[name]).reshape(t.shape).to(t) if name in gradients else None
            for name, t in zip(ctx.names, textures)
        ]
        return (None, None, None, None, None, *found)


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
    for name, texture in textures.items():
        if not isinstance(texture, torch.Tensor):
            raise TypeError(f"{name}: expected a tensor, found {type(texture).__name__}")
    samples, number = whole_number("spp", spp, 1), whole_number("seed", seed, 0)
    own = samples if gradient_spp is None else whole_number("gradient_spp", gradient_spp, 1)
    full = [_full(renderer, name, texture) for name, texture in textures.items()]
    picture = _Render.apply(renderer, tuple(textures), samples, own, number, *full)
    assert isinstance(picture, torch.Tensor)
    return picture

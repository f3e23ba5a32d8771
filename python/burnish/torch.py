"""Pictures as a function of PyTorch: `render` differentiates by the textures.

The picture comes from fresh samples, and its derivative from others that are independent of them. The gradient of a loss whose
derivative is affine in the picture, as the mean squared error is, is unbiased. Other losses see the noise of the picture: the more
samples, the less bias.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import torch

from ._core import Renderer

__all__ = ["render"]



class _Render(torch.autograd.Function):
    @staticmethod
    def forward(
        ctx: Any, renderer: Renderer, names: tuple[str, ...], spp: int, gradient_spp: int, seed: int, *textures: torch.Tensor
    ) -> torch.Tensor:
        values = dict(zip(names, (t.detach().cpu().numpy() for t in textures)))
        ctx.renderer, ctx.names, ctx.values = renderer, names, values
        ctx.gradient_spp, ctx.seed = gradient_spp, seed
        ctx.kinds = [(t.shape, t.dtype, t.device) for t in textures]
        picture = torch.from_numpy(renderer.render(values, spp, seed))
        return picture.to(textures[0]) if textures else picture

    @staticmethod
    def backward(ctx: Any, *adjoints: torch.Tensor) -> tuple[torch.Tensor | None, ...]:
        wanted = [name for name, needed in zip(ctx.names, ctx.needs_input_grad[5:]) if needed]
        adjoint = adjoints[0].detach().cpu().numpy()
        gradients = ctx.renderer.gradient(adjoint, wanted, ctx.values, ctx.gradient_spp, ctx.seed) if wanted else {}
        found: list[torch.Tensor | None] = [
            torch.from_numpy(gradients[name]).reshape(shape).to(dtype=dtype, device=device) if name in gradients else None
            for name, (shape, dtype, device) in zip(ctx.names, ctx.kinds)
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

    spp: samples per pixel of the picture; gradient_spp: of its derivative; None: as many. seed: of both, whose samples are
    independent of each other; give each step another one. Tensors of a GPU are copied: the work is done by the CPU.
    """
    names = tuple(textures)
    picture = _Render.apply(renderer, names, spp, gradient_spp or spp, seed, *textures.values())
    assert isinstance(picture, torch.Tensor)
    return picture

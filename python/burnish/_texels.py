"""Texels of other shapes than a texture's, as the functions of PyTorch and JAX take them."""
from __future__ import annotations

from ._core import InputError, Renderer


def full_shape(renderer: Renderer, name: str, shape: tuple[int, ...]) -> tuple[int, int, int] | None:
    """The shape of a texture, to which a number and texels of one channel are broadcast; None: there is no such one.

    Throws InputError for another shape: no gradient would fit it.
    """
    full = renderer.parameters.shapes.get(name)
    if full is None:
        texels = renderer.parameters.get(name)  # of a short form
        if texels is None:
            return None
        full = texels.shape
    height, width, channels = full
    if shape not in [(), (height, width), (height, width, 1), full]:
        known = f"a number, ({height}, {width}), ({height}, {width}, 1)"
        color = f" or ({height}, {width}, 3)" if channels == 3 else ""
        raise InputError(f"{name}: found the shape {shape}, expected {known}{color}")
    return height, width, channels

"""What is checked before the renderer is called: types, shapes and whole numbers, for PyTorch and JAX."""
from __future__ import annotations

import operator
from collections.abc import Iterable, Mapping
from typing import SupportsIndex

from ._core import InputError, Renderer

MAX_PICTURE_SPP = 2**20  # of Renderer.render; gradients may have more


def check_kinds(renderer: object, textures: object) -> None:
    """Of the arguments that are mixed up most easily. Throws TypeError."""
    if not isinstance(renderer, Renderer):
        raise TypeError(f"renderer: expected a Renderer, found {type(renderer).__name__}")
    if not isinstance(textures, Mapping):
        raise TypeError(f"textures: expected a mapping from names, found {type(textures).__name__}")


def check_names(renderer: Renderer, names: Iterable[str]) -> None:
    """Each texture once: which of two names would have its gradient? Throws InputError."""
    known: dict[str, str] = {}
    for name in names:
        other = known.setdefault(renderer.parameters.name(name), name)
        if other != name:
            raise InputError(f"the texture {name} is the same as {other}")


def whole_number(name: str, value: SupportsIndex, low: int, high: int = 2**32 - 1) -> int:
    """A whole number from low to high, as the renderer takes it. Throws TypeError and InputError."""
    expected = f"{name}: expected a whole number from {low} to {high}, found "
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{expected}{value!r}") from None
    if isinstance(value, bool):
        raise TypeError(f"{expected}{value!r}")
    if not low <= number <= high:
        raise InputError(f"{expected}{number}")
    return number


def full_shape(renderer: Renderer, name: str, shape: tuple[int, ...]) -> tuple[int, int, int]:
    """The shape of a texture, to which a number and texels of one channel are broadcast.

    Throws InputError: there is no such texture, or the shape is another one, and no gradient would fit it.
    """
    full = renderer.parameters.shape(name)
    height, width, channels = full
    if shape not in [(), (height, width), (height, width, 1), full]:
        known = f"a number, ({height}, {width}), ({height}, {width}, 1)"
        color = f" or ({height}, {width}, 3)" if channels == 3 else ""
        raise InputError(f"{name}: found the shape {shape}, expected {known}{color}")
    return full

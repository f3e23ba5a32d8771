"""Pictures as a function of JAX: `render` differentiates by the textures.

As burnish.torch.render: the picture comes from fresh samples, and its derivative from others that are independent of them.
"""
from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import numpy.typing as npt
from jax.custom_derivatives import SymbolicZero

from ._checks import MAX_PICTURE_SPP, check_kinds, check_names, full_shape, whole_number
from ._core import InputError, Renderer

__all__ = ["render"]

_Textures = dict[str, jax.Array]
_Values = Mapping[str, npt.NDArray[np.float32]]


@dataclass(frozen=True)
class _Picture:
    """Equal where it does the same: JAX compiles, and keeps, a program for each function that it calls back."""

    renderer: Renderer
    spp: int

    def __call__(self, values: _Values, number: npt.ArrayLike) -> npt.NDArray[np.float32]:
        return self.renderer.render({n: np.asarray(v) for n, v in values.items()}, self.spp, int(np.asarray(number)))


@dataclass(frozen=True)
class _Gradient:
    """As _Picture; names: of the textures that are differentiated."""

    renderer: Renderer
    spp: int
    names: tuple[str, ...]

    def __call__(self, values: _Values, dy: npt.ArrayLike, number: npt.ArrayLike) -> dict[str, npt.NDArray[np.float32]]:
        own = {n: np.asarray(v) for n, v in values.items()}
        all_of = self.renderer.gradient(np.asarray(dy), self.names, own, self.spp, int(np.asarray(number)))
        return {n: all_of[n].reshape(own[n].shape).astype(own[n].dtype) for n in self.names}


@functools.partial(jax.custom_vjp, nondiff_argnums=(0, 1, 2))
def _render(renderer: Renderer, spp: int, gradient_spp: int, textures: _Textures, seed: jax.Array) -> jax.Array:
    kind = jax.ShapeDtypeStruct((renderer.height, renderer.width, 3), jnp.float32)
    found: jax.Array = jax.pure_callback(_Picture(renderer, spp), kind, textures, seed, vmap_method="sequential")
    return found


def _forward(
    renderer: Renderer, spp: int, gradient_spp: int, textures: dict[str, Any], seed: Any
) -> tuple[jax.Array, tuple[_Textures, dict[str, tuple[()]], jax.Array]]:
    """Keeps the names of the textures that are differentiated: the others may be ones that cannot be recovered."""
    values = {n: t.value for n, t in textures.items()}
    wanted: dict[str, tuple[()]] = {n: () for n, t in textures.items() if t.perturbed}
    return _render(renderer, spp, gradient_spp, values, seed.value), (values, wanted, seed.value)


def _backward(
    renderer: Renderer, spp: int, gradient_spp: int, kept: tuple[_Textures, dict[str, tuple[()]], jax.Array], adjoint: Any
) -> tuple[dict[str, jax.Array | None], None]:
    textures, wanted, seed = kept
    none: dict[str, jax.Array | None] = dict.fromkeys(textures)
    if not wanted or isinstance(adjoint, SymbolicZero):
        return none, None

    kinds = {n: jax.ShapeDtypeStruct(textures[n].shape, textures[n].dtype) for n in wanted}
    own = _Gradient(renderer, gradient_spp, tuple(wanted))
    found: _Textures = jax.pure_callback(own, kinds, textures, adjoint, seed, vmap_method="sequential")
    return {**none, **found}, None


_render.defvjp(_forward, _backward, symbolic_zeros=True)


def _check_type(name: str, dtype: np.dtype[Any]) -> None:
    """As the renderer does. Throws TypeError and InputError."""
    if dtype.kind in "ub":
        raise InputError(f"{name}: found {dtype}, expected linear values as floating-point numbers; "
                         "read_image and read_photograph decode files")
    if dtype.kind not in "fi" and dtype != jnp.bfloat16:
        raise TypeError(f"{name}: expected an array of numbers, found one of {dtype}")


def _full(renderer: Renderer, name: str, texture: jax.Array) -> jax.Array:
    """As large as the texture of the scene, so that its gradient fits; JAX sums up that of what was broadcast."""
    shape = full_shape(renderer, name, texture.shape)
    _check_type(name, texture.dtype)
    if shape == texture.shape:
        return texture
    return jnp.broadcast_to(texture[..., None] if texture.ndim == 2 else texture, shape)


def _checked(seed: int | jax.Array) -> jax.Array:
    """A seed, of which the renderer checks the range where it is traced. Throws TypeError and InputError."""
    if isinstance(seed, jax.core.Tracer):
        if not jnp.issubdtype(seed.dtype, jnp.integer):
            raise TypeError(f"seed: expected a whole number from 0 to 4294967295, found one of {seed.dtype}")
        if seed.shape != ():
            raise TypeError(f"seed: expected a whole number, found an array of the shape {seed.shape}")
        return seed
    return jnp.asarray(whole_number("seed", seed, 0), jnp.uint32)


def render(
    renderer: Renderer,
    textures: Mapping[str, jax.Array],
    spp: int = 16,
    gradient_spp: int | None = None,
    seed: int | jax.Array = 0,
) -> jax.Array:
    """The picture [height, width, 3] of textures {name: [height, width, channels]}, which JAX differentiates.

    In jit, too, and in vmap, which makes one picture after the other.

    A texture may be a number for all texels, or have one channel that is all of them. spp: samples per pixel of the
    picture; gradient_spp: of its derivative; None: as many. seed: of both, whose samples are independent of each other;
    give each step another one. Throws InputError or TypeError at the call, in jit, too, where a name, a shape, a type
    or a number of samples does not fit.
    """
    check_kinds(renderer, textures)
    check_names(renderer, textures)
    arrays = {name: _full(renderer, name, jnp.asarray(t)) for name, t in textures.items()}
    samples = whole_number("spp", spp, 1, MAX_PICTURE_SPP)
    own = samples if gradient_spp is None else whole_number("gradient_spp", gradient_spp, 1)
    picture: jax.Array = _render(renderer, samples, own, arrays, _checked(seed))
    return picture

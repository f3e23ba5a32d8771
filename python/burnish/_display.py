"""What shows itself in a notebook: images, a solver, a summary."""
from __future__ import annotations

import base64
import html
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ._core import Solver, Summary, encode_png

if TYPE_CHECKING:  # the import of the package is light
    import numpy as np
    import numpy.typing as npt

_WIDTH = 192  # of an image, in pixels of the screen, at least


def _scale(width: int) -> int:
    return max(1, -(-_WIDTH // width))


def _figure(name: str, image: npt.NDArray[np.float32], png: bytes | None = None) -> str:
    data = base64.b64encode(encode_png(image) if png is None else png).decode()
    width = image.shape[1] * _scale(image.shape[1])
    return (f'<figure style="display:inline-block;margin:4px"><img alt="{html.escape(name)}" width="{width}" '
            f'style="image-rendering:pixelated;max-width:100%" src="data:image/png;base64,{data}">'
            f'<figcaption>{html.escape(name)}</figcaption></figure>')


def _curve(losses: list[float]) -> str:
    """The finite losses of the iterations, on a logarithmic scale where all are above 0."""
    import numpy as np

    found = np.asarray(losses, float)
    is_finite = np.isfinite(found)
    x, values = np.linspace(0, 240, len(found))[is_finite], found[is_finite]
    if len(values) < 2:
        return ""
    is_logarithmic = bool(values.min() > 0)
    if is_logarithmic:
        values = np.log(values)
    y = 56 - 52 * (values - values.min()) / max(float(np.ptp(values)), 1e-6 * float(np.abs(values).max()), 1e-30)
    points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y))
    caption = "loss, logarithmic" if is_logarithmic else "loss"
    return (f'<figure style="display:inline-block;margin:4px"><svg width="240" height="60"><polyline fill="none" stroke="#36c" '
            f'points="{points}"/></svg><figcaption>{caption}</figcaption></figure>')


class Shown:
    """What show returns: it shows itself in a notebook. images: each with its PNG."""

    def __init__(self, images: Mapping[str, tuple[npt.NDArray[np.float32], bytes]]) -> None:
        self._images = dict(images)

    def __repr__(self) -> str:
        return f"Shown({', '.join(name or 'an image' for name in self._images)})"

    def _repr_png_(self) -> bytes | None:
        if len(self._images) != 1:
            return None
        [(image, png)] = self._images.values()
        scale = _scale(image.shape[1])
        return png if scale == 1 else encode_png(image.repeat(scale, 0).repeat(scale, 1))

    def _repr_html_(self) -> str | None:
        if len(self._images) == 1:
            return None
        return "".join(_figure(name, image, png) for name, (image, png) in self._images.items())


def _array(image: Any) -> npt.NDArray[np.float32]:
    import numpy as np

    speaks_dlpack_alone = hasattr(image, "__dlpack__") and not hasattr(image, "__array__")
    return np.asarray(np.from_dlpack(image) if speaks_dlpack_alone else image, np.float32)


def show(images: npt.ArrayLike | Mapping[str, npt.ArrayLike]) -> Shown:
    """Images for a notebook, side by side where they have names: show(image), show({"picture": a, "image": b}).

    Three channels are linear colours, one channel is shown as it is: 0 black, 1 white. Throws InputError for what
    encode_png does not take.
    """
    named = images if isinstance(images, Mapping) else {"": images}
    shown = {}
    for name, image in named.items():
        png = encode_png(image)
        array = _array(image)
        shown[name] = (array[..., None] if array.ndim == 2 else array), png
    return Shown(shown)


def _iterations(count: int) -> str:
    return f"{count} iteration{'' if count == 1 else 's'}"


def _solver_html(solver: Solver) -> str:
    images: dict[str, Any] = dict(solver.textures)
    if (image := solver.image()) is not None:
        images["image"] = image
    return f"<p>{_iterations(solver.iterations)}</p>" + "".join(_figure(n, i) for n, i in images.items())


def _summary_html(summary: Summary) -> str:
    images = zip(_view_names(summary), (e.image for e in summary.result.views))
    figures = [_figure(view, image) for view, image in images if image is not None][:8]  # of this process
    for name, texture in summary.textures.items():
        figures.append(_figure(name, texture))
        if (confidence := summary.confidence[name]) is not None:
            figures.append(_figure("its confidence", confidence))
    text = (f"loss {summary.initial_loss:.4g} &rarr; {summary.loss:.4g} in {_iterations(summary.iteration_count)}, "
            f"{summary.seconds:.1f} s")
    return f"<p>{text}</p>" + "".join(figures) + _curve([i.loss for i in summary.iterations])


def _view_names(summary: Summary) -> list[str]:
    names = summary.view_names
    return [name or ("image" if len(names) == 1 else f"view {i}") for i, name in enumerate(names)]


setattr(Solver, "_repr_html_", _solver_html)
setattr(Summary, "_repr_html_", _summary_html)

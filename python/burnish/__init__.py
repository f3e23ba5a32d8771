"""Burnish recovers the textures of materials from images.

    import burnish

    renderer = burnish.load("scene.xml")
    problem = burnish.Problem(renderer, "photograph.exr", "mat.roughness")
    summary = burnish.solve(problem, iterations=100)
    burnish.write_image("roughness.exr", summary.textures["mat.roughness"])

Arrays are numpy's, [height, width, channels], linear, float32; anything that numpy makes an array of, or that speaks
DLPack, goes in.
"""

from collections.abc import Mapping as _Mapping

from ._interpreter import check_interpreter as _check_interpreter

_check_interpreter()  # before _core is imported

from ._core import (
    Camera,
    Capture,
    Environment,
    Error,
    Evaluation,
    InputError,
    Iteration,
    Lens,
    Lighting,
    Live,
    OutputError,
    Parameters,
    Problem,
    Renderer,
    ResourceError,
    Sensor,
    Solver,
    State,
    Summary,
    Unknown,
    View,
    ViewEvaluation,
    encode_png,
    live,
    load,
    mask_background,
    options,
    read_capture,
    read_image,
    read_photograph,
    read_views,
    solve,
    version,
    write_image,
    write_model,
    write_scene,
)
from ._display import show
from ._ranks import Ranks

_Mapping.register(Parameters)

__version__ = version

__all__ = [
    "Camera",
    "Capture",
    "Environment",
    "Error",
    "Evaluation",
    "InputError",
    "Iteration",
    "Lens",
    "Lighting",
    "Live",
    "OutputError",
    "Parameters",
    "Problem",
    "Ranks",
    "Renderer",
    "ResourceError",
    "Sensor",
    "Solver",
    "State",
    "Summary",
    "Unknown",
    "View",
    "ViewEvaluation",
    "encode_png",
    "live",
    "load",
    "mask_background",
    "options",
    "read_capture",
    "read_image",
    "read_photograph",
    "read_views",
    "show",
    "solve",
    "version",
    "write_image",
    "write_model",
    "write_scene",
]

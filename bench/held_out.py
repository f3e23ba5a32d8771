#!/usr/bin/env python3
"""Judges recovered textures by pictures that were not fitted, and by the true textures; Mitsuba 3 renders both.

    bench/held_out.py CAPTURE.json 0.5 out/textures -o FOLDER

CAPTURE.json is capture.json or front.json of bench/captures.py, whose scene has the true textures. What is judged is a
folder with PARAMETER.exr, as `burnish optimize` writes it, or a number: that value in every texel. Writes
FOLDER/held_out.json and FOLDER/held_out.md, one row for each; prints the table.

PSNR of a view: over the pixels of the object, between the pictures of the recovered and of the true textures, sRGB,
the 99th percentile of the true picture = 1. Both are rendered twice, with the same random numbers, and the squared
difference is the product of the two differences: noise does not count. Texture error: root mean squared difference
over the texels that move a fitted picture, at the truth; of one channel against the luminance of three.
"""
import argparse
import json
import math
import statistics
import sys
from collections.abc import Sequence
from pathlib import Path

from mitsuba_python import go_on_with_mitsuba

GROUPS = {"fitted": "fitted views", "places": "other places", "skies": "other skies"}
SEEN_SPP = 16  # of the derivative that finds the texels which count
LUMINANCE = (0.212671, 0.715160, 0.072169)

# ---- Numbers


def srgb(value: float) -> float:
    """Of a linear one, clamped to [0, 1]."""
    value = min(max(value, 0.0), 1.0)
    return 12.92 * value if value <= 0.0031308 else 1.055 * value ** (1 / 2.4) - 0.055


def psnr(pictures: Sequence[Sequence[float]], truths: Sequence[Sequence[float]]) -> float:
    """dB, at most 100; linear values of the same pixels and channels, two independent pictures each. The product of
    the differences of the two has no noise on average."""
    white = statistics.quantiles(map(statistics.fmean, zip(*truths)), n=100, method="inclusive")[98]
    halves = [[srgb(p / white) - srgb(t / white) for p, t in zip(*half)] for half in zip(pictures, truths)]
    return -10 * math.log10(max(statistics.fmean(a * b for a, b in zip(*halves)), 1e-10))


def texture_error(texels: Sequence[float], truth: Sequence[float]) -> float:
    return math.sqrt(statistics.fmean((a - b) ** 2 for a, b in zip(texels, truth)))


def group_of(view: dict) -> str:
    if view.get("split", "train") == "train":
        return "fitted"
    return "skies" if "environment" in view else "places"


# ---- Table


def cell(values: Sequence[float]) -> str:
    """The mean; the smallest in brackets where there are several."""
    if not values:
        return ""
    return f"{statistics.fmean(values):.1f}" + (f" ({min(values):.1f})" if len(values) > 1 else "")


def row(judged: dict) -> str:
    cells = [cell([v["psnr"] for v in judged["views"] if v["group"] == group]) for group in GROUPS]
    errors = ", ".join(f"{e:.3f}" for e in judged["texture_error"].values())
    return f"| {judged['textures']} | {' | '.join(cells)} | {errors} |"


def markdown(results: dict) -> str:
    """Mean PSNR of the views of each kind."""
    head = ["textures", *(f"{g}, dB" for g in GROUPS.values()), "texture error, seen texels"]
    return "\n".join([f"{results['capture']}: {', '.join(results['parameters'])}", "",
                      f"| {' | '.join(head)} |", "| --- " * len(head) + "|", *map(row, results["judged"])])


# ---- Pictures, with Mitsuba


def texels_of(judged: str, parameter: str, truth: "np.ndarray") -> "np.ndarray":
    """[height, width, channels]: of a folder or a number."""
    try:
        return np.full(truth.shape, float(judged), np.float32)
    except ValueError:
        pass
    file = Path(judged) / f"{parameter}.exr"
    if not file.exists():
        sys.exit(f"held_out: {file}: expected it there: no such file")
    texels = mitsuba_scene.read_image(file)
    if texels.shape[:2] != truth.shape[:2] or texels.shape[2] not in (1, truth.shape[2]):
        sys.exit(f"held_out: {file}: {texels.shape}, expected the shape of the true texture, {truth.shape}")
    return texels


def error_over(seen: "np.ndarray", texels: "np.ndarray", truth: "np.ndarray") -> float:
    if texels.shape != truth.shape:
        truth = truth @ np.array(LUMINANCE, dtype=np.float32)[:, None]
    return texture_error(texels[seen].ravel().tolist(), truth[seen].ravel().tolist())


class Capture:
    """Views, and true textures by parameter."""

    def __init__(self, file: Path, parameters: list[str] | None):
        self.folder, self.capture = file.parent, json.loads(file.read_text())
        made = self.folder / "made.json"
        self.parameters = parameters or json.loads(made.read_text())["parameters"]
        params = mi.traverse(self.scene())
        self.truth = {p: np.array(params[p], dtype=np.float32).reshape(params[p].shape) for p in self.parameters}

    def scene(self, sky: dict | None = None):
        return mitsuba_scene.load(self.folder / self.capture["scene"], self.parameters, self.capture.get("defines"),
                                  self.folder, sky)

    def seen(self) -> dict:
        """By parameter: the texels that move a fitted picture."""
        scene = self.scene()
        sensors = [mitsuba_scene.sensor_of(scene, v) for v in self.capture["views"] if group_of(v) == "fitted"]
        return {p: mitsuba_scene.seen_texels(scene, sensors, p, SEEN_SPP) for p in self.parameters}

    def pictures(self, view: dict, candidates: list[dict], spp: int) -> list[list[list[float]]]:
        """Values of the object's pixels in two pictures of each candidate: texels by parameter."""
        scene = self.scene(view.get("environment"))
        mask = mitsuba_scene.object_mask(scene, mitsuba_scene.sensor_of(scene, view), self.parameters)
        params = mi.traverse(scene)
        found = []
        for candidate in candidates:
            for p, texels in candidate.items():
                params[p] = mi.TensorXf(np.broadcast_to(texels, self.truth[p].shape).astype(np.float32))
            params.update()
            found.append([p[mask].ravel().tolist() for p in mitsuba_scene.render(scene, view, range(2), spp)])
        return found


def judge(capture: Capture, names: list[str], spp: int) -> list[dict]:
    candidates = [{p: texels_of(n, p, t) for p, t in capture.truth.items()} for n in names]
    seen = capture.seen()
    judged = [{"textures": n, "views": [], "texture_error": {p: error_over(seen[p], c[p], capture.truth[p]) for p in c}}
              for n, c in zip(names, candidates)]
    for view in capture.capture["views"]:
        truth, *pictures = capture.pictures(view, [capture.truth, *candidates], spp)
        for j, picture in zip(judged, pictures):
            j["views"].append({"name": view["name"], "group": group_of(view), "psnr": psnr(picture, truth)})
    return judged


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("capture", type=Path, metavar="CAPTURE.json")
    parser.add_argument("textures", nargs="+", help="a folder or a number")
    parser.add_argument("-o", "--output", type=Path, metavar="FOLDER")
    parser.add_argument("--parameter", action="append", help="Mitsuba's name; those of made.json without")
    parser.add_argument("--spp", type=int, default=16, help="of each of two pictures")
    arguments = parser.parse_args()
    capture = Capture(arguments.capture, arguments.parameter)
    results = {"capture": str(arguments.capture), "parameters": capture.parameters, "spp": arguments.spp,
               "judged": judge(capture, arguments.textures, arguments.spp)}
    print(markdown(results))
    if arguments.output:
        arguments.output.mkdir(parents=True, exist_ok=True)
        (arguments.output / "held_out.json").write_text(json.dumps(results, indent=1) + "\n")
        (arguments.output / "held_out.md").write_text(markdown(results) + "\n")


if __name__ == "__main__":
    go_on_with_mitsuba()
    import mitsuba as mi
    import numpy as np

    mi.set_variant("llvm_ad_rgb")
    import mitsuba_scene

    main()

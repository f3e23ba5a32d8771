#!/usr/bin/env python3
"""Photographs for the demo, of pictures that Mitsuba 3 made: 8-bit JPEG files with the noise of a sensor, each with an
exposure of its own, and the capture.json that names them.

    bench/captures.py -o out/captures --only goblet --size 400 --train 3 --test 1 --spp 128
    bench/demo_photographs.py out/captures/goblet -o scenes/goblet_photographs

A pixel of radiance L is exposure * L, with the noise of so many electrons and of their reading, clipped to 1, sRGB. Its
capture.json belongs into the folder of `burnish scene goblet`, and asks for the exposures to be fitted.
"""
import argparse
import json
from pathlib import Path

from mitsuba_python import go_on_with_mitsuba

go_on_with_mitsuba()

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")

import mitsuba_scene

NAMES = {"train-0": "front", "train-1": "right", "train-2": "left", "test-0": "between"}
STOPS = {"front": 1.0, "right": 0.7, "left": 1.3, "between": 1.0}
FULL_WELL, READ_NOISE = 4000, 0.002  # electrons of a pixel at 1; of a pixel at 1
QUALITY = 93


def photograph(radiance, exposure: float, random):
    """[height, width, 3] in [0, 1], linear."""
    exposed = np.maximum(radiance * exposure, 0)
    shot = random.poisson(exposed * FULL_WELL) / FULL_WELL
    return (shot + random.normal(0, READ_NOISE, exposed.shape)).clip(0, 1)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("capture", type=Path, help="a folder of bench/captures.py")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER")
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    capture = json.loads((arguments.capture / "capture.json").read_text())
    random = np.random.default_rng(1)
    views = []
    for view in capture["views"]:
        if view["name"] not in NAMES:
            continue
        name = NAMES[view["name"]]
        radiance = np.asarray(mitsuba_scene.read_image(arguments.capture / view["image"]), dtype=float)
        exposure = STOPS[name] * 0.6 / np.quantile(radiance.mean(axis=2), 0.95)
        picture = mi.Bitmap(photograph(radiance, exposure, random).astype(np.float32))
        picture.convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.UInt8, srgb_gamma=True).write(
            str(arguments.output / f"{name}.jpg"), quality=QUALITY)
        print(f"{name}.jpg: exposure {exposure:.4f}")
        views.append({"name": name, "image": f"{name}.jpg", "exposure": "fit", "camera": view["camera"]}
                     | ({"split": "test"} if view.get("split") == "test" else {}))
    content = {"version": 1, "scene": "scene.xml", "views": views}
    (arguments.output / "capture.json").write_text(json.dumps(content, indent=1) + "\n")


if __name__ == "__main__":
    main()

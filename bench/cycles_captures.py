#!/usr/bin/env python3
"""A capture whose pictures Blender's Cycles made, with Blender's own principled material: the goblet, as its model.glb
has it.

    bench/captures.py -o CAPTURES --only goblet --size 400 --train 8 --test 4 --spp 16
    bench/cycles_captures.py CAPTURES/goblet -o FOLDER

takes scene and cameras of the first and writes FOLDER/scene/, FOLDER/capture.json, whose images are EXR, and
FOLDER/photographs.json: 8-bit sRGB files, each with an exposure of its own that is not told. Direct light, as in the
scene. Then

    burnish optimize FOLDER/capture.json --parameter mat-goblet.roughness --parameter mat-goblet.base_color --time 120 -o out

Blender's Python module comes from the interpreter that BURNISH_BLENDER_PYTHON names (pip install bpy numpy).
"""
import argparse
import json
import math
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests" / "scenes"))
import model_in_blender

SPP = 128
STOPS = (0.7, 1.0, 1.4)  # exposures of photographs, in turn
MODEL = "model.glb"


def arguments_of():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", type=Path, help="a folder of bench/captures.py")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER")
    parser.add_argument("--burnish", type=Path, default=ROOT / "build/release/burnish", help="the program")
    parser.add_argument("--render", action="store_true", help=argparse.SUPPRESS)  # this script, within Blender
    return parser.parse_args()


def views_of(capture):
    """Those under the sky of the scene."""
    return [v for v in capture["views"] if "environment" not in v]


# ---- Within Blender


def set_camera(camera):
    """OpenCV's axes and +y up become Blender's: the camera looks along -z, and the world has +z up."""
    import bpy
    import numpy as np

    place = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1.0]])
    matrix = place @ np.array(camera["camera_to_world"]) @ np.diag([1, -1, -1, 1.0])
    of_scene = bpy.context.scene.camera
    of_scene.parent = None
    of_scene.matrix_world = matrix.T.tolist()
    of_scene.data.sensor_fit = "HORIZONTAL"
    of_scene.data.shift_x = of_scene.data.shift_y = 0
    of_scene.data.angle = 2 * math.atan(camera["width"] / 2 / camera["params"][0])


def render(folder):
    capture = json.loads((folder / "capture.json").read_text())
    model_in_blender.import_model(folder / MODEL)
    model_in_blender.add_sky(folder / "scene/textures/sky.exr")
    for view in views_of(capture):
        set_camera(view["camera"])
        model_in_blender.render(folder / view["image"], view["camera"]["width"], SPP)
        print(view["image"], flush=True)


# ---- Outside of it


def export_model(burnish, scene, output):
    """The scene as it is: a run that moves nothing."""
    with tempfile.TemporaryDirectory() as folder:
        model_in_blender.run(burnish, "optimize", scene, "--parameter", "mat-goblet.roughness", "--init", "scene",
                             "--iterations", "1", "--learning-rate", "1e-12", "--size", "32", "32", "--target-spp", "1",
                             "--evaluation-spp", "1", "-o", folder, "--force")
        shutil.copy(Path(folder) / MODEL, output / MODEL)


def write_photographs(folder):
    """Of the EXR files: white is what 99 of 100 pixels do not reach, before the exposure."""
    from mitsuba_python import go_on_with_mitsuba

    go_on_with_mitsuba()
    import mitsuba as mi
    import numpy as np

    mi.set_variant("scalar_rgb")
    photographs = json.loads((folder / "capture.json").read_text())
    for i, view in enumerate(photographs["views"]):
        pixels = np.array(mi.Bitmap(str(folder / view["image"])))[:, :, :3].astype(np.float32)
        exposed = pixels * (STOPS[i % len(STOPS)] / np.quantile(pixels.max(axis=2), 0.99))
        view["image"] = str(Path(view["image"]).with_suffix(".png"))
        view["exposure"] = "fit"
        picture = mi.Bitmap(exposed).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.UInt8, srgb_gamma=True)
        picture.write(str(folder / view["image"]))
    (folder / "photographs.json").write_text(json.dumps(photographs, indent=1) + "\n")


def main():
    arguments = arguments_of()
    folder = arguments.output
    if arguments.render:
        render(folder)
        return
    if not folder.exists():
        python = model_in_blender.interpreter_with_bpy()
        if python is None:
            sys.exit(f"cycles_captures: no Python with bpy and numpy: set {model_in_blender.NAMED} to one")
        unfinished = folder.with_name(folder.name + ".unfinished")
        shutil.rmtree(unfinished, ignore_errors=True)
        (unfinished / "images").mkdir(parents=True)
        shutil.copytree(arguments.source / "scene", unfinished / "scene")
        export_model(arguments.burnish.resolve(), unfinished / "scene/scene.xml", unfinished)
        capture = json.loads((arguments.source / "capture.json").read_text())
        capture["views"] = views_of(capture)
        (unfinished / "capture.json").write_text(json.dumps(capture, indent=1) + "\n")
        subprocess.run([python, __file__, arguments.source, "-o", unfinished, "--render"], check=True)
        unfinished.rename(folder)
    write_photographs(folder)


if __name__ == "__main__":
    main()

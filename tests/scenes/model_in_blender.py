#!/usr/bin/env python3
"""Blender imports model.glb and renders it as Burnish renders the scene.

    tests/scenes/model_in_blender.py BURNISH [--keep FOLDER]

BURNISH is the program to test. Blender's Python module is imported by the interpreter that BURNISH_BLENDER_PYTHON names,
or by the one that runs this file (pip install bpy); where neither has it, the test is skipped (exit status 77).

A few iterations on the built-in goblet, whose camera and lights are in the model; the sky is set up here. Cycles renders
direct light. Asked for are a PSNR of at least 28 dB, white being the 99th percentile of Burnish's picture, pictures in
the right sockets, the same PSNR with the materials that import_into_blender.py makes in their place, and that it falls below
that where the model is broken: texture coordinates upside down, another channel for roughness.
"""
import argparse
import logging
import math
import os
import runpy
import subprocess
import sys
import tempfile
from pathlib import Path

NAMED = "BURNISH_BLENDER_PYTHON"
SKIPPED = 77
LEAST_PSNR = 28.0
SIZE = 128
SAMPLES = 128


def interpreter_with_bpy():
    for candidate in filter(None, [os.environ.get(NAMED), sys.executable]):
        try:
            done = subprocess.run([candidate, "-c", "import bpy, numpy"], capture_output=True)
        except OSError:
            continue
        if done.returncode == 0:
            return candidate
    return None


def run(*command):
    subprocess.run([str(c) for c in command], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def make_results(burnish, folder):
    """The results of a short run, and Burnish's own picture of its scene/."""
    run(burnish, "optimize", "--iterations", "8", "--size", SIZE, SIZE, "--target-spp", "16", "--evaluation-spp", "8",
        "-o", folder)
    scene = folder / "scene" / "boxes.xml"
    scene.write_text((folder / "scene/scene.xml").read_text().replace("</film>", '<rfilter type="box"/></film>'))
    run(burnish, "render", scene, "--spp", "256", "-o", folder / "ours.exr")


def pixels(file):
    """[height, width, 3], row 0 on top."""
    import bpy
    import numpy as np

    image = bpy.data.images.load(str(file), check_existing=False)
    image.colorspace_settings.name = "Non-Color"
    values = np.empty(len(image.pixels), dtype=np.float32)
    image.pixels.foreach_get(values)
    return values.reshape(image.size[1], image.size[0], -1)[::-1, :, :3]


def import_model(file):
    import bpy

    bpy.ops.wm.read_factory_settings(use_empty=True)
    logging.disable(logging.INFO)
    bpy.ops.import_scene.gltf(filepath=str(file))
    bpy.context.scene.camera = next(o for o in bpy.data.objects if o.type == "CAMERA")


def add_sky(file):
    """Mitsuba's u = 0 is at -z of its world, +y of Blender's; Blender's is a quarter further."""
    import bpy

    world = bpy.data.worlds.new("sky")
    bpy.context.scene.world = world
    world.use_nodes = True
    tree = world.node_tree
    sky = tree.nodes.new("ShaderNodeTexEnvironment")
    sky.image = bpy.data.images.load(str(file))
    mapping = tree.nodes.new("ShaderNodeMapping")
    mapping.inputs["Rotation"].default_value = (0, 0, math.pi / 2)
    tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["Generated"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], sky.inputs["Vector"])
    tree.links.new(sky.outputs["Color"], tree.nodes["Background"].inputs["Color"])


def render(file, size=SIZE, samples=SAMPLES):
    import bpy

    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.use_adaptive_sampling = samples, False, False
    scene.cycles.max_bounces = 0  # direct light
    scene.cycles.sample_clamp_direct = scene.cycles.sample_clamp_indirect = scene.cycles.blur_glossy = 0
    scene.cycles.pixel_filter_type = "BOX"
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.filepath = str(file)
    bpy.ops.render.render(write_still=True)
    return pixels(file)


def psnr(a, b):
    import numpy as np

    white = np.quantile(b, 0.99)
    error = np.mean((np.clip(a / white, 0, 1) - np.clip(b / white, 0, 1)) ** 2)
    return -10 * math.log10(error)


def principled(name):
    import bpy

    return next(n for n in bpy.data.materials[name].node_tree.nodes if n.type == "BSDF_PRINCIPLED")


def source_of(socket):
    """The node, and the name of its output, that a socket takes its value from; through multiplications."""
    link = socket.links[0]
    while link.from_node.type in ("MATH", "MIX"):
        link = next(i for i in link.from_node.inputs if i.is_linked).links[0]
    return link.from_node, link.from_socket.name


def check_sockets():
    bsdf = principled("mat-goblet")
    node, output = source_of(bsdf.inputs["Base Color"])
    assert node.type == "TEX_IMAGE" and output == "Color", node
    assert node.image.colorspace_settings.name == "sRGB", node.image.colorspace_settings.name
    node, output = source_of(bsdf.inputs["Roughness"])
    assert node.type in ("SEPARATE_COLOR", "SEPRGB") and output == "Green", (node.type, output)
    image = node.inputs[0].links[0].from_node.image
    assert image.colorspace_settings.name == "Non-Color", image.colorspace_settings.name
    assert abs(bsdf.inputs["IOR"].default_value - 1.5) < 1e-6


def turn_uvs_around():
    import bpy

    for mesh in bpy.data.meshes:
        for layer in mesh.uv_layers:
            for uv in layer.uv:
                uv.vector[1] = 1 - uv.vector[1]


def exchange_channels():
    bsdf = principled("mat-goblet")
    node, _ = source_of(bsdf.inputs["Roughness"])
    bsdf.id_data.links.new(node.outputs["Red"], bsdf.inputs["Roughness"])


def compare(folder):
    """True where the model looks right, and wrong where it was broken."""
    ours = pixels(folder / "ours.exr")
    right = True
    for name, change, is_defect in (
            ("the model", None, False),
            ("the script", lambda: runpy.run_path(str(folder / "import_into_blender.py")), False),
            ("v turned around", turn_uvs_around, True),
            ("another channel for roughness", exchange_channels, True)):
        import_model(folder / "model.glb")
        add_sky(folder / "scene/textures/sky.exr")
        check_sockets()
        if change:
            change()
        found = psnr(render(folder / f"{name.replace(' ', '_')}.exr"), ours)
        good = (found < LEAST_PSNR) == is_defect
        print(f"{name}: {found:.1f} dB{'' if good else '  WRONG'}", flush=True)
        right = right and good
    return right


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("burnish")
    parser.add_argument("--keep", type=Path, help="folder that keeps the pictures")
    parser.add_argument("--inside", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if not arguments.inside:
        python = interpreter_with_bpy()
        if python is None:
            print(f"skipped: no Python with bpy and numpy; set {NAMED} to one (pip install bpy)")
            return SKIPPED
        os.execv(python, [python, __file__, *sys.argv[1:], "--inside"])
    with tempfile.TemporaryDirectory() as temporary:
        folder = (arguments.keep or Path(temporary)) / "results"
        make_results(arguments.burnish, folder)
        return 0 if compare(folder) else 1


if __name__ == "__main__":
    sys.exit(main())

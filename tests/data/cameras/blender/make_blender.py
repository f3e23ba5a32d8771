#!/usr/bin/env python3
"""Renders, with Blender, what the tests compare cameras of a transforms.json with: house.obj from two cameras, the
second one with a shifted lens; their alpha as gray pictures; and transforms.json as exporters for NeRF write it.

    python3.11 -m venv venv && venv/bin/pip install bpy==5.0.1 && venv/bin/python make_blender.py
"""

import json
import math
import struct
import zlib
from pathlib import Path

import bpy
from mathutils import Vector

HERE = Path(__file__).parent
WIDTH, HEIGHT = 120, 80

# Not symmetric: a house with a slanted roof that leans to one side.
VERTICES = [
    (-1, -0.5, 0), (1, -0.5, 0), (1, 0.7, 0), (-1, 0.7, 0),
    (-1, -0.5, 0.8), (1, -0.5, 1.1), (1, 0.7, 1.1), (-1, 0.7, 0.8), (-0.6, 0.2, 1.7), (0.3, 0.2, 1.7),
]
FACES = [
    (3, 2, 1, 0), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7), (4, 5, 9, 8), (6, 7, 8, 9), (5, 6, 9), (7, 4, 8),
]


def write_obj():
    lines = ["# Written by make_blender.py; z up."]
    lines += [f"v {x} {y} {z}" for x, y, z in VERTICES]
    lines += ["f " + " ".join(str(i + 1) for i in face) for face in FACES]
    (HERE / "house.obj").write_text("\n".join(lines) + "\n")


def make_scene():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    mesh = bpy.data.meshes.new("house")
    mesh.from_pydata(VERTICES, [], FACES)
    scene.collection.objects.link(bpy.data.objects.new("house", mesh))
    render = scene.render
    render.engine = "CYCLES"
    scene.cycles.samples = 64
    scene.cycles.use_denoising = False
    scene.cycles.pixel_filter_type = "BOX"
    render.film_transparent = True
    render.resolution_x, render.resolution_y, render.resolution_percentage = WIDTH, HEIGHT, 100
    render.image_settings.file_format = "PNG"
    render.image_settings.color_mode = "RGBA"
    return scene


def add_camera(scene, name, location, target, angle_x, shift=(0, 0)):
    data = bpy.data.cameras.new(name)
    data.sensor_fit = "HORIZONTAL"
    data.angle_x = angle_x
    data.shift_x, data.shift_y = shift
    camera = bpy.data.objects.new(name, data)
    camera.location = location
    camera.rotation_euler = (Vector(target) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(camera)
    return camera


def matrix_rows(matrix):
    return [list(row) for row in matrix]


def write_alpha(camera):
    """The alpha of a rendered picture as a gray PNG of 8 bits."""
    image = bpy.data.images.load(str(HERE / f"{camera.name}.png"))
    alpha = [round(255 * value) for value in list(image.pixels)[3::4]]  # from the bottom row up
    rows = [bytes([0, *alpha[y * WIDTH : (y + 1) * WIDTH]]) for y in reversed(range(HEIGHT))]

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    (HERE / f"{camera.name}_alpha.png").write_bytes(
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 0, 0, 0, 0))
        + chunk(b"IDAT", zlib.compress(b"".join(rows), 9))
        + chunk(b"IEND", b"")
    )


def main():
    write_obj()
    scene = make_scene()
    plain = add_camera(scene, "plain", (3.5, -4.5, 2.8), (0.2, 0, 0.7), 0.6911112070083618)
    shifted = add_camera(scene, "shifted", (-4.2, -2.0, 3.4), (0.5, -0.4, 0.3), 0.9, (0.17, -0.11))
    for camera in (plain, shifted):
        scene.camera = camera
        scene.render.filepath = str(HERE / f"{camera.name}.png")
        bpy.ops.render.render(write_still=True)
        write_alpha(camera)
    focal = 0.5 * WIDTH / math.tan(0.5 * shifted.data.angle_x)
    transforms = {
        "camera_angle_x": plain.data.angle_x,
        "frames": [
            {"file_path": "./plain", "rotation": 0.0, "transform_matrix": matrix_rows(plain.matrix_world)},
            {
                "file_path": "./shifted.png",
                "w": WIDTH,
                "h": HEIGHT,
                "fl_x": focal,
                "fl_y": focal,
                # A shift is a share of the longer side; the picture moves against it, y upwards.
                "cx": WIDTH / 2 - shifted.data.shift_x * WIDTH,
                "cy": HEIGHT / 2 + shifted.data.shift_y * WIDTH,
                "transform_matrix": matrix_rows(shifted.matrix_world),
            },
        ],
    }
    (HERE / "transforms.json").write_text(json.dumps(transforms, indent=2) + "\n")


if __name__ == "__main__":
    main()

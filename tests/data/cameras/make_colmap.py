#!/usr/bin/env python3
"""Writes, with pycolmap, what the tests compare cameras with: lenses.csv, a table of points that COLMAP projects
through each of its models; colmap/text and colmap/binary, one small reconstruction in both of its formats; and
poses.csv, where COLMAP has its images in the world, in the order of their names.

    python3 -m venv venv && venv/bin/pip install pycolmap==4.2.1 && venv/bin/python make_colmap.py
"""

import csv
from pathlib import Path

import numpy as np
import pycolmap

HERE = Path(__file__).parent
WIDTH, HEIGHT = 1200, 800

# Model, COLMAP's parameters, largest angle to the axis in degrees.
LENSES = [
    ("SIMPLE_PINHOLE", [900, 610.5, 380.25], 45),
    ("PINHOLE", [880, 910, 590, 412], 45),
    ("SIMPLE_RADIAL", [900, 600, 400, -0.17], 45),
    ("SIMPLE_RADIAL", [900, 600, 400, 0.3], 45),
    ("RADIAL", [870, 612, 391, -0.28, 0.09], 45),
    ("OPENCV", [860, 875, 605, 388, -0.31, 0.12, 0.006, -0.009], 42),
    ("OPENCV", [860, 875, 605, 388, 0.11, -0.04, -0.02, 0.013], 42),
    ("FULL_OPENCV", [600, 590, 590, 405, 0.9, 0.25, 0.002, -0.003, 0.02, 1.2, 0.5, 0.06], 55),
    ("SIMPLE_FISHEYE", [420, 600, 400], 85),
    ("FISHEYE", [420, 430, 590, 410], 85),
    ("SIMPLE_RADIAL_FISHEYE", [430, 600, 400, -0.04], 80),
    ("RADIAL_FISHEYE", [430, 600, 400, 0.06, -0.015], 80),
    ("OPENCV_FISHEYE", [440, 436, 588, 407, -0.05, 0.02, -0.008, 0.001], 88),
]
POINTS = 24


def write_lenses(rng):
    with open(HERE / "lenses.csv", "w", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["model", "count", *(f"p{i}" for i in range(12)), "width", "height", "x", "y", "z", "u", "v"])
        for name, params, widest in LENSES:
            camera = pycolmap.Camera(model=name, width=WIDTH, height=HEIGHT, params=params)
            for i in range(POINTS):
                # The first point lies on the axis, the second at the largest angle.
                angle = np.radians([0, widest][i] if i < 2 else widest * np.sqrt(rng.random()))
                around, distance = 2 * np.pi * rng.random(), 0.5 + 4 * rng.random()
                point = distance * np.array(
                    [np.sin(angle) * np.cos(around), np.sin(angle) * np.sin(around), np.cos(angle)]
                )
                point = np.round(point, 9)
                u, v = camera.img_from_cam(point)
                padded = [*params, *[0] * (12 - len(params))]
                rows.writerow(
                    [int(camera.model), len(params), *padded, WIDTH, HEIGHT, *point, f"{u:.9f}", f"{v:.9f}"]
                )


def make_reconstruction(rng):
    reconstruction = pycolmap.Reconstruction()
    models = [("SIMPLE_RADIAL", [500, 320, 240, -0.1], 640, 480), ("OPENCV_FISHEYE", [210, 212, 200, 150, 0.02, -0.01, 0.002, 0], 400, 300)]
    for i, (name, params, width, height) in enumerate(models, start=1):
        camera = pycolmap.Camera(model=name, width=width, height=height, params=params, camera_id=i)
        reconstruction.add_camera_with_trivial_rig(camera)
    names = ["front.jpg", "wide/side one.png", "back.jpg", "wide/above.png"]
    for i, name in enumerate(names, start=1):
        image = pycolmap.Image(name=name, camera_id=1 + ("wide" in name), image_id=10 * i)
        quaternion = rng.normal(size=4)
        pose = pycolmap.Rigid3d(pycolmap.Rotation3d(quaternion / np.linalg.norm(quaternion)), rng.normal(size=3))
        # One image has no points: its second line in the text is empty.
        points = rng.uniform(0, 300, size=(0 if i == 3 else 2 + i, 2))
        image.points2D = pycolmap.Point2DList([pycolmap.Point2D(p) for p in points])
        reconstruction.add_image_with_trivial_frame(image, pose)
    return reconstruction


def write_poses(reconstruction):
    with open(HERE / "colmap" / "poses.csv", "w", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow([f"m{row}{column}" for row in range(3) for column in range(4)])
        for image in sorted(reconstruction.images.values(), key=lambda image: image.name):
            world_from_camera = image.cam_from_world().inverse().matrix()
            rows.writerow([f"{value:.15g}" for value in world_from_camera.ravel()])


def main():
    rng = np.random.default_rng(7)
    write_lenses(rng)
    reconstruction = make_reconstruction(rng)
    write_poses(reconstruction)
    for form in ("text", "binary"):
        folder = HERE / "colmap" / form
        folder.mkdir(parents=True, exist_ok=True)
        getattr(reconstruction, f"write_{form}")(str(folder))
        for file in folder.iterdir():
            if file.stem not in ("cameras", "images"):
                file.unlink()


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Captures to test with: pictures of the seven scenes by Mitsuba 3, so that the renderer that is inverted did not make
them.

    bench/captures.py -o FOLDER                          the built-in scenes: goblet, tyre, bowl, tree
    bench/captures.py -o FOLDER --scenes DIR             the published ones, too: DIR/NAME/scene.xml
    bench/captures.py -o FOLDER --only bowl --size 32 --texture-size 64 --train 4 --test 2 --spp 4096

Of each scene FOLDER/NAME has
    scene/        a copy, with the textures of the unknown as truth
    capture.json  training views around the object, test views between them, two test views under other skies
    front.json    the camera of the scene file alone; test views 25 degrees to both sides, and under the two skies
    images/ environments/ made.json sheet.png    what the views name, how it was made, all pictures at a glance
    scene.json    what the copy was made of: other files of a published scene or another --texture-size are refused

A run that was stopped goes on where it was, and one with a larger --spp adds to the pictures that are there. Mitsuba
comes from the interpreter that BURNISH_MITSUBA_PYTHON names or from build/mitsuba.
"""
import argparse
import hashlib
import json
import math
from dataclasses import dataclass
from pathlib import Path

from mitsuba_python import MITSUBA, ROOT, go_on_with_mitsuba

go_on_with_mitsuba()

import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")

import mitsuba_scene
from compare_sides import PUBLISHED, SCENES
from scene_folder import write_scene

ASIDE = 25  # degrees, of test views beside the camera of the scene file
SKY_TURN = 70  # degrees about the vertical axis, of the second sky
SKY_SIZE = (128, 64)


@dataclass(frozen=True)
class Orbit:
    """Cameras around the centre of the object's box; degrees. Azimuth 0 is +z, 90 is +x. Training views lie at `low`
    and `high` in turn, test views halfway between neighbours."""
    first: float
    arc: float  # 360: all around
    low: float
    high: float
    distance: float  # of the camera, in units of the scene
    fov: float
    sky: float  # scale of both other skies: about as bright, on the object, as the lights of the scene

    def azimuth(self, i: float, count: int) -> float:
        return self.first + self.arc * i / (count if self.arc == 360 else count - 1)

    def training(self, count: int) -> list[tuple[float, float]]:
        """(azimuth, elevation)"""
        return [(self.azimuth(i, count), self.high if i % 2 else self.low) for i in range(count)]

    def tests(self, count: int, training: int) -> list[tuple[float, float]]:
        gaps = training if self.arc == 360 else training - 1
        return [(self.azimuth(k * gaps // count + 0.5, training), (self.low + self.high) / 2) for k in range(count)]


# Rooms are open to one side: the camera stays before their walls and above their floors.
ORBITS = {
    "ashtray": Orbit(-170, 360, 47, 65, 28.5, 39.6, 2),
    "tire": Orbit(-39, 360, 22, 50, 80, 39.6, 5),
    "chalice": Orbit(-65, 360, 20, 50, 27.5, 39.6, 20),
    "goblet": Orbit(8, 360, 15, 45, 2.6, 46, 1.2),
    "tyre": Orbit(-75, 150, 6, 40, 3.0, 46, 1),
    "bowl": Orbit(-50, 180, 35, 65, 2.6, 40, 1.8),
    "tree": Orbit(-65, 130, 5, 45, 2.5, 62, 0.9),
}


def arguments_of() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER")
    parser.add_argument("--scenes", type=Path, metavar="DIR", help="of the published scenes")
    parser.add_argument("--only", nargs="+", choices=ORBITS, metavar="NAME")
    parser.add_argument("--size", type=int, default=350, help="pixels a side")
    parser.add_argument("--spp", type=int, default=512, help="in passes of 16")
    parser.add_argument("--train", type=int, default=8, help="views, at least 2")
    parser.add_argument("--test", type=int, default=4, help="views under the sky of the scene")
    parser.add_argument("--texture-size", type=int, default=2048, help="of the built-in scenes")
    parser.add_argument("--burnish", type=Path, default=ROOT / "build/release/burnish", help="the program")
    arguments = parser.parse_args()
    if arguments.train < 2:
        parser.error(f"--train {arguments.train}: expected at least 2, between which test views lie")
    arguments.only = arguments.only or [n for n in ORBITS if arguments.scenes or n not in PUBLISHED]
    if not arguments.scenes and set(arguments.only) & set(PUBLISHED):
        parser.error("--scenes: expected the folder of the published scenes")
    return arguments


# ---- Cameras


def looking_at(origin, target) -> list[list[float]]:
    """camera_to_world in OpenCV's axes, +y up."""
    forward = (target - origin) / np.linalg.norm(target - origin)
    right = np.cross(forward, [0, 1, 0])
    right /= np.linalg.norm(right)
    return to_rows(right, np.cross(forward, right), forward, origin)


def to_rows(*columns) -> list[list[float]]:
    matrix = np.eye(4)
    matrix[:3, :] = np.stack(columns, axis=1)
    return matrix.round(9).tolist()


def turned(degrees: float, centre=(0, 0, 0)):
    """[4, 4]: about the vertical axis through a point."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    matrix = np.array([[c, 0, s, 0], [0, 1, 0, 0], [-s, 0, c, 0], [0, 0, 0, 1.0]])
    matrix[:3, 3] = centre - matrix[:3, :3] @ np.asarray(centre)
    return matrix


def pinhole(matrix: list[list[float]], fov: float, size: int) -> dict:
    focal = round(size / 2 / math.tan(math.radians(fov) / 2), 9)
    return {"model": "PINHOLE", "width": size, "height": size, "params": [focal, focal, size / 2, size / 2],
            "camera_to_world": matrix, "convention": "opencv"}


def view(name: str, camera: dict, **more) -> dict:
    return {"name": name, "image": f"images/{name}.exr", "camera": camera} | more


def skies(scale: float) -> dict[str, dict]:
    return {name: {"file": f"environments/{name}.exr", "scale": scale, "to_world": turned(degrees).round(9).tolist()}
            for name, degrees in (("dusk", 0), ("studio", SKY_TURN))}


def orbit_views(orbit: Orbit, centre, arguments) -> list[dict]:
    def camera(azimuth: float, elevation: float) -> dict:
        a, e = math.radians(azimuth), math.radians(elevation)
        direction = np.array([math.sin(a) * math.cos(e), math.sin(e), math.cos(a) * math.cos(e)])
        return pinhole(looking_at(centre + orbit.distance * direction, centre), orbit.fov, arguments.size)

    tests = [camera(*d) for d in orbit.tests(arguments.test, arguments.train)]
    return ([view(f"train-{i}", camera(*d)) for i, d in enumerate(orbit.training(arguments.train))]
            + [view(f"test-{i}", c, split="test") for i, c in enumerate(tests)]
            + [view(f"test-{sky}", c, environment=e, split="test")
               for (sky, e), c in zip(skies(orbit.sky).items(), tests)])


def front_views(orbit: Orbit, scene, centre, size: int) -> list[dict]:
    """Mitsuba's axes to OpenCV's: x and y turn around."""
    to_world, fov = mitsuba_scene.own_camera(scene)
    own = to_world @ np.diag([-1.0, -1, 1, 1])
    aside = {name: (turned(degrees, centre) @ own).round(9).tolist()
             for name, degrees in (("left", -ASIDE), ("right", ASIDE))}
    front = {"sensor": 0}
    return ([view("front", front)]
            + [view(f"front-{name}", pinhole(m, fov, size), split="test") for name, m in aside.items()]
            + [view(f"front-{sky}", front, environment=e, split="test") for sky, e in skies(orbit.sky).items()])


# ---- Skies


def lobe(directions, towards, degrees: float):
    """[height, width]: 1 in a direction, falling to 1/e at so many degrees from it."""
    towards = np.asarray(towards, dtype=float) / np.linalg.norm(towards)
    return np.exp((directions @ towards - 1) / (1 - math.cos(math.radians(degrees))))


def sky_image(name: str):
    """[height, width, 3]. dusk: a low sun below a bright horizon; studio: three soft boxes in the dark."""
    width, height = SKY_SIZE
    phi, theta = np.meshgrid((np.arange(width) + 0.5) / width * 2 * np.pi, (np.arange(height) + 0.5) / height * np.pi)
    d = np.stack([np.sin(phi) * np.sin(theta), np.cos(theta), -np.cos(phi) * np.sin(theta)], axis=-1)
    if name == "dusk":
        up = d[..., 1:2]
        sky = np.where(up > 0, [0.25, 0.4, 0.8] + np.exp(-6 * abs(up)) * [0.9, 0.5, 0.1], [0.12, 0.1, 0.09])
        return sky + lobe(d, (0.8, 0.5, 0.6), 7)[..., None] * [40, 28, 16]
    boxes = [((0.9, 0.9, 0.3), 14, (9, 9, 9)), ((-0.8, 0.5, 0.7), 18, (7, 4.5, 2.5)), ((0.1, 0.7, -1), 12, (3, 6, 12))]
    return 0.06 + sum(lobe(d, towards, degrees)[..., None] * color for towards, degrees, color in boxes)


# ---- Folders


def write_json(file: Path, content: dict) -> None:
    """As a whole: one that is stopped leaves what was there."""
    aside = file.with_suffix(".unfinished")
    aside.write_text(json.dumps(content, indent=1) + "\n")
    aside.replace(file)


def hash_of(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()


def record_of(v: dict, made: dict, image: Path) -> dict:
    """Of the picture that is there: that of made.json, or the one `before` it where a run was stopped before it moved
    its picture into place; empty: none is of it. Records without a hash are taken as they are."""
    if not image.exists():
        return {}
    record, found = made["views"].get(v["name"], {}), hash_of(image)
    while record and record.get("sha256", found) != found:
        record = record.get("before", {})
    return {k: value for k, value in record.items() if k != "before"}


def write_picture(folder: Path, v: dict, made: dict, passes: int, picture: np.ndarray) -> None:
    """And made.json, whose record tells by the hash whether the picture is there yet. made: its record is that of the
    picture that is there."""
    image = folder / v["image"]
    aside = image.with_name("unfinished.exr")
    mitsuba_scene.write_image(aside, picture)
    made["views"][v["name"]] = {"passes": passes, "view": v, "sha256": hash_of(aside),
                                "before": made["views"][v["name"]]}
    write_json(folder / "made.json", made)
    aside.replace(image)
    del made["views"][v["name"]]["before"]


def render_views(folder: Path, views: list[dict], made: dict, passes: int) -> None:
    """Adds passes to pictures that have fewer. made: what made.json says."""
    for v in views:
        made["views"][v["name"]] = record_of(v, made, folder / v["image"])

    def passes_of(v: dict) -> int:
        """0 where the picture is of another camera."""
        record = made["views"][v["name"]]
        return record["passes"] if record.get("view") == v else 0

    for sky in [None, *skies(1)]:
        todo = [v for v in views if Path(v.get("environment", {}).get("file", "")).stem == (sky or "")
                and passes_of(v) < passes]
        if not todo:
            continue
        file, environment = folder / "scene" / "scene.xml", todo[0].get("environment")
        scene = mitsuba_scene.load(file, (), made["defines"], folder, environment)
        for v in todo:
            image, before = folder / v["image"], passes_of(v)
            picture = np.mean(mitsuba_scene.render(scene, v, range(before, passes)), axis=0)
            if before:
                picture += (mitsuba_scene.read_image(image) - picture) * (before / passes)
            write_picture(folder, v, made, passes, picture)
            print(image, flush=True)
    write_json(folder / "made.json", made)


def write_sheet(file: Path, images: list[Path], columns: int = 7) -> None:
    """All pictures at a glance, sRGB: each with its median at a quarter."""
    pictures = [mitsuba_scene.read_image(i) for i in images]
    blank = np.zeros_like(pictures[0])
    cells = [p / (4 * np.median(p)) for p in pictures] + [blank] * (-len(pictures) % columns)
    rows = [np.concatenate(cells[i:i + columns], axis=1) for i in range(0, len(cells), columns)]
    sheet = mi.Bitmap(np.concatenate(rows).clip(0, 1).astype(np.float32))
    sheet.convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.UInt8, srgb_gamma=True).write(str(file))


def make_capture(name: str, arguments) -> None:
    folder, orbit, parameter = arguments.output / name, ORBITS[name], SCENES[name][0]
    file = write_scene(name, folder, arguments)
    for sky in skies(1):
        mitsuba_scene.write_image(folder / "environments" / f"{sky}.exr", sky_image(sky))
    defines = {"resx": str(arguments.size), "resy": str(arguments.size)}
    if name in PUBLISHED:
        defines["integrator"] = "direct"
    scene = mitsuba_scene.load(file, (), defines)
    box = mi.ScalarBoundingBox3f()
    for shape in mitsuba_scene.shapes_of(scene, [parameter]):
        box.expand(shape.bbox())
    centre = np.array(box.center(), dtype=float).ravel()
    captures = {"capture": orbit_views(orbit, centre, arguments),
                "front": front_views(orbit, scene, centre, arguments.size)}
    for kind, views in captures.items():
        write_json(folder / f"{kind}.json", {"version": 1, "scene": "scene/scene.xml", "defines": defines,
                                             "views": views})
    views = [v for kind in captures.values() for v in kind]
    made = {"scene": name, "parameters": [parameter], "by": MITSUBA, "defines": defines, "views": {}}
    if (folder / "made.json").exists():
        before = json.loads((folder / "made.json").read_text())
        made["views"] = before["views"] if before["defines"] == defines else {}
    render_views(folder, views, made, math.ceil(arguments.spp / mitsuba_scene.PASS_SPP))
    write_sheet(folder / "sheet.png", [folder / v["image"] for v in views])


def main() -> None:
    arguments = arguments_of()
    for name in arguments.only:
        make_capture(name, arguments)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Photographs as a phone leaves them, to try docs/guide/photographs-to-blender.md with.

    bench/phone_photographs.py make FOLDER               24 photographs of 1000 x 750
    bench/phone_photographs.py compare FOLDER SPARSE     COLMAP's cameras beside the true ones
    bench/phone_photographs.py pick FOLDER SPARSE        4 x 4, from six pairs of points as a hand would pick them

FOLDER has
    photos/      JPEG files: 8 bits, noise, an exposure of each one's own, held by hand, a lens that bends (OPENCV)
    sky.hdr      the light at the object's place, as a 360 degree camera sees it, turned by 50 degrees
    object.ply   the object's mesh, y up, without texture coordinates
    truth/       cameras.json and scene.xml: what nobody knows

The object is the goblet, painted, on a floor with a pattern; light bounces. `compare` moves the cameras of a COLMAP
text model onto the true ones by the best rotation, translation and scale, and prints what is left. `--moved`:
they have been moved to the mesh, and may only be turned about the axis of the goblet, which no mesh of it tells.
"""
import argparse
import json
import subprocess
from pathlib import Path

from mitsuba_python import ROOT, go_on_with_mitsuba

go_on_with_mitsuba()

import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")

import captures
import mitsuba_scene
from demo_photographs import QUALITY, photograph

COUNT, WIDTH, HEIGHT, FOCAL = 24, 1000, 750, 780.0
LENS = (-0.07, 0.02)  # k1, k2: the corners move inwards by 16 pixels
MARGIN = 60  # pixels around the picture, rendered for the lens to bend in
CENTRE = np.array([0, 0.8, 0])
SKY_YAW = 50  # degrees, how the 360 degree camera stood
BASE_COLOR, ROUGHNESS = ((0.75, 0.70, 0.6), (0.15, 0.35, 0.6), (0.65, 0.2, 0.1)), (0.15, 0.6, 0.35)
FLOOR = ((0.5, 0.45, 0.4), (0.15, 0.12, 0.1), (0.6, 0.25, 0.1))
SENSOR = """<sensor type="perspective"><float name="fov" value="{fov:.9g}"/>
        <transform name="to_world"><matrix value="{matrix}"/></transform>
        <film type="hdrfilm"><integer name="width" value="{width}"/><integer name="height" value="{height}"/></film>
    </sensor>
    """
PICKED = [(0.4, 0.08, 0), (-0.4, 0.08, 0.2), (0, 1.6, 0.45), (0.4, 1.4, -0.2), (-0.4, 1.5, -0.1), (0, 1, 0.4)]
PICKING_ERROR = 0.02
SCENE = """<scene version="3.0.0">
    <integrator type="path"><integer name="max_depth" value="4"/></integrator>
    <emitter type="envmap"><string name="filename" value="room.exr"/></emitter>
    <bsdf type="twosided" id="floor"><bsdf type="principled">
        <texture type="bitmap" name="base_color"><string name="filename" value="floor.exr"/></texture>
        <float name="roughness" value="0.6"/></bsdf></bsdf>
    <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="6"/></transform>
        <ref id="floor"/></shape>{object}
</scene>
"""
OBJECT = """
    <bsdf type="twosided" id="paint"><bsdf type="principled">
        <texture type="bitmap" name="base_color"><string name="filename" value="base_color.exr"/></texture>
        <texture type="bitmap" name="roughness"><string name="filename" value="roughness.exr"/>
            <boolean name="raw" value="true"/></texture></bsdf></bsdf>
    <shape type="ply"><string name="filename" value="goblet.ply"/><ref id="paint"/></shape>
    <shape type="ply"><string name="filename" value="inside.ply"/><ref id="paint"/></shape>"""


# ---- The scene


def noise(random, size: int, cells: int):
    """[size, size], smooth, in about [-1, 1]; tiles."""
    grid = random.uniform(-1, 1, (cells, cells))
    at = np.arange(size) * cells / size
    low, t = at.astype(int), (at % 1) ** 2 * (3 - 2 * (at % 1))
    rows = grid[low] * (1 - t)[:, None] + grid[(low + 1) % cells] * t[:, None]
    return rows[:, low] * (1 - t) + rows[:, (low + 1) % cells] * t


def pattern(random, size: int, cells: int, colors):
    """[size, size, channels]: blots of three colours, of many sizes, with sharp edges."""
    a, b = (sum(noise(random, size, cells * 2 ** k) / 1.4 ** k for k in range(5)) for _ in range(2))
    kind = np.where(a > 0.25, 1, np.where(b > 0.45, 2, 0))
    shade = 1 + 0.25 * noise(random, size, cells * 40)
    return np.asarray(colors).reshape(3, -1)[kind] * shade[..., None]


def write_scene(folder: Path, burnish: Path) -> None:
    made = folder / "goblet"
    subprocess.run([burnish, "scene", "goblet", "-o", made, "--texture-size", "64"], check=True, capture_output=True)
    for name in ("goblet", "inside"):
        (made / "meshes" / f"{name}.ply").rename(folder / f"{name}.ply")
    for name, seed, cells, colors in (("base_color", 10, 6, BASE_COLOR), ("roughness", 9, 6, ROUGHNESS),
                                      ("floor", 5, 24, FLOOR)):
        image = pattern(np.random.default_rng(seed), 2048, cells, colors)
        mitsuba_scene.write_image(folder / f"{name}.exr", image)
    captures.SKY_SIZE = (512, 256)
    mitsuba_scene.write_image(folder / "room.exr", captures.sky_image("dusk"))
    (folder / "scene.xml").write_text(SCENE.format(object=OBJECT))
    (folder / "room.xml").write_text(SCENE.format(object=""))


def write_mesh(file: Path, parts: list[Path]) -> None:
    """Text PLY without texture coordinates."""
    vertices, faces, count = [], [], 0
    for part in parts:
        mesh = mi.load_dict({"type": "ply", "filename": str(part)})
        vertices.append(np.array(mi.traverse(mesh)["vertex_positions"]).reshape(-1, 3))
        faces.append(np.array(mi.traverse(mesh)["faces"]).reshape(-1, 3) + count)
        count += len(vertices[-1])
    points, triangles = np.concatenate(vertices), np.concatenate(faces)
    with file.open("w") as out:
        out.write(f"ply\nformat ascii 1.0\nelement vertex {len(points)}\nproperty float x\nproperty float y\n"
                  f"property float z\nelement face {len(triangles)}\n"
                  "property list uchar int vertex_indices\nend_header\n")
        np.savetxt(out, points, "%.6g")
        np.savetxt(out, np.column_stack([np.full(len(triangles), 3), triangles]), "%d")


# ---- Pictures


def hand_held(random) -> list[np.ndarray]:
    """camera_to_world of each picture, OpenCV's axes."""
    matrices = []
    for i in range(COUNT):
        azimuth, elevation = np.radians(360 / COUNT * i + random.normal(0, 3)), np.radians((18, 34, 50)[i % 3])
        direction = np.array([np.sin(azimuth), np.tan(elevation), np.cos(azimuth)]) * np.cos(elevation)
        origin = CENTRE + random.uniform(2.5, 3.1) * direction
        matrix = np.array(captures.looking_at(origin, CENTRE + random.normal(0, 0.06, 3)))
        c, s = np.cos(roll := random.normal(0, 0.06)), np.sin(roll)
        matrix[:3, :2] = matrix[:3, :2] @ np.array([[c, -s], [s, c]])
        matrices.append(matrix)
    return matrices


def bent(picture):
    """As the lens shows it, of a wider picture of a pinhole camera."""
    x, y = np.meshgrid((np.arange(WIDTH) + 0.5 - WIDTH / 2) / FOCAL, (np.arange(HEIGHT) + 0.5 - HEIGHT / 2) / FOCAL)
    scale = np.ones_like(x)
    for _ in range(20):
        r2 = (x * x + y * y) / scale ** 2
        scale = 1 + LENS[0] * r2 + LENS[1] * r2 * r2
    return sampled(picture, x / scale * FOCAL + WIDTH / 2 + MARGIN - 0.5, y / scale * FOCAL + HEIGHT / 2 + MARGIN - 0.5)


def sampled(picture, x, y):
    """Bilinear, pixel centres at whole numbers."""
    left, top = (np.clip(np.floor(v).astype(int), 0, n - 2) for v, n in ((x, picture.shape[1]), (y, picture.shape[0])))
    u, v = np.clip(x - left, 0, 1)[..., None], np.clip(y - top, 0, 1)[..., None]
    return ((picture[top, left] * (1 - u) + picture[top, left + 1] * u) * (1 - v)
            + (picture[top + 1, left] * (1 - u) + picture[top + 1, left + 1] * u) * v)


def render(burnish: Path, scene: Path, cameras, width: int, height: int, focal: float, spp: int):
    """Pictures of a pinhole camera that is moved; light bounces twice."""
    fov = np.rad2deg(2 * np.arctan(width / 2 / focal))
    sensors = [SENSOR.format(fov=fov, width=width, height=height, matrix=mitsuba_scene.matrix_text(
        np.array(matrix) @ np.diag([-1.0, -1, 1, 1]))) for matrix in cameras]
    file, image = scene.with_name("cameras.xml"), scene.with_name("image.exr")
    file.write_text(scene.read_text().replace("<emitter", "".join(sensors) + "<emitter", 1))
    for i in range(len(sensors)):
        subprocess.run([burnish, "render", file, "--sensor", str(i), "--spp", str(spp), "--seed", str(i), "-o", image],
                       check=True, capture_output=True)
        yield mitsuba_scene.read_image(image).astype(np.float64)[..., :3]


def write_sky(file: Path, burnish: Path, scene: Path, spp: int) -> None:
    """Six views from the object's place; longitude and latitude in the axes of a camera that stands turned."""
    width, side = 1024, 512
    axes = {"+x": [(0, 0, 1), (0, -1, 0), (1, 0, 0)], "-x": [(0, 0, -1), (0, -1, 0), (-1, 0, 0)],
            "+y": [(1, 0, 0), (0, 0, 1), (0, 1, 0)], "-y": [(1, 0, 0), (0, 0, -1), (0, -1, 0)],
            "+z": [(-1, 0, 0), (0, -1, 0), (0, 0, 1)], "-z": [(1, 0, 0), (0, -1, 0), (0, 0, -1)]}
    angles = (np.arange(width) + 0.5) / width * 2 * np.pi
    phi, theta = np.meshgrid(angles, angles[:width // 2])
    phi += np.radians(SKY_YAW)
    d = np.stack([np.sin(phi) * np.sin(theta), np.cos(theta), -np.cos(phi) * np.sin(theta)], axis=-1)
    sky = np.zeros(d.shape)
    focal = side / 2 * 0.98  # a little wider than a right angle, for the edges
    cameras = [captures.to_rows(*axis, CENTRE) for axis in axes.values()]
    for (right, down, forward), face in zip(axes.values(), render(burnish, scene, cameras, side, side, focal, spp)):
        depth = d @ np.array(forward)
        there = depth >= np.abs(d).max(axis=-1) - 1e-9
        x, y = (d @ np.array(axis) / np.where(there, depth, 1) * focal + side / 2 - 0.5 for axis in (right, down))
        sky[there] = sampled(face, x[there], y[there])
    mi.Bitmap(sky.astype(np.float32)).write(str(file))


def make(folder: Path, spp: int, burnish: Path) -> None:
    for name in ("photos", "truth"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    truth = folder / "truth"
    write_scene(truth, burnish)
    write_mesh(folder / "object.ply", [truth / "goblet.ply", truth / "inside.ply"])
    write_sky(folder / "sky.hdr", burnish, truth / "room.xml", spp)
    random, cameras = np.random.default_rng(7), {}
    matrices = hand_held(random)
    images = render(burnish, truth / "scene.xml", matrices, WIDTH + 2 * MARGIN, HEIGHT + 2 * MARGIN, FOCAL, spp)
    for i, (matrix, image) in enumerate(zip(matrices, images)):
        name, radiance = f"IMG_{2041 + i}.jpg", bent(image)
        exposure = random.uniform(0.75, 1.3) * 0.5 / np.quantile(radiance.mean(axis=2), 0.9)
        mi.Bitmap(photograph(radiance, exposure, random).astype(np.float32)).convert(
            mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.UInt8, srgb_gamma=True).write(
                str(folder / "photos" / name), quality=QUALITY)
        cameras[name] = {"camera_to_world": matrix.tolist(), "exposure": exposure}
        print(name, flush=True)
    captures.write_json(truth / "cameras.json", cameras)


# ---- COLMAP's cameras


def rotation(w, x, y, z):
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def colmap_cameras(sparse: Path) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Rotation from the camera to the world, and centre, of each picture of a text model."""
    lines = [line.split() for line in (sparse / "images.txt").read_text().splitlines() if not line.startswith("#")]
    found = {}
    for line in lines[::2]:
        turn = rotation(*map(float, line[1:5])).T
        found[line[9]] = (turn, -turn @ np.array(line[5:8], dtype=float))
    return found


def similarity(source, target) -> tuple[float, np.ndarray, np.ndarray]:
    """Scale, rotation and translation that move points onto others (Umeyama)."""
    a, b = source - source.mean(axis=0), target - target.mean(axis=0)
    u, s, vt = np.linalg.svd(b.T @ a)
    signs = np.array([1, 1, np.sign(np.linalg.det(u @ vt))])
    turn = u * signs @ vt
    scale = (s * signs).sum() / (a * a).sum()
    return scale, turn, target.mean(axis=0) - scale * turn @ source.mean(axis=0)


def pick(folder: Path, sparse: Path) -> None:
    """Of COLMAP's points those nearest to six places of the object, beside these points with an error."""
    truth = json.loads((folder / "truth" / "cameras.json").read_text())
    found = colmap_cameras(sparse)
    true = np.array([truth[n]["camera_to_world"] for n in found])
    scale, turn, shift = similarity(np.array([c for _, c in found.values()]), true[:, :3, 3])
    lines = [line.split() for line in (sparse / "points3D.txt").read_text().splitlines() if not line.startswith("#")]
    points = np.array([line[1:4] for line in lines], dtype=float)
    places = scale * points @ turn.T + shift
    chosen = [np.argmin(np.linalg.norm(places - place, axis=1)) for place in PICKED]
    error = np.random.default_rng(3).normal(0, PICKING_ERROR, (len(chosen), 3))
    scale, turn, shift = similarity(points[chosen], places[chosen] + error)
    for row in [*np.column_stack([scale * turn, shift]), [0, 0, 0, 1]]:
        print(" ".join(f"{v:.9g}" for v in row))


def turned_about_axis(source, target) -> tuple[float, np.ndarray, np.ndarray]:
    """The same, but for the angle about +y alone given."""
    across = (source[:, 2] * target[:, 0] - source[:, 0] * target[:, 2]).sum()
    along = (source[:, [0, 2]] * target[:, [0, 2]]).sum()
    return 1, captures.turned(np.degrees(np.arctan2(across, along)))[:3, :3], np.zeros(3)


def compare(folder: Path, sparse: Path, moved: bool) -> None:
    truth = json.loads((folder / "truth" / "cameras.json").read_text())
    found = colmap_cameras(sparse)
    names = sorted(set(truth) & set(found))
    true = [np.array(truth[n]["camera_to_world"]) for n in names]
    centres, wanted = np.array([found[n][1] for n in names]), np.array([m[:3, 3] for m in true])
    scale, turn, shift = (turned_about_axis if moved else similarity)(centres, wanted)
    places = np.linalg.norm(scale * centres @ turn.T + shift - wanted, axis=1)
    angles = [np.degrees(np.arccos(np.clip((np.trace(m[:3, :3].T @ turn @ found[n][0]) - 1) / 2, -1, 1)))
              for n, m in zip(names, true)]
    distance = np.linalg.norm(wanted - CENTRE, axis=1).mean()
    print(f"{len(names)} of {len(truth)} cameras; scale {scale:.5f}")
    print(f"place: RMS {np.sqrt((places ** 2).mean()):.5f}, largest {places.max():.5f}, {distance:.2f} from the object")
    print(f"direction: RMS {np.sqrt(np.mean(np.square(angles))):.4f}, largest {max(angles):.4f} degrees")
    pixel = []  # where the camera sees a point of the object, and where it should
    for n, m in zip(names, true):
        for corner in CENTRE + 0.5 * np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]):
            at = (found[n][0].T @ (turn.T @ (corner - shift) / scale - found[n][1]), m[:3, :3].T @ (corner - m[:3, 3]))
            pixel.append(FOCAL * np.linalg.norm(at[0][:2] / at[0][2] - at[1][:2] / at[1][2]))
    print(f"of a point at the object: RMS {np.sqrt(np.mean(np.square(pixel))):.3f}, largest {max(pixel):.3f} pixels "
          "at the true focal length")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    making, comparing, picking = (commands.add_parser(name) for name in ("make", "compare", "pick"))
    for command in (making, comparing, picking):
        command.add_argument("folder", type=Path)
    making.add_argument("--spp", type=int, default=16)
    making.add_argument("--burnish", type=Path, default=ROOT / "build/release/burnish", help="the program")
    for command in (comparing, picking):
        command.add_argument("sparse", type=Path, help="a model as text")
    comparing.add_argument("--moved", action="store_true", help="to the mesh")
    arguments = parser.parse_args()
    if arguments.command == "make":
        make(arguments.folder, arguments.spp, arguments.burnish)
    elif arguments.command == "pick":
        pick(arguments.folder, arguments.sparse)
    else:
        compare(arguments.folder, arguments.sparse, arguments.moved)


if __name__ == "__main__":
    main()

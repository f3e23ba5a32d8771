#!/usr/bin/env python3
"""Recovers textures of random scenes from one and from four pictures, with the searched start and from 0.5.

    bench/random_scenes.py COUNT --burnish build/release/burnish -o FOLDER [--first SEED] [--time SECONDS] [--unknowns N]

Each seed is a scene: a shape, a light, a material whose numbers are textures or constants, one to three of them
unknown, six cameras, 160 x 160 pixels. Its files lie in FOLDER/SEED: scene.xml and capture.json, whose last two views
are held out. Without --time the start alone is made. --unknowns: only scenes with that many or more. Writes
FOLDER/random_scenes.json and prints what each scene is, its errors from each start, then means. Texture errors are
root mean squares over the texels that light reaches. Needs numpy.
"""
import argparse
import json
import math
import statistics
from pathlib import Path

import numpy as np

from compare_sides import call

RESOLUTION = 160
#: Of each number of a BSDF: channels, and the range of its values.
NUMBERS = {
    "principled": {"base_color": (3, 0.05, 0.9), "roughness": (1, 0.08, 0.9), "metallic": (1, 0, 1),
                   "anisotropic": (1, 0, 0.9), "clearcoat": (1, 0, 1), "specular": (1, 0.1, 0.9)},
    "roughconductor": {"alpha": (1, 0.05, 0.6), "specular_reflectance": (3, 0.2, 1)},
    "roughplastic": {"diffuse_reflectance": (3, 0.05, 0.9)},
    "diffuse": {"reflectance": (3, 0.05, 0.9)},
}
#: How often each is unknown.
WEIGHTS = {
    "principled": [0.33, 0.42, 0.15, 0.06, 0.04, 0],  # specular is a constant in Mitsuba
    "roughconductor": [0.7, 0.3], "roughplastic": [1], "diffuse": [1],
}

# ---- Textures


def noise(random, size: int, octaves: list[int], channels: int) -> np.ndarray:
    """[size, size, channels], the sum of smooth noises that repeat; octaves: their cells on a side."""
    total = np.zeros((size, size, channels))
    for cells in octaves:
        values = random.normal(size=(cells, cells, channels))
        at = np.arange(size) * cells / size
        cell, weight = at.astype(int), at % 1
        weight = weight * weight * (3 - 2 * weight)
        rows = values[cell] * (1 - weight)[:, None, None] + values[(cell + 1) % cells] * weight[:, None, None]
        total += rows[:, cell] * (1 - weight)[:, None] + rows[:, (cell + 1) % cells] * weight[:, None]
    return total


def stripes(random, size: int, channels: int) -> np.ndarray:
    wave = np.sin(2 * np.pi * random.choice([3, 6, 12]) * np.arange(size) / size) * 0.5 + 0.5
    pattern = np.broadcast_to(wave[:, None, None], (size, size, channels))
    return pattern.transpose(1, 0, 2) if random.random() < 0.5 else pattern


def checker(random, size: int, channels: int) -> np.ndarray:
    cell = np.arange(size) * random.choice([4, 8, 16]) // size
    dark, bright = random.uniform(0, 0.5, channels), random.uniform(0.5, 1, channels)
    return np.where(((cell[:, None] + cell) % 2)[..., None], bright, dark)


PATTERNS = {
    "noise": lambda random, size, channels: noise(random, size, [4, 8, 16], channels),
    "fine noise": lambda random, size, channels: noise(random, size, [8, 32, 64], channels),
    "spots": lambda random, size, channels: (noise(random, size, [8, 16], channels) > 0.4).astype(float),
    "checker": checker,
    "stripes": stripes,
    "ramp": lambda _, size, channels: np.broadcast_to(np.arange(size)[:, None] / size, (size, size, channels)),
    "flat": lambda random, size, channels: np.broadcast_to(random.uniform(0, 1, channels), (size, size, channels)),
}


def texture(random, size: int, channels: int, low: float, high: float) -> tuple[str, np.ndarray]:
    kind = random.choice(list(PATTERNS), p=[0.22, 0.18, 0.2, 0.12, 0.12, 0.08, 0.08])
    pattern = PATTERNS[kind](random, size, channels)
    if kind != "flat":
        pattern = (pattern - pattern.min()) / max(1e-9, pattern.max() - pattern.min())
    low, high = (low, high) if random.random() < 0.5 else sorted(random.uniform(low, high, 2))
    return kind, low + (high - low) * pattern


def write_pfm(file: Path, image: np.ndarray) -> None:
    """image: [height, width, 1 or 3], linear, the top row first."""
    height, width, channels = image.shape
    header = f"{'PF' if channels == 3 else 'Pf'}\n{width} {height}\n-1.0\n".encode()
    file.write_bytes(header + image[::-1].astype("<f4").tobytes())


# ---- Pieces of scene.xml


def material(random, folder: Path) -> tuple[str, list[str], str]:
    """The BSDF's element, its unknown numbers, and words on all of them. Writes the textures."""
    model = random.choice(list(NUMBERS), p=[0.7, 0.1, 0.1, 0.1])
    numbers, size = NUMBERS[model], int(random.choice([64, 128, 256]))
    count = min(np.count_nonzero(WEIGHTS[model]), int(random.choice([1, 2, 3], p=[0.6, 0.25, 0.15])))
    unknown = list(random.choice(list(numbers), count, replace=False, p=WEIGHTS[model]))
    inner, words = "", [model, f"{size} x {size}"]
    for name, (channels, low, high) in numbers.items():
        if name in unknown or (name != "specular" and random.random() < 0.3):
            kind, values = texture(random, size, channels, low, high)
            write_pfm(folder / f"{name}.pfm", values)
            filter_type = random.choice(["nearest", "bilinear"])
            inner += (f'<texture type="bitmap" name="{name}"><string name="filename" value="{name}.pfm"/>'
                      f'<boolean name="raw" value="true"/><string name="filter_type" value="{filter_type}"/></texture>\n')
            words.append(f"{name}{'?' if name in unknown else ''} {kind} {values.min():.2f} to {values.max():.2f}")
        elif channels == 3:
            inner += '<rgb name="{}" value="{:.3f}, {:.3f}, {:.3f}"/>\n'.format(name, *random.uniform(0.1, 0.9, 3))
        elif name not in ("anisotropic", "clearcoat") or random.random() < 0.3:
            value = random.choice([0.0, 1.0, random.uniform()]) if name == "metallic" else random.uniform(low, high)
            inner += f'<float name="{name}" value="{value:.3f}"/>\n'
            words.append(f"{name} {value:.2f}")
    if model == "roughconductor":
        inner += f'<string name="material" value="{random.choice(["Al", "Cu", "Au"])}"/>'
    element = f'<bsdf type="twosided" id="material"><bsdf type="{model}">\n{inner}</bsdf></bsdf>\n'
    return element, unknown, ", ".join(words)


def grid_mesh(points: np.ndarray, file: Path) -> None:
    """points: [rows, columns, 3], with texture coordinates from 0 to 1."""
    rows, columns = points.shape[:2]
    lines = ["v {:.6f} {:.6f} {:.6f}".format(*p) for p in points.reshape(-1, 3)]
    lines += [f"vt {x / (columns - 1):.6f} {y / (rows - 1):.6f}" for y in range(rows) for x in range(columns)]
    for y in range(rows - 1):
        for x in range(columns - 1):
            a = y * columns + x + 1
            b, c, d = a + 1, a + columns + 1, a + columns
            lines += [f"f {a}/{a} {b}/{b} {c}/{c}", f"f {a}/{a} {c}/{c} {d}/{d}"]
    file.write_text("\n".join(lines) + "\n")


def shape(random, folder: Path) -> tuple[str, str]:
    """The element, and its kind."""
    kind = random.choice(["sphere", "cube", "rectangle", "bumpy", "torus", "hill"])
    placed = {"sphere": '<translate y="1"/>', "rectangle": '<rotate x="1" angle="-60"/><translate y="0.9"/>',
              "cube": '<scale value="0.7"/><rotate y="1" angle="25"/><translate y="0.75"/>'}
    if kind in placed:
        inner = f'<transform name="to_world">{placed[kind]}</transform>'
        return f'<shape type="{kind}">{inner}<ref id="material"/></shape>\n', kind
    u, v = np.meshgrid(np.linspace(0, 1, 97), np.linspace(0, 1, 97))
    a, b = 2 * np.pi * u, np.pi * v
    if kind == "bumpy":
        radius = 1 + 0.12 * np.sin(5 * a) * np.sin(b) ** 2 * np.sin(4 * b)
        points = [-radius * np.sin(b) * np.cos(a), 1 - radius * np.cos(b), radius * np.sin(b) * np.sin(a)]
    elif kind == "torus":
        ring = 0.8 + 0.35 * np.cos(2 * b)
        points = [ring * np.cos(a), 0.9 + 0.9 * ring * np.sin(a), 0.35 * np.sin(2 * b)]
    else:
        height = 0.3 + 0.5 * np.exp(-6 * ((u - 0.5) ** 2 + (v - 0.5) ** 2)) + 0.05 * np.sin(20 * u)
        points = [2.4 * u - 1.2, height, 1.2 - 2.4 * v]
    grid_mesh(np.stack(points, -1), folder / "shape.obj")
    return '<shape type="obj"><string name="filename" value="shape.obj"/><ref id="material"/></shape>\n', kind


def sky(random, folder: Path, kind: str) -> str:
    height, width = 64, 128
    up = np.maximum(0, np.linspace(1, -1, height))[:, None, None]
    image = up * random.uniform(0.3, 1, 3) + 0.15 * random.uniform(0.3, 1, 3)
    image = image + 0.2 * np.clip(noise(random, width, [4, 8, 16], 1)[:height], 0, 3)
    for _ in range({"sky": 0, "sun": 1, "lamps": 8}[kind]):
        y, x, side = int(random.uniform(4, 30)), int(random.uniform(4, 120)), int(random.uniform(1, 5))
        bright = random.uniform(80, 480) if kind == "sun" else random.uniform(20, 120) / side
        image[y - side:y + side, x - side:x + side] += bright * random.uniform(0.5, 1, 3)
    write_pfm(folder / "sky.pfm", image)
    return '<emitter type="envmap"><string name="filename" value="sky.pfm"/></emitter>\n'


def panel(random) -> str:
    """An area light that faces the middle."""
    transform = (f'<scale value="{random.uniform(0.2, 0.8):.3f}"/><translate z="-3"/><rotate x="1" '
                 f'angle="{random.uniform(20, 70):.1f}"/><rotate y="1" angle="{random.uniform(0, 360):.1f}"/>'
                 '<translate y="0.8"/>')
    radiance = "{:.2f}, {:.2f}, {:.2f}".format(*random.uniform(8, 20, 3))
    return (f'<shape type="rectangle"><transform name="to_world">{transform}</transform><emitter type="area">'
            f'<rgb name="radiance" value="{radiance}"/></emitter></shape>\n')


def lights(random, folder: Path) -> tuple[str, str]:
    """The elements, and their kind."""
    kind = random.choice(["sky", "sun", "lamps", "panels", "constant", "points"], p=[0.25, 0.25, 0.2, 0.15, 0.08, 0.07])
    constant = '<emitter type="constant"><rgb name="radiance" value="{0}, {0}, {0}"/></emitter>\n'
    if kind == "panels":
        return "".join(panel(random) for _ in range(int(random.integers(1, 4)))) + constant.format(0.1), kind
    if kind == "constant":
        return constant.format(0.9), kind
    if kind == "points":
        element = ('<emitter type="point"><point name="position" x="{:.2f}" y="{:.2f}" z="{:.2f}"/>'
                   '<rgb name="intensity" value="{:.1f}, {:.1f}, {:.1f}"/></emitter>\n')
        low, high = [-3, 2, 1, 10, 10, 10], [3, 4, 4, 30, 30, 30]
        return "".join(element.format(*random.uniform(low, high)) for _ in range(3)), kind
    return sky(random, folder, kind), kind


def sensors(random, kind: str) -> str:
    """Four cameras and two between them: around the shape, or in front of what has a back."""
    first = random.uniform(-40, 40)
    angles = [first + 90 * i for i in (0, 1, 2, 3, 0.4, 2.4)]
    if kind in ("rectangle", "hill"):
        angles = [-50, -17, 17, 50, -20, 25]
    element = ('<sensor type="perspective"><float name="fov" value="38"/><transform name="to_world">'
               '<lookat origin="{:.4f}, {:.4f}, {:.4f}" target="0, 0.85, 0" up="0, 1, 0"/></transform>'
               '<film type="hdrfilm"><integer name="width" value="{}"/><integer name="height" value="{}"/></film>'
               '</sensor>\n')
    text = ""
    for angle in map(math.radians, angles):
        place = 4.2 * math.sin(angle), random.uniform(1.2, 3), 4.2 * math.cos(angle)
        text += element.format(*place, RESOLUTION, RESOLUTION)
    return text


FLOOR = ('<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="4"/></transform>'
         '<bsdf type="diffuse"><rgb name="reflectance" value="0.4, 0.38, 0.35"/></bsdf></shape>\n')


def make_scene(seed: int, folder: Path) -> tuple[list[str], str]:
    """Writes a scene and its capture; returns the unknown numbers, and words on the scene."""
    folder.mkdir(parents=True, exist_ok=True)
    random = np.random.default_rng(seed)
    bsdf, unknown, words = material(random, folder)
    object_shape, kind = shape(random, folder)
    emitters, light = lights(random, folder)
    floor = FLOOR if random.random() < 0.7 else ""
    integrator = random.choice(["direct", "path"], p=[0.6, 0.4])
    (folder / "scene.xml").write_text(
        f'<scene version="3.0.0">\n<integrator type="{integrator}"/>\n{sensors(random, kind)}{bsdf}{object_shape}'
        f"{floor}{emitters}</scene>\n")
    views = [{"name": f"view {i}", "camera": {"sensor": i}, "split": "train" if i < 4 else "test"} for i in range(6)]
    (folder / "capture.json").write_text(json.dumps({"version": 1, "scene": "scene.xml", "views": views}, indent=1))
    return unknown, f"{kind}, {light}, {integrator}; {words}"


# ---- Runs


def recover(burnish: Path, file: Path, unknown: list[str], start: str, seconds: float | None) -> dict[str, list[float]]:
    """Of each unknown its errors at the start and at the end."""
    out = file.parent / f"{file.stem}-{start}"
    rules = ["--time", seconds] if seconds else ["--iterations", "1", "--learning-rate", "1e-9"]
    call(burnish, "optimize", file, *(f"--parameter=material.brdf_0.{name}" for name in unknown), "--init", start, *rules,
         "--target-spp", 128, "--evaluation-spp", 16, "-o", out, "--force")
    errors = json.loads((out / "summary.json").read_text())["result"]["texture_rmse"]
    return {name.split(".")[-2]: [e["initial"], e["final"]] for name, e in sorted(errors.items())}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("count", type=int, help="how many seeds")
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--burnish", type=Path, default=Path("build/release/burnish"))
    parser.add_argument("--first", type=int, default=0, metavar="SEED")
    parser.add_argument("--time", type=float, metavar="SECONDS")
    parser.add_argument("--unknowns", type=int, default=1, metavar="N")
    arguments = parser.parse_args()
    rows, errors = [], {"search": [], "0.5": []}
    for seed in range(arguments.first, arguments.first + arguments.count):
        folder = arguments.output / str(seed)
        unknown, words = make_scene(seed, folder)
        if len(unknown) < arguments.unknowns:
            continue
        print(f"{seed}: {words}", flush=True)
        for file in ("scene.xml", "capture.json"):
            for start, of_start in errors.items():
                found = recover(arguments.burnish, folder / file, unknown, start, arguments.time)
                rows.append({"seed": seed, "file": file, "start": start, "errors": found})
                of_start += found.values()
                shown = [f"{name} {first:.3f}" + (f" -> {last:.3f}" if arguments.time else "")
                         for name, (first, last) in found.items()]
                print(f"    {file:12} from {start:6}  {', '.join(shown)}", flush=True)
    (arguments.output / "random_scenes.json").write_text(json.dumps(rows, indent=1) + "\n")
    for i, what in enumerate(["start", "end"][:2 if arguments.time else 1]):
        means = {start: statistics.fmean(e[i] for e in of_start) for start, of_start in errors.items()}
        worse = sum(a[i] > b[i] + 0.05 for a, b in zip(errors["search"], errors["0.5"]))
        print(f"texture error at the {what}: {means['search']:.3f} searched, {means['0.5']:.3f} from 0.5; more than 0.05 "
              f"worse than from 0.5: {worse} of {len(errors['search'])}")


if __name__ == "__main__":
    main()

"""Scene files in Mitsuba 3: with textures that can be replaced, with the camera and the sky of a view of a capture.

A view is one of capture.json, a dictionary. The Mitsuba variant is chosen by whoever imports this.
"""
import zlib
import xml.etree.ElementTree as ET
from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np

PASS_SPP = 16  # of one pass, stratified over the pixel; Mitsuba's memory grows with them
# Direct light, as the seven scenes ask for, with more light samples for each camera ray: half of the time for the
# same noise.
DIRECT = {"type": "direct", "emitter_samples": 4, "bsdf_samples": 2}
SKIES = ("envmap", "constant")
# Columns of camera_to_world that point the other way in Mitsuba (x left, y up, z forward).
FLIPPED = {"opencv": (0, 1), "opengl": (0, 2), "mitsuba": ()}


def matrix_text(rows) -> str:
    return " ".join(f"{v:.9g}" for row in rows for v in row)


def store_as_floats(root: ET.Element, parameter: str) -> None:
    """8-bit storage has no gradient and rounds what is put into it."""
    bsdf, name = parameter.split(".")[0], parameter.split(".")[-2]
    texture = root.find(f".//bsdf[@id='{bsdf}']").find(f".//texture[@name='{name}']")
    ET.SubElement(texture, "string", name="format", value="variant")


def replace_sky(root: ET.Element, folder: Path, sky: dict) -> None:
    """sky: `environment` of a view."""
    for emitter in [e for e in root.findall("emitter") if e.get("type") in SKIES]:
        root.remove(emitter)
    emitter = ET.SubElement(root, "emitter", type="envmap")
    ET.SubElement(emitter, "string", name="filename", value=str((folder / sky["file"]).resolve()))
    ET.SubElement(emitter, "float", name="scale", value=str(sky.get("scale", 1)))
    transform = ET.SubElement(emitter, "transform", name="to_world")
    ET.SubElement(transform, "matrix", value=matrix_text(sky.get("to_world", np.eye(4).tolist())))


def load(file: Path, parameters=(), defines=None, folder: Path | None = None, sky: dict | None = None):
    """A mi.Scene. folder: what the paths of `sky` are relative to."""
    root = ET.parse(file).getroot()
    for element in root.iterfind(".//*[@name='filename']"):
        element.set("value", str((Path(file).resolve().parent / element.get("value"))))
    for parameter in parameters:
        store_as_floats(root, parameter)
    if sky:
        replace_sky(root, folder, sky)
    return mi.load_string(ET.tostring(root, encoding="unicode"), **(defines or {}))


def perspective(to_world: np.ndarray, fov: float, width: int, height: int):
    """fov: of the width, degrees."""
    return mi.load_dict({"type": "perspective", "fov_axis": "x", "fov": fov, "to_world": mi.ScalarTransform4f(to_world),
                         "sampler": {"type": "multijitter", "sample_count": PASS_SPP},
                         "film": {"type": "hdrfilm", "width": width, "height": height, "pixel_format": "rgb",
                                  "component_format": "float32"}})


def own_camera(scene, number: int = 0) -> tuple[np.ndarray, float]:
    """to_world [4, 4] and field of view of a sensor of the scene file."""
    sensor = scene.sensors()[number]
    matrix = np.array(sensor.world_transform().matrix, dtype=float).reshape(4, 4)
    return matrix, float(mi.traverse(sensor)["x_fov"][0])


def sensor_of(scene, view: dict):
    """That of the scene file, or a pinhole camera whose principal point is the middle of its picture."""
    camera = view["camera"]
    if "sensor" in camera:
        size = scene.sensors()[camera["sensor"]].film().size()
        return perspective(*own_camera(scene, camera["sensor"]), int(size[0]), int(size[1]))
    width, height = camera["width"], camera["height"]
    focal, *other, cx, cy = camera["params"]
    known = camera["model"] in ("PINHOLE", "SIMPLE_PINHOLE") and other in ([], [focal])
    if not known or (cx, cy) != (width / 2, height / 2):
        raise ValueError(f"view {view['name']}: expected a pinhole camera with square pixels around its middle")
    to_world = np.array(camera["camera_to_world"], dtype=float)
    to_world[:3, FLIPPED[camera.get("convention", "opencv")]] *= -1
    return perspective(to_world, np.rad2deg(2 * np.arctan(width / 2 / focal)), width, height)


def render(scene, view: dict, passes: range, spp: int = PASS_SPP) -> list[np.ndarray]:
    """Independent pictures, [height, width, 3] each. A pass of a view has the same random numbers in every scene, so
    that pictures of scenes that differ little have nearly the same noise."""
    integrator, sensor = mi.load_dict(DIRECT), sensor_of(scene, view)
    first = zlib.crc32(view["name"].encode()) % 1000000 * 1000
    images = (mi.render(scene, sensor=sensor, integrator=integrator, spp=spp, seed=first + i) for i in passes)
    return [np.array(image, dtype=np.float64)[..., :3] for image in images]


def rel_mse(image, target):
    """The relMSE of Burnish, differentiable."""
    return dr.mean(dr.square(image - target) / (dr.square(target) + 0.01), axis=None)


def shapes_of(scene, parameters) -> list:
    """Those whose BSDF has one of the textures: the object."""
    bsdfs = {p.split(".")[0] for p in parameters}
    return [s for s in scene.shapes() if s.bsdf().id() in bsdfs]


def object_mask(scene, sensor, parameters) -> np.ndarray:
    """[height, width]: whether the ray through the centre of the pixel meets the object first."""
    width, height = (int(v) for v in sensor.film().size())
    index = dr.arange(mi.UInt32, width * height)
    centre = mi.Point2f((index % width + 0.5) / width, (index // width + 0.5) / height)
    ray, _ = sensor.sample_ray(0, 0.5, centre, 0.5)
    shape = scene.ray_intersect_preliminary(ray).shape
    hit = mi.Bool(False)
    for s in shapes_of(scene, parameters):
        hit |= shape == mi.ShapePtr(s)
    return np.broadcast_to(np.array(hit), width * height).reshape(height, width)


def seen_texels(scene, sensors, parameter: str, spp: int) -> np.ndarray:
    """[height, width]: whether a texel moves one of the pictures; sampled, direct light."""
    integrator = mi.load_dict({"type": "prb", "max_depth": 2})
    params = mi.traverse(scene)
    params.keep([parameter])
    seen = np.zeros(params[parameter].shape[:2], dtype=bool)
    for k, sensor in enumerate(sensors):
        dr.enable_grad(params[parameter])
        params.update()
        dr.backward(dr.sum(mi.render(scene, params, sensor=sensor, integrator=integrator, spp=spp, seed=k), axis=None))
        seen |= (np.array(dr.grad(params[parameter])).reshape(*seen.shape, -1) != 0).any(axis=2)
        dr.disable_grad(params[parameter])
    return seen


def read_image(path: Path | str) -> np.ndarray:
    """[height, width, channels]"""
    values = np.array(mi.Bitmap(str(path)).convert(component_format=mi.Struct.Type.Float32, srgb_gamma=False))
    return values[..., None] if values.ndim == 2 else values


def write_image(path: Path | str, values: np.ndarray) -> None:
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    mi.Bitmap(values.astype(np.float32)).write(str(path))

"""Captures and the cameras of other programs."""
import json
import struct
import subprocess
import zlib

import numpy as np
import pytest

import burnish

from conftest import NAME

TO_WORLD = [[1, 0, 0, 0], [0, 0, 1, -6], [0, -1, 0, 1], [0, 0, 0, 1]]


@pytest.fixture
def folder(target, tmp_path):
    """A capture of two views, by the scene's sensor and by a camera."""
    scene = tmp_path / "goblet" / "scene.xml"
    burnish.write_scene("goblet", scene.parent, texture_size=32)
    renderer = burnish.load(scene).with_camera(burnish.Camera(24, 20, 30, camera_to_world=TO_WORLD))
    burnish.write_image(tmp_path / "front.exr", target)
    burnish.write_image(tmp_path / "side.exr", renderer.render(spp=16))
    mask = np.ones((32, 32), np.float32)
    mask[:8] = 0
    burnish.write_image(tmp_path / "mask.exr", mask)
    camera = {"model": "PINHOLE", "width": 24, "height": 20, "params": [30, 30, 12, 10], "camera_to_world": TO_WORLD}
    (tmp_path / "capture.json").write_text(json.dumps({
        "version": 1, "scene": "goblet/scene.xml", "defines": {"spp": 4},
        "views": [{"name": "front", "image": "front.exr", "mask": "mask.exr", "camera": {"sensor": 0}, "exposure": "fit"},
                  {"name": "side", "image": "side.exr", "camera": camera, "split": "test"}]}))
    return tmp_path


def test_a_capture_is_what_its_file_says(folder, target):
    capture = burnish.read_capture(folder / "capture.json")
    assert capture.scene == str(folder / "goblet" / "scene.xml") and capture.definitions == {"spp": "4"}
    front, side = capture.views
    np.testing.assert_array_equal(front.image, target)
    assert front.mask[:8].max() == 0 and front.mask[8:].min() == 1 and side.mask is None
    assert (front.name, front.exposure, front.held_out) == ("front", "fit", False)
    assert front.camera == burnish.Sensor("0", 32, 32)
    assert (side.name, side.exposure, side.held_out) == ("side", (1, 1, 1), True)
    assert side.camera == burnish.Camera(24, 20, 30, camera_to_world=TO_WORLD)
    small = burnish.read_capture(folder / "capture.json", scale=0.5).views
    assert small[0].image.shape == (16, 16, 3) and small[1].camera == side.camera.scaled(0.5)


def test_what_would_be_lost_cannot_be_written(folder, target):
    capture = burnish.read_capture(folder / "capture.json")
    with pytest.raises(TypeError, match="does not support item assignment"):
        capture.definitions["spp"] = "8"
    lens, lighting, view = burnish.Lens("fisheye", [0.1, 0.2]), burnish.Lighting(["lamp"]), burnish.View(target, exposure=[1, 2, 3])
    assert (lens.coefficients, lighting.emitters, view.exposure) == ((0.1, 0.2, 0, 0), ("lamp",), (1, 2, 3))
    for values in (capture.views, lens.coefficients, lighting.emitters, view.exposure):
        with pytest.raises(AttributeError, match="append"):
            values.append(1)
    assert burnish.Lens("fisheye", lens.coefficients) == lens and burnish.Lighting(lighting.emitters) == lighting
    assert burnish.View(target, exposure=view.exposure).exposure == view.exposure
    assert burnish.Lens().coefficients == () and len(burnish.Lens("brown_conrady").coefficients) == 8


def test_the_same_bytes_as_the_program(folder, program):
    subprocess.run([program, "optimize", folder / "capture.json", "--parameter", NAME, "--init", "0.5", "--iterations", "4",
                    "--evaluation-spp", "4", "-o", folder / "out"], check=True, capture_output=True)
    [file] = (folder / "out" / "textures").glob("*roughness*data.exr")
    capture = burnish.read_capture(folder / "capture.json")
    renderer = burnish.load(capture.scene, definitions=capture.definitions)
    problem = burnish.Problem(renderer, capture.views, burnish.Unknown(NAME, start=0.5))
    summary = burnish.solve(problem, iterations=4, evaluation_spp=4)
    np.testing.assert_array_equal(summary.textures[NAME], burnish.read_image(file))


def test_views_of_transforms(folder):
    opengl = np.array(TO_WORLD) * [1, -1, -1, 1]
    (folder / "transforms.json").write_text(json.dumps({
        "fl_x": 30, "fl_y": 30, "cx": 12, "cy": 10, "w": 24, "h": 20,
        "frames": [{"file_path": "side.exr", "transform_matrix": opengl.tolist()}]}))
    [view] = burnish.read_views(folder / "transforms.json", exposure="fit")
    assert view.exposure == "fit"
    np.testing.assert_array_equal(view.image, burnish.read_image(folder / "side.exr"))
    np.testing.assert_array_equal(view.camera.camera_to_world, TO_WORLD)


BOARD = """<scene version="3.0.0">
    <integrator type="direct"/>
    <sensor type="perspective"><film type="hdrfilm"/></sensor>
    <emitter type="constant"/>
    <shape type="rectangle"><bsdf type="diffuse" id="board"><texture type="bitmap" name="reflectance">
        <string name="filename" value="color.exr"/><boolean name="raw" value="true"/></texture></bsdf></shape>
</scene>"""
TOWARDS = [[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 5], [0, 0, 0, 1]]


@pytest.fixture
def board(tmp_path):
    """A board before a sky, and two pictures of it with a sky of their own."""
    burnish.write_image(tmp_path / "color.exr", np.full((4, 4, 3), 0.5, np.float32))
    (tmp_path / "scene.xml").write_text(BOARD)
    opengl = np.array(TOWARDS) * [1, -1, -1, 1]
    frames = []
    for name, sky in (("a.exr", 7), ("b.exr", 3)):
        picture = np.full((20, 24, 3), 0.3, np.float32)
        picture[0] = sky
        burnish.write_image(tmp_path / name, picture)
        frames.append({"file_path": name, "transform_matrix": opengl.tolist()})
    (tmp_path / "transforms.json").write_text(json.dumps(
        {"fl_x": 36, "fl_y": 36, "cx": 12, "cy": 10, "w": 24, "h": 20, "frames": frames}))
    return tmp_path


def test_backgrounds_and_held_out_views_are_those_of_the_program(board, program):
    subprocess.run([program, "optimize", board / "scene.xml", "--views", board / "transforms.json", "--ignore-background", "--hold-out",
                    "b.exr", "--parameter", "reflectance", "--init", "0.5", "--iterations", "4", "--evaluation-spp", "4", "-o",
                    board / "out"], check=True, capture_output=True)
    [file] = (board / "out" / "textures").glob("*.reflectance.data.exr")
    renderer = burnish.load(board / "scene.xml")
    views = burnish.read_views(board / "transforms.json", held_out=["b.exr"])

    def textures(views):
        problem = burnish.Problem(renderer, views, burnish.Unknown("reflectance", start=0.5))
        return burnish.solve(problem, iterations=4, evaluation_spp=4).textures["reflectance"]

    own = textures([burnish.mask_background(renderer, view) for view in views])
    np.testing.assert_array_equal(own, burnish.read_image(file))
    assert (textures(views) != own).any()


def test_the_background_is_left_out(board):
    renderer = burnish.load(board / "scene.xml")
    [_, view] = burnish.read_views(board / "transforms.json", exposure=2, held_out=iter(["b.exr"]))
    masked = burnish.mask_background(renderer, view)
    assert view.mask is None and masked.mask.shape == (20, 24, 1) and set(masked.mask.flat) == {0, 1}
    shows_board = renderer.with_camera(view.camera).render(spp=64).max(-1, keepdims=True) < 0.6  # of the sky 1
    assert shows_board[masked.mask == 1].all() and 0.15 < masked.mask.mean() < shows_board.mean() < 0.5
    np.testing.assert_array_equal(masked.image, view.image)
    assert [getattr(masked, n) for n in ("name", "camera", "exposure", "held_out")] == ["b.exr", view.camera, (2, 2, 2), True]
    own = np.linspace(0, 1, 20 * 24 * 3, dtype=np.float32).reshape(20, 24, 3)
    both = burnish.mask_background(renderer, burnish.View(view.image, own, camera=view.camera))
    np.testing.assert_array_equal(both.mask, own * masked.mask)

    away = burnish.Camera(24, 20, 36, camera_to_world=np.array(TOWARDS) * [1, -1, -1, 1])
    for wrong, message in [(burnish.View(view.image[:4], camera=view.camera), "the target image has 24 x 4 pixels"),
                           (burnish.View(view.image, own[:4], camera=view.camera), "the mask has 24 x 4 pixels"),
                           (burnish.View(view.image, name="back", camera=away), "back: no pixel shows a surface of the scene"),
                           (burnish.View(view.image, 1 - masked.mask, camera=view.camera), "no pixel counts: each that shows a")]:
        with pytest.raises(burnish.InputError, match=f"^{message}"):
            burnish.mask_background(renderer, wrong)


def test_views_are_held_out_by_name(board, folder):
    assert [v.held_out for v in burnish.read_views(board / "transforms.json", held_out="a.exr")] == [True, False]
    assert [v.held_out for v in burnish.read_capture(folder / "capture.json", held_out=("front",)).views] == [True, True]
    with pytest.raises(burnish.InputError, match='^held_out: no view is named "c.exr": expected one of a.exr, b.exr$'):
        burnish.read_views(board / "transforms.json", held_out=["c.exr"])
    for wrong in (3, [3], None):
        with pytest.raises(TypeError, match="^held_out: expected names of views, found "):
            burnish.read_capture(folder / "capture.json", held_out=wrong)


def gray_png(bits, code):
    """32 x 32 pixels, all of one code."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    row = bytes(1) + bytes([sum(code << shift for shift in range(0, 8, bits))] * (4 * bits))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 32, 32, bits, 0, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(32 * row)) + chunk(b"IEND", b""))


@pytest.mark.parametrize("bits", [1, 2, 4, 8])
def test_masks_of_codes_0_and_1(folder, bits):
    capture = folder / "capture.json"
    capture.write_text(capture.read_text().replace("mask.exr", "mask.png"))
    (folder / "mask.png").write_bytes(gray_png(bits, 1))
    if bits == 1:  # white
        assert burnish.read_capture(capture).views[0].mask.min() == 1
        return
    white = 2**bits - 1
    with pytest.raises(burnish.InputError, match=f"holds no code above 1, .* expected weights from 0 to 1, whose code is {white}"):
        burnish.read_capture(capture)
    (folder / "mask.png").write_bytes(gray_png(bits, 2))
    np.testing.assert_allclose(burnish.read_capture(capture).views[0].mask, 2 / white, rtol=1e-6)


def test_messages(folder):
    with pytest.raises(burnish.InputError, match="scale: found 2"):
        burnish.read_capture(folder / "capture.json", scale=2)
    with pytest.raises(burnish.InputError, match="expected cameras.bin and images.bin, or cameras.txt and images.txt"):
        burnish.read_views(folder)
    for name in ("cameras.txt", "images.txt"):
        (folder / name).write_text("")
    with pytest.raises(burnish.InputError, match="images: expected the folder"):
        burnish.read_views(folder)
    text = (folder / "capture.json").read_text()
    (folder / "capture.json").write_text(text.replace('"image": "side.exr", ', ""))
    with pytest.raises(burnish.InputError, match=r"capture.json: views\[1\]: the view side has no image"):
        burnish.read_capture(folder / "capture.json")
    burnish.write_image(folder / "small.exr", np.ones((20, 24, 1), np.float32))
    (folder / "capture.json").write_text(text.replace("mask.exr", "small.exr"))
    with pytest.raises(burnish.InputError, match=r"capture.json: views\[0\].mask: the mask .* is 24 x 20 pixels, expected the size of the picture, 32 x 32"):
        burnish.read_capture(folder / "capture.json")
    (folder / "capture.json").write_text(text)
    burnish.write_image(folder / "side.exr", np.ones((20, 25, 3), np.float32))
    with pytest.raises(burnish.InputError, match=r"views\[1\].image: .*side.exr.* is 25 x 20 pixels, expected the size of its camera, 24 x 20"):
        burnish.read_capture(folder / "capture.json")

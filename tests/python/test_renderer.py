"""Scenes, pictures, textures."""
import collections.abc
import json
import shutil
import struct
import time
import types

import numpy as np
import pytest

import burnish
from burnish._checks import full_shape

from conftest import NAME


def test_parameters_are_a_mapping_of_names_to_arrays(renderer):
    parameters = renderer.parameters
    assert len(parameters) == len(list(parameters)) == len(parameters.keys()) > 0
    full = next(n for n in parameters if "roughness" in n and "mat-goblet" in n)
    assert NAME in parameters and full in parameters and "nothing" not in parameters and 3 not in parameters
    texture = parameters[NAME]
    assert texture.dtype == np.float32 and texture.shape == (32, 32, 1) == parameters.shapes[full]
    np.testing.assert_array_equal(texture, dict(parameters.items())[full])
    with pytest.raises(KeyError, match="nothing"):
        parameters["nothing"]
    assert isinstance(parameters, collections.abc.Mapping) and len(parameters.values()) == len(parameters)
    assert parameters.keys() & {full, "nothing"} == {full} and list(parameters.keys()) == list(parameters) == [n for n, _ in parameters.items()]
    assert [t.shape for t in parameters.values()] == list(parameters.shapes.values())
    np.testing.assert_array_equal(parameters.get(NAME), texture)
    assert parameters.get("nothing") is None and parameters.get("nothing", 3) == 3
    for no_text in (None, 3, ("a",)):
        assert no_text not in parameters and parameters.get(no_text) is None and parameters.get(no_text, 3) == 3
        with pytest.raises(KeyError, match="expected the name of a texture"):
            parameters[no_text]
    assert full in repr(burnish.show(parameters))
    assert full in repr(parameters)


def test_pictures_are_those_of_the_textures(renderer):
    picture = renderer.render(spp=4)
    assert picture.shape == (32, 32, 3) == (renderer.height, renderer.width, 3) and picture.dtype == np.float32
    assert np.isfinite(picture).all() and picture.max() > 0
    np.testing.assert_array_equal(picture, renderer.render(spp=4))
    np.testing.assert_array_equal(picture, renderer.render({NAME: renderer.parameters[NAME]}, spp=4))
    assert (picture != renderer.render(spp=4, seed=1)).any()
    rough = renderer.render({NAME: 0.9}, spp=4)
    np.testing.assert_array_equal(rough, renderer.render({NAME: np.full((32, 32), 0.9)}, spp=4))
    assert (picture != rough).any()
    picture[:] = 0  # it is the caller's


def test_pictures_of_too_much_light_are_refused(tmp_path):
    (tmp_path / "scene.xml").write_text("""<scene version="3.0.0"><integrator type="direct"/>
        <sensor type="perspective"><float name="fov" value="40"/>
            <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="16"/></film>
            <transform name="to_world"><lookat origin="0, 0, 3" target="0, 0, 0" up="0, 1, 0"/></transform></sensor>
        <shape type="rectangle"><bsdf type="diffuse" id="floor"/></shape>
        <emitter type="point"><point name="position" value="0, 0, 0.3"/><rgb name="intensity" value="1e38"/></emitter></scene>""")
    renderer = burnish.load(tmp_path / "scene.xml", constants=["floor.reflectance"])
    with pytest.raises(burnish.InputError, match=r"\d+ of 4096 samples were not finite, expected at most one in 1000"):
        renderer.render(spp=16)


def test_two_names_of_one_texture_are_refused(renderer):
    full = next(n for n in renderer.parameters if "roughness" in n and "mat-goblet" in n)
    assert full != NAME
    with pytest.raises(burnish.InputError, match="are one texture"):
        renderer.render({NAME: 0.1, full: 0.9}, spp=1)


def read_glb(file):
    """The document and the data of a binary glTF file of two chunks."""
    data = file.read_bytes()
    magic, version, size, length, kind = struct.unpack_from("<4sIII4s", data)
    assert (magic, version, size, kind) == (b"glTF", 2, len(data), b"JSON")
    return json.loads(data[20:20 + length]), data[28 + length:]


def test_models_hold_the_textures(renderer, tmp_path):
    def roughness(**textures):
        burnish.write_model(tmp_path / "model.glb", renderer, {NAME: v for v in textures.values()} or None)
        model, data = read_glb(tmp_path / "model.glb")
        material = next(m for m in model["materials"] if "metallicRoughnessTexture" in m["pbrMetallicRoughness"])
        index = material["pbrMetallicRoughness"]["metallicRoughnessTexture"]["index"]
        view = model["bufferViews"][model["images"][model["textures"][index]["source"]]["bufferView"]]
        picture = tmp_path / "roughness.png"
        picture.write_bytes(data[view["byteOffset"]:view["byteOffset"] + view["byteLength"]])
        return burnish.read_photograph(picture, "linear")[0][:, :, 1]

    own = renderer.parameters[NAME][:, :, 0]
    np.testing.assert_allclose(roughness(), own, atol=0.5 / 255 + 1e-6)
    np.testing.assert_allclose(roughness(other=1 - own[:, :, None]), 1 - own, atol=0.5 / 255 + 1e-6)
    with pytest.raises(burnish.InputError, match="expected 32 x 32"):
        burnish.write_model(tmp_path / "other.glb", renderer, {NAME: np.zeros((2, 2))})
    with pytest.raises(burnish.Error, match="nowhere"):
        burnish.write_model(tmp_path / "nowhere" / "model.glb", renderer)
    assert not (tmp_path / "other.glb").exists()


def test_definitions_and_size(scene, renderer):
    defined = burnish.load(str(scene), resx=24, resy=16)
    assert (defined.width, defined.height) == (24, 16)
    assert burnish.load(scene, definitions={"resx": "24", "resy": 16}).width == 24
    assert burnish.load(scene, definitions=types.MappingProxyType({"resx": 24})).width == 24
    with pytest.raises(TypeError, match="definitions: expected a mapping"):
        burnish.load(scene, definitions=3)
    for size in [(0, 1), (1, 0), (32769, 1), (1, 40000)]:
        with pytest.raises(burnish.InputError, match="size: found .* expected a width and a height from 1 to 32768"):
            burnish.load(scene, size=size)
    assert burnish.load(scene, size=(40, 40), light_selection="tree").width == 40


def test_what_is_not_supported_can_be_left_out(scene, tmp_path):
    folder = shutil.copytree(scene.parent, tmp_path / "scene")
    text = scene.read_text().replace("</scene>", '<emitter type="sunsky"/></scene>')
    (folder / "scene.xml").write_text(text)
    with pytest.raises(burnish.InputError, match='emitter "sunsky"'):
        burnish.load(folder / "scene.xml", size=(16, 16))
    renderer = burnish.load(folder / "scene.xml", size=(16, 16), ignore_unsupported=True)
    assert any('emitter "sunsky" is' in w and ": left out, " in w for w in renderer.warnings), renderer.warnings
    with pytest.raises(TypeError):
        burnish.load(scene, ignore_unsupported=2)


def test_constants_become_parameters(scene):
    constant = burnish.load(scene, size=(16, 16), constants=["mat-goblet.metallic:4x2"])
    assert constant.parameters["mat-goblet.metallic"].shape == (2, 4, 1)


def test_shapes_that_a_gradient_fits(renderer):
    color = "mat-goblet.base_color"
    for name in (NAME, "mat-goblet.brdf_0.roughness.data"):
        for shape in ((), (32, 32), (32, 32, 1)):
            assert full_shape(renderer, name, shape) == (32, 32, 1)
        for shape in ((1,), (32, 32, 3), (32, 31), (32, 32, 1, 1)):
            with pytest.raises(burnish.InputError, match=r"roughness.*: found the shape \(.*, expected a number, \(32, 32\)"):
                full_shape(renderer, name, shape)
    for shape in ((), (32, 32), (32, 32, 1), (32, 32, 3)):
        assert full_shape(renderer, color, shape) == (32, 32, 3)
    with pytest.raises(burnish.InputError, match="no parameter is called 'nothing'"):
        full_shape(renderer, "nothing", (2, 2))


def test_shapes_have_the_height_first(scene):
    constant = burnish.load(scene, size=(16, 16), constants=["mat-goblet.metallic:4x2"])
    for name in ("mat-goblet.metallic", "mat-goblet.brdf_0.metallic.data"):
        for shape in ((), (2, 4), (2, 4, 1)):
            assert full_shape(constant, name, shape) == (2, 4, 1)
        for shape in ((4, 2), (4, 2, 1)):
            with pytest.raises(burnish.InputError, match=r"expected a number, \(2, 4\), \(2, 4, 1\)$"):
                full_shape(constant, name, shape)


def test_the_shape_of_a_name_costs_no_texels(scene):
    large = burnish.load(scene, size=(16, 16), constants=["mat-goblet.metallic:2048"])

    def seconds(work, count):
        begin = time.process_time()
        for _ in range(count):
            work()
        return time.process_time() - begin

    read = min(seconds(lambda: large.parameters["mat-goblet.metallic"], 1) for _ in range(3))
    assert "mat-goblet.metallic" in large.parameters and large.parameters.shape("mat-goblet.metallic") == (2048, 2048, 1)
    assert seconds(lambda: "mat-goblet.metallic" in large.parameters, 40) < 10 * read
    assert seconds(lambda: full_shape(large, "mat-goblet.metallic", ()), 40) < 10 * read
    with pytest.raises(burnish.InputError, match="no parameter is called 'nothing'"):
        large.parameters.shape("nothing")


def test_cameras_and_lights(renderer):
    camera = burnish.Camera(20, 10, focal_x=30, camera_to_world=np.eye(4), lens=burnish.Lens("brown_conrady", [0.1]))
    assert camera.focal_y == 30 and camera.center_x == 10 and camera.center_y == 5
    assert camera == burnish.Camera(20, 10, 30, camera_to_world=np.eye(4).tolist(), lens=camera.lens)
    assert camera.scaled(0.5).width == 10
    with pytest.raises(ValueError, match="read-only"):
        camera.camera_to_world[0, 3] = 5
    kept = camera.lens
    camera.lens = burnish.Lens("fisheye", [0.2])
    assert kept == burnish.Lens("brown_conrady", [0.1]) and camera.lens.kind == "fisheye"
    assert renderer.with_camera(camera).render(spp=1).shape == (10, 20, 3)
    assert renderer.with_camera(burnish.Sensor("0", 16, 16)).width == 16
    assert burnish.Sensor(0, 16, 16) == burnish.Sensor("0", 16, 16)
    with pytest.raises(burnish.InputError, match="the picture has 16 x 0 pixels: expected 1 to"):
        renderer.with_camera(burnish.Sensor(0, width=16))
    dark = renderer.with_lighting(burnish.Lighting(emitters=[]))
    assert dark.render(spp=1).max() == 0
    sky = burnish.Environment(np.ones((2, 4, 3)), scale=2)
    with pytest.raises(ValueError, match="read-only"):
        sky.image[...] = 0
    assert renderer.with_lighting(burnish.Lighting(emitters=[], environment=sky)).render(spp=1).max() > 0


def test_files(tmp_path, renderer):
    picture = renderer.render(spp=1)
    burnish.write_image(tmp_path / "picture.exr", picture)
    np.testing.assert_array_equal(burnish.read_image(tmp_path / "picture.exr"), picture)
    image, weights = burnish.read_photograph(tmp_path / "picture.exr", scale=0.5)
    assert image.shape == (16, 16, 3) and weights is None
    mask = np.ones((32, 32), bool)
    mask[:16] = False
    image, weights = burnish.read_photograph(tmp_path / "picture.exr", mask=mask)
    np.testing.assert_array_equal(weights[..., 0], mask)
    for scale in (1, 0.5):
        with pytest.raises(burnish.InputError, match="the mask holds -0.9"):
            burnish.read_photograph(tmp_path / "picture.exr", mask=np.where(mask, 1, -0.9), scale=scale)

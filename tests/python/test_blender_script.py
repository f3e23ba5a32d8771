"""import_into_blender.py, run with a stand-in for Blender's module: which nodes it makes and links."""
import collections
import os
import runpy
import subprocess
import sys
import types

import burnish
import numpy as np
import pytest

SCENE = """<scene version="3.0.0"><integrator type="direct"/>
<sensor type="perspective"><transform name="to_world"><lookat origin="0,0,4" target="0,0,0" up="0,1,0"/></transform>
  <film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="8"/></film></sensor>
<emitter type="constant"/>
<shape type="rectangle"><bsdf type="roughconductor" id="gold\U0001f642"><string name="material" value="Au"/>{color}
  </bsdf></shape>
<shape type="rectangle"><bsdf type="principled" id="constant">{base}<float name="anisotropic" value="0.9"/></bsdf></shape>
<shape type="rectangle"><bsdf type="principled" id="texture">{base}
  <texture type="bitmap" name="anisotropic"><string name="filename" value="number.exr"/></texture></bsdf></shape>
<shape type="rectangle"><bsdf type="principled" id="{none}">{base}</bsdf></shape></scene>"""
NONE = "none" + 76 * "\u00e9"


def cut(name, size=63):
    """As Blender 4 does: to so many bytes of UTF-8."""
    return name.encode()[:size].decode(errors="ignore")


class Node:
    def __init__(self, kind):
        self.kind = kind
        self.inputs = collections.defaultdict(lambda: types.SimpleNamespace(link=None))
        self.outputs = self  # each output is the node

    def __getitem__(self, _):
        return self


class Materials(dict):
    def new(self, name):
        tree = types.SimpleNamespace(nodes=[], links=types.SimpleNamespace())

        class Nodes(list):
            def new(self, kind):
                self.append(Node(kind))
                return self[-1]

        tree.nodes = Nodes()
        tree.links.new = lambda output, socket: setattr(socket, "link", output)
        name = cut(name)
        if name in self:
            name = cut(name, 59) + ".001"
        self[name] = types.SimpleNamespace(node_tree=tree)
        return self[name]


class Images(list):
    def load(self, file, check_existing=False):
        for image in self:
            if check_existing and image.filepath == file:
                return image
        self.append(types.SimpleNamespace(filepath=file, colorspace_settings=types.SimpleNamespace(name="sRGB")))
        return self[-1]


def absolute(path):
    """As Blender 4 gives it of a path that saving has made relative to the .blend's folder."""
    return os.path.join(os.path.dirname(path), "blend", "..", os.path.basename(path))


def materials_of(script, monkeypatch, runs=1):
    """What the script makes: of each material the inputs of its Principled BSDF."""
    bpy = types.SimpleNamespace(data=types.SimpleNamespace(materials=Materials(), images=Images()),
                                path=types.SimpleNamespace(abspath=absolute),
                                context=types.SimpleNamespace(space_data=None, selected_objects=[]))
    monkeypatch.setitem(sys.modules, "bpy", bpy)
    for _ in range(runs):
        runpy.run_path(str(script))
    return {name: next(n for n in m.node_tree.nodes if n.kind == "ShaderNodeBsdfPrincipled").inputs
            for name, m in bpy.data.materials.items()}


@pytest.fixture
def script(program, tmp_path):
    burnish.write_image(tmp_path / "color.exr", np.full((2, 2, 3), 0.5))
    burnish.write_image(tmp_path / "number.exr", np.full((2, 2, 1), 0.5))
    texture = '<texture type="bitmap" name="{}"><string name="filename" value="color.exr"/></texture>'
    (tmp_path / "scene.xml").write_text(SCENE.format(color=texture.format("specular_reflectance"), none=NONE,
                                                     base=texture.format("base_color")), encoding="utf-8")
    names = ["gold\U0001f642.specular_reflectance", "constant.base_color", "texture.base_color", f"{NONE}.base_color"]
    subprocess.run([program, "optimize", "scene.xml", *(f"--parameter={name}" for name in names), "--init", "0.4",
                    "--iterations", "1", "--target-spp", "1", "--evaluation-spp", "1", "-o", "out"], cwd=tmp_path, check=True)
    return tmp_path / "out/import_into_blender.py"


@pytest.fixture
def materials(script, monkeypatch):
    return materials_of(script, monkeypatch)


@pytest.fixture
def shared_script(program, tmp_path):
    """Of a material whose colour and roughness are one file, whose metal is a PFM, and of which a number was recovered."""
    burnish.write_image(tmp_path / "both.png", np.full((2, 2, 1), 0.5))
    burnish.write_image(tmp_path / "metal.pfm", np.full((2, 2, 1), 0.5))
    texture = """<texture type="bitmap" name="{}"><string name="filename" value="{}"/>
      <boolean name="raw" value="{}"/></texture>"""
    textures = [("base_color", "both.png", "false"), ("roughness", "both.png", "true"), ("metallic", "metal.pfm", "true")]
    base = "".join(texture.format(*t) for t in textures)
    (tmp_path / "scene.xml").write_text(SCENE.format(color="", base=base, none="none"), encoding="utf-8")
    burnish.write_image(tmp_path / "number.exr", np.full((2, 2, 1), 0.5))
    subprocess.run([program, "optimize", "scene.xml", "--parameter=constant.anisotropic", "--init", "0.4", "--iterations", "1",
                    "--target-spp", "1", "--evaluation-spp", "1", "-o", "out"], cwd=tmp_path, check=True)
    return tmp_path / "out/import_into_blender.py"


def test_a_file_has_an_image_for_each_colour_space(shared_script, monkeypatch):
    inputs = materials_of(shared_script, monkeypatch, runs=2)["constant"]
    color, roughness = (inputs[name].link.image for name in ("Base Color", "Roughness"))
    assert color.filepath == roughness.filepath == str(shared_script.parent / "scene/both.png")
    assert [i.colorspace_settings.name for i in (color, roughness)] == ["sRGB", "Non-Color"]
    assert [i.filepath for i in sys.modules["bpy"].data.images].count(color.filepath) == 2, "a second run finds them"


def test_a_pfm_is_left_out(shared_script, monkeypatch):
    inputs = materials_of(shared_script, monkeypatch)["constant"]
    assert inputs["Metallic"].link is None and not any(i.filepath.endswith(".pfm") for i in sys.modules["bpy"].data.images)


def test_a_tangent_where_there_is_anisotropy(materials):
    tangents = {name: inputs["Tangent"].link for name, inputs in materials.items()}
    assert {name for name, tangent in tangents.items() if tangent} == {"constant", "texture"}
    for name in ("constant", "texture"):
        assert tangents[name].kind == "ShaderNodeTangent"
        assert tangents[name].direction_type == "UV_MAP"


def test_a_metal_has_its_colour(materials):
    metal = materials["gold\U0001f642"]["Base Color"].link
    assert (metal.kind, metal.operation) == ("ShaderNodeVectorMath", "MULTIPLY")
    np.testing.assert_allclose(metal.inputs[1].default_value, [0.967, 0.802, 0.324], atol=1e-3)
    assert metal.inputs[0].link.kind == "ShaderNodeTexImage"
    assert materials[cut(NONE)]["Base Color"].link.kind == "ShaderNodeTexImage"


def test_a_second_run_finds_the_material_whose_name_is_cut(script, monkeypatch):
    twice = materials_of(script, monkeypatch, runs=2)
    assert set(twice) == {"gold\U0001f642", "constant", "texture", cut(NONE)}
    assert all(inputs["Base Color"].link for inputs in twice.values())


def test_names_that_are_cut_alike_have_a_material_each(script, monkeypatch):
    script.write_text(script.read_text(encoding="utf-8").replace('"constant"', f'"{NONE}2"'), encoding="utf-8")
    materials = materials_of(script, monkeypatch)
    assert set(materials) == {"gold\U0001f642", "texture", cut(NONE), cut(NONE, 59) + ".001"}
    assert [name for name, inputs in materials.items() if inputs["Tangent"].link] == [cut(NONE), "texture"]

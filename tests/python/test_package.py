"""Stubs, documentation and the README's lines."""
import pathlib
import re
import subprocess
import sys

import pytest

import burnish

ROOT = pathlib.Path(__file__).resolve().parents[2]
PACKAGE = pathlib.Path(burnish.__file__).parent


def test_docstrings_have_the_table_of_options():
    for name, sentence, _, default in burnish.options():
        for text in (burnish.solve.__doc__, burnish.Solver.__doc__):
            assert f"    {name}: {sentence}" in text and default in text
    assert len(burnish.options()) > 25
    assert {o[0]: o[3] for o in burnish.options()}["spp"] == "4 or 32"


def test_a_source_distribution_has_the_files_of_the_repository_alone():
    """`sdist.include` goes before .gitignore: with a name in it what was built goes along."""
    project = (ROOT / "pyproject.toml").read_text()
    assert "[tool.scikit-build]" in project and "sdist.include" not in project


def test_options_need_what_the_page_of_the_command_line_says():
    help_of = dict(re.findall(r"^    (\w+): (.*)$", burnish.solve.__doc__, re.MULTILINE))
    page = (ROOT / "docs" / "reference" / "options.md").read_text()
    known = 0
    for entry in re.findall(r"^- (\*\*`.*?)(?=\n- |\n\n|\Z)", page, re.DOTALL | re.MULTILINE):
        text = " ".join(entry.split())
        keyword = re.match(r"\*\*`([\w.]+)`", text)[1].replace(".", "_")
        if keyword not in help_of or keyword == "loss":  # others go by their flag; there no problem has a loss of its own
            continue
        known += 1
        assert re.findall(r" Needs (.*)\.$", text) == re.findall(r" Needs (.*)\.$", help_of[keyword]), keyword
    assert known > 15 and "Needs a problem without a loss of its own." in help_of["loss"]


def test_everything_is_exported_and_documented():
    for name in burnish.__all__:
        assert getattr(burnish, name) is not None
        if name != "version":
            assert getattr(burnish, name).__doc__, name


def test_the_reference_page_is_up_to_date():
    subprocess.run([sys.executable, ROOT / "scripts" / "python_docs.py", PACKAGE / "_core.pyi", "--check"], check=True)


def test_the_lines_of_the_readme_recover_a_texture(tmp_path):
    [code] = re.findall(r"```python\n(import burnish\n.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    assert len(code.strip().split("\n")) <= 10
    code = code.replace("256", "64")
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    before, after = map(float, done.stdout.split("->"))
    assert after < 0.5 * before and burnish.read_image(tmp_path / "roughness.exr").shape == (64, 64, 1)


def test_the_install_by_pip_goes_on_where_a_compiler_warns():
    tomllib = pytest.importorskip("tomllib", reason="Python is older than 3.11")
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    assert project["tool"]["scikit-build"]["cmake"]["define"]["BURNISH_WERROR"] == "OFF"
    # The first that takes a licence as a string.
    minimum = project["tool"]["scikit-build"]["minimum-version"]
    assert tuple(map(int, minimum.split("."))) >= (0, 11)
    assert f"scikit-build-core>={minimum}" in project["build-system"]["requires"]


def check_types(*files):
    pytest.importorskip("mypy", reason="mypy is not installed")
    done = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--cache-dir", "/dev/null", *files], capture_output=True, text=True,
                          env={"PATH": ""} | ({} if PACKAGE.parent.name == "site-packages" else {"MYPYPATH": str(PACKAGE.parent)}))
    assert done.returncode == 0, done.stdout + done.stderr


def test_examples_are_typed():
    skipped = [] if __import__("importlib.util").util.find_spec("torch") else ["perceptual_loss.py", "neural_texture.py"]
    check_types(*(f for f in (ROOT / "examples" / "python").glob("*.py") if f.name not in skipped))


def test_types_allow_what_the_module_takes(tmp_path):
    file = tmp_path / "typed.py"
    file.write_text("""
from collections.abc import Mapping
import numpy as np
import numpy.typing as npt
import burnish
renderer = burnish.load("scene.xml")
image = renderer.render(renderer.parameters)
renderer.gradient(image, None, renderer.parameters)
burnish.write_model("scene.glb", renderer, renderer.parameters)
burnish.View(image, exposure=np.ones(3))
burnish.View(image, exposure="fit")
capture = burnish.read_capture("capture.json")
burnish.load(capture.scene, definitions=capture.definitions)
burnish.Problem(renderer, capture.views, "mat.roughness")
burnish.Problem(renderer, [burnish.mask_background(renderer, v) for v in capture.views], "mat.roughness")
burnish.read_views("transforms.json", held_out="side.exr" if capture.views else {"front.exr"})
view = capture.views[0]
burnish.View(image, lighting=None, exposure=view.exposure)
burnish.Lens("fisheye", burnish.Lens("fisheye").coefficients)
burnish.Lens("fisheye", np.array([0.1, 0.2]))
textures: Mapping[str, npt.NDArray[np.float32]] = renderer.parameters
print(textures.keys() & {"mat.roughness"}, [t.shape for t in textures.values()], dict(textures.items()), textures.get("mat.roughness"))
burnish.Lighting(view.lighting.emitters)
unknown = burnish.Unknown("mat.roughness")
burnish.Unknown(unknown.name, unknown.start, unknown.learning_rate)
environment = burnish.Environment(np.ones((2, 4, 3)))
if environment.image is not None:
    print(environment.image.shape)
""")
    check_types(file)

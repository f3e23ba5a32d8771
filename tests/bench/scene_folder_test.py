"""The scene of a folder of captures is taken again only where it was made of the same."""
import shutil
import sys
import tempfile
import unittest
from pathlib import Path
from types import SimpleNamespace
from unittest import mock

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "bench"))
import scene_folder

# Stands for `burnish scene NAME -o DIR --texture-size N`.
PROGRAM = """#!/bin/sh
mkdir -p "$4" && echo "$6" >"$4/scene.xml"
"""


class SceneFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        self.program = self.root / "burnish"
        self.program.write_text(PROGRAM)
        self.program.chmod(0o755)
        (self.root / "scenes" / "tire").mkdir(parents=True)
        (self.root / "scenes" / "tire" / "scene.xml").write_text("<scene/>")

    def write(self, name, **changes):
        arguments = {"scenes": self.root / "scenes", "texture_size": 64, "burnish": self.program} | changes
        return scene_folder.write_scene(name, self.root / "out" / name, SimpleNamespace(**arguments))

    def test_what_was_made_of_the_same_is_taken(self):
        for name in ("goblet", "tire"):
            file = self.write(name)
            file.write_text("taken")
            self.assertEqual(self.write(name).read_text(), "taken")

    def test_another_texture_size_is_refused(self):
        self.write("goblet")
        with self.assertRaisesRegex(SystemExit, "goblet holds a scene of --texture-size 64: expected another folder"):
            self.write("goblet", texture_size=128)

    def test_other_files_are_refused_and_the_same_elsewhere_are_taken(self):
        self.write("tire")
        (self.root / "elsewhere" / "tire").mkdir(parents=True)
        elsewhere = self.root / "elsewhere" / "tire" / "scene.xml"
        elsewhere.write_text("<scene/>")
        self.write("tire", scenes=self.root / "elsewhere")
        elsewhere.write_text("<scene version=\"3\"/>")
        with self.assertRaisesRegex(SystemExit, "tire holds a copy of other files: expected another folder"):
            self.write("tire", scenes=self.root / "elsewhere")

    def test_a_copy_that_was_interrupted_is_made_again(self):
        (self.root / "scenes" / "tire" / "texture.exr").write_text("texels")
        copy = shutil.copyfile

        def copy_scene_alone(source, target, **options):
            if Path(source).name != "scene.xml":
                raise KeyboardInterrupt
            return copy(source, target, **options)

        for _ in range(2):
            with mock.patch.object(shutil, "copyfile", copy_scene_alone), self.assertRaises(KeyboardInterrupt):
                self.write("tire")
        folder = self.write("tire").parent
        self.assertEqual(sorted(f.name for f in folder.iterdir()), ["scene.xml", "texture.exr"])
        self.assertEqual(sorted(f.name for f in folder.parent.iterdir()), ["scene", "scene.json"])


if __name__ == "__main__":
    unittest.main()

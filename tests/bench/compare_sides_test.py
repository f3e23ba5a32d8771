"""The scene and the target that bench/compare_sides.py takes again."""
import sys
import tempfile
import unittest
from pathlib import Path
from types import SimpleNamespace
from unittest import mock

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "bench"))
import compare_sides


class Prepare(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        self.settings = {"size": (32, 32), "texture_size": 64, "target_spp": 16}
        self.published = self.root / "scenes" / "tire" / "scene.xml"
        self.published.parent.mkdir(parents=True)
        self.published.write_text("<scene/>")

    def write(self, program, command, *arguments):
        """Stands for the program, which writes what it was asked for."""
        words = [str(a) for a in arguments]
        file = Path(words[words.index("-o") + 1]) / ("scene.xml" if command == "scene" else "")
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(" ".join(words[:1] + words[words.index("-o") + 2:]))
        self.made.append(command)
        return ""

    def prepare(self, name="goblet", runs=1, **changes):
        """The commands that made something."""
        settings = self.settings | changes
        arguments = SimpleNamespace(scenes=self.root / "scenes", size=settings["size"], runs=runs)
        comparison = compare_sides.Comparison(name, arguments, self.root / "out", "python")
        comparison.texture_size, comparison.target_spp = settings["texture_size"], settings["target_spp"]
        comparison.definitions = changes.get("definitions", comparison.definitions)
        self.made = []
        with mock.patch("compare_sides.call", self.write):
            comparison.prepare()
        return self.made

    def test_what_was_made_of_the_same_is_taken(self):
        self.assertEqual(self.prepare(), ["scene", "render"])
        self.assertEqual(self.prepare(), [])

    def test_another_texture_is_made_and_its_target(self):
        self.prepare()
        self.assertEqual(self.prepare(texture_size=128), ["scene", "render"])
        self.assertIn("--texture-size 128", (self.root / "out" / "goblet" / "scene" / "scene.xml").read_text())

    def test_a_target_of_other_samples_size_or_definitions_is_made_again(self):
        self.prepare()
        for change in ({"target_spp": 32}, {"size": (64, 32)}, {"definitions": {"integrator": "direct"}}):
            self.assertEqual(self.prepare(**change), ["render"], change)
            self.assertEqual(self.prepare(**change), [], change)

    def test_a_target_of_other_files_is_made_again(self):
        self.assertEqual(self.prepare("tire"), ["render"])
        self.assertEqual(self.prepare("tire"), [])
        self.published.write_text("<scene version='3'/>")
        self.assertEqual(self.prepare("tire"), ["render"])

    def test_what_was_stopped_is_made_again(self):
        self.prepare()
        with mock.patch.object(self, "write", side_effect=KeyboardInterrupt), self.assertRaises(KeyboardInterrupt):
            self.prepare(target_spp=32)
        self.assertEqual(self.prepare(), ["render"])
        record = self.root / "out" / "goblet" / "target.json"
        record.write_text(record.read_text()[:9])
        self.assertEqual(self.prepare(), ["render"])

    def test_without_runs_there_is_no_target(self):
        self.assertEqual(self.prepare(runs=None), ["scene"])


if __name__ == "__main__":
    unittest.main()

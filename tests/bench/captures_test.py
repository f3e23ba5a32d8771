"""Pictures of bench/captures.py, with numbers in place of Mitsuba: a run that is killed changes nothing."""
import importlib
import json
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "bench"))
import mitsuba_python

VIEWS = [{"name": name, "image": f"images/{name}.exr", "camera": {"sensor": 0}} for name in ("left", "right")]


class Killed(BaseException):
    pass


class Renderer:
    """Pass k is the picture k. Dies at the call `dies_at` that writes or moves a file, before it or within it."""

    def __init__(self):
        self.calls, self.dies_at, self.rendered = 0, None, []

    def render(self, scene, view, passes):
        self.rendered += passes
        return [float(k) for k in passes]

    def step(self):
        self.calls += 1
        if self.calls == self.dies_at:
            raise Killed

    def write_image(self, path, picture):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("torn")
        self.step()
        path.write_text(str(picture))

    def read_image(self, path):
        return float(path.read_text())


class Pictures(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root, self.renderer = Path(folder.name), Renderer()
        numbers = mock.MagicMock(mean=lambda pictures, axis: sum(pictures) / len(pictures))
        scene = mock.MagicMock(render=self.renderer.render, write_image=self.renderer.write_image,
                               read_image=self.renderer.read_image)
        modules = {"drjit": mock.MagicMock(), "mitsuba": mock.MagicMock(), "numpy": numbers, "mitsuba_scene": scene}
        replace, write_text = Path.replace, Path.write_text

        def stepped_replace(path, target):
            self.renderer.step()
            return replace(path, target)

        def stepped_write(path, text):
            if path.suffix not in (".json", ".unfinished"):
                return write_text(path, text)
            write_text(path, text[:9])
            self.renderer.step()
            return write_text(path, text)

        for patch in (mock.patch.dict("sys.modules", modules), mock.patch("builtins.print"),
                      mock.patch.object(mitsuba_python, "go_on_with_mitsuba"),
                      mock.patch.object(Path, "replace", stepped_replace),
                      mock.patch.object(Path, "write_text", stepped_write)):
            patch.start()
            self.addCleanup(patch.stop)
        sys.modules.pop("captures", None)
        self.captures = importlib.import_module("captures")

    def run_to(self, passes, views=VIEWS, folder="out"):
        folder = self.root / folder
        folder.mkdir(exist_ok=True)
        made = {"defines": {}, "views": {}}
        if (folder / "made.json").exists():
            made = json.loads((folder / "made.json").read_text())
        self.captures.render_views(folder, views, made, passes)
        return [float((folder / v["image"]).read_text()) for v in views]

    def test_passes_are_added_to_pictures_that_are_there(self):
        self.assertEqual(self.run_to(2), [0.5, 0.5])
        self.assertEqual(self.run_to(4), [1.5, 1.5])
        self.assertEqual(self.renderer.rendered, [0, 1, 0, 1, 2, 3, 2, 3])
        self.assertEqual(self.run_to(4), [1.5, 1.5])
        self.assertEqual(len(self.renderer.rendered), 8)

    def test_a_run_that_is_killed_anywhere_goes_on_to_the_same(self):
        self.run_to(2, folder="whole")
        before = self.renderer.calls
        self.run_to(4, folder="whole")
        steps = self.renderer.calls - before
        self.assertEqual(steps, 2 * 4 + 2)  # a picture, made.json, and a move of each; made.json at the end
        for step in range(1, steps + 1):
            folder = f"killed at {step}"
            self.run_to(2, folder=folder)
            self.renderer.calls, self.renderer.dies_at = 0, step
            with self.assertRaises(Killed):
                self.run_to(4, folder=folder)
            self.renderer.dies_at = None
            self.renderer.rendered = []
            self.assertEqual(self.run_to(4, folder=folder), [1.5, 1.5], folder)
            self.assertNotIn(0, self.renderer.rendered, f"{folder}: what was there is lost")

    def test_the_records_at_the_end_are_those_of_the_pictures(self):
        for passes in (2, 4):
            self.run_to(passes)
            records = json.loads((self.root / "out" / "made.json").read_text())["views"]
            self.assertEqual([r["passes"] for r in records.values()], [passes] * 2)
            self.assertFalse([r for r in records.values() if "before" in r])

    def test_a_picture_of_another_camera_is_made_again(self):
        self.run_to(2)
        turned = [VIEWS[0] | {"camera": {"sensor": 1}}, VIEWS[1]]
        self.renderer.rendered = []
        self.assertEqual(self.run_to(2, turned), [0.5, 0.5])
        self.assertEqual(self.renderer.rendered, [0, 1])

    def test_a_record_without_a_hash_is_taken(self):
        folder = self.root / "out"
        self.run_to(2)
        made = json.loads((folder / "made.json").read_text())
        made["views"] = {name: {k: r[k] for k in ("passes", "view")} for name, r in made["views"].items()}
        (folder / "made.json").write_text(json.dumps(made))
        self.renderer.rendered = []
        self.assertEqual(self.run_to(4), [1.5, 1.5])
        self.assertEqual(self.renderer.rendered, [2, 3, 2, 3])


if __name__ == "__main__":
    unittest.main()

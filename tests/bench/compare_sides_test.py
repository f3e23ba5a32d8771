"""The scene and the target that bench/compare_sides.py takes again, and what Mitsuba's derivatives are timed by."""
import importlib
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


class Derivatives(unittest.TestCase):
    """What is measured at equal time is what set the time, though another way to differentiate is faster."""

    def test_the_time_is_that_of_detached_derivatives(self):
        arguments = SimpleNamespace(scenes=None, size=(32, 32), runs=1, repeats=3, estimators=["pgris"])
        comparison = compare_sides.Comparison("goblet", arguments, Path("out"), "python")
        comparison.results_file = mock.MagicMock()
        seconds = {"image": 1, "derivative": iter([1, 1, 1]), "detached derivative": iter([4, 2, 3]), "iteration": 1}
        timed = []

        def ask(request, what=None, **_):
            if request != "time":
                return {}
            timed.append(what)
            return seconds[what] if isinstance(seconds[what], int) else next(seconds[what])

        mitsuba = SimpleNamespace(ask=ask, close=lambda: None)
        ours = {"texture": "t", "adjoint": "a", "variants": {"mc": {"seconds": [1]}}}
        with mock.patch.object(comparison, "start_mitsuba", return_value=mitsuba), \
                mock.patch("compare_sides.call", side_effect=lambda *_: timed.append("burnish") or "{}"), \
                mock.patch.object(comparison, "made", return_value="folder"), \
                mock.patch.object(comparison, "runs", return_value={}), \
                mock.patch.object(comparison, "beside", return_value=ours) as beside:
            comparison.measure()
        words = beside.call_args.args
        self.assertEqual(words[words.index("--seconds") + 1], 3)
        self.assertEqual(timed, [*seconds, "burnish"] * 3, "both alternate")

    def test_files_are_of_detached_derivatives(self):
        names = ("drjit", "mitsuba", "mitsuba_scene", "numpy")
        with mock.patch.dict("sys.modules", {name: mock.MagicMock() for name in names}):
            worker = importlib.import_module("mitsuba_worker").Worker.__new__(sys.modules["mitsuba_worker"].Worker)
            worker.best, worker.parameter, worker.params, worker.shape = "attached", "p", mock.MagicMock(), (1, 1, 1)
            with mock.patch.object(worker, "derivative") as derivative:
                worker.time("detached derivative")
                worker.derivatives("t", "a", 1, 2, "folder")
            del sys.modules["mitsuba_worker"]
        self.assertEqual({call.args[0] for call in derivative.call_args_list}, {"detached"})


if __name__ == "__main__":
    unittest.main()

"""The table of bench/benchmarks.py."""
import sys
import unittest
from pathlib import Path
from types import SimpleNamespace
from unittest import mock

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "bench"))
import benchmarks


def row(side, **changes):
    return {"scene": "goblet", "parameter": "p", "learning_rate": 0.01, "side": side, "split": [8, 4],
            "loss_start": 0.25, "loss_end": 0.0123456, "texture_error_start": 0.2, "texture_error_end": 0.05,
            "iterations": 120, "seconds": 20.1, "iteration_s": 0.1674, "peak_memory_gb": 0.5} | changes


RESULTS = {"commit": "0123456789ab", "machine": "2 cores", "date": "2026-01-02", "command": "bench/benchmarks.py -o x",
           "seconds": 20, "size": [350, 350], "target_spp": 512, "evaluation_spp": 64,
           "rows": [row("path-cache pyramid", split=None), row("mitsuba")]}


class Table(unittest.TestCase):
    def test_says_what_the_numbers_are_of(self):
        text = benchmarks.markdown(RESULTS)
        for part in ("0123456789ab", "2 cores", "2026-01-02", "350 x 350", "20 s", "bench/benchmarks.py -o x"):
            self.assertIn(part, text)

    def test_has_a_row_for_each_run(self):
        lines = [line for line in benchmarks.markdown(RESULTS).splitlines() if line.startswith("|")]
        self.assertEqual([line.count("|") for line in lines], [len(benchmarks.HEAD) + 1] * 4)
        self.assertEqual(lines[2], "| goblet | path cache | 0.25 | 0.01235 | 0.200 | 0.050 | 120 | 0.167 | 0.50 |")
        self.assertIn("| Mitsuba, 8+4 |", lines[3])

    def test_knows_the_learning_rate_of_every_scene(self):
        self.assertEqual(set(benchmarks.ORDER), set(benchmarks.SCENES))


class Scenes(unittest.TestCase):
    def test_published_scenes_run_where_their_folder_is_named(self):
        everything = SimpleNamespace(scenes=None)
        with mock.patch.dict("os.environ", {benchmarks.PAPER: "folder"}):
            self.assertEqual(len(benchmarks.wanted_scenes(everything)), 7)
            self.assertEqual(benchmarks.wanted_scenes(SimpleNamespace(scenes=["tire"])), ["tire"])
        with mock.patch.dict("os.environ"):
            benchmarks.os.environ.pop(benchmarks.PAPER, None)
            self.assertEqual(benchmarks.wanted_scenes(everything), ["goblet", "tyre", "bowl", "tree"])
            with self.assertRaises(SystemExit):
                benchmarks.wanted_scenes(SimpleNamespace(scenes=["tire"]))


if __name__ == "__main__":
    unittest.main()

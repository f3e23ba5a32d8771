"""Random scenes: a seed is always the same files, and the program reads and recovers them.

    random_scenes_test.py BURNISH
"""
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "bench"))
import random_scenes

BURNISH = Path(sys.argv.pop(1)).resolve()
SEEDS = range(12)


class RandomScenes(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)

    def make(self, seed, name):
        """The files' bytes, and words on the scene."""
        _, words = random_scenes.make_scene(seed, self.root / name)
        return {file.name: file.read_bytes() for file in (self.root / name).iterdir()}, words

    def test_a_seed_is_a_scene(self):
        self.assertEqual(self.make(5, "once"), self.make(5, "again"))
        self.assertNotEqual(self.make(5, "once"), self.make(6, "another"))

    def test_the_program_reads_all_kinds(self):
        kinds = set()
        for seed in SEEDS:
            _, words = self.make(seed, str(seed))
            kinds.update(words.split("; ")[0].split(", "))
            read = subprocess.run([BURNISH, "info", self.root / str(seed) / "capture.json"], capture_output=True, text=True)
            self.assertEqual(read.returncode, 0, read.stderr)
            self.assertNotIn("warning", read.stderr, words)
        self.assertGreater(len(kinds), 8, kinds)

    def test_errors_are_told(self):
        random_scenes.RESOLUTION, before = 16, random_scenes.RESOLUTION
        self.addCleanup(setattr, random_scenes, "RESOLUTION", before)
        unknown, _ = random_scenes.make_scene(2, self.root / "small")
        errors = random_scenes.recover(BURNISH, self.root / "small" / "capture.json", unknown, "0.5", None)
        self.assertEqual(sorted(errors), sorted(unknown))
        for first, last in errors.values():
            self.assertGreater(first, 0)
            self.assertAlmostEqual(first, last, delta=1e-3)
        self.assertTrue(json.loads((self.root / "small" / "capture-0.5" / "summary.json").read_text()))


if __name__ == "__main__":
    unittest.main()

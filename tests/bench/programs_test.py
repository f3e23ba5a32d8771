"""Each program of bench that no other test runs, once and small: it ends, and prints lines of JSON with numbers.

    programs_test.py BUILD
"""
import json
import math
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

BUILD = Path(sys.argv.pop(1)).resolve()
SIZE = ("--size", "16", "16")


def numbers_in(value):
    if value is None:  # so is NaN written
        return [math.nan]
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list):
        return [n for v in value for n in numbers_in(v)]
    return [value] if isinstance(value, (int, float)) else []


class Programs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        subprocess.run([BUILD / "burnish", "scene", "goblet", "-o", folder.name, "--texture-size", "16"], check=True,
                       capture_output=True)
        cls.scene = Path(folder.name) / "scene.xml"

    def lines_of(self, program, *arguments):
        done = subprocess.run([BUILD / "bench" / program, self.scene, "mat-goblet.brdf_0.roughness.data", *arguments],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        lines = [json.loads(line) for line in done.stdout.splitlines()]
        for line in lines:
            self.assertTrue(numbers_in(line), line)
            self.assertTrue(all(map(math.isfinite, numbers_in(line))), line)
        return lines

    def test_stages(self):
        line, = self.lines_of("burnish_stages", *SIZE, "--spp", "2", "--repeats", "1", "--variants", "mc", "path-cache")
        self.assertEqual(set(line["iteration_s"]), {"mc", "path-cache"})

    def test_path_cache(self):
        self.assertEqual(len(self.lines_of("burnish_path_cache", *SIZE, "--window", "2", "--repeats", "1")), 1)

    def test_path_cache_variance(self):
        lines = self.lines_of("burnish_path_cache_variance", *SIZE, "--runs", "2", "--starts", "0", "1", "--windows",
                              "2")
        self.assertEqual([line["first_pass"] for line in lines], [0, 1])

    def test_old_records(self):
        lines = self.lines_of("burnish_old_records", *SIZE, "--runs", "2", "--passes", "2", "--shifts", "0.1")
        self.assertEqual(len(lines), 2)

    def test_start_search(self):
        lines = self.lines_of("burnish_start_search", *SIZE, "--runs", "2", "--seed", "7", "--target-spp", "4")
        self.assertEqual([line["seed"] for line in lines], [7, 8])
        self.assertNotEqual(lines[0]["error"], lines[1]["error"])

    def test_closed_loop_bias(self):
        lines = self.lines_of("burnish_closed_loop_bias", "--size", "16", "--runs", "2", "--iterations", "2", "--init",
                              "0.5")
        self.assertEqual(len(lines), 1)


if __name__ == "__main__":
    unittest.main()

"""The arithmetic of bench/held_out.py: answers that are known."""
import math
import random
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "bench"))
import held_out


def psnr(picture, truth):
    """Without noise."""
    return held_out.psnr([picture, picture], [truth, truth])


class Psnr(unittest.TestCase):
    # White is 100, the 99th percentile; 1 % of the pixels lie above it.
    truth = [0.0] * 100 + [100.0] * 99 + [1000.0, 100.0]

    def test_encoding_is_srgb(self):
        for linear, encoded in ((0, 0), (0.002, 0.02584), (0.214041, 0.5), (1, 1), (-1, 0), (7, 1)):
            self.assertAlmostEqual(held_out.srgb(linear), encoded, places=5)

    def test_the_same_picture_has_100_db(self):
        self.assertEqual(psnr(self.truth, self.truth), 100)

    def test_a_tenth_of_white_in_half_of_the_values_has_23_db(self):
        half, more = 0.214041140, 0.318546778  # sRGB 0.5 and 0.6
        self.assertAlmostEqual(psnr([more] * 50 + [1] * 50, [half] * 50 + [1] * 50), 20 + 10 * math.log10(2), places=4)

    def test_the_99th_percentile_of_the_truth_is_white(self):
        self.assertAlmostEqual(psnr([0.0] * 201, self.truth), -10 * math.log10(101 / 201), places=9)
        scaled = [[3 * v for v in values] for values in ([50.0] * 201, self.truth)]
        self.assertAlmostEqual(psnr(*scaled), psnr([50.0] * 201, self.truth), places=9)

    def test_what_is_brighter_than_white_counts_as_white(self):
        picture = [0.0] * 100 + [5000.0] * 101
        picture[0] = 100
        self.assertAlmostEqual(psnr(picture, self.truth), 10 * math.log10(201), places=9)

    def test_noise_of_the_halves_does_not_count(self):
        generator, grey = random.Random(1), 0.214041140
        noisy = [[grey + generator.gauss(0, 0.02) for _ in range(20000)] + [1.0] * 1000 for _ in range(4)]
        self.assertGreater(held_out.psnr(noisy[:2], noisy[2:]), 45)
        self.assertLess(psnr(noisy[0], noisy[2]), 32)


class TextureError(unittest.TestCase):
    def test_is_the_root_of_the_mean_square(self):
        self.assertAlmostEqual(held_out.texture_error([0.1, 0.5, 0.9], [0.1, 0.8, 0.5]), math.sqrt(0.25 / 3))


class Table(unittest.TestCase):
    def test_kinds_of_views(self):
        views = [{"name": "a"}, {"name": "b", "split": "train", "environment": {}}, {"name": "c", "split": "test"},
                 {"name": "d", "split": "test", "environment": {}}]
        self.assertEqual([held_out.group_of(v) for v in views], ["fitted", "fitted", "places", "skies"])

    def test_rows_have_means_and_smallest(self):
        groups = (("fitted", 30.26), ("places", 19.5), ("places", 20.5), ("skies", 27.04))
        judged = {"textures": "out", "texture_error": {"p": 0.4551},
                  "views": [{"name": "v", "group": g, "psnr": p} for g, p in groups]}
        text = held_out.markdown({"capture": "c.json", "parameters": ["p"], "judged": [judged]})
        lines = text.splitlines()
        self.assertEqual(lines[-1], "| out | 30.3 | 20.0 (19.5) | 27.0 | 0.455 |")
        self.assertEqual({line.count("|") for line in lines[2:]}, {6})


if __name__ == "__main__":
    unittest.main()

"""The sizes of the levels of bench/views_in_mitsuba.py."""
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "bench"))
from views_in_mitsuba import LEVELS, level_sizes


class Levels(unittest.TestCase):
    def test_halve_sides_that_are_multiples_of_16(self):
        self.assertEqual(level_sizes(64, 32), [(64, 32), (32, 16), (16, 8), (8, 4), (4, 2)])

    def test_hold_every_texel_and_no_more(self):
        for height, width in ((1, 1), (15, 17), (16, 16), (100, 75), (129, 2047)):
            sizes = level_sizes(height, width)
            self.assertEqual(len(sizes), LEVELS)
            for k, (rows, columns) in enumerate(sizes):
                self.assertEqual(((height - 1) >> k, (width - 1) >> k), (rows - 1, columns - 1), (height, width, k))


if __name__ == "__main__":
    unittest.main()

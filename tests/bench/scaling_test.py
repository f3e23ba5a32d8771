#!/usr/bin/env python3
"""bench/scaling.py: its model where the answer is known, and the views of a batch as the program shares them out."""
import random
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent.parent / "bench"))
import scaling  # noqa: E402


def measured(sent=0.0):
    alone = {"processes": 1, "iteration": 0.81, "slowest": 0.8, "step": 0.01, "sent_bytes": 0, "peak_bytes": 1}
    return {"views": 8, "pixels": 100, "floats": 1000, "cores": 2,
            "runs": [alone, dict(alone, processes=2, sent_bytes=sent)]}


class ModelTest(unittest.TestCase):
    def test_takes_its_numbers_from_the_runs(self):
        # Of 1000 floats of two, half dirty, each sends what the other reads, and the texels that it has stepped.
        sent = 8 * 500 * scaling.read_share(2, 1000 ** 0.5) + 4 * 4 / 3 * 500
        model = scaling.Model(measured(sent), latency=1, bandwidth=100)
        self.assertAlmostEqual(model.visit, 0.1)
        self.assertAlmostEqual(model.dirty, 0.5)

    def test_one_process_sends_nothing(self):
        self.assertEqual(scaling.Model(measured(), 1, 100).messages(1, 1000, 1, 30), 0)

    def test_bytes_of_a_process_hardly_grow_with_their_number(self):
        model = scaling.Model(measured(), latency=0, bandwidth=1)
        high = 1e12  # rows: the margin is nothing
        moved = 4 * 4 / 3
        self.assertAlmostEqual(model.messages(2, 1000, 1, high), (8 + moved) * 500, delta=0.01)
        self.assertAlmostEqual(model.messages(1000, 1000, 1, high), (8 + moved) * 999, delta=0.1)
        self.assertAlmostEqual(model.messages(2, 1000, 0.25, high), (2 + moved) * 500, delta=0.01)

    def test_parts_read_rows_around_them(self):
        self.assertAlmostEqual(scaling.read_share(4, 512), 0.25 + 32 / 512)
        self.assertEqual(scaling.read_share(2, 16), 1)

    def test_steps_are_shared_out(self):
        self.assertEqual(scaling.step_share(1), 1)
        self.assertLess(scaling.step_share(64), 0.06)


class BatchTest(unittest.TestCase):
    def test_batches_that_divide_the_views_are_even(self):
        draw = random.Random(1)
        for views, batch, nodes in ((1000, 1000, 10), (1000, 200, 8), (16, 4, 4), (64, 64, 64)):
            for _ in range(20):
                self.assertEqual(scaling.slowest_share(views, batch, nodes, draw), batch // nodes)

    def test_others_are_not(self):
        draw = random.Random(1)
        shares = [scaling.slowest_share(1000, 64, 64, draw) for _ in range(20)]
        self.assertGreater(min(shares), 1)
        self.assertEqual(scaling.slowest_share(7, 7, 3, draw), 3)


class DrawingTest(unittest.TestCase):
    def test_is_a_picture_of_every_curve(self):
        curves = {8: [(1, 1.0, 0.0, 0.1), (2, 0.5, 0.1, 0.1)], 4: [(1, 0.5, 0.0, 0.1), (4, 0.2, 0.1, 0.1)]}
        drawing = scaling.drawing_of(curves)
        self.assertTrue(drawing.startswith("<svg") and drawing.rstrip().endswith("</svg>"))
        self.assertIn("batch 8", drawing)
        self.assertIn("batch 4", drawing)


if __name__ == "__main__":
    unittest.main()

"""What bench/compare_mitsuba.py tries, and the numbers that it derives from measurements: curves, equal time, equal loss,
ratios."""
import math
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "bench"))
import compare_report as report
import compare_sides as sides


def run(*moments):
    return {"moments": [{"seconds": s, "loss": l, "iterations": k + 1} for k, (s, l) in enumerate(moments)]}


class Splits(unittest.TestCase):
    def test_mitsuba_takes_the_best_of_four_and_the_path_cache_has_one(self):
        self.assertEqual(sides.splits_of("mitsuba"), ((32, 1), (8, 4), (4, 4), (2, 2)))
        self.assertEqual(len(sides.splits_of("path-cache texels")), 1)


class Curves(unittest.TestCase):
    curve = report.curve_of(run((1, 0.8), (3, 0.4), (5, 0.5)), 1.0)

    def test_loss_between_moments_is_in_proportion(self):
        for seconds, loss in ((0.5, 0.9), (1, 0.8), (2, 0.6), (4, 0.45)):
            self.assertAlmostEqual(report.loss_at(self.curve, seconds), loss)

    def test_after_the_last_moment_the_loss_stays(self):
        self.assertEqual(report.loss_at(self.curve, 9), 0.5)

    def test_a_loss_is_reached_when_it_first_is(self):
        self.assertAlmostEqual(report.seconds_to(self.curve, 0.5), 2.5)
        self.assertAlmostEqual(report.seconds_to(self.curve, 0.4), 3)

    def test_what_lies_before_the_first_moment_counts_as_reached_there(self):
        self.assertEqual(report.seconds_to(self.curve, 0.9), 1)

    def test_a_loss_below_all_is_never_reached(self):
        self.assertEqual(report.seconds_to(self.curve, 0.39), math.inf)

    def test_compilation_delays_the_curve(self):
        late = report.curve_of(run((1, 0.8), (3, 0.4)), 1.0, before=2)
        self.assertEqual(report.loss_at(late, 1.5), 1.0)
        self.assertAlmostEqual(report.loss_at(late, 3), 0.8)
        self.assertAlmostEqual(report.seconds_to(late, 0.6), 4)
        self.assertEqual(report.seconds_to(late, 0.9), 3)


class Derivatives(unittest.TestCase):
    def test_an_error_that_noise_hides_has_no_ratio(self):
        comparison = sides.Comparison.__new__(sides.Comparison)
        comparison.beside = lambda *_: {"nmse": [2.0, None, 8.0, 4.0], "reference_nmse": 0.1}
        ours, theirs = ({"files": ["a", "b"], "seconds": [1, 1], "spp": 1} for _ in range(2))
        derivatives = {"texture": "t", "adjoint": "a", "variants": {"mc": ours | {"mitsuba": theirs}}}
        comparison.evaluate_derivatives(derivatives)
        self.assertEqual(derivatives["reference_nmse"], 0.1)
        self.assertEqual(next(report.derivative_rows(derivatives)).ratio(), "4 [4, 4] in 1 of 2")


class Rows(unittest.TestCase):
    def test_the_ratio_is_theirs_over_ours_per_repeat(self):
        self.assertEqual(report.Row("", [2, 9, 8], [1, 3, 2]).ratio(), "3 [2, 4]")

    def test_there_is_no_ratio_of_what_was_not_reached(self):
        self.assertEqual(report.Row("", [math.inf], [1]).ratio(), "-")
        row = report.Row("", [2, math.inf, 4], [1, 1, 1], ".0f")
        self.assertEqual((row.ratio(), row.medians()), ("3 [2, 4] in 2 of 3", ["3", "1"]))

    def test_there_is_no_ratio_of_losses_that_noise_hides(self):
        for theirs, ours in ((-2, 1), (2, -1), (-2, -1), (0, 1), (math.nan, 1)):
            self.assertEqual(report.Row("", [theirs], [ours]).ratio(), "-")
        row = report.Row("", [-2, 4], [1, 1], ".0f")
        self.assertEqual((row.ratio(), row.medians()), ("4 [4, 4] in 1 of 2", ["4", "1"]))

    def test_equal_loss_is_what_both_reach(self):
        theirs = [run((2, 0.5), (4, 0.4)) | {"compile_s": 1.0}]
        ours = [run((2, 0.2), (4, 0.1))]
        loss, seconds = report.pair_rows("", theirs, ours, 1.0, 4, jit=False)
        self.assertEqual((loss.theirs, loss.ours), ((0.4,), (0.1,)))
        self.assertEqual(seconds.theirs, (4,))
        self.assertEqual(seconds.ours[0], 2)
        late = [run((9, 0.5)) | {"compile_s": 0.0}]
        self.assertEqual(list(report.pair_rows("", late, ours, 1.0, 4, jit=False))[1].theirs, (4,))
        loss, seconds = report.pair_rows("", theirs, ours, 1.0, 4, jit=True)
        self.assertAlmostEqual(loss.theirs[0], 0.45)
        self.assertEqual(seconds.ours[0], 2)

    def test_without_progress_there_is_no_equal_loss(self):
        theirs, ours = [run((4, 0.999)) | {"compile_s": 0.0}], [run((4, 0.1))]
        loss, seconds = report.pair_rows("", theirs, ours, 1.0, 4, jit=False)
        self.assertEqual(seconds.ratio(), "-")
        self.assertAlmostEqual(loss.theirs[0], 0.999)
        self.assertAlmostEqual(loss.ours[0], 0.1)


if __name__ == "__main__":
    unittest.main()

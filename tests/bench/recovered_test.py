"""The table of bench/recovered.py, and what it takes from a run that was stopped."""
import json
import sys
import tempfile
import unittest
from pathlib import Path
from types import SimpleNamespace
from unittest import mock

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "bench"))
import recovered

ROW = {"scene": "tire", "parameters": ["mat-tire.brdf_0.roughness.data"], "iterations": 900, "seconds": 120.1,
       "seconds_in_all": 139.6, "psnr_of_number": {"fitted": [17.04, 19.04], "places": [17.06]},
       "psnr": {"fitted": [36.04, 32.24], "places": [30.96]},
       "texture_errors_of_number": [0.4131], "texture_error_of_start": 0.0921, "texture_errors": [0.0919],
       "texture_error_resolved": None}


class Table(unittest.TestCase):
    def test_a_row_tells_the_number_and_what_was_recovered(self):
        self.assertEqual(recovered.error_cells(ROW), ["tire", "roughness", "0.413", "0.092", "0.092", "", "900", "140 s"])
        self.assertEqual(recovered.picture_cells(ROW), ["tire", "18.0 → 34.1 (32.2)", "17.1 → 31.0", ""])

    def test_several_unknowns_stand_in_one_row(self):
        several = ROW | {"parameters": ["mat.base_color.data", "mat.roughness.data"], "texture_errors": [0.25, 0.125]}
        cells = recovered.error_cells(several)
        self.assertEqual((cells[1], cells[4]), ("base_color, roughness", "0.250, 0.125"))

    def test_every_cell_has_a_head(self):
        self.assertEqual(len(recovered.error_cells(ROW)), len(recovered.ERRORS))
        self.assertEqual(len(recovered.picture_cells(ROW)), len(recovered.PICTURES))

    def test_every_picture_is_kept(self):
        views = [{"group": "fitted", "psnr": 30}, {"group": "fitted", "psnr": 40}, {"group": "skies", "psnr": 33}]
        self.assertEqual(recovered.decibels({"views": views}), {"fitted": [30, 40], "skies": [33]})


class Command(unittest.TestCase):
    def test_names_what_is_not_the_default(self):
        arguments = SimpleNamespace(views="capture", inputs=None, seconds=120, seed=0, scenes=None)
        self.assertEqual(recovered.command_of(arguments), "bench/recovered.py CAPTURES -o FOLDER")
        arguments = SimpleNamespace(views="front", inputs=["metallic"], seconds=60, seed=3, scenes=["tire", "bowl"])
        self.assertEqual(recovered.command_of(arguments),
                         "bench/recovered.py CAPTURES -o FOLDER --views front --inputs metallic --seconds 60 "
                         "--seed 3 --scenes tire bowl")


class Row(unittest.TestCase):
    def test_counts_the_seconds_from_the_start_of_the_run_to_its_results(self):
        judged = {"views": [], "texture_error": {"mat": 0.5}}
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "tire").mkdir()
            (Path(folder) / "tire" / "summary.json").write_text('{"result": {"iterations": 9, "seconds": 60}}')
            (Path(folder) / "made.json").write_text(json.dumps({"parameters": ROW["parameters"]}))
            arguments = SimpleNamespace(output=Path(folder), inputs=None, seconds=60, seed=0)
            with mock.patch("recovered.call"), mock.patch("recovered.judge", return_value=[judged] * 2), \
                    mock.patch("recovered.search_of", return_value={}), \
                    mock.patch("time.monotonic", side_effect=[1000, 1083]):
                row = recovered.row("tire", Path(folder) / "capture.json", arguments, Path("build"))
        self.assertEqual((row["seconds"], row["seconds_in_all"]), (60, 83))


class Unknowns(unittest.TestCase):
    def test_are_those_of_the_capture_or_others_of_its_material(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "made.json").write_text(json.dumps({"parameters": ROW["parameters"]}))
            capture = Path(folder) / "capture.json"
            self.assertEqual(recovered.parameters_of(capture, None), ROW["parameters"])
            self.assertEqual(recovered.parameters_of(capture, ["metallic", "base_color"]),
                             ["mat-tire.brdf_0.metallic.data", "mat-tire.brdf_0.base_color.data"])


class Start(unittest.TestCase):
    def test_is_searched_as_long_as_that_of_the_run(self):
        for seconds, effort in ((20, 1), (120, 2), (600, 4)):
            with mock.patch("recovered.call", return_value="{}") as call:
                recovered.search_of(Path("build"), Path("capture.json"), ROW["parameters"], seconds, 0)
            self.assertEqual(call.call_args.args[-2:], ("--effort", effort))

    def test_is_searched_with_the_seed_of_the_run(self):
        arguments = SimpleNamespace(output=Path("out"), inputs=None, seconds=60, seed=7)
        summary = '{"result": {"iterations": 9, "seconds": 60}}'
        judged = {"views": [], "texture_error": {"mat": 0.5}}
        with mock.patch("recovered.call", return_value="{}") as call, \
                mock.patch("recovered.judge", return_value=[judged] * 2), \
                mock.patch("recovered.parameters_of", return_value=["mat"]), \
                mock.patch("pathlib.Path.read_text", return_value=summary):
            recovered.row("tire", Path("capture.json"), arguments, Path("build"))
        for made in call.call_args_list:
            self.assertEqual(made.args[made.args.index("--seed") + 1], 7)
        self.assertEqual(len(call.call_args_list), 2)


class Stopped(unittest.TestCase):
    def test_rows_of_another_program_are_made_again(self):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            (folder / "captures" / "tire").mkdir(parents=True)
            (folder / "captures" / "tire" / "capture.json").touch()
            (folder / "bench").mkdir()
            command = ["recovered.py", str(folder / "captures"), "-o", str(folder / "out"), "--scenes", "tire",
                       "--build", str(folder)]
            with mock.patch("sys.argv", command), mock.patch("recovered.row", return_value=ROW) as row, \
                    mock.patch("recovered.commit", return_value="a"), mock.patch("builtins.print"):
                for program, search, rows in (("one", "one", 1), ("one", "one", 1), ("other", "one", 2),
                                              ("other", "other", 3)):
                    (folder / "burnish").write_text(program)
                    (folder / "bench" / "burnish_start_search").write_text(search)
                    recovered.main()
                    self.assertEqual(row.call_count, rows, (program, search))

    def test_rows_of_the_same_run_are_kept_and_those_of_another_are_not(self):
        results = {"commit": "a", "programs": ["p"], "command": "b", "captures": "/captures", "seconds": 120,
                   "machine": "2 cores"}
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "recovered.json"
            self.assertEqual(recovered.earlier_rows(file, results), [])
            file.write_text(json.dumps(results | {"rows": [ROW]}))
            self.assertEqual(recovered.earlier_rows(file, results), [ROW])
            for other in ({"commit": "c"}, {"programs": ["q"]}, {"command": "c"}, {"captures": "/c"}, {"seconds": 60},
                          {"machine": "4 cores"}):
                self.assertEqual(recovered.earlier_rows(file, results | other), [], other)

    def test_rows_of_a_tree_that_no_commit_tells_are_made_again(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "recovered.json"
            for commit in ("a with changes", "unknown"):
                results = {"commit": commit, "programs": ["p"], "command": "b", "captures": "/captures",
                           "seconds": 120, "machine": "2 cores"}
                file.write_text(json.dumps(results | {"rows": [ROW]}))
                self.assertEqual(recovered.earlier_rows(file, results), [], commit)

    def test_rows_that_do_not_name_their_captures_are_made_again(self):
        results = {"commit": "a", "programs": ["p"], "command": "b", "seconds": 120, "machine": "2 cores"}
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "recovered.json"
            file.write_text(json.dumps(results | {"rows": [ROW]}))
            self.assertEqual(recovered.earlier_rows(file, results | {"captures": "/captures"}), [])


if __name__ == "__main__":
    unittest.main()

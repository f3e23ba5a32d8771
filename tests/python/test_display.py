"""What a notebook shows, and the line of progress."""
import base64
import re
import sys
import threading
import types

import numpy as np
import pytest

import burnish
from burnish._bar import Bar, _Line
from burnish._display import _curve, _summary_html

from conftest import NAME, in_two_ranks


def decoded(png, tmp_path):
    file = tmp_path / "shown.png"
    file.write_bytes(png)
    return burnish.read_image(file)


def images_of(html, tmp_path):
    return [decoded(base64.b64decode(data), tmp_path) for data in re.findall(r'src="data:image/png;base64,([^"]*)"', html)]


def test_an_image_shows_itself(target, tmp_path):
    shown = burnish.show(target)
    assert shown._repr_html_() is None
    large = decoded(shown._repr_png_(), tmp_path)
    assert large.shape == (192, 192, 3)  # enlarged
    np.testing.assert_allclose(large[::6, ::6], np.clip(target, 0, 1), atol=0.01)


def test_images_show_themselves_side_by_side(target, tmp_path):
    gray = np.linspace(0, 1, 12, dtype=np.float32).reshape(3, 4)
    shown = burnish.show({"<picture>": target, "gray": gray})
    assert shown._repr_png_() is None and "&lt;picture&gt;" in shown._repr_html_()
    assert 'alt="&lt;picture&gt;"' in shown._repr_html_() and "max-width:100%" in shown._repr_html_()
    picture, numbers = images_of(shown._repr_html_(), tmp_path)
    assert picture.shape == target.shape
    codes = np.round(255 * gray) / 255  # as they are: read_image takes them for sRGB
    linear = np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4)
    np.testing.assert_allclose(numbers[..., 0], linear, atol=1e-5)


@pytest.mark.parametrize("wrong", [np.full((4, 4, 3), 60, np.uint8), np.zeros(5), np.zeros((2, 2, 2)), np.zeros((0, 3, 3)),
                                   np.full((2, 2), np.nan)])
def test_what_is_no_image_is_refused_at_once(wrong):
    with pytest.raises(burnish.InputError) as expected:
        burnish.encode_png(wrong)
    for images in (wrong, {"name": wrong}):
        with pytest.raises(burnish.InputError, match=f"^{re.escape(str(expected.value))}$"):
            burnish.show(images)


def test_an_image_that_speaks_dlpack_alone_shows_itself(tmp_path):
    class OnlyDlpack:
        values = np.linspace(0, 1, 36, dtype=np.float32).reshape(3, 4, 3)

        def __dlpack__(self, **keywords):
            return self.values.__dlpack__(**keywords)

        def __dlpack_device__(self):
            return self.values.__dlpack_device__()

    shown, expected = burnish.show(OnlyDlpack()), burnish.show(OnlyDlpack.values)
    np.testing.assert_array_equal(decoded(shown._repr_png_(), tmp_path), decoded(expected._repr_png_(), tmp_path))


def points_of(html):
    return [tuple(map(float, p.split(","))) for p in re.search('points="([^"]*)"', html)[1].split()]


def test_a_curve_is_of_what_is_finite():
    falling = _curve([100.0, 10.0, 1.0])
    assert points_of(falling) == [(0, 4), (120, 30), (240, 56)] and ">loss, logarithmic<" in falling
    broken = _curve([100.0, float("nan"), 10.0, float("inf"), 1.0])
    assert points_of(broken) == [(0, 4), (120, 30), (240, 56)]
    below = _curve([-1.0, -2.0, -3.0])
    assert points_of(below) == [(0, 4), (120, 30), (240, 56)] and ">loss<" in below
    assert points_of(_curve([1.0, 0.0])) == [(0, 4), (240, 56)]
    assert points_of(_curve([0.0, 0.0])) == [(0, 56), (240, 56)]
    for losses in ([], [1.0], [1.0, float("nan")], [float("inf")] * 3):
        assert _curve(losses) == ""


def test_solvers_and_summaries_show_themselves(problem, tmp_path):
    solver = burnish.Solver(problem, iterations=3)
    assert len(images_of(solver._repr_html_(), tmp_path)) == 1  # no image yet
    for _ in solver:
        pass
    html = solver._repr_html_()
    assert NAME in html and "3 iterations" in html and len(images_of(html, tmp_path)) == 2
    summary = burnish.solve(problem, iterations=3)
    html = summary._repr_html_()
    assert f"{summary.loss:.4g} in 3 iterations" in html and len(images_of(html, tmp_path)) == 3
    assert len(re.findall(r"[\d.]+,[\d.]+", re.search('points="([^"]*)"', html)[1])) == 3
    assert summary.iteration_count == 3
    of_many = {name: getattr(summary, name) for name in dir(summary) if not name.startswith("_")} | {"iteration_count": 40000}
    assert "in 40000 iterations" in _summary_html(types.SimpleNamespace(**of_many))
    assert "<svg" not in burnish.solve(problem, iterations=1)._repr_html_()


def test_a_summary_shows_the_views_of_its_process(renderer, target):
    def solve(ranks):
        problem = burnish.Problem(renderer, [target, target], burnish.Unknown(NAME, 0.5), ranks=ranks)
        return burnish.solve(problem, batch=2, iterations=1, evaluation_spp=2)

    summaries = in_two_ranks(solve)
    first, second = ([e.image for e in summary.result.views] for summary in summaries)
    assert all(image is not None for image in first)  # it has all
    assert sum(image is None for image in second) == 1
    assert [len(re.findall("<figcaption>view [01]<", s._repr_html_())) for s in summaries] == [2, 1]


def test_a_summary_names_its_views(renderer, target):
    def captions(*names):
        views = [burnish.View(target, name=name) for name in names]
        summary = burnish.solve(burnish.Problem(renderer, views, burnish.Unknown(NAME, 0.5)), iterations=1, evaluation_spp=2)
        assert summary.view_names == list(names) and len(summary.result.views) == len(names)
        return re.findall("<figcaption>([^<]*)<", summary._repr_html_())[:len(names)]

    assert captions("<front>", "", "side") == ["&lt;front&gt;", "view 1", "side"]
    assert captions("front") == ["front"] and captions("") == ["image"]


def test_a_bar_shows_the_progress(problem, capfd, monkeypatch):
    def fail(iteration):
        raise ZeroDivisionError

    monkeypatch.setitem(sys.modules, "tqdm", None)  # as if it were not installed
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    summary = burnish.solve(problem, iterations=4, progress=True, callback=lambda i: i.number == 2)
    assert summary.ending == "cancelled"
    lines = capfd.readouterr().err.split("\n")
    assert len(lines) >= 3 and all(line.startswith("\r") for line in lines[:-1])
    [iterations] = [line.split("\r")[-1] for line in lines if "iteration  " in line]
    assert re.fullmatch(r"iteration  3/4  loss \d.*", iterations.strip())
    with pytest.raises(ZeroDivisionError):
        burnish.solve(problem, iterations=4, progress=True, callback=fail)
    assert capfd.readouterr().err.endswith("\n")


def test_a_bar_counts_from_the_start_of_the_run(problem, tmp_path, capfd, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    state = burnish.solve(problem, iterations=4, evaluation_spp=2, checkpoints=tmp_path).state
    burnish.solve(problem, iterations=6, evaluation_spp=2, checkpoints=tmp_path, progress=True)
    burnish.solve(problem, state, iterations=2, evaluation_spp=2, progress=True)
    lines = [line.split("\r") for line in capfd.readouterr().err.split("\n") if "iteration  " in line]
    assert [line[-1].split("  ")[1] for line in lines] == ["6/6", "6/6"]


def test_the_line_is_like_tqdms():
    tqdm = pytest.importorskip("tqdm", reason="tqdm is not installed").tqdm
    for line in (tqdm(total=3, desc="work", mininterval=0.2, disable=False), _Line(total=3, desc="work", mininterval=0.2)):
        line.set_postfix_str("loss 1", refresh=False)
        line.update(2)
        assert line.n == 2 and line.total == 3
        line.close()
    for line in (tqdm(total=6, desc="work", initial=4, disable=False), _Line(total=6, desc="work", initial=4)):
        line.update(1)
        assert line.n == 5
        line.close()
    bar = Bar(None)
    bar.stage("evaluating", 0.5)
    assert bar.line.n == 50
    bar.close()
    bar.close()


def test_a_stage_is_a_percentage(capfd, monkeypatch):
    pytest.importorskip("tqdm", reason="tqdm is not installed")
    monkeypatch.setattr("importlib.util.find_spec", lambda name: name == "tqdm" or None)
    bar = Bar(None)
    for share in (0.12345, 2 / 3):
        bar.stage("evaluating", share)
    assert bar.line.n == 67
    bar.close()
    last = capfd.readouterr().err.split("\r")[-1]
    assert "evaluating:  67%" in last and not re.search(r"67\.|/100|/s", last), last


def test_a_bar_that_another_thread_closes_shows_no_more(monkeypatch):
    """As Ctrl-C does, while the thread of the run shows an iteration."""
    closing, postfixes = [], []

    class Line(_Line):
        def set_postfix_str(self, text, refresh=True):
            postfixes.append(text)
            closing.append(threading.Thread(target=bar.close))
            closing[-1].start()
            closing[-1].join(0.2)  # comes after the iteration

    monkeypatch.setattr("burnish._bar._line", lambda **arguments: Line(**arguments))
    bar = Bar(None)
    for number in range(2):
        bar.iteration(types.SimpleNamespace(number=number, loss=1.0))
        closing[0].join()
    bar.stage("evaluating", 0.5)
    assert postfixes == ["loss 1"] and bar.title == "iteration"

"""Runs, steps, states: the same bytes as the program's."""
import copy
import os
import pickle
import shutil
import signal
import subprocess

import numpy as np
import pytest

import burnish

from conftest import NAME


def test_a_run_recovers_a_texture(problem):
    heard = []
    summary = burnish.solve(problem, callback=lambda i: heard.append(i.number), iterations=80, evaluation_spp=64)
    assert heard == list(range(80)) == [i.number for i in summary.iterations]
    assert summary.ending == "iterations" and summary.loss < summary.initial_loss and summary.seconds > 0
    texture = summary.textures[NAME]
    assert texture.shape == (32, 32, 1) and texture.min() >= 0 and texture.max() <= 1
    np.testing.assert_array_equal(summary.starts[NAME], np.full((32, 32, 1), 0.5, np.float32))
    assert summary.coverage[NAME].max() == 1 and summary.confidence[NAME].max() <= 1
    assert summary.result.views[0].image.shape == (32, 32, 3) and summary.result.samples_per_pixel == 64
    with pytest.raises(burnish.Error, match="Solver"):
        summary.iterations[0].textures


def test_the_same_bytes_as_the_program(problem, scene, target, program, tmp_path):
    burnish.write_image(tmp_path / "target.exr", target)
    subprocess.run(
        [program, "optimize", scene, "--size", "32", "32", "--target", tmp_path / "target.exr", "--parameter", NAME, "--init", "0.5",
         "--iterations", "7", "--evaluation-spp", "4", "-o", tmp_path / "out"], check=True, capture_output=True)
    [file] = (tmp_path / "out" / "textures").glob("*roughness*data.exr")
    expected = burnish.read_image(file)
    summary = burnish.solve(problem, iterations=7, evaluation_spp=4)
    np.testing.assert_array_equal(summary.textures[NAME], expected)
    solver = burnish.Solver(problem, iterations=7, evaluation_spp=4)
    losses = [i.loss for i in solver]
    assert losses == [i.loss for i in summary.iterations]
    np.testing.assert_array_equal(solver.recovered()[NAME], expected)


def test_textures_of_a_solver_are_not_copied(problem):
    solver = burnish.Solver(problem, iterations=3)
    texture = solver.textures[NAME]
    assert texture.min() == texture.max() == 0.5
    for iteration in solver:
        assert iteration.textures[NAME].ctypes.data == texture.ctypes.data
    assert texture.min() < texture.max()
    assert not texture.flags.writeable
    with pytest.raises(ValueError):
        texture[0] = 0
    kept = texture.copy()
    del solver, iteration
    np.testing.assert_array_equal(texture, kept)  # the array keeps what it shows


def test_rules_end_a_loop_and_steps_go_on(problem):
    solver = burnish.Solver(problem, iterations=2)
    assert solver.image() is None and solver.ending is None
    assert [i.number for i in solver] == [0, 1] and solver.ending == "iterations"
    assert list(solver) == []
    assert solver.step().number == 2 and solver.iterations == 3
    assert solver.image().shape == (32, 32, 3)
    assert solver.exposure() == [1, 1, 1]
    assert solver.evaluate(spp=4).samples_per_pixel == 4
    assert len(list(burnish.Solver(problem, time=1e-6))) == 1


def test_patience_ends_a_loop_as_it_ends_a_run(problem):
    options = dict(patience=1, iterations=45, learning_rate=1e-30)  # no texel moves
    summary = burnish.solve(problem, evaluation_spp=2, **options)
    solver = burnish.Solver(problem, **options)
    held_out = [i.held_out_loss for i in solver]
    assert held_out == [i.held_out_loss for i in summary.iterations]
    assert [k for k, loss in enumerate(held_out, 1) if loss is not None] == [20, 40]
    assert len(held_out) == 40
    assert solver.ending == summary.ending == "patience"


def test_a_callback_ends_a_run(problem):
    summary = burnish.solve(problem, callback=lambda i: i.number == 2, iterations=50, evaluation_spp=2)
    assert summary.ending == "cancelled" and len(summary.iterations) == 3


def test_progress_is_told(problem):
    burnish.solve(problem, progress=False, iterations=1, evaluation_spp=2)
    told = []
    burnish.solve(problem, progress=lambda stage, share: told.append((stage, share)), iterations=1, evaluation_spp=2)
    assert {stage for stage, _ in told} >= {"rendering the start", "evaluating the result"}
    assert all(0 <= share <= 1 for _, share in told)


def test_states_go_on_to_the_same_bytes(problem, tmp_path):
    whole = burnish.Solver(problem, iterations=5)
    for iteration in whole:
        if iteration.number == 2:
            state = whole.state
    state.save(tmp_path / "state")
    for again in [state, pickle.loads(pickle.dumps(state)), burnish.State.load(tmp_path / "state"), copy.deepcopy(state),
                  burnish.State.from_bytes(state.to_bytes())]:
        assert again == state
        solver = burnish.Solver(problem, again, iterations=2)
        assert [i.number for i in solver] == [3, 4]
        np.testing.assert_array_equal(solver.textures[NAME], whole.textures[NAME])
    assert burnish.solve(problem, state, iterations=2, evaluation_spp=2).state == whole.state
    assert whole.state != state
    with pytest.raises(burnish.InputError):
        burnish.State.from_bytes(b"nothing")


def test_masks_of_codes_are_refused(target):
    mask = np.zeros((32, 32), np.uint8)
    mask[:, 16:] = 255
    for codes in (mask, mask.astype(int)):
        with pytest.raises(burnish.InputError, match="up to 255, expected weights from 0 to 1"):
            burnish.View(target, mask=codes)
    view = burnish.View(target, mask=mask // 255)
    np.testing.assert_array_equal(view.mask[..., 0], mask // 255)
    with pytest.raises(ValueError, match="read-only"):
        view.mask[...] = 0


def test_views_masks_and_exposures(renderer, target):
    mask = np.ones((32, 32), np.float32)
    mask[:, 16:] = 0
    views = [burnish.View(target, name="first", mask=mask), burnish.View(2 * target, exposure="fit", name="second"),
             burnish.View(target, held_out=True)]
    problem = burnish.Problem(renderer, views, [burnish.Unknown(NAME, 0.4)])
    solver = burnish.Solver(problem, batch=2, iterations=3)
    list(solver)
    assert 1.8 < solver.exposure(1)[0] < 2.3
    assert solver.image(2) is None
    with pytest.raises(IndexError):
        solver.image(3)
    assert len(solver.evaluate(2).views) == 3


def test_the_start_is_searched(renderer, target):
    summary = burnish.solve(burnish.Problem(renderer, [target], [NAME]), iterations=1, evaluation_spp=2)
    assert summary.search_seconds > 0 and summary.starts[NAME].shape == (32, 32, 1)


def test_a_run_goes_on_from_its_checkpoints(problem, renderer, target, tmp_path):
    folder = tmp_path / "kept"
    first = burnish.solve(problem, checkpoints=folder, iterations=5, evaluation_spp=2)
    heard = []
    rest = burnish.solve(problem, checkpoints=folder, iterations=12, evaluation_spp=2, callback=lambda i: heard.append(i.number))
    whole = burnish.solve(problem, iterations=12, evaluation_spp=2)
    assert heard == list(range(5, 12))
    assert [i.loss for i in rest.iterations] == [i.loss for i in whole.iterations]
    assert rest.state == whole.state and rest.initial_loss == first.initial_loss
    with pytest.raises(burnish.InputError, match="changed since it began: the option seed"):
        burnish.solve(problem, checkpoints=folder, seed=3)
    with pytest.raises(burnish.InputError, match="expected one of them"):
        burnish.solve(problem, first.state, checkpoints=folder)
    own = burnish.Problem(renderer, target, burnish.Unknown(NAME, start=0.5), lambda image, view: (0.0, image * 0))
    with pytest.raises(burnish.InputError, match="changed since it began: the loss, which is one's own"):
        burnish.solve(own, checkpoints=folder)


@pytest.mark.parametrize("name, said", [(b"run", "run"), (b"caf\xe9", r"caf\\xe9")])
def test_a_damaged_checkpoint_is_warned_of(problem, tmp_path, name, said):
    folder = tmp_path / os.fsdecode(name)
    for iterations in (1, 2):
        burnish.solve(problem, checkpoints=folder, iterations=iterations, evaluation_spp=2)
    os.truncate(folder / "0000000002.burnish", 100)
    with pytest.warns(RuntimeWarning, match=f"{said}/0000000002.burnish: .*: the one before it is taken") as warned:
        summary = burnish.solve(problem, checkpoints=folder, iterations=2, evaluation_spp=2)
    assert len(warned) == 1 and summary.iteration_count == 2


def test_a_run_does_not_go_on_with_another_scene(scene, renderer, target, tmp_path):
    def of(renderer):
        return burnish.Problem(renderer, target, burnish.Unknown(NAME, start=0.5))

    def loaded(folder="same", **settings):
        return burnish.load(tmp_path / folder / "scene.xml", size=(32, 32), **settings)

    for folder in ("same", "painted"):
        shutil.copytree(scene.parent, tmp_path / folder)
    picture = tmp_path / "painted" / "textures" / "table.png"
    burnish.write_image(picture, 0.5 * burnish.read_image(picture))
    sky = burnish.Lighting(emitters=[], environment=burnish.Environment(np.ones((2, 4, 3))))
    folder = tmp_path / "kept"
    burnish.solve(of(loaded()), checkpoints=folder, iterations=1, evaluation_spp=2)
    for other, what in [(loaded("painted"), "the scene's textures"), (loaded(constants=["mat-goblet.metallic:4"]), "the scene's textures"),
                        (loaded(light_selection="power"), "the light selection"), (loaded(spp=3), "the scene's file"),
                        (loaded().with_lighting(sky), "the renderer's light"),
                        (loaded().with_camera(burnish.Camera(32, 32, 50)), "the renderer's camera")]:
        with pytest.raises(burnish.InputError, match=f"changed since it began: .*{what}"):
            burnish.solve(of(other), checkpoints=folder, iterations=2)
    burnish.solve(of(loaded()), checkpoints=folder, iterations=2, evaluation_spp=2)
    burnish.solve(of(renderer), checkpoints=folder, iterations=3, evaluation_spp=2)  # the same files elsewhere


def test_a_folder_of_checkpoints_is_of_one_run(problem, tmp_path):
    def callback(iteration):
        burnish.solve(problem, checkpoints=tmp_path, iterations=1)

    with pytest.raises(burnish.Error, match="the folder of checkpoints of a run that goes on"):
        burnish.solve(problem, checkpoints=tmp_path, iterations=2, callback=callback)
    assert burnish.solve(problem, checkpoints=tmp_path, iterations=2, evaluation_spp=2).ending == "iterations"


@pytest.mark.parametrize("own_loss", [False, True])
def test_an_interrupted_run_goes_on(renderer, target, own_loss, tmp_path):
    def loss(image, view):
        return float(((image - target) ** 2).mean()), 2 * (image - target) / image.size

    problem = burnish.Problem(renderer, target, burnish.Unknown(NAME, start=0.5), loss if own_loss else None)

    def interrupt(*arguments):
        raise KeyboardInterrupt

    def arm(iteration):
        if iteration.number == 0:
            signal.setitimer(signal.ITIMER_REAL, 0.3)

    earlier = signal.signal(signal.SIGALRM, interrupt)
    try:
        with pytest.raises(KeyboardInterrupt):
            burnish.solve(problem, checkpoints=tmp_path, iterations=1000000, callback=arm)
    finally:
        signal.signal(signal.SIGALRM, earlier)
    heard = []
    rest = burnish.solve(problem, checkpoints=tmp_path, iterations=1000000, evaluation_spp=2,
                         callback=lambda i: heard.append(i.number) or len(heard) == 3)
    assert heard[0] > 0
    whole = burnish.solve(problem, iterations=heard[-1] + 1, evaluation_spp=2)
    assert rest.state == whole.state


def test_outputs_that_cannot_be_written(problem, tmp_path):
    (tmp_path / "file").write_text("")
    for write in (lambda: burnish.solve(problem, checkpoints=tmp_path / "file", iterations=1),
                  lambda: burnish.write_image(tmp_path / "file" / "a.exr", np.zeros((2, 2)))):
        with pytest.raises(burnish.OutputError) as caught:
            write()
        assert isinstance(caught.value, OSError) and isinstance(caught.value, burnish.Error)


def test_a_folder_of_checkpoints_that_cannot_be_made_is_said_before_the_run(problem, tmp_path):
    (tmp_path / "loop").symlink_to("loop")
    for folder in (tmp_path / "loop", tmp_path / ("a" * 300), tmp_path / "loop" / "within"):
        with pytest.raises(burnish.OutputError, match="cannot be (made|read)"):
            burnish.solve(problem, checkpoints=folder, iterations=1, callback=lambda i: pytest.fail("it runs"))
    with pytest.raises(burnish.InputError, match="the folder of the checkpoints has no name"):
        burnish.solve(problem, checkpoints="", iterations=1, callback=lambda i: pytest.fail("it runs"))


def test_what_is_no_file_is_not_replaced(problem, renderer, tmp_path):
    """As a device would be, by whoever may write into its folder."""
    state = burnish.Solver(problem, pyramid_levels=1).state
    for name, write in {"state": state.save, "a.png": lambda file: burnish.write_image(file, np.zeros((2, 2))),
                        "a.glb": lambda file: burnish.write_model(file, renderer)}.items():
        os.mkfifo(tmp_path / name)
        with pytest.raises(burnish.OutputError, match="not a regular file"):
            write(tmp_path / name)
        assert (tmp_path / name).is_fifo() and len(os.listdir(tmp_path)) == 1
        os.remove(tmp_path / name)

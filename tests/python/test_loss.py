"""Losses of one's own."""
import warnings

import numpy as np
import pytest

import burnish

from conftest import NAME


def relative(target):
    def loss(image, view):
        assert image.flags.writeable and view == 0
        difference = image - target
        weight = 1 / (target**2 + np.float32(0.01)) / target.size
        return float((difference.astype(float) ** 2 * weight).sum()), 2 * difference * weight
    return loss


def solver_of(renderer, target, own, **options):
    """own: a loss, or None: relMSE."""
    loss = {} if own else {"loss": "relmse"}
    return burnish.Solver(burnish.Problem(renderer, target, burnish.Unknown(NAME, 0.5), own), iterations=5, **loss, **options)


def test_a_loss_of_ones_own_that_is_built_in_does_the_same(renderer, target):
    own = solver_of(renderer, target, relative(target))
    built_in = solver_of(renderer, target, None)
    for a, b in zip(own, built_in):
        assert a.loss == pytest.approx(b.loss, rel=1e-5)
    np.testing.assert_allclose(own.textures[NAME], built_in.textures[NAME], atol=2e-3)


def test_with_a_loss_of_ones_own_nothing_is_searched_or_fitted(renderer, target):
    def solver(view):
        return burnish.Solver(burnish.Problem(renderer, view, NAME, relative(target)))

    assert (solver(target).textures[NAME] == 0.5).all() and "with a loss of your own 0.5" in " ".join(burnish.Unknown.__doc__.split())
    with pytest.raises(burnish.InputError, match="loss"):
        solver(burnish.View(target, exposure="fit"))


def test_a_loss_gets_the_whole_image_times_the_exposure(renderer, target):
    mask = np.ones((32, 32, 1), np.float32)
    mask[:20] = 0
    seen = []

    def whole(image, view):
        seen.append(image.copy())
        return relative(target)(image, view)

    def masked(image, view):
        weight = mask / (target**2 + np.float32(0.01)) / target.size
        return float(((image - target) ** 2 * weight).sum()), 2 * (image - target) * weight

    def after_steps(loss, **view):
        solver = solver_of(renderer, burnish.View(target, exposure=2, **view), loss)
        return list(solver), solver

    with pytest.warns(UserWarning, match="the masks of the views count in psnr alone, unless it applies them"):
        _, own = after_steps(whole, mask=mask)
    assert any(np.array_equal(image, 2 * own.image()) for image in seen)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        _, without = after_steps(whole, mask=np.ones((32, 32)))
        iterations, built_in = after_steps(None, mask=mask)
        applied, other = after_steps(masked)
    np.testing.assert_array_equal(own.textures[NAME], without.textures[NAME])
    assert own.evaluate(16).views[0].psnr != without.evaluate(16).views[0].psnr
    assert [i.loss for i in applied] == pytest.approx([i.loss for i in iterations], rel=1e-5)
    np.testing.assert_allclose(other.textures[NAME], built_in.textures[NAME], atol=2e-3)
    assert np.abs(own.textures[NAME] - built_in.textures[NAME]).max() > 0.01


def test_what_a_loss_raises_arrives_whole(renderer, target):
    def loss(image, view):
        raise ZeroDivisionError("of the loss")

    solver = solver_of(renderer, target, loss)
    with pytest.raises(ZeroDivisionError, match="of the loss") as raised:
        next(solver)
    assert raised.traceback[-1].name == "loss"
    with pytest.raises(ZeroDivisionError):
        solver.step()
    assert solver.iterations == 0 and solver.textures[NAME].mean() == 0.5  # as it was
    with pytest.raises(ZeroDivisionError):
        burnish.solve(burnish.Problem(renderer, target, NAME, loss), iterations=1)


class RaisingLoss:
    """The relative loss, which raises in one of its calls."""

    def __init__(self, target, failing=None):
        self.loss, self.failing, self.calls = relative(target), failing, 0

    def __call__(self, image, view):
        self.calls += 1
        if self.calls == self.failing:
            raise ZeroDivisionError("once")
        return self.loss(image, view)


@pytest.mark.parametrize("estimator", ["path_cache", "mc"])
@pytest.mark.parametrize("failing", [1, 2, 5])
def test_a_solver_goes_on_after_its_loss_has_raised(renderer, target, failing, estimator):
    other = solver_of(renderer, target, relative(target), estimator=estimator)
    solver = solver_of(renderer, target, RaisingLoss(target, failing), estimator=estimator)
    with pytest.raises(ZeroDivisionError, match="once"):
        list(solver)
    rest, all_of = list(solver), list(other)
    assert [i.number for i in rest] == [0, 1, 2, 3, 4][-len(rest):] and solver.iterations == 5
    assert [i.loss for i in rest] == [i.loss for i in all_of][-len(rest):]
    assert solver.state == other.state


@pytest.mark.parametrize("iterations", [20, 22])  # the check comes after 20
def test_an_iteration_whose_check_has_raised_counts(renderer, target, iterations):
    def solver(loss):
        return burnish.Solver(burnish.Problem(renderer, target, burnish.Unknown(NAME, 0.5), loss), iterations=iterations, patience=1)

    counted = RaisingLoss(target)
    other = solver(counted)
    while other.iterations < 20:
        next(other)
    one = solver(RaisingLoss(target, counted.calls))  # the last call is of the check
    list(other)
    with pytest.raises(ZeroDivisionError, match="once"):
        list(one)
    assert one.iterations == 20
    assert [i.number for i in one] == list(range(20, iterations)) and one.ending == "iterations"
    np.testing.assert_array_equal(one.textures[NAME], other.textures[NAME])


def test_a_loss_that_raises_stop_iteration_does_not_end_the_loop(renderer, target):
    with pytest.raises(RuntimeError, match="the loss raised StopIteration"):
        list(solver_of(renderer, target, lambda image, view: next(iter([]))))


@pytest.mark.parametrize("result, exception", [
    (3.0, TypeError), (None, TypeError), ((1.0,), TypeError), (("one", np.zeros((32, 32, 3))), (TypeError, ValueError)),
    ((1.0, None), TypeError), ((1.0, np.zeros((3, 3, 3))), burnish.InputError), ((1.0, np.zeros((32, 32))), burnish.InputError),
    ((1.0, np.full((32, 32, 3), np.nan)), burnish.InputError),
])
def test_what_a_loss_may_not_return(renderer, target, result, exception):
    with pytest.raises(exception):
        solver_of(renderer, target, lambda image, view: result).step()


def test_a_loss_cannot_use_its_solver(renderer, target):
    def loss(image, view):
        solver.textures  # they can be seen
        solver.step()

    solver = solver_of(renderer, target, loss)
    with pytest.raises(burnish.Error, match="at work"):
        solver.step()


def test_a_loss_can_use_the_renderer(renderer, target):
    inner = relative(target)
    seen = []

    def loss(image, view):
        seen.append(renderer.render(spp=1).mean())
        return inner(image, view)

    solver_of(renderer, target, loss).step()
    assert seen

"""Exchanges between processes that are functions of a test's own: no MPI is needed."""
import math
import signal
from concurrent.futures import ThreadPoolExecutor

import pytest

import burnish

from conftest import NAME, in_two_ranks, two_ranks


@pytest.mark.parametrize("ranks, error, text", [
    (burnish.Ranks(2, 2, lambda m: m), burnish.InputError, "process 2 of 2"),
    (burnish.Ranks(0, 0, lambda m: m), burnish.InputError, "process 0 of 0"),
    (burnish.Ranks(0, 1, 3), TypeError, "expected a function"),
    (3, TypeError, "expected a burnish.Ranks"),
])
def test_what_is_no_rank_is_refused(renderer, target, ranks, error, text):
    with pytest.raises(error, match=text):
        burnish.Problem(renderer, target, NAME, ranks=ranks)


@pytest.mark.parametrize("answer", [None, [b""], [b"", "text"], (b"", b"")])
def test_an_exchange_that_returns_something_else_is_said(renderer, target, answer):
    problem = burnish.Problem(renderer, [target, target], burnish.Unknown(NAME, start=0.5), ranks=burnish.Ranks(0, 2, lambda m: answer))
    with pytest.raises(TypeError, match="Ranks.exchange returned"):
        burnish.solve(problem, batch=2, iterations=1)


def test_an_exchange_that_loses_what_was_sent_is_said(renderer, target):
    ranks = burnish.Ranks(0, 2, lambda messages: [b""] * len(messages))
    problem = burnish.Problem(renderer, [target, target], burnish.Unknown(NAME, start=0.5), ranks=ranks)
    with pytest.raises(burnish.Error, match="an exchange gave an empty message"):
        burnish.solve(problem, batch=2, iterations=1)


def test_the_first_process_alone_hears_of_iterations(renderer, target):
    def solve(ranks):
        heard, told = [], set()

        def callback(iteration):
            heard.append(iteration.number)
            return iteration.number == 2

        problem = burnish.Problem(renderer, [target, target], burnish.Unknown(NAME, start=0.5), ranks=ranks)
        summary = burnish.solve(problem, batch=2, iterations=5, evaluation_spp=2, callback=callback, progress=lambda stage, _: told.add(stage))
        return heard, told, summary

    (first, told, one), (second, told_second, other) = in_two_ranks(solve)
    assert (first, second) == ([0, 1, 2], []) and one.ending == other.ending == "cancelled"
    assert told == told_second == {"rendering the start", "evaluating the result"}


# Of one view with `mc` the second process has no share.
@pytest.mark.parametrize("interrupted, views, estimator", [(0, 2, "path_cache"), (1, 2, "path_cache"), (1, 1, "mc")])
def test_ctrl_c_in_one_process_ends_the_run_of_all_with_a_checkpoint(
    renderer, target, tmp_path, interrupted, views, estimator
):
    def solve(ranks, folder, callback):
        problem = burnish.Problem(renderer, [target] * views, burnish.Unknown(NAME, start=0.5), ranks=ranks)
        options = dict(estimator=estimator, batch=views if views > 1 else None, iterations=5000, evaluation_spp=2)
        return burnish.solve(problem, checkpoints=tmp_path / folder, callback=callback, **options)

    def interrupt(*arguments):
        raise KeyboardInterrupt

    def arm(iteration):
        if iteration.number == 2:
            signal.setitimer(signal.ITIMER_REAL, 0.1)

    ranks = two_ranks()
    own, other = ranks[interrupted], ranks[1 - interrupted]
    earlier = signal.signal(signal.SIGALRM, interrupt)
    try:
        with ThreadPoolExecutor(1) as thread:
            elsewhere = thread.submit(solve, other, str(other.rank), arm)
            with pytest.raises(KeyboardInterrupt):
                solve(own, str(own.rank), arm)
            suspended = elsewhere.result()
            assert suspended.ending == "suspended" and not suspended.result.views
            assert math.isnan(suspended.loss) and math.isnan(suspended.initial_loss)
    finally:
        signal.signal(signal.SIGALRM, earlier)
    heard = []
    rest = solve(None, "0", lambda i: heard.append(i.number) or len(heard) == 2)
    assert heard[0] > 2 and rest.state == solve(None, "whole", lambda i: i.number == heard[-1]).state

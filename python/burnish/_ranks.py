"""Processes that solve a problem together."""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Ranks:
    """The processes that share out the views of a problem, and of a path cache the bands of a view where there are
    fewer views than processes. Each has the same problem and options, and makes the same calls; the result does not
    depend on how many they are. Those of MPI: burnish.mpi.ranks_of.

    rank: this process, from 0. count: at most the views of an iteration, but where this visits all fitted ones.
    exchange: sends one message of bytes to each process, itself included, and returns those that came; it returns
    once all processes have called it, and is called by another thread than the one that calls solve.
    """

    rank: int
    count: int
    exchange: Callable[[list[bytes]], list[bytes]]

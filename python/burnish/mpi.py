"""Processes of MPI that solve a problem together, by mpi4py.

    mpirun -n 4 python -m mpi4py program.py

    from mpi4py import MPI
    import burnish, burnish.mpi

    problem = burnish.Problem(renderer, views, "mat.roughness", ranks=burnish.mpi.ranks_of(MPI.COMM_WORLD))
    summary = burnish.solve(problem, batch=len(views))
    if MPI.COMM_WORLD.rank == 0:
        burnish.write_image("roughness.exr", summary.textures["mat.roughness"])

`-m mpi4py` ends the job where one process fails. Without it the others wait for it.
"""
from __future__ import annotations

import time

import numpy as np
from mpi4py import MPI

from ._ranks import Ranks

__all__ = ["ranks_of"]

_TAG = 0
_MAX_PART = 1 << 30  # counts are int: long messages go in parts


def _wait_for(requests: list[MPI.Request]) -> None:
    """Without keeping a core busy for long: a process on the same machine may need it."""
    tries = 0
    while not MPI.Request.Testall(requests):
        time.sleep(0 if tries < 200 else 50e-6)
        tries += 1


def _parts(message: bytes | bytearray) -> list[memoryview]:
    return [memoryview(message)[at : at + _MAX_PART] for at in range(0, len(message), _MAX_PART)]


def _exchange(communicator: MPI.Intracomm, messages: list[bytes]) -> list[bytes]:
    sizes, coming = np.array([len(m) for m in messages], np.uint64), np.empty(len(messages), np.uint64)
    _wait_for([communicator.Ialltoall([sizes, MPI.UINT64_T], [coming, MPI.UINT64_T])])
    came = [bytearray(int(size)) for size in coming]
    requests: list[MPI.Request] = []
    for other in range(communicator.size):
        if other == communicator.rank:
            continue
        requests += [communicator.Irecv([part, MPI.BYTE], other, _TAG) for part in _parts(came[other])]
        requests += [communicator.Isend([part, MPI.BYTE], other, _TAG) for part in _parts(messages[other])]
    _wait_for(requests)
    return [messages[r] if r == communicator.rank else bytes(m) for r, m in enumerate(came)]


def ranks_of(communicator: MPI.Intracomm) -> Ranks:
    """The processes of a communicator, on which nothing else may be sent while a call lasts.

    MPI is called by another thread than the one that calls solve: mpi4py's own level of threads, MPI_THREAD_MULTIPLE, allows it.
    Throws RuntimeError where MPI was begun with less than MPI_THREAD_SERIALIZED.
    """
    if MPI.Query_thread() < MPI.THREAD_SERIALIZED:
        raise RuntimeError("MPI was begun for one thread: expected MPI_THREAD_SERIALIZED, or mpi4py's own MPI_THREAD_MULTIPLE")
    return Ranks(communicator.rank, communicator.size, lambda messages: _exchange(communicator, messages))

"""Several processes of MPI from Python; skipped without mpi4py or mpirun."""
import os
import subprocess
import sys
import textwrap

import numpy as np
import pytest

import burnish

from conftest import NAME

MPIEXEC = os.environ.get("BURNISH_MPIEXEC")
try:
    from mpi4py import MPI  # noqa: F401: looks for the system's library
except (ImportError, RuntimeError):
    MPIEXEC = None

pytestmark = pytest.mark.skipif(not MPIEXEC, reason="mpi4py or mpirun is not there")

PROGRAM = """
    import pathlib, sys
    import numpy as np
    import burnish

    renderer = burnish.load(sys.argv[1], size=(32, 32))
    front = renderer.render(spp=64, seed=7)
    views = [burnish.View(front * e, exposure=e, name=str(e)) for e in (1, 0.5, 2, 1)]
    ranks = None
    if len(sys.argv) > 3:
        import burnish.mpi
        from mpi4py import MPI
        ranks = burnish.mpi.ranks_of(MPI.COMM_WORLD)
    problem = burnish.Problem(renderer, views, burnish.Unknown("NAME", start=0.5), ranks=ranks)
    last = pathlib.Path(sys.argv[2]).with_suffix(".checkpoints")
    own = []
    summary = burnish.solve(problem, batch=4, iterations=6, evaluation_spp=4, checkpoints=last, callback=lambda i: own.append(i.number))
    assert ranks is None or ranks.count == int(sys.argv[3])
    if ranks is None or ranks.rank == 0:
        np.savez(sys.argv[2], texture=summary.textures["NAME"], losses=[i.loss for i in summary.iterations], own=own)
"""
PROGRAM = textwrap.dedent(PROGRAM).replace("NAME", NAME)


def environment() -> dict[str, str]:
    """Lets OpenMPI start more processes than there are cores, as root in a container, too."""
    names = ("OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "OMPI_MCA_rmaps_base_oversubscribe", "PRTE_ALLOW_RUN_AS_ROOT", "PRTE_ALLOW_RUN_AS_ROOT_CONFIRM")
    return {**os.environ, **dict.fromkeys(names, "1"), "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe"}


def run(launcher: list[str], code: str, *arguments) -> subprocess.CompletedProcess:
    command = [*launcher, sys.executable, "-m", "mpi4py", "-c", code, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, env=environment())


@pytest.fixture(scope="module")
def alone(scene, tmp_path_factory):
    file = tmp_path_factory.mktemp("alone") / "result.npz"
    done = run([], PROGRAM, scene, file)
    assert done.returncode == 0, done.stderr
    return np.load(file)


@pytest.mark.parametrize("count", [2, 3])
def test_any_number_of_processes_makes_the_same_bytes(scene, alone, tmp_path, count):
    done = run([MPIEXEC, "-n", str(count)], PROGRAM, scene, tmp_path / "result.npz", count)
    assert done.returncode == 0, done.stderr
    result = np.load(tmp_path / "result.npz")
    assert (result["texture"] == alone["texture"]).all()
    assert (result["losses"] == alone["losses"]).all()
    # One process goes on with what several have kept.
    more = run([], PROGRAM.replace("iterations=6", "iterations=8"), scene, tmp_path / "result.npz")
    assert more.returncode == 0, more.stderr
    result = np.load(tmp_path / "result.npz")
    assert len(result["losses"]) == 8 and result["own"].tolist() == [6, 7]


def test_a_process_that_fails_ends_the_job(scene, tmp_path):
    code = PROGRAM.replace("problem = ", "if ranks.rank == 1: raise ValueError('only here')\nproblem = ")
    done = run([MPIEXEC, "-n", "2"], code, scene, tmp_path / "result.npz", 2)
    assert done.returncode != 0 and "only here" in done.stderr
    assert not (tmp_path / "result.npz").exists()


def test_more_processes_than_views_are_refused(scene, tmp_path):
    done = run([MPIEXEC, "-n", "2"], PROGRAM.replace("batch=4", "batch=1"), scene, tmp_path / "result.npz", 2)
    assert done.returncode != 0 and "InputError" in done.stderr


def test_messages_longer_than_a_part_arrive(scene, alone, tmp_path):
    code = PROGRAM.replace("import burnish.mpi\n", "import burnish.mpi; burnish.mpi._MAX_PART = 1000\n")
    assert code != PROGRAM
    done = run([MPIEXEC, "-n", "2"], code, scene, tmp_path / "result.npz", 2)
    assert done.returncode == 0, done.stderr
    result = np.load(tmp_path / "result.npz")
    assert (result["texture"] == alone["texture"]).all()
    assert (result["losses"] == alone["losses"]).all()

"""Threads, signals, memory, the end of the interpreter."""
import ctypes
import gc
import importlib.util
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
import weakref

import numpy as np
import pytest

import burnish

from conftest import NAME

CORES = len(os.sched_getaffinity(0))  # that this process may use


def run(code: str, scene, **keywords) -> subprocess.CompletedProcess:
    keywords = {"env": {**os.environ, "BURNISH_LEAK_WARNINGS": "1"}} | keywords
    return subprocess.run([sys.executable, "-c", textwrap.dedent(code), str(scene)], capture_output=True, text=True, timeout=300, **keywords)


def test_the_import_is_light(scene):
    code = "import sys, burnish; assert not {'numpy', 'torch', 'mitsuba', 'IPython'} & set(sys.modules), sys.modules.keys()"
    done = run(code, scene)
    assert done.returncode == 0, done.stderr


def test_a_sub_interpreter_is_refused_and_takes_nothing_from_the_first(scene):
    name = next((n for n in ("_interpreters", "_xxsubinterpreters") if importlib.util.find_spec(n)), None)
    if not name:
        pytest.skip("this Python has no sub-interpreters")
    code = f"import sys; sys.path = {sys.path}\ntry: import burnish\nexcept ImportError as error: print(error, flush=True)"
    done = run(f"""
        import {name} as interpreters
        import burnish, sys
        renderer = burnish.load(sys.argv[1], size=(8, 8))
        for _ in range(2):
            interpreters.run_string(interpreters.create(), {code!r})
        assert renderer.render(spp=1).shape == (8, 8, 3)
        try:
            burnish.Camera(8, 8, 1).scaled(3)
        except burnish.InputError:
            print("as it was")
    """, scene)
    refused = "burnish is for the main interpreter of a process alone, found a sub-interpreter\n"
    assert done.returncode == 0 and done.stdout == 2 * refused + "as it was\n" and not done.stderr, done.stdout + done.stderr


@pytest.mark.parametrize("name", ["render", "encode_png"])
def test_other_threads_run_while_work_runs(renderer, name):
    large = np.random.default_rng(0).random((2000, 2000, 3), np.float32)
    work = {"render": lambda: renderer.render(spp=1500 * CORES), "encode_png": lambda: burnish.encode_png(large)}[name]
    ticks = []
    stop = threading.Event()

    def tick():
        while not stop.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    begin = time.perf_counter()
    work()
    end = time.perf_counter()
    stop.set()
    thread.join()
    during = [t for t in ticks if begin < t < end]
    assert end - begin > 0.05 and len(during) > 10 * (end - begin)


def test_threads_share_a_renderer(renderer, problem):
    expected, texture = renderer.render(spp=8), burnish.Solver(problem, iterations=4)
    list(texture)
    failures = []

    def work(number):
        try:
            for _ in range(3):
                assert (renderer.render(spp=8) == expected).all()
            solver = burnish.Solver(problem, iterations=4)
            list(solver)
            assert (solver.textures[NAME] == texture.textures[NAME]).all()
        except BaseException as error:
            failures.append(error)

    threads = [threading.Thread(target=work, args=(i,)) for i in range(6)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert not failures


def test_threads_take_turns_with_a_solver(problem):
    alone = burnish.Solver(problem, iterations=12)
    list(alone)
    shared = burnish.Solver(problem)
    numbers = []
    threads = [threading.Thread(target=lambda: [numbers.append(shared.step().number) for _ in range(3)]) for _ in range(4)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert sorted(numbers) == list(range(12))
    np.testing.assert_array_equal(shared.textures[NAME], alone.textures[NAME])


def test_threads_that_share_a_solver_keep_to_its_rule(problem):
    for _ in range(10):
        shared = burnish.Solver(problem, iterations=6)
        numbers = []
        threads = [threading.Thread(target=lambda: numbers.extend(i.number for i in shared)) for _ in range(4)]
        for t in threads:
            t.start()
        for t in threads:
            t.join()
        assert sorted(numbers) == list(range(6))


INTERRUPTED = """
    import burnish, os, signal, sys, threading, time
    cores = len(os.sched_getaffinity(0))
    renderer = burnish.load(sys.argv[1], size=(32, 32))
    target = renderer.render(spp=16)
    def work_for(seconds):
        # Until the process has taken so many of processor time.
        begin = time.process_time()
        while time.process_time() - begin < seconds:
            time.sleep(0.01)
    def interrupt(at_work):
        # Once it has worked for so many seconds, or the event is set. Returns when, in processor time.
        sent = [0]
        def send():
            at_work.wait(250) if isinstance(at_work, threading.Event) else work_for(at_work)
            sent[0] = time.process_time()
            signal.pthread_kill(threading.main_thread().ident, signal.SIGINT)
        threading.Thread(target=send, daemon=True).start()
        return sent
"""


@pytest.mark.parametrize("work", [
    "renderer.render(spp=1000000)", "renderer.gradient(target, spp=3000000)",
    "burnish.solve(burnish.Problem(renderer, target, 'mat-goblet.roughness'), iterations=10**8)",
    "burnish.solve(burnish.Problem(renderer, target, 'mat-goblet.roughness'), iterations=1, evaluation_spp=10**6)",
    "burnish.Solver(burnish.Problem(renderer, target, burnish.Unknown('mat-goblet.roughness', 0.5))).evaluate(10**6)",
    # Loops in C, of calls that are done before they look for a signal.
    "list(burnish.Solver(burnish.Problem(renderer, target, burnish.Unknown('mat-goblet.roughness', 0.5)), iterations=10**8))",
    "list(map(renderer.render, [None] * 10**6, [1] * 10**6))",
])
def test_ctrl_c_arrives_within_a_second(scene, work):
    """A second of processor time of each core: on a busy machine it takes longer by the clock."""
    done = run(textwrap.dedent(INTERRUPTED) + textwrap.dedent(f"""
        sent = interrupt(0.3)
        try:
            {work}
        except KeyboardInterrupt:
            print(time.process_time() - sent[0])
        assert renderer.render(spp=1).max() > 0
    """), scene)
    assert done.returncode == 0 and float(done.stdout) < CORES, done.stdout + done.stderr


def test_a_solver_whose_evaluation_was_interrupted_is_free(scene):
    """The evaluation, which would take minutes, is given up; the program ends, too."""
    done = run(textwrap.dedent(INTERRUPTED) + textwrap.dedent("""
        solver = burnish.Solver(burnish.Problem(renderer, target, burnish.Unknown('mat-goblet.roughness', 0.5)))
        interrupt(0.3)
        try:
            solver.evaluate(10**6)
        except KeyboardInterrupt:
            begin = time.process_time()
            solver.step()
            print(time.process_time() - begin)
    """), scene)
    assert done.returncode == 0 and float(done.stdout) < CORES, done.stdout + done.stderr


def test_ctrl_c_ends_the_search_of_a_solver(scene):
    """Without a look at the progress some 12 seconds of a core are still to come when it arrives."""
    done = run(textwrap.dedent("""
        import atexit, time
        atexit.register(lambda: print(time.process_time() - begin))  # after all work: burnish is imported later
    """) + textwrap.dedent(INTERRUPTED) + textwrap.dedent("""
        renderer = burnish.load(sys.argv[1], size=(512, 512))
        target = renderer.render(spp=1)
        problem = burnish.Problem(renderer, [target] * 8, ['mat-goblet.roughness', 'mat-goblet.base_color'])
        interrupt(0.3)
        try:
            burnish.Solver(problem)
        except KeyboardInterrupt:
            begin = time.process_time()
    """), scene)
    assert done.returncode == 0 and float(done.stdout) < 7, done.stdout + done.stderr


def test_ctrl_c_leaves_a_usable_solver(scene):
    done = run(textwrap.dedent(INTERRUPTED) + textwrap.dedent("""
        spp = 150 * cores  # no machine is done when it is interrupted
        at_work, caught = threading.Event(), threading.Event()
        def slow(image, view):
            at_work.set()
            assert caught.wait(250)
            return 0.0, image * 0 + 1
        for loss in [None, slow]:
            caught.set()
            problem = burnish.Problem(renderer, target, burnish.Unknown('mat-goblet.roughness', 0.5), loss)
            alone = burnish.Solver(problem, iterations=1 if loss else 6, estimator="mc", spp=spp)
            expected = [i.number for i in alone]
            solver = burnish.Solver(problem, iterations=1 if loss else 6, estimator="mc", spp=spp)
            numbers = []
            at_work.clear(), caught.clear()
            interrupt(at_work if loss else 0.1)
            try:
                for i in solver: numbers.append(i.number)
                raise SystemExit('not interrupted')
            except KeyboardInterrupt:
                pass
            caught.set()
            for i in solver: numbers.append(i.number)
            assert numbers == expected, numbers
            assert (solver.textures['mat-goblet.roughness'] == alone.textures['mat-goblet.roughness']).all()
    """), scene)
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_handler_cannot_use_the_solver_whose_step_it_interrupts(scene):
    done = run(textwrap.dedent(INTERRUPTED) + textwrap.dedent("""
        at_work, asked = threading.Event(), threading.Event()
        def loss(image, view):
            at_work.set()
            assert asked.wait(250)
            return 0.0, image * 0
        problem = burnish.Problem(renderer, target, burnish.Unknown('mat-goblet.roughness', 0.5), loss)
        solver = burnish.Solver(problem)
        def handler(number, frame):
            try:
                solver.state
            except burnish.Error as error:
                print(error)
            asked.set()
            raise KeyboardInterrupt
        signal.signal(signal.SIGINT, handler)
        interrupt(at_work)
        try:
            solver.step()
        except KeyboardInterrupt:
            print(solver.iterations)
    """), scene)
    assert done.returncode == 0 and "at work" in done.stdout and done.stdout.endswith("\n1\n"), done.stdout + done.stderr


def test_the_loss_of_a_step_that_nobody_waits_for_is_not_collected(scene):
    done = run(textwrap.dedent(INTERRUPTED) + textwrap.dedent("""
        import gc
        target, called = renderer.render(spp=1), threading.Event()
        def step():
            def loss(image, view):
                solver.textures  # knows its solver
                called.set()
                return 0.0, image * 0
            problem = burnish.Problem(renderer, target, burnish.Unknown('mat-goblet.roughness', 0.5), loss)
            solver = burnish.Solver(problem, estimator="mc", spp=1500 * cores)  # for seconds
            interrupt(0.1)
            try:
                solver.step()
            except KeyboardInterrupt:
                print('interrupted')
        step()
        assert not called.is_set()
        gc.collect()
        assert called.wait(250)
    """), scene)
    assert done.returncode == 0 and done.stdout == "interrupted\n", done.stdout + done.stderr


def test_the_interpreter_ends_while_work_goes_on(scene):
    done = run(textwrap.dedent(INTERRUPTED) + textwrap.dedent("""
        at_work, caught = threading.Event(), threading.Event()
        def loss(image, view):
            at_work.set()
            assert caught.wait(250)
            time.sleep(0.5)
            return 0.0, image * 0
        solver = burnish.Solver(burnish.Problem(renderer, target, burnish.Unknown('mat-goblet.roughness', 0.5), loss))
        interrupt(at_work)
        try:
            solver.step()
        except KeyboardInterrupt:
            print('interrupted')
        caught.set()
    """), scene)
    assert done.returncode == 0 and done.stdout == "interrupted\n" and not done.stderr, done.stdout + done.stderr


def test_ctrl_c_ends_a_program_that_waits_for_a_loss(scene):
    """The first one ends the waiting for the step alone; others come while the interpreter waits for the loss."""
    done = run(textwrap.dedent(INTERRUPTED) + textwrap.dedent("""
        import atexit
        at_work, ending = threading.Event(), threading.Event()
        atexit.register(ending.set)
        sys.stdout.reconfigure(write_through=False)  # also where PYTHONUNBUFFERED is set
        def loss(image, view):
            at_work.set()
            time.sleep(60)
            print("the loss returns", flush=True)
            return 0.0, image * 0
        def go_on():
            assert ending.wait(250)
            while True:
                time.sleep(0.2)
                signal.pthread_kill(threading.main_thread().ident, signal.SIGINT)
        threading.Thread(target=go_on, daemon=True).start()
        interrupt(at_work)
        try:
            burnish.Solver(burnish.Problem(renderer, target, burnish.Unknown('mat-goblet.roughness', 0.5), loss)).step()
        except KeyboardInterrupt:
            print("interrupted")
    """), scene)
    assert done.returncode == -signal.SIGINT and done.stdout == "interrupted\n", done.stdout + done.stderr


@pytest.mark.parametrize("goes_on", [
    "burnish.Solver(problem, state, **options)",
    "burnish.solve(problem, state, spp=1, path_cache_window=300, iterations=1, evaluation_spp=2)",
])
def test_a_state_is_copied_once(scene, tmp_path, goes_on):
    """One of many records: by the solver that goes on from it."""
    begin = f"""
        import burnish, os, pathlib, re, sys
        def peak():  # ru_maxrss holds what the process was before it became this program
            return 1024 * int(re.search(r"VmHWM:\\s+(\\d+)", pathlib.Path("/proc/self/status").read_text())[1])
        renderer = burnish.load(sys.argv[1], size=(96, 96))
        problem = burnish.Problem(renderer, renderer.render(spp=1), burnish.Unknown({NAME!r}, 0.5))
        options, file = dict(spp=600, path_cache_window=300), {str(tmp_path / "state")!r}
        solver = burnish.Solver(problem, **options)
    """
    written = run(textwrap.dedent(begin) + textwrap.dedent("""
        solver.step()
        solver.state.save(file)
    """), scene)
    assert written.returncode == 0, written.stderr
    done = run(textwrap.dedent(begin) + textwrap.dedent(f"""
        before = peak()
        state = burnish.State.load(file)
        own = {goes_on}
        print((peak() - before) / os.path.getsize(file))
    """), scene)
    assert done.returncode == 0, done.stderr
    assert 1.5 < float(done.stdout) < 3.5


def test_the_interpreter_ends_while_a_daemon_works(scene):
    done = run(textwrap.dedent(INTERRUPTED) + textwrap.dedent("""
        problem = burnish.Problem(renderer, target, burnish.Unknown('mat-goblet.roughness', 0.5))
        at_work = threading.Event()
        def solve():
            burnish.solve(problem, iterations=10**8, callback=lambda i: at_work.set())
        for work in [solve, lambda: renderer.render(spp=1000000)]:
            threading.Thread(target=work, daemon=True).start()
        assert at_work.wait(250)
        work_for(0.3)
        print('ends')
    """), scene)
    assert done.returncode == 0 and done.stdout == "ends\n", done.stdout + done.stderr


@pytest.mark.parametrize("own_loss", [False, True])
def test_a_program_that_ctrl_c_ends_leaves_a_checkpoint(scene, tmp_path, own_loss):
    """The loss returns once the program ends, and then uses what would stop at once."""
    done = run(textwrap.dedent(INTERRUPTED) + textwrap.dedent(f"""
        import atexit
        at_work, ending = threading.Event(), threading.Event()
        atexit.register(ending.set)
        def loss(image, view):
            if at_work.is_set():
                assert ending.wait(250)
                time.sleep(0.2)
                burnish.encode_png(image)
            return float(((image - target) ** 2).mean()), 2 * (image - target) / image.size
        problem = burnish.Problem(renderer, target, burnish.Unknown({NAME!r}, 0.5), loss if {own_loss} else None)
        interrupt(at_work)
        burnish.solve(problem, iterations=10**6, checkpoints={str(tmp_path)!r}, callback=lambda i: i.number == 2 and at_work.set())
    """), scene)
    assert done.returncode != 0 and "KeyboardInterrupt" in done.stderr, done.stdout + done.stderr
    renderer = burnish.load(scene, size=(32, 32))
    target = renderer.render(spp=16)

    def loss(image, view):
        return float(((image - target) ** 2).mean()), 2 * (image - target) / image.size

    problem = burnish.Problem(renderer, target, burnish.Unknown(NAME, 0.5), loss if own_loss else None)
    heard = []
    rest = burnish.solve(problem, checkpoints=tmp_path, iterations=10**6, evaluation_spp=2,
                         callback=lambda i: heard.append(i.number) or len(heard) == 3)
    assert heard[0] > 2
    assert rest.state == burnish.solve(problem, iterations=heard[-1] + 1, evaluation_spp=2).state


@pytest.mark.parametrize("work", [
    "burnish.solve(problem, iterations=10**8, callback=lambda i: at_work.set() or renderer.render(spp=300000) is None)",
    "burnish.solve(problem, iterations=10**8, callback=lambda i: at_work.set() or burnish.write_image(path, picture))",
    "burnish.Solver(burnish.Problem(renderer, target, unknown, loss)).step()",
    pytest.param("burnish.solve(problem, iterations=1, evaluation_spp=2**16, progress=progress, "
                 "callback=lambda i: worker.append(threading.get_ident()))",
                 marks=pytest.mark.skipif(CORES < 2, reason="oneTBB has no thread of its own")),
])
def test_the_interpreter_ends_while_work_waits_for_work(scene, tmp_path, work):
    done = run(textwrap.dedent(INTERRUPTED) + textwrap.dedent(f"""
        import numpy
        path, picture = {str(tmp_path / "picture.exr")!r}, numpy.random.rand(2048, 2048, 3).astype("float32")
        unknown = burnish.Unknown('mat-goblet.roughness', 0.5)
        problem = burnish.Problem(renderer, target, unknown)
        at_work = threading.Event()
        def loss(image, view):
            at_work.set()
            renderer.render(spp=300000)
            return 0.0, image * 0
        worker = []
        def progress(stage, share):  # of the evaluation, on a thread of oneTBB
            if worker and threading.get_ident() != worker[0]:
                at_work.set()
                renderer.render(spp=300000)
        def work():
            {work}
        threading.Thread(target=work, daemon=True).start()
        assert at_work.wait(250)
        work_for(0.3)
        print('ends')
    """), scene)
    assert done.returncode == 0 and done.stdout == "ends\n", done.stdout + done.stderr


class Mallinfo2(ctypes.Structure):
    """What malloc has done, in glibc's words: uordblks bytes in use in its arenas, hblkhd bytes in mappings."""
    _fields_ = [(name, ctypes.c_size_t) for name in
                ("arena", "ordblks", "smblks", "hblks", "hblkhd", "usmblks", "fsmblks", "uordblks", "fordblks", "keepcost")]


def memory_in_use() -> int:
    """Bytes that malloc has handed out. Resident memory also holds stacks and arenas of threads that come and go."""
    mallinfo2 = ctypes.CDLL(None).mallinfo2
    mallinfo2.restype = Mallinfo2
    info = mallinfo2()
    return info.uordblks + info.hblkhd


def test_a_run_copies_the_pictures_once(renderer):
    picture, camera = np.full((256, 256, 3), 0.5, np.float32), burnish.Sensor(0, 256, 256)
    views = [burnish.View(picture, camera=camera, held_out=k > 0) for k in range(24)]
    problem = burnish.Problem(renderer, views, burnish.Unknown(NAME, 0.5))
    inside = []
    before = memory_in_use()
    burnish.solve(problem, iterations=1, evaluation_spp=2, estimator="mc", callback=lambda i: inside.append(memory_in_use()))
    own = inside[0] - before - len(views) * picture.nbytes  # without the images of the start
    assert own < 1.5 * len(views) * picture.nbytes, own


def test_what_knows_itself_through_its_loss_is_collected(renderer, target):
    class Trainer:
        def __init__(self):
            self.problem = burnish.Problem(renderer, target, burnish.Unknown(NAME, 0.5), self.loss)

        def loss(self, image, view):
            return 0.0, image * 0

    class OwnProblem(burnish.Problem):
        def __init__(self):
            super().__init__(renderer, target, burnish.Unknown(NAME, 0.5), self.loss)

        def loss(self, image, view):
            return 0.0, image * 0

    class OwnSolver(burnish.Solver):
        def __init__(self):
            super().__init__(burnish.Problem(renderer, target, burnish.Unknown(NAME, 0.5), self.loss))

        def loss(self, image, view):
            return 0.0, image * 0

    def made():
        trainer, problem, solver = Trainer(), OwnProblem(), OwnSolver()
        trainer.solver = burnish.Solver(trainer.problem)
        trainer.last = trainer.solver.step()
        problem.solver = burnish.Solver(problem)
        solver.last = solver.step()
        burnish.solve(trainer.problem, iterations=1)
        return [weakref.ref(x) for x in (trainer, problem, solver)]

    known = made()
    gc.collect()
    assert [x() for x in known] == [None, None, None]


def test_nothing_is_left_at_the_end_of_the_guides_loss(scene):
    done = run("""
        import burnish, sys
        renderer = burnish.load(sys.argv[1], size=(16, 16))
        target = renderer.render(spp=1)
        def loss(image, view):
            return 0.0, image - target
        problem = burnish.Problem(renderer, target, "mat-goblet.roughness", loss)
        solver = burnish.Solver(problem)
        solver.step()
    """, scene)
    assert done.returncode == 0 and not done.stderr, done.stderr


def test_what_a_daemon_holds_at_the_end_is_told_where_leaks_are_looked_for_alone(scene):
    code = """
        import burnish, sys, threading, time
        ready = threading.Event()
        def work():
            renderer = burnish.load(sys.argv[1], size=(16, 16))
            ready.set()
            time.sleep(1000)
        threading.Thread(target=work, daemon=True).start()
        assert ready.wait(250)
    """
    for environment, is_told in [({}, False), ({"BURNISH_LEAK_WARNINGS": "1"}, True)]:
        own = {name: value for name, value in os.environ.items() if name != "BURNISH_LEAK_WARNINGS"}
        done = run(code, scene, env=own | environment)
        assert done.returncode == 0 and ("leaked" in done.stderr if is_told else not done.stderr), done.stderr


def test_pictures_keep_no_memory(renderer):
    """oneTBB keeps some 8 KB for each thread that has ever worked with it: calls share their threads."""
    def resident():
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")

    for _ in range(300):
        renderer.render(spp=1)
    threads, sizes = len(os.listdir("/proc/self/task")), [resident()]
    for _ in range(2):
        for _ in range(1000):
            renderer.render(spp=1)
        sizes.append(resident())
    assert min(sizes[1] - sizes[0], sizes[2] - sizes[1]) < 2e6, f"{sizes} bytes"
    assert len(os.listdir("/proc/self/task")) <= threads


def test_solvers_come_and_go(renderer, target):
    """Memory and threads do not grow, one solver in ten with a loss that knows its solver.

    BURNISH_MANY_SOLVERS says how many, twice; some 30 ms each. A leak grows in both batches, what a thread keeps for itself
    in one. A leak of one picture for each solver (12 KB) shows from two hundred on.
    """
    count = int(os.environ.get("BURNISH_MANY_SOLVERS", "250"))
    problem = burnish.Problem(renderer, target, burnish.Unknown(NAME, 0.5))

    def make(count):
        for k in range(count):
            solver = burnish.Solver(problem, pyramid_levels=1)
            if k % 20 == 0:
                solver.step()
            if k % 10 == 0:
                def loss(image, view):
                    return float(len(solver.textures)), image

                solver = burnish.Solver(burnish.Problem(renderer, target, burnish.Unknown(NAME, 0.5), loss))
        solver = None
        gc.collect()

    make(100)
    sizes, threads = [memory_in_use()], len(os.listdir("/proc/self/task"))
    for _ in range(2):
        make(count)
        sizes.append(memory_in_use())
    deadline = time.monotonic() + 60
    while len(os.listdir("/proc/self/task")) > threads + 2 and time.monotonic() < deadline:
        time.sleep(0.1)  # threads end by themselves
    growth = min(sizes[1] - sizes[0], sizes[2] - sizes[1])
    assert growth < 2e6 + 400 * count, f"{sizes} bytes"
    assert len(os.listdir("/proc/self/task")) <= threads + 2

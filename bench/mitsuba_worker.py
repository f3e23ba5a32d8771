"""Mitsuba's side of bench/benchmarks.py and bench/compare_mitsuba.py: one process per scene, its memory its own.

Reads one JSON request per line from standard input and answers each with one line of JSON. Runs in the virtual
environment that compare_mitsuba.py makes.
"""
import json
import resource
import sys
import time

import drjit as dr
import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")

import mitsuba_scene


def timed(work):
    dr.sync_thread()
    start = time.perf_counter()
    result = work()
    dr.sync_thread()
    return time.perf_counter() - start, result


def reasons(error):
    """The messages of an error and of what caused it."""
    messages = []
    while error is not None:
        messages.append(str(error).strip())
        error = error.__cause__ or error.__context__
    return "; ".join(messages)


def peak_memory():
    """GB, so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024**2


def constant(shape, value):
    """As data: kernels for a literal would have to be compiled once more for other values."""
    return mi.TensorXf(np.full(shape, value, np.float32))


class OptimisationRun:
    """Adam from 0.5 everywhere."""

    WARM = 5  # iterations: a frozen function records anew until the optimiser's state has its final form

    def __init__(self, worker, spp, spp_grad, rate, frozen):
        self.worker, self.rate = worker, rate
        parameter, integrator = worker.parameter, worker.detached

        # All that changes is an argument: a frozen function sees nothing else.
        def step(scene, optimizer, target, seed):
            params = mi.traverse(scene)
            params.keep([parameter])
            params.update(optimizer)
            # The seed of the derivative follows from that of the image.
            rendered = mi.render(scene, params, spp=spp, spp_grad=spp_grad, seed=seed, integrator=integrator)
            loss = mitsuba_scene.rel_mse(rendered, target)
            dr.backward(loss)
            optimizer.step()
            optimizer[parameter] = dr.clip(dr.detach(optimizer[parameter]), 0, 1)
            return loss

        self.step = dr.freeze(step) if frozen else step
        self.restart()

    def restart(self):
        self.worker.reset()
        self.optimizer = mi.ad.Adam(lr=self.rate)
        # Not the scene's own variable: for one that it holds already an update compares values, which cannot be frozen.
        self.optimizer[self.worker.parameter] = self.worker.half()

    def texture(self):
        return self.optimizer[self.worker.parameter]

    def iterate(self):
        seed = mi.UInt32(self.worker.next_seed())
        dr.eval(self.step(self.worker.scene, self.optimizer, self.worker.target, seed), self.texture())

    def warm_up(self):
        """(seconds of compilation, seconds of an iteration after it)"""
        seconds = [timed(self.iterate)[0] for _ in range(self.WARM)]
        steady = min(seconds[-2:])
        return sum(seconds) - self.WARM * steady, steady


class Worker:
    def __init__(self, scene_file, parameter, width, height, definitions):
        self.scene = mitsuba_scene.load(scene_file, [parameter], {"resx": width, "resy": height} | definitions)
        self.parameter = parameter
        self.params = mi.traverse(self.scene)
        self.shape = self.params[parameter].shape
        self.detached = mi.load_dict({"type": "prb", "max_depth": 2})
        self.attached = mi.load_dict({"type": "direct"})
        self.seed = 0
        self.reset()
        self.adjoint = constant((height, width, 3), 1e-4)
        self.compile_seconds = {}
        self.runs = {}  # warm ones
        self.frozen = False  # until the first time of an iteration says whether freezing helps
        self.target = constant((height, width, 3), 0.5)

    def compile(self):
        """The kernels of the stages, in a cold process."""
        # The first call of each kernel compiles it; the faster of the two integrators stands for Mitsuba's derivative.
        first, _ = timed(lambda: self.image(32))
        self.compile_seconds["image"] = first - timed(lambda: self.image(32))[0]
        seconds = {}
        for name in ("detached", "attached"):
            first, _ = timed(lambda: self.derivative(name, 1))
            seconds[name] = min(timed(lambda: self.derivative(name, 1))[0] for _ in range(2))
            self.compile_seconds[f"derivative ({name})"] = first - seconds[name]
        self.best = min(seconds, key=seconds.get)

    def half(self):
        """A texture to start from."""
        return constant(self.shape, 0.5)

    def reset(self):
        self.params[self.parameter] = self.half()
        self.params.update()

    def next_seed(self):
        self.seed += 1
        return self.seed

    def image(self, spp):
        dr.eval(mi.render(self.scene, spp=spp, seed=self.next_seed(), integrator=self.attached))

    def derivative(self, integrator, spp):
        texture = dr.detach(self.params[self.parameter], True)
        dr.enable_grad(texture)
        self.params[self.parameter] = texture
        self.params.update()
        getattr(self, integrator).render_backward(self.scene, self.params, self.adjoint, spp=spp, seed=self.next_seed())
        gradient = dr.grad(texture)
        dr.eval(gradient)
        return gradient

    # ---- Requests

    def time(self, what, spp=32, spp_grad=1):
        """The second of two in a row: the first meets caches that another process used, or kernels to compile."""
        if what == "iteration" and not hasattr(self, "steady"):
            self.steady = self.fastest_run(spp, spp_grad, 0.01)
        work = {"image": lambda: self.image(spp), "derivative": lambda: self.derivative(self.best, spp_grad),
                "detached derivative": lambda: self.derivative("detached", spp_grad),
                "iteration": lambda: self.steady.iterate()}[what]
        timed(work)
        return timed(work)[0]

    def fastest_run(self, spp, spp_grad, rate):
        """With and without kernel freezing, whichever is faster; both warm."""
        best = None
        for frozen in (True, False):
            try:
                run = OptimisationRun(self, spp, spp_grad, rate, frozen)
                compile_seconds, steady = run.warm_up()
            except Exception as error:  # freezing does not know every operation
                self.freezing_error = reasons(error)
                continue
            self.compile_seconds.setdefault("iteration", compile_seconds)  # the second way finds the kernels compiled
            if best is None or steady < best[0]:
                best = (steady, run, frozen)
        self.frozen = best[2]
        return best[1]

    def optimise(self, spp, spp_grad, rate, moments, target, folder):
        """A run; seconds of iterations, JIT compilation apart. Writes the texture at each moment: the first at or
        after it."""
        self.target = mi.TensorXf(mitsuba_scene.read_image(target))
        key = (spp, spp_grad, rate)
        if key not in self.runs:
            run = OptimisationRun(self, spp, spp_grad, rate, self.frozen)
            self.runs[key] = (run, run.warm_up()[0])
        run, compile_seconds = self.runs[key]
        run.restart()
        spent, written = [], []
        while len(written) < len(moments):
            spent.append(timed(run.iterate)[0])
            while len(written) < len(moments) and sum(spent) >= moments[len(written)]:
                path = f"{folder}/{len(written)}.exr"
                mitsuba_scene.write_image(path, np.array(run.texture()).reshape(self.shape))
                written.append({"seconds": sum(spent), "iterations": len(spent), "texture": path})
        return {"moments": written, "iteration_s": float(np.median(spent)), "compile_s": compile_seconds}

    def derivatives(self, texture, adjoint, seconds, count, folder):
        """`count` independent detached derivatives, as files, for a texture and an adjoint image; each with the most
        samples per pixel that take no longer than `seconds`, at least one."""
        self.params[self.parameter] = mi.TensorXf(mitsuba_scene.read_image(texture))
        self.params.update()
        self.adjoint = mi.TensorXf(mitsuba_scene.read_image(adjoint))

        def take(spp):
            return timed(lambda: self.derivative("detached", spp))

        cost = {}
        for spp in (1, 5):
            take(spp)
            cost[spp] = float(np.median([take(spp)[0] for _ in range(3)]))
        each = max((cost[5] - cost[1]) / 4, 1e-9)
        spp = max(1, int(1 + (seconds - cost[1]) / each))
        take(spp)
        spent, files = [], []
        for k in range(count):
            s, g = take(spp)
            spent.append(s)
            files.append(f"{folder}/{k}.exr")
            mitsuba_scene.write_image(files[-1], np.array(g).reshape(self.shape))
        return {"spp": spp, "seconds": spent, "files": files}

    def about(self):
        return {"compile_s": self.compile_seconds, "frozen": self.frozen,
                "freezing_error": getattr(self, "freezing_error", None)}

    def memory(self, spp, spp_grad, frozen):
        """GB at most, of a process that has done nothing but this run."""
        OptimisationRun(self, spp, spp_grad, 0.01, frozen).warm_up()
        return peak_memory()


def main():
    scene_file, parameter, width, height, definitions = sys.argv[1:]
    worker = Worker(scene_file, parameter, int(width), int(height), json.loads(definitions))
    print(json.dumps("ready"), flush=True)
    for line in sys.stdin:
        request = json.loads(line)
        print(json.dumps(getattr(worker, request.pop("request"))(**request)), flush=True)


if __name__ == "__main__":
    main()

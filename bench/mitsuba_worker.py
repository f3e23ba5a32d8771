"""Mitsuba's side of bench/compare_mitsuba.py: one process per scene, so that its memory is its own.

Reads one JSON request per line from standard input and answers each with one line of JSON. Runs in the virtual
environment that compare_mitsuba.py makes.
"""
import json
import re
import resource
import sys
import time
from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")


def differentiable_scene(scene_file, parameter):
    """The scene's text with the optimised texture stored as floats (8-bit storage has no gradient), paths absolute."""
    text = Path(scene_file).read_text()
    folder = Path(scene_file).resolve().parent
    text = re.sub(r'(name="filename"\s+value=")(?!/)', lambda m: m.group(1) + str(folder) + "/", text)
    bsdf, name = parameter.split(".")[0], parameter.split(".")[-2]
    at = text.index(f'name="{name}"', text.index(f'id="{bsdf}"'))
    end = text.index("</texture>", at)
    return text[:end] + '<string name="format" value="variant"/>' + text[end:]


def timed(work):
    dr.sync_thread()
    start = time.perf_counter()
    result = work()
    dr.sync_thread()
    return time.perf_counter() - start, result


def read_image(path):
    return np.array(mi.Bitmap(str(path)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32))


def peak_memory():
    """GB, so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024**2


def nmse(a, b):
    return float(np.sum((a - b) ** 2) / np.sum(b ** 2))


class Worker:
    def __init__(self, scene_file, parameter, width, height, definitions):
        self.scene = mi.load_string(differentiable_scene(scene_file, parameter), resx=width, resy=height, **definitions)
        self.parameter = parameter
        self.params = mi.traverse(self.scene)
        self.shape = self.params[parameter].shape
        self.detached = mi.load_dict({"type": "prb", "max_depth": 2})
        self.attached = mi.load_dict({"type": "direct"})
        self.seed = 0
        self.reset()
        self.adjoint = dr.full(mi.TensorXf, 1e-4, (height, width, 3))
        self.compile_seconds = {}
        self.target = dr.full(mi.TensorXf, 0.5, (height, width, 3))
        # The first call of each kernel compiles it; the faster of the two integrators stands for Mitsuba's derivative.
        first, _ = timed(lambda: self.image(32))
        self.compile_seconds["image"] = first - timed(lambda: self.image(32))[0]
        seconds = {}
        for name in ("detached", "attached"):
            first, _ = timed(lambda: self.derivative(name, 1))
            seconds[name] = min(timed(lambda: self.derivative(name, 1))[0] for _ in range(2))
            self.compile_seconds[f"derivative ({name})"] = first - seconds[name]
        self.best = min(seconds, key=seconds.get)

    def reset(self):
        self.params[self.parameter] = dr.full(type(self.params[self.parameter]), 0.5, self.shape)
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

    def descent(self, spp, spp_grad, rate, frozen):
        """A function that makes one iteration; starts from 0.5."""
        self.reset()
        optimizer = mi.ad.Adam(lr=rate)
        optimizer[self.parameter] = self.params[self.parameter]
        self.params.update(optimizer)

        # All that changes is an argument: a frozen function sees nothing else.
        def step(scene, optimizer, target, seed):
            params = mi.traverse(scene)
            params.keep([self.parameter])
            params.update(optimizer)
            # The seed of the derivative follows from that of the image.
            rendered = mi.render(scene, params, spp=spp, spp_grad=spp_grad, seed=seed,
                                 integrator=self.detached)
            loss = dr.mean(dr.square(rendered - target) / (dr.square(target) + 0.01), axis=None)
            dr.backward(loss)
            optimizer.step()
            optimizer[self.parameter] = dr.clip(dr.detach(optimizer[self.parameter]), 0, 1)
            return loss

        work = dr.freeze(step) if frozen else step

        def iterate():
            loss = work(self.scene, optimizer, self.target, mi.UInt32(self.next_seed()))
            dr.eval(loss, optimizer[self.parameter])

        return iterate, optimizer

    # ---- Requests

    def time(self, what, spp=32, spp_grad=1):
        if what == "image":
            return timed(lambda: self.image(spp))[0]
        if what == "derivative":
            return timed(lambda: self.derivative(self.best, spp_grad))[0]
        if not hasattr(self, "steady"):
            self.steady = self.fastest_descent(spp, spp_grad, 0.01)
        return timed(self.steady)[0]

    def fastest_descent(self, spp, spp_grad, rate):
        """With and without kernel freezing, whichever is faster; both warm."""
        best = None
        for frozen in (False, True):
            try:
                iterate, _ = self.descent(spp, spp_grad, rate, frozen)
                first = timed(iterate)[0]
                timed(iterate)
                steady = min(timed(iterate)[0] for _ in range(3))
            except Exception as error:  # freezing does not know every operation
                print(f"mitsuba_worker: without kernel freezing: {error}", file=sys.stderr)
                continue
            if best is None or steady < best[0]:
                best = (steady, iterate, frozen)
                self.peak = peak_memory()  # not what trying the other way takes
                self.compile_seconds["iteration"] = first - steady
        self.frozen = best[2]
        return best[1]

    def descend(self, spp, spp_grad, rate, moments, target, folder):
        """A descent; seconds of iterations, JIT compilation of the first ones apart. Writes the texture at each moment."""
        self.target = mi.TensorXf(read_image(target))
        iterate, _ = self.descent(spp, spp_grad, rate, getattr(self, "frozen", False))
        warm = [timed(iterate)[0] for _ in range(3)]
        iterate, optimizer = self.descent(spp, spp_grad, rate, getattr(self, "frozen", False))
        # A frozen function is new: it records once more, which is not counted either.
        seconds, iterations, written = 0.0, 0, []
        first = True
        while len(written) < len(moments):
            s, _ = timed(iterate)
            iterations += 1
            seconds += min(s, warm[-1]) if first else s
            first = False
            while len(written) < len(moments) and seconds >= moments[len(written)]:
                path = f"{folder}/texture_{len(written)}.exr"
                texels = np.array(optimizer[self.parameter])
                mi.Bitmap(texels.reshape(self.shape)).write(path)
                written.append({"seconds": seconds, "iterations": iterations, "texture": path})
        return {"moments": written, "compile": warm[0] - warm[-1]}

    def gradient(self, adjoint, spp, count, folder):
        """`count` independent derivatives at 0.5 for an adjoint image, as files, and their median seconds."""
        self.reset()
        self.adjoint = mi.TensorXf(read_image(adjoint))
        seconds, files = [], []
        timed(lambda: self.derivative("detached", spp))
        for k in range(count):
            s, g = timed(lambda: self.derivative("detached", spp))
            seconds.append(s)
            files.append(f"{folder}/mitsuba_gradient_{k}.npy")
            np.save(files[-1], np.array(g).reshape(self.shape))
        return {"seconds": sorted(seconds)[count // 2], "files": files}

    def compile(self):
        return self.compile_seconds

    def frozen_kernels(self):
        return getattr(self, "frozen", False)

    def memory(self):
        return self.peak


# ---- The judge: the same for both renderers


def relmse(image, target):
    a, b = read_image(image), read_image(target)
    return float(np.mean((a - b) ** 2 / (b**2 + 0.01)))


def write_adjoint(image, target, path):
    a, b = read_image(image), read_image(target)
    mi.Bitmap((2 * (a - b) / (b**2 + 0.01) / a.size).astype(np.float32)).write(path)


def texels(path):
    if path.endswith(".npy"):
        return np.load(path)
    bitmap = mi.Bitmap(path)
    values = np.array(bitmap.convert(component_format=mi.Struct.Type.Float32))
    return values[..., None] if values.ndim == 2 else values


def errors(files, reference):
    b = texels(reference)
    return [nmse(texels(f), b) for f in files]


def main():
    scene_file, parameter, width, height, definitions = sys.argv[1:]
    worker = Worker(scene_file, parameter, int(width), int(height), json.loads(definitions))
    judge = {"relmse": relmse, "write_adjoint": write_adjoint, "errors": errors}
    print(json.dumps("ready"), flush=True)
    for line in sys.stdin:
        request = json.loads(line)
        name = request.pop("request")
        answer = judge[name](**request) if name in judge else getattr(worker, name)(**request)
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    main()

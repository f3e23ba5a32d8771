#!/usr/bin/env python3
"""Recovers the texture of a capture with Mitsuba 3, beside `burnish optimize`: the same pictures, start and pyramid.

    bench/views_in_mitsuba.py CAPTURE.json START -o FOLDER --seconds 120

START is a folder with PARAMETER.exr: `burnish optimize CAPTURE.json --parameter NAME --iterations 1 --learning-rate
1e-9` writes what Burnish starts from. `prb` renders one view an iteration, the views in turn; Adam moves a pyramid of
five levels, whose sum is clamped to [0, 1], down the relMSE of Burnish. The split of samples between image and
derivative, and the learning rate, are those with the lowest loss after an eighth of the time. Seconds are those of
iterations alone: kernels are compiled before. Writes FOLDER/textures/PARAMETER.exr for bench/held_out.py, and
FOLDER/run.json.
"""
import argparse
import itertools
import json
import time
from pathlib import Path

from held_out import group_of
from mitsuba_python import go_on_with_mitsuba

LEVELS = 5
# Samples per pixel of the image and of the derivative; multijitter samplers round others up.
SPLITS = ((36, 1), (9, 4), (4, 4), (2, 2))
GPU_SPLITS = SPLITS + ((64, 16), (256, 64))
RATES = (0.005, 0.001667)  # decisions 045 and 058
CHECK_SPP = 16


def level_sizes(height, width):
    """[level]: texel (x, y) is in (x >> level, y >> level)."""
    return [(((height - 1) >> k) + 1, ((width - 1) >> k) + 1) for k in range(LEVELS)]


class Pyramid:
    """start + a sum of levels, each half as wide as the one before, rounded up."""

    def __init__(self, start):
        self.start, self.shape = mi.TensorXf(start), start.shape
        height, width, channels = start.shape
        y, x, c = np.meshgrid(*(np.arange(n, dtype=np.uint32) for n in start.shape), indexing="ij")
        self.zeros, self.from_level = [], []
        for k, (rows, columns) in enumerate(level_sizes(height, width)):
            size = (rows, columns, channels)
            self.zeros.append(np.zeros(size, np.float32))
            self.from_level.append(mi.UInt32((((y >> k) * columns + (x >> k)) * channels + c).ravel()))

    def texture(self, levels):
        total = self.start.array
        for level, index in zip(levels, self.from_level):
            total = total + dr.gather(mi.Float, level.array, index)
        return mi.TensorXf(dr.clip(total, 0, 1), self.shape)


class Run:
    def __init__(self, problem, split, rate):
        self.problem, self.split, self.rate = problem, split, rate
        self.restart()

    def restart(self):
        self.count, self.adam = 0, mi.ad.Adam(lr=self.rate)
        for k, level in enumerate(self.problem.pyramid.zeros):
            self.adam[str(k)] = mi.TensorXf(level)

    def levels(self):
        return [self.adam[str(k)] for k in range(LEVELS)]

    def texture(self):
        return self.problem.pyramid.texture(self.levels())

    def iterate(self):
        p = self.problem
        view = self.count % len(p.sensors)
        p.params[p.parameter] = self.texture()
        p.params.update()
        image = mi.render(p.scene, p.params, sensor=p.sensors[view], integrator=p.integrator, spp=self.split[0],
                          spp_grad=self.split[1], seed=self.count)
        dr.backward(mitsuba_scene.rel_mse(image, p.targets[view]))
        self.adam.step()
        dr.eval(self.levels())
        dr.sync_thread()
        self.count += 1

    def iterate_for(self, seconds):
        for _ in range(len(self.problem.sensors)):  # compiles
            self.iterate()
        self.restart()
        begin = time.perf_counter()
        while time.perf_counter() - begin < seconds:
            self.iterate()
        return {"split": self.split, "rate": self.rate, "iterations": self.count,
                "seconds": time.perf_counter() - begin, "loss": self.problem.loss(self.texture())}


class Problem:
    def __init__(self, file, start):
        capture = json.loads(file.read_text())
        self.parameter, = json.loads((file.parent / "made.json").read_text())["parameters"]
        views = [v for v in capture["views"] if group_of(v) == "fitted"]
        self.scene = mitsuba_scene.load(file.parent / capture["scene"], [self.parameter], capture.get("defines"))
        self.sensors = [mitsuba_scene.sensor_of(self.scene, v) for v in views]
        self.targets = [mi.TensorXf(mitsuba_scene.read_image(file.parent / v["image"])[..., :3]) for v in views]
        self.params = mi.traverse(self.scene)
        self.params.keep([self.parameter])
        self.integrator = mi.load_dict({"type": "prb", "max_depth": 2})
        self.pyramid = Pyramid(mitsuba_scene.read_image(start / f"{self.parameter}.exr"))

    def loss(self, texture):
        """The mean over the views, with the noise of the images."""
        self.params[self.parameter] = dr.detach(texture)
        self.params.update()
        images = (mi.render(self.scene, sensor=s, integrator=self.integrator, spp=CHECK_SPP, seed=10**6 + k)
                  for k, s in enumerate(self.sensors))
        return float(np.mean([mitsuba_scene.rel_mse(i, t).array[0] for i, t in zip(images, self.targets)]))


def arguments_of():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("capture", type=Path, metavar="CAPTURE.json")
    parser.add_argument("start", type=Path, metavar="START")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER")
    parser.add_argument("--seconds", type=float, default=120)
    parser.add_argument("--variant", default="llvm_ad_rgb", choices=("llvm_ad_rgb", "cuda_ad_rgb"))
    return parser.parse_args()


def main(arguments):
    problem = Problem(arguments.capture, arguments.start)
    trials = []
    for split, rate in itertools.product(GPU_SPLITS if arguments.variant == "cuda_ad_rgb" else SPLITS, RATES):
        trials.append(Run(problem, split, rate).iterate_for(arguments.seconds / 8))
        print(json.dumps(trials[-1]), flush=True)
    best = min(trials, key=lambda t: t["loss"])
    run = Run(problem, best["split"], best["rate"])
    found = run.iterate_for(arguments.seconds)
    texture = np.array(run.texture()).reshape(problem.pyramid.shape)
    mitsuba_scene.write_image(arguments.output / "textures" / f"{problem.parameter}.exr", texture)
    (arguments.output / "run.json").write_text(json.dumps(found | {"trials": trials}, indent=1) + "\n")
    print(json.dumps(found))


if __name__ == "__main__":
    go_on_with_mitsuba()
    import drjit as dr
    import mitsuba as mi
    import numpy as np

    given = arguments_of()
    mi.set_variant(given.variant)
    import mitsuba_scene

    main(given)

#!/usr/bin/env python3
"""Makes the reference gradients of tests/data/blends by Mitsuba 3: means of 16 runs and their standard errors.

    tests/scenes/blend_gradients.py

To be run by a Python that has `mitsuba`, for its variant llvm_ad_rgb. Not run by the tests, which read what it has made.
"""
from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np

FOLDER = Path(__file__).resolve().parents[1] / "data" / "blends"
RUNS, SPP = 16, 2048
SCENES = {"direct": {"max_depth": 2}, "path": {"max_depth": 4, "rr_depth": 100}}


def write(name, values):
    mi.Bitmap(np.asarray(values, np.float32)).write(str(FOLDER / f"{name}.exr"))


def main():
    mi.set_variant("llvm_ad_rgb")
    random = np.random.default_rng(3)
    write("weight", random.uniform(0.15, 0.85, (8, 8, 1)))
    adjoint = random.uniform(0, 1, (32, 32, 3)).astype(np.float32)
    write("adjoint", adjoint)
    scene = mi.load_file(str(FOLDER / "scene.xml"))
    for name, options in SCENES.items():
        integrator = mi.load_dict({"type": "prb", **options})
        parameters = mi.traverse(scene)
        key = "two.brdf_0.weight.data"
        runs = []
        for seed in range(RUNS):
            dr.enable_grad(parameters[key])
            parameters.update()
            image = mi.render(scene, parameters, integrator=integrator, spp=SPP, spp_grad=SPP, seed=2 * seed,
                              seed_grad=2 * seed + 1)
            dr.backward(dr.sum(mi.TensorXf(adjoint) * image, axis=None))
            runs.append(np.array(dr.grad(parameters[key])).reshape(8, 8, 1))
            dr.set_grad(parameters[key], 0)
        write(f"{name}_d_weight", np.mean(runs, 0))
        write(f"{name}_d_weight_stderr", np.std(runs, 0, ddof=1) / RUNS**0.5)


if __name__ == "__main__":
    main()

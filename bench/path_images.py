#!/usr/bin/env python3
"""Seconds of an image with light that bounces: Mitsuba 3 (llvm_ad_rgb) and Burnish, alternating in one process.

    bench/path_images.py SCENE.xml... [--size 350 350] [--spp 64] [--runs 5]

Prints Mitsuba / Burnish for each scene, in seconds and in seconds of all processors: the median over the runs with the
smallest and the largest in brackets. Above 1 Burnish is faster. The kernels of Mitsuba are compiled before. Needs
numpy, mitsuba and the Python package of Burnish (build/release/python); BURNISH_MITSUBA_PYTHON names an interpreter.
"""
import argparse
import statistics
import sys
import time
from pathlib import Path

from mitsuba_python import ROOT, go_on_with_mitsuba

go_on_with_mitsuba()
sys.path.insert(0, str(ROOT / "build" / "release" / "python"))

import drjit as dr
import mitsuba as mi

import burnish

mi.set_variant("llvm_ad_rgb")


def timed(work):
    """(seconds, seconds of all processors)"""
    start, start_of_all = time.perf_counter(), time.process_time()
    work()
    return time.perf_counter() - start, time.process_time() - start_of_all


class Mitsuba:
    def __init__(self, scene, size, spp):
        self.scene = mi.load_file(str(scene))
        sensor = self.scene.sensors()[0]
        parameters = mi.traverse(sensor)
        parameters["film.size"] = list(size)
        parameters["film.crop_size"] = list(size)
        parameters.update()
        self.spp, self.seed = spp, 0

    def image(self):
        self.seed += 1
        dr.eval(mi.render(self.scene, spp=self.spp, seed=mi.UInt32(self.seed)))
        dr.sync_thread()


class Burnish:
    def __init__(self, scene, size, spp):
        self.renderer = burnish.load(str(scene), size=tuple(size))
        self.spp, self.seed = spp, 0

    def image(self):
        self.seed += 1
        self.renderer.render(spp=self.spp, seed=self.seed)


def spread(ratios):
    return f"{statistics.median(ratios):.2f} [{min(ratios):.2f}, {max(ratios):.2f}]"


def compare(scene, arguments):
    sides = [side(scene, arguments.size, arguments.spp) for side in (Mitsuba, Burnish)]
    for side in sides:
        side.image()
    runs = [[timed(side.image) for side in sides] for _ in range(arguments.runs)]
    seconds, of_all = ([mitsuba[i] / ours[i] for mitsuba, ours in runs] for i in range(2))
    ours = statistics.median(run[1][0] for run in runs)
    print(f"| {scene.stem} | {ours:.2f} | {spread(seconds)} | {spread(of_all)} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", type=Path, nargs="+", metavar="SCENE.xml")
    parser.add_argument("--size", type=int, nargs=2, default=(350, 350))
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--runs", type=int, default=5)
    arguments = parser.parse_args()
    print("| scene | seconds | Mitsuba / Burnish | of processors |\n| --- | --- | --- | --- |")
    for scene in arguments.scenes:
        compare(scene, arguments)


if __name__ == "__main__":
    main()

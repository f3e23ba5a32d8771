#!/usr/bin/env python3
"""Noise and time of the ways to choose a light, relative to the uniform choice, as a table in Markdown.

    bench/light_selection.py BURNISH SCENE.xml... [--size 128] [--spp 16] [--seeds 8] [--reference 512] [--repeats 5] [-D k=v]

Error: mean over pixels and channels of (I - R)^2 / (R^2 + 0.01), R the mean of images of all four ways. Time: that of the
processors for the samples alone: the difference of two runs with other numbers of samples, in turns, the median of the
repeats. Efficiency: 1 / (error * time).
"""
import argparse
import resource
import statistics
import subprocess
import tempfile
from pathlib import Path

import numpy

WAYS = ("uniform", "resampled", "power", "tree")


def read_pfm(file):
    data = file.read_bytes()
    kind, size, _, values = data.split(b"\n", 3)
    assert kind == b"PF"
    width, height = map(int, size.split())
    return numpy.frombuffer(values, "<f4").reshape(height, width, 3).astype(float)


class Renderer:
    def __init__(self, options, scene, folder):
        self.command = [options.burnish, "render", scene, "--size", options.size, options.size]
        self.command += [part for definition in options.definitions for part in ("-D", definition)]
        self.file = folder / "image.pfm"

    def run(self, way, samples, seed):
        """The image, and the seconds of all processors."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        command = [*self.command, "--light-selection", way, "--spp", samples, "--seed", seed, "-o", self.file]
        subprocess.run(list(map(str, command)), check=True, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        return read_pfm(self.file), resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def errors(renderer, options):
    reference = sum(renderer.run(way, options.reference, 1000 + i)[0] for i, way in enumerate(WAYS)) / len(WAYS)

    def error(way):
        images = [renderer.run(way, options.spp, seed)[0] for seed in range(options.seeds)]
        return statistics.mean(((image - reference) ** 2 / (reference ** 2 + 0.01)).mean() for image in images)

    return {way: error(way) for way in WAYS}


def ratios_of_time(renderer, options):
    ratios = {way: [] for way in WAYS}
    samples = 8 * options.spp
    for repeat in range(options.repeats):
        seconds = {way: renderer.run(way, samples, repeat)[1] - renderer.run(way, 1, repeat)[1] for way in WAYS}
        for way in WAYS:
            ratios[way].append(seconds[way] / seconds["uniform"])
    return {way: statistics.median(values) for way, values in ratios.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("burnish")
    parser.add_argument("scenes", nargs="+")
    parser.add_argument("-D", dest="definitions", action="append", default=[])
    for name, value in (("size", 128), ("spp", 16), ("seeds", 8), ("reference", 512), ("repeats", 5)):
        parser.add_argument("--" + name, type=int, default=value)
    options = parser.parse_args()
    print("| scene | " + " | ".join(f"{what}, {way}" for way in WAYS[1:] for what in ("error", "time", "efficiency")) + " |")
    print("| --- |" + " --- |" * (3 * (len(WAYS) - 1)))
    with tempfile.TemporaryDirectory() as folder:
        for scene in options.scenes:
            renderer = Renderer(options, scene, Path(folder))
            error, time = errors(renderer, options), ratios_of_time(renderer, options)
            cells = []
            for way in WAYS[1:]:
                e = error[way] / error["uniform"]
                cells += [f"{e:.3g}", f"{time[way]:.3g}", f"{1 / (e * time[way]):.3g}"]
            print(f"| {Path(scene).parent.name} | " + " | ".join(cells) + " |", flush=True)


main()

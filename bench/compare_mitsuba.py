#!/usr/bin/env python3
"""Mitsuba 3 (llvm_ad_rgb) and Burnish on the same scenes, alternating in one run on the same cores.

    bench/compare_mitsuba.py SCENES_DIR                        seconds of the stages, peak memory
    bench/compare_mitsuba.py SCENES_DIR --runs 6               also derivative error and loss at equal time
    bench/compare_mitsuba.py SCENES_DIR --runs 6 --estimators pgris:identity pgris:replay mc

SCENES_DIR holds NAME/scene.xml of the published scenes; the built-in ones (goblet, tyre, bowl, tree) are made on the
way. Mitsuba comes from PyPI into its own virtual environment (build/mitsuba) on the first run; Burnish is built into
build/bench.

Stages: seconds of a 32-spp image, of a 1-spp derivative, of a whole iteration (image, loss, derivative, Adam), and peak
memory. With --runs: the error of the derivative after 20 iterations of pgris, at equal time of that stage, of Mitsuba
with `prb`, whose sampling is detached, as Burnish's; the loss after so many seconds of iterations, for both with their
best split of image and derivative samples (32+1, 8+4, 4+4 or 2+2), the same loss, learning rate, target and starting
texture; and the seconds that each needs to reach the larger of the two losses. Textures of both are evaluated by
Burnish with samples of their own, derivatives against a converged one.

Every split runs in the first repeat, the best one of each side in the others. Ratios are Mitsuba / Burnish: above 1
Burnish is better; the median over the repeats with the smallest and the largest in brackets. JIT compilation is
reported apart and counted where the row says so. Kernel freezing is used where it makes Mitsuba faster.

--step says what is done: `prepare` makes targets, `measure` is what needs the machine for itself, `evaluate` evaluates
what was found and prints the table. They meet in --folder.
"""
import argparse
import json
import sys
import tempfile
from pathlib import Path

import compare_report
from compare_sides import SCENES, Comparison, build
from mitsuba_python import ENVIRONMENT, make_environment

STEPS = ("prepare", "measure", "evaluate")


def arguments_of():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", type=Path, metavar="SCENES_DIR")
    parser.add_argument("--scenes", dest="names", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--size", type=int, nargs=2, default=(350, 350))
    parser.add_argument("--runs", type=float, metavar="SECONDS", help="also compare runs of so many seconds")
    parser.add_argument("--estimators", nargs="+", default=["pgris:identity"], metavar="NAME[:SHIFT]",
                        help="of Burnish, in the rows on derivatives and runs")
    parser.add_argument("--markdown", type=Path, help="also write the rows of all scenes as tables")
    parser.add_argument("--folder", type=Path, help="where all that is made stays")
    parser.add_argument("--step", nargs="+", choices=STEPS, default=STEPS)
    return parser.parse_args()


def main():
    arguments = arguments_of()
    if arguments.folder is None and set(arguments.step) != set(STEPS):
        sys.exit("compare_mitsuba: --step without --folder: the steps would not find what the others made")
    if "prepare" in arguments.step:
        make_environment()
        build("burnish_stages", "burnish_beside", "burnish_program")
    evaluated = []
    with tempfile.TemporaryDirectory() as temporary:
        for name in arguments.names:
            folder = arguments.folder or Path(temporary)
            comparison = Comparison(name, arguments, folder, ENVIRONMENT / "bin" / "python")
            for step in STEPS:
                if step in arguments.step:
                    getattr(comparison, step)()
            if "evaluate" in arguments.step:
                evaluated.append(json.loads(comparison.results_file.read_text()))
                compare_report.print_scene(evaluated[-1])
    if arguments.markdown:
        arguments.markdown.write_text(compare_report.markdown(evaluated) + "\n")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""The benchmark table: what each estimator recovers in a given time, scene by scene, with Mitsuba 3 beside it.

    bench/benchmarks.py -o FOLDER                          all scenes, 20 s for each run, 350 x 350
    bench/benchmarks.py -o FOLDER --seconds 60 --scenes tire tyre
    bench/benchmarks.py -o FOLDER --quick                  two scenes of 32 x 32, 1 s for each run: does it work?

Writes FOLDER/benchmarks.md and FOLDER/benchmarks.json with commit, machine and date. The built-in scenes (goblet,
tyre, bowl, tree) are made on the way; the published ones (tire, ashtray, chalice) run where the environment variable
BURNISH_PAPER_DIR names the folder that holds scenes/paper/NAME/scene.xml. Burnish is built into build/bench.

FOLDER/benchmarks.md is a page that says how the numbers were made. Mitsuba runs where --python names an interpreter
that can import it and LLVM 15 or newer is installed. Where it crashes with frozen kernels: --without-freezing.
"""
import argparse
import datetime
import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from types import SimpleNamespace

from compare_sides import BUILD, PUBLISHED, SCENES, SPLITS, Comparison, build
from mitsuba_python import ROOT, interpreter_with_mitsuba

PAPER = "BURNISH_PAPER_DIR"
ORDER = ("goblet", "tyre", "bowl", "tree", "tire", "ashtray", "chalice")
SIDES = ("path-cache pyramid", "pgris pyramid", "mc pyramid")
NAMES = {"path-cache pyramid": "path cache", "pgris pyramid": "pgris", "mc pyramid": "mc", "mitsuba": "Mitsuba"}
TRIAL = 1 / 8  # of the seconds of a run, for each split of Mitsuba


def arguments_of():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER")
    parser.add_argument("--scenes", nargs="+", choices=ORDER, help="only these")
    parser.add_argument("--seconds", type=float, default=20, help="of each run")
    parser.add_argument("--size", type=int, nargs=2, default=(350, 350), metavar=("W", "H"))
    parser.add_argument("--python", help="with Mitsuba, if it is to run; without: as for the other scripts")
    parser.add_argument("--without-freezing", action="store_true", help="of Mitsuba's kernels: where that crashes")
    parser.add_argument("--folder", type=Path,
                        help="where scenes and targets stay; those of an earlier run with the same options are taken")
    parser.add_argument("--build", type=Path, help="a folder with the programs; nothing is built")
    parser.add_argument("--quick", action="store_true")
    arguments = parser.parse_args()
    if arguments.python and not shutil.which(arguments.python):
        parser.error(f"--python {arguments.python}: no such program")
    arguments.python = arguments.python or interpreter_with_mitsuba() or sys.executable
    if arguments.quick:
        arguments.seconds, arguments.size = 1, (32, 32)
        arguments.scenes = arguments.scenes or ("goblet", "tree")
    return arguments


def samples_of(arguments):
    """Per pixel: of targets, and of each of the two images of an evaluation."""
    return (16, 4) if arguments.quick else (512, 64)


def wanted_scenes(arguments):
    there = ORDER if os.environ.get(PAPER) else [name for name in ORDER if name not in PUBLISHED]
    missing = set(arguments.scenes or ()) - set(there)
    if missing:
        sys.exit(f"benchmarks: {', '.join(sorted(missing))}: expected {PAPER} to name the folder that holds "
                 "scenes/paper/NAME/scene.xml")
    return [name for name in there if name in (arguments.scenes or there)]


def can_import_mitsuba(python):
    return subprocess.run([python, "-c", "import mitsuba, numpy"], capture_output=True).returncode == 0


# ---- Runs


class Case(Comparison):
    """One scene of the table."""

    def __init__(self, name, arguments, folder):
        scenes = Path(os.environ.get(PAPER, "."), "scenes", "paper")
        settings = SimpleNamespace(scenes=scenes, size=arguments.size, runs=arguments.seconds)
        super().__init__(name, settings, folder, shutil.which(arguments.python), arguments.build or BUILD)
        self.without_freezing = arguments.without_freezing
        self.texture_size = 64 if arguments.quick else 2048
        self.target_spp, self.evaluation_spp = samples_of(arguments)

    def rows(self, with_mitsuba):
        self.prepare()
        done = [self.optimise(side, SPLITS[0], 0, moments=(1,)) for side in SIDES]
        if with_mitsuba:
            done.append(self.run_mitsuba())
        start, *ends = self.evaluations(["0.5"] + [d["moments"][-1]["texture"] for d in done],
                                        self.evaluation_spp)
        return [self.row(d, start, end) for d, end in zip(done, ends)]

    def run_mitsuba(self):
        self.mitsuba = self.start_mitsuba()
        self.mitsuba.ask("compile")
        if not self.without_freezing:
            self.mitsuba.ask("time", what="iteration")  # finds out whether freezing helps
        trials = [self.optimise("mitsuba", split, 0, moments=(TRIAL,)) for split in SPLITS]
        losses = self.losses([t["moments"][-1]["texture"] for t in trials], 16)
        split = SPLITS[losses.index(min(losses))]
        done = self.optimise("mitsuba", split, 1, moments=(1,))
        frozen = self.mitsuba.ask("about")["frozen"]
        self.mitsuba.close()
        alone = self.start_mitsuba()
        memory = alone.ask("memory", spp=split[0], spp_grad=split[1], frozen=frozen)
        alone.close()
        return done | {"peak_memory_gb": memory}

    def row(self, done, start, end):
        last = done["moments"][-1]
        return {"scene": self.name, "parameter": self.parameter, "learning_rate": self.rate, "side": done["side"],
                "split": done["split"] if not done["side"].startswith("path-cache") else None,
                "loss_start": start["loss"], "loss_end": end["loss"],
                "texture_error_start": start["texture_error"], "texture_error_end": end["texture_error"],
                "iterations": last["iterations"], "seconds": last["seconds"], "iteration_s": done["iteration_s"],
                "peak_memory_gb": done["peak_memory_gb"]}


# ---- What the numbers are of


def output_of(*command):
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    return done.stdout.strip() if done.returncode == 0 else ""


UNKNOWN, CHANGED = "unknown", " with changes"


def commit():
    name = output_of("git", "rev-parse", "--short=12", "HEAD") or UNKNOWN
    return name + (CHANGED if output_of("git", "status", "--porcelain", "--untracked-files=no") else "")


def is_clean(name):
    """Whether a commit() tells all that the tree holds."""
    return name != UNKNOWN and not name.endswith(CHANGED)


def machine():
    def field(file, name):
        lines = Path(file).read_text().splitlines() if Path(file).exists() else []
        return next((line.split(":")[1].strip() for line in lines if line.startswith(name)), "")

    kilobytes = field("/proc/meminfo", "MemTotal").split()
    memory = f", {int(kilobytes[0]) / 1024**2:.0f} GiB" if kilobytes else ""
    processor = field("/proc/cpuinfo", "model name") or os.uname().machine
    return f"{len(os.sched_getaffinity(0))} cores of {processor}{memory}"


def machine_and_date():
    return {"machine": machine(), "date": datetime.date.today().isoformat()}


METHOD = """\
Every run recovers one texture from 0.5 everywhere to a target of {target_spp} samples per pixel, under relMSE, with the
learning rates of the paper: 0.005 for *tire* and *tyre*, 0.1 for *tree*, which is too much for a path cache
([decision 023](decisions/023-bias-in-a-closed-loop.md)), otherwise 0.01. Burnish runs with these, otherwise with the
defaults of `burnish optimize`, and with the estimators path cache, pgris (replay shift) and mc. Mitsuba 3 runs `prb`,
Adam and plain texels, with that split of image and derivative samples (32+1, 8+4, 4+4 or 2+2) which ends lowest after
an eighth of the time; the row names it.

Seconds are those of iterations alone, without loading, evaluation and JIT compilation. Losses are those of two
independent images with {evaluation_spp} samples per pixel each, without their noise on average. The texture error is
the root mean squared difference over the texels that light reaches. Peak memory is that of a process that does nothing
but this run. *tire*, *ashtray* and *chalice* are the published scenes of the paper, which run where `BURNISH_PAPER_DIR`
names their folder ([testing](testing.md#data)); the others come from `burnish scene`.
"""


def command_of(arguments):
    """Without the paths of this machine."""
    if arguments.quick:
        return "bench/benchmarks.py -o FOLDER --quick"
    parts = ["bench/benchmarks.py -o FOLDER", f"--seconds {arguments.seconds:g}"]
    if tuple(arguments.size) != (350, 350):
        parts.append(f"--size {arguments.size[0]} {arguments.size[1]}")
    if arguments.scenes:
        parts.append("--scenes " + " ".join(arguments.scenes))
    parts += ["--without-freezing"] if arguments.without_freezing else []
    return " ".join(parts)


def header(arguments):
    return {"commit": commit(), "command": command_of(arguments), "seconds": arguments.seconds,
            "size": list(arguments.size), "target_spp": samples_of(arguments)[0],
            "evaluation_spp": samples_of(arguments)[1]} | machine_and_date()


# ---- Tables


def cells_of(row):
    split = f", {row['split'][0]}+{row['split'][1]}" if row["side"] == "mitsuba" else ""
    return [row["scene"], NAMES[row["side"]] + split, f"{row['loss_start']:.4g}", f"{row['loss_end']:.4g}",
            f"{row['texture_error_start']:.3f}", f"{row['texture_error_end']:.3f}", str(row["iterations"]),
            f"{row['iteration_s']:.3f}", f"{row['peak_memory_gb']:.2f}"]


HEAD = ["scene", "estimator", "loss at start", "loss", "texture error at start", "texture error", "iterations",
        "s each", "memory, GB"]


def table(head, rows):
    """Markdown; rows of cells."""
    lines = ["| " + " | ".join(head) + " |", "|" + " --- |" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(cells) + " |" for cells in rows])


def markdown(results):
    """The page."""
    return "\n".join(["# Benchmarks", "", f"    {results['command']}", "",
                      f"Commit {results['commit']}, {results['date']}, {results['machine']}.",
                      f"Images of {results['size'][0]} x {results['size'][1]}, {results['seconds']:g} s for each run.",
                      "", table(HEAD, map(cells_of, results["rows"])), "", "## How the numbers are made",
                      METHOD.format(**results)])


def write(results, folder):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "benchmarks.json").write_text(json.dumps(results, indent=1) + "\n")
    (folder / "benchmarks.md").write_text(markdown(results))


def main():
    arguments = arguments_of()
    names = wanted_scenes(arguments)
    with_mitsuba = can_import_mitsuba(arguments.python)
    if not with_mitsuba:
        print(f"benchmarks: {arguments.python} cannot import mitsuba and numpy: without Mitsuba", flush=True)
    if not arguments.build:
        build("burnish_beside", "burnish_program")
    results = header(arguments) | {"rows": []}
    with tempfile.TemporaryDirectory() as temporary:
        for name in names:
            print(f"benchmarks: {name} ({names.index(name) + 1} of {len(names)})", flush=True)
            results["rows"] += Case(name, arguments, arguments.folder or Path(temporary)).rows(with_mitsuba)
            write(results, arguments.output)  # after each scene: what is there is kept
    print(table(HEAD, map(cells_of, results["rows"])))


if __name__ == "__main__":
    main()

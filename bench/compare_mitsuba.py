#!/usr/bin/env python3
"""Mitsuba 3 (llvm_ad_rgb) and Burnish on the same scenes, alternating in one run on the same cores.

    bench/compare_mitsuba.py SCENES_DIR [--repeats 5] [--size 350 350] [--scenes ashtray tire chalice]
    bench/compare_mitsuba.py SCENES_DIR --descents 20 --repeats 3        also derivative error and loss at equal time

SCENES_DIR holds NAME/scene.xml of the published scenes; the project's own (goblet, tyre, bowl, tree) are made on the
way. Mitsuba comes from PyPI into its own virtual environment (build/mitsuba) on the first run; Burnish is built into
build/bench. For every scene: seconds of a 32-spp image, of a 1-spp derivative with a given adjoint, of a whole
iteration (image, loss, derivative, Adam), and peak memory. With --descents: the error of the derivative at equal time,
the loss after so many seconds of iterations (Mitsuba with its best split of image and derivative samples, the same
loss, learning rate and starting texture, plain texels; Burnish with plain texels and with the pyramid), and the seconds
that Burnish needs to reach Mitsuba's best loss. Both are judged by the same images of 256 samples per pixel.

Ratios are Mitsuba / Burnish, the median over the repeats with the smallest and the largest in brackets. JIT compilation
is reported apart and counted in no other number. Kernel freezing is used where it makes Mitsuba faster.
"""
import argparse
import json
import math
import os
import re
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
ENVIRONMENT = ROOT / "build" / "mitsuba"
MITSUBA = "mitsuba==3.9.1"
BUILD = ROOT / "build" / "bench"
# name: parameter, learning rate [PR sec. 5]
SCENES = {
    "ashtray": ("mat-ashtray.brdf_0.anisotropic.data", 0.01),
    "tire": ("mat-tire.brdf_0.roughness.data", 0.005),
    "chalice": ("mat-chalice.brdf_0.roughness.data", 0.01),
    "goblet": ("mat-goblet.brdf_0.roughness.data", 0.01),
    "tyre": ("mat-tyre.brdf_0.roughness.data", 0.005),
    "bowl": ("mat-bowl.brdf_0.anisotropic.data", 0.01),
    "tree": ("mat-tree.brdf_0.base_color.data", 0.1),
}
PUBLISHED = ("ashtray", "tire", "chalice")
MEASURES = ("image", "derivative", "iteration")
SPLITS = ((32, 1), (8, 4), (4, 4), (2, 2))  # samples per pixel of the image and of the derivative


def newest_llvm():
    """Dr.Jit takes the LLVM that it finds first, which may be too old for this processor (14 stops on AVX-512)."""
    versions = {}
    for file in Path("/usr/lib").glob("*/libLLVM*.so*"):
        number = re.search(r"LLVM[-.](?:so\.)?(\d+)", file.name)
        if number:
            versions[int(number.group(1))] = str(file)
    if max(versions, default=0) < 15:
        sys.exit("compare_mitsuba: LLVM 15 or newer is needed: apt-get install libllvm19")
    return versions[max(versions)]


class Mitsuba:
    """The worker process."""

    def __init__(self, scene_file, parameter, size, definitions, home):
        command = [ENVIRONMENT / "bin" / "python", ROOT / "bench" / "mitsuba_worker.py", scene_file, parameter, *size,
                   json.dumps(definitions)]
        # An empty home: Dr.Jit keeps compiled kernels there, and their compilation is to be seen.
        environment = os.environ | {"DRJIT_LIBLLVM_PATH": newest_llvm(), "HOME": str(home)}
        self.process = subprocess.Popen([str(c) for c in command], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        text=True, env=environment)
        self.answer()

    def answer(self):
        line = self.process.stdout.readline()
        if not line:
            sys.exit("compare_mitsuba: Mitsuba stopped; its message stands above")
        return json.loads(line)

    def ask(self, request, **arguments):
        self.process.stdin.write(json.dumps({"request": request} | arguments) + "\n")
        self.process.stdin.flush()
        return self.answer()

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def run(program, *arguments):
    done = subprocess.run([str(program), *map(str, arguments)], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"compare_mitsuba: {Path(program).name}: {done.stderr.strip()}")
    return done.stdout


def ratio(theirs, ours):
    ratios = [a / b for a, b in zip(theirs, ours)]
    return f"{statistics.median(ratios):7.2f} [{min(ratios):.2f}, {max(ratios):.2f}]"


def print_row(label, theirs, ours, form="9.3f"):
    a, b = statistics.median(theirs), statistics.median(ours)
    print(f"  {label:32} {a:{form}} {b:{form}}   {ratio(theirs, ours)}", flush=True)


class Comparison:
    """One scene."""

    def __init__(self, name, arguments, folder):
        self.name, self.arguments, self.folder = name, arguments, folder
        self.parameter, self.rate = SCENES[name]
        self.definitions = {"integrator": "direct"} if name in PUBLISHED else {}
        if name in PUBLISHED:
            self.file = arguments.scenes / name / "scene.xml"
        else:
            run(BUILD / "burnish", "scene", name, "-o", folder / name)
            self.file = folder / name / "scene.xml"
        self.size = [str(s) for s in arguments.size]
        self.scene = [self.file, *(f for k, v in self.definitions.items() for f in ("-D", f"{k}={v}")), "--size", *self.size]
        home = folder / f"home_{name}"
        home.mkdir()
        self.mitsuba = Mitsuba(self.file, self.parameter, self.size, self.definitions, home)
        self.results = {"scene": name}

    def stages(self):
        theirs = {m: [] for m in MEASURES}
        ours = {m: [] for m in (*MEASURES, "iteration_identity", "iteration_mc", "rays", "memory")}
        for _ in range(self.arguments.repeats):
            for m in MEASURES:
                theirs[m].append(self.mitsuba.ask("time", what=m, spp=self.arguments.spp))
            b = json.loads(run(BUILD / "bench" / "burnish_stages", self.file, self.parameter, "--size", *self.size,
                               "--spp", self.arguments.spp, "--repeats", 3,
                               *(f for k, v in self.definitions.items() for f in ("-D", f"{k}={v}"))))
            ours["image"].append(b["image_s"]["median"])
            ours["derivative"].append(b["derivative_s"]["median"])
            ours["iteration"].append(b["iteration_s"]["pgris_replay"]["whole"])
            ours["iteration_identity"].append(b["iteration_s"]["pgris_identity"]["whole"])
            ours["iteration_mc"].append(b["iteration_s"]["mc"]["whole"])
            ours["rays"].append(b["rays_alone_s"])
            ours["memory"].append(b["peak_memory_gb"])
        memory = self.mitsuba.ask("memory")
        print(f"\n{self.name}, {' x '.join(self.size)}")
        print(f"  {'':32} {'Mitsuba':>9} {'Burnish':>9}   Mitsuba / Burnish")
        print_row(f"image, {self.arguments.spp} spp, s", theirs["image"], ours["image"])
        print_row("derivative, 1 spp, s", theirs["derivative"], ours["derivative"])
        print_row("iteration, pgris replay, s", theirs["iteration"], ours["iteration"])
        print_row("iteration, pgris identity, s", theirs["iteration"], ours["iteration_identity"])
        print_row("iteration, mc, s", theirs["iteration"], ours["iteration_mc"])
        print_row("peak memory, GB", [memory] * len(ours["memory"]), ours["memory"])
        rays = statistics.median(ours["rays"])
        print(f"  {'image / rays alone':32} {statistics.median(theirs['image']) / rays:9.2f} "
              f"{statistics.median(ours['image']) / rays:9.2f}   rays alone: {rays:.3f} s")
        compile_seconds = self.mitsuba.ask("compile")
        text = ", ".join(f"{k} {v:.2f} s" for k, v in compile_seconds.items())
        frozen = "with" if self.mitsuba.ask("frozen_kernels") else "without"
        print(f"  JIT compilation, not counted above: {text}; iterations {frozen} kernel freezing", flush=True)
        self.results |= {"mitsuba": theirs | {"memory": memory, "compile": compile_seconds}, "burnish": ours}

    def target(self):
        """What both are to match, and the start that both share."""
        self.target_image = self.folder / f"{self.name}_target.exr"
        run(BUILD / "burnish", "render", *self.scene, "-o", self.target_image, "--spp", 512, "--seed", 77)

    def judge(self, texture):
        """The loss of a texture, 256 samples per pixel."""
        image = self.folder / "judged.exr"
        run(BUILD / "burnish", "render", *self.scene, "-o", image, "--spp", 256, "--seed", 5, "--texture",
            f"{self.parameter}={texture}")
        return self.mitsuba.ask("relmse", image=str(image), target=str(self.target_image))

    def derivatives(self):
        """NMSE at equal time, at 0.5: Mitsuba's 1 spp against as many of Burnish as fit its time."""
        start, adjoint, reference = (self.folder / f"{self.name}_{k}.exr" for k in ("start", "adjoint", "reference"))
        half = ["--texture", f"{self.parameter}=0.5"]
        run(BUILD / "burnish", "render", *self.scene, *half, "-o", start, "--spp", 256, "--seed", 6)
        self.mitsuba.ask("write_adjoint", image=str(start), target=str(self.target_image), path=str(adjoint))
        gradient = [BUILD / "burnish", "gradient", *self.scene, "--parameter", self.parameter, *half, "--adjoint", adjoint,
                    "--estimator", "mc"]
        run(*gradient, "--spp", 2048, "--seed", 99, "-o", reference)
        theirs = self.mitsuba.ask("gradient", adjoint=str(adjoint), spp=1, count=self.arguments.repeats,
                                  folder=str(self.folder))
        ours_seconds = statistics.median(self.results["burnish"]["derivative"])
        spp = max(1, int(theirs["seconds"] / ours_seconds))
        files = []
        for k in range(self.arguments.repeats):
            files.append(str(self.folder / f"gradient_{k}.exr"))
            run(*gradient, "--spp", spp, "--seed", k, "-o", files[-1])
        a = self.mitsuba.ask("errors", files=theirs["files"], reference=str(reference))
        b = self.mitsuba.ask("errors", files=files, reference=str(reference))
        print_row(f"derivative NMSE, 1 and {spp} spp", a, b, "9.3g")
        self.results["derivative_nmse"] = {"mitsuba": a, "burnish": b, "burnish_spp": spp,
                                           "mitsuba_seconds": theirs["seconds"]}

    def burnish_descent(self, seconds, parameterization, seed):
        folder = self.folder / f"out_{parameterization}"
        run(BUILD / "burnish", "optimize", *self.scene, "--parameter", self.parameter, "--target", self.target_image,
            "--learning-rate", self.rate, "--parameterization", parameterization, "--time", seconds, "--seed", seed,
            "--evaluation-spp", 1, "--shift", "identity", "-o", folder, "--force")
        return self.judge(next((folder / "textures").glob("*.exr")))

    def descents(self):
        seconds = self.arguments.descents
        fractions = [seconds * f for f in (1 / 16, 1 / 8, 1 / 4, 1 / 2, 1)]
        best, ours, reached = [], {"texels": [], "pyramid": []}, {"texels": [], "pyramid": []}
        splits = {}
        for repeat in range(self.arguments.repeats):
            ends = {}
            for spp, spp_grad in SPLITS:
                done = self.mitsuba.ask("descend", spp=spp, spp_grad=spp_grad, rate=self.rate, moments=[seconds],
                                        target=str(self.target_image), folder=str(self.folder))
                ends[f"{spp}+{spp_grad}"] = self.judge(done["moments"][-1]["texture"])
            for split, loss in ends.items():
                splits.setdefault(split, []).append(loss)
            best.append(min(ends.values()))
            for parameterization in ours:
                losses = [self.burnish_descent(s, parameterization, repeat) for s in fractions]
                ours[parameterization].append(losses[-1])
                first = next((s for s, loss in zip(fractions, losses) if loss <= best[-1]), math.inf)
                reached[parameterization].append(first)
        print(f"  loss after {seconds:g} s of iterations; Mitsuba's splits: "
              + ", ".join(f"{k} {statistics.median(v):.4f}" for k, v in splits.items()))
        for parameterization, losses in ours.items():
            print_row(f"loss, best split; {parameterization}", best, losses, "9.4f")
            times = [t for t in reached[parameterization] if t < math.inf]
            text = (f"within {statistics.median(times):.2f} s, {seconds / statistics.median(times):.1f} times sooner"
                    if len(times) == len(best) else "not in every repeat")
            print(f"  {'Mitsuba' + chr(39) + 's best loss reached':32} {text}", flush=True)
        self.results["loss"] = {"mitsuba": splits, "burnish": ours, "seconds_to_mitsubas_best": {
            k: [t if t < math.inf else None for t in v] for k, v in reached.items()}}


def prepare():
    if not (ENVIRONMENT / "bin" / "python").exists():
        subprocess.run([sys.executable, "-m", "venv", str(ENVIRONMENT)], check=True)
    subprocess.run([str(ENVIRONMENT / "bin" / "pip"), "install", "-q", MITSUBA, "numpy"], check=True)
    subprocess.run(["cmake", "--preset", "bench"], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", "--preset", "bench", "--target", "burnish_stages", "burnish_cli"], cwd=ROOT,
                   check=True, stdout=subprocess.DEVNULL)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", type=Path, metavar="SCENES_DIR")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--size", type=int, nargs=2, default=(350, 350))
    parser.add_argument("--spp", type=int, default=32)
    parser.add_argument("--scenes", dest="names", nargs="+", choices=SCENES, default=list(PUBLISHED))
    parser.add_argument("--descents", type=float, metavar="SECONDS", help="also compare descents of so many seconds")
    parser.add_argument("--json", type=Path, help="also write the numbers here")
    arguments = parser.parse_args()
    prepare()
    results = []
    with tempfile.TemporaryDirectory() as folder:
        for name in arguments.names:
            comparison = Comparison(name, arguments, Path(folder))
            comparison.stages()
            if arguments.descents:
                comparison.target()
                comparison.derivatives()
                comparison.descents()
            comparison.mitsuba.close()
            results.append(comparison.results)
            if arguments.json:
                arguments.json.write_text(json.dumps(results, indent=1))


if __name__ == "__main__":
    main()

"""What bench/benchmarks.py and bench/compare_mitsuba.py ask of the two renderers, scene by scene, as JSON."""
import hashlib
import json
import math
import os
import shutil
import statistics
import subprocess
import sys
from pathlib import Path

from mitsuba_python import ROOT, llvm

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
DETACHED = "detached derivative"
MEASURES = ("image", "derivative", DETACHED, "iteration")
SPLITS = ((32, 1), (8, 4), (4, 4), (2, 2))  # samples per pixel of the image and of the derivative
MOMENTS = (1 / 8, 1 / 4, 1 / 2, 1)  # of a run, at which its texture is kept
PARAMETERIZATIONS = ("texels", "pyramid")


def splits_of(side):
    """The path cache has one kind of samples, and their number by itself."""
    return SPLITS[:1] if side.startswith("path-cache") else SPLITS


def build(*targets):
    subprocess.run(["cmake", "--preset", "bench"], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", str(BUILD), "--target", *targets], cwd=ROOT, check=True,
                   stdout=subprocess.DEVNULL)


class Mitsuba:
    """The worker process."""

    def __init__(self, python, scene_file, parameter, size, definitions, home):
        command = [python, ROOT / "bench" / "mitsuba_worker.py", scene_file, parameter, *size,
                   json.dumps(definitions)]
        # An empty home: Dr.Jit keeps compiled kernels there, and their compilation is to be seen.
        environment = os.environ | {"DRJIT_LIBLLVM_PATH": llvm(), "HOME": str(home)}
        self.process = subprocess.Popen([str(c) for c in command], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        text=True, env=environment)
        self.answer()

    def answer(self):
        line = self.process.stdout.readline()
        if not line:
            sys.exit("bench: Mitsuba stopped; its message stands above")
        return json.loads(line)

    def ask(self, request, **arguments):
        self.process.stdin.write(json.dumps({"request": request} | arguments) + "\n")
        self.process.stdin.flush()
        return self.answer()

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def call(program, *arguments):
    done = subprocess.run([str(program), *map(str, arguments)], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"bench: {Path(program).name}: {done.stderr.strip()}")
    return done.stdout


def digest_of(folder):
    """Of the files below a folder: names and bytes."""
    total = hashlib.sha256()
    for file in sorted(f for f in folder.rglob("*") if f.is_file()):
        total.update(hashlib.sha256(str(file.relative_to(folder)).encode()).digest())
        total.update(hashlib.sha256(file.read_bytes()).digest())
    return total.hexdigest()


def make_unless_there(file, record, made_of, make):
    """Makes a file where it is not there or `record` says that it was made of something else. The record is written
    last: what was stopped is made again."""
    text = json.dumps(made_of, indent=1) + "\n"
    if file.exists() and record.exists() and record.read_text() == text:
        return
    record.unlink(missing_ok=True)
    make()
    record.write_text(text)


class Comparison:
    """One scene, in a folder of its own."""

    texture_size = 2048  # of the built-in scenes
    target_spp = 512

    def __init__(self, name, arguments, folder, python, binaries=BUILD):
        self.python, self.binaries, self.program = python, binaries / "bench", binaries / "burnish"
        self.name, self.arguments, self.folder = name, arguments, folder / name
        self.parameter, self.rate = SCENES[name]
        self.definitions = {"integrator": "direct"} if name in PUBLISHED else {}
        self.file = arguments.scenes / name / "scene.xml" if name in PUBLISHED else self.folder / "scene" / "scene.xml"
        self.size = [str(s) for s in arguments.size]
        self.defines = [f for k, v in self.definitions.items() for f in ("-D", f"{k}={v}")]
        self.scene = [self.file, self.parameter, "--size", *self.size, *self.defines]
        self.target = self.folder / "target.exr"
        self.results_file = self.folder / "results.json"

    def beside(self, command, *arguments):
        return json.loads(call(self.binaries / "burnish_beside", command, *self.scene, *arguments))

    def made(self, *parts):
        folder = self.folder.joinpath(*map(str, parts))
        folder.mkdir(parents=True, exist_ok=True)
        return folder

    # ---- prepare

    def prepare(self):
        """The scene, and the image that both are to match, where those of the same are not there yet."""
        self.folder.mkdir(parents=True, exist_ok=True)
        if self.name not in PUBLISHED:
            made_of = {"texture_size": self.texture_size}
            make_unless_there(self.file, self.folder / "scene.json", made_of, self.make_scene)
        if self.arguments.runs:
            made_of = {"scene": digest_of(self.file.parent), "definitions": self.definitions, "size": self.size,
                       "spp": self.target_spp}
            make_unless_there(self.target, self.folder / "target.json", made_of, self.make_target)

    def make_scene(self):
        call(self.program, "scene", self.name, "-o", self.file.parent, "--texture-size", self.texture_size)

    def make_target(self):
        call(self.program, "render", self.file, *self.defines, "--size", *self.size, "-o", self.target, "--spp",
             self.target_spp, "--seed", 77)

    # ---- measure

    def start_mitsuba(self):
        """With no kernel compiled."""
        shutil.rmtree(self.made("home"))
        return Mitsuba(self.python, self.file, self.parameter, self.size, self.definitions, self.made("home"))

    def measure(self):
        self.mitsuba = self.start_mitsuba()
        self.mitsuba.ask("compile")
        results = {"scene": self.name, "size": self.size, "seconds": self.arguments.runs,
                   "estimators": self.arguments.estimators, "stages": self.stages()}
        results["mitsuba"] = self.mitsuba.ask("about")
        if self.arguments.runs:
            results["derivatives"] = self.derivatives(results["stages"]["mitsuba"][DETACHED])
            results["runs"] = self.runs()
        self.mitsuba.close()
        self.results_file.write_text(json.dumps(results, indent=1))

    def stages(self):
        theirs, ours = {m: [] for m in MEASURES}, []
        variants = list(dict.fromkeys(["mc", "pgris:replay", "pgris:identity", *self.arguments.estimators]))
        for _ in range(self.arguments.repeats):
            for m in MEASURES:
                theirs[m].append(self.mitsuba.ask("time", what=m))
            ours.append(json.loads(call(self.binaries / "burnish_stages", *self.scene, "--repeats", 1, "--variants",
                                       *variants)))
        return {"mitsuba": theirs, "burnish": ours}

    def derivatives(self, times):
        """Files of derivatives: the baseline in the time of Mitsuba's 1 spp, the median of `times`, the others in their
        own. Those of Mitsuba are detached, as Burnish's, whether or not that is the faster of its ways."""
        seconds = statistics.median(times)
        ours = self.beside("derivatives", "--target", self.target, "-o", self.made("derivatives"), "--seconds", seconds,
                           "--repeats", self.arguments.repeats, "--learning-rate", self.rate, "--variants",
                           *self.arguments.estimators)
        for name, variant in ours["variants"].items():
            allowed = 0 if name == "mc" else statistics.median(variant["seconds"])  # 0: 1 spp
            variant["mitsuba"] = self.mitsuba.ask(
                "derivatives", texture=ours["texture"], adjoint=ours["adjoint"], seconds=allowed,
                count=self.arguments.repeats, folder=str(self.made("derivatives", name.replace(":", "_"))))
        return ours

    def optimise(self, side, split, repeat, moments=MOMENTS):
        """side: "mitsuba", or "ESTIMATOR[:SHIFT] PARAMETERIZATION" of Burnish. moments: of its seconds."""
        folder = self.made("runs", f"{side.replace(':', '_').replace(' ', '_')}_{split[0]}_{split[1]}_{repeat}")
        moments = [self.arguments.runs * m for m in moments]
        if side == "mitsuba":
            done = self.mitsuba.ask("optimise", spp=split[0], spp_grad=split[1], rate=self.rate, moments=moments,
                                    target=str(self.target), folder=str(folder))
        else:
            estimator, parameterization = side.split()
            done = self.beside("run", "--target", self.target, "-o", folder, "--learning-rate", self.rate, "--spp",
                               split[0], "--gradient-spp", split[1], "--estimator", estimator,
                               "--parameterization", parameterization,
                               "--seed", repeat, "--moments", *moments)
        return {"side": side, "split": list(split), "repeat": repeat} | done

    def runs(self):
        sides = ["mitsuba"] + [f"{e} {p}" for e in self.arguments.estimators for p in PARAMETERIZATIONS]
        done, best = [], {}
        for repeat in range(self.arguments.repeats):
            for split in SPLITS:
                for side in sides:
                    if split in splits_of(side) and best.get(side, split) == split:
                        done.append(self.optimise(side, split, repeat))
            if repeat == 0:
                ends = self.losses([d["moments"][-1]["texture"] for d in done], 8)
                for side in sides:
                    best[side] = min((loss, tuple(d["split"])) for loss, d in zip(ends, done) if d["side"] == side)[1]
        return {"best": best, "done": done}

    # ---- evaluate

    def evaluations(self, textures, spp):
        """The loss and the texture error of each; a texture is a file or a value."""
        return self.beside("textures", "--target", self.target, "--spp", spp, "--seed", 5, "--textures", *textures)

    def losses(self, textures, spp):
        return [e["loss"] for e in self.evaluations(textures, spp)]

    def evaluate(self):
        results = json.loads(self.results_file.read_text())
        mitsuba = self.start_mitsuba()
        results["mitsuba"]["peak_memory_gb"] = mitsuba.ask("memory", spp=32, spp_grad=1,
                                                           frozen=results["mitsuba"]["frozen"])
        mitsuba.close()
        if results["seconds"]:
            self.evaluate_runs(results)
        self.results_file.write_text(json.dumps(results, indent=1))

    def evaluate_runs(self, results):
        self.evaluate_derivatives(results["derivatives"])
        runs = results["runs"]
        moments = [m for d in runs["done"] for m in
                   (d["moments"] if d["split"] == runs["best"][d["side"]] else d["moments"][-1:])]
        *losses, start = self.losses([m["texture"] for m in moments] + ["0.5"], 16)
        for moment, loss in zip(moments, losses):
            moment["loss"] = loss
        runs["start"] = start

    def evaluate_derivatives(self, derivatives):
        estimates = [side for v in derivatives["variants"].values() for side in (v, v["mitsuba"])]
        evaluated = self.beside("errors", "--texture", derivatives["texture"], "--adjoint", derivatives["adjoint"],
                             "--spp", 1024, "--seed", 99, "--derivatives", *(f for e in estimates for f in e["files"]))
        # null: the noise of the converged derivative hides it, or is all of it
        own = evaluated["reference_nmse"]
        derivatives["reference_nmse"] = math.inf if own is None else own
        errors = iter(math.nan if e is None else e for e in evaluated["nmse"])
        for e in estimates:
            e["nmse"] = [next(errors) for _ in e["files"]]

#!/usr/bin/env python3
"""Seconds of Mitsuba 3 (llvm_ad_rgb) and of Burnish on the same scenes, alternating in one run.

    bench/compare_mitsuba.py SCENES_DIR [--repeats 5] [--size 350 350] [--scenes ashtray tire chalice]

SCENES_DIR holds NAME/scene.xml of the published scenes. Mitsuba comes from PyPI into its own virtual environment
(build/mitsuba) on the first run; Burnish is built into build/bench. For every scene: seconds of a 32-spp image, of a
1-spp derivative with a given adjoint, of a whole iteration (image, loss, derivative, Adam), and peak memory. Ratios
are Mitsuba / Burnish, the median over the repeats with the smallest and the largest in brackets. JIT compilation is
not counted: each of Mitsuba's kernels runs once before it is timed.
"""
import argparse
import json
import os
import re
import resource
import statistics
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
ENVIRONMENT = ROOT / "build" / "mitsuba"
MITSUBA = "mitsuba==3.9.1"
PARAMETERS = {
    "ashtray": "mat-ashtray.brdf_0.anisotropic.data",
    "tire": "mat-tire.brdf_0.roughness.data",
    "chalice": "mat-chalice.brdf_0.roughness.data",
}
MEASURES = ("image", "derivative", "iteration")


def differentiable_scene(scene_file, parameter):
    """The scene's text with the optimised texture stored as floats (8-bit storage has no gradient), paths absolute."""
    text = Path(scene_file).read_text()
    folder = Path(scene_file).resolve().parent
    text = re.sub(r'(name="filename"\s+value=")(?!/)', lambda m: m.group(1) + str(folder) + "/", text)
    bsdf, name = parameter.split(".")[0], parameter.split(".")[-2]
    at = text.index(f'name="{name}"', text.index(f'id="{bsdf}"'))
    end = text.index("</texture>", at)
    return text[:end] + '<string name="format" value="variant"/>' + text[end:]


def worker(scene_file, parameter, width, height, spp):
    """Mitsuba's side: answers each name of a measure on standard input with its seconds."""
    import drjit as dr
    import mitsuba as mi

    mi.set_variant("llvm_ad_rgb")
    scene = mi.load_string(differentiable_scene(scene_file, parameter), integrator="direct", resx=width, resy=height)
    params = mi.traverse(scene)
    params[parameter] = dr.full(type(params[parameter]), 0.5, params[parameter].shape)
    params.update()
    target = mi.render(scene, spp=spp, seed=7)
    dr.eval(target)
    detached = mi.load_dict({"type": "prb", "max_depth": 2})
    attached = mi.load_dict({"type": "direct"})
    optimizer = mi.ad.Adam(lr=0.01)
    optimizer[parameter] = params[parameter]
    params.update(optimizer)
    adjoint = dr.full(mi.TensorXf, 1e-4, target.shape)
    dr.eval(adjoint)
    seed = [0]

    def image():
        dr.eval(mi.render(scene, spp=spp, seed=seed[0], integrator=attached))

    def derivative(integrator):
        dr.enable_grad(params[parameter])
        dr.set_grad(params[parameter], 0)
        integrator.render_backward(scene, params, adjoint, spp=1, seed=seed[0])
        dr.eval(dr.grad(params[parameter]))

    def iteration():
        dr.enable_grad(optimizer[parameter])
        params.update(optimizer)
        rendered = mi.render(scene, params, spp=spp, spp_grad=1, seed=seed[0], seed_grad=seed[0] + 1000003,
                             integrator=detached)
        loss = dr.mean(dr.square(rendered - target) / (dr.square(target) + 0.01), axis=None)
        dr.backward(loss)
        optimizer.step()
        optimizer[parameter] = dr.clip(optimizer[parameter], 0, 1)
        params.update(optimizer)
        dr.eval(optimizer[parameter])

    def timed(work):
        seed[0] += 1
        dr.sync_thread()
        start = time.perf_counter()
        work()
        dr.sync_thread()
        return time.perf_counter() - start

    # The faster of the two integrators stands for Mitsuba's derivative; the first call of each compiles.
    for integrator in (detached, attached):
        timed(lambda: derivative(integrator))
    seconds = {i: min(timed(lambda: derivative(i)) for _ in range(2)) for i in (detached, attached)}
    best = min(seconds, key=seconds.get)
    timed(image)
    timed(iteration)
    timed(iteration)
    works = {"image": image, "derivative": lambda: derivative(best), "iteration": iteration}
    print("ready", flush=True)
    for line in sys.stdin:
        name = line.strip()
        if name == "memory":
            print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024**2, flush=True)
        else:
            print(timed(works[name]), flush=True)


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
    """A worker process, so that Mitsuba's memory is its own."""

    def __init__(self, scene_file, parameter, size, spp):
        command = [ENVIRONMENT / "bin" / "python", __file__, "--worker", scene_file, parameter, *map(str, size), str(spp)]
        self.process = subprocess.Popen([str(c) for c in command], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        text=True, env=os.environ | {"DRJIT_LIBLLVM_PATH": newest_llvm()})
        while self.process.stdout.readline().strip() != "ready":
            if self.process.poll() is not None:
                sys.exit("compare_mitsuba: Mitsuba stopped before it was ready")

    def ask(self, name):
        self.process.stdin.write(name + "\n")
        self.process.stdin.flush()
        return float(self.process.stdout.readline())

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def burnish(scene_file, parameter, size, spp):
    command = [ROOT / "build/bench/bench/burnish_stages", scene_file, parameter, "--size", *size, "--spp", spp,
               "--repeats", 3, "-D", "integrator=direct"]
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"compare_mitsuba: {done.stderr.strip()}")
    return json.loads(done.stdout)


def ratio(theirs, ours):
    ratios = [a / b for a, b in zip(theirs, ours)]
    return f"{statistics.median(ratios):5.2f} [{min(ratios):.2f}, {max(ratios):.2f}]"


def compare(name, scenes, arguments):
    scene_file, parameter = scenes / name / "scene.xml", PARAMETERS[name]
    theirs = {m: [] for m in MEASURES}
    ours = {m: [] for m in (*MEASURES, "iteration_identity", "iteration_mc", "rays", "memory")}
    mitsuba = Mitsuba(scene_file, parameter, arguments.size, arguments.spp)
    for _ in range(arguments.repeats):
        for m in MEASURES:
            theirs[m].append(mitsuba.ask(m))
        b = burnish(scene_file, parameter, arguments.size, arguments.spp)
        ours["image"].append(b["image_s"]["median"])
        ours["derivative"].append(b["derivative_s"]["median"])
        ours["iteration"].append(b["iteration_s"]["pgris_replay"]["whole"])
        ours["iteration_identity"].append(b["iteration_s"]["pgris_identity"]["whole"])
        ours["iteration_mc"].append(b["iteration_s"]["mc"]["whole"])
        ours["rays"].append(b["rays_alone_s"])
        ours["memory"].append(b["peak_memory_gb"])
    memory = mitsuba.ask("memory")
    mitsuba.close()

    median = statistics.median
    rows = [
        (f"image, {arguments.spp} spp", theirs["image"], ours["image"]),
        ("derivative, 1 spp", theirs["derivative"], ours["derivative"]),
        ("iteration, pgris replay", theirs["iteration"], ours["iteration"]),
        ("iteration, pgris identity", theirs["iteration"], ours["iteration_identity"]),
        ("iteration, mc", theirs["iteration"], ours["iteration_mc"]),
        ("peak memory, GB", [memory] * arguments.repeats, ours["memory"]),
    ]
    print(f"\n{name}, {arguments.size[0]} x {arguments.size[1]}")
    print(f"  {'':28} {'Mitsuba':>9} {'Burnish':>9}   Mitsuba / Burnish")
    for label, a, b in rows:
        print(f"  {label:28} {median(a):9.3f} {median(b):9.3f}   {ratio(a, b)}")
    print(f"  image / rays alone           {median(theirs['image']) / median(ours['rays']):9.2f} "
          f"{median(ours['image']) / median(ours['rays']):9.2f}   rays alone: {median(ours['rays']):.3f} s", flush=True)
    return {"scene": name, "mitsuba": theirs | {"memory": memory}, "burnish": ours}


def prepare():
    if not (ENVIRONMENT / "bin" / "python").exists():
        subprocess.run([sys.executable, "-m", "venv", str(ENVIRONMENT)], check=True)
    subprocess.run([str(ENVIRONMENT / "bin" / "pip"), "install", "-q", MITSUBA, "numpy"], check=True)
    subprocess.run(["cmake", "--preset", "bench"], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", "--preset", "bench", "--target", "burnish_stages"], cwd=ROOT, check=True,
                   stdout=subprocess.DEVNULL)


def main():
    if sys.argv[1:2] == ["--worker"]:
        scene_file, parameter, width, height, spp = sys.argv[2:]
        return worker(scene_file, parameter, int(width), int(height), int(spp))
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", type=Path)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--size", type=int, nargs=2, default=(350, 350))
    parser.add_argument("--spp", type=int, default=32)
    parser.add_argument("--scenes", dest="names", nargs="+", choices=PARAMETERS, default=list(PARAMETERS))
    parser.add_argument("--json", type=Path, help="also write the numbers here")
    arguments = parser.parse_args()
    prepare()
    results = [compare(name, arguments.scenes, arguments) for name in arguments.names]
    if arguments.json:
        arguments.json.write_text(json.dumps(results, indent=1))


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""The table of recovered textures: what `burnish optimize` makes of the captures of bench/captures.py with its
defaults, judged by bench/held_out.py with Mitsuba.

    bench/recovered.py CAPTURES -o FOLDER                            capture.json of every scene, 120 s for each run
    bench/recovered.py CAPTURES -o FOLDER --views front --seconds 60 the camera of the scene file alone
    bench/recovered.py CAPTURES -o FOLDER --scenes tire --inputs base_color roughness metallic
                                                                     several textures of the material together

CAPTURES holds SCENE/capture.json and so on. Writes FOLDER/recovered.json and FOLDER/recovered.md with commit, machine
and date, after each scene anew: a run that was stopped goes on where it was, if nothing is changed since the commit and
the programs are the same. Burnish is built into build/bench.
"""
import argparse
import hashlib
import json
import statistics
import sys
import time
from pathlib import Path

from benchmarks import ORDER, commit, is_clean, machine_and_date, table
from compare_sides import BUILD, build, call
from held_out import GROUPS, cell
from mitsuba_python import ROOT

NUMBER = "0.5"  # in every texel: what a texture is compared with


def arguments_of():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("captures", type=Path, metavar="CAPTURES")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER")
    parser.add_argument("--scenes", nargs="+", choices=ORDER, help="only these")
    parser.add_argument("--views", choices=("capture", "front"), default="capture")
    parser.add_argument("--inputs", nargs="+", metavar="NAME", help="of the unknown's material, instead of it")
    parser.add_argument("--seconds", type=int, default=120, help="of each run")
    parser.add_argument("--seed", type=int, default=0, help="of each run")
    parser.add_argument("--build", type=Path, help="a folder with the programs; nothing is built")
    return parser.parse_args()


def parameters_of(capture, inputs):
    """Those of the capture, or others of its material."""
    own, = json.loads((capture.parent / "made.json").read_text())["parameters"]
    material = own.removesuffix(".data").rpartition(".")[0]
    return [f"{material}.{name}.data" for name in inputs] if inputs else [own]


def search_of(programs, capture, parameters, seconds, seed):
    """What the start of such a run is and what pictures resolve: both texture errors are those of the search's own
    test."""
    if len(parameters) > 1:
        return {}
    effort = min(max(seconds / 60, 1), 4)
    return json.loads(call(programs / "bench" / "burnish_start_search", capture, *parameters, "--runs", "1",
                           "--seed", seed, "--effort", effort))


def judge(capture, parameters, textures, folder):
    """The number, and what was recovered."""
    call(sys.executable, ROOT / "bench" / "held_out.py", capture, NUMBER, textures, "-o", folder,
         *(f"--parameter={p}" for p in parameters))
    return json.loads((folder / "held_out.json").read_text())["judged"]


def decibels(judged):
    """Of each view, by kind."""
    views = {g: [v["psnr"] for v in judged["views"] if v["group"] == g] for g in GROUPS}
    return {g: values for g, values in views.items() if values}


def row(scene, capture, arguments, programs):
    folder = arguments.output / scene
    parameters = parameters_of(capture, arguments.inputs)
    start = time.monotonic()
    call(programs / "burnish", "optimize", capture, *(f"--parameter={p}" for p in parameters),
         "--time", arguments.seconds, "--seed", arguments.seed, "-o", folder, "--force")
    in_all = time.monotonic() - start
    summary = json.loads((folder / "summary.json").read_text())["result"]
    before, after = judge(capture, parameters, folder / "textures", folder)
    search = search_of(programs, capture, parameters, arguments.seconds, arguments.seed)
    return {"scene": scene, "parameters": parameters, "iterations": summary["iterations"],
            "seconds": summary["seconds"], "seconds_in_all": in_all,
            "psnr_of_number": decibels(before), "psnr": decibels(after),
            "texture_errors_of_number": list(before["texture_error"].values()),
            "texture_errors": list(after["texture_error"].values()),
            "texture_error_of_start": search.get("error"), "texture_error_resolved": search.get("error_resolved")}


ERRORS = ["scene", "unknown", "texture error: 0.5", "start", "recovered", "resolved", "iterations", "in all"]
PICTURES = ["scene", *GROUPS]


def error_cells(r):
    names = [p.removesuffix(".data").rpartition(".")[2] for p in r["parameters"]]
    errors = [r["texture_errors_of_number"], [r["texture_error_of_start"]], r["texture_errors"],
              [r["texture_error_resolved"]]]
    return [r["scene"], ", ".join(names),
            *(", ".join("" if e is None else f"{e:.3f}" for e in several) for several in errors),
            str(r["iterations"]), f"{r['seconds_in_all']:.0f} s"]


def picture_cells(r):
    return [r["scene"], *(f"{statistics.fmean(r['psnr_of_number'][g]):.1f} → {cell(r['psnr'][g])}"
                          if g in r["psnr"] else "" for g in GROUPS)]


def tables(rows):
    return "\n\n".join((table(ERRORS, map(error_cells, rows)), table(PICTURES, map(picture_cells, rows))))


def markdown(results):
    return "\n".join([f"    {results['command']}", "",
                      f"Commit {results['commit']}, {results['date']}, {results['machine']}; "
                      f"{results['seconds']} s of iterations for each run; *in all*: from its start until its results "
                      "are written. PSNR: the mean of the views, in brackets the least of several.", "",
                      tables(results["rows"]), ""])


def command_of(arguments):
    """Without the paths of this machine."""
    parts = ["bench/recovered.py CAPTURES -o FOLDER"]
    parts += [f"--views {arguments.views}"] if arguments.views != "capture" else []
    parts += ["--inputs " + " ".join(arguments.inputs)] if arguments.inputs else []
    parts += [f"--seconds {arguments.seconds}"] if arguments.seconds != 120 else []
    parts += [f"--seed {arguments.seed}"] if arguments.seed else []
    parts += ["--scenes " + " ".join(arguments.scenes)] if arguments.scenes else []
    return " ".join(parts)


def hashes_of(programs):
    """Of those whose numbers the rows are, where they are there."""
    files = (programs / "burnish", programs / "bench" / "burnish_start_search")
    return [hashlib.sha256(f.read_bytes()).hexdigest() for f in files if f.exists()]


def earlier_rows(file, results):
    """Of a run that was stopped. A commit does not tell what a tree with changes holds, nor of which commit the
    programs of --build are."""
    if not file.exists() or not is_clean(results["commit"]):
        return []
    earlier = json.loads(file.read_text())
    kept = ("commit", "programs", "command", "captures", "seconds", "machine")
    same = all(earlier.get(k) == results[k] for k in kept)
    return earlier["rows"] if same else []


def main():
    arguments = arguments_of()
    if not arguments.build:
        build("burnish_program", "burnish_start_search")
    programs = arguments.build or BUILD
    results = {"command": command_of(arguments), "captures": str(arguments.captures.resolve()), "commit": commit(),
               "programs": hashes_of(programs), "seconds": arguments.seconds} | machine_and_date()
    file = arguments.output / "recovered.json"
    results["rows"] = earlier_rows(file, results)
    arguments.output.mkdir(parents=True, exist_ok=True)
    for scene in arguments.scenes or ORDER:
        capture = arguments.captures / scene / f"{arguments.views}.json"
        if any(r["scene"] == scene for r in results["rows"]):
            continue
        if not capture.exists():
            print(f"recovered: {capture}: no such capture, left out", flush=True)
            continue
        print(f"recovered: {scene}", flush=True)
        results["rows"].append(row(scene, capture, arguments, programs))
        file.write_text(json.dumps(results, indent=1) + "\n")
        (arguments.output / "recovered.md").write_text(markdown(results))
    print(tables(results["rows"]))


if __name__ == "__main__":
    main()

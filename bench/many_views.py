#!/usr/bin/env python3
"""Many pictures and a large texture: how soon a run steps, how soon it has seen every picture, and its memory.

    bench/many_views.py -o FOLDER                       100 pictures of 800 x 800, a texture of 4096 x 4096
    bench/many_views.py -o FOLDER --views 20 --size 400 --texture-size 1024

The goblet of `burnish scene` from places all around it. Burnish makes the pictures, with few samples: nobody judges the
texture here. FOLDER/capture.json names them; `burnish optimize` starts from the search, as it does by default, and goes
on for a quarter more iterations than it needs to see all of them. Seconds count from the start of the program. Writes
FOLDER/many_views.json.
"""
import argparse
import json
import math
import shutil
import subprocess
import time
from pathlib import Path

from scaling import ROOT, rows_of

PARAMETER = "mat-goblet.roughness"
SENSOR = """    <sensor type="perspective"><float name="fov" value="46"/>
        <transform name="to_world"><lookat origin="{0:.9g}, 1.9, {1:.9g}" target="0, 0.83, 0" up="0, 1, 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="{2}"/><integer name="height" value="{2}"/></film></sensor>
"""


def arguments_of():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER")
    parser.add_argument("--views", type=int, default=100)
    parser.add_argument("--size", type=int, default=800, help="pixels a side")
    parser.add_argument("--texture-size", type=int, default=4096, help="texels a side")
    parser.add_argument("--spp", type=int, default=4, help="samples per pixel of the pictures")
    parser.add_argument("--burnish", type=Path, default=ROOT / "build/release/burnish", help="the program")
    return parser.parse_args()


def make_capture(arguments):
    """Pictures that are there stay."""
    folder = arguments.output
    scene, record = folder / "goblet/scene.xml", folder / "made.json"
    made = {name: getattr(arguments, name) for name in ("views", "size", "texture_size", "spp")}
    if scene.exists() and (not record.exists() or json.loads(record.read_text()) != made):
        raise SystemExit(f"many_views: {folder} holds pictures of other options: expected another folder")
    if not scene.exists():
        folder.mkdir(parents=True, exist_ok=True)
        record.write_text(json.dumps(made) + "\n")
        subprocess.run([arguments.burnish, "scene", "goblet", "-o", scene.parent, "--texture-size",
                        str(arguments.texture_size)], check=True, stdout=subprocess.DEVNULL)
        angles = [2 * math.pi * (i + 0.1) / arguments.views for i in range(arguments.views)]
        sensors = "".join(SENSOR.format(2.5 * math.sin(a), 2.5 * math.cos(a), arguments.size) for a in angles)
        start, end = scene.read_text().rsplit("</scene>", 1)
        scene.write_text(start + sensors + "</scene>" + end)
    (folder / "images").mkdir(exist_ok=True)
    views = []
    for i in range(arguments.views):
        image = folder / f"images/{i}.exr"
        if not image.exists():
            subprocess.run([arguments.burnish, "render", scene, "--sensor", str(i + 1), "--spp", str(arguments.spp), "-o",
                            image], check=True, capture_output=True)
        views.append({"name": str(i), "image": f"images/{i}.exr", "camera": {"sensor": i + 1}})
    (folder / "capture.json").write_text(json.dumps({"version": 1, "scene": "goblet/scene.xml", "views": views}))


def memory_of(process):
    """Resident bytes; none: it has ended."""
    try:
        text = Path(f"/proc/{process.pid}/status").read_text()
    except FileNotFoundError:
        return None
    found = [line.split()[1] for line in text.splitlines() if line.startswith("VmRSS")]
    return int(found[0]) * 1024 if found else None


def has_begun(history):
    """Whether an iteration has ended."""
    return history.exists() and len(history.read_text().splitlines()) > 1


def follow(command, history):
    """Runs it. Seconds from its start to its first iteration's end, and [seconds, bytes] as it went."""
    start = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    began, memory = None, []
    while process.poll() is None:
        seconds = time.monotonic() - start
        if began is None and has_begun(history):
            began = seconds
        if resident := memory_of(process):
            memory.append((seconds, resident))
        time.sleep(0.1)
    if process.returncode:
        raise SystemExit(f"many_views: burnish optimize ended with {process.returncode}")
    return began, memory


def run(arguments):
    out = arguments.output / "recovered"
    shutil.rmtree(out, ignore_errors=True)
    iterations = arguments.views + arguments.views // 4
    began, memory = follow([arguments.burnish, "optimize", arguments.output / "capture.json", "--parameter", PARAMETER,
                            "--iterations", str(iterations), "--evaluation-spp", "1", "-o", out],
                           out / "checkpoints/history.csv")
    rows = rows_of(out)
    ends = [began + row["seconds"] - rows[0]["seconds"] for row in rows]  # of iterations

    def seconds_of(count):
        return round(ends[count - 1], 1) if len(ends) >= count else None

    def bytes_at(seconds):
        return next(b for s, b in memory if s >= seconds)
    # An iteration visits one view; one is visited again when all have been.
    result = {"views": arguments.views, "size": arguments.size, "texture_size": arguments.texture_size,
              "seconds_to_first_iteration": seconds_of(1), "seconds_to_all_views": seconds_of(arguments.views),
              "seconds_to_results": round(memory[-1][0], 1), "iterations": len(ends), "peak_bytes": max(b for _, b in memory)}
    if len(ends) >= arguments.views:
        result |= {"bytes_after_all_views": bytes_at(ends[arguments.views - 1]), "bytes_at_the_end": bytes_at(ends[-1])}
    return result


def main():
    arguments = arguments_of()
    arguments.output.mkdir(parents=True, exist_ok=True)
    make_capture(arguments)
    result = run(arguments)
    (arguments.output / "many_views.json").write_text(json.dumps(result, indent=2) + "\n")
    for name, value in result.items():
        print(f"{name:28} {value / 2 ** 30:.2f} GiB" if "bytes" in name and value else f"{name:28} {value}")


if __name__ == "__main__":
    main()

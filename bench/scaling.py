#!/usr/bin/env python3
"""How a run scales over processes: measured on this machine, and a model of time and traffic that says what others do.

    bench/scaling.py measure -o FOLDER     runs of 1, 2 and 4 processes of one thread on eight views of the goblet
    bench/scaling.py model FOLDER          those runs, and what the model says of them
    bench/scaling.py simulate FOLDER       1 to 64 nodes: table, and FOLDER/scaling.svg

`measure` writes FOLDER/scaling.json. `simulate` draws the batches of a run, shares their views out as burnish-mpi does,
and adds up the seconds of the slowest process, of the messages and of the step. Its options say what a node and the
problem are; what they take is in the measured file, in seconds of one thread.
"""
import argparse
import json
import math
import os
import random
import statistics
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
COUNTS = (1, 2, 4)


def look_at(origin, target):
    """camera_to_world of a camera that looks along z, x right, y down."""
    def unit(a):
        return [x / math.sqrt(sum(y * y for y in a)) for x in a]

    def cross(a, b):
        return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    z = unit([t - o for o, t in zip(origin, target)])
    x = unit(cross(z, (0, 1, 0)))
    y = cross(z, x)
    return [[x[i], y[i], z[i], origin[i]] for i in range(3)] + [[0, 0, 0, 1]]


def make_capture(folder, program, views, size, texture):
    """Views all around the goblet, rendered."""
    subprocess.run([program, "scene", "goblet", "-o", folder / "goblet", "--texture-size", str(texture)], check=True)
    entries = []
    for i in range(views):
        angle = 2 * math.pi * (i + 0.1) / views
        eye = [3.65 * math.sin(angle), 1.75, 3.65 * math.cos(angle)]
        camera = {"model": "PINHOLE", "width": size, "height": size, "params": [1.8 * size, 1.8 * size, size / 2, size / 2],
                  "camera_to_world": look_at(eye, (0, 0.83, 0))}
        entries.append({"name": f"view{i}", "camera": camera})
    capture = {"version": 1, "scene": "goblet/scene.xml", "views": entries}
    (folder / "capture.json").write_text(json.dumps(capture))


def rows_of(folder):
    """history.csv as dictionaries of numbers."""
    lines = (folder / "history.csv").read_text().splitlines()
    names = lines[0].split(",")
    return [{n: float(v) for n, v in zip(names, line.split(",")) if v} for line in lines[1:]]


def run(arguments, count):
    out = arguments.output / f"processes{count}"
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    command = ["mpirun", "--oversubscribe", "--bind-to", "none", "-n", str(count), arguments.program, "optimize",
               "capture.json", "--parameter", "mat-goblet.roughness", "--init", "0.5", "--set",
               f"batch={arguments.views}", "--threads", "1", "--target-spp", "4", "--evaluation-spp", "2",
               "--spp", str(arguments.spp), "--iterations", str(arguments.iterations), "--max-memory", "4",
               "--force", "-o", out.name]
    subprocess.run(command, check=True, cwd=arguments.output, env=environment)
    summary = json.loads((out / "summary.json").read_text())
    rows = rows_of(out)
    times = [b["seconds"] - a["seconds"] for a, b in zip(rows, rows[1:])][arguments.warm_up:]
    kept = rows[1 + arguments.warm_up:]

    def middle(*names):
        return statistics.median(sum(r[n] for n in names) for r in kept)
    return {"processes": count, "iteration": statistics.median(times), "slowest": middle("image_seconds", "derivative_seconds"),
            "step": middle("step_seconds"), "peak_bytes": summary["peak_memory_bytes"],
            "sent_bytes": summary.get("processes", {}).get("sent_bytes", 0) / len(rows)}


def measure(arguments):
    arguments.program = arguments.program.resolve()
    arguments.output.mkdir(parents=True, exist_ok=True)
    make_capture(arguments.output, arguments.program.parent / "burnish", arguments.views, arguments.size,
                 arguments.texture)
    result = {"views": arguments.views, "pixels": arguments.size ** 2, "floats": arguments.texture ** 2,
              "cores": os.cpu_count(), "runs": [run(arguments, count) for count in COUNTS]}
    (arguments.output / "scaling.json").write_text(json.dumps(result, indent=2) + "\n")
    show_model(arguments)


def visits(views, processes):
    """Of the process that has most: whole views, or bands where there are fewer views than processes."""
    return views / processes if processes > views else math.ceil(views / processes)


MARGIN_ROWS = 32  # of a texture, around the part of a process: what its coarser texels read, with five levels
WHOLE_STEP = 0.04  # of a step: what every process does, the sums of the coarser levels


def read_share(processes, side):
    """Of a gradient: what the part of a process reads."""
    return min(1.0, 1 / processes + MARGIN_ROWS / side)


def step_share(processes):
    """Of the seconds of a step by one process."""
    return 1.0 if processes == 1 else 1 / processes + WHOLE_STEP


class Model:
    """What an iteration takes, from measured runs of one process and of two."""

    def __init__(self, measured, latency, bandwidth):
        alone = measured["runs"][0]
        two = next(r for r in measured["runs"] if r["processes"] == 2)
        self.visit = alone["slowest"] / measured["views"]      # seconds of a view, on one thread
        self.step = alone["step"]                              # of sums and the optimiser, on one thread
        self.floats = measured["floats"]
        self.side = math.sqrt(self.floats)
        # Of one view this has the tiles of its images, too.
        gradient = two["sent_bytes"] / self.floats - self.moved_bytes(2, 1)
        self.dirty = min(1.0, max(0.0, gradient / (8 * read_share(2, self.side))))
        self.latency, self.bandwidth = latency, bandwidth

    @staticmethod
    def moved_bytes(processes, floats):
        """What a process sends of the texels that it has stepped, to all others: all that ever had a gradient, here
        every one, with a third more on the coarser levels."""
        return 4 * 4 / 3 * floats * (processes - 1) / processes

    def messages(self, processes, floats, dirty, side, unknowns=1):
        """Seconds of an iteration's exchanges: losses, counts, parts of the views' sums, what was left out; and for
        each unknown gates, texels of the coarser levels, and those of the texture."""
        if processes == 1:
            return 0.0
        gradient = 8 * floats * dirty * (processes - 1) * read_share(processes, side)  # two halves of four bytes each
        sent = gradient + self.moved_bytes(processes, floats)
        return (4 + 3 * unknowns) * self.latency * (processes - 1) + sent / self.bandwidth


def show_model(arguments):
    measured = json.loads((arguments.output / "scaling.json").read_text())
    model = Model(measured, arguments.latency, arguments.bandwidth)
    print("| processes | s an iteration | model | difference | speed | messages | bytes sent | memory, MB |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    alone = measured["runs"][0]
    for r in measured["runs"]:
        n = r["processes"]
        parallel = min(n, measured["cores"])
        views = visits(measured["views"], n) * n / parallel  # of a core
        messages = model.messages(n, model.floats, model.dirty, model.side)
        step = model.step * step_share(n) * n / parallel
        said = views * model.visit + step + messages
        share = max(0.0, r["iteration"] - r["slowest"] - step) / r["iteration"]
        print(f"| {n} | {r['iteration']:.3f} | {said:.3f} | {100 * (said / r['iteration'] - 1):+.0f} % | "
              f"{alone['iteration'] / r['iteration']:.2f} | {100 * share:.1f} % | {r['sent_bytes'] / 1e6:.2f} MB | "
              f"{r['peak_bytes'] / 1e6:.0f} |")


def slowest_share(views, batch, nodes, draw):
    """Views of the process that has most of a batch: those of src/optimize/batch.cpp, owned as in ranks.cpp."""
    if views % batch == 0:
        run = views // batch
        chosen = [k * run + draw.randrange(run) for k in range(batch)]
    else:
        chosen = draw.sample(range(views), batch)
    counts = [0] * nodes
    for view in chosen:
        counts[view * nodes // views] += 1
    return max(counts)


def simulate(arguments):
    measured = json.loads((arguments.output / "scaling.json").read_text())
    model = Model(measured, arguments.latency, arguments.bandwidth)
    scale = arguments.pixels / measured["pixels"] / arguments.cores / arguments.efficiency
    floats = arguments.texture ** 2 * arguments.channels
    step = model.step * floats / model.floats / arguments.memory_threads
    draw = random.Random(1)
    curves = {}
    for batch in arguments.batches:
        curve = curves.setdefault(batch, [])
        for nodes in arguments.nodes:
            if nodes > batch:
                continue
            work = statistics.mean(slowest_share(arguments.views, batch, nodes, draw) *
                                   max(draw.lognormvariate(0, arguments.spread) for _ in range(nodes))
                                   for _ in range(100))
            messages = model.messages(nodes, floats, arguments.dirty, arguments.texture, arguments.unknowns)
            parts = (work * model.visit * scale, messages, step * step_share(nodes))
            curve.append((nodes, *parts))
    print("| batch | nodes | s an iteration | views | messages | step | views a second | efficiency |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    for batch, curve in curves.items():
        first = batch / sum(curve[0][1:]) / curve[0][0]
        for nodes, *parts in curve:
            rate = batch / sum(parts)
            print(f"| {batch} | {nodes} | {sum(parts):.2f} | {parts[0]:.2f} | {parts[1]:.2f} | {parts[2]:.2f} | "
                  f"{rate:.1f} | {100 * rate / nodes / first:.0f} % |")
    (arguments.output / "scaling.svg").write_text(drawing_of(curves))


def drawing_of(curves):
    """Views a second by nodes, both on logarithmic axes."""
    width, height, left, bottom = 560, 360, 60, 40
    points = {b: [(n, b / sum(p)) for n, *p in c] for b, c in curves.items()}
    rates = [r for c in points.values() for _, r in c]
    nodes = sorted({n for c in points.values() for n, _ in c})
    low, high = 10 ** math.floor(math.log10(min(rates))), 10 ** math.ceil(math.log10(max(rates)))

    def at(n, rate):
        x = left + (width - left - 100) * math.log(n / nodes[0]) / max(1e-9, math.log(nodes[-1] / nodes[0]))
        y = height - bottom - (height - bottom - 20) * math.log(rate / low) / math.log(high / low)
        return f"{x:.1f}", f"{y:.1f}"
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" font-family="sans-serif" '
             f'font-size="12"><rect width="{width}" height="{height}" fill="white"/>']

    def text(x, y, what, anchor="middle"):
        parts.append(f'<text x="{x}" y="{y}" text-anchor="{anchor}">{what}</text>')
    for n in nodes:
        x, _ = at(n, low)
        parts.append(f'<line x1="{x}" x2="{x}" y1="20" y2="{height - bottom}" stroke="#ddd"/>')
        text(x, height - bottom + 16, n)
    rate = low
    while rate <= high:
        _, y = at(nodes[0], rate)
        parts.append(f'<line x1="{left}" x2="{width - 100}" y1="{y}" y2="{y}" stroke="#ddd"/>')
        text(left - 6, float(y) + 4, f"{rate:g}", "end")
        rate *= 10
    text((left + width - 100) / 2, height - 6, "nodes")
    text(left, 14, "views a second", "start")
    text(width - 100, 14, "dashed: in proportion to the nodes", "end")
    for color, (batch, curve) in zip(("#1b6ca8", "#c0392b", "#27803b", "#8e44ad"), points.items()):
        ends = " ".join(",".join(at(n, r)) for n, r in curve)
        parts.append(f'<polyline points="{ends}" fill="none" stroke="{color}" stroke-width="2"/>')
        x, y = at(*curve[-1])
        parts.append(f'<text x="{float(x) + 6:.1f}" y="{float(y) + 4:.1f}" fill="{color}">batch {batch}</text>')
        x, y = at(curve[-1][0], curve[0][1] * curve[-1][0] / curve[0][0])
        ideal = f'{",".join(at(*curve[0]))} {x},{max(20.0, float(y)):.1f}'
        parts.append(f'<polyline points="{ideal}" fill="none" stroke="{color}" stroke-dasharray="3 3" opacity="0.5"/>')
    return "\n".join(parts + ["</svg>", ""])


def arguments_of():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    m = commands.add_parser("measure")
    m.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER")
    m.add_argument("--program", type=Path, default=ROOT / "build/release/burnish-mpi")
    m.add_argument("--views", type=int, default=8)
    m.add_argument("--size", type=int, default=256, help="pixels of a side of each view")
    m.add_argument("--texture", type=int, default=512, help="texels of a side")
    m.add_argument("--spp", type=int, default=4)
    m.add_argument("--iterations", type=int, default=30)
    m.add_argument("--warm-up", type=int, default=10, help="iterations that are left out")
    m.set_defaults(call=measure)
    for name, call in (("model", show_model), ("simulate", simulate)):
        p = commands.add_parser(name)
        p.add_argument("output", type=Path, metavar="FOLDER")
        p.set_defaults(call=call)
    for p, latency, bandwidth in ((m, 2e-5, 2e9), (commands.choices["model"], 2e-5, 2e9),
                                  (commands.choices["simulate"], 5e-6, 1e10)):
        p.add_argument("--latency", type=float, default=latency, help="seconds of a message")
        p.add_argument("--bandwidth", type=float, default=bandwidth, help="bytes a second, of a node")
    s = commands.choices["simulate"]
    s.add_argument("--nodes", type=int, nargs="+", default=[1, 2, 4, 8, 16, 32, 64])
    s.add_argument("--cores", type=int, default=32, help="of a node")
    s.add_argument("--efficiency", type=float, default=0.8, help="of a node's threads together")
    s.add_argument("--memory-threads", type=float, default=8, help="threads that fill a node's memory bandwidth")
    s.add_argument("--views", type=int, default=1000)
    s.add_argument("--pixels", type=float, default=2e6, help="of a view")
    s.add_argument("--texture", type=int, default=8192, help="texels of a side")
    s.add_argument("--channels", type=int, default=4, help="of all textures")
    s.add_argument("--unknowns", type=int, default=2, help="textures that they are")
    s.add_argument("--dirty", type=float, default=0.5, help="share of a texture in the sum of a process's views")
    s.add_argument("--spread", type=float, default=0.05, help="of the seconds of a visit")
    s.add_argument("--batches", type=int, nargs="+", default=[1000, 200, 64])
    arguments = parser.parse_args()
    if arguments.call is measure and arguments.iterations < arguments.warm_up + 2:
        parser.error("--iterations: expected at least two more than --warm-up")
    if arguments.call is simulate and max(arguments.batches) > arguments.views:
        parser.error(f"--batches: expected at most the {arguments.views} views")
    if arguments.call is simulate and min(arguments.nodes) > min(arguments.batches):
        parser.error("--nodes: expected one that is not above the smallest of --batches")
    return arguments


if __name__ == "__main__":
    given = arguments_of()
    given.call(given)

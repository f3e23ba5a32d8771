"""The tables of bench/compare_mitsuba.py. A ratio is Mitsuba / Burnish: above 1 Burnish is better."""
import math
import statistics
from typing import NamedTuple

WIDTH = 52
PROGRESS = 0.995  # of the loss at the start: above it nothing has been reached that both could be timed for


class Row(NamedTuple):
    """One measure, a number per repeat of each side."""
    label: str
    theirs: list
    ours: list
    form: str = ".3f"

    def ratio(self):
        """"median [min, max]" over the repeats whose pairs are comparable."""
        ratios = [a / b for a, b in self.comparable()]
        if not ratios:
            return "-"
        text = f"{statistics.median(ratios):.3g} [{min(ratios):.3g}, {max(ratios):.3g}]"
        return text + (f" in {len(ratios)} of {len(self.ours)}" if len(ratios) < len(self.ours) else "")

    def comparable(self):
        """Pairs of what was reached. A loss without its noise may be below 0: it has no ratio."""
        return [(a, b) for a, b in zip(self.theirs, self.ours) if 0 < a < math.inf and 0 < b < math.inf]

    def medians(self):
        pairs = self.comparable()
        return [f"{statistics.median(x):{self.form}}" for x in zip(*pairs)] if pairs else ["-", "-"]


# ---- Loss over seconds


def curve_of(run, start, before=0.0):
    """(seconds, loss) at the moments; `before`: seconds that passed before the first iteration."""
    return [(0.0, start), (before, start)] + [(before + m["seconds"], m["loss"]) for m in run["moments"]]


def loss_at(curve, seconds):
    """Between moments, in proportion."""
    for (t0, l0), (t1, l1) in zip(curve, curve[1:]):
        if t1 >= seconds > t0:
            return l0 + (l1 - l0) * (seconds - t0) / (t1 - t0)
    return curve[-1][1]


def seconds_to(curve, loss):
    """When the curve first is at the loss; infinite: never. In proportion between moments, but not before the first: a
    few iterations lead there, and the loss after each is not known."""
    for (t0, l0), (t1, l1) in zip(curve, curve[1:]):
        if l1 <= loss < l0:
            return t1 if (t0, l0) == curve[1] else t0 + (t1 - t0) * (l0 - loss) / (l0 - l1)
    return math.inf


# ---- Rows


def stage_rows(stages):
    theirs, ours = stages["mitsuba"], stages["burnish"]
    yield Row("image, 32 spp, s", theirs["image"], [b["image_s"]["median"] for b in ours])
    yield Row("derivative, 1 spp, mc, s", theirs["derivative"], [b["derivative_s"]["median"] for b in ours])
    for variant in ours[0]["iteration_s"]:
        yield Row(f"iteration, 32+1 spp, {variant}, s", theirs["iteration"],
                  [b["iteration_s"][variant]["whole"] for b in ours])


def memory_row(results):
    theirs, done = results["mitsuba"]["peak_memory_gb"], results.get("runs", {}).get("done", [])
    ours = [d["peak_memory_gb"] for d in done if d["side"].endswith(" texels") and d["split"] == [32, 1]]
    ours = ours or [b["peak_memory_gb"] for b in results["stages"]["burnish"]]
    return Row("peak memory, 32+1 spp, GB", [theirs] * len(ours), ours)


def derivative_rows(derivatives):
    for variant, ours in derivatives["variants"].items():
        theirs = ours["mitsuba"]
        yield Row(f"derivative NMSE, equal time, {variant}", theirs["nmse"], ours["nmse"], ".3g")
        yield Row(f"    its seconds, {variant}", theirs["seconds"], ours["seconds"], ".4f")
        yield Row(f"    its samples per pixel, {variant}", [theirs["spp"]], [ours["spp"]], ".0f")


def of_best_split(runs, side):
    return [d for d in runs["done"] if d["side"] == side and d["split"] == runs["best"][side]]


def run_rows(results, jit):
    runs = results["runs"]
    theirs = of_best_split(runs, "mitsuba")
    for side in list(runs["best"])[1:]:
        ours = of_best_split(runs, side)
        yield from pair_rows(side + (", with JIT" if jit else ""), theirs, ours, runs["start"], results["seconds"],
                             jit)


def pair_rows(label, theirs, ours, start, seconds, jit):
    curves = [(curve_of(a, start, a["compile_s"] if jit else 0.0), curve_of(b, start)) for a, b in zip(theirs, ours)]
    ends = [(loss_at(a, seconds), loss_at(b, seconds)) for a, b in curves]
    yield Row(f"loss after {seconds:g} s, {label}", *zip(*ends), ".4g")
    # What both reach, if the loss fell at all.
    goals = [max(pair) if max(pair) < PROGRESS * start else -math.inf for pair in ends]
    reached = [tuple(min(seconds_to(c, goal), seconds if goal > 0 else math.inf) for c in pair)
               for pair, goal in zip(curves, goals)]
    yield Row(f"s to equal loss, {label}", *zip(*reached), ".2f")


def groups_of(results):
    """Lists of rows, by what they are about."""
    groups = [[*stage_rows(results["stages"]), memory_row(results)]]
    if results["seconds"]:
        groups.append(list(derivative_rows(results["derivatives"])))
        groups += [list(run_rows(results, jit)) for jit in (False, True)]
    return groups


# ---- Tables


def split_lines(runs):
    for side in runs["best"]:
        ends = {f"{d['split'][0]}+{d['split'][1]}": d["moments"][-1] for d in runs["done"]
                if d["side"] == side and d["repeat"] == 0}
        yield (f"loss by split, {side}: "
               + ", ".join(f"{k} {m['loss']:.4g} ({m['iterations']} iterations)" for k, m in ends.items()))


def remarks(results):
    """What the rows do not say."""
    mitsuba = results["mitsuba"]
    rays = statistics.median(b["rays_alone_s"] for b in results["stages"]["burnish"])
    yield f"rays of the image alone, in Burnish: {rays:.3f} s"
    if results["seconds"]:
        yield (f"loss at the start: {results['runs']['start']:.4g}; "
               "equal loss is the larger of both ends, if it is 0.5 % below")
        yield from split_lines(results["runs"])
        yield f"NMSE of the converged derivative: {results['derivatives']['reference_nmse']:.2g}, corrected for"
    compiled = ", ".join(f"{k} {v:.2f} s" for k, v in mitsuba["compile_s"].items())
    yield f"JIT compilation of Mitsuba, in the rows \"with JIT\" alone: {compiled}"
    yield (f"Mitsuba's iterations {'with' if mitsuba['frozen'] else 'without'} kernel freezing"
           + (f"; it failed: {mitsuba['freezing_error']}" if mitsuba["freezing_error"] else ""))


def print_scene(results):
    print(f"\n{results['scene']}, {' x '.join(results['size'])}")
    print(f"  {'':{WIDTH}} {'Mitsuba':>9} {'Burnish':>9}   Mitsuba / Burnish")
    for row in (row for group in groups_of(results) for row in group):
        a, b = row.medians()
        print(f"  {row.label:{WIDTH}} {a:>9} {b:>9}   {row.ratio()}")
    for line in remarks(results):
        print(f"  {line}")
    print(flush=True)


def markdown(all_results):
    """A table per group, a row per scene: the medians of both sides and the ratio."""
    tables = []
    for groups in zip(*(groups_of(r) for r in all_results)):
        lines = ["| | " + " | ".join(row.label.strip() for row in groups[0]) + " |"]
        lines.append("| --- " * (len(groups[0]) + 1) + "|")
        for results, rows in zip(all_results, groups):
            cells = [f"{row.medians()[0]} / {row.medians()[1]}: {row.ratio()}" if row.ratio() != "-" else "-"
                     for row in rows]
            lines.append(f"| {results['scene']} | " + " | ".join(cells) + " |")
        tables.append("\n".join(lines))
    return "\n\n".join(tables)

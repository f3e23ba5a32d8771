#!/usr/bin/env python3
"""Stock Mitsuba 3 renders the procedural scenes as Burnish does.

    tests/scenes/agree_with_mitsuba.py BURNISH [NAME...] [--size 96] [--batches 32] [--spp 32]

BURNISH is the program to test. Mitsuba is imported by the interpreter that BURNISH_MITSUBA_PYTHON names, or by
build/mitsuba/bin/python, or by the one that runs this file; where none of them has it, the test is skipped (exit
status 77). Variant scalar_rgb, so no LLVM is needed.

For every scene both programs render independent batches, with seeds that do not change from run to run. The means
of the batches are compared in every tile of 8 x 8 pixels and in the whole image, channel by channel, by Welch's t; the
smallest p-value counts times the number of comparisons (Bonferroni). alpha = 2.5e-7 for each scene, 1e-6 in all. The means of the
whole images must agree within 1 %. Then the scene that Burnish renders is changed a little, by editing scene.xml, and
the same comparison must reject it.

Both render with a box filter, which has no bias of a ratio: Mitsuba divides by the filter weights that the samples
happened to have.
"""
import argparse
import math
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "bench"))
from mitsuba_python import interpreter_with_mitsuba

ALPHA = 2.5e-7
MEAN_TOLERANCE = 0.01
TILE = 8
SKIPPED = 77


def scaled(factor):
    def scale(match):
        values = ", ".join(f"{float(v) * factor:.6f}" for v in match[2].split(","))
        return match[1] + values + match[3]
    return scale


AREA_LIGHT = r'(<emitter type="area"><rgb name="radiance" value=")([^"]*)(")'
ROUGHNESS = r'(<float name="roughness" value=")([^"]*)(")'
# Of each scene: what is changed, the pattern, by what factor, how often.
DEFECTS = {
    "goblet": ("lamps + 2 %", AREA_LIGHT, 1.02, 0),
    "tyre": ("one soft box + 10 %", AREA_LIGHT, 1.10, 1),
    "bowl": ("roughness + 3 %", ROUGHNESS, 1.03, 1),
    "tree": ("bulbs + 3 %", AREA_LIGHT, 1.03, 0),
}


def with_defect(text, name):
    _, pattern, factor, count = DEFECTS[name]
    changed, times = re.subn(pattern, scaled(factor), text, count=count)
    assert times > 0, f"{name}: nothing to change"
    return changed


def t_tail(t, df):
    """P(|T| > t) for Student's t: the regularised incomplete beta function by Lentz's continued fraction."""
    a, b, x = df / 2, 0.5, df / (df + t * t)
    if x >= 1:
        return 1.0
    if x > (a + 1) / (a + b + 2):
        return 1 - incomplete_beta(b, a, 1 - x)
    return incomplete_beta(a, b, x)


def incomplete_beta(a, b, x):
    front = math.exp(math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b) + a * math.log(x) + b * math.log1p(-x)) / a
    c, d = 1.0, 1 / (1 - (a + b) * x / (a + 1))
    fraction = d
    for m in range(1, 400):
        for numerator in (m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)),
                          -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))):
            d = 1 / (1 + numerator * d)
            c = 1 + numerator / c
            fraction *= c * d
        if abs(c * d - 1) < 1e-12:
            break
    return front * fraction


def tiles(image):
    """[height, width, 3] to the means of tiles and then of the whole image, flat; channel fastest."""
    import numpy as np

    h, w, _ = image.shape
    image = np.asarray(image, dtype=np.float64)
    of_tiles = image.reshape(h // TILE, TILE, w // TILE, TILE, 3).mean(axis=(1, 3)).ravel()
    return np.concatenate([of_tiles, image.mean(axis=(0, 1))])


def welch(ours, theirs):
    """Smallest p-value over the columns times their number, and the column; not a number where one is not.

    [batches, columns] each.
    """
    na, nb = len(ours), len(theirs)
    va, vb = ours.var(axis=0, ddof=1) / na, theirs.var(axis=0, ddof=1) / nb
    worst = (2.0, -1)
    for i, (d, a, b) in enumerate(zip(ours.mean(axis=0) - theirs.mean(axis=0), va, vb)):
        if a + b == 0:
            p = 1.0 if d == 0 else 0.0
        else:
            df = (a + b) ** 2 / (a * a / (na - 1) + b * b / (nb - 1))
            p = t_tail(abs(d) / math.sqrt(a + b), df)
        if math.isnan(p):
            return p, i
        worst = min(worst, (p, i))
    return min(1.0, worst[0] * ours.shape[1]), worst[1]


def mitsuba_batches(scene_file, arguments, **definitions):
    import mitsuba as mi
    import numpy as np

    scene = mi.load_file(str(scene_file), **definitions)
    return np.stack([tiles(np.array(mi.render(scene, spp=arguments.spp, seed=1000 + i)))
                     for i in range(arguments.batches)])


def burnish_batches(scene_file, folder, arguments):
    import mitsuba as mi
    import numpy as np

    means = []
    for i in range(arguments.batches):
        image = folder / "burnish.exr"
        subprocess.run([arguments.burnish, "render", scene_file, "-o", image, "--size", str(arguments.size),
                        str(arguments.size), "--spp", str(arguments.spp), "--seed", str(i + 1)],
                       check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        means.append(tiles(np.array(mi.Bitmap(str(image)))[:, :, :3]))
    return np.stack(means)


def check_scene(name, folder, arguments):
    """True where the scene agrees and its defect is rejected."""
    subprocess.run([arguments.burnish, "scene", name, "-o", folder, "--texture-size", "512"], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    scene_file = folder / "scene.xml"
    scene_file.write_text(scene_file.read_text().replace("</film>", '<rfilter type="box"/></film>'))
    theirs = mitsuba_batches(scene_file, arguments, resx=arguments.size, resy=arguments.size)
    ours = burnish_batches(scene_file, folder, arguments)
    p, worst = welch(ours, theirs)
    ratio = ours[:, -3:].mean() / theirs[:, -3:].mean() - 1
    defective = folder / "defective.xml"
    defective.write_text(with_defect(scene_file.read_text(), name))
    p_defect, _ = welch(burnish_batches(defective, folder, arguments), theirs)
    agrees, rejects = p > ALPHA and abs(ratio) < MEAN_TOLERANCE, p_defect < ALPHA
    print(f"{name}: mean {ours[:, -3:].mean():.4f}, Mitsuba's {theirs[:, -3:].mean():.4f} ({ratio:+.3%}); p = {p:.2g}"
          f"{'' if agrees else f'  DIFFERS, most in column {worst}'}"
          f"; {DEFECTS[name][0]}: p = {p_defect:.2g}{'' if rejects else '  NOT REJECTED'}", flush=True)
    return agrees and rejects


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("burnish")
    parser.add_argument("names", nargs="*", metavar="NAME", help="scenes; all four without")
    parser.add_argument("--size", type=int, default=96, help="pixels a side, a multiple of 8")
    parser.add_argument("--batches", type=int, default=32)
    parser.add_argument("--spp", type=int, default=32)
    parser.add_argument("--inside", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if not arguments.inside:
        python = interpreter_with_mitsuba()
        if python is None:
            print("skipped: no Python with mitsuba and numpy; set BURNISH_MITSUBA_PYTHON to one")
            return SKIPPED
        os.execv(python, [python, __file__, *sys.argv[1:], "--inside"])
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    agree = []
    for name in arguments.names or DEFECTS:
        with tempfile.TemporaryDirectory() as folder:
            agree.append(check_scene(name, Path(folder), arguments))
    return 0 if all(agree) else 1


if __name__ == "__main__":
    sys.exit(main())

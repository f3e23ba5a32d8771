#!/usr/bin/env python3
"""Stock Mitsuba 3 renders the scene/ of a result as Burnish does.

    tests/scenes/rewritten_in_mitsuba.py BURNISH

As agree_with_mitsuba.py, whose statistics, interpreter and alpha these are: a few iterations on the built-in goblet, then
batches of its rewritten scene in both programs. The scene with the textures that it had before must be rejected.
"""
import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import agree_with_mitsuba as agree

SIZE = 64


def run(*command):
    subprocess.run([str(c) for c in command], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def with_box_filter(scene):
    """Beside the scene, so that it finds its files."""
    file = scene.with_name("boxes.xml")
    file.write_text(scene.read_text().replace("</film>", '<rfilter type="box"/></film>'))
    return file


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("burnish")
    parser.add_argument("--size", type=int, default=SIZE, help="pixels a side, a multiple of 8")
    parser.add_argument("--batches", type=int, default=32)
    parser.add_argument("--spp", type=int, default=32)
    parser.add_argument("--inside", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if not arguments.inside:
        python = agree.interpreter_with_mitsuba()
        if python is None:
            print("skipped: no Python with mitsuba and numpy; set BURNISH_MITSUBA_PYTHON to one")
            return agree.SKIPPED
        os.execv(python, [python, __file__, *sys.argv[1:], "--inside"])
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        run(arguments.burnish, "optimize", "--init", "1", "--iterations", "4", "--size", arguments.size, arguments.size,
            "--target-spp", "16", "--evaluation-spp", "8", "-o", folder / "out")
        run(arguments.burnish, "scene", "goblet", "-o", folder / "before", "--texture-size", "256")
        scene = with_box_filter(folder / "out/scene/scene.xml")
        theirs = agree.mitsuba_batches(scene, arguments)
        p, _ = agree.welch(agree.burnish_batches(scene, folder, arguments), theirs)
        before = with_box_filter(folder / "before/scene.xml")
        p_before, _ = agree.welch(agree.burnish_batches(before, folder, arguments), theirs)
    agrees, rejects = p > agree.ALPHA, p_before < agree.ALPHA
    print(f"the rewritten scene: p = {p:.2g}{'' if agrees else '  DIFFERS'}; with the textures that it had before: "
          f"p = {p_before:.2g}{'' if rejects else '  NOT REJECTED'}")
    return 0 if agrees and rejects else 1


if __name__ == "__main__":
    sys.exit(main())

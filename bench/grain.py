#!/usr/bin/env python3
"""Grain of recovered textures, as a table in Markdown.

    bench/grain.py TEXTURE.exr... [--side 512]

TEXTURE: written by `burnish optimize`, its _coverage.exr beside it. Of the square that the pictures see most (it begins at
a multiple of 64 texels): the standard deviation of channels from the median of the 3 x 3 around them, and the shares of
them that lie further than 0.05 and 0.1 from it. Needs the Python packages mitsuba (for OpenEXR) and numpy.
"""
import argparse
from pathlib import Path

import mitsuba
import numpy

STRIDE = 64


def read(file):
    """[height, width, channels]"""
    values = numpy.array(mitsuba.Bitmap(str(file)), dtype=float)
    return values.reshape(*values.shape[:2], -1)


def best_square(coverage, side):
    """Rows and columns."""
    height, width = coverage.shape
    if min(height, width) < side:
        raise SystemExit(f"expected textures of at least {side} x {side} texels, found {width} x {height}: see --side")
    corners = ((y, x) for y in range(0, height - side + 1, STRIDE) for x in range(0, width - side + 1, STRIDE))
    y, x = max(corners, key=lambda corner: coverage[corner[0] : corner[0] + side, corner[1] : corner[1] + side].mean())
    return slice(y, y + side), slice(x, x + side)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("textures", nargs="+", type=Path, metavar="TEXTURE.exr")
    parser.add_argument("--side", type=int, default=512)
    options = parser.parse_args()
    mitsuba.set_variant("scalar_rgb")
    print("| texture | deviation | > 0.05 | > 0.1 |\n| --- | --- | --- | --- |")
    for file in options.textures:
        coverage = read(file.with_name(file.stem + "_coverage.exr"))[..., 0]
        texture = read(file)[best_square(coverage, options.side)]
        windows = numpy.lib.stride_tricks.sliding_window_view(texture, (3, 3), axis=(0, 1))
        distance = numpy.abs(texture[1:-1, 1:-1] - numpy.median(windows, axis=(-2, -1)))
        deviation = numpy.sqrt((distance**2).mean())
        shares = " | ".join(f"{(distance > limit).mean():.2%}" for limit in (0.05, 0.1))
        print(f"| {file} | {deviation:.4f} | {shares} |")


if __name__ == "__main__":
    main()

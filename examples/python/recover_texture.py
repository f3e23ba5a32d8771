"""Recovers a texture from a picture.

    recover_texture.py SCENE.xml PICTURE PARAMETER TEXTURE.exr [ITERATIONS]
"""
import sys

import burnish


def main(scene: str, picture: str, parameter: str, texture: str, iterations: str = "200") -> None:
    problem = burnish.Problem(burnish.load(scene), picture, parameter)
    summary = burnish.solve(problem, iterations=int(iterations))
    burnish.write_image(texture, summary.textures[parameter])
    print(f"loss {summary.initial_loss:.4g} -> {summary.loss:.4g}")


if __name__ == "__main__":
    main(*sys.argv[1:])

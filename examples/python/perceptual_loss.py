"""A loss of one's own in PyTorch: differences of gradients at several scales, which see edges and not brightness alone.

    perceptual_loss.py SCENE.xml PICTURE PARAMETER TEXTURE.exr [ITERATIONS]

It runs through the solver: its path cache, its optimiser, its stopping rules.
"""
from __future__ import annotations

import sys

import numpy as np
import numpy.typing as npt
import torch

import burnish

SCALES = 4
Array = npt.NDArray[np.float32]


def gradients(image: torch.Tensor) -> list[torch.Tensor]:
    """Horizontal and vertical differences of log(image), at halved and halved sizes."""
    found = []
    level = torch.log(image.clamp(min=0) + 0.05).permute(2, 0, 1)[None]
    for _ in range(SCALES):
        found += [level[..., 1:, :] - level[..., :-1, :], level[..., 1:] - level[..., :-1], level]
        if min(level.shape[-2:]) < 4:
            break
        level = torch.nn.functional.avg_pool2d(level, 2)
    return found


class PerceptualLoss:
    def __init__(self, target: Array) -> None:
        self.target = [level.detach() for level in gradients(torch.from_numpy(target))]

    def __call__(self, image: Array, view: int) -> tuple[float, Array]:
        tensor = torch.from_numpy(image).requires_grad_()
        loss = torch.stack([(a - b).square().mean() for a, b in zip(gradients(tensor), self.target)]).sum()
        (adjoint,) = torch.autograd.grad(loss, tensor)
        return loss.item(), adjoint.numpy()


def main(scene: str, picture: str, parameter: str, texture: str, iterations: str = "200") -> None:
    target = burnish.read_image(picture)
    problem = burnish.Problem(burnish.load(scene), target, burnish.Unknown(parameter, start=0.5), PerceptualLoss(target))
    solver = burnish.Solver(problem, iterations=int(iterations))
    before = solver.evaluate(64).loss
    for iteration in solver:
        if iteration.number % 20 == 0:
            print(f"iteration {iteration.number}, loss {iteration.loss:.4g}")
    burnish.write_image(texture, solver.recovered()[parameter])
    print(f"loss {before:.4g} -> {solver.evaluate(64).loss:.4g}")


if __name__ == "__main__":
    main(*sys.argv[1:])

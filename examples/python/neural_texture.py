"""A neural texture: a small network whose outputs are the texels, trained through the renderer.

    neural_texture.py SCENE.xml PICTURE PARAMETER TEXTURE.exr [ITERATIONS]
"""
from __future__ import annotations

import sys

import numpy as np
import torch

import burnish
import burnish.torch


class NeuralTexture(torch.nn.Module):
    """Sines of the texel's place, and a network of them; values in (0, 1)."""

    def __init__(self, height: int, width: int, channels: int, octaves: int = 5, hidden: int = 32) -> None:
        super().__init__()
        v, u = torch.meshgrid(torch.arange(height) / height, torch.arange(width) / width, indexing="ij")
        angles = [2 * np.pi * 2**k * x for k in range(octaves) for x in (u, v)]
        self.features = torch.stack([f(a) for a in angles for f in (torch.sin, torch.cos)], dim=-1)
        self.network = torch.nn.Sequential(
            torch.nn.Linear(self.features.shape[-1], hidden), torch.nn.ReLU(),
            torch.nn.Linear(hidden, hidden), torch.nn.ReLU(), torch.nn.Linear(hidden, channels))

    def forward(self) -> torch.Tensor:
        texels: torch.Tensor = torch.sigmoid(self.network(self.features))
        return texels


def relative_error(image: torch.Tensor, target: torch.Tensor) -> torch.Tensor:
    """Its derivative is affine in the image, so that the image's noise does not bias the gradient."""
    return ((image - target).square() / (target.square() + 0.01)).mean()


def main(scene: str, picture: str, parameter: str, texture: str, iterations: str = "200") -> None:
    torch.manual_seed(0)
    renderer = burnish.load(scene)
    target = torch.from_numpy(burnish.read_image(picture))
    model = NeuralTexture(*renderer.parameters[parameter].shape)
    optimizer = torch.optim.Adam(model.parameters(), lr=5e-3)

    def evaluate() -> float:
        with torch.no_grad():
            return relative_error(burnish.torch.render(renderer, {parameter: model()}, spp=256), target).item()

    before = evaluate()
    for step in range(int(iterations)):
        optimizer.zero_grad()
        loss = relative_error(burnish.torch.render(renderer, {parameter: model()}, spp=16, seed=step), target)
        torch.autograd.backward(loss)
        optimizer.step()
    burnish.write_image(texture, model().detach().numpy())
    print(f"loss {before:.4g} -> {evaluate():.4g}")


if __name__ == "__main__":
    main(*sys.argv[1:])

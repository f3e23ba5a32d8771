"""The examples that need no other package."""
from conftest import losses_of


def test_example_recover_texture(small):
    losses = losses_of("recover_texture.py", small, 60)
    assert losses[-1] < losses[0]

"""Images sent to a viewer beside a run, to a receiver that reads tev's protocol."""
import os
import socket
import struct
import threading

import numpy as np
import pytest

import burnish

from conftest import NAME, in_two_ranks


class Viewer(threading.Thread):
    """Takes one connection; `images` are complete once the other side has closed."""

    def __init__(self):
        super().__init__(daemon=True)
        self.listening = socket.create_server(("127.0.0.1", 0))
        self.address = "127.0.0.1:%d" % self.listening.getsockname()[1]
        self.images, self.closed, self.opened = {}, [], []
        self.start()

    def run(self):
        connection, _ = self.listening.accept()
        with connection, connection.makefile("rb") as stream:
            while head := stream.read(4):
                self.take(stream.read(struct.unpack("<I", head)[0] - 4))

    def take(self, packet):
        kind, packet = packet[0], packet[1:]
        if kind == 2:
            assert packet.endswith(b"\0")
            self.closed.append(packet[:-1].decode())
            del self.images[self.closed[-1]]
            return
        name, rest = packet[1:].split(b"\0", 1)
        name = name.decode()
        if kind == 7:
            assert rest == b"\0"
            self.opened.append(name)
        elif kind == 4:
            width, height, channels = struct.unpack("<3i", rest[:12])
            assert rest[12:] == {1: b"L\0", 3: b"R\0G\0B\0"}[channels]
            self.images[name] = np.full((height, width, channels), np.nan, np.float32)
        else:
            assert kind == 6
            (channels,) = struct.unpack("<i", rest[:4])
            rest = rest[4 + 2 * channels:]
            x, y, width, height, *places = struct.unpack(f"<4i{2 * channels}q", rest[:16 + 16 * channels])
            assert x == 0 and places == [*range(channels), *[channels] * channels]
            values = np.frombuffer(rest[16 + 16 * channels:], "<f4")
            self.images[name][y:y + height] = values.reshape(height, width, channels)

    def wait(self):
        self.join(60)
        assert not self.is_alive()
        return self.images


def test_a_run_is_shown_and_stays_what_it_is(problem, target):
    viewer = Viewer()
    live = burnish.live(viewer.address, title="run")
    summary = burnish.solve(problem, iterations=5, callback=live)
    del live
    images = viewer.wait()
    np.testing.assert_array_equal(images["run/" + NAME], summary.textures[NAME])
    np.testing.assert_array_equal(images["run/view 0 picture"], target)
    np.testing.assert_array_equal(images["run/view 0"], summary.result.views[0].image)
    assert summary.state == burnish.solve(problem, iterations=5).state


def test_the_first_process_alone_shows(renderer, target):
    viewers = [Viewer(), Viewer()]

    def solve(ranks):
        problem = burnish.Problem(renderer, [target, target], burnish.Unknown(NAME, 0.5), ranks=ranks)
        live = burnish.live(viewers[ranks.rank].address)
        burnish.solve(problem, batch=2, iterations=2, evaluation_spp=2, callback=live)
        live.show("own", np.zeros((1, 1, 3), np.float32))

    in_two_ranks(solve)
    first, second = [viewer.wait() for viewer in viewers]
    assert "burnish/" + NAME in first and list(second) == ["burnish/own"]


def test_a_solver_is_shown(problem):
    viewer = Viewer()
    live = burnish.live(viewer.address)
    solver = burnish.Solver(problem, iterations=1)
    for iteration in solver:
        live(iteration)
    live.show("gray", np.full((2, 3), 0.5, np.float32))
    live.open("/pictures/a.exr")
    live.show("no more", np.zeros((1, 1), np.float32))
    del live
    images = viewer.wait()
    np.testing.assert_array_equal(images["burnish/" + NAME], solver.textures[NAME])
    assert images["burnish/gray"].tolist() == [[[0.5]] * 3] * 2
    assert viewer.opened == ["/pictures/a.exr"] and "burnish/no more" in images


@pytest.fixture
def nobody():
    """An address at which nobody listens: it stays taken, so that no other program gets it."""
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        yield "127.0.0.1:%d" % taken.getsockname()[1]


def test_without_a_viewer_a_run_goes_on_and_warns_once(problem, nobody):
    live = burnish.live(nobody)
    with pytest.warns(RuntimeWarning, match=f"no viewer takes images at {nobody}") as warned:
        burnish.solve(problem, iterations=40, callback=live)
        del live  # waits for what the last images have met with
    assert len(warned) == 1
    with pytest.raises(burnish.InputError, match="found 'a:b', expected HOST:PORT"):
        burnish.live("a:b")


def test_one_picture_without_a_viewer_warns(nobody):
    live = burnish.live(nobody)
    live.show("a", np.zeros((1, 1), np.float32))
    with pytest.warns(RuntimeWarning, match=f"no viewer takes images at {nobody}"):
        del live


def test_a_viewer_that_is_too_slow_for_the_last_images_is_told_of():
    with socket.create_server(("127.0.0.1", 0)) as listening:  # and takes nothing
        live = burnish.live("127.0.0.1:%d" % listening.getsockname()[1])
        live.show("large", np.zeros((2000, 1000, 3), np.float32))
        with pytest.warns(RuntimeWarning, match="the viewer at 127.0.0.1:[0-9]* was too slow|no viewer takes images"):
            del live


def test_a_fork_cannot_use_the_viewer(nobody):
    live = burnish.live(nobody)
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            for use in (lambda: live.show("a", np.zeros((1, 1))), lambda: live.close("a"), lambda: live.open("a.exr")):
                with pytest.raises(burnish.Error) as caught:
                    use()
                os.write(write, str(caught.value).encode() + b"\n")
        finally:
            os._exit(0)
    os.close(write)
    with open(read) as said:
        assert said.read().count("forked after burnish.live") == 3
    os.waitpid(child, 0)


def test_a_callback_sees_textures_and_no_later(problem, nobody):
    kept, seen = [], []

    def callback(iteration):
        kept.append(iteration)
        seen.append(iteration.textures[NAME])

    summary = burnish.solve(problem, iterations=3, callback=callback)
    shown = [iteration.textures[NAME].copy() for iteration in burnish.Solver(problem, iterations=3)]
    assert not np.array_equal(seen[0], seen[2])
    np.testing.assert_array_equal(seen, shown)
    with pytest.raises(burnish.Error, match="while its callback runs alone"):
        kept[0].textures
    with pytest.raises(burnish.Error, match="while its callback runs alone"):
        burnish.live(nobody)(summary.iterations[0])

"""The progress of solve in one line: tqdm's where it is installed, else of its own on standard error."""
from __future__ import annotations

import importlib.util
import sys
import threading
import time
from typing import Any

from ._core import Iteration


class _Line:
    """What is used of tqdm, without it."""

    def __init__(self, total: int | None = None, desc: str = "", initial: int = 0, **_: Any) -> None:
        self.total, self.desc, self.n, self.postfix = total, desc, initial, ""
        self.shown, self.last = "", 0.0

    def refresh(self) -> None:
        count = f"{self.n}" + (f"/{self.total}" if self.total else "")
        text = f"{self.desc}  {count}  {self.postfix}"
        print("\r" + text.ljust(len(self.shown)), end="", file=sys.stderr, flush=True)
        self.shown, self.last = text, time.monotonic()

    def set_postfix_str(self, text: str, refresh: bool = True) -> None:
        self.postfix = text

    def update(self, count: int) -> None:
        self.n += count
        if time.monotonic() - self.last > 0.2:
            self.refresh()

    def close(self) -> None:
        if self.shown:
            self.refresh()
            print(file=sys.stderr, flush=True)
            self.shown = ""


def _line(**arguments: Any) -> Any:
    if importlib.util.find_spec("tqdm") is None:
        return _Line(**arguments)
    if importlib.util.find_spec("ipywidgets") is None:
        from tqdm import tqdm
    else:
        from tqdm.auto import tqdm
    return tqdm(**arguments)


class Bar:
    """Hears of the stages and the iterations of one run, until it is closed, by any thread. total: iterations, where they
    are known, those before this call included."""

    def __init__(self, total: int | None) -> None:
        self.total = total
        self.title: str | None = None
        self.line: Any = None
        self.closed = False
        self.lock = threading.Lock()

    def begin(self, title: str, total: int | None, initial: int = 0, **arguments: Any) -> None:
        if self.title != title:
            self.end()
            self.title, self.line = title, _line(total=total, desc=title, initial=initial, mininterval=0.2, **arguments)

    def end(self) -> None:
        if self.line is not None:
            self.line.close()

    def stage(self, name: str, share: float) -> None:
        with self.lock:
            if self.closed:
                return
            self.begin(name, 100, bar_format="{l_bar}{bar}| {elapsed}<{remaining}")  # a percentage, no count and rate
            self.line.update(round(100 * share) - self.line.n)

    def iteration(self, iteration: Iteration) -> None:
        with self.lock:
            if self.closed:
                return
            self.begin("iteration", self.total, iteration.number)
            self.line.set_postfix_str(f"loss {iteration.loss:.4g}", refresh=False)
            self.line.update(iteration.number + 1 - self.line.n)

    def close(self) -> None:
        with self.lock:
            self.closed = True
            self.end()

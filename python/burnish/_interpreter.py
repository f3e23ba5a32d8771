"""The interpreter that imports the package."""
from __future__ import annotations

import importlib


def check_interpreter() -> None:
    """The state of _core is one for the process: a second import, in a sub-interpreter, would take it from the first.

    Throws ImportError: this is not the main interpreter.
    """
    for name in ("_interpreters", "_xxsubinterpreters"):  # of Python 3.13 and newer, of older ones
        try:
            interpreters = importlib.import_module(name)
        except ImportError:
            continue
        if interpreters.get_current() != interpreters.get_main():
            raise ImportError("burnish is for the main interpreter of a process alone, found a sub-interpreter")
        return

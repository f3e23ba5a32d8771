#!/usr/bin/env python3
"""Runs the notebooks of docs/guide/notebooks and keeps their outputs in them.

    scripts/notebooks.py [NOTEBOOK...]

Needs burnish, nbclient and ipykernel in this Python, and what the notebooks name: PyTorch, Mitsuba, the program `burnish`
(BURNISH_BINARY). An output that the notebook does not need, as the times of its cells, is left out.
"""
import pathlib
import sys

import nbformat
from nbclient import NotebookClient

FOLDER = pathlib.Path(__file__).resolve().parents[1] / "docs" / "guide" / "notebooks"


def run(file: pathlib.Path) -> None:
    notebook = nbformat.read(file, as_version=4)
    NotebookClient(notebook, timeout=300, record_timing=False, resources={"metadata": {"path": file.parent}}).execute()
    # Of the interpreter that ran it.
    notebook.metadata = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"},
                         "language_info": {"name": "python"}}
    nbformat.write(notebook, file)
    print(f"{file.name}: {file.stat().st_size // 1024} KiB")


if __name__ == "__main__":
    for name in sys.argv[1:] or sorted(FOLDER.glob("*.ipynb")):
        run(pathlib.Path(name).resolve())

#!/usr/bin/env python3
"""Whether Clang compiles what a build with GCC compiles, without a warning and without making anything of it.

    scripts/clang_syntax.py [BUILD [PART...]]    BUILD: configured; build/release unless given. PART: of files' paths
"""
import concurrent.futures
import json
import os
import pathlib
import shlex
import subprocess
import sys

OF_GCC = ("-march=", "-flto", "-fno-fat-lto-objects", "-Wno-psabi", "-Winvalid-pch")


def of_clang(command: str) -> list[str]:
    """Without precompiled headers and outputs."""
    words = shlex.split(command)
    words = words[next(i for i, word in enumerate(words) if "g++" in word or "c++" in word) + 1:]
    for option in ("-o", "-include"):
        while option in words:
            at = words.index(option)
            del words[at:at + 2]
    return ["clang++", "-fsyntax-only", *(w for w in words if w != "-c" and not w.startswith(OF_GCC))]


def complaints(entry: dict[str, str]) -> str:
    run = subprocess.run(of_clang(entry["command"]), cwd=entry["directory"], capture_output=True, text=True)
    return run.stderr or (f"status {run.returncode}" if run.returncode else "")


def main() -> int:
    build, *parts = sys.argv[1:] or ["build/release"]
    entries = [e for e in json.loads(pathlib.Path(build, "compile_commands.json").read_text())
               if not any(other in e["file"] for other in ("cmake_pch", "nanobind")) and not e["file"].endswith(".c")
               and (not parts or any(part in e["file"] for part in parts))]
    wrong = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for entry, text in zip(entries, pool.map(complaints, entries)):
            if text:
                wrong += 1
                print(entry["file"], text, sep="\n")
    print(f"clang_syntax: {len(entries)} files, {wrong} with complaints")
    return 1 if wrong or not entries else 0


if __name__ == "__main__":
    sys.exit(main())

"""The Python that has Mitsuba 3, and the LLVM that it compiles with."""
import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
ENVIRONMENT = ROOT / "build" / "mitsuba"
MITSUBA = "mitsuba==3.9.1"
NAMED = "BURNISH_MITSUBA_PYTHON"


def make_environment() -> None:
    """Mitsuba from PyPI in a virtual environment of its own."""
    if not (ENVIRONMENT / "bin" / "python").exists():
        subprocess.run([sys.executable, "-m", "venv", str(ENVIRONMENT)], check=True)
        subprocess.run([str(ENVIRONMENT / "bin" / "pip"), "install", "-q", MITSUBA, "numpy"], check=True)


def newest_llvm() -> str:
    """Dr.Jit takes the LLVM that it finds first, which may be too old for this processor (14 stops on AVX-512)."""
    versions = {}
    for file in Path("/usr/lib").glob("*/libLLVM*.so*"):
        number = re.search(r"LLVM[-.](?:so\.)?(\d+)", file.name)
        if number:
            versions[int(number.group(1))] = str(file)
    if max(versions, default=0) < 15:
        sys.exit("bench: LLVM 15 or newer is needed: apt-get install libllvm19")
    return versions[max(versions)]


def llvm() -> str:
    """The one that DRJIT_LIBLLVM_PATH names, or the newest."""
    return os.environ.get("DRJIT_LIBLLVM_PATH") or newest_llvm()


def interpreter_with_mitsuba() -> str | None:
    """The one that BURNISH_MITSUBA_PYTHON names, or that of build/mitsuba, or this one."""
    candidates = [os.environ.get(NAMED), ENVIRONMENT / "bin" / "python", sys.executable]
    for candidate in map(str, filter(None, candidates)):
        try:
            done = subprocess.run([candidate, "-c", "import mitsuba, numpy"], capture_output=True)
        except OSError:
            continue
        if done.returncode == 0:
            return candidate
    return None


def go_on_with_mitsuba() -> None:
    """Starts this script again in an interpreter with Mitsuba; returns at once where it is one."""
    if importlib.util.find_spec("mitsuba") and "DRJIT_LIBLLVM_PATH" in os.environ:
        return
    python = interpreter_with_mitsuba()
    if python is None and {"-h", "--help"} & set(sys.argv):
        print(sys.modules["__main__"].__doc__)
        sys.exit(0)
    if python is None:
        sys.exit(f"bench: no Python with mitsuba and numpy: set {NAMED} to one (pip install {MITSUBA} numpy)")
    os.execve(python, [python, *sys.argv], os.environ | {"DRJIT_LIBLLVM_PATH": llvm()})

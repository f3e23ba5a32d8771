#!/usr/bin/env python3
"""Makes docs/reference/python-api.md from the stubs of the Python package, which the build makes of its docstrings, and
from what is written in Python.

    scripts/python_docs.py STUB          writes the page; STUB: build/release/python/burnish/_core.pyi
    scripts/python_docs.py STUB --check  says whether the page is up to date; status 1 where it is not
"""
import ast
import pathlib
import re
import sys
import textwrap

ROOT = pathlib.Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs/reference/python-api.md"
IN_PYTHON = [ROOT / "python/burnish/_ranks.py"]  # shown besides the stub
INTRO = """# Python API

Made from the docstrings of `python/` by `scripts/python_docs.py`; edit these. How the pieces go together is in the
[guide](../guide/python.md). Everything is in the module `burnish`; what needs PyTorch is in `burnish.torch`, what
needs JAX in `burnish.jax`, and the [processes of MPI](../guide/several-machines.md#from-python) in `burnish.mpi`.
"""
OPTIONS = "Options are keyword arguments, of which None is the default: see the [guide](../guide/python.md#options)."


def signature(node):
    """def f(a: int = 1) -> str, without self and decorators, in lines of at most 100 characters."""
    if any(a.arg == "estimator" for a in node.args.kwonlyargs):  # the options have a page of their own
        node.args.kwonlyargs, node.args.kw_defaults, node.args.kwarg = [], [], ast.arg("options")
    arguments = ast.unparse(node.args)
    arguments = re.sub(r"^self(, |$)", "", arguments)
    arguments = re.sub(r"(, )?/", "", arguments)
    returns = f" -> {ast.unparse(node.returns)}" if node.returns else ""
    name = node.name
    text = f"{name}({arguments}){returns}".replace("numpy.typing.NDArray[numpy.float32]", "Array")
    text = text.replace("numpy.typing.ArrayLike", "ArrayLike").replace("burnish._ranks.", "")
    return textwrap.wrap(text, 100, subsequent_indent="    ", break_long_words=False)


def prose(node):
    doc = ast.get_docstring(node) or ""
    lines = []
    for line in doc.split("\n"):
        if re.match(r"    \w+: ", line):
            continue
        line = line.replace("Options, of which None is the default:", OPTIONS)
        lines += textwrap.wrap(line, 116) or [""]
    return lines


def member(node, owner):
    is_property = any(isinstance(d, ast.Name) and d.id == "property" for d in node.decorator_list)
    if is_property:
        kind = ast.unparse(node.returns).replace("numpy.typing.NDArray[numpy.float32]", "Array")
        code = [f"{node.name}: {kind}"]
    else:
        code = signature(node)
        if node.name == "__init__":
            code[0] = code[0].replace("__init__", owner, 1)
            code[-1] = code[-1].removesuffix(" -> None")
    return ["", "```python", *code, "```", *prose(node)]


def is_shown(node):
    if not isinstance(node, ast.FunctionDef):
        return False
    is_setter = any(isinstance(d, ast.Attribute) for d in node.decorator_list)
    return not is_setter and (not node.name.startswith("_") or node.name == "__init__")


def page(sources):
    out = [INTRO]
    for node in [n for source in sources for n in ast.parse(source).body]:
        if isinstance(node, ast.ClassDef):
            out += ["", f"## {node.name}", "", *prose(node)]
            fields = [ast.unparse(n) for n in node.body if isinstance(n, ast.AnnAssign)]
            if fields:
                out += ["", "```python", *fields, "```"]
            for child in filter(is_shown, node.body):
                out += member(child, node.name)
        elif isinstance(node, ast.AnnAssign) and not ast.unparse(node.target).startswith("_"):
            name = ast.unparse(node.target)  # its value changes with each version
            out += ["", f"## {name}", "", "```python", f"{name}: {ast.unparse(node.annotation)}", "```"]
        elif is_shown(node):
            out += ["", f"## {node.name}", *member(node, "")]
    return re.sub(r"\n{3,}", "\n\n", "\n".join(line.rstrip() for line in out)).strip() + "\n"


def main(arguments):
    text = page([p.read_text(encoding="utf-8") for p in [pathlib.Path(arguments[0]), *IN_PYTHON]])
    if arguments[1:] == ["--check"]:
        if PAGE.exists() and PAGE.read_text(encoding="utf-8") == text:
            return 0
        print(f"python_docs: {PAGE.name} is not what the package says: run scripts/python_docs.py {arguments[0]}")
        return 1
    PAGE.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

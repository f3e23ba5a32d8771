#!/usr/bin/env python3
"""Makes docs/reference/cpp-api.md from the comments of the public headers.

    scripts/api_docs.py          writes the page
    scripts/api_docs.py --check  says whether the page is up to date; status 1 where it is not
"""

import itertools
import pathlib
import re
import sys
import textwrap

ROOT = pathlib.Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs/reference/cpp-api.md"
# In the order in which a reader needs them. A header that is not listed comes last.
ORDER = ["burnish.h", "renderer.h", "solve.h", "options.h", "gradient.h", "image.h", "error.h"]
INTRO = """# C++ API

Made from the comments of `include/burnish/` by `scripts/api_docs.py`; edit the headers. How the pieces go together is
in the [guide](../guide/cpp.md).
"""
# Members that a user of the library does not need.
HIDDEN = re.compile(r"friend bool operator==|struct Impl;|struct Values;|impl\(\)|values_|For the library's own use|data\(\) const|"
                    r"explicit (Renderer|Solver|State)\(")


def headers():
    found = {path.name: path for path in (ROOT / "include/burnish").glob("*.h")}
    return [found.pop(name) for name in ORDER if name in found] + [found[name] for name in sorted(found)]


def declarations(lines):
    """Top-level declarations of namespace burnish: (comment lines, code lines)."""
    comment, code, depth = [], [], 0
    for line in lines:
        if not code and line.startswith("///"):
            comment.append(line[3:].rstrip().removeprefix(" "))
            continue
        if not code and (not line.strip() or line.startswith(("//", "#", "namespace", "}"))):
            comment = []
            continue
        code.append(line)
        depth += line.count("{") - line.count("}")
        if depth == 0 and re.search(r"[;}]\s*(//.*)?$", line):
            yield comment, code
            comment, code = [], []


def is_forward_declaration(code):
    return len(code) == 1 and re.match(r"(struct|class) \w+;$", code[0])


def without_body(code):
    """An inline function as its declaration; everything else as it is."""
    text = "\n".join(code)
    if re.match(r"(struct|class|enum|using)\b", text):
        return shown_members(code)
    body = re.search(r"\)\s*\{", text)
    return (text[:body.start() + 1].removeprefix("inline ") + ";" if body else text).split("\n")


def shown_members(code):
    """A type without its private part, hidden members and the bodies of functions in it."""
    shown, depth = [], 0
    for line in code:
        if line.strip() == "private:":
            shown.append("};")
            break
        if depth <= 1 and not HIDDEN.search(line):
            has_body = depth == 1 and re.search(r"\) (const )?\{", line)
            shown.append(line[:line.rindex(has_body[0]) + len(has_body[0]) - 1].rstrip() + ";" if has_body else line)
        elif depth <= 1:  # its comment says nothing without it
            while shown and shown[-1].strip().startswith("///"):
                shown.pop()
        depth += line.count("{") - line.count("}")
    return tidy(shown)


def prose(comment):
    """The lines of a comment; those that are indented, code and formulas, as blocks."""
    lines = []
    for is_indented, group in itertools.groupby(comment, lambda line: line.startswith("  ")):
        lines += ["", "```text", *textwrap.dedent("\n".join(group)).split("\n"), "```", ""] if is_indented else group
    return tidy("\n".join(lines).strip("\n").split("\n"))


def tidy(lines):
    """Without empty lines in a row, or at the end of a body."""
    text = "\n".join(lines)
    text = re.sub(r"\n(\s*\n)+", "\n\n", text)
    text = re.sub(r"\n\s*\n\}", "\n}", text)
    return text.split("\n")


def name_of(code):
    text = " ".join(code)
    match = re.match(r"(?:struct|class|enum class|enum|using) (\w+)", text) or re.match(r"inline constexpr \w+ (\w+)", text) \
        or re.search(r"(\w+)\(", text)
    return match[1]


def section(path):
    lines = path.read_text(encoding="utf-8").split("\n")
    above = lines[:lines.index("#pragma once")]
    intro = [line[2:].rstrip().removeprefix(" ") for line in above if line.startswith("//")]
    out = [f"## burnish/{path.name}", "", *prose(intro)]
    last = None
    for comment, code in declarations(lines):
        if is_forward_declaration(code):
            continue
        name = name_of(code)
        out += [""] if name == last else ["", f"### {name}", ""]
        out += prose(comment) + [""] if comment else []
        out += ["```cpp", *without_body(code), "```"]
        last = name
    return out


def page():
    return INTRO + "".join("\n" + "\n".join(section(path)) + "\n" for path in headers())


def main(arguments):
    if arguments == ["--check"]:
        if PAGE.exists() and PAGE.read_text(encoding="utf-8") == page():
            print("api_docs: docs/reference/cpp-api.md is up to date")
            return 0
        print("api_docs: docs/reference/cpp-api.md is not what the headers say: run scripts/api_docs.py")
        return 1
    PAGE.write_text(page(), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

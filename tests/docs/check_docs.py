#!/usr/bin/env python3
"""Checks the documentation of a source tree.

    check_docs.py [ROOT]     prints FILE:LINE: MESSAGE for each violation; status 1 where there is one
    check_docs.py --self-test  seeds a violation of each kind into a temporary tree and expects it to be found

To add a rule: a generator of (line, message) below, a row in PAGE_RULES, and a seed in self_test.
"""

import os
import pathlib
import re
import sys
import tempfile

MAX_LINE = 120
MAX_DECISION_LINES = 60
MAX_ARCHITECTURE_LINES = 150
MAX_SHORT_ENTRY = 12  # words of more than three letters up to which entries of the changes are not compared
MAX_SHARED = 0.9  # of these words, in two entries
# The first folder of a path in backticks that is taken for a file of this repository.
FOLDERS = {"bench", "cli", "docs", "examples", "experiments", "include", "python", "scenes", "scripts", "src", "tests"}
# Words of earlier versions, and words of history. Pages of decisions and of changes may use them.
BANNED_WORDS = [
    r"pools?", r"banks?", r"aloud", r"foretold", r"foretell", r"born", r"extremes", r"lanelist", r"(emitter|bsdf|light) draws?",
    r"noise of judging", r"halved gradients?", r"steps by agreement", r"levels that agree", r"detail(s)? that fades?",
    r"a descent", r"descents", r"previously", r"formerly", r"no longer",
]
NAMES_OLD_OPTIONS = ["CHANGELOG.md", "docs/reference/options.md"]  # in backticks
MACHINE_STATE = [
    r"idle machine", r"busy machine", r"otherwise idle", r"nothing else ran", r"machine did other work", r"at low priority",
]

LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
WRITTEN = re.compile(r"-o +([^\s\"'`]+)")
CODE_SPAN = re.compile(r"`[^`]*`")
PATH_SPAN = re.compile(r"`([A-Za-z0-9_.*/-]+/[A-Za-z0-9_.*/-]*)`")


class Page:
    """A Markdown file: its lines, and which of them are blocks of code."""

    def __init__(self, root, path):
        self.root, self.path = root, path
        self.name = path.relative_to(root).as_posix()
        self.lines = path.read_text(encoding="utf-8").splitlines()
        self.code = find_code(self.lines)
        self.is_decision = self.name.startswith("docs/decisions/")

    def prose(self):
        """(number, line) of lines that are not code."""
        return [(i, line) for i, line in enumerate(self.lines, 1) if not self.code[i - 1]]


def find_code(lines):
    """For each line: whether it is in a block of code, fenced or indented after an empty line or a heading."""
    code, fenced, indented = [], False, False
    for i, line in enumerate(lines):
        fence = line.lstrip().startswith("```")
        fenced ^= fence
        before = lines[i - 1] if i > 0 else ""
        starts = not before.strip() or before.startswith("#")
        indented = line.startswith("    ") and (indented or starts) or (indented and not line.strip())
        code.append(fenced or fence or indented)
    return code


def anchors(page):
    """The anchors of a page's headings, as GitHub makes them."""
    found = {}
    for _, line in page.prose():
        heading = re.match(r"#+ (.*)", line)
        if heading:
            text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading[1]).strip().lower()
            slug = re.sub(r"[^\w\- ]", "", text).replace(" ", "-")
            count = found.get(slug, 0)
            found[slug] = count + 1
            if count:
                found[f"{slug}-{count}"] = 1
    return found


def links_of(page):
    """(line number, target file, anchor) of links into the repository."""
    for number, line in page.prose():
        for target in LINK.findall(CODE_SPAN.sub("", line)):
            if not re.match(r"[a-z]+:", target):
                file, _, anchor = target.partition("#")
                yield number, (page.path.parent / file).resolve() if file else page.path, anchor


def broken_links(page):
    for number, target, anchor in links_of(page):
        if not target.exists():
            yield number, f"links to {target.name}, which does not exist"
        elif anchor and anchor not in anchors(Page(page.root, target)):
            yield number, f"links to #{anchor}, which is no heading of {target.name}"


def missing_files(page):
    for number, line in page.prose():
        for path in PATH_SPAN.findall(line):
            named = path.split("/")[0] in FOLDERS or re.search(r"\.(h|cpp|py|sh|md)$", path)
            if not named or re.search(r"[A-Z]{3}", path) or path.startswith(("/", ".", "out/", "build/")):
                continue
            roots = [page.root, page.root / "src", page.root / "include", page.path.parent]
            if not any(list(root.glob(path.rstrip("/"))) for root in roots):
                yield number, f"names {path}, which does not exist"


def long_lines(page):
    for number, line in enumerate(page.lines, 1):
        if len(line) > MAX_LINE:
            yield number, f"has {len(line)} characters, more than {MAX_LINE}"


def srun_without_cores(page):
    """Since Slurm 22.05 a step has one core unless srun itself says how many."""
    for number, line in enumerate(page.lines, 1):
        if page.code[number - 1] and re.match(r"\s*srun ", line) and "--cpus-per-task" not in line:
            yield number, "runs srun without --cpus-per-task"


def commands_not_executable(page):
    """Scripts of the repository that a line of code begins with."""
    for number, line in enumerate(page.lines, 1):
        command = re.match(r"\s*((?:\./)?[\w./-]+\.(?:sh|py))(?: |$)", line)
        if page.code[number - 1] and command and "/" in command[1] and (page.root / command[1]).is_file():
            if not os.access(page.root / command[1], os.X_OK):
                yield number, f"runs {command[1]}, which is not executable"


def banned_words(page):
    if page.is_decision:
        return
    for number, line in page.prose():
        text = CODE_SPAN.sub("", line) if page.name in NAMES_OLD_OPTIONS else line
        for word in BANNED_WORDS:
            if re.search(rf"(?<![\w-]){word}(?![\w-])", text, re.IGNORECASE):
                yield number, f"uses the word {word}"


def machine_states(page):
    if page.name == "docs/benchmarks.md":
        return
    for number, line in enumerate(page.lines, 1):
        for state in MACHINE_STATE:
            if re.search(state, line, re.IGNORECASE):
                yield number, f"names the state of a machine: {state}"


def decision_form(page):
    if not page.is_decision or page.path.name == "README.md":
        return
    if len(page.lines) > MAX_DECISION_LINES:
        yield MAX_DECISION_LINES + 1, f"is longer than {MAX_DECISION_LINES} lines"
    status = paragraph(page.lines[2:])
    if not re.match(r"Status: .*\b(accepted|rejected|removed|default|defaults)\b.*\d{4}-\d\d-\d\d", status):
        yield 3, "expected 'Status: accepted, rejected or removed', and a date"
    index = page.path.parent / "README.md"
    if not index.exists():
        return
    rows = [paragraph([row]) for row in index.read_text().split("\n- ")]
    listed = [row.split(f"]({page.path.name}): ")[1] for row in rows if f"]({page.path.name}): " in row]
    if not listed:
        yield 1, "is not listed in README.md beside it"
    elif without_links(listed[0]) != without_links(status.removeprefix("Status: ")):
        yield 3, "has another status in README.md beside it"


def paragraph(lines):
    """The text up to an empty line, as one line."""
    return re.sub(r"\s+", " ", "\n".join(lines).split("\n\n")[0]).strip()


def without_links(text):
    return re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)


def folders_of_the_demo(page):
    """`burnish` refuses a folder that another command has made: no page may write where the demo did before."""
    demo = page.root / "demo"
    taken = {folder.rstrip("/") for folder in WRITTEN.findall(demo.read_text())} if demo.exists() else set()
    for number, line in enumerate(page.lines, 1):
        for folder in WRITTEN.findall(line):
            if not page.is_decision and folder.rstrip("/") in taken:
                yield number, f"writes to {folder}, to which demo writes"


def entries_of(lines):
    """(line number, text) of the entries of a list."""
    entries = []
    for number, line in enumerate(lines, 1):
        if line.startswith("- "):
            entries.append((number, line))
        elif line.startswith("  ") and entries:
            entries[-1] = (entries[-1][0], entries[-1][1] + line)
    return entries


def repeated_entries(page):
    """Entries of one version of the changes that share nearly all words of more than three letters."""
    if page.name != "CHANGELOG.md":
        return
    starts = [i for i, line in enumerate(page.lines) if line.startswith("## ")] + [len(page.lines)]
    for start, end in zip(starts, starts[1:]):
        known = []
        for number, text in entries_of(page.lines[start:end]):
            words = set(re.findall(r"\w{4,}", text.lower()))
            for other, others in known:
                shorter = min(len(words), len(others))
                if shorter > MAX_SHORT_ENTRY and len(words & others) >= MAX_SHARED * shorter:
                    yield start + number, f"says again what line {start + other} says"
            known.append((number, words))


def architecture_length(page):
    if page.name == "docs/architecture.md" and len(page.lines) > MAX_ARCHITECTURE_LINES:
        yield MAX_ARCHITECTURE_LINES + 1, f"is longer than {MAX_ARCHITECTURE_LINES} lines"


PAGE_RULES = [
    broken_links, missing_files, long_lines, srun_without_cores, commands_not_executable, banned_words, machine_states, decision_form,
    architecture_length, folders_of_the_demo, repeated_entries,
]


def pages_of(root):
    return [Page(root, path) for path in sorted([*root.glob("*.md"), *root.glob("docs/**/*.md")])]


def unreachable(root, pages):
    """Pages under docs/ that no chain of links reaches from the README."""
    by_path = {page.path.resolve(): page for page in pages}
    seen, open_pages = set(), [(root / "README.md").resolve()]
    while open_pages:
        path = open_pages.pop()
        if path in by_path and path not in seen:
            seen.add(path)
            open_pages += [target for _, target, _ in links_of(by_path[path])]
    return [page for path, page in by_path.items() if path not in seen and page.name.startswith("docs/")]


def violations(root):
    root = root.resolve()
    pages = pages_of(root)
    found = [f"{page.name}:{number}: {message}" for page in pages for rule in PAGE_RULES for number, message in rule(page)]
    return found + [f"{page.name}:1: no chain of links from README.md leads here" for page in unreachable(root, pages)]


ENTRY = "- Scenes, cameras, films, lights, shapes, meshes, bitmaps, emitters, sensors, textures, masks and views are\n"


def self_test():
    clean = {
        "README.md": "# Name\n\nSee [a page](docs/page.md#a-heading) and `src/file.h`.\n\n    pool --option\n",
        "src/file.h": "",
        "scripts/it.sh": "",
        "demo": "burnish scene name -o out/scene\n",
        "CHANGELOG.md": f"# Changelog\n\n## 2.0\n\n{ENTRY}  so.\n\n## 1.0\n\n{ENTRY}  so.\n",
        "docs/page.md": "# Page\n\n## A heading\n\n[decisions](decisions/001-it.md)\n",
        "docs/decisions/001-it.md": "# 001 It\n\nStatus: rejected, 2026-01-31\n\nThe pool.\n",
    }
    seeds = {
        "docs/page.md:7: links to gone.md": ("docs/page.md", "\n[x](gone.md)\n"),
        "docs/page.md:7: links to #gone": ("docs/page.md", "\n[x](#gone)\n"),
        "README.md:7: names src/gone.h": ("README.md", "\n`src/gone.h`\n"),
        "docs/page.md:7: has 121": ("docs/page.md", "\n" + "x" * 121 + "\n"),
        "docs/page.md:8: runs srun": ("docs/page.md", "\n\n    srun program\n"),
        "docs/page.md:8: runs scripts/it.sh": ("docs/page.md", "\n\n    scripts/it.sh --all\n"),
        "docs/page.md:7: uses the word": ("docs/page.md", "\nA pool of samples.\n"),
        "docs/page.md:7: names the state": ("docs/page.md", "\nMeasured on an idle machine.\n"),
        "docs/decisions/001-it.md:61: is longer": ("docs/decisions/001-it.md", "x\n" * 60),
        "docs/decisions/002.md:3: expected": ("docs/decisions/002.md", "# 002\n\nIt was so.\n[x](001-it.md)\n"),
        "docs/decisions/001-it.md:1: is not listed": ("docs/decisions/README.md", "# Decisions\n"),
        "docs/decisions/001-it.md:3: has another status": (
            "docs/decisions/README.md", "# Decisions\n\n- [001 It](001-it.md):\n  rejected, 2026-02-01\n"),
        "docs/page.md:7: writes to out/scene": ("docs/page.md", "\n    burnish optimize scene.xml -o out/scene/\n"),
        "CHANGELOG.md:18: says again what line 15": (
            "CHANGELOG.md", f"\n## Unreleased\n\n{ENTRY}  alike.\n\n{ENTRY}  other words.\n"),
        "docs/architecture.md:151: is longer": ("docs/architecture.md", "x\n" * 151),
        "docs/lost.md:1: no chain": ("docs/lost.md", "# Lost\n"),
    }
    for expected, (name, text) in [(None, (None, None)), *seeds.items()]:
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for file, content in clean.items():
                (root / file).parent.mkdir(parents=True, exist_ok=True)
                (root / file).write_text(content + (text if file == name else ""))
            if name and name not in clean:
                (root / name).write_text(text)
            found = violations(root)
            if bool(expected) != bool(found) or (expected and not any(v.startswith(expected) for v in found)):
                print(f"check_docs: the self-test expected {expected} and found {found}")
                return 1
    print(f"check_docs: self-test passed: {len(seeds)} seeded violations found")
    return 0


def main(arguments):
    if arguments == ["--self-test"]:
        return self_test()
    root = pathlib.Path(arguments[0]) if arguments else pathlib.Path(__file__).parents[2]
    found = violations(root)
    print("\n".join(found) if found else "check_docs: links, files, lines and words are right")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

#!/usr/bin/env python3
"""Checks how C++, kernels and GLSL are laid out: at most 120 columns and one statement a line.

    tools/check_layout.py          all files
    tools/check_layout.py FILE...  some files

clang-format cures both where it can (CONTRIBUTING.md). A `break` may follow on the line of its case.
"""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SUFFIXES = (".cpp", ".h", ".inl", ".glsl")
COLUMNS = 120
# Texts, characters and comments, of which nothing counts; newlines in them stay.
SILENT = re.compile(r'R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|(?<![\w])\'(?:\\.|[^\'\\\n])+\'|//[^\n]*|/\*.*?\*/', re.S)
SECOND = re.compile(r";\s*(?!break;)[^\s;})\\]")


def masked(text):
    """The text with nothing but newlines where something is silent or within parentheses."""
    text = SILENT.sub(lambda m: "\n" * m[0].count("\n"), text)
    depth, kept = 0, []
    for c in text:
        depth += c == "("
        if depth == 0 or c == "\n":
            kept.append(c)
        depth -= c == ")"
    return "".join(kept)


def findings(path):
    text = path.read_text()
    for number, line in enumerate(text.split("\n"), 1):
        if len(line) > COLUMNS:
            yield number, f"{len(line)} columns; at most {COLUMNS}"
    for number, line in enumerate(masked(text).split("\n"), 1):
        if SECOND.search(line) and not line.lstrip().startswith("#"):
            yield number, "more than one statement"


def main(arguments):
    if any(a.startswith("-") for a in arguments):
        sys.exit(__doc__)
    files = [Path(a).resolve() for a in arguments]
    if not files:
        folders = ("bench", "cases", "command", "examples", "include", "peers", "scenes", "src", "tests", "wild")
        files = sorted(f for folder in folders for f in (ROOT / folder).rglob("*") if f.suffix in SUFFIXES)
    count = 0
    for path in files:
        for number, what in sorted(findings(path)):
            count += 1
            print(f"{path.relative_to(ROOT) if path.is_relative_to(ROOT) else path}:{number}: {what}")
    print(f"check_layout: {len(files)} files, {count} findings")
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

#!/usr/bin/env python3
"""Checks that code which the documents quote is what stands in its file.

    tools/check_quotes.py           README.md and docs/*.md
    tools/check_quotes.py --write   bring the quotes up to date

Before the block of code stands
    <!-- quote examples/hello.cpp -->                       the whole file
    <!-- quote examples/forces/wind.cpp: PCPHYS_KERNEL -->  from the first line that begins so to the next empty one
"""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
QUOTE = re.compile(r"(<!-- quote (?P<file>[^\s:]+)(?:: (?P<start>.*?))? -->\n```\w*\n)(?P<code>.*?)(?=```\n)", re.S)


def source(file, start):
    text = (ROOT / file).read_text()
    if start is None:
        return text
    found = re.search(rf"^{re.escape(start)}.*?(?=^\n|\Z)", text, re.S | re.M)
    if not found:
        raise ValueError(f"{file} has no line that begins with `{start}`")
    return found[0]


def renewed(page):
    """The page with its quotes as they should be, and how many it has."""
    return QUOTE.subn(lambda m: m[1] + source(m["file"], m["start"]), page)


def main():
    write = sys.argv[1:] == ["--write"]
    if sys.argv[1:] and not write:
        sys.exit(__doc__)
    wrong = quotes = 0
    for path in [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]:
        page = path.read_text()
        try:
            fresh, count = renewed(page)
        except (OSError, ValueError) as error:
            sys.exit(f"{path.relative_to(ROOT)}: {error}")
        quotes += count
        if count != page.count("<!-- quote "):
            sys.exit(f"{path.relative_to(ROOT)}: a `<!-- quote ... -->` is not followed by a block of code")
        if fresh == page:
            continue
        if write:
            path.write_text(fresh)
        else:
            wrong += 1
            print(f"{path.relative_to(ROOT)}: a quote differs from its file; run tools/check_quotes.py --write")
    if not wrong:
        print(f"{quotes} quotes are as their files")
    return 1 if wrong or not quotes else 0


if __name__ == "__main__":
    sys.exit(main())

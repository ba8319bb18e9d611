#!/usr/bin/env python3
"""Checks that physics stands only in kernels, and that kernel text rounds the same everywhere.

    tools/check_kernels.py                     the whole tree
    tools/check_kernels.py FILE...             some files
    tools/check_kernels.py --self-test FOLDER  samples whose `// expect: RULE` comments must match

In src/kernels/**/*.inl (the common subset of C++20 and GLSL):
    call      only pc_ and PC_ names, functions of the kernels, and constructors may be called
    division  no operator / on reals: devices round it differently
    precise   a sum, difference or product of reals is the initialiser of a `precise` local
    literal   constants of reals stand in PC_REAL(...)
    bare      other numbers than 0.0, 0.5, 1.0 and 2.0 have a name: #define NAME PC_REAL(...), or are of math*.inl
    reserved  no name that GLSL keeps for itself
    nodes     a loop over the nodes of a tree is one of nodes.inl, which say how a work group may share it
In src/cpu, src/glcompute and src/step (loops and bindings only; lanes*.h and prelude*.h define the types):
    backend   no floating-point literal, arithmetic or mathematical function
Anywhere:
    unread    a statement with arithmetic that this checker cannot read
    marker    `lint: allow` without a reason

`// lint: allow (reason)` excuses its own line and the next one, `// lint: allow-file (reason)` the file.
"""
import re
import sys
from pathlib import Path

from kernel_lint.backend import check_backend
from kernel_lint.kernel import Kernel, Names
from kernel_lint.source import Source

CURES = {
    "call": "use a pc_ function of math.inl, or add one there",
    "division": "use pc_div(a, b)",
    "precise": "give the result a name first: precise Real x = ...;",
    "literal": "write PC_REAL({})",
    "bare": "give {} a name: #define NAME PC_REAL(...)",
    "reserved": "GLSL keeps this word: choose another name",
    "nodes": "use PC_NODES, PC_DOWN, PC_UP, PC_CHILDREN or PC_ALL",
    "backend": "move it into a kernel in src/kernels (times: count nanoseconds as integers)",
    "unread": "write it as simple declarations and assignments",
    "marker": "write // lint: allow (reason)",
}
BACKENDS = ("cpu", "glcompute", "step")


def is_kernel(path):
    return path.suffix == ".inl" and path.parent.name not in BACKENDS


def tree(root):
    files = list(root.glob("src/kernels/**/*.inl"))
    for folder in BACKENDS:
        for suffix in ("cpp", "h", "inl", "glsl"):
            files += [f for f in root.glob(f"src/{folder}/*.{suffix}") if not re.match(r"(lanes|prelude).*\.h$", f.name)]
    return sorted(files)


def check(files):
    sources = [Source(f) for f in files]
    kernels = [s for s in sources if is_kernel(s.path)]
    names = Names(kernels)
    for source in sources:
        if is_kernel(source.path):
            Kernel(source, names)
        else:
            check_backend(source)
    return sources


def self_test(folder):
    sources = check(sorted(f for f in Path(folder).iterdir() if f.suffix in (".inl", ".cpp", ".glsl")))
    failures = 0
    for source in sources:
        found = sorted({(line, rule) for line, rule, _ in source.open_findings()})
        expected = sorted(set(source.expected))
        for line, rule in sorted(set(found) ^ set(expected)):
            failures += 1
            print(f"{source.path}:{line}: {rule} {'was not found' if (line, rule) in expected else 'was not expected'}")
    print(f"{len(sources)} samples, {failures} differences")
    return 1 if failures or not sources else 0


def main(arguments):
    root = Path(__file__).resolve().parent.parent
    if arguments[:1] == ["--self-test"] and len(arguments) == 2:
        return self_test(arguments[1])
    if any(a.startswith("-") for a in arguments):
        print(__doc__)
        return 0 if arguments[0] in ("-h", "--help") else 2
    files = [Path(a).resolve() for a in arguments] or tree(root)
    if arguments:  # kernels know each other's functions and constants, so read them all and report the chosen ones
        files += [f for f in root.glob("src/kernels/**/*.inl") if f not in files]
    chosen = {Path(a).resolve() for a in arguments}
    count = 0
    for source in check(files):
        if chosen and source.path not in chosen:
            continue
        for line, rule, what in source.open_findings():
            count += 1
            shown = source.path.relative_to(root) if source.path.is_relative_to(root) else source.path
            print(f"{shown}:{line}: {rule}: {what}; {CURES[rule].format(what)}")
    print(f"check_kernels: {len(chosen) or len(files)} files, {count} findings")
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

#!/usr/bin/env python3
"""Makes the runs that docs/gpu.md reports, and its tables from them.

    tools/gpu_table.py --run PCPHYS ROWS.json [--steps K]    runs the command PCPHYS and writes a list of its JSON
    tools/gpu_table.py ROWS.json                             prints the tables as Markdown
    tools/gpu_table.py ROWS.json --into docs/gpu.md          puts them between the page's two marks

A row is the object that `pcphys run --json` writes. Ends with 1 when two runs of a scene have other hashes.
"""
import itertools
import json
import subprocess
import sys
import tempfile
from pathlib import Path

PARITY = [("balls", 60), ("ragdolls", 8), ("pyramid", 20), ("chain", 20), ("door", 1), ("dominoes", 20), ("stack", 10), ("hulls", 20),
          ("chainswing", 20), ("heavy", 2), ("ballistic", 1000),
          ("magnets", 72)]
LARGE = [("balls", 1000), ("balls", 10000), ("ragdolls", 100), ("ragdolls", 1000), ("pyramid", 60)]
LANES = {"float": (1, 4, 8), "double": (1, 4)}
STAGES = ("integrate", "joints", "impulses")
TIMED = ("broad", "narrow", "plan", "upload", "integrate", "joints", "impulses", "download")
UNSOUND = 3  # exit status of a run that lost bodies
BEGIN, END = "<!-- tables: begin -->", "<!-- tables: end -->"


# ---- making rows -----------------------------------------------------------------------------------
def commands(pcphys, steps):
    """One command line a row."""
    for precision, (scene, count) in itertools.product(LANES, PARITY):
        base = [pcphys, "run", scene, "--count", str(count), "--steps", str(steps or 600), "--precision", precision]
        for lanes in LANES[precision]:
            yield base + ["--lanes", str(lanes)]
        for mix in itertools.product(("cpu", "gl"), repeat=3):
            if "gl" in mix:
                yield base + [word for stage, place in zip(STAGES, mix) for word in (f"--{stage}", place)]
    for scene, count in LARGE:
        for backend in ("cpu", "gl"):
            yield [pcphys, "run", scene, "--count", str(count), "--steps", str(steps or 120), "--backend", backend]


def make_rows(pcphys, target, steps):
    rows, all_commands = [], list(commands(pcphys, steps))
    with tempfile.TemporaryDirectory() as folder:
        for number, command in enumerate(all_commands, 1):
            print(f"{number}/{len(all_commands)} {' '.join(command[1:])}", file=sys.stderr)
            file = Path(folder) / "row.json"
            done = subprocess.run(command + ["--json", str(file)], stdout=subprocess.DEVNULL)
            if done.returncode not in (0, UNSOUND):  # unsound runs are results too: the table names them
                sys.exit(f"gpu_table: {' '.join(command)} ended with {done.returncode}")
            rows.append(json.loads(file.read_text()))
    Path(target).write_text(json.dumps(rows, indent=1))


# ---- tables ----------------------------------------------------------------------------------------
def groups(rows):
    """Rows of the same scene, count, precision and steps, in the order of the file."""
    result = {}
    for row in rows:
        result.setdefault((row["scene"], row["count"], row["precision"], row["steps"]), []).append(row)
    return result


def place(row):
    return "/".join(row["stage_backends"][stage] for stage in STAGES)


def reference(group):
    """The scalar run on the CPU; the first on the CPU where there is none."""
    on_cpu = [row for row in group if row["backend"] == "cpu"] or group
    return min(on_cpu, key=lambda row: row["lanes"])


def sound(group):
    return all(row["escaped"] == 0 and row["nonfinite"] == 0 and not row["overflow"] for row in group)


def ms(group, lanes=None, backend="cpu"):
    found = [row["median_ms"] for row in group if row["backend"] == backend and (lanes is None or row["lanes"] == lanes)]
    return f"{found[0]:.3f}" if found else ""


def table(titles, lines):
    rule = "|" + "---|" * len(titles)
    return "\n".join(["| " + " | ".join(titles) + " |", rule] + ["| " + " | ".join(line) + " |" for line in lines]) + "\n"


def parity_table(rows):
    lines, equal = [], True
    for (scene, count, precision, steps), group in groups(rows).items():
        first = reference(group)
        other = [row for row in group if row["hash"] != first["hash"]]
        equal = equal and not other
        verdict = "equal" if not other else f"**{len(other)} differ** (integrate/joints/impulses on " + ", ".join(place(row) for row in other) + ")"
        lines.append([f"{scene} {count}", precision, str(steps), str(len(group)), verdict, f"`{first['hash']}`", "yes" if sound(group) else "**no**"])
    return table(["scene", "precision", "steps", "runs", "hashes", "hash of the scalar CPU run", "none lost or overflowed"], lines), equal


def small_table(rows):
    """Scenes that were run in every mix."""
    lines = []
    for (scene, count, precision, _), group in groups(rows).items():
        if len(group) > 2:
            lines.append([f"{scene} {count}", precision, *(ms(group, lanes) for lanes in (1, 4, 8)), ms(group, backend="gl")])
    return table(["scene", "precision", "cpu, 1 lane", "4 lanes", "8 lanes", "gl, all stages"], lines)


def large_table(rows):
    """Scenes that were run once on either side, with the time of each stage."""
    lines = []
    for (scene, count, _, _), group in groups(rows).items():
        if len(group) == 2:
            for row in group:
                where = f"cpu, {row['lanes']} lanes" if row["backend"] == "cpu" else "gl"
                lines.append([f"{scene} {count:,}", where, f"{row['median_ms']:.2f}", *(f"{row['stages'][stage]:.2f}" for stage in TIMED),
                              f"{row['transfers_bytes'] / 1e6:.1f}", f"{row['contacts']:,}", str(row["colours"])])
    return table(["scene", "where", "step", *TIMED, "MB over the bus", "contacts", "colours"], lines)


def report(rows):
    parity, equal = parity_table(rows)
    devices = sorted({row["devices"]["gl"] for row in rows if row["devices"]["gl"]})
    text = f"{len(rows)} runs; GL device: {', '.join(devices) or 'none'}.\n\n"
    text += "### Hashes\n" + parity
    text += "\n### Small scenes: median ms a step\n" + small_table(rows)
    text += "\n### Larger scenes: median ms a step, float\nA stage's median need not come from the same step, so stages do not add up exactly.\n\n" + large_table(rows)
    return text, equal


def insert(page, text):
    path = Path(page)
    before, _, rest = path.read_text().partition(BEGIN)
    _, mark, after = rest.partition(END)
    if not mark:
        sys.exit(f"gpu_table: {page} lacks the lines {BEGIN} and {END}; add them where the tables belong.")
    path.write_text(f"{before}{BEGIN}\n{text}{END}{after}")


def main(arguments):
    steps = 0
    if "--steps" in arguments:
        at = arguments.index("--steps")
        steps = int(arguments[at + 1])
        del arguments[at:at + 2]
    if len(arguments) == 3 and arguments[0] == "--run":
        make_rows(arguments[1], arguments[2], steps)
        return 0
    if len(arguments) not in (1, 3) or (len(arguments) == 3 and arguments[1] != "--into"):
        print(__doc__)
        return 2
    text, equal = report(json.loads(Path(arguments[0]).read_text()))
    if len(arguments) == 3:
        insert(arguments[2], text)
    else:
        print(text, end="")
    if not equal:
        print("gpu_table: not all hashes of a scene are equal; see the table.", file=sys.stderr)
    return 0 if equal else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

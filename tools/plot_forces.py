#!/usr/bin/env python3
"""Draws what the programs of examples/forces show: docs/img/forces/*.svg.

    tools/plot_forces.py [BUILD]      where the examples are built; default build/release

Runs each program with --csv and draws its columns over time: "x" as a line, its closed form "x exact" as dashes; where it has errors
over the sub-step (--errors), these beside a line of second order.
Needs matplotlib (Debian: python3-matplotlib).
"""
import csv
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
OUT = ROOT / "docs" / "img" / "forces"
# of each program: what the y axis is of the columns that it draws, and where it ends, if a legend needs room
PLOTS = {
    "wind": [("vertical speed [m/s]", ["flat", "tilted", "on edge"])],
    "springs": [("place [m]", ["kernel light", "library light", "kernel strong", "library strong"])],
    "cord": [("length [m]", ["jumper", "two bodies"])],
    "buoyancy": [("height over the water [m]", ["sphere 300", "box 400", "tilted box 750"])],
    "thruster": [("speed [m/s]", ["speed"]), ("fuel [kg]", ["fuel"])],
    "attraction": [("distance [m]", ["distance"]), ("energy [J]", ["kinetic", "potential", "sum"])],
    "orbit": [("distance [m]", ["distance"], 1.9), ("energy, of its amount [%]", ["energy gained"], 0.55)],
}
ERRORS = {"orbit": "largest error in a turn [m]"}


def columns(program, option="--csv"):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "rows.csv"
        subprocess.run([program, option, path], check=True)
        with open(path) as file:
            rows = list(csv.DictReader(file))
    return {name: [float(row[name]) for row in rows] for name in rows[0]}


def draw_errors(axis, label, data):
    steps = data.pop("sub-step")
    for name, marker in zip(data, "os^"):
        axis.loglog(steps, data[name], marker + "-", ms=4, lw=1.4, label=name)
    worst = max(data.values(), key=sum)
    axis.loglog(steps, [worst[-1] * (h / steps[-1]) ** 2 for h in steps], "--", lw=1, color="black", label="second order")
    axis.set(xlabel="sub-step [s]", ylabel=label)
    axis.spines[["top", "right"]].set_visible(False)
    axis.legend(frameon=False, fontsize=8)


def draw(plt, name, data, errors):
    count = len(PLOTS[name]) + (errors is not None)
    figure, axes = plt.subplots(1, count, figsize=(max(7, 3.3 * count), 3.2), squeeze=False, layout="constrained")
    if errors is not None:
        draw_errors(axes[0][-1], ERRORS[name], errors)
    for axis, (label, names, *top) in zip(axes[0], PLOTS[name]):
        for series in names:
            line, = axis.plot(data["time"], data[series], lw=1.8, label=series)
            exact = data.get(f"{series} exact", data.get(f"{series.split()[-1]} exact"))
            axis.plot(data["time"], exact, "--", lw=1, color="black", label="closed form" if series == names[-1] else None)
        axis.set(xlabel="time [s]", ylabel=label)
        axis.set_ylim(top=top[0] if top else None)
        axis.spines[["top", "right"]].set_visible(False)
        axis.legend(frameon=False, fontsize=8)
    figure.savefig(OUT / f"{name}.svg", metadata={"Date": None})
    plt.close(figure)


def main():
    try:
        import matplotlib
    except ImportError:
        sys.exit("plot_forces: matplotlib was not found; install it (Debian, Ubuntu: apt-get install python3-matplotlib).")
    matplotlib.use("svg")
    matplotlib.rcParams.update({"svg.hashsalt": "pcphys", "svg.fonttype": "none"})  # the same file from the same rows
    import matplotlib.pyplot as plt
    build = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "build" / "release"
    OUT.mkdir(parents=True, exist_ok=True)
    for name in PLOTS:
        program = build / "examples" / f"example_{name}"
        draw(plt, name, columns(program), columns(program, "--errors") if name in ERRORS else None)


if __name__ == "__main__":
    main()

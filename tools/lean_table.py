#!/usr/bin/env python3
"""The tables of docs/leaving-out.md, measured: `tools/lean_table.py build/release/bench/pcphys_bench` writes them between the
page's marks; without a page to write (`--print`) they go to standard output."""
import argparse
import json
import pathlib
import subprocess

PAGE = pathlib.Path(__file__).resolve().parent.parent / "docs" / "leaving-out.md"


def rows(bench, pattern):
    text = subprocess.run([bench, f"--benchmark_filter={pattern}", "--benchmark_format=json"], check=True, capture_output=True,
                          text=True).stdout
    return json.loads(text[text.index("{"):])["benchmarks"]


def size(count):
    return f"{count / 1e6:.2f} MB" if count >= 1e6 else f"{count / 1e3:.1f} kB"


def kinds(bench):
    lines = ["| scene: with; without | bodies | step, ms | | contacts | | kernel runs | | memory | | time left |",
             "|---|---|---|---|---|---|---|---|---|---|---|"]
    for row in rows(bench, "^leaving_out/"):
        name = row["name"].split("/")[1]
        if "error_message" in row:
            lines.append(f"| {name} | {row['error_message']} |")
            continue
        lines.append(f"| {name} | {row['bodies']:.0f} | {row['on_ms']:.4f} | {row['out_ms']:.4f} | {row['on_contacts']:.0f} | "
                     f"{row['out_contacts']:.0f} | {row['on_kernels']:.0f} | "
                     f"{row['out_kernels']:.0f} | {size(row['on_bytes'])} | {size(row['out_bytes'])} | "
                     f"{100 * row['out_ms'] / row['on_ms']:.0f} % |")
    return lines


def planning(bench):
    lines = ["| what | time |", "|---|---|"]
    for row in rows(bench, "^planning/"):
        what = row["name"].split("/iterations")[0][len("planning/"):]
        if "plan_us" in row:
            lines.append(f"| {what} | {row['plan_us']:.1f} us |")
        elif "replan_ms" in row:
            lines.append(f"| {what} | {row['replan_ms']:.2f} ms beyond the {row['step_ms']:.2f} ms of an ordinary step; of the least disturbed of 15, {row['least_ms']:.2f} ms |")
        else:
            lines.append(f"| {what} | {row['real_time'] / 1000:.3f} us |")
    return lines


def flight(bench):
    lines = ["| bodies, place | pcphys, ms | by hand, ms | ratio | differing bodies |", "|---|---|---|---|---|"]
    for row in rows(bench, "^ballistic/.*/(cpu|gl)"):
        what = " ".join(row["name"].split("/")[1:3])
        if "ratio" not in row:
            lines.append(f"| {what} | {row.get('error_message', '')} |")
            continue
        differs = f"{row['differs']:.0f}" if "differs" in row else "not compared"
        lines.append(f"| {what} | {row['ms']:.3f} | {row['hand_ms']:.3f} | {row['ratio']:.2f} | {differs} |")
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("bench")
    parser.add_argument("--print", action="store_true")
    options = parser.parse_args()
    tables = {"kinds": kinds(options.bench), "planning": planning(options.bench), "flight": flight(options.bench)}
    if options.print:
        for lines in tables.values():
            print("\n".join(lines) + "\n")
        return
    text = PAGE.read_text()
    for name, lines in tables.items():
        begin, end = f"<!-- {name} -->\n", f"<!-- end of {name} -->"
        head, rest = text.split(begin, 1)
        text = head + begin + "\n".join(lines) + "\n" + end + rest.split(end, 1)[1]
    PAGE.write_text(text)


if __name__ == "__main__":
    main()

"""Error against run time, beside other engines: which runs and curves lie under which (for accuracy_report.py)."""
import math

FLOOR = 1e-17  # an error of zero is drawn here


def group(rows, *keys):
    """Rows by the values of these keys, in the order of their first appearance."""
    result = {}
    for row in rows:
        result.setdefault(tuple(row[k] for k in keys), []).append(row)
    return result


def cell(text):
    """A bar would end the cell of a Markdown table."""
    return text.replace("|", "\\|")


def is_order(row):
    return row["metric"].startswith(("2 - order of", "4 - order of"))


def drawn(rows):
    """Of a variant's rows, those of the metric that its diagram shows."""
    rows = [r for r in rows if not is_order(r) and r["total_ms"] > 0]
    return [r for r in rows if r["metric"] == rows[0]["metric"]]


ORDER_4 = ", order 4"  # ends the name of a variant that asks for it (StepSettings::order): a setting, as the sub-steps are


def curves(rows):
    """Rows with the name of the variant without settings, and beside them the curve that a run of ours belongs to. What a peer ran
    is the same with either setting: its faster run is kept."""
    fastest, result = {}, []
    for r in rows:
        fourth = r["variant"].endswith(ORDER_4)
        r = {**r, "variant": r["variant"].removesuffix(ORDER_4), "curve": r["precision"] + (ORDER_4 if fourth else "")}
        if r["peer"]:
            run = tuple(r[k] for k in ("case", "variant", "precision", "dt", "substeps", "metric", "peer"))
            if run in fastest:
                if r["total_ms"] < fastest[run]["total_ms"]:
                    fastest[run].update(r)
                continue
            fastest[run] = r
        result.append(r)
    return result


def went_through(rows):
    """Those that did not fail: not by themselves, and not by an error as large as the motion."""
    return [r for r in rows if r["error"] is not None and not r.get("lost")]


def measured(row):
    """Its error, or what the measure itself may be off by (`floor` of the variants in cases/*.cpp): below it errors are equal."""
    return max(row["error"], row.get("floor") or FLOOR)


def beaten(row, own):
    """Whether one of our runs took no longer and erred no more."""
    return not went_through([row]) or any(
        r["total_ms"] <= row["total_ms"] and measured(r) <= measured(row) for r in went_through(own))


def front(rows):
    """Of the runs those that no other one beats, by run time, as logarithms of time and error; level from the last of them to the
    longest run."""
    points = []
    ordered = sorted(went_through(rows), key=lambda r: (r["total_ms"], r["error"]))
    for r in ordered:
        error = math.log10(measured(r))
        if not points or error < points[-1][1]:
            points.append((math.log10(r["total_ms"]), error))
    if points and ordered[-1]["total_ms"] > 10 ** points[-1][0]:
        points.append((math.log10(ordered[-1]["total_ms"]), points[-1][1]))
    return points


def height(curve, x):
    """Of the line through the points, at an abscissa between its ends."""
    for (x0, y0), (x1, y1) in zip(curve, curve[1:]):
        if x0 <= x <= x1:
            return y0 + (y1 - y0) * (x - x0) / (x1 - x0) if x1 > x0 else min(y0, y1)
    return curve[0][1] if x <= curve[0][0] else curve[-1][1]


def lies_under(own, other):
    """Whether our curve is nowhere above the other, over the run times that both cover, from the shortest run to the longest. Where
    they share none, every run of the other must be beaten."""
    ours, theirs = front(own), front(other)
    if not theirs or not ours:
        return not theirs
    first, last = max(ours[0][0], theirs[0][0]), min(ours[-1][0], theirs[-1][0])
    if first > last:
        return all(beaten(r, own) for r in other)
    places = [first, last] + [x for x, _ in ours + theirs if first < x < last]
    return all(height(ours, x) <= height(theirs, x) + 1e-9 for x in places)


def contest(rows):
    """Case by case, how many runs of each peer have one of ours beneath and left of them in the diagrams."""
    rows = curves(rows)
    peers = list(dict.fromkeys(r["peer"] for r in rows if r["peer"]))
    if not peers:
        return []
    lines, under, shared, as_one, cases, lost, above = [], 0, 0, 0, 0, [], []
    for (case,), of_case in group(rows, "case").items():
        tally = {peer: [0, 0] for peer in peers}
        crossed, mixed = [], 0
        for (variant,), of_variant in group(of_case, "variant").items():
            shown = drawn(of_variant)
            own = [r for r in shown if not r["peer"]]
            for (peer,), series in group([r for r in shown if r["peer"]], "peer").items():
                won = sum(beaten(r, own) for r in series)
                tally[peer][0] += won
                tally[peer][1] += len(series)
                mixed += not lies_under(own, series)
                if not any(lies_under(curve, series) for _, curve in group(own, "curve").items()):
                    crossed.append(f"{variant}: {peer}")
                if won < len(series):
                    lost.append((case, variant, peer, len(series) - won, len(series)))
        if not any(total for _, total in tally.values()):
            continue
        cases += 1
        under += all(won == total for won, total in tally.values())
        shared += not crossed
        as_one += mixed == 0
        above += [f"* {case}: {cell('; '.join(crossed))}"] if crossed else []
        lines.append(f"| {case} | " + " | ".join(f"{won} of {total}" if total else "-" for won, total in tally.values()) + " |")
    head = ["", "## Beside other engines", "",
            "Runs of each engine that have one of pcphys's beneath them or to their left in the diagram: no longer, and no "
            "larger an error. A run that failed counts as beneath, and so does one whose error is as large as the motion itself "
            "(`lost_at` of the variants in `cases/*.cpp`: a phase lost by a radian, a joint apart by a link); of pcphys such runs "
            "beat nothing.", "",
            f"**In {under} of {cases} cases every run of every peer is beaten in this way**: pcphys's staircase lies under every peer's "
            "at every run time, the shortest of the peer's included, where a run can be beaten only by a cheaper one.", "",
            f"**In {shared} of {cases} cases pcphys's curve lies under every peer's at every run time that both cover**: lines "
            "through the runs that no other of the same engine beats, time and error as logarithms, from its shortest run to its "
            "longest. Double and single precision are two curves, fourth order where a variant has it two more, and one of them must lie "
            "under the peer's. What the measure itself "
            f"may be off by (`floor` of the variants) counts as equal. (With all of them as one curve: {as_one}.)", "",
            "| case | " + " | ".join(peers) + " |", "|---" * (len(peers) + 1) + "|"]
    tail = ["", "Where a peer has a run that none of ours is under:", ""]
    for (case,), of_case in group([dict(zip(("case", "variant", "peer", "runs", "of"), l)) for l in lost], "case").items():
        named = "; ".join(f"{l['variant']}: {l['peer']} {l['runs']} of {l['of']}" for l in of_case)
        tail.append(f"* {case}: {cell(named)}")
    crossings = ["", "Where a peer's curve comes below ours at run times that both cover:", ""] + above
    return head + lines + (tail if lost else []) + (crossings if above else [])

#!/usr/bin/env python3
"""Prints a table of the runs in a folder of scripts/demo, and draws them in FOLDER/demo.png.

    tools/plot_demo.py FOLDER     reads FOLDER/SCENE-BACKEND.json and .gltf as `pcphys run` writes them

Ends with 1 when a body escaped, a number is not finite, a buffer overflowed, or backends disagree on the hash.
"""
import base64
import json
import sys
from pathlib import Path

TABLE = [  # title, width, value of a run
    ("scene", 14, lambda r: f"{r['scene']} {r['count']}"),
    ("backend", 8, lambda r: r["backend"]),
    ("ms/step", 8, lambda r: f"{r['median_ms']:.3f}"),
    ("max fps", 9, lambda r: f"{r['max_fps']:.0f}"),
    ("min fps", 9, lambda r: f"{r['min_fps']:.0f}"),
    ("contacts", 9, lambda r: str(r["contacts"])),
    ("overlap mm", 11, lambda r: f"{1000 * r['max_penetration']:.2f}"),
    ("joint mm", 9, lambda r: f"{1000 * r['max_joint_separation']:.2f}" if r["joints"] else "-"),
    ("escaped", 8, lambda r: str(r["escaped"])),
    ("not finite", 11, lambda r: str(r["nonfinite"])),
    ("hash", 19, lambda r: str(r["hash"])),
    ("device", 0, lambda r: r["device"]),
]


def print_table(runs):
    print("".join(title.ljust(width) for title, width, _ in TABLE))
    for run in runs:
        print("".join(str(value(run)).ljust(width) for _, width, value in TABLE))
    good = True
    print()
    for scene in dict.fromkeys(r["scene"] for r in runs):
        group = [r for r in runs if r["scene"] == scene]
        equal = len(group) > 1 and len({r["hash"] for r in group}) == 1
        sound = all(r["escaped"] == 0 and r["nonfinite"] == 0 and not r["overflow"] for r in group)
        backends = " and ".join(r["backend"] for r in group)
        verdict = "the same bits" if equal else "DIFFERENT BITS" if len(group) > 1 else "only one backend ran"
        print(f"{scene}: {backends}: {verdict} after {group[0]['steps']} steps" + ("" if sound else "; BODIES LOST, see above"))
        good = good and equal and sound
    return good


# ---- the scene, out of glTF ------------------------------------------------------------------------
class Scene:
    """Meshes and moving nodes of a glTF file."""

    def __init__(self, path):
        import numpy as np
        self.np, self.folder = np, Path(path).parent
        self.doc = json.loads(Path(path).read_text())
        self.data = [self.buffer(b["uri"]) for b in self.doc["buffers"]]
        self.tracks = {}
        for animation in self.doc.get("animations", []):
            for channel in animation["channels"]:
                sampler = animation["samplers"][channel["sampler"]]
                self.tracks.setdefault(channel["target"]["node"], {})[channel["target"]["path"]] = (
                    self.accessor(sampler["input"]), self.accessor(sampler["output"]))
        self.duration = max((float(t[0][-1]) for track in self.tracks.values() for t in track.values()), default=0.0)

    def buffer(self, uri):
        return base64.b64decode(uri.split(",", 1)[1]) if uri.startswith("data:") else (self.folder / uri).read_bytes()

    def accessor(self, index):
        np, a = self.np, self.doc["accessors"][index]
        view = self.doc["bufferViews"][a["bufferView"]]
        dtype = np.dtype({5121: "<u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}[a["componentType"]])
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[a["type"]]
        start = view.get("byteOffset", 0) + a.get("byteOffset", 0)
        stride = view.get("byteStride", dtype.itemsize * width)
        raw = np.frombuffer(self.data[view["buffer"]], np.uint8)
        rows = np.lib.stride_tricks.as_strided(raw[start:], (a["count"], dtype.itemsize * width), (stride, 1))
        values = np.ascontiguousarray(rows).view(dtype)
        return values[:, 0] if width == 1 else values

    def value(self, node, path, time, default):
        track = self.tracks.get(node, {}).get(path)
        if track is None:
            return self.np.array(self.doc["nodes"][node].get(path, default), float)
        return self.np.array(track[1][min(self.np.searchsorted(track[0], time - 1e-6), len(track[0]) - 1)], float)

    def triangles(self, time):
        """(moving, node, corners) of every mesh at a time; corners are n x 3 x 3, in world axes."""
        np, result = self.np, []

        def visit(node, rotation, origin, moving):
            item = self.doc["nodes"][node]
            x, y, z, w = self.value(node, "rotation", time, [0, 0, 0, 1])
            turn = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                             [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                             [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])
            moving = moving or node in self.tracks
            origin = origin + rotation @ self.value(node, "translation", time, [0, 0, 0])
            rotation = rotation @ turn @ np.diag(self.value(node, "scale", time, [1, 1, 1]))
            if "mesh" in item:
                for part in self.doc["meshes"][item["mesh"]]["primitives"]:
                    if part.get("mode", 4) == 4:
                        points = self.accessor(part["attributes"]["POSITION"]) @ rotation.T + origin
                        corners = self.accessor(part["indices"]) if "indices" in part else np.arange(len(points))
                        result.append((moving, node, points[corners.reshape(-1, 3)]))
            for child in item.get("children", []):
                visit(child, rotation, origin, moving)

        for root in self.doc["scenes"][self.doc.get("scene", 0)]["nodes"]:
            visit(root, np.eye(3), np.zeros(3), False)
        return result


def camera(scene):
    """Where to stand so that everything that moves is in view: (centre, axes, distance)."""
    np = scene.np
    seen = [t.reshape(-1, 3) for time in (0, scene.duration) for moving, _, t in scene.triangles(time) if moving]
    points = np.concatenate(seen)
    low, high = np.percentile(points, [0.5, 99.5], axis=0)
    forward = np.array([-0.62, -0.38, -0.69])
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, [0, 1, 0])
    right /= np.linalg.norm(right)
    return (low + high) / 2, np.array([right, np.cross(right, forward), forward]), 1.25 * np.linalg.norm(high - low)


def draw(axes, scene, time, view):
    """Painter's algorithm: far triangles first, static bodies as faint back walls."""
    from matplotlib import colormaps
    from matplotlib.collections import PolyCollection
    np = scene.np
    centre, frame, distance = view
    light = np.array([0.35, 0.85, 0.4]) / np.linalg.norm([0.35, 0.85, 0.4])
    polygons, colours, depths = [], [], []
    palette = colormaps["turbo"](np.linspace(0.08, 0.92, 24))[:, :3]
    for moving, node, corners in scene.triangles(time):
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        length = np.linalg.norm(normal, axis=1, keepdims=True)
        normal = normal / np.where(length > 0, length, 1)
        eye = (corners - centre) @ frame.T
        depth = eye[..., 2] + distance
        facing = np.einsum("ij,ij->i", normal, corners.mean(axis=1) - (centre - distance * frame[2])) < 0
        # Of a container only the far walls are shown, else it would hide what is in it.
        keep = (depth.min(axis=1) > 0.05 * distance) & (facing if moving else True)
        if not moving:
            keep &= (np.abs(eye[..., :2]).max(axis=(1, 2)) < 3 * distance)
        flat = eye[..., :2] / depth[..., None] * distance
        shade = 0.35 + 0.65 * np.clip(normal @ light, 0, 1)
        colour = np.ones((len(corners), 4))
        colour[:, :3] = palette[(node * 7) % 24] * shade[:, None] if moving else 0.55
        colour[:, 3] = 1 if moving else 0.10
        polygons.append(flat[keep])
        colours.append(colour[keep])
        depths.append(depth.mean(axis=1)[keep] + (0 if moving else 10 * distance))
    order = np.argsort(-np.concatenate(depths))
    axes.add_collection(PolyCollection(np.concatenate(polygons)[order], facecolors=np.concatenate(colours)[order],
                                       edgecolors="none", antialiaseds=False))
    half = 0.46 * distance
    axes.set(xlim=(-half, half), ylim=(-half, half), aspect="equal", xticks=[], yticks=[], facecolor="#f4f4f1")
    for side in axes.spines.values():
        side.set_visible(False)
    axes.set_title(f"{time:.1f} s", fontsize=9, loc="left", color="#444444")


def picture(runs, folder):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    scenes = list(dict.fromkeys(r["scene"] for r in runs))
    figure = plt.figure(figsize=(16, 3.9 * len(scenes)), layout="constrained")
    grid = figure.add_gridspec(len(scenes), 5, width_ratios=[1, 1, 1, 1, 1.15])
    for row, name in enumerate(scenes):
        group = [r for r in runs if r["scene"] == name]
        file = next((f for f in (folder / f"{name}-{r['backend']}.gltf" for r in group) if f.exists()), None)
        if file:
            scene = Scene(file)
            view = camera(scene)
            for column, share in enumerate((0, 0.12, 0.35, 1)):
                draw(figure.add_subplot(grid[row, column]), scene, share * scene.duration, view)
        bars(figure.add_subplot(grid[row, 4]), group)
    figure.suptitle("pcphys: one source of physics, run on the CPU and through OpenGL", fontsize=14, x=0.01, ha="left")
    figure.savefig(folder / "demo.png", dpi=110)
    plt.close(figure)


def bars(axes, group):
    """Median time of each stage, one bar a backend, and the figures that matter beside it."""
    stages = list(dict.fromkeys(s for r in group for s in r["stages"]))
    colours = dict(zip(stages, ["#4477aa", "#ee6677", "#228833", "#ccbb44", "#66ccee", "#aa3377", "#999933", "#bbbbbb", "#332288"] * 4))
    for place, run in enumerate(group):
        start = 0
        for stage in stages:
            time = run["stages"].get(stage, 0)
            axes.barh(place, time, left=start, color=colours[stage], label=stage if place == 0 else None, height=0.5)
            start += time
        axes.text(0, place + 0.36, f"{run['backend']}: {run['device']}", fontsize=8, va="center", color="#333333")
    first = group[0]
    same = len(group) > 1 and len({r["hash"] for r in group}) == 1
    text = f"overlap at most {1000 * first['max_penetration']:.2f} mm"
    if first["joints"]:
        text += f", joints {1000 * first['max_joint_separation']:.2f} mm"
    axes.set_title(f"{first['scene']} {first['count']}: " + ("equal to the last bit" if same else "hashes differ"), fontsize=11, loc="left")
    axes.set(xlabel=f"ms a step, median of {first['steps']}\n{text}", yticks=[], ylim=(-0.9, len(group) - 0.4))
    axes.legend(fontsize=7, ncols=3, loc="lower right", frameon=False)
    for side in ("top", "right", "left"):
        axes.spines[side].set_visible(False)


def main(arguments):
    if len(arguments) != 1:
        print(__doc__)
        return 2
    folder = Path(arguments[0])
    runs = [json.loads(f.read_text()) for f in sorted(folder.glob("*-*.json"))]
    if not runs:
        print(f"plot_demo: no run in {folder}; scripts/demo makes them", file=sys.stderr)
        return 1
    good = print_table(runs)
    try:
        import matplotlib  # noqa: F401
    except ImportError:
        print("No picture: matplotlib is missing (apt-get install python3-matplotlib).")
        return 0 if good else 1
    picture(runs, folder)
    print(f"Picture: {folder / 'demo.png'}")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

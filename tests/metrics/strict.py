"""Recomputes the values behind the strict verdict on contact from the positions of stored runs, with independent code: brute
force on small grids. usage: strict.py FOLDER

Fails if a stored value differs from the value computed here by more than this code's accuracy, if a verdict does not follow from
its value, or if fewer values were compared than COMPARED expects. Not computed here: crossings, which need the motion between
frames, and the contour of a hand of capsules, whose fingers are thinner than the distance between the sample points.
"""
import functools
import itertools
import json
import pathlib
import sys

import h5py
import numpy as np

COMPARED = {"stretch_max": 15, "stretch_max_end": 15, "pop_max_m": 15, "contact_length_max_m": 12, "contact_length_settled_m": 12, "depth_max_m": 8,
            "self_contact_length_max_m": 1}  # minimum number of runs
EXACT = (1e-6, 1e-9)         # relative; absolute, in the value's unit
SAMPLED = (0.02, 1e-4)       # contours of curved colliders, which are level lines between sample points
CELLS = 12                   # intervals between sample points along the side of a triangle
norm = functools.partial(np.linalg.norm, axis=-1)
dot = functools.partial(np.einsum, "...k,...k->...")

class Run:
    def __init__(self, path):
        f = h5py.File(path)
        self.name = f"{path.parent.name}/{path.stem}"
        self.scene, self.summary = json.loads(json.loads(f["header_json"][0])["scenario_json"]), dict(f["summary"].attrs)
        self.triangles, self.time = f["triangles"][:], f["metrics/time_s"][:]
        self.x = f["trajectory/position"][:].astype(float)
        count = int(f["colliders"].attrs["count"]) if "colliders" in f else 0
        self.colliders = [dict(f[f"colliders/{k}"].attrs) | {n: d[:] for n, d in f[f"colliders/{k}"].items()} for k in range(count)]
        self.grips = {n: d[:] for n, d in f["colliders/grips"].items()} if "colliders/grips" in f else {}
        (self.columns, self.rows), (self.width, self.height) = self.scene["cloth"]["grid"], self.scene["cloth"]["size_m"]
        self.late = self.time >= self.time[-1] - 0.5 - 0.5 / self.scene["time"]["frame_rate_hz"]


def segment_in_triangle(p, q, t):
    """Whether segments p-q cross triangles t (Möller & Trumbore 1997), and where."""
    e1, e2, way = t[..., 1, :] - t[..., 0, :], t[..., 2, :] - t[..., 0, :], q - p
    h = np.cross(way, e2)
    with np.errstate(divide="ignore", invalid="ignore"):
        f, s = 1 / dot(e1, h), p - t[..., 0, :]
        u, k = f * dot(s, h), np.cross(s, e1)
        v, at = f * dot(way, k), f * dot(e2, k)
        return (u >= 0) & (v >= 0) & (u + v <= 1) & (at >= 0) & (at <= 1), p + at[..., None] * way


def shared_length(a, b):
    """Length of the segments in which pairs of triangles in general position intersect; each segment has two ends."""
    ends = [segment_in_triangle(mine[:, i], mine[:, (i + 1) % 3], other) for mine, other in ((a, b), (b, a)) for i in range(3)]
    two = sum(hit.astype(int) for hit, _ in ends) == 2
    return sum(norm(p[two & hit & also] - q[two & hit & also]).sum() for (hit, p), (also, q) in itertools.combinations(ends, 2))


def vertices_of(c, frame):
    """Vertices of a mesh collider; a skinned mesh is posed by linear blend skinning."""
    x = c["position_m"].astype(float)
    if "joint_matrix" not in c:
        return x
    matrix = np.array(c["joint_matrix"][min(frame, len(c["joint_matrix"]) - 1)], float)[c["joint_index"]]
    each = np.einsum("vkij,vj->vki", matrix[..., :3], x) + matrix[..., 3]
    return np.einsum("vk,vki->vi", np.array(c["joint_weight"], float), each)


def depth_in(c, frame, p):
    """Depth of points in a collider with a closed form; negative outside."""
    if c["shape"] == "plane":
        return (c["point_m"] - p) @ c["normal"]
    if c["shape"] == "box":
        d = np.abs((p - np.array(c["center_m"])) @ np.array([c["axis_u"], c["axis_v"], c["axis_w"]]).T) - np.array(c["half_extent_m"])
        return -np.where((d <= 0).all(-1), d.max(-1), norm(np.maximum(d, 0)))
    out = -np.inf
    for v in [np.r_[c["center_m"], c["center_m"], c["radius_m"]]] if c["shape"] == "sphere" else c["capsules"][min(frame, len(c["capsules"]) - 1)]:
        a, ab = v[:3], v[3:6] - v[:3]
        share = np.clip(dot(p - a, ab) / max(dot(ab, ab), 1e-300), 0, 1)
        out = np.maximum(out, v[6] - norm(p - a - share[..., None] * ab))
    return out


INDEX = {ij: k for k, ij in enumerate((i, j) for i in range(CELLS + 1) for j in range(CELLS + 1 - i))}
WEIGHTS = np.array([(i, j, CELLS - i - j) for i, j in INDEX]) / CELLS
SMALL = np.array([[INDEX[k] for k in t] for i, j in INDEX for t in (
    [(i, j), (i + 1, j), (i, j + 1)], [(i + 1, j + 1), (i + 1, j), (i, j + 1)]) if all(k in INDEX for k in t)])


def level_line(c, frame, t):
    """Length of the line where the depth is 0, interpolated in parts of triangles, and the maximum depth at the corners of the parts."""
    p = np.einsum("wk,tkx->twx", WEIGHTS, t)
    depth = depth_in(c, frame, p)
    d, corner = depth[:, SMALL].reshape(-1, 3), p[:, SMALL].reshape(-1, 3, 3)
    cut = (d > 0).any(1) & (d <= 0).any(1)
    d, corner, ends = d[cut], corner[cut], []
    for i in range(3):
        j = (i + 1) % 3
        hit = (d[:, i] > 0) != (d[:, j] > 0)
        share = np.divide(d[:, i], d[:, i] - d[:, j], where=hit, out=np.zeros(len(d)))
        ends.append((hit, corner[:, i] + share[:, None] * (corner[:, j] - corner[:, i])))
    length = sum(norm((p - q)[hit & also]).sum() for (hit, p), (also, q) in itertools.combinations(ends, 2))
    return length, max(0.0, depth.max())


def contact(run):
    """Contour in each frame, its accuracy, and the maximum depth at vertices and at sample points; None instead of an undefined depth."""
    contours, depths, accuracy, closed = [], [], EXACT, all(c["shape"] != "mesh" for c in run.colliders)
    for f, x in enumerate(run.x):
        t, length = x[run.triangles], 0.0
        for c in run.colliders:
            if c["shape"] != "mesh":
                accuracy = accuracy if c["shape"] == "plane" else SAMPLED
                line, deepest = level_line(c, f, t)
                length += line
                depths.append((max(0.0, depth_in(c, f, x).max()), deepest))
                continue
            faces = vertices_of(c, f)[c["triangles"]]
            a, b = np.nonzero(np.all((t.min(1)[:, None] <= faces.max(1)) & (faces.min(1) <= t.max(1)[:, None]), -1))
            length += shared_length(t[a], faces[b])
        contours.append(length)
    return np.array(contours), accuracy, np.max(depths, 0) if closed else None


def driven(run):
    """Displacement of the fastest collider or attached vertex, summed up to each frame."""
    step = np.zeros(len(run.time))
    for c in run.colliders:
        if c["shape"] == "capsules":
            at = c["capsules"][:, :, :6].reshape(len(c["capsules"]), -1, 3)[:len(step)]
        elif "joint_matrix" in c:
            at = np.array([vertices_of(c, f)[::max(1, len(c["position_m"]) // 64)] for f in range(len(c["joint_matrix"]))])[:len(step)]
        else:
            continue
        step[1:len(at)] = np.maximum(step[1:len(at)], norm(np.diff(at, axis=0)).max(1))
    if run.grips:
        held, target = run.grips["held"][1:len(step)] != 0, run.grips["target_m"][:len(step)]
        step[1:] = np.maximum(step[1:], np.where(held, norm(np.diff(target, axis=0)), 0).max(1))
    return np.cumsum(step)


def popping(run):
    """Maximum excess of a displacement in 1/36 s over the largest of these: twice the path of the fastest collider or attached vertex; twice the
    vertex's own displacement before or after; twice (for corners, four times) the path of a vertex up to two edges away, before or after."""
    rate, count = run.scene["time"]["frame_rate_hz"], run.x.shape[1]
    window = max(2, np.ceil(rate / 36 - 1e-9)) / rate
    linked = np.zeros((count, count), int)
    linked[run.triangles[:, [0, 0, 1, 1, 2, 2]], run.triangles[:, [1, 2, 0, 2, 0, 1]]] = 1
    near = (linked + linked @ linked > 0) & ~np.eye(count, dtype=bool)
    gain = np.where(np.bincount(run.triangles.ravel(), minlength=count) > 2, 2, 4)
    velocity = np.broadcast_to(run.scene["cloth"].get("initial_velocity_m_per_s", [0, 0, 0]), (count, 3))
    time, x = np.r_[run.time[0] - 1, run.time], np.concatenate([run.x[:1] - velocity, run.x])
    gone = np.concatenate([np.zeros((1, count)), np.cumsum(norm(np.diff(x, axis=0)), axis=0)])
    drive, starts, most = np.r_[0, driven(run)], np.r_[run.time, (run.time[1:] + run.time[:-1]) / 2], 0.0
    for start in starts[starts + 2 * window <= run.time[-1] + 1e-9]:
        at = start + window * np.arange(-1, 3)
        k = np.minimum((frame := np.interp(at, time, np.arange(len(time)))).astype(int), len(time) - 2)
        share = (frame - k)[:, None, None]
        before, now, after = np.diff((1 - share) * x[k] + share * x[k + 1], axis=0)
        paths = np.diff((1 - share[..., 0]) * gone[k] + share[..., 0] * gone[k + 1], axis=0)
        beside = np.where(near, np.maximum(paths[0], paths[2])[None], 0).max(1)
        along = np.maximum(dot(now, before), dot(now, after)) / np.maximum(norm(now), 1e-300)
        explained = np.maximum(gain * beside, 2 * np.maximum(along, np.diff(np.interp(at, time, drive)).max()))
        most = max(most, (norm(now) - explained).max())
    return most


def ranges(run):
    """Minimum and maximum that each scalar may have."""
    def about(value, accuracy=EXACT):
        by = max(accuracy[1], accuracy[0] * abs(value))
        return value - by, value + by
    x = run.x.reshape(len(run.time), run.rows, run.columns, 3)
    along, across = norm(np.diff(x, axis=2)) * (run.columns - 1) / run.width, norm(np.diff(x, axis=1)) * (run.rows - 1) / run.height
    strain = np.maximum(along.max((1, 2)), across.max((1, 2))) - 1
    out = {"stretch_max": about(strain.max()), "stretch_max_end": about(strain[-1]), "pop_max_m": about(popping(run))}
    if run.colliders:
        contours, accuracy, depths = contact(run)
        if not any(c["shape"] == "capsules" and c["capsules"].shape[1] > 1 for c in run.colliders):
            out |= {"contact_length_max_m": about(contours.max(), accuracy), "contact_length_settled_m": about(contours[run.late].max(), accuracy)}
        if depths is not None:
            out["depth_max_m"] = (about(depths[0])[0], depths[1] + max(run.width / (run.columns - 1), run.height / (run.rows - 1)) / CELLS)
    if "self_contact_length_max_m" in run.summary:
        pairs = [(a, b) for a in range(len(run.triangles)) for b in range(a) if not set(run.triangles[a]) & set(run.triangles[b])]
        a, b = run.triangles[np.array(pairs).T]
        length = np.array([shared_length(x[a], x[b]) for x in run.x])
        out["self_contact_length_max_m"] = about(max(0.0, length.max() - length[0]))
    return out


def main(folder):
    faults, compared = [], dict.fromkeys(COMPARED, 0)
    for path in sorted(pathlib.Path(folder).rglob("*.h5")):
        run = Run(path)
        for name, (low, high) in ranges(run).items():
            value = run.summary.get(name, np.nan)
            compared[name] += not np.isnan(value)
            if value < low or value > high:
                faults.append(f"{run.name}: {name} stored {value!r}, computed {low!r} to {high!r}")
            bound, verdict = run.scene.get("expect", {}).get(name, {}).get("at_most"), run.summary.get(f"expect.{name}")
            if None not in (bound, verdict) and verdict != (value <= bound):
                faults.append(f"{run.name}: {name} {value!r} and at most {bound!r}, but the verdict is {verdict!r}")
    faults += [f"{name}: compared in {n} runs, expected {COMPARED[name]} or more" for name, n in compared.items() if n < COMPARED[name]]
    print("\n".join(faults) if faults else f"{sum(compared.values())} values agree: {compared}")
    return bool(faults)


sys.exit(main(sys.argv[1]))

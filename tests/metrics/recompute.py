"""Computes from the positions of stored runs, by other code, what their series and summaries say; brute force on small
grids. usage: recompute.py FOLDER [--list]

Fails where a value differs by more than 1e-6 of itself and 1e-9, where a series or scalar is neither computed here nor
left out below with its reason, and where fewer are computed than once were.
"""
import json
import pathlib
import sys

import h5py
import numpy as np

from recompute_contact import contact_series, vertices_of
from recompute_geometry import area, cross, norm, pairs_of_triangles
from recompute_passage import passage_series

RELATIVE, ABSOLUTE = 1e-6, 1e-9
SERIES, SCALARS = 11, 18  # computed at least

# Names that are not recomputed, and why. A name that ends in * stands for all that begin so.
LEFT_OUT = {
    "free_fall_error*": "depends on the solver's integrator", "crossings_max": "tests/liars checks it", "truth_*": "needs a reference solution, which its own tests check",
    "energy_rise*": "of velocities", "stability_*": "of velocities and the reference", "imposed_speed_m_per_s": "of the scene alone",
    "motion_check.*": "tests/liars checks it on wrong and right motions", "frames*": "counted, not measured", "time_s": "given", "frame": "given",
}


class Run:
    def __init__(self, path):
        f = h5py.File(path)
        header = f["header_json"][()]
        self.name = f"{path.parent.name}/{path.stem}"
        self.header = json.loads(header[0] if getattr(header, "shape", ()) else header)
        self.scene = json.loads(json.loads(f["header_json"][0])["scenario_json"])
        self.triangles = f["triangles"][:]
        self.time = f["metrics/time_s"][:]
        self.x = f["trajectory/position"][:].astype(float)
        self.series = {n: d[:] for n, d in f["metrics"].items() if n not in ("time_s", "frame")}
        self.summary = dict(f["summary"].attrs)
        self.colliders = [self.collider(f[f"colliders/{k}"]) for k in range(int(f["colliders"].attrs["count"]))] if "colliders" in f else []
        self.grips = {n: d[:] for n, d in f["colliders/grips"].items()} if "colliders/grips" in f else {}
        cloth = self.scene["cloth"]
        (self.columns, self.rows), (width, height), pose = cloth["grid"], cloth["size_m"], cloth["pose"]
        self.width, self.height = width, height
        self.u, self.v = np.array(pose["axis_u"], float), np.array(pose["axis_v"], float)
        i, j = np.arange(self.columns) / (self.columns - 1) - 0.5, np.arange(self.rows) / (self.rows - 1) - 0.5
        flat = i[None, :, None] * width * self.u + j[:, None, None] * height * self.v
        self.start = (np.array(pose["center_m"], float) + flat).reshape(-1, 3)
        self.triangle_area = area(self.start[self.triangles])
        self.vertex_area = np.zeros(len(self.start))
        for corner in self.triangles.T:
            np.add.at(self.vertex_area, corner, self.triangle_area / 3)

    def collider(self, group):
        held = {m["collider"]: m["margin_m"] for m in (self.header["plan"] or {}).get("contact_margins") or [] if m["margin_m"] is not None}
        out = dict(group.attrs) | {n: d[:] for n, d in group.items()}
        margin = held.get(out["name"], out["margin_m"])
        tolerance = max(0.1 * margin, 1e-3 * min(self.scene["cloth"]["size_m"]))
        return out | {"reach_m": margin + tolerance}


def sheet_series(run):
    """Strain, work against gravity, folds, grips, self-contact."""
    x = run.x.reshape(len(run.time), run.rows, run.columns, 3)
    du, dv = run.width / (run.columns - 1), run.height / (run.rows - 1)
    strain = np.concatenate([(norm(np.diff(x, axis=2)) / du - 1).reshape(len(x), -1), (norm(np.diff(x, axis=1)) / dv - 1).reshape(len(x), -1)], 1)
    out = {"stretch_max": strain.max(1), "stretch_rms": np.sqrt((strain**2).mean(1)), "stretch_mean": strain.mean(1),
           "stretch_mean_positive": np.maximum(strain, 0).mean(1)}
    share = np.outer(*[np.r_[0.5, np.ones(n - 2), 0.5] for n in (run.rows, run.columns)]).ravel()
    mass = share * run.scene["cloth"]["areal_density_kg_per_m2"] * du * dv
    moved = np.einsum("v,fvk->fk", mass, run.x - run.start)
    g = np.array(run.scene["gravity_m_per_s2"], float)
    out["gravity_energy_J"] = -moved @ g
    if run.colliders and g.any():
        out["lowest_height_m"] = (-run.x @ g / norm(g)).min(1)
    if "fold_roughness" in run.series:
        normal = cross(x[:, 1:, 1:] - x[:, :-1, :-1], x[:, 1:, :-1] - x[:, :-1, 1:])
        normal /= norm(normal)[..., None]
        along, across = np.diff(normal, axis=2), np.diff(normal, axis=1)
        squares = [(s**2).sum((1, 2, 3)) for s in (along, across)]
        out["fold_angle_rms_rad"] = np.sqrt(sum(squares) / sum(s.shape[1] * s.shape[2] for s in (along, across)))
        rough = smooth = count = 0
        for steps in (along, np.swapaxes(across, 1, 2)):
            n = steps.shape[2] - 4
            high = sum(w * steps[:, :, k:k + n] for k, w in enumerate((1, -4, 6, -4, 1))) / 16
            rough, smooth = rough + (high**2).sum((1, 2, 3)), smooth + (steps[:, :, 2:2 + n]**2).sum((1, 2, 3))
            count += n * steps.shape[1]
        with np.errstate(divide="ignore", invalid="ignore"):
            out["fold_roughness"] = np.where(np.sqrt(smooth / count) < 1e-4, 0, np.sqrt(rough / smooth))
    if run.grips:
        held, target = run.grips["held"], run.grips["target_m"]
        apart = norm(run.x[:, run.grips["held_vertex"]] - target[:len(run.x)])
        out["grip_error_m"] = np.where(held[:len(run.x)] != 0, apart, 0).max(1)
    if "self_contact_pairs" in run.series:
        pairs = [(a, b) for a in range(len(run.triangles)) for b in range(a) if not set(run.triangles[a]) & set(run.triangles[b])]
        a, b = np.array(pairs).T
        met = [pairs_of_triangles(p[run.triangles[a]], p[run.triangles[b]]) for p in run.x]
        out["self_contact_pairs"] = np.array([hit.sum() for hit, _ in met], float)
        out["self_contact_length_m"] = np.array([length.sum() for _, length in met])
    return out


def settled(run):
    return run.time >= run.time[-1] - 0.5 - 0.5 / run.scene["time"]["frame_rate_hz"]


def ends_of(c):
    """Points of a moving collider, frame after frame: the ends of capsules, or some 64 vertices of a mesh."""
    if c["shape"] == "capsules":
        return c["capsules"][:, :, :6].reshape(len(c["capsules"]), -1, 3)
    some = slice(None, None, max(1, len(c["position_m"]) // 64))
    return np.array([vertices_of(c, f)[some] for f in range(len(c["joint_matrix"]))])


def driven(run):
    """Way of the fastest collider or held vertex up to each frame."""
    way = np.zeros(len(run.time))
    points = [ends_of(c)[:len(run.time)] for c in run.colliders if c["shape"] == "capsules" or "joint_matrix" in c]
    for x in points:
        way[1:len(x)] = np.maximum(way[1:len(x)], norm(np.diff(x, axis=0)).max(1))
    if run.grips:
        held = run.grips["held"][1:len(run.time)] != 0
        way[1:] = np.maximum(way[1:], np.where(held, norm(np.diff(run.grips["target_m"][:len(run.time)], axis=0)), 0).max(1))
    return np.cumsum(way)


def popping(run):
    """Greatest displacement in 1/36 s beyond twice that of vertices up to two edges away, before or after, or of what drives the cloth."""
    window, count = max(1 / 36, 1 / run.scene["time"]["frame_rate_hz"]), len(run.start)
    linked = np.zeros((count, count), int)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        linked[run.triangles[:, a], run.triangles[:, b]] = linked[run.triangles[:, b], run.triangles[:, a]] = 1
    near = (linked + linked @ linked > 0) & ~np.eye(count, dtype=bool)
    velocity = np.broadcast_to(run.scene["cloth"].get("initial_velocity_m_per_s", [0, 0, 0]), (count, 3))
    time = np.r_[run.time[0] - 1, run.time]
    x = np.concatenate([run.x[:1] - velocity, run.x])
    way = np.r_[0, driven(run)]
    starts = np.r_[run.time, (run.time[1:] + run.time[:-1]) / 2]
    most = 0.0
    for start in starts[starts + 2 * window <= run.time[-1] + 1e-9]:
        at = start + window * np.arange(-1, 3)
        frame = np.interp(at, time, np.arange(len(time)))
        k = np.minimum(frame.astype(int), len(time) - 2)
        share = (frame - k)[:, None, None]
        before, now, after = np.diff((1 - share) * x[k] + share * x[k + 1], axis=0)
        beside = np.where(near, np.maximum(norm(before), norm(after))[None], 0).max(1)
        along = np.maximum((now * before).sum(1), (now * after).sum(1)) / np.maximum(norm(now), 1e-300)
        explained = np.maximum(np.maximum(beside, along), np.diff(np.interp(at, time, way)).max())
        most = max(most, (norm(now) - 2 * explained).max())
    return most


def longest(run, flags):
    best = now = 0.0
    for f in range(1, len(flags)):
        now = now + run.time[f] - run.time[f - 1] if flags[f] else 0.0
        best = max(best, now)
    return best


def grip_scalars(run, s):
    held, at = run.grips["held"], run.grips["target_m"]
    v = run.grips["held_vertex"]
    rest = norm(run.start[v][:, None] - run.start[v][None])
    apart = min(run.width, run.height) / 4
    let_go = next((f for f in range(len(run.time)) if not held[f].any()), len(run.time))
    ratios, moved_at, still = [], 0, []
    for f in range(let_go):
        if f and (norm(at[f] - at[f - 1])[held[f] != 0] > 0).any():
            moved_at = f
        both = (held[f][:, None] != 0) & (held[f][None] != 0) & (rest >= apart)
        pull = np.divide(norm(at[f][:, None] - at[f][None]), rest, where=both, out=np.zeros_like(rest))
        ratios.append((1 + s["stretch_max"][f]) / max(1.0, pull[both].max(initial=1.0)))
        still = [] if moved_at == f else still + [ratios[-1]] if moved_at and f >= moved_at + 3 else still
    after = [f for f in range(let_go, len(run.time)) if run.time[f] >= run.time[let_go] + 1 - 1e-9]
    return {"grip_error_max_m": s["grip_error_m"].max(), "grip_edge_ratio_max": max(ratios), "grip_edge_ratio_held": max(still) if still else np.nan,
            "strain_mean_released": s["stretch_mean_positive"][after[0]] if after else np.nan}


def scalars(run, s):
    """The summary's values from the series that were computed here."""
    late, last_second = settled(run), run.time >= run.time[-1] - 1 + 0.5 / run.scene["time"]["frame_rate_hz"]
    out = {"stretch_max": s["stretch_max"].max(), "stretch_max_end": s["stretch_max"][-1], "stretch_max_last_second": s["stretch_max"][last_second].max(),
           "stretch_mean_last_second": s["stretch_mean_positive"][last_second].mean()}
    series_of = {"max": np.max, "least": np.min, "end": lambda v: v[-1], "settled": lambda v: v[late].max(), "sum": np.sum,
                 "mean": lambda v: np.trapezoid(v, run.time) / np.ptp(run.time) if hasattr(np, "trapezoid") else np.trapz(v, run.time) / np.ptp(run.time)}
    for name, series, how in (
            ("tunnelled_fraction_max", "tunnelled_fraction", "max"), ("tunnelled_fraction_end", "tunnelled_fraction", "end"),
            ("tunnelled_depth_max_m", "tunnelled_depth_m", "max"), ("contact_length_max_m", "contact_length_m", "max"),
            ("contact_length_settled_m", "contact_length_m", "settled"), ("contact_length_mean_m", "contact_length_m", "mean"),
            ("depth_vertex_max_m", "depth_vertex_m", "max"), ("depth_max_m", "depth_m", "max"), ("depth_p99_m", "depth_p99_m", "max"),
            ("depth_mean_m", "depth_mean_m", "max"), ("penetrating_area_max_m2", "penetrating_area_m2", "max"),
            ("wrong_side_samples_max", "wrong_side_samples", "max"), ("wrong_side_fraction_max", "wrong_side_fraction", "max"),
            ("wrong_side_fraction_end", "wrong_side_fraction", "end"), ("laid_over_samples_max", "laid_over_samples", "max"),
            ("laid_over_samples_end", "laid_over_samples", "end"), ("hooked_end", "hooked_axes", "end"), ("slip_m", "slip_m", "sum"),
            ("lowest_height_min_m", "lowest_height_m", "least"), ("touching_fraction_end", "touching_fraction", "end"),
            ("fold_roughness_end", "fold_roughness", "end"), ("fold_angle_rms_end_rad", "fold_angle_rms_rad", "end")):
        if series in s:
            out[name] = series_of[how](s[series])
    for name in ("pairs", "length"):
        v = s.get("self_contact_" + name + ("" if name == "pairs" else "_m"))
        if v is not None:
            beyond = {"max": v.max(), "end": v[-1], "settled": v[late].max()}
            for how in ("max", "end") if name == "pairs" else ("max", "settled"):
                out[f"self_contact_{name}_{how}" + ("" if name == "pairs" else "_m")] = max(0.0, beyond[how] - v[0])
    if "hooked_axes" in s:
        out["hooked_longest_s"] = longest(run, s["hooked_axes"] > 0)
    if "contact_length_m" in s:
        bad = np.any([s[n] > 0 for n in ("contact_length_m", "tunnelled_fraction", "wrong_side_samples") if n in s], 0)
        out["contact_violated_longest_s"] = longest(run, bad)
        frames = np.flatnonzero(bad)
        out["untangle_s"] = np.nan if not len(frames) else np.inf if bad[-1] else run.time[frames[-1]] - run.time[max(frames[0] - 1, 0)]
    if "penetrating_area_m2" in s:
        out["depth_time_mean_m"] = series_of["mean"](s["depth_mean_m"] * s["penetrating_area_m2"] / (run.width * run.height))
    if "slip_m" in s and late.sum() >= 3:
        out["slip_settled_m"] = s["slip_m"][late][1:].sum()
    if run.colliders:
        rest = run.x[late]
        if len(rest) >= 3:
            out["rest_jitter_m"] = np.sqrt((((rest[2:] - 2 * rest[1:-1] + rest[:-2]) / 2)**2).sum(-1).mean())
            out["rest_drift_m_per_s"] = np.sqrt((norm(rest[-1] - rest[0])**2).mean()) / (run.time[-1] - run.time[late][0])
    out["pop_max_m"] = popping(run)
    return out | (grip_scalars(run, s) if run.grips else {})


def left_out(name):
    return next((why for n, why in LEFT_OUT.items() if name == n or (n.endswith("*") and name.startswith(n[:-1]))), None)


def differ(stored, mine):
    stored, mine = np.asarray(stored, float), np.asarray(mine, float)
    with np.errstate(invalid="ignore"):
        near = np.abs(stored - mine) <= np.maximum(ABSOLUTE, RELATIVE * np.abs(stored))
    same = (np.isnan(stored) & np.isnan(mine)) | (stored == mine) | near
    return np.flatnonzero(~np.atleast_1d(same))


def compare(run, computed, faults, seen, missing):
    for kind, stored, mine in (("series", run.series, computed), ("scalar", run.summary, scalars(run, computed))):
        for name, value in stored.items():
            # Spheres and capsules are triangles there and curves here: tests/contact holds the two against each other.
            if name.startswith("contact_length") and any(c["shape"] in ("sphere", "capsules") for c in run.colliders):
                continue
            if name in mine:
                seen.setdefault((kind, name), 0)
                seen[kind, name] += 1
                for k in differ(value, mine[name])[:1]:
                    faults.append(f"{run.name}: {kind} {name}[{k}]: stored {np.atleast_1d(value)[k]!r}, computed {np.atleast_1d(mine[name])[k]!r}")
            elif kind == "series" or not np.isnan(value):
                missing.setdefault((kind, name), run.name)


def main():
    faults, seen, missing = [], {}, {}
    paths = sorted(pathlib.Path(sys.argv[1]).glob("*/*.h5"), key=lambda p: int(p.parent.name))
    for path in paths:
        run = Run(path)
        computed = sheet_series(run)
        if run.colliders:
            computed |= contact_series(run)
            computed |= passage_series(run, computed)
        compare(run, computed, faults, seen, missing)
    for (kind, name), where in missing.items():
        # What is measured otherwise (times, bytes, counts) comes of no position.
        if left_out(name) is None and (kind, name) not in seen and not name.startswith(("expect.", "stage_")) and name not in NOT_OF_POSITIONS:
            faults.append(f"{where}: {kind} {name} is neither recomputed nor left out with a reason")
    if "--list" in sys.argv:
        print(*sorted(f"{kind} {name}: in {count} runs" for (kind, name), count in seen.items()), sep="\n")
    series, of_runs = (sum(k == kind for k, _ in seen) for kind in ("series", "scalar"))
    print(f"{len(paths)} runs: {series} series and {of_runs} scalars recomputed")
    if series < SERIES or of_runs < SCALARS:
        faults.append(f"expected at least {SERIES} series and {SCALARS} scalars")
    sys.exit("\n".join(faults) or 0)


# Summary values of clocks, plans and machines.
NOT_OF_POSITIONS = {"fps_median", "frame_wall_median_s", "jobs", "load_s", "trials", "untimed_s"}

if __name__ == "__main__":
    main()

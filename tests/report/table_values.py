"""Tables of a report and values behind its figures, computed from the result files by other code than the report's."""
import collections
import json
import math
import re

import h5py
import numpy as np

LEFT_OUT = {  # tables and columns that are not compared: why
    "Table 3: work per frame": "a fit, which rates_test.cpp compares with another program's", "Claims of the article, over what it leaves open": "needs a GPU; contact_test.cpp counts its points",
    "rank|(p50: )?× bullet-soft|rate: 95 % interval": "random resamples, as all intervals in brackets; tested in rates_test.cpp", "conditions|meaning|error": "sentences and definitions", "clock|feature|criterion": "select what is compared"}
SUMMARY = {  # column: scale, and the stored values
    "crossings": (1, "crossings_max"), "contour, max / settled [mm]": (1e3, "contact_length_max_m", "contact_length_settled_m"), "depth [mm]": (1e3, "depth_max_m"), "popping [mm]": (1e3, "pop_max_m"),
    "strain, max / end [%]": (100, "stretch_max", "stretch_max_end"), "stretch [%]": (100, "stretch_max_last_second"), "stretch, mean / maximum [%]": (100, "stretch_mean_last_second", "stretch_max_last_second"),
    "free-fall error [g T²/2]": (1, "free_fall_error"), "pipelined [ms]": (1e3, "frame_pipelined_median_s"), "load [ms]": (1e3, "load_s"), "trials": (1, "trials"), "dispatches": (1, "dispatches"),
    "MB per frame, read / written": (1e-6, "read_B_per_frame", "write_B_per_frame"), "peak bandwidth, read / written [GB/s]": (1e-9, "bandwidth_read_peak_B_per_s", "bandwidth_write_peak_B_per_s"),
    "window [s]": (1, "bandwidth_window_s"), "memory [MB]": (1e-6, "device_memory_B"), "space": (1, "truth_space_error"), "U_ref": (1, "reference_uncertainty"), "spread": (1, "reference_spread"), "order xpbd": (1, "reference_order_xpbd"), "reference − exact": (1, "reference_truth_distance"),
    "order BDF2": (1, "reference_order_bdf2")}
QUANTILES = {  # column: clock (empty: the row's), and quantiles by nearest rank
    "frame p50 [ms]": ("", 0.5), "p95 / p99 / worst [ms]": ("", 0.95, 0.99, 1), "GPU: p50 / p95 / p99 / worst [ms]": ("GPU", 0.5, 0.95, 0.99, 1), "GPU, with contact [ms]": ("GPU, with contact", 0.5, 0.95, 0.99, 1),
    "with contact: p50 / p95 / p99 / worst [ms]": ("wall, with contact", 0.5, 0.95, 0.99, 1)}
RATES, BUDGETS_MS = "rate: 95 % interval", {"error within 0.1 ms": 0.1, "error within 1 ms": 1, "error within 13.9 ms": 13.9, "best error": math.inf}
STATED = ["gpu", "gpu is software", "device profile", "driver", "cpu", "cpu threads", "shader compiler", "clock policy", "protocol", "git commit", "git dirty", "source sha256", "build type", "assets"]
GRADES, NAN, finite, words = ("stable", "degraded", "failed"), math.nan, math.isfinite, lambda name: name.replace("_", " ")
text_of = lambda c: c if isinstance(c, str) else c[0]  # noqa: E731
quantile = lambda t, q: float(t[max(math.ceil(q * len(t)), 1) - 1]) if len(t) else NAN  # noqa: E731


class Run:
    """A result file, and what the page says about it. A planned run has no file."""

    def __init__(self, path, row):
        self.path, self.row, self.a, self.header, self.outcome, clocks, touched = path, row, {}, {}, {"status": "missing", "class": "", "failed_frame": -1, "expect": "", "message": "planned, not run"}, {}, []
        if path:
            with h5py.File(path) as f:
                self.a, self.outcome, self.header = dict(f["summary"].attrs), dict(f["outcome"].attrs), json.loads(f["header_json"][0])
                clocks = {name: f[f"timing/frame_{c}_s"][:] for name, c in (("wall", "wall"), ("GPU", "device"), ("CPU", "cpu")) if f"timing/frame_{c}_s" in f}
                touched = [f["metrics"][n][1:] > 0 for n in ("touching_fraction", "contact_length_m", "depth_m", "self_contact_length_m") if n in f.get("metrics", [])]
        frames = np.flatnonzero(np.any(touched, axis=0)) if touched else []
        clocks.update({f"{name}, with contact": t[:, frames[frames < t.shape[1]]] for name, t in clocks.items() if touched and name != "CPU"})
        self.time = {name: np.sort(t[np.isfinite(t)]) for name, t in clocks.items() if np.isfinite(t).any()}
        self.scenario, self.environment, self.status = json.loads(self.header.get("scenario_json") or "{}"), self.header.get("environment", {}), self.outcome["status"]
        self.rate_hz, self.error = self.scenario.get("time", {}).get("frame_rate_hz", NAN), self.value("truth_error")
        self.counts, (pipelined, wall, self.device_ms) = self.status == "ok" and finite(self.error), (1e3 * self.rate_hz * self.value(f"frame_{c}_median_s") for c in ("pipelined", "wall", "device"))
        self.wall_ms, self.grade = pipelined if finite(pipelined) else wall, int(grade) if finite(grade := self.value("stability_grade")) else 2
        self.bounds = {k[7:]: v for k, v in self.a.items() if k.startswith("expect.")}
        self.violated, self.ending = sorted(k for k, v in self.bounds.items() if v == 0), self.status + (f" at {self.outcome['failed_frame']}" if self.outcome["failed_frame"] >= 0 else "")

    def value(self, name):
        return float(self.a.get(name, NAN))

    def verdict(self):
        if self.status != "ok" or self.violated or self.outcome["expect"].startswith("fail") or not self.bounds:
            return self.ending if self.status != "ok" else "fail" if self.outcome["expect"].startswith("fail") or self.violated else "–"
        ignored = "sphere" in self.environment["solver_features"]["ignores"] and (self.scenario["colliders"] or self.scenario["grips"])
        return "not measured" if not all(map(finite, self.bounds.values())) else "ignored" if ignored else "pass"


def share(g):
    """Passed runs with Wilson's interval."""
    n, k, zz = len(g), sum(r.verdict() == "pass" for r in g), 1.959963984540054**2
    middle, half, d = k / n + zz / (2 * n), math.sqrt(zz * (k / n * (1 - k / n) / n + zz / (4 * n * n))), (1 + zz / n) / 100
    return f"{k}/{n} ({(middle - half) / d if k else 0:.0f}–{(middle + half) / d if k < n else 100:.0f} %)", k / n


def offset(x):
    """Contact offsets: those that a solver states, otherwise the scene's."""
    of = lambda r: stated if len(stated := r.header.get("plan", {}).get("contact_margins", [])) == len(r.scenario.get("colliders", [])) else r.scenario["colliders"]  # noqa: E731
    mm = [1e3 * c["margin_m"] for r in x.runs if r.status not in ("unsupported", "missing") for c in of(r) if "margin_m" in c]
    return (" to ".join(dict.fromkeys(f"{v:.3g}" for v in (min(mm), max(mm)))), min(mm)) if mm else "–"


def stable(g, _):
    unsupported = [r for r in g if r.status == "unsupported"]
    others = sorted(collections.Counter((r.grade, r.outcome["class"]) for r in g if r.grade > 0 and r not in unsupported).items())
    good, more = sum(r.grade == 0 for r in g), [f"{n} {GRADES[grade]} ({name})" for (grade, name), n in others] + [f"{len(unsupported)} unsupported"] * bool(unsupported)
    return ", ".join([f"{good}/{len(g)} stable", *more]), good / len(g)


def feature(g, name):
    told = next((t for r in g if (t := r.environment.get("solver_features"))), None)
    only = "".join(f" (only with {words(b)})" for a, b in told["only_with"] if words(a) == name) if told else ""
    return "not built" if not told else "ignored" if name in map(words, told["ignores"]) else f"yes{only}" if name in map(words, told["supports"]) else "no"


def expected(r, name):
    """The limits of a criterion, and its number per SI unit."""
    unit, scale = (" %", 100) if name.startswith("stretch_") else (" m", 1) if name.startswith("lowest") else (" mm", 1e3) if name.endswith("_m") else ("", 1)
    exact, bound = r.value(f"{name}_bound"), r.scenario.get("expect", {}).get(name, {})
    limits = [f"{words(k)} {bound[k] * scale:.6g}{unit}" for k in ("at_least", "at_most") if k in bound and isinstance(bound, dict)]
    return f"at most {exact * scale:.3g}{unit}" if finite(exact) else bound if isinstance(bound, str) else ", ".join(limits) or "–", scale


class Line:
    """A row of a table: its runs, its texts by head, and the run that its times are about."""

    def __init__(self, runs, keys, scene):
        self.runs, self.keys, self.first, self.run = runs, keys, runs[0], runs[0]
        space, uncertainty = (next((r.value(n) for r in scene if finite(r.value(n))), NAN) for n in ("truth_space_error", "reference_uncertainty"))
        self.floor, least = np.nanmax([0, 3 * uncertainty, space]), np.nanmax([min((r.error for r in scene if r.counts), default=NAN), space, 0])
        self.refused = "no reference solution" if not finite(uncertainty) else "" if 3 * uncertainty < least else f"3 U_ref {3 * uncertainty:.1e} is not below the best error {least:.1e}"
        if "best error" in keys or RATES in keys:
            self.run = next((r for r in runs if r.row["largest"] and r.status == "ok"), Run(None, runs[0].row)) if RATES in keys else self.best(wall_ms, 1e-2) or self.best(error)
        self.times = lambda clock="": self.run.time.get(clock or keys.get("clock", "wall"), np.array([]))

    def best(self, by, most=math.inf, frame_ms=math.inf):
        return min((r for r in self.runs if r.counts and r.error <= most and finite(by(r)) and (frame_ms == math.inf or r.wall_ms / r.rate_hz <= frame_ms)), key=by, default=None)

    def setting(self, by, *limits):
        """The best setting, and its error or time."""
        v = by(r) if (r := self.best(by, *limits)) else NAN
        return (f"{'≤ ' * (v <= self.floor)}{max(self.floor, v):.2g} ({r.row['setting']})" if by is error else f"{v:.3g} ({r.row['setting']})", v) if r else "–"

    def stored(self, head, scale, *names):
        runs = [] if head in ("pipelined [ms]", "load [ms]") and self.keys["clock"] != "wall" else [self.run] if RATES in self.keys else self.runs
        values = [next((scale * r.value(n) for r in runs if finite(r.value(n))), NAN) for n in names]
        return values, round(values[0], 3) if "mean" in head and finite(values[0]) else values[0]

    def quantiles(self, clock, *qs):
        t = self.times(clock)
        return ([NAN if 0.5 < q < 1 and len(t) * (1 - q) < 1 - 1e-9 else 1e3 * quantile(t, q) for q in qs], quantile(t, qs[0])) if len(t) else "–"


found = lambda r, name: r.ending if name == "outcome" else "fail" if re.match("motion|fail", name) else ([r.value(name) * expected(r, name)[1]], r.value(name))  # noqa: E731
error, wall_ms, device_ms, number = (lambda r: r.error), (lambda r: r.wall_ms), (lambda r: r.device_ms), lambda v, *more: ([v, *more], v)
late = lambda x, hz: 100 * float(np.mean(x.times() > 1 / hz)) if len(x.times()) else NAN  # noqa: E731
CELLS = {  # column: the wanted cell of a line, numbers or a text, with the value by which the page sorts
    **{head: lambda x, head=head, of=of: x.stored(head, *of) for head, of in SUMMARY.items()}, **{head: lambda x, of=of: x.quantiles(*of) for head, of in QUANTILES.items()},
    **{head: lambda x, ms=ms: x.setting(error, math.inf, ms) for head, ms in BUDGETS_MS.items()}, "to 1 %": lambda x: x.setting(wall_ms, 1e-2), "to 0.1 %": lambda x: x.setting(wall_ms, 1e-3),
    "to 1 %, GPU": lambda x: x.setting(device_ms, 1e-2), "to 0.1 %, GPU": lambda x: x.setting(device_ms, 1e-3), "missed 72 / 90 Hz [%]": lambda x: number(late(x, 72), late(x, 90)), "frames": lambda x: number(len(x.times())),
    "real-time factor": lambda x: number(1 / (x.run.rate_hz * quantile(x.times(), 0.5))), "CPU threads": lambda x: number(max(1, round(quantile(x.times("CPU"), 0.5) / quantile(x.times(), 0.5)))),
    "trials": lambda x: number(x.first.value("trials") if x.run.time else NAN), "verdict": lambda x: x.first.verdict(), "outcome": lambda x: x.first.verdict(), "all": lambda x: share(x.runs), "contact offset [mm]": lambda x: offset(x),
    "expected": lambda x: expected(x.first, x.keys["criterion"])[0], "found": lambda x: found(x.first, x.keys["criterion"]), "failed": lambda x: (f"{sum(not r.counts for r in x.runs)} of {len(x.runs)}", np.mean([not r.counts for r in x.runs])),
    "ranked": lambda x: "no" if x.refused else "no: ~" if " ~" in x.keys["frame p50 [ms]"] else "yes", "ranks": lambda x: f"REFUSED: {x.refused}" if x.refused else "yes",
    **{name: lambda x, name=name: stated(x.first.environment.get(name.replace(" ", "_"))) for name in STATED}, "runs": lambda x: ", ".join(f"{s} ({n})" for s, n in sorted(collections.Counter(r.row["solver"] for r in x.runs).items())),
    "scenes": lambda x: f"{len(x.runs)} runs: " * (len(x.runs) > 1) + ", ".join(r.row["scene"] + f" (frame {r.outcome['failed_frame']})" * (r.outcome["failed_frame"] >= 0) for r in x.runs),
    "scenes (violated criteria)": lambda x: "; ".join(f"{r.row['scene']} ({', '.join(re.sub('_m$', '', v).replace('_', ' ') for v in r.violated)})" for r in x.runs),
    "precision": lambda x: x.run.environment.get("precision", "–"), "device": lambda x: x.run.environment.get("gpu", "–").split(" (")[0]}
KEYS = {"scene": lambda r, x: r.row["scene"] + " (refused)" * bool(x.refused and "best error" in x.keys), "sides": lambda r, x: r.scenario["cloth"].get("sides", ""), "message": lambda r, x: r.outcome["message"], "status": lambda r, x: status(r),
        "solver": lambda r, x: r.row["solver"] if "best error" in x.keys else r.row["label"] + (f", {r.row['sides']}" if RATES in x.keys and r.row["sides"] != "single" else ""), "kind": lambda r, x: r.scenario["drawn"]["kind"] + " (procedural)" * (r.scenario["drawn"]["assets"] == "procedural"),
        "case": lambda r, x: f"{r.scenario['stability']['case']} {r.scenario['name'][4:]}"}
status = lambda r: "ended, but " * (r.status == "ok") + (GRADES[r.grade] if r.status == "ok" else r.status) + f" ({r.outcome['class']})" * (r.outcome["class"] not in ("", "ok"))  # noqa: E731
stated = lambda v: "–" if v in (None, "") else ("no", "yes")[v] if isinstance(v, bool) else str(v)  # noqa: E731
fps = lambda g, name: g[0].ending if g[0].status != "ok" else number(g[0].value("fps_median"))  # noqa: E731
ACROSS = [  # start of a title: the column of a run, and the wanted cell
    ("Verdict", lambda r: r.row["label"], lambda g, name: share(g) if len(g) > 1 else g[0].verdict()), ("Robustness", lambda r: r.row["label"], stable), ("Table 4", lambda r: r.row["solver"], feature),
    ("Table 3|Frame", lambda r: r.row["resolution"], fps), ("Random", lambda r: next(b for low, b in ((10, "≥ 10 m/s"), (5, "5–10 m/s"), (2, "2–5 m/s"), (0, "0–2 m/s")) if r.scenario["drawn"]["speed_m_per_s"] >= low), lambda g, name: share(g))]


def is_shown(text, value, wanted):
    """Whether a cell has the wanted text, or numbers rounded to its last digits, and the wanted value."""
    wanted, sorts_by = wanted if isinstance(wanted, tuple) else (wanted, value)
    if isinstance(wanted, str):
        return text == wanted and (value == sorts_by or abs(value - sorts_by) <= 1e-5 * abs(sorts_by))
    parts = [re.sub(r" [(~!m%].*", "", part) for part in text.split(" / ")]
    near = len(parts) == len(wanted) or text == "–"
    for part, w in zip(parts, wanted):
        digits, decimals, exponent, scale = re.fullmatch(r"<?(-?\d*\.?(\d*))(e[+-]\d+)?([kM]?)", part).groups() if part[:1] in "<-0123456789" else ("nan", "", "", "")
        power = int((exponent or "e0")[1:]) + {"k": 3, "M": 6}.get(scale, 0)
        near = near and (not finite(w) if part in "–never" else abs(float(digits or "nan") * 10.0**power - w) <= 10.0 ** (power - len(decimals or "")) * (1 if part[0] == "<" else 0.500001) + 1e-9 * abs(w))
    return near and (not finite(sorts_by) if value is None else abs(value - sorts_by) <= 1e-5 * abs(sorts_by) + 1e-300)


def compare_tables(doc, runs):
    """Number of compared cells by title. Fails for an unknown table or column. `runs`: of the rows of the document."""
    compared, faults = collections.Counter(), []
    for t in (t for s in doc["sections"] for t in s["tables"] if not any(re.fullmatch(name, t["title"]) for name in LEFT_OUT)):
        across = next(((of, cell) for start, of, cell in ACROSS if re.match(start, t["title"])), None)
        pool = [runs[n] for again in t["again"] for n in again]
        for cells, again in ((c, again) for c, again in zip(t["rows"][1:], t["again"]) if not runs[again[0]].row.get("published")):
            keys = dict(zip(t["rows"][0], map(text_of, cells)))
            mine = [runs[n] for n in again]
            line = Line(mine, keys, [r for r in runs if r.row["part"] == "accuracy" and r.row["scene"] == mine[0].row["scene"]])
            for n, (head, c) in enumerate(zip(keys, cells)):
                (text, value), group = c[:2] if isinstance(c, list) else (c, None), across and [r for r in mine if across[0](r) == head]
                if any(re.fullmatch(name, head) for name in LEFT_OUT) or n < t["keys"] and text.startswith("all"):
                    continue
                assert n < t["keys"] or head in CELLS or across and (any(across[0](r) == head for r in pool) or re.fullmatch("\\d+²", head)), f"{t['title']}: the column {head} is neither compared nor listed"
                wanted = KEYS[head](mine[0], line) if n < t["keys"] and head in KEYS else across[1](group, keys.get("feature")) if group else ("not run" if t["title"][0] == "V" else "–") if head not in CELLS else CELLS[head](line)
                compared[t["title"]] += 1
                if not is_shown(text.strip(), value, wanted) or isinstance(c, list) and c[2] != {"pass": "good", "fail": "bad"}.get(text, c[2]):
                    faults.append(f"{t['title']}: {list(keys.values())[:t['keys']]}, {head}: {c}, expected {wanted}")
    plain = [r for r in runs if not r.row.get("published") and not (r.row["part"] == "accuracy" and "=" in r.row["setting"])]
    part = lambda name: [r for r in runs if r.row["part"] == name]  # noqa: E731
    rows = {  # by title; None: not counted
        "Contact": part("contact"), "Time per frame [ms]": [t for r in plain for t in r.time], "Bytes and device memory per frame": [r for r in plain if finite(r.value("device_memory_B")) and r.row["part"] in ("rates", "contact")],
        "Acceptance criteria that are violated": [v for r in plain for v in r.violated or [""] * r.outcome["expect"].startswith("fail") if r.row["part"] != "stability"], "Table 4: features": None, "Leading scenes with contact": None,
        "Verdict on the acceptance criteria of each scene": {"all"} | {r.row["scene"] for r in part("contact")}, "Robustness": {"all"} | {r.row["case"] for r in part("stability")}, "Table 3: speed and error": None, "Runs that failed": None, "Failed scenes of each solver": {r.row["label"] for r in part("contact") if r.verdict() == "fail"},
        "Error against run time": {(r.row["scene"], r.row["solver"]) for r in part("accuracy")}, "Reference cases and their reference solutions": {r.row["scene"] for r in part("accuracy")}, "Frame rates: conformance-sheet": None,
        "Random scenes of contact: pass rate": None, "Machines of the runs": {tuple(stated(r.environment.get(n.replace(" ", "_"))) for n in STATED) for r in runs if r.environment}}
    tables = {t["title"]: t["rows"] for s in doc["sections"] for t in s["tables"]}
    faults += [f"{title}: a table that is neither compared nor listed, or lacks" for title in rows.keys() ^ compared.keys()]
    faults += [f"{title}: {len(tables[title]) - 1} rows, expected {len(wanted)}" for title, wanted in rows.items() if wanted is not None and len(tables.get(title, [])) != len(wanted) + 1]
    faults += [f"no table has the column {head}" for head in CELLS if head not in ("CPU threads", *BUDGETS_MS, *STATED) and not any(head in t[0] for t in tables.values())]
    assert not faults, "\n".join(faults)
    return compared


def compare_rows(runs):
    """Number of compared values behind the figures. Fails for an unknown one."""
    # Not compared: names of the run, indices, what this test adds; intervals, which are random resamples; sentences; criteria, which are compared in their table.
    left_out, count = {*"part study job name plugin file family label scene solver setting published largest fps_low fps_high trust frames ranking refused not_ranked violated".split()}, 0
    fact = lambda r, name: next((q.value(name) for q in runs if q.row["scene"] == r.row["scene"] and finite(q.value(name))), NAN)  # noqa: E731
    for r in runs:
        s, e, grid = r.scenario, r.environment, r.scenario["cloth"].get("grid", [0, 0])
        device = e["cpu" if e["gpu"] == "CPU" else "gpu"].split(" (")[0]
        told = {"status": r.status, "verdict": r.verdict(), "sides": s["cloth"].get("sides"), "cpu": r.environment.get("gpu") == "CPU", "message": r.outcome["message"] or r.row.get("message"), "made": f"at {e['git_commit'][:12]}{' (with local changes)' * e['git_dirty']}" + f", on {device}" * (device != ""), "trials": r.value("trials"), "width": math.sqrt(grid[0] * grid[1]),
                "is_grid": grid[0] > 0, "resolution": f"{grid[0]}²" if grid[0] == grid[1] else f"{grid[0]}×{grid[1]}", "paper_table": s.get("paper", {}).get("table", 0), "grade": r.grade if "stability" in s else None, "wall_ms_per_s": r.wall_ms, "device_ms_per_s": r.device_ms,
                "error": r.error, "space_error": fact(r, "truth_space_error"), "reference_uncertainty": fact(r, "reference_uncertainty"), "case": "stability" in s and KEYS["case"](r, None), "speed": s.get("drawn", {}).get("speed_m_per_s"),
                "kind": s.get("drawn", {}).get("kind")}
        for name, v in ((n, v) for n, v in r.row.items() if n not in left_out):
            t = r.time.get({"wall": "wall", "gpu_time": "GPU", "contact_wall": "wall, with contact", "contact_gpu_time": "GPU, with contact"}.get(name))
            shown, wanted = ([v[0], *v[3:]], [quantile(t, q) for q in (0.5, 0.95, 0.99, 1)]) if t is not None else ([v], [told[name] if name in told else r.value(name)])
            assert t is not None or name in told or name in r.a, f"{name} is neither compared nor listed"
            assert t is None or v[1] is None or t[0] <= v[1] * 1.00001 <= v[0] * 1.00002 <= v[2] * 1.0001 <= t[-1] * 1.0002, v
            assert all(a == b or not isinstance(b, str) and (not finite(b) if a is None else abs(a - b) <= 1e-5 * abs(b)) for a, b in zip(shown, wanted)), (r.row["scene"], r.row["label"], name, v, wanted)
            count += len(shown)
    return count

#!/usr/bin/env python3
"""Takes out of a committed reference report what must no longer be printed, where there are no result files to make it again
from: times that were not taken alone, values by an older version of a metric's rule, verdicts by older bounds of a scene.

usage: renew_reference.py [--check] results/reference/<folder>...

<folder>/renewed.json says what is known of the run:
  "timed_alone": {"<column of cells.csv>": [values]}  rows whose times stand; without it all do
  "times": why the others' do not
  "metric_versions": {"<metric>": [version it was measured by, version now]}
Tables, CSV files and notes are changed as `clothbench report` would write them (harness/report/withheld.cpp). Verdicts are
computed from the stored scalars and the scenes' `expect` of today. Running it again changes nothing; --check only looks.
"""
import csv
import io
import itertools
import json
import math
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
DASH = "–"
BEHIND = {  # summary values computed from a metric, as the registry in harness/metrics has them (clothbench list scalars)
    "wrong_side_samples": ["wrong_side_samples_max", "contact_violated_longest_s", "untangle_s"],
    "wrong_side_fraction": ["wrong_side_fraction_max", "wrong_side_fraction_end"],
}
WORDS = {"tunnelled_fraction_max": "tunnelled", "wrong_side_samples_max": "wrong side", "depth_vertex_max_m": "inside [m]", "grip_edge_ratio_max": "edge pulled",
         "strain_mean_released": "strain left", "truth_quantity_error_max": "strain off [v0/c]", "pop_speed_ratio": "popping [of limit]",
         "contact_length_settled_m": "contour left [m]"}  # harness/report/leak.cpp
BYTES = ("loads and stores of the shaders, computed from the scene and the kernels' loops and checked against instrumented kernels in tests; ≥: a lower "
         "bound, where what is read depends on how the cloth lies (contact of xpbd); retries of atomics are left out.")
CAPTIONS = {
    "Counted loads and stores of the shaders; missing for CPU solvers, never modelled.": f"Bytes: {BYTES} – for CPU solvers, of which nothing is known.",
    "Bytes: counted loads and stores of the shaders, a frame. Memory: device-local buffers. – on a CPU.": f"Bytes a frame: {BYTES} Memory: device-local buffers. – on a CPU.",
    "The same counted bytes over wall time;": "The same bytes over wall time;",
    "Fig. 5: counted bytes per second of wall time,": "Fig. 5: bytes that shaders load and store (computed from the scene and the kernels) per second of wall time,",
    "CPU solvers are absent: their bytes are not counted, and never\nmodelled.": "CPU\nsolvers are absent: nothing is known of their bytes.",
}
LEAKS = ("The lowest speed at which a solver breaks what the scene expects, and the first bound that it breaks: cloth through a mesh, on the wrong side of a hand or "
         "over 1 mm inside it, edges longer than so many times what the hands impose, a mean strain of over 1 % a second after they let go, cloth that pops faster "
         "than its limit, a greatest strain of a strip pulled by bars that is off its exact wave by over a tenth of v0/c. The verdicts above are by the same bounds. none: up to the greatest speed that was run.")


def scenes():
    """name -> (expect, kind, name in the file) of every scene of the penetration study, as load_study names them."""
    out = {}
    study = ROOT / "scenarios/studies/penetration.json"
    for item in json.loads(study.read_text())["scenes"]:
        scene = json.loads((study.parent / item["file"]).read_text())
        for k in itertools.product(*(range(len(a["values"])) for a in item.get("axes", []))):
            name, expect, types = scene["name"], scene.get("expect", {}), {c["type"] for c in scene.get("colliders", [])}
            for axis, i in zip(item.get("axes", []), k):
                name += "-" + axis["labels"][i]
                expect = axis.get("with", {}).get("expect", {i: expect})[i]
                if axis["key"] == "colliders.0.type":
                    types = {axis["values"][i]}
            kind = ("wave" if scene.get("truth") else "grip" if scene.get("grips") else "hand" if "hand_mesh" in types else "capsules" if "hand_capsules" in types
                    else "rooms" if types & {"room", "mesh"} else "shapes")
            out[name] = (expect, kind, scene["name"])
    return out


def was_timed(r, column):
    """Whether the cell had a time in this column: of its load, and of its trials, if any, by the clocks that it has."""
    if column in ("load_s", "untimed_s"):
        return True
    if number(r["trials"]) > 0:
        return re.fullmatch(r"fps_.*|frame_wall_.*|bandwidth_window_s", column) or r["gpu"] != "CPU" and re.fullmatch(r"(frame_device|bandwidth|stage_device)_.*", column)
    return False


def number(text):
    return float(text) if text not in ("", None) else math.nan


class Cells:
    """Rows of cells.csv, with what must not be printed taken out and verdicts of today."""

    def __init__(self, folder, known):
        self.rows = list(csv.DictReader(io.StringIO((folder / "cells.csv").read_text(encoding="utf-8"))))
        self.known, self.scenes, self.why = known, scenes(), {}
        for r in self.rows:
            self.renew(r)

    def key(self, r):
        return r["scene"], label(r), r["sides"]

    def renew(self, r):
        why = {}
        told = r.get("withheld", "")
        alone = self.known.get("timed_alone")
        if alone is not None and any(r[c] not in values for c, values in alone.items()):
            why.update({c: self.known["times"] for c in r if r["status"] == "ok" and was_timed(r, c)})
        for metric, (was, now) in self.known.get("metric_versions", {}).items():
            reason = f"{metric} was measured by version {was} of its rule, now {now}"
            if r[BEHIND[metric][0]] or reason in told:
                for c in BEHIND[metric]:
                    why.update({c: reason, "expect." + c: reason})
        for c in why:
            if c in r:
                r[c] = ""
        self.judge(r, why)
        self.why[self.key(r)] = why
        r["withheld"] = "; ".join(sorted(set(why.values())))

    def judge(self, r, why):
        """As harness/runner/expect.cpp does."""
        expect, _, _ = self.scenes.get(r["scene"], ({}, "", ""))
        if r["status"] != "ok" or not expect:
            return
        for c in list(r):
            if c.startswith("expect."):
                r[c] = ""
        wrong, unknown = [], False
        for name in ["outcome"] + sorted(set(expect) - {"outcome"}):
            if name == "outcome":
                r["expect.outcome"] = "1"
                continue
            if name in why:
                unknown = True
                continue
            v, most, least = number(r.get(name)), expect[name].get("at_most", math.inf), expect[name].get("at_least", -math.inf)
            r["expect." + name] = "1" if least <= v <= most else "0"
            if math.isnan(v):
                wrong.append(f"{name} has no value")
            elif not v <= most:
                wrong.append(f"{name} {v:.4g} > {most:.4g}")
            elif not v >= least:
                wrong.append(f"{name} {v:.4g} < {least:.4g}")
        r["expect"] = "broken: " + "; ".join(wrong) if wrong else "not measured" if unknown else "kept"

    def bounds(self, r):
        return [n for n in ["outcome"] + sorted(set(self.scenes.get(r["scene"], ({},))[0]) - {"outcome"})]

    def verdict(self, r):
        """As `verdict` in harness/report/penetration.cpp."""
        if r["status"] != "ok":
            return r["status"] + (f" at {r['failed_frame']}" if r["failed_frame"] else "")
        if r["expect"].startswith("broken"):
            return "broken"
        if not r["expect"] or any("expect." + b in self.why[self.key(r)] for b in self.bounds(r)):
            return DASH
        return "ignored" if r["expect"] == "kept" and r["solver"] == "ballistic" else r["expect"]

    def leak(self, r):
        """As `leak_of` in harness/report/leak.cpp."""
        if r["status"] != "ok":
            return r["status"]
        names = sorted(self.bounds(r), key=lambda n: list(WORDS).index(n) if n in WORDS else len(WORDS))
        for n in names:
            if r.get("expect." + n) == "0":
                v = number(r.get(n))
                return WORDS.get(n, n) + (" not known" if math.isnan(v) else f" {v:.3g}")
        return DASH if any("expect." + n in self.why[self.key(r)] for n in names) else ""

    def find(self, scene, solver, sides=None):
        return next((r for r in self.rows if r["scene"] == scene and label(r) == solver and sides in (None, DASH, r["sides"])), None)


def label(r):
    text = r["solver"] if r["setting"] in ("default", "") else f"{r['solver']} {r['setting']}"
    return text if r["repeat"] == "1" else f"{text} ({r['repeat']})"


def split_row(line):
    return [c.strip() for c in line.strip().strip("|").split("|")]


class Table:
    """A section of report.md with one table: title, rows with the header first, what follows."""

    def __init__(self, text):
        lines = text.split("\n")
        self.title = lines[0]
        at = [i for i, line in enumerate(lines) if line.startswith("|")]
        self.is_table = bool(at)
        if at:
            self.rows = [split_row(lines[i]) for i in at if not lines[i].startswith("|--")]
            self.tail = "\n".join(lines[at[-1] + 1:])
        else:
            self.tail = "\n".join(lines[1:])

    def text(self):
        if not self.is_table:
            return self.title + "\n" + self.tail
        row = lambda cells: "| " + " | ".join(cells) + " |"
        return "\n".join([self.title, "", row(self.rows[0]), "|---|" + "--:|" * (len(self.rows[0]) - 1), *map(row, self.rows[1:]), self.tail])

    def note(self, reasons):
        """The sentence that says what is not printed, once."""
        self.tail = re.sub(r" ?Not printed \(–\): [^\n]*", "", self.tail)
        if not reasons:
            return
        head, *rest = self.tail.strip("\n").split("\n\n", 1)
        sentence = "Not printed (–): " + "; ".join(sorted(reasons)) + "."
        words = head.strip()
        self.tail = "\n" + (words + " " if words else "") + sentence + "\n" + ("\n" + rest[0] + "\n" if rest else "") + "\n"


def by_solver(cells, t, shown):
    """Tables with a row for each scene and solver."""
    head, reasons = t.rows[0], set()
    for row in t.rows[1:]:
        r = cells.find(row[0], row[1], row[2] if head[2] == "sides" else None)
        if r is None:
            continue
        why = cells.why[cells.key(r)]
        for column, names in shown.items():
            if column in head and any(n in why for n in names):
                row[head.index(column)] = DASH
                reasons |= {why[n] for n in names if n in why}
        if "expected" in head:
            row[head.index("expected")] = cells.verdict(r)
            reasons |= {why["expect." + b] for b in cells.bounds(r) if "expect." + b in why}
    t.note(reasons)


def verdicts(cells, t):
    reasons = set()
    for row in t.rows[1:]:
        for k, solver in enumerate(t.rows[0][1:], 1):
            r = cells.find(row[0], solver)
            if r is not None:
                row[k] = cells.verdict(r)
                why = cells.why[cells.key(r)]
                reasons |= {why["expect." + b] for b in cells.bounds(r) if "expect." + b in why}
    t.note(reasons)


def leaks(cells, t):
    reasons = set()
    t.tail = "\n" + LEAKS + "\n\n"
    for row in t.rows[1:]:
        scene, kind = re.fullmatch(r"(.*) \((.*)\)", row[0]).groups()
        for k, solver in enumerate(t.rows[0][2:], 2):
            of = sorted((number(r["imposed_speed_m_per_s"]), cells.leak(r), r["scene"]) for r in cells.rows
                        if label(r) == solver and cells.scenes.get(r["scene"], ("", "", ""))[1:] == (kind, scene) and number(r["imposed_speed_m_per_s"]) > 0
                        and r["status"] not in ("unsupported", "over_budget") and cells.verdict(r) != "ignored")
            if len(of) < 3:
                continue
            first = next(((v, leak) for v, leak, _ in of if leak), None)
            row[k] = f"none up to {of[-1][0]:g} m/s" if first is None else DASH if first[1] == DASH else f"{first[0]:g} m/s: {first[1]}"
            for r in cells.rows:
                if label(r) == solver and cells.scenes.get(r["scene"], ("", "", ""))[1:] == (kind, scene):
                    reasons |= {w for c, w in cells.why[cells.key(r)].items() if c in WORDS}
    t.note(reasons)


def broken(cells, t, order):
    t.rows = t.rows[:1]
    for scene in order:
        for r in sorted((r for r in cells.rows if r["scene"] == scene), key=lambda r: (r["solver"], r["setting"])):
            expect = cells.scenes[scene][0] if scene in cells.scenes else {}
            for n in sorted(cells.bounds(r)):
                if r.get("expect." + n) == "0":
                    words = expect[n] if n == "outcome" else ", ".join(w + json.dumps(expect[n][k]) for k, w in (("at_least", "at least "), ("at_most", "at most ")) if k in expect[n])
                    v = number(r.get(n))
                    t.rows.append([scene, label(r), n, words, DASH if math.isnan(v) else f"{v:.4g}"])


def expectations(cells, t, order):
    place = {s: k for k, s in enumerate(["paper", "xpbd", "bullet-soft", "bullet-deformable", "ballistic"])}
    t.rows = t.rows[:1]
    for scene in order:
        for r in sorted((r for r in cells.rows if r["scene"] == scene), key=lambda r: (r["setting"] != "default", place[r["solver"]])):
            if r["expect"].startswith("broken"):
                t.rows.append([scene, label(r), r["expect"]])
    count = lambda word: sum(r["expect"] == word for r in cells.rows)
    t.tail = f"\n{count('kept')} kept, {count('not measured')} not measured.\n\n"


def turned(cells, t):
    for row in t.rows[1:]:
        pair = [cells.find(row[0] + end, row[1], row[2]) for end in ("", "-turned")]
        if None in pair:
            continue
        leak = [cells.leak(r) for r in pair]
        for k in (0, 1):
            row[3 + k] = cells.verdict(pair[k]) + (f" ({leak[k]})" if leak[k] not in ("", DASH) else "")
        apart = row[5].split(" / ")[0]
        same = bool(leak[0]) == bool(leak[1]) and apart != DASH and float(apart) <= 0.05
        row[6] = DASH if DASH in leak else "same" if same else "differs"
    t.note({w for row in t.rows[1:] for end in ("", "-turned") for r in [cells.find(row[0] + end, row[1], row[2])] if r
            for c, w in cells.why[cells.key(r)].items() if c.startswith("expect.")})


def renew_tables(text, cells):
    head, *parts = re.split(r"^### ", text, flags=re.M)
    head = re.sub(r"\*\*Not printed \(–\), [^\n]*\n\n", "", head)
    counts = {}
    for why in cells.why.values():
        for reason in set(why.values()):
            counts[reason] = counts.get(reason, 0) + 1
    lines = "".join(f"**Not printed (–), {n} cell{'s' * (n > 1)}: {reason}.**\n\n" for reason, n in sorted(counts.items()))
    head = re.sub(r"\A(# [^\n]*\n\n)?", lambda m: m[0] + lines, head, count=1)
    tables = [Table(p) for p in parts]
    order = next(([row[0] for row in t.rows[1:]] for t in tables if t.title.startswith("Penetration:")), [])
    for t in tables:
        if not t.is_table:
            continue
        if t.title.startswith("Penetration:"):
            verdicts(cells, t)
        elif t.title == "Speed of the first leak":
            leaks(cells, t)
        elif t.title == "Broken expectations":
            broken(cells, t, order)
        elif t.title == "Expectations that were broken":
            expectations(cells, t, order)
        elif t.title == "The cloth turned over":
            turned(cells, t)
        elif t.rows[0][:3] == ["scene", "solver", "sides"]:
            by_solver(cells, t, {"wall / GPU [ms]": ["frame_wall_median_s"], "load [ms]": ["load_s"], "wrong side [samples]": ["wrong_side_samples_max"],
                                 "crossed, longest [s]": ["contact_violated_longest_s"]})
    return head + "".join("### " + t.text() for t in tables)


def lower_bounds(text):
    """The sign before what `xpbd` reads in tables of costs of scenes with colliders, where there is no cells.csv to tell by."""
    def section(m):
        if re.match(r"### Cost: (Hands|Bars)", m[0]) or not m[0].startswith("### Cost: "):
            return m[0]
        return re.sub(r"^(\| [^|]* \| xpbd[^|]*\| [^|]* \| )(?=\d)", r"\1≥ ", m[0], flags=re.M)
    return re.sub(r"^### .*?(?=^### |\Z)", section, text, flags=re.M | re.S)


def renew_csv(path, cells):
    rows = list(csv.DictReader(io.StringIO(path.read_text(encoding="utf-8"))))
    names = [n for n in rows[0] if n != "withheld"]
    extra = sorted({c for r in cells.rows for c in r if c.startswith("expect.")} - set(names)) if path.name == "cells.csv" else []
    names += extra
    of = {cells.key(r): r for r in cells.rows}
    out = io.StringIO()
    write = csv.writer(out, lineterminator="\n")
    write.writerow(names + ["withheld"])
    for r in rows:
        now, why = of[cells.key(r)], cells.why[cells.key(r)]
        values = [now.get(n, "") if n == "expect" or n.startswith("expect.") or n in why else r[n] for n in names]
        write.writerow(values + ["; ".join(sorted({why[n] for n in names if n in why}))])
    return out.getvalue()


def renewed(folder):
    """path -> text of every file that changes or not."""
    out = {}
    known = json.loads((folder / "renewed.json").read_text()) if (folder / "renewed.json").exists() else None
    cells = Cells(folder, known) if known is not None else None
    for path in sorted(folder.glob("*")):
        if path.suffix not in (".md", ".txt", ".csv") or path.name == "README.md":
            continue
        text = path.read_text(encoding="utf-8")
        if path.suffix == ".csv":
            out[path] = renew_csv(path, cells) if cells and text.startswith("family,") else text
            continue
        for old, new in CAPTIONS.items():
            text = text.replace(old, new)
        if path.suffix == ".md":
            text = lower_bounds(renew_tables(text, cells) if cells else text)
        out[path] = text
    return out


def main():
    folders = [a for a in sys.argv[1:] if a != "--check"]
    if not folders:
        sys.exit(__doc__)
    stale = []
    for folder in map(pathlib.Path, folders):
        for path, text in renewed(folder).items():
            if path.read_text(encoding="utf-8") != text:
                stale.append(str(path))
                if "--check" not in sys.argv:
                    path.write_text(text, encoding="utf-8")
    print("\n".join(stale) or "nothing to renew")
    if "--check" in sys.argv and stale:
        sys.exit("these hold what must not be printed, or verdicts by older bounds: run scripts/renew_reference.py on their folders")


if __name__ == "__main__":
    main()

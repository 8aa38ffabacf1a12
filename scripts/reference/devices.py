"""Which solver is first on each of two devices, and which verdicts are the same."""
import json
import pathlib

from figures import Tables, statement

CLAIMS = json.loads((pathlib.Path(__file__).resolve().parent / "claims.json").read_text(encoding="utf-8"))
# Parts whose names begin so ran on another device than the study of the rest of the name: those of the software table, and of scripts/reference.sh --second.
OTHERS = ("software-", "second-")
# By what the solvers of a scene are ordered, in which table, and below which value two are equal (single precision). Times are not of a software device.
ORDERS = {"table3": [("runs.csv", "free_fall_error", 1e-6), ("runs.csv", "frame_wall_median_s", 0)],
          "hang": [("runs.csv", "stretch_mean_last_second", 1e-6), ("runs.csv", "frame_device_median_s", 0)],
          "work-precision": [("work-precision.csv", "least time to an error of 1 %", 0)],
          "contact-cost": [("runs.csv", "frame_device_median_s", 0)],
          "penetration": [("runs.csv", "expect", 0)]}
WORDS = {"free_fall_error": "free-fall error", "frame_wall_median_s": "wall time of a frame", "stretch_mean_last_second": "mean stretch", "frame_device_median_s": "GPU time of a frame", "expect": "verdict"}
TIMES = {"frame_wall_median_s", "frame_device_median_s", "least time to an error of 1 %"}
SAME_WITHIN = 1.05  # two figures of an order


def device_of(folder, prefix):
    """What the documents call the device of these parts: its own name, if it is a GPU."""
    if prefix == "software-":
        return "software device"
    rows = (r for group in ORDERS for r in Tables(folder, prefix).rows(f"{group}/runs.csv"))
    return next((r["gpu"] for r in rows if r["gpu"] not in ("", "CPU", "–")), "second device")


def figures_of(tables, name, column):
    """The figure of each solver and setting, by scene."""
    out = {}
    for r in tables.rows(name):
        of_scene = out.setdefault(r["scene"], {})
        if r["status"] != "ok":
            # Of error against run time a setting that fails is none; elsewhere the run has no figure.
            if column in r:
                of_scene[f"{r['solver']} {r['setting']}".removesuffix(" default")] = r["status"] if column == "expect" else float("nan")
            continue
        if column == "least time to an error of 1 %":
            if not r["refused"] and r["error"] and float(r["error"]) <= 0.01:
                of_scene[r["solver"]] = min(float(r["wall_ms_per_s"]), of_scene.get(r["solver"], float("inf")))
        elif r.get(column) and r[column] != "–":
            of_scene[f"{r['solver']} {r['setting']}".removesuffix(" default")] = r[column] if column == "expect" else float(r[column])
    return out


def failed(figure):
    """Whether a figure of figures_of is that of a run that ended badly."""
    return figure != figure or (isinstance(figure, str) and figure != "pass" and not figure.startswith("fail"))


def same_order(a, b, floor):
    """Whether no two figures that differ are the other way round, and all are numbers."""
    if any(v != v for of in (a, b) for v in of.values()):
        return False
    less = lambda x, y: x * SAME_WITHIN < y and y > floor
    return not any(less(a[x], a[y]) and less(b[y], b[x]) for x in a for y in a)


def devices_table(folder):
    """How the solvers of a scene are ordered on the first device and on another one, by error, time or verdict: rows of text."""
    rows = [["other device", "study", "scene", "by", "first device", "other device", "same"]]
    for prefix in OTHERS:
        device = device_of(folder, prefix)
        here, there = Tables(folder), Tables(folder, prefix)
        for group, orders in ORDERS.items():
            for name, column, floor in orders:
                if prefix == "software-" and column in TIMES:
                    continue
                a, b = (figures_of(t, f"{group}/{name}", column) for t in (here, there))
                for scene in b:
                    # What ended badly on both is no difference; on one alone it is.
                    common = sorted(c for c in set(a.get(scene, {})) & set(b[scene]) if not (failed(a[scene][c]) and failed(b[scene][c])))
                    if len(common) < 2:
                        continue
                    both = [{c: of[scene][c] for c in common} for of in (a, b)]
                    if column == "expect":
                        texts = [", ".join(f"{c.split()[0]} {of[c].split(':')[0]}" for c in common) for of in both]
                        same = texts[0] == texts[1]
                    else:
                        texts = [" < ".join(sorted(common, key=lambda c, of=of: (failed(of[c]), of[c]))) for of in both]
                        same = same_order(*both, floor)
                    rows.append([device, group, scene, WORDS.get(column, column), *texts, "yes" if same else "no"])
    return rows


def devices_summary(rows):
    """How many orders and verdicts of each study are the same, of the rows of devices_table: rows of text."""
    counts = {}
    for device, study, _, by, *_, same in rows[1:]:
        of = counts.setdefault((device, study, by), [0, 0])
        of[0] += same == "yes"
        of[1] += 1
    return [["other device", "study", "by", "same", "of"]] + [[*key, str(same), str(of)] for key, (same, of) in counts.items()]


def devices_sentence(folder, rows):
    """Which conclusions hold on other devices: orders and verdicts of scenes, and the claims that rest on untimed scenes alone."""
    out, agreed = [], []
    for prefix in OTHERS:
        device = device_of(folder, prefix)
        of_device = [r for r in rows[1:] if r[0] == device]
        if not of_device:
            continue
        same = sum(r[-1] == "yes" for r in of_device)
        text = f"On the {device} {same} of {len(of_device)} orders and verdicts are those of the first device; figures within {SAME_WITHIN - 1:.0%}, and errors below 1e-6, count as equal."
        claims = [c for c in CLAIMS if "figures" in c and (prefix != "software-" or all("penetration/runs.csv" in line for line in c["figures"].values()))]
        on_both = [(c["id"], *(statement(Tables(folder, of), c)[1] for of in ("", prefix))) for c in claims]
        known = [(name, a == b) for name, a, b in on_both if a is not None and b is not None]
        for holds, words in ((True, "The same verdict on both devices"), (False, "Another verdict")):
            if names := [name for name, agrees in known if agrees == holds]:
                text += f" {words}: {', '.join(names)}."
        out.append(text)
        agreed.append([name for name, agrees in known if agrees])
    if len(agreed) > 1 and (names := [name for name in agreed[0] if all(name in of for of in agreed)]):
        out.append(f"The same verdict on all devices: {', '.join(names)}.")
    return " ".join(out)

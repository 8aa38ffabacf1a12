"""What the documents say of the study of 200 drawn contact scenes is what its tables have, and the bounds of drawn pulls are those measured."""
import csv
import json
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1])
reference = root / "results/reference"

# What the documents say of drawn contact scenes is what the table has.
with open(reference / "contact-h200/contact-rates.csv", encoding="utf-8", newline="") as f:
    rates = {(r["solver"], r["setting"], r["kind"]): r for r in csv.DictReader(f) if r["speed_m_per_s"] == "all"}


def passed(solver, setting, kind):
    return rates[solver, setting, kind]["passed"] + " of " + rates[solver, setting, kind]["drawn"]


index, study = ((root / name).read_text(encoding="utf-8") for name in ("results/reference/EARLIER.md", "results/reference/contact-h200/README.md"))
total = rates["xpbd", "default", "all"]
interval = f"({100 * float(total['rate_low']):.0f} to {100 * float(total['rate_high']):.0f} %)"
assert passed("xpbd", "default", "all") in index and interval in index, interval
for kind, words in (("push", "pushes"), ("sweep-mesh", "sweeps of a hand mesh"), ("sweep-capsules", "sweeps of capsules")):
    assert f"{passed('xpbd', 'default', kind)} {words}" in re.sub(r"\s+", " ", index), kind
for solver, setting in (("xpbd", "default"), ("bullet-soft", "default"), ("paper", "default")):
    count, drawn = (rates[solver, setting, "all"][k] for k in ("passed", "drawn"))
    assert f"`{solver}` passes {count} of {drawn}" in study or f"`{solver}` {count}" in study, solver
assert f"{rates['xpbd', 'accurate', 'all']['passed']} at `accurate`" in study

# What they say of the same scenes since planes hold every collider off.
with open(reference / "contact-h200/contact-runs.csv", encoding="utf-8", newline="") as f:
    before = {(r["scene"], r["setting"]): r for r in csv.DictReader(f) if r["solver"] == "xpbd"}
with open(reference / "contact-h200/planes-runs.csv", encoding="utf-8", newline="") as f:
    now = {(r["scene"], r["setting"]): r for r in csv.DictReader(f) if r["status"] == "ok"}
with open(reference / "contact-h200/planes-rates.csv", encoding="utf-8", newline="") as f:
    planes = {(r["setting"], r["speed_m_per_s"]): r for r in csv.DictReader(f) if r["kind"] == "all"}
plain = re.sub(r"\s+", " ", study)


with open(reference / "contact-h200/planes-earlier-bounds.csv", encoding="utf-8", newline="") as f:
    earlier = {(r["scene"], r["setting"]): r for r in csv.DictReader(f)}


def shapes(setting):
    drops = [r["expect"] for k, r in now.items() if k[1] == setting and re.search("-(sphere|box)$", k[0])]
    return f"{sum(e != 'pass' for e in drops)} of {len(drops)}"


def counts(runs, setting):
    return sum(runs[k]["expect"].startswith("pass") for k in now if k[1] == setting)


def of(setting, speed="all"):
    r = planes[setting, speed]
    return f"{r['passed']} of {r['drawn']}"


low, high = (round(100 * float(planes["default", "all"][k])) for k in ("rate_low", "rate_high"))
leaks = sorted(k[1] for k in now if re.search("contact_length|tunnelled|wrong_side|hooked|depth_max", now[k]["expect"]))
assert leaks == ["default", "fast"] and all("-191-" in k[0] for k in now if "wrong_side" in now[k]["expect"]), leaks
assert all(float(r["self_contact_length_max_m"] or 0) == 0 for r in now.values())
assert of("default", "0–2") == "67 of 67" and shapes("accurate").startswith("0 of")
assert len(earlier) == 400 and {r["git_dirty"] for r in earlier.values()} == {"false"}
for setting in ("default", "accurate", "fast"):
    assert of(setting) == f"{counts(now, setting)} of {sum(k[1] == setting for k in now)}", setting
for words in (
    f"Of 600 runs {len(now)} ended",
    f"At default {of('default')} scenes pass** ({low} to {high} %)",
    *(
        f"| {s} | {of(s)} | {counts(earlier, s)} | {counts(before, s)} | {sum(r['expect'] == 'pass' for k, r in earlier.items() if k[1] == s)} |"
        for s in ("default", "accurate")
    ),
    f"| fast | {of('fast')} | – |",
    f"All {planes['default', '0–2']['drawn']} scenes below 2 m/s pass",
    f"{shapes('default')} at default, none of {shapes('accurate').split()[-1]} at `accurate`",
    f"and {of('default', '≥ 10')} above 10 m/s",
):
    assert words in plain, words
assert f"{of('default').replace('of', 'of the')} that were run again, {counts(earlier, 'default')} of them by the bounds of before ({counts(before, 'default')} before" in re.sub(r"\s+", " ", index)

# What it says of them since frames without contact take lines alone.
with open(reference / "contact-h200/frames-runs.csv", encoding="utf-8", newline="") as f:
    frames = {(r["scene"], r["setting"]): r for r in csv.DictReader(f) if r["status"] == "ok"}
with open(reference / "contact-h200/frames-rates.csv", encoding="utf-8", newline="") as f:
    rates = {r["setting"]: r for r in csv.DictReader(f) if r["kind"] == "all" and r["speed_m_per_s"] == "all"}
assert {(r["git_commit"][:12], r["git_dirty"]) for r in frames.values()} == {("b4f7ed1c50a8", "false")}


def values(scalar):
    return [float(r[scalar]) for r in frames.values() if r[scalar]]


leaks = [k for k, r in frames.items() if not float(r["wrong_side_samples_max"] or 0) == 0]
wrong = sorted({int(re.search("[0-9]+", scene).group()) for scene, _ in leaks})
assert {setting for _, setting in leaks} == {"fast"}
for k, r in frames.items():  # what else fails
    bounds = [b.split()[0] for b in r["expect"].removeprefix("fail:").split(";")]
    assert r["expect"] == "pass" or k in leaks or all(re.match("stretch|pop|grip_edge_ratio", b) for b in bounds), (k, bounds)
assert not any(values("contact_length_max_m")) and not any(values("self_contact_length_max_m"))
with open(reference / "gpu/contact-long/runs.csv", encoding="utf-8", newline="") as f:
    hundred = {(r["scene"], r["setting"]): r for r in csv.DictReader(f) if r["status"] == "ok"}
of_the_hundred = {r["git_commit"][:7] for r in hundred.values()} == {"e7c6b92"}


def shared(setting):
    """The row's end: scenes of both studies, and those that passed. Once the hundred are measured again, it says what was before."""
    both = [k for k in frames if k in hundred and k[1] == setting]
    then, now_passed = (sum(runs[k]["expect"].startswith("pass") for k in both) for runs in (hundred, frames))
    return f"%) | {len(both)} | {then} | {now_passed} |" if of_the_hundred else ""


if of_the_hundred:
    lost = [k for k in frames if k in hundred and hundred[k]["expect"].startswith("pass") and frames[k]["expect"] != "pass"]
    assert len([k for k in lost if k[1] == "fast"]) == 6 and all("stretch_max_end" in frames[k]["expect"] for k in lost if k[1] == "fast"), lost
pushes = [r for (scene, _), r in frames.items() if scene.endswith("-push")]
slow = [r for (scene, _), r in frames.items() if "-sweep-" in scene and float(r["imposed_speed_m_per_s"]) <= 3.3]
assert not any(float(r["hooked_end"] or 0) for r in pushes) and all(float(r["laid_over_samples_end"] or 0) <= 4 for r in slow)
section = plain.split("## Since frames without")[1].split("## What contact costs")[0]
for words in (
    f"Of 600 runs {len(frames)} ended",
    *(
        f"| {s} | {r['passed']} of {r['drawn']} ({100 * float(r['rate_low']):.0f} to {100 * float(r['rate_high']):.0f} %)"
        for s, r in rates.items()
    ),
    f"none of {len(values('contact_length_max_m'))} runs with colliders has a contour",
    f"none of {len(values('self_contact_length_max_m'))} with self-contact a crossing",
    "seeds {}, {} and {}".format(*wrong),
    f"none of the {len(pushes)} pushes ends so",
    f"None of the {len(slow)} sweeps up to 3.3 m/s",
    *(shared(s) for s in rates),
):
    assert words in section, words

# And what it says of cost, in milliseconds of GPU time.
cost = {}
for name in ("planes-cost", "cost"):
    with open(reference / f"contact-h200/{name}.csv", encoding="utf-8", newline="") as f:
        for r in csv.DictReader(f):
            if r["frame_device_median_s"] and r["setting"] in ("default", "points"):
                cost[r["scene"], r["setting"]] = f"{1e3 * float(r['frame_device_median_s']):.2f}"
table = [row for row in study.splitlines() if re.match(r"\| [a-z0-9-]+ \| [0-9.]+ \|", row)]
for row in table:
    scene, now_ms, before_ms = (c.strip() for c in row.strip("|").split("|")[:3])
    assert now_ms == cost[scene, "default"] and before_ms == cost.get((scene, "points"), "–"), row
assert len(table) == sum(k[1] == "default" for k in cost), len(table)
# The bounds of drawn pulls are the converged solutions plus 10 %.
with open(reference / "contact-h200/pulls.csv", encoding="utf-8", newline="") as f:
    pulls = list(csv.DictReader(f))
contact = json.loads((root / "scenarios/studies/contact.json").read_text(encoding="utf-8"))
(bounds,) = (s["draw"]["set"]["expect"] for s in contact["scenes"] if s["draw"]["kind"] == "stretch")
assert len(pulls) == 10 and {r["git_dirty"] for r in pulls} == {"false"}
for scalar in ("grip_edge_ratio_max", "stretch_max"):
    greatest = max(float(r[scalar]) for r in pulls)
    assert abs(bounds[scalar]["at_most"] - 1.1 * greatest) <= 0.001 and f"{greatest:.3f}" in bounds[scalar]["why"], (scalar, greatest)

print("ok")

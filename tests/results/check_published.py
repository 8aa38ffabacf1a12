"""What scripts/reference.sh refuses: a table that was changed, a second commit, a result of a changed tree, a file too many, bad arguments.

    check_published.py ROOT
"""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

root = pathlib.Path(sys.argv[1])
sys.path[:0] = [str(root / "scripts"), str(root / "scripts/reference")]
import devices  # noqa: E402
import figures  # noqa: E402
import page  # noqa: E402
import reference  # noqa: E402
import sources as measured  # noqa: E402

HEAD = "scene,solver,setting,status,expect,gpu,cpu,git_commit,git_dirty,source_sha256,created,fps_median,free_fall_error"


def table(rows):
    return "\n".join([HEAD, *rows]) + "\n"


def row(scene, solver, fps, commit, dirty="false", error="0.1", sources=""):
    return f"{scene},{solver},default,ok,pass,GPU,CPU,{commit},{dirty},{sources},2026-01-02T00:00:00Z,{fps},{error}"


def made(folder, commit, rows=None, sources=""):
    """A published folder of two studies, sealed."""
    to = folder / "results/device"
    rows = rows or [row("gravity-64-single", "paper", 310, commit), row("gravity-128-single", "paper", 200, commit)]
    for study in ("table3", "software-table3"):
        (to / study).mkdir(parents=True)
        (to / study / "runs.csv").write_text(table(rows), encoding="utf-8")
    facts = {g: {**f, "how": ["timed"], "seconds": 1, "commands": ["study table3"]} for g, f in reference.facts_of(to, ["table3", "software-table3"]).items()}
    reference.seal(to, {"commit": commit, "source_sha256": sources, "studies": facts, "results": {}})
    return to


def checked(to, *words):
    done = subprocess.run([str(root / "scripts/reference.sh"), "--check", "--to", str(to), *words], text=True, capture_output=True, env={**os.environ, "PYTHON": sys.executable})
    return done.returncode, done.stdout + done.stderr


def refused(commit, change, why):
    with tempfile.TemporaryDirectory() as scratch:
        to = made(pathlib.Path(scratch), commit)
        change(to)
        code, said = checked(to)
        assert code == 1 and re.search(why, said), (why, code, said)


def replace(name, old, new, sealed=False):
    def change(to):
        text = (to / name).read_text(encoding="utf-8")
        assert old in text
        (to / name).write_text(text.replace(old, new, 1), encoding="utf-8")
        if sealed:
            reference.seal(to, json.loads((to / reference.LIST).read_text(encoding="utf-8")))
    return change


git = subprocess.run(["git", "-C", str(root), "rev-parse", "HEAD"], text=True, capture_output=True)
head = git.stdout.strip() if git.returncode == 0 else ""
commit = head or "0" * 40
with tempfile.TemporaryDirectory() as scratch:
    to = made(pathlib.Path(scratch), commit)
    code, said = checked(to)
    assert (code, "nothing that may change" in said) == (0, True) if head else (code == 4), (code, said)
    text = (to.parent / "README.md").read_text(encoding="utf-8")
    assert "| C2 | " in text and "reproduced | `paper`: 310 and 200 frames a second" in text, text
    (pathlib.Path(scratch) / "out/table3").mkdir(parents=True)
    (pathlib.Path(scratch) / "out/table3/x.h5").write_bytes(b"other")
    code, said = checked(to, str(pathlib.Path(scratch) / "out"))
    assert code == 1 and "is not the result that is published" in said, said
with tempfile.TemporaryDirectory() as scratch:
    code, said = checked(made(pathlib.Path(scratch), "1" * 40))
    assert code == 4 and "measured before this change" in said, (code, said)

# Two commits are one study if what may change a figure is the same in both, also where this tree knows neither of them.
if head:
    sources = measured.source_sha256()
    two = [row("gravity-64-single", "paper", 310, "1" * 40, sources=sources), row("gravity-128-single", "paper", 200, "2" * 40, sources=sources)]
    with tempfile.TemporaryDirectory() as scratch:
        code, said = checked(made(pathlib.Path(scratch), "1" * 40, two, sources))
        assert code == 0 and "nothing that may change" in said, (code, said)
    with tempfile.TemporaryDirectory() as scratch:
        other = [two[0], two[1].replace(sources, "3" * 64)]
        code, said = checked(made(pathlib.Path(scratch), "1" * 40, other, sources))
        assert code == 1 and "or one source_sha256" in said, (code, said)

refused(commit, replace("table3/runs.csv", ",310,", ",400,"), r"runs\.csv: is not as --report wrote it")
refused(commit, replace("table3/runs.csv", commit, "2" * 40, sealed=True), "results of the commits .*expected one")
refused(commit, replace("table3/runs.csv", "false", "true", sealed=True), "1 runs are of a tree with local changes")
refused(commit, lambda to: (to / "table3/runs.csv").unlink(), "is missing")
refused(commit, lambda to: (to / "table3/more.md").write_text("x"), "was not written by --report")
refused(commit, lambda to: (to.parent / "README.md").write_text("C2 is reproduced\n"), "not what the tables say")

# Figures: exactly one row, no number where there is none, rules that fail with NaN, an order of solvers by device.
with tempfile.TemporaryDirectory() as scratch:
    folder = pathlib.Path(scratch)
    (folder / "table3").mkdir()
    (folder / "software-table3").mkdir()
    rows = [row("a", "paper", 1, commit, error="0.2"), row("a", "xpbd", 2, commit, error="0.1")]
    (folder / "table3/runs.csv").write_text(table([*rows, row("b", "xpbd", "nan", commit)]), encoding="utf-8")
    (folder / "software-table3/runs.csv").write_text(table([r.replace("0.2", "0.05") for r in rows]), encoding="utf-8")
    of = figures.Tables(folder).figure
    assert of("one table3/runs.csv scene=a solver=xpbd : fps_median") == 2 and of("count table3/runs.csv scene~^a") == 2
    for missing in ("one table3/runs.csv scene=a : fps_median", "one none.csv : x", "one table3/runs.csv scene=a solver=xpbd : none", "max table3/runs.csv scene=z : fps_median"):
        assert of(missing) is None, missing
    entry = {"figures": {"n": "one table3/runs.csv scene=b : fps_median"}, "rule": "n >= 72", "text": "{n}"}
    assert figures.statement(figures.Tables(folder), entry) == ("nan", False)
    assert figures.statement(figures.Tables(folder), {**entry, "needs": "n > 0"}) == (None, None)
    rows = reference.devices_table(folder)
    assert rows[1][2:] == ["a", "free-fall error", "xpbd < paper", "paper < xpbd", "no"], rows
    assert devices.devices_summary(rows)[1:] == [["software device", "table3", "free-fall error", "0", "1"]], devices.devices_summary(rows)

    # A run that ends badly on one device alone is a difference; on both it is none.
    for fails, same in ((["software-table3"], ["no"]), (["table3", "software-table3"], [])):
        for study in ("table3", "software-table3"):
            lines = [row("a", "paper", 1, commit, error="0.2"), row("a", "xpbd", 2, commit, error="0.1")]
            (folder / study / "runs.csv").write_text(table([lines[0].replace(",ok,", ",crashed,") if study in fails else lines[0], lines[1]]), encoding="utf-8")
        assert [r[-1] for r in reference.devices_table(folder)[1:]] == same, (fails, reference.devices_table(folder))

# The page: titles without repeats; the sections that figures belong to first.
assert [page.title_of("Garments", "Penetration", alone) for alone in (True, False)] == ["Garments", "Garments: Penetration"]
assert page.title_of("Hanging sheets", "Rates: hang", False) == "Hanging sheets: hang" and page.title_of("Penetration", "Penetration", False) == "Penetration"
titles = {s["group"]: s["title"] for s in reference.data("studies.json")}
assert [s["title"] for s in page.in_order([{"title": "Hanging sheets: Penetration"}, {"title": "Penetration"}], titles)] == ["Penetration", "Hanging sheets: Penetration"]

# Orders of two devices: within 5 %, below the floor, not a number.
for a, b, floor, same in ((1, 2), (1.04, 1), 0, True), ((1, 2), (1.2, 1), 0, False), ((1, 2), (1.2, 1), 3, True), ((1, 2), (float("nan"), 3), 0, False):
    assert devices.same_order(dict(enumerate(a)), dict(enumerate(b)), floor) == same, (a, b, floor)

# The table of parts can be read, and every study and claim has its data.
for words, why in ((["--limit", "x"], "expected a positive whole number"), (["--table", "none"], "expected gpu, software or quick"), (["--part", "none"], "has no such part"), (["--part"], "expected a value")):
    done = subprocess.run([str(root / "scripts/reference.sh"), tempfile.gettempdir() + "/none", "--list", *words], text=True, capture_output=True, env={**os.environ, "CLOTHBENCH": "/bin/true"})
    assert done.returncode == 2 and why in done.stderr, (words, done)
parts = [line.split() for line in (root / "scripts/reference/parts.conf").read_text(encoding="utf-8").splitlines() if line and line[0] != "#"]
assert all(p[0] in ("gpu", "software", "quick") and p[2].isdigit() and p[3] in ("timed", "untimed", "spread") for p in parts), parts
assert {p[1] for p in parts if p[0] == "software" and p[3] == "timed"} == {"peers-hang"}  # engines on one CPU core
assert sum(int(p[2]) for p in parts if p[0] == "gpu" and p[3] == "timed") <= 3600
named = {s["group"] for s in reference.data("studies.json")} | {"repeat-again"}
assert {p[1].split("+")[0] for p in parts if not p[1].startswith("software-")} <= named, named
assert [c["id"] for c in reference.data("claims.json")] == [f"C{n}" for n in range(1, 16)]

# What is published.
if reference.PUBLISHED.exists():
    code, said = checked(reference.PUBLISHED)
    assert code in (0, 4), (code, said)
print("ok")

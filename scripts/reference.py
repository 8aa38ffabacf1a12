#!/usr/bin/env python3
"""Publishes the results of scripts/reference.sh, and checks what is published.

    scripts/reference.sh --report OUT… [--to FOLDER] [--work FOLDER]
    scripts/reference.sh --add OUT… [--to FOLDER] [--work FOLDER]
    scripts/reference.sh --check [OUT…] [--to FOLDER]

--report: makes tables of each study and one page of all (index.html) from the folders OUT, which must be of one state of the sources, into FOLDER (default:
results/reference/gpu), and ../README.md of FOLDER. reference.json has the SHA-256 of all of these and of every result file they were made from.
--add: adds parts of another device (scripts/reference.sh --second) to what is published; their sources must be those of what is there, which stays as it is.
Raw results are not published: they are some hundred megabytes, and the tables hold every summary value of every run.

--check: exit status 1 and a line for each fault if what is published is not what --report wrote, if the runs are of two states of the sources or of a tree
with local changes, or if a result file below OUT has changed; 4 if nothing is wrong but what the figures depend on has changed since ("measured
before this change"), or this tree does not know the commit; else 0.
"""
import argparse
import csv
import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "reference"))
from devices import OTHERS, devices_sentence, devices_summary, devices_table  # noqa: E402
from figures import SET_UPS, Tables, claims_table, markdown, statement  # noqa: E402
from page import document_of, merged, section, write_page  # noqa: E402
from sources import changed_since  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent
DATA = ROOT / "scripts/reference"
PUBLISHED = ROOT / "results/reference/gpu"
LIST = "reference.json"
DEVICES = "devices.csv"
# Files of a report that are not published: the page is one for all studies, and what else is left out is in runs.csv.
UNPUBLISHED = {"index.html", "runs.json", "tables.tex", "bandwidth.csv", "memory.csv", "report-pictures.json", "penetration-series.csv", "work-precision.json", "penetration.csv", "contact-runs.csv"}


def sha256(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def data(name):
    return json.loads((DATA / name).read_text(encoding="utf-8"))


def parts_of(folders):
    """Finished parts of all folders: {group: [(part folder, how, seconds, command)]}, in the order of the studies."""
    out = {s["group"]: [] for s in data("studies.json")}
    for folder in folders:
        for done in sorted(folder.glob("*.done")):
            name, how, seconds, command = done.read_text(encoding="utf-8").rstrip("\n").split("\t")
            out.setdefault(name.split("+")[0], []).append((folder / name, how, int(seconds), command))
    names = [p[0].name for parts in out.values() for p in parts]
    for name in sorted({n for n in names if names.count(n) > 1}):
        sys.exit(f"{' and '.join(str(f / name) for f in folders if (f / name).is_dir())}: the same part twice; expected each in one of the folders")
    return {group: parts for group, parts in out.items() if parts}


def without_unplanned(part, to):
    """A folder like `part` whose study.json names the runs that the part was to do; links to its files. A part of chosen runs has no others."""
    to.mkdir(parents=True)
    for file in part.iterdir():
        if file.name != "study.json":
            (to / file.name).symlink_to(file)
        else:
            study = json.loads(file.read_text(encoding="utf-8"))
            study["runs"] = [r for r in study["runs"] if (part / f"{r}.h5").exists() or (part / f"{r}.part").exists()]
            (to / file.name).write_text(json.dumps(study), encoding="utf-8")
    return to


def bench():
    return os.environ.get("CLOTHBENCH", str(ROOT / "build/release/clothbench"))


def report(inputs, out):
    """The report of the inputs in `out`; the text of its page."""
    done = subprocess.run([bench(), "report", *map(str, inputs), "-o", str(out)], capture_output=True, text=True, check=False)
    if done.returncode != 0 or not (out / "index.html").exists():
        sys.exit(f"clothbench report of {inputs[0]}: {done.stderr or done.stdout}")
    return (out / "index.html").read_text(encoding="utf-8")


def runs_of(folder, group):
    with open(folder / group / "runs.csv", encoding="utf-8", newline="") as f:
        return list(csv.DictReader(f))


def facts_of(folder, groups):
    """Commits, sources, trees with local changes, devices and days of the runs, by group."""
    out = {}
    for group in groups:
        runs = [r for r in runs_of(folder, group) if r["git_commit"] and (r["scene"] != "effective-moduli" or group.endswith("moduli"))]
        out[group] = {"runs": len(runs), "commits": sorted({r["git_commit"] for r in runs}), "sources": sorted({r.get("source_sha256", "") for r in runs} - {"", "–", "unknown"}), "dirty": sum(r["git_dirty"] != "false" for r in runs),
                      "devices": sorted({r["gpu"] for r in runs} - {"", "CPU", "–"}), "cpus": sorted({r["cpu"] for r in runs} - {""}),
                      "days": sorted({r["created"][:10] for r in runs})}
    return out


def head_of(listing):
    """The page's first lines: the commit, and a warning where all that ran on a Vulkan device ran on a software one."""
    devices = {d for f in listing["studies"].values() for d in f["devices"]}
    software = all(re.search("llvmpipe|lavapipe|SwiftShader", d) for d in devices)
    return ("**Software Vulkan device: it shows correctness; its times say nothing of a GPU.**\n\n" if devices and software else "") + \
        f"The reference study, measured at commit {listing['commit'][:12]}. Devices: {', '.join(sorted(devices)) or 'none'}; the table of studies says where each ran."


def readme(folder, listing):
    """results/reference/README.md, from the stored tables."""
    tables = Tables(folder)
    at = folder.name
    text = ["# The reference study", "",
            f"All figures of the study: one state of the sources (commit {listing['commit'][:12]}), one command, one [page]({at}/index.html) that opens from disk. "
            "Times were taken alone, in one process, contenders in turns; what is called untimed ran side by side and has no times. "
            f"[reference.json]({at}/reference.json) has the SHA-256 of every file; `scripts/reference.sh --check` verifies them.", "",
            *([listing["note"], ""] if listing.get("note") else []),
            "<!-- needs hardware: a GPU -->", "```sh",
            "scripts/reference.sh OUT --table gpu          # call again while its exit status is 75",
            "scripts/reference.sh SOFT --table software    # parts that need no GPU, on any machine",
            "scripts/reference.sh OUT2 --table gpu --second    # the same on another GPU, if there is one",
            "scripts/reference.sh --report OUT SOFT OUT2",
            "scripts/reference.sh --add OUT2               # the other GPU alone, to what is published", "```", "", "## Claims of the paper", "",
            markdown(claims_table(tables, data("claims.json"))), ""]
    if "penetration" in listing["studies"]:
        text += [f"C6 and C8 to C13 are of the study *Penetration*, on {', '.join(listing['studies']['penetration']['devices'])}.", ""]
    devices = devices_table(folder)
    if len(devices) > 1:
        text += ["## Devices", "", devices_sentence(folder, devices), ""]
        if other := [r for r in devices[1:] if r[-1] == "no"]:
            text += [markdown([devices[0], *other]), ""]
        text += [f"[{DEVICES}]({at}/{DEVICES}) has all of them, and which solver is first in each.", ""]
        if second := [f for g, f in listing["studies"].items() if g.startswith("second-")]:
            machine, days, commits = (", ".join(sorted({x for f in second for x in f[key]})) for key in ("devices", "days", "commits"))
            text += [f"The second device, with `--second`: {machine}, {days}, {len(second)} studies in {sum(f['seconds'] for f in second)} s, at commit {commits[:12]}; the sources are the same.", ""]
            if again := Tables(folder, "second-").rows("repeat/compare.csv"):
                same = sum(r["verdict"] == "noise" and r["values_that_differ"] == "0" for r in again)
                text += [f"Repeated there, {same} of {len(again)} runs have the same values and times within noise.", ""]
    for s in data("studies.json"):
        group = s["group"]
        if group not in listing["studies"]:
            continue
        facts = listing["studies"][group]
        answer, _ = statement(tables, s)
        answer = answer and answer.replace("](gpu/", f"]({at}/")
        text += [f"## {s['title']}: [{group}]({at}/{group}/report.md)", "", f"*{s['question']}* {answer or 'The tables lack a figure of the answer.'}", ""]
        if s.get("picture") and (folder / group / s["picture"]).exists():
            text += [f"![{s['question']}]({at}/{group}/{s['picture']})", ""]
        how = "timed" if facts["how"] == ["timed"] else "untimed" if "timed" not in facts["how"] else "timed, in part untimed"
        text += [" · ".join([*(re.sub(r" RUNS=(.*)`$", r"` (runs `\1`)", f"`clothbench {c}`") for c in facts["commands"]), ", ".join(facts["devices"] + facts["cpus"]), ", ".join(facts["days"]), how]), ""]
    if (folder.parent / "EARLIER.md").exists():
        text += ["## Beside this study", "", "[EARLIER.md](EARLIER.md) has 200 drawn contact scenes, measured at other commits.", ""]
    if (folder.parent / "CHANGES.md").exists():
        text += ["## Before", "", "[CHANGES.md](CHANGES.md) has the figures of earlier studies beside these.", ""]
    if (folder.parent / "pictures").exists():
        text += ["## Pictures", "", "[pictures](pictures) are made by `clothbench render` on a software device, [page](page) has pictures of this study's page.", ""]
    return "\n".join(text).rstrip("\n") + "\n"


def repeated(a, b, to):
    """compare.csv: what a study and its repetition differ in, run by run."""
    done = subprocess.run([bench(), "--json", "compare", str(a), str(b)], capture_output=True, text=True, check=True)
    with open(to / "compare.csv", "w", encoding="utf-8", newline="") as f:
        out = csv.writer(f, lineterminator="\n")
        out.writerow(["run", "verdict", "ratio", "low", "high", "outcome", "values_that_differ"])
        out.writerows([[r["run"], r["verdict"], r["ratio"], r["low"], r["high"], r["outcome"], len(r["metrics"])] for r in json.loads(done.stdout)])


def texts_of(to):
    """Documents with what stands between marks such as <!-- reference limits begin --> and <!-- reference limits end --> as the tables have it."""
    out = {}
    for name, texts in data("texts.json").items():
        out[ROOT / name] = before = (ROOT / name).read_text(encoding="utf-8")
        for mark, entry in texts.items():
            text, _ = statement(Tables(to), entry)
            pattern = rf"(<!-- reference {mark} begin -->\n).*?(<!-- reference {mark} end -->)"
            if text and re.search(pattern, before, re.S):
                out[ROOT / name] = re.sub(pattern, lambda m, t=text: m[1] + t + "\n" + m[2], out[ROOT / name], flags=re.S)
    return out


def motions_of(parts):
    """Result files whose motions the page shows: of each set-up and solver the first that has one. Packed results may have none (pack.py)."""
    import h5py
    shown = {}
    for group in ("table3", "penetration", "software-penetration", "meshes"):
        for h5 in (h5 for p in parts.get(group, []) for h5 in sorted(p[0].glob("*.h5")) if SET_UPS.match(h5.name)):
            with h5py.File(h5) as file:
                if h5.name not in shown and "trajectory/position" in file:
                    shown[h5.name] = h5
    return [shown[name] for name in sorted(shown)]


def tables_of(parts, to, work):
    """Writes the tables of each study below `to`; the documents of their pages and the SHA-256 of the result files."""
    documents, files = {}, {}
    for group, list_of in parts.items():
        inputs = [without_unplanned(p[0], work / "in" / p[0].name) for p in list_of]
        if group.endswith("work-precision"):  # whether stiffness is a parameter of a solver decides where it is ranked
            inputs += [p[0] for p in parts.get(group.replace("work-precision", "moduli"), [])]
        documents[group] = document_of(report(inputs, work / group))
        (to / group).mkdir()
        for file in sorted((work / group).iterdir()):
            if file.name not in UNPUBLISHED and file.suffix != ".svg":
                shutil.copy(file, to / group)
        for part, *_ in list_of:
            files.update({f"{part.name}/{h5.name}": sha256(h5) for h5 in sorted(part.glob("*.h5"))})
    for again in (g for g in parts if g.endswith("repeat-again")):
        first = again.removesuffix("-again")
        if first in parts:
            repeated(work / "in" / first, work / "in" / again, to / first)
    return documents, files


def listing_of(parts, to, files, before=None):
    """The list of what is published: of the studies of `before`, if there are any, and of `parts`."""
    facts = facts_of(to, parts)
    for group, list_of in parts.items():
        facts[group] |= {"how": sorted({p[1].replace("spread", "untimed") for p in list_of}), "seconds": sum(p[2] for p in list_of), "commands": [p[3] for p in list_of]}
    before = before or {"studies": {}, "results": {}}
    facts = before["studies"] | facts
    commits = {c for f in facts.values() for c in f["commits"]}
    sources = {s for f in facts.values() for s in f["sources"]}
    if len(sources) > 1 or (len(commits) > 1 and not all(f["sources"] for f in facts.values())):
        sys.exit("the folders hold results of different sources; a reference study has one state of what may change a figure")
    commit = before.get("commit", sorted(commits)[0])
    return before | {"format": "clothbench-reference", "format_version": 1, "commit": commit, "source_sha256": "".join(sources), "studies": facts, "results": before["results"] | files}


def sections_of(to, listing):
    """The sections of the page that are of all studies: claims, studies, devices."""
    studies = [["study", "question", "answer", "machine", "day", "how"]]
    for s in data("studies.json"):
        if f := listing["studies"].get(s["group"]):
            answer = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", statement(Tables(to), s)[0] or "–")  # a page on its own has no links to files
            studies.append([s["title"], s["question"], answer, ", ".join(f["devices"] + f["cpus"]), ", ".join(f["days"]), ", ".join(f["how"])])
    out = [section("claims", "Claims of the paper", ("Claims of the paper", "", claims_table(Tables(to), data("claims.json")))), section("studies", "Studies", ("Studies", "", studies))]
    rows = devices_table(to)
    if len(rows) > 1:
        other = [r for r in rows if r[-1] != "yes"]  # and the head
        text = f"{DEVICES} has all {len(rows) - 1}, and which solver is first in each."
        out.append(section("devices", "Devices", ("Orders and verdicts that are the same", devices_sentence(to, rows), devices_summary(rows)), ("Orders and verdicts that differ", text, other)))
    return out


def finish(to, listing, template, document):
    """Writes page, list and documents; says what a check will refuse."""
    write_page(to / "index.html", template, document)
    rows = devices_table(to)
    if len(rows) > 1:
        with open(to / DEVICES, "w", encoding="utf-8", newline="") as f:
            csv.writer(f, lineterminator="\n").writerows(rows)
    seal(to, listing)
    for fault in faults_of(to, []):
        print(f"warning: {fault}; --check will refuse it", file=sys.stderr)
    print(f"{to}: {len(listing['studies'])} studies, {len(listing['results'])} result files, page of {(to / 'index.html').stat().st_size / 1e6:.1f} MB")


def publish(folders, to, work):
    parts = parts_of(folders)
    if "penetration" not in parts and "software-penetration" in parts:  # verdicts without times may come from any device
        parts["penetration"] = parts.pop("software-penetration")
    if not parts:
        sys.exit(f"{folders[0]}: no finished part; scripts/reference.sh {folders[0]} makes them")
    shutil.rmtree(to, ignore_errors=True)
    to.mkdir(parents=True)
    documents, files = tables_of(parts, to, work)
    listing = listing_of(parts, to, files)
    template = report(motions_of(parts) or [p[0] for p in list(parts.values())[-1]], work / "motions")
    shown = {g: d for g, d in documents.items() if not g.startswith((*OTHERS, "repeat"))}
    finish(to, listing, template, merged(shown, document_of(template), sections_of(to, listing), head_of(listing), {s["group"]: s["title"] for s in data("studies.json")}))


def add(folders, to, work):
    """Adds the parts of another device to what is published; of the page only the sections of all studies change."""
    before = listing_at(to)
    if faults := changed_files(to, before):
        sys.exit("\n".join(faults))
    parts = parts_of(folders)
    for group in parts:
        if not group.startswith(OTHERS):
            sys.exit(f"{group}: expected parts of another device, made with --second; --report makes a study anew")
        if group in before["studies"]:
            sys.exit(f"{to / group}: is published already; --report makes a study anew")
    try:
        listing = listing_of(parts, to, tables_of(parts, to, work)[1], before)
    except SystemExit:
        for group in parts:
            shutil.rmtree(to / group, ignore_errors=True)
        raise
    template = (to / "index.html").read_text(encoding="utf-8")
    document = document_of(template)
    document["headline"] = head_of(listing)
    document["sections"] = sections_of(to, listing) + [s for s in document["sections"] if s["id"] not in ("claims", "studies", "devices")]
    finish(to, listing, template, document)


def seal(to, listing):
    """Writes README.md beside the folder, and the list with the hashes of all that is published."""
    (to.parent / "README.md").write_text(readme(to, listing), encoding="utf-8")
    if to == PUBLISHED:
        for document, text in texts_of(to).items():
            document.write_text(text, encoding="utf-8")
    listing["published"] = {f.relative_to(to).as_posix(): sha256(f) for f in sorted(to.rglob("*")) if f.is_file() and f.name != LIST}
    (to / LIST).write_text(json.dumps(listing, indent=1, sort_keys=True, ensure_ascii=False) + "\n", encoding="utf-8")


def listing_at(to):
    if not (to / LIST).exists():
        sys.exit(f"{to / LIST}: no such file; scripts/reference.sh --report OUT writes it")
    return json.loads((to / LIST).read_text(encoding="utf-8"))


def changed_files(to, listing):
    """What is not as it was written: a line for each file."""
    here = {f.relative_to(to).as_posix() for f in to.rglob("*") if f.is_file() and f.name != LIST}
    out = []
    for name, hashed in listing["published"].items():
        if name not in here:
            out.append(f"{to / name}: is missing; --report wrote it")
        elif sha256(to / name) != hashed:
            out.append(f"{to / name}: is not as --report wrote it")
    return out + [f"{to / name}: was not written by --report" for name in sorted(here - set(listing["published"]))]


def faults_of(to, folders):
    """What is wrong with what is published: a line each."""
    listing = json.loads((to / LIST).read_text(encoding="utf-8"))
    if out := changed_files(to, listing):
        return out
    facts = facts_of(to, listing["studies"])
    commits, sources = ({x for f in facts.values() for x in f[key]} for key in ("commits", "sources"))
    one_state = bool(listing.get("source_sha256")) and sources == {listing["source_sha256"]} and all(f["sources"] for f in facts.values())
    if commits != {listing["commit"]} and not one_state:
        out.append(f"{to}: results of the commits {', '.join(sorted(commits))}; expected one, {listing['commit']}, or one source_sha256")
    out += [f"{to / g}: {f['dirty']} runs are of a tree with local changes" for g, f in facts.items() if f["dirty"]]
    if (to.parent / "README.md").read_text(encoding="utf-8") != readme(to, listing):
        out.append(f"{to.parent / 'README.md'}: not what the tables say; scripts/reference.sh --report writes it")
    if to == PUBLISHED:
        out += [f"{d}: a text between its marks is not what the tables say" for d, text in texts_of(to).items() if text != d.read_text(encoding="utf-8")]
    for folder in folders:
        for h5 in sorted(folder.glob("*/*.h5")):
            if listing["results"].get(h5.relative_to(folder).as_posix()) != sha256(h5):
                out.append(f"{h5}: is not the result that is published")
    return out


def check(to, folders):
    listing = listing_at(to)
    faults = faults_of(to, folders)
    if faults:
        print("\n".join(faults), file=sys.stderr)
        return 1
    commit = listing["commit"]
    changed = changed_since(commit, listing.get("source_sha256"))
    if changed == []:
        print(f"{to}: as published, measured at {commit[:12]}; nothing that may change a figure has changed since")
        return 0
    what = "the commit is not known here" if changed is None else f"{len(changed)} files have changed since, such as {changed[0]}"
    print(f"{to}: as published, measured before this change ({commit[:12]}; {what})")
    return 4


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    what = arguments.add_mutually_exclusive_group(required=True)
    for name in ("report", "add", "check"):
        what.add_argument(f"--{name}", action="store_true")
    arguments.add_argument("folder", nargs="*", type=pathlib.Path)
    arguments.add_argument("--to", type=pathlib.Path, default=PUBLISHED)
    arguments.add_argument("--work", type=pathlib.Path, help="keep the reports of the studies there")
    a = arguments.parse_args()
    folders = [f.resolve() for f in a.folder]
    for f in folders:
        if not f.is_dir():
            arguments.error(f"{f}: no such folder")
    if a.check:
        return check(a.to, folders)
    if not folders:
        arguments.error("--report and --add: expected a folder of results")
    with tempfile.TemporaryDirectory() as scratch:
        (add if a.add else publish)(folders, a.to.resolve(), a.work or pathlib.Path(scratch))
    return 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Runs the shell commands of each document in order, in a copy of the tree; each command runs unchanged or in a short form.

usage: run_commands.py CLOTHBENCH NULL_XR_RUNTIME.json [--only PREFIX] [--except PREFIX] [--times]

CLOTHBENCH must be in its build folder. commands.txt gives the short forms, and the commands that a stage of CI runs. A document marks
commands that need hardware, the network or root. Prints one line per fault and exits with 1.
"""
import argparse
import collections
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from documents import ROOT, all_commands, tracked

TABLE = Path(__file__).with_name("commands.txt")
MOST_SECONDS = 60  # maximum for one command
# Files that no documented command reads; the published results are large and used only in their own documents.
ASIDE = re.compile(r"^(tests/|results/reference/.*\.(?!md$)\w+$)")
ASIDE_OF_RESULTS = re.compile(r"^tests/")
SHELL = """
shopt -s expand_aliases
set -o pipefail
ended() { echo "$1 $2 $EPOCHREALTIME" >>"$ENDED"; [ "$1" = 0 ] || exit "$1"; }
"""


def table():
    """Rows of commands.txt: command -> (kind, what)."""
    rows = {}
    lines = [line for line in TABLE.read_text(encoding="utf-8").splitlines() if line.strip() and not line.startswith("#")]
    for command, how in zip(lines[::2], lines[1::2]):
        match = re.match(r"    (=>|@) (.+)$", how)
        assert match and not command.startswith(" ") and command not in rows, f"{TABLE.name}: {command}"
        rows[command] = (match[1], match[2])
    return rows


def scripts_of_ci():
    """.ci/run and every script that it runs, directly or through another script."""
    found, new = set(), {".ci/run"}
    while new:
        name = new.pop()
        found.add(name)
        new |= {s for s in re.findall(r"scripts/[\w.-]+\.sh", (ROOT / name).read_text(encoding="utf-8")) if (ROOT / s).exists()} - found
    return found


def stage_fault(what):
    name, words = what.split(": ", 1)
    if name not in scripts_of_ci():
        return f"{name} is not run by .ci/run"
    return None if words in (ROOT / name).read_text(encoding="utf-8") else f"{name} has no `{words}`"


def copy_of_tree(to, program, aside):
    for name in tracked():
        if not aside.match(name):
            (to / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, to / name)
    built = to / "build" / "release"
    built.mkdir(parents=True)
    (to / ".bin").mkdir()
    for link in (built / "clothbench", to / ".bin" / "clothbench"):
        link.symlink_to(program)
    if (program.parent / "web").exists():
        (built / "web").symlink_to(program.parent / "web")


def run_document(name, commands, arguments):
    """Runs (command, text) one after another in one shell; yields (command, seconds, fault)."""
    with tempfile.TemporaryDirectory(prefix="clothbench-documents-") as folder:
        tree = Path(folder) / "clothbench"
        copy_of_tree(tree, arguments.clothbench, ASIDE_OF_RESULTS if name.startswith("results/reference/") else ASIDE)
        script = SHELL + "".join(f"{text}\nended $? {k}\n" for k, (_, text) in enumerate(commands))
        environment = {**os.environ, "PATH": f"{tree}/.bin:{os.environ['PATH']}", "CLOTHBENCH_SCENARIOS": str(tree / "scenarios"),
                       "CLOTHBENCH_ASSETS": "procedural", "XR_RUNTIME_JSON": str(arguments.runtime),
                       "LC_ALL": "C.UTF-8", "ENDED": f"{folder}/ended"}
        start, log, ends = time.time(), Path(folder) / "log", Path(folder) / "ended"
        with open(log, "w", encoding="utf-8") as out:
            shell = subprocess.Popen(["bash", "-c", script], cwd=tree, env=environment, stdin=subprocess.DEVNULL, stdout=out, stderr=out,
                                     start_new_session=True)
            try:
                shell.wait(MOST_SECONDS * len(commands))
            except subprocess.TimeoutExpired:
                os.killpg(shell.pid, signal.SIGKILL)
        ended = ends.read_text().splitlines() if ends.exists() else []
        for k, (command, text) in enumerate(commands):
            status, _, at = ended[k].split() if k < len(ended) else ("no exit status", k, time.time())
            took, start = float(at) - start, float(at)
            fault = None
            if status != "0":
                fault = f"`{text}`: {status}\n" + log.read_text(encoding="utf-8", errors="replace")[-2000:]
            elif took > MOST_SECONDS:
                fault = f"`{text}`: {took:.0f} s; expected at most {MOST_SECONDS}; add a short form to {TABLE.name}"
            yield command, took, fault
            if status != "0":
                return


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("clothbench", type=lambda p: Path(p).resolve())
    parser.add_argument("runtime", type=lambda p: Path(p).resolve())
    parser.add_argument("--only", default="", help="run only documents whose names start with PREFIX")
    parser.add_argument("--except", dest="but", help="skip documents whose names start with PREFIX")
    parser.add_argument("--times", action="store_true")
    arguments = parser.parse_args()
    rows, used, faults = table(), set(), []
    counts = collections.Counter()
    to_run = collections.defaultdict(list)
    for command in all_commands():
        kind, what = rows.get(command.key, ("", ""))
        used.add(command.key)
        if command.mark:
            counts[f"needs {command.mark}"] += 1
            if kind:
                faults.append(f"{command.document}:{command.line}: marked as not to be run, but listed in {TABLE.name}")
        elif kind == "@":
            counts["run by a stage of CI"] += 1
            if fault := stage_fault(what):
                faults.append(f"{command.document}:{command.line}: {command.key}: {fault}")
        else:
            counts["run in a short form" if kind else "run as it stands"] += 1
            to_run[command.document].append((command, what or command.text))
    faults += [f"{TABLE.name}: no document has `{command}`" for command in rows.keys() - used]
    for name, commands in to_run.items():
        if not name.startswith(arguments.only) or (arguments.but and name.startswith(arguments.but)):
            continue
        for command, took, fault in run_document(name, commands, arguments):
            if arguments.times:
                print(f"{took:7.2f} s  {name}:{command.line}: {command.key[:90]}", flush=True)
            if fault:
                faults.append(f"{name}:{command.line}: {fault}")
    if sum(counts.values()) < 60:
        faults.append(f"{sum(counts.values())} commands found; there are more")
    print("\n".join(faults + [f"{sum(counts.values())} commands: " + ", ".join(f"{n} {kind}" for kind, n in counts.most_common())]))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())

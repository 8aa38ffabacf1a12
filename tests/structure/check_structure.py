#!/usr/bin/env python3
"""Checks what a reader relies on to find his way: includes go one way, files and functions stay short, the format is one.

    check_structure.py [--list]     --list: print every include between rooms, with a file that has it

Prints one line a fault and exits with 1; with 77 (skipped) where a needed program is missing and nothing else is wrong.
"""
import argparse
import ast
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

# A room may include those before it, and the public interface (include/clothbench); nothing after it.
ROOMS = ["base", "assets", "scenario", "truth", "metrics", "results", "runner", "report", "check", "studies", "render", "xr", "cli", "android"]
# A solver may include the public interface and base.
SOLVERS_MAY_INCLUDE = {"base", "clothbench"}

# Rooms that stand on one another below the command line and the apps.
APPS = {"cli", "render", "xr", "android"}
MOST_FLOORS = 7
# What the README of a room says of it: what belongs there, what it may include, how to add the thing that people add.
OF_A_ROOM = {"what belongs there": r"\*\*Belongs here:\*\*", "what it may include": r"\*\*May include:\*\*", "how to add to it": r"(\*\*Add |\*\*To (add|store|change) |## (How to add|Adding))"}

MOST_LINES_OF_A_FILE = 400
MOST_LINES_OF_A_FUNCTION = 60
# A table, row after row, and a macro that pmccabe takes for a function's head.
LONG_ON_PURPOSE = {"clothbench::metrics", "__attribute__"}


def files(*patterns):
    out = subprocess.run(["git", "-C", ROOT, "ls-files", "-z", "--", *patterns], capture_output=True, check=True, text=True).stdout
    return [f for f in out.split("\0") if f and (ROOT / f).exists()]


def includes(path):
    for line in (ROOT / path).read_text().splitlines():
        match = re.match(r'#include "([^/"]+)/', line)
        if match:
            yield match[1]


def wrong_includes(show):
    faults = []
    seen = {}
    for path in files("harness/*.cpp", "harness/*.hpp", "harness/*.in"):
        room = path.split("/")[1]
        if room not in ROOMS:
            continue
        for other in includes(path):
            if other != room and other in ROOMS:
                seen.setdefault((room, other), path)
                if ROOMS.index(other) > ROOMS.index(room):
                    faults.append(f"{path}: {room} may not include {other}, which stands above it")
    for path in files("solvers/*.cpp", "solvers/*.hpp"):
        for other in includes(path):
            if other in ROOMS and other not in SOLVERS_MAY_INCLUDE:
                faults.append(f"{path}: a solver may include the public interface and base, not {other}")
    floor = {}
    for room in ROOMS:
        floor[room] = 1 + max((floor[other] for other in floor if (room, other) in seen), default=0)
        if room not in APPS and floor[room] > MOST_FLOORS:
            faults.append(f"harness/{room}: stands on floor {floor[room]}; at most {MOST_FLOORS} below the command line and the apps")
    if show:
        print("floors: " + ", ".join(f"{room} {n}" for room, n in floor.items()))
        for (room, other), path in sorted(seen.items()):
            print(f"{room} -> {other}   {path}")
    return faults


def silent_readmes():
    for room in ROOMS:
        path = f"harness/{room}/README.md"
        text = (ROOT / path).read_text()
        for what, words in OF_A_ROOM.items():
            if not re.search(words, text):
                yield f"{path}: does not say {what} ({words})"


def long_files():
    product = files("harness/*", "solvers/*", "scripts/*.py", "scripts/*.sh", "scripts/*.mjs")
    code = (".cpp", ".hpp", ".h", ".glsl", ".comp", ".js", ".mjs", ".py", ".sh", ".cmake")
    for path in product:
        if not path.endswith(code):
            continue
        lines = len((ROOT / path).read_text().splitlines())
        if lines > MOST_LINES_OF_A_FILE:
            yield f"{path}: {lines} lines; at most {MOST_LINES_OF_A_FILE}"


def long_functions():
    sources = files("harness/*.cpp", "harness/*.hpp", "solvers/*.cpp", "solvers/*.hpp")
    # Columns: complexity twice, statements, first line, lines, file(line): name.
    out = subprocess.run(["pmccabe", *sources], cwd=ROOT, capture_output=True, text=True).stdout
    count = 0
    for line in out.splitlines():
        fields = line.split("\t")
        lines, place, name = int(fields[4]), *fields[5].split(": ", 1)
        count += 1
        if lines > MOST_LINES_OF_A_FUNCTION and name not in LONG_ON_PURPOSE:
            yield f"{place}: {name}: {lines} lines; at most {MOST_LINES_OF_A_FUNCTION}"
    if count < 1000:
        yield f"pmccabe found {count} functions; there are over a thousand"


def long_scripts():
    """Functions of Python, and of JavaScript by their first and last line, which the format puts in one column."""
    for path in files("harness/*.py", "scripts/*.py"):
        for node in ast.walk(ast.parse((ROOT / path).read_text())):
            if isinstance(node, ast.FunctionDef) and node.end_lineno - node.lineno >= MOST_LINES_OF_A_FUNCTION:
                yield f"{path}({node.lineno}): {node.name}: {node.end_lineno - node.lineno + 1} lines; at most {MOST_LINES_OF_A_FUNCTION}"
    for path in files("harness/*.js", "harness/*.mjs", "scripts/*.mjs"):
        first = 0
        for k, line in enumerate((ROOT / path).read_text().splitlines(), 1):
            if re.match(r"( {2})?(export )?(async )?(function\*? |(?!if|for|while|switch)\w+\(.*\) \{$)", line):
                first, head = k, line.strip()
            if re.match(r"( {2})?\}", line) and first and k - first >= MOST_LINES_OF_A_FUNCTION:
                yield f"{path}({first}): {head}: {k - first + 1} lines; at most {MOST_LINES_OF_A_FUNCTION}"
            if re.match(r"\}", line):
                first = 0


def long_shader_functions():
    """Functions of GLSL, whose first and last line begin in the first column."""
    for path in files("harness/*.comp", "harness/*.frag", "harness/*.vert", "harness/*.glsl", "solvers/*.comp", "solvers/*.glsl"):
        first = 0
        for k, line in enumerate((ROOT / path).read_text().splitlines(), 1):
            if match := re.match(r"\w+ (\w+)\(", line):
                first, name = k, match[1]
            if line.startswith("}") and first:
                if k - first >= MOST_LINES_OF_A_FUNCTION:
                    yield f"{path}({first}): {name}: {k - first + 1} lines; at most {MOST_LINES_OF_A_FUNCTION}"
                first = 0


def unformatted():
    sources = files("*.cpp", "*.hpp", "*.h")
    out = subprocess.run(["clang-format-14", "--dry-run", *sources], cwd=ROOT, capture_output=True, text=True).stderr
    names = sorted({line.split(":")[0] for line in out.splitlines() if "[-Wclang-format-violations]" in line})
    return [f"{name}: not formatted (clang-format-14 -i {name})" for name in names]


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--list", action="store_true")
    show = arguments.parse_args().list
    faults = wrong_includes(show) + list(silent_readmes()) + list(long_files()) + list(long_scripts()) + list(long_shader_functions())
    missing = [program for program in ("pmccabe", "clang-format-14") if not shutil.which(program)]
    if "pmccabe" not in missing:
        faults += long_functions()
    if "clang-format-14" not in missing:
        faults += unformatted()
    for fault in faults:
        print(fault)
    if faults:
        return 1
    if missing:
        print(f"skipped: no {', '.join(missing)}")
        return 77
    print("includes, lengths and format: as they should be")
    return 0


if __name__ == "__main__":
    sys.exit(main())

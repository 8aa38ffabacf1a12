#!/usr/bin/env python3
"""Copies tables of reports and of the program's registry into the documents that show them, and the registry's scalars into the scene schema.

usage: embed_tables.py [--check] [CLOTHBENCH]     default program: build/release/clothbench; --check: write nothing, fail if a file would change

A document marks such a table by a line of one of these forms before it and `<!-- end of table -->` after it:

    <!-- table of FILE#ANCHOR -->                        the Markdown table of FILE below the heading with this anchor
    <!-- table of FILE#ANCHOR: ROW, ROW -->              only its rows with this first key, or `ROW: …`
    <!-- table of `clothbench list metrics`: KEY, KEY -->   one row per object that has all these keys; `a.b` is key b of object a
"""
import json
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
TABLE = re.compile(r"(<!-- table of (?:`clothbench (?P<command>[^`]+)`|(?P<file>[^#`\n]+)#(?P<anchor>[\w-]+))(?:: (?P<what>.+?))? -->\n).*?(<!-- end of table -->)", re.S)
SCHEMA = "scenarios/schema/scene.schema.json"
program = ROOT / "build/release/clothbench"


def objects(command):
    return json.loads(subprocess.run([program, *command.split(), "--json"], check=True, capture_output=True).stdout)


def cell(value):
    text = "yes" if value is True else "" if value is False else ", ".join(map(str, value)) if isinstance(value, list) else str(value)
    return text.replace("|", "\\|")


def table_of_objects(command, keys):
    rows = []
    for one in objects(command):
        values = [one]
        for key in keys:
            value = one
            for part in key.split("."):
                value = value.get(part) if isinstance(value, dict) else None
            values.append(value)
        if None not in values:
            rows.append([f"`{values[1]}`", *map(cell, values[2:])])
    return "".join("| " + " | ".join(row) + " |\n" for row in [keys, ["---"] * len(keys), *rows])


def table_of_report(file, anchor, rows):
    """The table of a section, which its anchor names: the heading in small letters, without punctuation, with hyphens for spaces."""
    for section in re.split(r"^#+ ", (ROOT / file).read_text(encoding="utf-8"), flags=re.M)[1:]:
        heading, _, text = section.partition("\n")
        if re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") == anchor and (found := re.match(r"\n((?:\|.*\n)+)", text)):
            head, rule, *lines = found[1].splitlines(keepends=True)
            return head + rule + "".join(line for line in lines if not rows or line.split("|")[1].strip().split(":")[0] in rows)
    sys.exit(f"{file}: no table with the anchor #{anchor}")


def table(match):
    what = match["what"].split(", ") if match["what"] else []
    new = table_of_objects(match["command"], what) if match["command"] else table_of_report(match["file"], match["anchor"], what)
    return match[1] + "\n" + new + "\n" + match[match.re.groups]


def bounds(match):
    """The names that a scene's `expect` may bound, with their descriptions."""
    row = '        {}: {{"$ref": "#/definitions/bounds", "description": {}}}'
    return match[1] + ",\n".join(row.format(json.dumps(s["name"]), json.dumps(s["long_name"], ensure_ascii=False)) for s in objects("list scalars") if s["expect"]) + "\n" + match[2]


def embedded(name, text):
    return re.sub(r'("expect": \{.*?"outcome": [^\n]*\n).*?(      \}\n)', bounds, text, count=1, flags=re.S) if name == SCHEMA else TABLE.sub(table, text)


def main():
    global program
    check = "--check" in sys.argv
    program = next((a for a in sys.argv[1:] if a != "--check"), program)
    names = subprocess.run(["git", "-C", ROOT, "ls-files", "-z", "--", "*.md", SCHEMA], check=True, capture_output=True, text=True).stdout.split("\0")
    stale = []
    for path in (ROOT / name for name in names if name and (ROOT / name).exists()):
        before = path.read_text(encoding="utf-8")
        after = embedded(str(path.relative_to(ROOT)), before)
        if after != before:
            stale.append(str(path.relative_to(ROOT)))
            if not check:
                path.write_text(after, encoding="utf-8")
    if check and stale:
        sys.exit(f"{', '.join(stale)}: differs from the output of scripts/embed_tables.py; run it with this build's clothbench")
    print("; ".join(stale) or "all tables match their sources")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Copies tables of reports and of the program's registry into the documents that show them, and the registry's scalars into the scene schema.

usage: embed_tables.py [--check] [CLOTHBENCH]     default program: build/release/clothbench; --check: write nothing, fail if a file would change

A document marks such a table by a line of one of these forms before it and `<!-- end of table -->` after it:

    <!-- table of FILE#ANCHOR -->                        the Markdown table of FILE below the heading with this anchor
    <!-- table of FILE#ANCHOR: ROW, ROW, -COLUMN -->     only its rows with this first key, or `ROW: …`; without this column
    <!-- table of `clothbench list metrics`: KEY, KEY -->   one row per object that has all these keys; `a.b` is key b of object a,
        or of all objects of list a; `KEY?` may be missing; `KEY!`: then the schema's default. `FILES FILES` instead of a command: JSON (`path`: folder/file), rows of .tsv
"""
import csv
import json
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
TABLE = re.compile(r"(<!-- table of (?:`(?P<source>[^`]+)`|(?P<file>[^#`\n]+)#(?P<anchor>[\w-]+))(?:: (?P<what>.+?))? -->\n).*?(<!-- end of table -->)", re.S)
SCHEMA = "scenarios/schema/scene.schema.json"
DEFAULTS = dict(re.findall(r'"(\w+)": \{[^{}]*"default": ([\d.]+)', (ROOT / SCHEMA).read_text(encoding="utf-8")))
check = "--check" in sys.argv
program = next((a for a in sys.argv[1:] if a != "--check"), ROOT / "build/release/clothbench")


def objects(source):
    if source.startswith("clothbench "):
        return json.loads(subprocess.run([program, *source.split()[1:], "--json"], check=True, capture_output=True).stdout)
    found = []
    for path in (path for pattern in source.split() for path in sorted(ROOT.glob(pattern))):
        text, place = path.read_text(encoding="utf-8"), f"{path.parent.name}/{path.stem}"
        found += [{"path": place, **json.loads(text)}] if path.suffix == ".json" else csv.DictReader(text.splitlines(), delimiter="\t")
    return found or sys.exit(f"{source}: no such file")


def cell(value):
    text = "yes" if value is True else "" if value is False else ", ".join(map(cell, value)) if isinstance(value, list) else str(value)
    return (f"{value:.4g}" if isinstance(value, float) else text).replace("|", "\\|")


def find(value, key):
    for part in key.rstrip("?!").split("."):
        default = DEFAULTS.get(part) if key[-1] == "!" else None
        if isinstance(value, list):
            value = "; ".join(dict.fromkeys(cell(one.get(part, default)) for one in value if part in one or default)) or None
        else:
            value = value.get(part, default) if isinstance(value, dict) else None
    return "–" if value is None and key[-1] in "?!" else value


def table_of_objects(source, keys):
    rows = [[find(one, key) for key in keys] for one in objects(source)]
    rows = [[f"`{values[0]}`", *map(cell, values[1:])] for values in rows if None not in values] or sys.exit(f"{source}: no object has all of {keys}")
    last = [key.rstrip("?!").split(".")[-1] for key in keys]
    heads = [name if last.count(name) == 1 else key.rstrip("?!") for name, key in zip(last, keys)]
    return "".join("| " + " | ".join(row) + " |\n" for row in [heads, ["---"] * len(keys), *rows])


def table_of_report(file, anchor, what):
    """The table of a section, which its anchor names: the heading in small letters, without punctuation, with hyphens for spaces."""
    for section in re.split(r"^#+ ", (ROOT / file).read_text(encoding="utf-8"), flags=re.M)[1:]:
        heading, _, text = section.partition("\n")
        if re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") == anchor and (found := re.match(r"\n((?:\|.*\n)+)", text)):
            rows, wanted = [re.split(r"(?<!\\)\|", line) for line in found[1].splitlines()], [name for name in what if name[0] != "-"]
            kept = [k for k, name in enumerate(rows[0]) if f"-{name.strip()}" not in what]
            return "".join("|".join(row[k] for k in kept) + "\n" for n, row in enumerate(rows) if n < 2 or not wanted or row[1].strip().split(":")[0] in wanted)
    sys.exit(f"{file}: no table with the anchor #{anchor}")


def table(match):
    what = match["what"].split(", ") if match["what"] else []
    new = table_of_objects(match["source"], what) if match["source"] else table_of_report(match["file"], match["anchor"], what)
    return match[1] + "\n" + new + "\n" + match[match.re.groups]


def bounds(match):
    """The names that a scene's `expect` may bound, with their descriptions."""
    row = '        {}: {{"$ref": "#/definitions/bounds", "description": {}}}'
    return match[1] + ",\n".join(row.format(json.dumps(s["name"]), json.dumps(s["long_name"], ensure_ascii=False)) for s in objects("clothbench list scalars") if s["expect"]) + "\n" + match[2]


def embedded(name, text):
    return re.sub(r'("expect": \{.*?"outcome": [^\n]*\n).*?(      \}\n)', bounds, text, count=1, flags=re.S) if name == SCHEMA else TABLE.sub(table, text)


def main():
    names = subprocess.run(["git", "-C", ROOT, "ls-files", "-z", "--", "*.md", SCHEMA], check=True, capture_output=True, text=True).stdout.split("\0")
    stale = []
    for path in (ROOT / name for name in names if name and (ROOT / name).exists()):
        before = path.read_text(encoding="utf-8")
        if (after := embedded(str(path.relative_to(ROOT)), before)) != before:
            stale.append(str(path.relative_to(ROOT)))
            if not check:
                path.write_text(after, encoding="utf-8")
    print("; ".join(stale) or "all tables match their sources")
    sys.exit("these files differ from the output of scripts/embed_tables.py; run it with this build's clothbench" if check and stale else 0)


if __name__ == "__main__":
    main()

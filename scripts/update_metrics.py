#!/usr/bin/env python3
"""Writes the tables of metrics and scalars in documents and in the scene schema from the program's registry: the tables of
harness/metrics/REGISTRY.md and results/baselines/README.md between their markers, and the names under `expect` of
scenarios/schema/scene.schema.json. With --check nothing is written, and it fails if any of them is not so already.

usage: update_metrics.py [--check] [path of clothbench, default build/release/clothbench]
"""
import json
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


def table(*rows):
    head, *rest = ("| " + " | ".join(run.replace("|", "\\|") for run in r) + " |\n" for r in rows)
    return head + "|---" * len(rows[0]) + "|\n" + "".join(rest)


def names(words):
    return ", ".join(f"`{w}`" for w in words)


def metrics_table(metrics):
    return table(["metric", "unit", "defined for", "what it is", "file"],
                 *([f"`{m['name']}`" + (f" (version {m['version']})" if m["version"] > 1 else ""), m["units"], m["needs"], m["long_name"], f"`{m['source']}`"] for m in metrics))


def scalars_table(scalars):
    return table(["scalar", "unit", "what it is", "of", "in `expect`", "file"],
                 *([f"`{s['name']}`", s["units"], s["long_name"], names(s["of"]), "yes" if s["expect"] else "",
                    f"`{s['source']}`"] for s in scalars))


def gates_table(scalars):
    gates = {}  # scalars that one file holds by the same rule are one row
    for s in scalars:
        if "check" in s:
            gates.setdefault((s["check"]["slack"], s["check"]["why"]), []).append(s["name"])
    return table(["scalar", "fails if", "slack", "why"],
                 ["`expect.*`", "fail, and pass in the baseline", "none", "the scene's own verdict has its tolerance in the scene"],
                 *([names(of), "above baseline + slack", slack, why] for (slack, why), of in gates.items()))


def bounds(scalars):
    return ",\n".join(f'        {json.dumps(s["name"])}: {{"$ref": "#/definitions/bounds", "description": {json.dumps(s["long_name"], ensure_ascii=False)}}}'
                      for s in scalars if s["expect"]) + "\n"


def main():
    arguments = [a for a in sys.argv[1:] if a != "--check"]
    program = arguments[0] if arguments else ROOT / "build/release/clothbench"
    metrics, scalars = (json.loads(subprocess.run([program, "list", what, "--json"], check=True, capture_output=True).stdout) for what in ("metrics", "scalars"))
    marked = r"(<!-- {0} begin -->\n).*?(<!-- {0} end -->)"
    parts = (("harness/metrics/REGISTRY.md", marked.format("metrics"), metrics_table(metrics)),
             ("harness/metrics/REGISTRY.md", marked.format("scalars"), scalars_table(scalars)),
             ("results/baselines/README.md", marked.format("gates"), gates_table(scalars)),
             ("scenarios/schema/scene.schema.json", r'("expect": \{.*?"outcome": [^\n]*\n).*?(      \}\n)', bounds(scalars)))
    stale = []
    for file, pattern, new in parts:
        path = ROOT / file
        before = path.read_text(encoding="utf-8")
        text, count = re.subn(pattern, lambda m: m[1] + new + m[2], before, count=1, flags=re.S)
        if count != 1:
            sys.exit(f"{file}: its place for what the registry says is missing")
        if text != before:
            stale.append(file)
            if "--check" not in sys.argv:
                path.write_text(text, encoding="utf-8")
    if "--check" in sys.argv and stale:
        sys.exit(f"{', '.join(sorted(set(stale)))}: not as scripts/update_metrics.py makes it")
    print("; ".join(sorted(set(stale))) or "all as the registry says")


if __name__ == "__main__":
    main()

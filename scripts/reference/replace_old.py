#!/usr/bin/env python3
"""Replaces what was published before by the reference study, once: run it after scripts/reference.sh --report, then commit.

    scripts/reference/replace_old.py [--dry-run]

Writes results/reference/CHANGES.md (old and new figures), removes the old folders with what serves them alone, and changes the documents'
links and pictures. Removes itself and its data (results/reference/old.json).
"""
import json
import pathlib
import re
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
from figures import Tables, markdown  # noqa: E402

ROOT = HERE.parent.parent
REFERENCE = ROOT / "results/reference"
OLD = json.loads((REFERENCE / "old.json").read_text(encoding="utf-8"))


def expanded(entry):
    """The entry once for each combination of the values of its `each`."""
    out = [entry]
    for key, values in entry.get("each", {}).items():
        out = [{k: v.replace("{" + key + "}", str(value)) if isinstance(v, str) else v for k, v in e.items()} for e in out for value in values]
    return out


def changes():
    old, new = Tables(REFERENCE), Tables(REFERENCE / "h200")
    rows, same = [["figure", "old", "new", "new / old", "what has changed in between"]], 0
    for entry in OLD["figures"]:
        for e in expanded(entry):
            a, b = old.figure(e["old"]), new.figure(e["new"])
            if "old_of" in e:  # a share of two counts
                of_a, of_b = old.figure(e["old_of"]), new.figure(e["new_of"])
                a, b = (a / of_a if a is not None and of_a else None), (b / of_b if b is not None and of_b else None)
            ratio = b / a if a and b is not None else None
            noise = ratio is not None and abs(ratio - 1) <= e["noise"] or (a == b and a is not None)
            same += noise
            text = ["–" if v is None else f"{v:.4g}" for v in (a, b, ratio)]
            rows.append([e["figure"], *text, "within noise" if noise else e["why"] if b is not None else "not measured again" if a is not None else "was not measured"])
    head = ["# Published figures, before and now", "",
            f"The reference study replaces {len(OLD['folders'])} folders that were measured at several commits. The last column says what has changed "
            f"between the two for each figure that differs by more than noise ({same} of {len(rows) - 1} do not). It is no proof of a cause. Times are in seconds.", "",
            "The old folders are in the history of this repository, up to the commit before this file came.", ""]
    return "\n".join([*head, ""]) + markdown(rows) + "\n"


def change_text(path, pairs):
    text = before = (ROOT / path).read_text(encoding="utf-8")
    for old, new in pairs:
        text = text.replace(old, new)
    if text != before:
        (ROOT / path).write_text(text, encoding="utf-8")


def drop_unused_commands():
    """Rows of tests/documents/commands.txt whose command no document has any more."""
    table = ROOT / "tests/documents/commands.txt"
    documents = "\n".join(p.read_text(encoding="utf-8") for p in ROOT.rglob("*.md") if "build" not in p.parts)
    lines, out = table.read_text(encoding="utf-8").split("\n"), []
    at = lines.index("# results/baselines and results/reference")
    k = at
    while k < len(lines):
        row = [lines[k]]
        while k + 1 < len(lines) and lines[k + 1].startswith("    =>"):
            k += 1
            row.append(lines[k])
        k += 1
        if len(row) == 1 or row[0] in documents:
            out += row
    table.write_text("\n".join(lines[:at] + out), encoding="utf-8")


def main():
    if not (REFERENCE / "h200/reference.json").exists():
        sys.exit("results/reference/h200: nothing is published; first scripts/reference.sh --report OUT…")
    text = changes()
    if sys.argv[1:] == ["--dry-run"]:
        print(text)
        return
    (REFERENCE / "CHANGES.md").write_text(text, encoding="utf-8")
    for folder in OLD["folders"]:
        shutil.rmtree(REFERENCE / folder, ignore_errors=True)
    for file in OLD["files"]:
        (ROOT / file).unlink(missing_ok=True)
    for path, pairs in OLD["texts"].items():
        change_text(path, pairs)
    cmake = ROOT / "tests/results/CMakeLists.txt"
    cmake.write_text(re.sub(r"if\(EXISTS [^\n]*contact-h200\).*?endif\(\)\n", "", cmake.read_text(encoding="utf-8"), flags=re.S), encoding="utf-8")
    subprocess.run([sys.executable, str(ROOT / "scripts/update_readme.py")], check=True)
    subprocess.run([sys.executable, str(ROOT / "scripts/peers_tables.py"), str(REFERENCE / "h200"), str(ROOT / "solvers/plugin/PEERS.md")], check=True)
    drop_unused_commands()
    # The index names CHANGES.md, which is there now.
    sys.path.insert(0, str(HERE.parent))
    import reference
    reference.seal(reference.PUBLISHED, json.loads((reference.PUBLISHED / reference.LIST).read_text(encoding="utf-8")))
    for own in (REFERENCE / "old.json", pathlib.Path(__file__)):
        own.unlink()
    print("replaced; look at git status, run the tests of results and documents, and commit")


if __name__ == "__main__":
    main()

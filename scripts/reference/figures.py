"""Figures that texts and verdicts take from the stored tables of a reference study.

A figure is written as one line, `TAKE TABLE CONDITION… [: COLUMN [* FACTOR]]`:

    one table3/runs.csv scene=gravity-128-single solver=xpbd setting=default : fps_median

TABLE is a CSV file below the study's folder, or features.json. CONDITION is `column=value` or `column~expression` (re.search); spaces in
a value are written as `_`. TAKE is `one` (exactly one row must match), `min`, `max`, `median` of the column, or `count` of the rows.
A figure that the tables do not have is None, never a number.
"""
import csv
import json
import re
import statistics

# Result files of the four set-ups of the paper and of the garments, whose motions the page shows.
SET_UPS = re.compile(r"^(gravity-32-single|desk-flat-low|desk-corner-low|capsule-sweep|hand-push|two-hand-stretch-2mps|sleeve|t-shirt|skirt|tablecloth)__(?!ballistic)[^_]+__(default|whole-room)\.h5$")


class Tables:
    """The tables below a folder, read once each; with a prefix, those of the studies whose names begin with it."""

    def __init__(self, folder, prefix=""):
        self.folder = folder
        self.prefix = prefix
        self.read = {}

    def rows(self, name):
        """Rows of a table as dictionaries of text; none if the file is missing."""
        if name not in self.read:
            path = self.folder / (self.prefix + name)
            if not path.exists():
                self.read[name] = []
            elif path.suffix == ".json":
                features = json.loads(path.read_text(encoding="utf-8"))
                self.read[name] = [{"name": f["name"], "solver": s, "value": v} for f in features for s, v in f["solvers"].items()]
            else:
                with open(path, encoding="utf-8", newline="") as f:
                    self.read[name] = list(csv.DictReader(f))
        return self.read[name]

    def figure(self, line):
        """The number that `line` names, or None."""
        head, _, column = line.partition(" : ")
        take, table, *conditions = head.split()
        column, _, factor = (part.strip() for part in column.partition("*"))
        tests = []
        for c in conditions:
            key, sign, value = re.fullmatch(r"([\w.]+)([=~])(.*)", c).groups()
            tests.append((key, sign, value.replace("_", " ") if sign == "=" and key == "setting" else value))
        all_rows = self.rows(table)
        for key in [t[0] for t in tests] + ([column] if column else []):
            if all_rows and key not in all_rows[0]:
                return None
        rows = [r for r in all_rows if all(r[k] == v if s == "=" else re.search(v, r[k]) for k, s, v in tests)]
        if not all_rows:
            return None
        if take == "count":
            return len(rows)
        values = [float(factor or 1) * float(r[column]) for r in rows if r[column] not in ("", "–")]
        if not values or (take == "one" and (len(rows) != 1 or len(values) != 1)):
            return None
        return {"one": lambda v: v[0], "min": min, "max": max, "median": statistics.median}[take](values)


def holds(rule, values):
    """Whether an expression over the figures is true. It is the repository's own data; a NaN makes every comparison false."""
    return bool(eval(rule, {"__builtins__": {}, "abs": abs, "min": min, "max": max}, dict(values)))


def statement(tables, entry):
    """(text with its figures filled in, whether its rule holds); (None, None) if a figure or what the entry needs is missing."""
    values = {name: tables.figure(line) for name, line in entry.get("figures", {}).items()}
    if any(v is None for v in values.values()) or not holds(entry.get("needs", "True"), values):
        return None, None
    try:
        return entry["text"].format(**values), holds(entry["rule"], values) if "rule" in entry else None
    except ZeroDivisionError:
        return None, None


VERDICTS = {True: "reproduced", False: "not reproduced", None: "cannot be tested here"}


def claims_table(tables, claims):
    """Rows of the claims: number, claim, verdict, what shows it."""
    rows = [["", "claim", "verdict", "what shows it"]]
    for c in claims:
        if "untestable" in c:
            rows.append([c["id"], c["claim"], VERDICTS[None], c["untestable"]])
            continue
        text, verdict = statement(tables, c)
        rows.append([c["id"], c["claim"], VERDICTS[verdict], text or "The results lack a figure that this needs."])
    return rows


def markdown(rows):
    """A Markdown table of rows of text; the first row is the head."""
    lines = ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join([lines[0], "|" + "---|" * len(rows[0]), *lines[1:]])

"""The page of a reference study: the documents of all studies' pages in one."""
import json
import re
import sys

PAGE_LIMIT_B = 20_000_000
FIGURES_OF = {"penetration": ("penetration", "meshes"), "work": ("work-precision",), "maps": ("stability",), "cases": ("stability",)}
SHARED = ("environment", "failed", "expect")  # one section of all studies
DOCUMENT = re.compile(r'(<script type="application/json" id="clothbench-data">)(.*?)(</script>)', re.S)


def document_of(page):
    return json.loads(DOCUMENT.search(page)[2])


def section(name, title, *tables):
    """A section of tables, each (title, note, rows of text)."""
    plain = lambda rows: [[cell.replace("`", "") for cell in row] for row in rows]  # the page's cells are text, not Markdown
    return {"id": name, "title": title, "tables": [{"title": t, "note": note, "rows": plain(rows)} for t, note, rows in tables]}


def title_of(study, title, alone):
    """The title of a section of a study; `alone`: it is the study's only one."""
    return study if alone or title == study else f"{study}: {title.removeprefix('Rates: ')}"


def in_order(sections, titles):
    """The sections, those of the studies of FIGURES_OF first: the page puts its figures into the first section of their kind."""
    leading = {titles[groups[0]] for groups in FIGURES_OF.values()}
    return sorted(sections, key=lambda s: s["title"] not in leading)


def merged(documents, motions, extra, head, titles):
    """One document of those of all studies, by group, under the line `head`; motions are those of `motions`, titles those of the groups."""
    out = dict(motions)
    sections, shared = [], {}
    for group, d in documents.items():
        study = titles.get(group, group)
        own = [s for s in d["sections"] if s["id"] not in SHARED and (s["id"] != "features" or group == "penetration") and (s["id"] != "material" or group == "moduli")]
        sections += [{**s, "title": title_of(study, s["title"], len(own) == 1)} for s in own]
        for s in (s for s in d["sections"] if s["id"] in SHARED):
            one = shared.setdefault(s["id"], {**s, "tables": []})
            one["tables"] += [{**t, "title": f"{study}: {t['title']}"} for t in s["tables"]]
    out["headline"] = head
    out["sections"] = extra + in_order(sections, titles) + list(shared.values())
    out["runs"] = sum(d["runs"] for d in documents.values())
    out["rates"] = [r for d in documents.values() for r in d["rates"]]
    out["commands"] = ["scripts/reference.sh"]
    for key, groups in FIGURES_OF.items():
        out[key] = [x for group in groups if group in documents for x in documents[group][key]]
    return out


def write_page(path, template, document):
    # "<" never stands in the data of a page.
    text = json.dumps(document, ensure_ascii=True, separators=(",", ":")).replace("<", "\\u003c")
    page = DOCUMENT.sub(lambda m: m[1] + text + m[3], template)
    if len(page) > PAGE_LIMIT_B:
        sys.exit(f"{path}: {len(page)} bytes; a page has at most {PAGE_LIMIT_B}")
    path.write_text(page, encoding="utf-8")

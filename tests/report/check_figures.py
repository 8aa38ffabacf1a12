"""Draws the figures of made-up reports with what the program carries and looks at the SVG: marks against the data, titles of
axes, words inside the picture, no number that is none. Exit 77 where there is no Node, or the build has no page.

usage: check_figures.py NODE FIGURES.cjs
"""
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as xml

NODE, SCRIPT = sys.argv[1:3]
SOLVERS = json.loads((pathlib.Path(__file__).parents[2] / "harness/report/solvers.json").read_text(encoding="utf-8"))
EMPTY = {"rates": [], "work": [], "penetration": [], "maps": [], "cases": [], "solvers": SOLVERS}
SVG = "{http://www.w3.org/2000/svg}"


def draw(**parts):
    """{name: SVG} and what shows them."""
    with tempfile.TemporaryDirectory(prefix="it's a report ") as folder:
        folder = pathlib.Path(folder)
        data = json.dumps(EMPTY | parts).replace("<", "\\u003c")
        page = folder / "index.html"
        page.write_text(f'<script type="application/json" id="clothbench-data">{data}</script><script>0</script>', encoding="utf-8")
        done = subprocess.run([NODE, SCRIPT, page, folder], capture_output=True, text=True, check=False)
        assert (done.returncode, done.stdout + done.stderr) == (0, ""), done.stderr
        out = {f.stem: f.read_text(encoding="utf-8") for f in sorted(folder.glob("*.svg"))}
        shown = (folder / "figures.md").read_text(encoding="utf-8")
    assert sorted(re.findall(r"^!\[[^\]]+\]\((\S+)\.svg\)$", shown, re.M)) == sorted(out), shown
    for name, text in out.items():
        look(name, text)
    return out, shown


def look(name, text):
    """What holds for every figure: for paper, and whole."""
    wrong = re.search(r".{80}(NaN|undefined|Infinity|null).{20}", re.sub(r' aria-label="[^"]*"', "", text))
    assert not wrong, f"{name}: {wrong[0]}"
    root = xml.fromstring(text)
    width, height = float(root.get("width")), float(root.get("height"))
    assert root[0].tag == SVG + "rect" and root[0].get("fill") == "#ffffff", f"{name}: not on white"
    unseen = {None, "none", "transparent", "#ffffff"}
    for group in root.iter(SVG + "g"):
        for symbol in group if "role-legend-symbol" in (group.get("class") or "") else []:
            assert {symbol.get("fill"), symbol.get("stroke")} - unseen, f"{name}: a symbol of the legend is not seen"
    for x, y, size, anchor, words in texts(root, 0, 0):
        reach = {"start": (0, 1), "middle": (0.5, 0.5), "end": (1, 0)}[anchor or "start"]
        left, right = (x - reach[0] * 0.5 * size * len(words), x + reach[1] * 0.5 * size * len(words))
        assert 0 <= left and right <= width and 0 <= y <= height, f"{name}: “{words}” is cut off"


def texts(node, x, y):
    """Upright words: place, size, anchor."""
    shift = re.match(r"translate\(([-\d.e]+),([-\d.e]+)\)", node.get("transform") or "")
    if "rotate" in (node.get("transform") or ""):
        return
    if shift:
        x, y = x + float(shift[1]), y + float(shift[2])
    if node.tag == SVG + "text" and float(node.get("opacity") or 1) > 0:
        size = float(re.search(r"[\d.]+", node.get("font-size") or "11")[0])
        yield x, y, size, node.get("text-anchor"), max(node.itertext(), key=len, default="")
    for child in node:
        yield from texts(child, x, y)


def marks(svg, name):
    """How many marks a layer has, over all panels."""
    count = 0
    for group in xml.fromstring(svg).iter(SVG + "g"):
        if re.search(rf" {name}(_\d+)?_marks$", group.get("class") or ""):
            count += sum(child.get("d") != "" for child in group)
    return count


def words(svg):
    return " ".join("".join(t.itertext()) for t in xml.fromstring(svg).iter(SVG + "text"))


def series(solver, sizes, sides="single", status="ok", gpu="Fake GPU (software; its times say nothing of a GPU)", **more):
    ok = status == "ok"
    return {"label": solver, "solver": solver, "setting": "default", "sides": sides, "points": [
        {"width": n, "resolution": f"{n}²", "status": status, "gpu": gpu, "fps": 1e4 / n if ok else None, "spread": 0.1 if ok else None,
         "device_s": 1e-5 * n if ok and gpu else None, "read_B_per_s": 1e7 * n if ok and gpu else None,
         "write_B_per_s": 4e6 * n if ok and gpu else None, "window_s": 0.5 if ok else None, "stretch_max": None, "stretch_mean": None} | more
        for n in sizes]}


def family(all_series, name="gravity", published=True):
    out = {"name": name, "paper_table": 3 if published else 0, "series": all_series}
    if published:
        out["published"] = [{"label": f"column {k}", "sides": "", "points": [{"width": n, "fps": 72} for n in (8, 16)]} for k in range(3)]
    return out


class Rates(unittest.TestCase):
    def setUp(self):
        self.series = [series(s, (8, 16, 32), sides) for s in ("paper", "xpbd") for sides in ("single", "double")]
        self.series += [series("bullet-soft", (8, 16, 32), gpu=""), series("ballistic", (8, 16, 32), gpu="", fps=1e6)]
        self.series += [series("other", (8,), status="diverged"), series("other", (16,), status="unsupported")]

    def test_every_run_is_there(self):
        rates = [family([series("elsewhere", (8,))], "other", False), family(self.series)]
        svg, shown = draw(rates=rates)
        self.assertEqual(sorted(svg), ["fig4", "fig5"])
        self.assertEqual(marks(svg["fig4"], "points"), 5 * 3 + 3 * 2)
        self.assertEqual(marks(svg["fig4"], "failed"), 1, "failed runs are marked, unsupported ones not")
        for part in ("frames per second, uncapped", "vertices along one side", "software; its times say nothing of a GPU", "published: column 2",
                     "1,000,000", "double"):
            self.assertIn(part, words(svg["fig4"]))
        self.assertNotIn("elsewhere", words(svg["fig4"]), "Fig. 4 is of the paper's table")
        self.assertEqual(marks(svg["fig5"], "points"), 2 * 4 * 3)
        self.assertEqual(marks(svg["fig5"], "failed"), 2)
        for part in ("peak bandwidth [GB/s]", "read", "written", "Not known: bullet-soft, ballistic."):
            self.assertIn(part, words(svg["fig5"]))
        self.assertIn("peak over windows of 0.5 to 0.5 s", shown)
        self.assertEqual(draw(rates=rates)[0], svg, "the same data give another file")

    def test_some_alone(self):
        cpu = draw(rates=[family([s for s in self.series if s["solver"] == "bullet-soft"])])[0]
        self.assertEqual(sorted(cpu), ["fig4"], "bytes are known of GPU solvers alone")
        floor = draw(rates=[family([s for s in self.series if s["solver"] == "ballistic"], "hang", False)])[0]
        self.assertEqual(marks(floor["fig4"], "points"), 3, "alone, it is shown")
        self.assertNotIn("published", words(floor["fig4"]))
        failed = draw(rates=[family([series("other", (8,), status="diverged")], "x", False)])[0]
        self.assertEqual(marks(failed["fig4"], "failed"), 1)
        self.assertEqual(draw()[0], {})

    def test_stretch_against_time(self):
        settings = [series("xpbd", (32, 64), device_s=1e-4 * k, stretch_max=0.1 / k, stretch_mean=0.01 / k) | {"setting": f"s{k}"}
                    for k in (1, 2, 3)]
        svg = draw(rates=[family(settings, "hang", False)])[0]
        self.assertEqual(marks(svg["hang-stretch"], "points"), 3 * 2 * 2)
        for part in ("GPU time a frame [ms]", "stretch, last second [%]", "s3", "greatest", "mean"):
            self.assertIn(part, words(svg["hang-stretch"]))
        self.assertNotIn("hang-stretch", draw(rates=[family(settings[:1], "hang", False)])[0], "of one setting there is nothing to compare")


class Work(unittest.TestCase):
    def test_points_fronts_and_floors(self):
        def point(solver, k, status="ok", **more):
            ok = status == "ok"
            return {"solver": solver, "setting": f"s{k}", "status": status, "gpu": "Fake GPU", "wall_ms_per_s": 10.0 * k if ok else None,
                    "device_ms_per_s": 5.0 * k if ok else None, "error": 0.1 / k if ok else None, "on_front": ok} | more

        points = [point("xpbd", k) for k in (1, 2, 3)] + [point("xpbd", 9, error=1.0, on_front=False)]
        points += [point("paper", 1), point("paper", 2, "diverged", wall_ms_per_s=7.0), point("paper", 3, "diverged"), point("paper", 4, "over_budget")]
        points += [point("reference", 1, "unsupported")]
        diagram = {"scene": "a-scene", "ranking": "RMS distance / L", "space_error": 1e-3, "reference_uncertainty": 1e-9, "refused": "",
                   "not_ranked": {"paper": "softer than asked"}, "points": points}
        svg = draw(work=[diagram, diagram | {"scene": "none", "points": points[-1:]}])[0]
        one = svg["work-precision-a-scene"]
        for layer, count in {"points": 5, "front_points": 4, "failed": 1, "untimed": 1, "floors": 1, "not_distinguished": 1, "device_fronts": 2}.items():
            self.assertEqual(marks(one, layer), count, layer)
        for part in ("error: RMS distance / L", "[ms per simulated second]", "error of the mesh 1.0e-3", "paper: 2 of 4 failed, 1 of 4 not run.",
                     "reference: unsupported.", "paper is shown but not ranked: softer than asked.", "uncertainty 3.0e-9", "Fake GPU"):
            self.assertIn(part, words(one))
        self.assertIn("No run of this scene", words(svg["work-precision-none"]))
        mesh = diagram | {"scene": "a-scene-mesh", "grid_scene": "a-scene", "space_error": 2e-3, "points": points[:3]}
        drawn = draw(work=[diagram, mesh, mesh | {"scene": "alone-mesh", "grid_scene": "alone"}])[0]
        self.assertEqual(sorted(n for n in drawn if "beside" in n), ["work-precision-a-scene-beside-mesh"])
        both = drawn["work-precision-a-scene-beside-mesh"]
        for layer, count in {"points": 5 + 3, "front_points": 4 + 3, "floors": 2}.items():
            self.assertEqual(marks(both, layer), count, layer)
        for part in ("grid: a-scene", "mesh: a-scene-mesh", "error of the mesh 2.0e-3", "[ms per simulated second]", "those of a mesh against"):
            self.assertIn(part, words(both))


class Penetration(unittest.TestCase):
    def row(self, label, status="ok", frames=40, **amplitude):
        time = [k / 72 for k in range(frames)]
        return {"label": label, "solver": label.split()[0], "status": status, "failed_frame": -1 if status == "ok" else frames, "time_s": time,
                "metrics": {m: {"values": [a * max(0, math.sin(6 * t)) for t in time]} for m, a in amplitude.items()}}

    def test_panels_and_lines(self):
        rooms = [{"name": n, "rows": [self.row(s, contact_length_m=0.1 * k, depth_m=4.0 * k)
                                      for k, s in enumerate(("paper", "paper whole-room", "xpbd", "bullet-soft", "bullet-deformable"))]}
                 for n in ("desk-flat-low", "desk-corner-low")]
        sweep = [{"name": "sweep", "rows": [self.row("xpbd", contact_length_m=0.3, depth_m=0.002),
                                            self.row("paper", "not_finite", 9, contact_length_m=0.3, depth_m=0.05)]}]
        grip = [{"name": f"stretch-{k}", "rows": [self.row("xpbd", stretch_max=0.2)]} for k in range(4)]
        push = [{"name": "push", "rows": [self.row("bullet-soft"), self.row("ballistic", contact_length_m=9)]}]
        ups = {"rooms": rooms, "capsules": sweep, "grip": grip, "hand": push}
        svg = draw(penetration=[{"kind": k, "title": f"Set-up [{k}] <b>", "scenes": s} for k, s in ups.items()])[0]
        self.assertEqual(sorted(svg), ["penetration-capsules", "penetration-grip", "penetration-hand", "penetration-rooms"])
        self.assertEqual(marks(svg["penetration-rooms"], "lines"), 2 * 2 * 5)
        self.assertEqual(marks(svg["penetration-rooms"], "failed"), 0)
        for part in ("paper whole-room", "desk-corner-low", "contour [mm]", "depth [mm]", "time [s]"):
            self.assertIn(part, words(svg["penetration-rooms"]))
        self.assertEqual(marks(svg["penetration-capsules"], "failed"), 2, "a failed solver is marked in every panel")
        self.assertEqual(marks(svg["penetration-grip"], "lines"), 4)
        self.assertIn("No run of this set-up", words(svg["penetration-hand"]))
        alone = draw(penetration=[{"kind": "hand", "title": "A hand", "scenes": [{"name": "push", "rows": push[0]["rows"][1:]}]}])[0]
        self.assertEqual(marks(alone["penetration-hand"], "lines"), 1, "alone, it is shown")

    def test_a_name_is_no_path(self):
        self.assertEqual(list(draw(penetration=[{"kind": "../../x y", "title": "", "scenes": []}])[0]), ["penetration-..-..-x-y"])


class Stability(unittest.TestCase):
    def test_maps_and_cases(self):
        classes = ["ok"] + [f"F{k}" for k in range(4)]
        probes = [{"x": 10.0 ** k, "y": 1.0, "seed": 0, "status": "ok", "class": c, "grade": 0 if c == "ok" else 2, "frame": k, "message": "<b>"}
                  for k, c in enumerate(classes)]
        solver = {"solver": "xpbd", "setting": "8x4", "unsupported": False, "probes": probes, "largest": 1.0, "open": True,
                  "rows": [{"y": 1.0, "seeds": [{"last_good": 1.0, "first_bad": 1.1}, {"last_good": 2.0, "first_bad": 2.2}]},
                           {"y": 10.0, "seeds": [{"last_good": 0, "first_bad": 1}]}]}
        absent = {**solver, "solver": "reference", "setting": "default", "unsupported": True, "probes": [], "rows": [], "largest": None}
        one = {"name": "one", "title": "One map", "headline": "largest of all", "x": {"label": "step", "unit": "s"}, "y": {"label": "ratio", "unit": ""},
               "theory": [{"name": "explicit-limit", "label": "explicit", "points": [[1, 1], [2, 10]]}], "solvers": [solver, absent]}
        cases = [{"case": "S01", "solver": "xpbd", "stable": 2, "degraded": 1, "failed": 1}, {"case": "S02", "solver": "paper", "stable": 0, "degraded": 0, "failed": 3}]
        svg = draw(maps=[one, one | {"name": "two", "solvers": [absent]}], cases=cases)[0]
        self.assertEqual(sorted(svg), ["stability-cases", "stability-one", "stability-two"])
        text = svg["stability-one"]
        self.assertEqual([marks(text, n) for n in ("points", "theory", "boundary", "seeds")], [5, 1, 1, 1])
        for part in ("step [s]", "ratio", "xpbd 8x4: ≥ 1 s", "F2 strain beyond the load", "stable", "explicit", "One map"):
            self.assertIn(part, words(text))
        shapes = {re.sub(r"[-\d.e]+", "", p.get("d")) + p.get("fill") for g in xml.fromstring(text).iter(SVG + "g")
                  if (g.get("class") or "").endswith(" points_marks") for p in g}
        self.assertEqual(len(shapes), len(classes), "a colour and a symbol a class")
        self.assertIn("None of these solvers supports", words(svg["stability-two"]))
        self.assertEqual(marks(svg["stability-cases"], "points"), 4)
        for part in ("S02", "paper", "degraded", "share of runs"):
            self.assertIn(part, words(svg["stability-cases"]))


class Faults(unittest.TestCase):
    def test_one_line_says_why(self):
        with tempfile.TemporaryDirectory() as folder:
            bad = pathlib.Path(folder, "index.html")
            bad.write_text("no page", encoding="utf-8")
            for words_of in ([bad, folder], [bad.with_name("nothing"), folder]):
                done = subprocess.run([NODE, SCRIPT, *words_of], capture_output=True, text=True, check=False)
                self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)
                self.assertIn("figures: ", done.stderr)


if __name__ == "__main__":
    if not pathlib.Path(SCRIPT).exists() or NODE.endswith("NOTFOUND"):
        print("SKIPPED: no Node, or this build has no page")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])

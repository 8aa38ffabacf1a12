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
EMPTY = {"runs": [], "series": [], "solvers": SOLVERS}
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


def row(part, solver, **more):
    """A run as page.cpp describes it."""
    return {"part": part, "scene": "a-scene", "family": "gravity", "paper_table": 3, "published": False, "solver": solver, "setting": "default",
            "label": solver, "sides": "single", "set_up": "", "width": 8, "resolution": "8²", "status": "ok", "verdict": "–",
            "gpu": "Fake GPU (software; its times say nothing of a GPU)"} | more


def rates(solver, sizes, status="ok", gpu=True, **more):
    ok = status == "ok"
    out = []
    for n in sizes:
        out.append(row("rates", solver, width=n, resolution=f"{n}²", status=status, fps_median=1e4 / n if ok else None, fps_spread=0.1 if ok else None,
                       frame_device_median_s=1e-5 * n if ok and gpu else None, bandwidth_read_peak_B_per_s=1e7 * n if ok and gpu else None,
                       bandwidth_write_peak_B_per_s=4e6 * n if ok and gpu else None, bandwidth_window_s=0.5 if ok else None,
                       stretch_max_last_second=None, stretch_mean_last_second=None) | ({} if gpu else {"gpu": ""}) | more)
    return out


def published():
    return [row("rates", f"published: column {k}", width=n, resolution=f"{n}²", published=True, gpu="", fps_median=72, bandwidth_read_peak_B_per_s=None)
            for k in range(3) for n in (8, 16)]


class Rates(unittest.TestCase):
    def setUp(self):
        sizes = (8, 16, 32)
        self.rows = [r for s in ("paper", "xpbd") for sides in ("single", "double") for r in rates(s, sizes, sides=sides)]
        self.rows += rates("bullet-soft", sizes, gpu=False) + rates("ballistic", sizes, gpu=False, fps_median=1e6)
        self.rows += rates("other", (8,), "diverged") + rates("other", (16,), "unsupported")

    def test_every_run_is_there(self):
        elsewhere = rates("elsewhere", (8,), family="other", paper_table=0)
        svg, shown = draw(runs=elsewhere + published() + self.rows)
        self.assertEqual(sorted(svg), ["fig4", "fig5"])
        self.assertEqual(marks(svg["fig4"], "points"), 5 * 3 + 3 * 2)
        self.assertEqual(marks(svg["fig4"], "failed"), 1, "failed runs are marked, unsupported ones not")
        for part in ("frames per second, uncapped", "vertices along one side", "software; its times say nothing of a GPU", "published: column 2",
                     "1,000,000", "double"):
            self.assertIn(part, words(svg["fig4"]))
        self.assertNotIn("elsewhere", words(svg["fig4"]), "Fig. 4 shows the paper's table")
        self.assertEqual(marks(svg["fig5"], "points"), 2 * 4 * 3)
        self.assertEqual(marks(svg["fig5"], "failed"), 2)
        for part in ("peak bandwidth [GB/s]", "read", "written", "Not known: bullet-soft, ballistic."):
            self.assertIn(part, words(svg["fig5"]))
        self.assertIn("peak over windows of 0.5 to 0.5 s", shown)
        self.assertEqual(draw(runs=elsewhere + published() + self.rows)[0], svg, "the same data give another file")

    def test_some_alone(self):
        cpu = draw(runs=[r for r in self.rows if r["solver"] == "bullet-soft"])[0]
        self.assertEqual(sorted(cpu), ["fig4"], "bytes are known only of GPU solvers")
        floor = draw(runs=[r | {"paper_table": 0} for r in self.rows if r["solver"] == "ballistic"])[0]
        self.assertEqual(marks(floor["fig4"], "points"), 3, "alone, it is shown")
        self.assertNotIn("published", words(floor["fig4"]))
        failed = draw(runs=rates("other", (8,), "diverged"))[0]
        self.assertEqual(marks(failed["fig4"], "failed"), 1)
        self.assertEqual(draw()[0], {})

    def test_stretch_against_time(self):
        settings = [r for k in (1, 2, 3) for n in (32, 64)
                    for r in rates("xpbd", (n,), family="hang", paper_table=0, setting=f"s{k}", label=f"xpbd s{k}", frame_device_median_s=1e-4 * k,
                                   stretch_max_last_second=0.1 / k, stretch_mean_last_second=0.01 / k)]
        svg = draw(runs=settings)[0]
        self.assertEqual(marks(svg["hang-stretch"], "points"), 3 * 2 * 2)
        for part in ("GPU time per frame [ms]", "stretch, last second [%]", "s3", "max", "mean"):
            self.assertIn(part, words(svg["hang-stretch"]))
        self.assertNotIn("hang-stretch", draw(runs=settings[:2])[0], "with one setting there is nothing to compare")


class Work(unittest.TestCase):
    def test_points_fronts_and_floors(self):
        def point(solver, k, status="ok", **more):
            ok = status == "ok"
            return row("accuracy", solver, setting=f"s{k}", status=status, gpu="Fake GPU", wall_ms_per_s=10.0 * k if ok else None,
                       device_ms_per_s=5.0 * k if ok else None, error=0.1 / k if ok else None, not_ranked="softer than asked" if solver == "paper" else "",
                       ranking="RMS distance / L", space_error=1e-3, reference_uncertainty=1e-9, refused="") | more

        points = [point("xpbd", k) for k in (1, 2, 3)] + [point("xpbd", 9, error=1.0)]
        points += [point("paper", 1), point("paper", 2, "diverged", wall_ms_per_s=7.0), point("paper", 3, "diverged"), point("paper", 4, "over_budget")]
        points += [point("reference", 1, "unsupported")]
        svg = draw(runs=points + [points[-1] | {"scene": "none"}])[0]
        one = svg["work-precision-a-scene"]
        for layer, count in {"points": 5, "failed": 1, "failed_untimed": 1, "rules_y": 1, "rules_x": 1, "shade": 1, "lines": 4}.items():
            self.assertEqual(marks(one, layer), count, layer)
        for part in ("error: RMS distance / L", "[ms per simulated second]", "error of the mesh 1.0e-3", "paper: 2 of 4 failed, 1 of 4 not run.",
                     "reference: unsupported.", "paper is shown but not ranked: softer than asked.", "uncertainty 3.0e-9", "Fake GPU"):
            self.assertIn(part, words(one))
        self.assertIn("No run of this scene", words(svg["work-precision-none"]))


class Penetration(unittest.TestCase):
    def document(self, runs):
        """runs: [(scene, set_up, solver, status, frames, amplitudes)]"""
        rows, series = [], []
        for scene, set_up, label, status, frames, amplitudes in runs:
            time = [k / 72 for k in range(frames)]
            rows.append(row("contact", label.split()[0], label=label, scene=scene, set_up=set_up, status=status, verdict="pass" if status == "ok" else status))
            series.append({"run": len(rows) - 1, "time_s": time,
                           "metrics": {m: {"values": [a * max(0, math.sin(6 * t)) for t in time]} for m, a in amplitudes.items()}})
        return {"runs": rows, "series": series}

    def test_panels_and_lines(self):
        runs = [(scene, "rooms", s, "ok", 40, {"contact_length_m": 0.1 * k, "depth_m": 4.0 * k})
                for scene in ("desk-flat-low", "desk-corner-low") for k, s in enumerate(("paper", "paper fine", "xpbd", "bullet-soft", "bullet-deformable"))]
        runs += [("sweep", "capsules", "xpbd", "ok", 40, {"contact_length_m": 0.3, "depth_m": 0.002}),
                 ("sweep", "capsules", "paper", "not_finite", 9, {"contact_length_m": 0.3, "depth_m": 0.05})]
        runs += [(f"stretch-{k}", "grip", "xpbd", "ok", 40, {"stretch_max": 0.2}) for k in range(4)]
        runs += [("push", "hand", "bullet-soft", "ok", 40, {}), ("push", "hand", "ballistic", "ok", 40, {"contact_length_m": 9})]
        svg = draw(**self.document(runs))[0]
        self.assertEqual(sorted(svg), ["penetration-capsules", "penetration-grip", "penetration-hand", "penetration-rooms", "verdicts"])
        self.assertEqual(marks(svg["penetration-rooms"], "lines"), 2 * 2 * 5)
        self.assertEqual(marks(svg["penetration-rooms"], "failed"), 0)
        for part in ("paper fine", "desk-corner-low", "contour [mm]", "depth [mm]", "time [s]"):
            self.assertIn(part, words(svg["penetration-rooms"]))
        self.assertEqual(marks(svg["penetration-capsules"], "failed"), 2, "a failed solver is marked in every panel")
        self.assertEqual(marks(svg["penetration-grip"], "lines"), 4)
        self.assertIn("No run of this scene has this metric", words(svg["penetration-hand"]))
        self.assertIn("fail", words(svg["verdicts"]))
        alone = draw(**self.document(runs[-1:]))[0]
        self.assertEqual(marks(alone["penetration-hand"], "lines"), 1, "alone, it is shown")

    def test_a_name_is_no_path(self):
        self.assertIn("penetration-..-..-x-y", draw(**self.document([("s", "../../x y", "xpbd", "missing", 9, {})]))[0])


class Stability(unittest.TestCase):
    def test_cases(self):
        cases = {("S01", "xpbd"): (2, 1, 1), ("S02", "paper"): (0, 0, 3)}
        runs = [row("stability", solver, case=case, grade=grade) for (case, solver), counts in cases.items() for grade, n in enumerate(counts) for _ in range(n)]
        svg = draw(runs=runs + [row("stability", "x", case="S03", grade=-1)])[0]
        self.assertEqual(sorted(svg), ["stability-cases"])
        self.assertEqual(marks(svg["stability-cases"], "points"), 4)
        for part in ("S02", "paper", "degraded", "share of runs"):
            self.assertIn(part, words(svg["stability-cases"]))
        self.assertNotIn("S03", words(svg["stability-cases"]))


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

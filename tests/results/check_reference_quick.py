"""The reference study in a quick form, whole: parts in two calls, report, check, page.

    check_reference_quick.py ROOT CLOTHBENCH
"""
import os
import pathlib
import subprocess
import sys
import tempfile

root, bench = pathlib.Path(sys.argv[1]), sys.argv[2]
script = str(root / "scripts/reference.sh")
PARTS = ["--table", "quick", "--part", "table3", "--part", "hang", "--part", "penetration", "--part", "repeat", "--part", "repeat-again"]


def call(*words):
    return subprocess.run([script, *map(str, words)], text=True, capture_output=True, env={**os.environ, "CLOTHBENCH": bench, "PYTHON": sys.executable})


with tempfile.TemporaryDirectory() as scratch:
    out, to = pathlib.Path(scratch) / "out", pathlib.Path(scratch) / "results/device"
    first = call(out, *PARTS, "--limit", 3)
    assert first.returncode == 75 and "call again to continue" in first.stdout, first
    kept = {f: f.stat().st_mtime_ns for f in out.glob("*/*.h5")}
    done = call(out, *PARTS)
    assert done.returncode == 0 and "complete" in done.stdout, done
    assert all(f.stat().st_mtime_ns == t for f, t in kept.items()), "a finished run was done again"
    assert call("--report", out, "--to", to).returncode == 0
    page = (to / "index.html").read_text(encoding="utf-8")
    assert "Claims of the paper" in page and 'id="blob-0"' in page and len(page) < 20_000_000
    checked = call("--check", out, "--to", to)
    # A developer's tree may have local changes; nothing else is wrong.
    assert checked.returncode in (0, 4) or all("local changes" in line for line in checked.stderr.splitlines()), checked
    # Another device's parts join what is published, once; the rest stays as it is.
    other, before = pathlib.Path(scratch) / "second", (to / "table3/runs.csv").read_bytes()
    refused = call("--add", out, "--to", to)
    assert refused.returncode == 1 and "expected parts of another device" in refused.stderr, refused
    assert call(other, "--table", "quick", "--part", "hang", "--second").returncode == 0
    added = call("--add", other, "--to", to)
    assert added.returncode == 0 and (to / "second-hang/runs.csv").exists() and (to / "table3/runs.csv").read_bytes() == before, added
    assert '"id":"devices"' in (to / "index.html").read_text(encoding="utf-8") and "## Devices" in (to.parent / "README.md").read_text(encoding="utf-8")
    twice = call("--add", other, "--to", to)
    assert twice.returncode == 1 and "is published already" in twice.stderr, twice
    checked = call("--check", out, other, "--to", to)
    assert checked.returncode in (0, 4) or all("local changes" in line for line in checked.stderr.splitlines()), checked
    readme = (to.parent / "README.md").read_text(encoding="utf-8")
    assert "## Hanging sheets: [hang](device/hang/report.md)" in readme and "## Repeated" in readme, readme
    assert call("--pack", out, pathlib.Path(scratch) / "packed").returncode == 0
    whole = b"".join(f.read_bytes() for f in sorted((pathlib.Path(scratch) / "packed").glob("part-*")))
    (pathlib.Path(scratch) / "again").mkdir()
    subprocess.run(["tar", "xz", "-C", str(pathlib.Path(scratch) / "again")], input=whole, check=True)
    assert call("--report", pathlib.Path(scratch) / "again", "--to", pathlib.Path(scratch) / "other/device").returncode == 0
    for table in ("table3/runs.csv", "penetration/penetration.md", "hang/report.md"):
        assert (to / table).read_bytes() == (pathlib.Path(scratch) / "other/device" / table).read_bytes(), table
print("ok")

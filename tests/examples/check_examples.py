"""usage: check_examples.py CLOTHBENCH MAKE_SAMPLE SOURCE: every script in scripts/examples answers the question in its docstring."""
import pathlib
import subprocess
import sys
import tempfile

CLOTHBENCH, MAKE_SAMPLE, SOURCE = sys.argv[1:4]
FOLDER = pathlib.Path(SOURCE, "scripts", "examples")
EXPECTED = {
    "fastest.py": ["gravity", "ballistic", " ms  ["],
    "accuracy.py": ["gravity", "free_fall_error"],
    "stages.py": ["sample__none", "'First': '100.0 us'", "'Second': '200.0 us'"],
    "over_time.py": [],
}

with tempfile.TemporaryDirectory() as home:
    run, sample = home + "/run", home + "/sample"
    words = ["run", "paper/gravity", "--solver", "ballistic", "--out", run]
    words += ["--set", "cloth.grid=[8,8]", "--set", "cloth.sides=single", "--set", "time.duration_s=1"]
    subprocess.run([CLOTHBENCH, *words], check=True, stdout=subprocess.DEVNULL, cwd=home)
    subprocess.run([MAKE_SAMPLE, sample], check=True, stdout=subprocess.DEVNULL)
    scripts = sorted(p.name for p in FOLDER.glob("[a-z]*.py"))
    assert scripts == sorted(EXPECTED), scripts
    readme = (FOLDER / "README.md").read_text(encoding="utf-8")
    for name in scripts:
        done = subprocess.run([sys.executable, FOLDER / name, run, sample], capture_output=True, text=True, check=False, cwd=home)
        assert done.returncode == 0, (name, done.stderr)
        for word in EXPECTED[name]:
            assert word in done.stdout, (name, word, done.stdout)
        assert f"`{name}`" in readme, name
        text = (FOLDER / name).read_text(encoding="utf-8")
        lines = [line for line in text.splitlines()[1:] if line.strip()]
        assert text.startswith('"""') and len(lines) <= 10, (name, len(lines), "ten lines below the question")
    assert pathlib.Path(home, "over_time.png").read_bytes()[1:4] == b"PNG"
print("all examples answer")

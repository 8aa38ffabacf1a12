"""What may change a figure: its hash, as harness/runner/build_info.cmake computes it for results, and what has changed since a commit."""
import hashlib
import pathlib
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
# Folders with what may change a figure.
MEASURED = [line for line in (ROOT / "scripts/reference/measured_paths.txt").read_text(encoding="utf-8").split("\n") if line and not line.startswith("#")]


def git(*words):
    return subprocess.run(["git", "-C", str(ROOT), *words], capture_output=True, text=True, check=False)


def source_sha256():
    """Of what may change a figure at HEAD, as harness/runner/build_info.cmake computes it."""
    listing = git("ls-tree", "-r", "HEAD", "--", *MEASURED).stdout.splitlines(keepends=True)
    return hashlib.sha256("".join(line for line in listing if not line.endswith(".md\n")).encode()).hexdigest()


def changed_since(commit, sources):
    """Files that may change a figure and differ between the commit and HEAD; None if this tree does not know the commit and its sources are
    others."""
    if sources and sources == source_sha256():
        return []
    if git("cat-file", "-e", commit + "^{commit}").returncode != 0:
        return None
    done = git("diff", "--name-only", commit, "HEAD", "--", *MEASURED, ":(exclude)*.md")
    return done.stdout.split() if done.returncode == 0 else None

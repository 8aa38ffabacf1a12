#!/usr/bin/env python3
"""A copy of the results of scripts/reference.sh for the way to another machine.

    scripts/reference.sh --pack OUT TO [--no-motions] [PART…]

Writes TO/part-00, part-01, … of at most 15 MB each; `cat part-* | tar xz` unpacks them. With PARTs, only those. Motions that no table and no part of the page shows are left out, and comparisons of
motions of more than 6 MB. --no-motions leaves out all motions but those that tables compare: the page then shows those of the parts software-….
Needs h5py; PYTHON names the Python that has it.
"""
import json
import pathlib
import shutil
import sys
import tarfile
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from figures import SET_UPS  # noqa: E402

MOST_B = 15_000_000
LARGE_B = 6_000_000
COMPARED = ("feature-cost", "room")  # parts whose tables compare motions


def slim(source, to, whole):
    """A copy of a result file without its second views of the motion; without the motion itself unless `whole`."""
    import h5py
    with h5py.File(source) as a, h5py.File(to, "w", libver=("earliest", "v110")) as b:
        b.attrs.update(a.attrs)
        for name in a:
            if name == "trajectory" and not whole:
                a.copy("trajectory/time_s", b.create_group(name))
            elif name != "frames" and (name != "VTKHDF" or whole):
                a.copy(name, b)


def study_of(folder):
    manifest = folder / "study.json"
    return json.loads(manifest.read_text(encoding="utf-8")) if manifest.exists() else {}


def copy_part(part, to, motions):
    """The part's files; comparisons with a motion that is too large leave its study.json."""
    to.mkdir(parents=True)
    study = study_of(part)
    pairs = (study.get("definition") or {}).get("pairs", [])
    files = sorted(part.glob("*.h5"))
    large = {f.name.split("__")[0] for f in files if f.stat().st_size > LARGE_B}
    scenes = lambda pair: {pair.get("scene"), *((pair.get("with") or {}).get("scene") or [])}
    kept = [p for p in pairs if not scenes(p) & large]
    paired = set().union(*(scenes(p) for p in kept)) if kept else set()
    for file in files:
        scene = file.name.split("__")[0]
        slim(file, to / file.name, scene in paired or (motions and bool(SET_UPS.match(file.name))) or part.name.removeprefix("second-") in COMPARED)
    if pairs:
        study["definition"]["pairs"] = kept
    if study:
        (to / "study.json").write_text(json.dumps(study), encoding="utf-8")
    for file in part.glob("stability*.json*"):
        shutil.copy(file, to)


def pack(out, to, only, motions):
    to.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        copies = scratch / "copies"
        copies.mkdir()
        for path in sorted(out.iterdir()):
            if path.is_dir() and (not only or path.name in only):
                copy_part(path, copies / path.name, motions)
            elif path.is_file() and (not only or path.stem in only or path.name == "version"):
                shutil.copy(path, copies)
        whole = scratch / "all.tar.gz"
        with tarfile.open(whole, "w:gz", compresslevel=6) as tar:
            tar.add(copies, ".")
        with open(whole, "rb") as packed:
            pieces = 0
            while piece := packed.read(MOST_B):
                (to / f"part-{pieces:02}").write_bytes(piece)
                pieces += 1
    print(f"{to}: {pieces} files of at most 15 MB")


if __name__ == "__main__":
    if len(sys.argv) < 3 or not pathlib.Path(sys.argv[1]).is_dir():
        sys.exit(__doc__)
    names = sys.argv[3:]
    pack(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), [n for n in names if n != "--no-motions"], "--no-motions" not in names)

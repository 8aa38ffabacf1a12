#!/usr/bin/env python3
"""A copy of the results of scripts/reference.sh for the way to another machine.

    scripts/reference.sh --pack OUT TO

Writes TO/part-00, part-01, … of at most 15 MB each; `cat part-* | tar xz` unpacks them. Motions that no table and no part of the page shows are left out.
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
COMPARED = ("feature-cost", "room")  # parts whose tables compare motions


def slim(source, to, whole):
    """A copy of a result file; without its motion unless `whole`."""
    import h5py
    if whole:
        shutil.copy(source, to)
        return
    with h5py.File(source) as a, h5py.File(to, "w", libver=("earliest", "v110")) as b:
        b.attrs.update(a.attrs)
        for name in a:
            if name == "trajectory":
                a.copy("trajectory/time_s", b.create_group(name))
            elif name not in ("VTKHDF", "frames"):
                a.copy(name, b)


def pack(out, to):
    to.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        for file in sorted(p for p in out.rglob("*") if p.is_file() and p.suffix != ".xdmf" and ".part" not in str(p)):
            copy = scratch / file.relative_to(out)
            copy.parent.mkdir(parents=True, exist_ok=True)
            if file.suffix != ".h5":
                shutil.copy(file, copy)
                continue
            manifest = file.parent / "study.json"
            study = json.loads(manifest.read_text(encoding="utf-8")) if manifest.exists() else {}
            paired = file.name.split("__")[0] in json.dumps((study.get("definition") or {}).get("pairs", []))
            slim(file, copy, paired or bool(SET_UPS.match(file.name)) or file.parent.name in COMPARED)
        whole = to / "all.tar.gz"
        with tarfile.open(whole, "w:gz", compresslevel=6) as tar:
            tar.add(scratch, ".")
        with open(whole, "rb") as packed:
            pieces = 0
            while piece := packed.read(MOST_B):
                (to / f"part-{pieces:02}").write_bytes(piece)
                pieces += 1
        whole.unlink()
    print(f"{to}: {pieces} files of at most 15 MB")


if __name__ == "__main__":
    if len(sys.argv) != 3 or not pathlib.Path(sys.argv[1]).is_dir():
        sys.exit(__doc__)
    pack(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]))

#!/usr/bin/env python3
"""Packs what a device needs beside the program: scenarios/ and, where they were fetched, room and hand assets.

usage: pack_assets.py OUT [--assets FOLDER]

FOLDER is where scripts/fetch-assets.sh puts them (build/assets/node_modules); without it the device uses the procedural
stand-ins. OUT then holds scenarios/, assets/ and index.txt, one line per file: SHA-256 and path. SPIR-V and the published
values are inside the program already. The same input gives the same bytes. Old files in OUT are not removed; make_apk.py
packs only those that index.txt lists."""
import argparse
import hashlib
import pathlib

SOURCE = pathlib.Path(__file__).resolve().parent.parent.parent
# Files of the packages that harness/assets reads, and their licences.
PACKED = {
    "scenarios": ["**/*.json"],
    "assets": ["@iwer/sem/captures/*.json", "iwer/lib/device/configs/hand/*.js",
               "@webxr-input-profiles/assets/dist/profiles/generic-hand/*.glb", "@iwer/sem/package.json", "iwer/package.json",
               "@webxr-input-profiles/assets/package.json", "@iwer/sem/LICENSE*", "iwer/LICENSE*",
               "@webxr-input-profiles/assets/LICENSE*"],
}


def pack(out, assets):
    lines = []
    for name, folder in {"scenarios": SOURCE / "scenarios", "assets": assets}.items():
        files = sorted({p for pattern in PACKED[name] for p in folder.glob(pattern) if p.is_file()})
        print(f"packed {len(files)} files of {folder}")
        for file in files:
            content = file.read_bytes()
            target = out / name / file.relative_to(folder)
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(content)
            lines.append(f"{hashlib.sha256(content).hexdigest()} {target.relative_to(out).as_posix()}")
    (out / "index.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--assets", type=pathlib.Path, default=SOURCE / "build" / "assets" / "node_modules")
    arguments = parser.parse_args()
    pack(arguments.out, arguments.assets)

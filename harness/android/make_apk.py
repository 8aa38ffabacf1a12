#!/usr/bin/env python3
"""Packs, aligns, signs and verifies the APK with the SDK's build-tools or Debian's packages; no Gradle, no Java code.

usage: make_apk.py --library libclothbench_quest.so --assets FOLDER --out clothbench.apk [--also lib.so]... [--version V]

Tools: the newest $ANDROID_HOME/build-tools/*, else PATH (Debian: aapt zipalign apksigner default-jre-headless
android-framework-res). The key is $CLOTHBENCH_KEYSTORE (password in $CLOTHBENCH_KEYSTORE_PASSWORD, alias
androiddebugkey), else a debug key made beside the APK. If a tool is missing: exit code 3 and one line that names it."""
import argparse
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import zipfile

HERE = pathlib.Path(__file__).resolve().parent
MIN_SDK, TARGET_SDK = 29, 32
PAGE = 16384  # Android 15 and later may use 16 KiB pages
MISSING = 3


def missing(what):
    print(f"make_apk.py: {what}", file=sys.stderr)
    sys.exit(MISSING)


def in_sdk(kind, name):
    """The file `name` of the newest version in $ANDROID_HOME/<kind>; None if there is none."""
    number = lambda p: [int(n) for n in "".join(c if c.isdigit() else " " for c in p.parent.name).split()]
    found = sorted(pathlib.Path(os.environ.get("ANDROID_HOME", "/nowhere"), kind).glob("*/" + name), key=number)
    return str(found[-1]) if found else None


def find_tool(name):
    return in_sdk("build-tools", name) or shutil.which(name) or missing(
        f"{name} is neither in $ANDROID_HOME/build-tools nor on PATH (Debian: aapt zipalign apksigner default-jre-headless)")


def find_framework():
    debian = "/usr/share/android-framework-res/framework-res.apk"
    return in_sdk("platforms", "android.jar") or (debian if os.path.isfile(debian) else missing(
        "no $ANDROID_HOME/platforms/*/android.jar and no Debian android-framework-res"))


def run(*command, **options):
    done = subprocess.run(command, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, **options)
    if done.returncode != 0:
        sys.exit(f"make_apk.py: failed: {' '.join(command)}\n{done.stdout}")
    return done.stdout


def check_library(path):
    """Refuses a library that is no arm64 ELF with segments on 16 KiB pages (ELF-64: e_machine at 18, program headers by e_phoff)."""
    data = path.read_bytes()
    if data[:5] != b"\x7fELF\x02" or struct.unpack_from("<H", data, 18)[0] != 183:
        sys.exit(f"make_apk.py: {path}: not an arm64 ELF library")
    offset, = struct.unpack_from("<Q", data, 32)
    size, count = struct.unpack_from("<HH", data, 54)
    for k in range(count):
        kind, = struct.unpack_from("<I", data, offset + k * size)
        align, = struct.unpack_from("<Q", data, offset + k * size + 48)
        if kind == 1 and align % PAGE != 0:
            sys.exit(f"make_apk.py: {path}: a segment is aligned to {align} B; expected a multiple of {PAGE} (-Wl,-z,max-page-size={PAGE})")


def add_files(apk, libraries, assets):
    """Adds libraries (stored) and assets (compressed), in a fixed order with a fixed date."""
    with zipfile.ZipFile(apk, "a") as z:
        entries = [(f"lib/arm64-v8a/{l.name}", l, zipfile.ZIP_STORED) for l in libraries]
        packed = [line.split(" ", 1)[1] for line in (assets / "index.txt").read_text(encoding="utf-8").splitlines()]
        entries += [(f"assets/{name}", assets / name, zipfile.ZIP_DEFLATED) for name in sorted([*packed, "index.txt"])]
        for name, file, how in entries:
            info = zipfile.ZipInfo(name, (2020, 1, 1, 0, 0, 0))
            info.compress_type = how
            z.writestr(info, file.read_bytes())


def keystore(folder):
    """Returns the key's file and password."""
    given = os.environ.get("CLOTHBENCH_KEYSTORE")
    if given:
        return given, os.environ.get("CLOTHBENCH_KEYSTORE_PASSWORD", "android")
    file = folder / "debug.keystore"
    if not file.exists():
        run(find_tool("keytool"), "-genkeypair", "-keystore", str(file), "-storepass", "android", "-keypass", "android",
            "-alias", "androiddebugkey", "-dname", "CN=Debug", "-keyalg", "RSA", "-keysize", "2048", "-validity", "10000")
    return str(file), "android"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--library", type=pathlib.Path, required=True)
    parser.add_argument("--also", type=pathlib.Path, action="append", default=[])
    parser.add_argument("--assets", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--version", default="0.1.0")
    a = parser.parse_args()
    aapt2, zipalign, apksigner = find_tool("aapt2"), find_tool("zipalign"), find_tool("apksigner")
    framework = find_framework()
    if not (a.assets / "index.txt").is_file():
        sys.exit(f"make_apk.py: {a.assets}: expected packed assets (index.txt); run pack_assets.py")
    for library in [a.library, *a.also]:
        check_library(library)
    a.out.parent.mkdir(parents=True, exist_ok=True)
    unaligned, aligned = a.out.with_suffix(".unaligned"), a.out.with_suffix(".aligned")
    major, minor, patch = (int(n) for n in a.version.split("."))
    # Debian's aapt2 does not know <queries>, an element of API 30, but writes it correctly.
    run(aapt2, "link", "--warn-manifest-validation", "-o", str(unaligned), "--manifest", str(HERE / "AndroidManifest.xml"), "-I", framework,
        "--min-sdk-version", str(MIN_SDK), "--target-sdk-version", str(TARGET_SDK),
        "--version-code", str(major * 10000 + minor * 100 + patch + 1), "--version-name", a.version)
    add_files(unaligned, [a.library, *a.also], a.assets)
    # -p: page-aligned libraries, because the loader maps them.
    run(zipalign, "-f", "-p", "4", str(unaligned), str(aligned))
    run(zipalign, "-c", "-p", "4", str(aligned))
    file, password = keystore(a.out.parent)
    run(apksigner, "sign", "--ks", file, "--ks-key-alias", "androiddebugkey", "--ks-pass", f"pass:{password}", "--out", str(a.out), str(aligned))
    run(apksigner, "verify", "--min-sdk-version", str(MIN_SDK), str(a.out))
    for rest in (unaligned, aligned, a.out.with_suffix(".apk.idsig")):
        rest.unlink(missing_ok=True)
    print(f"{a.out}: {a.out.stat().st_size} B")


if __name__ == "__main__":
    main()

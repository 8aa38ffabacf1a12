"""Packs the APK and checks it with the tools that a user would use: badging, alignment, signature, contents, 16 KiB segments.

The library inside is the arm64-linux test build: a test of the packaging alone. With an NDK the real one is packed."""
import re
import zipfile

from device import *

apk = next((BUILD / n for n in ("clothbench.apk", "packaging-test-only.apk") if n == sys.argv[4]))
apk.unlink(missing_ok=True)
code, text = run(["cmake", "--build", BUILD, "--target", "clothbench_apk"])
if code != 0:
    for line in text.splitlines():
        if line.startswith("make_apk.py:") and "Debian" in line:
            skip(line)
    sys.exit(text)

sys.path.insert(0, str(SOURCE / "harness" / "android"))
import make_apk

aapt2, zipalign, apksigner = make_apk.find_tool("aapt2"), make_apk.find_tool("zipalign"), make_apk.find_tool("apksigner")
badging = must([aapt2, "dump", "badging", apk])
for wanted in ["package: name='org.clothbench.quest'", "sdkVersion:'29'", "targetSdkVersion:'32'",
               "uses-permission: name='com.oculus.permission.HAND_TRACKING'", "uses-permission: name='android.permission.HAND_TRACKING'",
               "uses-permission: name='com.oculus.permission.USE_SCENE'", "uses-permission: name='android.permission.SCENE_UNDERSTANDING_COARSE'",
               "launchable-activity: name='android.app.NativeActivity'", "uses-permission: name='android.permission.INTERNET'"]:
    assert wanted in badging, (wanted, badging)
# aapt2 also takes a "lib/" in an asset's path for an ABI's folder.
native = re.search(r"native-code: (.*)", badging).group(1)
assert "'arm64-v8a'" in native and not any(f"'{abi}'" in native for abi in ("armeabi-v7a", "x86", "x86_64")), native
assert "application-debuggable" not in badging, badging
manifest = must([aapt2, "dump", "xmltree", apk, "--file", "AndroidManifest.xml"])
for wanted in ["com.oculus.supportedDevices", "quest3", "android.intent.category.LAUNCHER", "com.oculus.intent.category.VR",
               "org.khronos.openxr.intent.category.IMMERSIVE_HMD", "org.khronos.openxr.runtime_broker", "com.oculus.vr.focusaware", "android.app.lib_name", "clothbench_quest"]:
    assert wanted in manifest, (wanted, manifest)
assert re.search(r"hasCode\(0x0101000c\)=false", manifest), manifest
assert re.search(r"extractNativeLibs\(0x010104ea\)=true", manifest), manifest
assert re.search(r"exported\(0x01010010\)=true", manifest), manifest
print("ok: manifest")

must([zipalign, "-c", "-p", "4", apk])
verified = must([apksigner, "verify", "-v", "--min-sdk-version", "29", apk])
assert "Verifies" in verified and re.search(r"v3[^:]*\): true", verified), verified
print("ok: aligned and signed")

with zipfile.ZipFile(apk) as z:
    names = z.namelist()
    assert [n for n in names if n.startswith("lib/")] == ["lib/arm64-v8a/libclothbench_quest.so"], names
    assert not any(n.endswith(".dex") for n in names), names
    index = z.read("assets/index.txt").decode().splitlines()
    packed = {"assets/" + line.split(" ", 1)[1] for line in index} | {"assets/index.txt"}
    assert packed == {n for n in names if n.startswith("assets/")}, packed
    assert "assets/scenarios/studies/table3.json" in packed
    with Folder() as folder:
        library = pathlib.Path(z.extract("lib/arm64-v8a/libclothbench_quest.so", folder))
        make_apk.check_library(library)
        needed = must(["readelf", "-d", library])
        assert "libhdf5" not in needed and "libpython" not in needed, needed
        symbols = must(["readelf", "--dyn-syms", "-W", library])
        exported = [l.split()[-1] for l in symbols.splitlines() if re.search(r"GLOBAL\s+DEFAULT\s+\d+\s", l)]
        assert exported == ["ANativeActivity_onCreate"], exported
        # Segments on 4 KiB pages and a library for another machine are refused.
        elf = bytearray(library.read_bytes())
        offset = int.from_bytes(elf[32:40], "little")
        loads = [offset + k * 56 for k in range(int.from_bytes(elf[56:58], "little")) if elf[offset + k * 56] == 1]
        for at, value in ((loads[0] + 48, (4096).to_bytes(8, "little")), (18, (62).to_bytes(2, "little"))):
            bad = bytearray(elf)
            bad[at:at + len(value)] = value
            library.write_bytes(bad)
            try:
                make_apk.check_library(library)
            except SystemExit:
                continue
            sys.exit(f"make_apk.check_library takes a library with byte {at} changed")
print(f"ok: {apk.name}, {len(names)} entries, {apk.stat().st_size} B")

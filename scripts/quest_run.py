#!/usr/bin/env python3
"""Runs the benchmark's app on a Quest from this computer: checks the headset and fixes its settings, starts the app, samples
frame rate, memory traffic, clocks and temperatures during the run, restores the settings, fetches the results and merges them.

  scripts/quest_run.py "study table3" --apk build/android-arm64/clothbench.apk

Exit codes: 0 ok, 1 the run failed or is not valid, 2 bad input, 3 no device, 130 interrupted. See scripts/quest/README.md.
"""
import argparse
import datetime
import json
import os
import posixpath
import shlex
import shutil
import signal
import subprocess
import sys
import time

from quest import formats, judge, samples
from quest.adb import Adb, find_adb
from quest.follow import PACKAGE, AppFailed, Follower
from quest.pins import OVR_METRICS, Pins, default_folder
from quest.problems import BadInput, Gone, Problem

DEVICE_FILES = f"/sdcard/Android/data/{PACKAGE}/files"
METRICS_FOLDER = f"/sdcard/Android/data/{OVR_METRICS}/files/CapturedMetrics"
ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def arguments(words):
    p = argparse.ArgumentParser(
        prog="quest_run.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    p.add_argument("command", nargs="?", default="study table3", help="command that the app runs (default: %(default)s)")
    p.add_argument("--apk", help="install this APK before the run")
    p.add_argument("--out", help="new folder for everything that is fetched; default results/runs/quest-<UTC>")
    p.add_argument("--serial", help="serial number of the headset, if several are plugged in")
    p.add_argument(
        "--cpu-level", type=int, default=4, choices=range(0, 6), help="default %(default)s; passthrough allows 3"
    )
    p.add_argument(
        "--gpu-level", type=int, default=4, choices=range(0, 6), help="default %(default)s; passthrough allows 2"
    )
    p.add_argument("--refresh-hz", type=float, default=72)
    p.add_argument("--any-model", action="store_true", help="accept models other than Quest 3")
    p.add_argument("--least-charge", type=float, default=30, metavar="PERCENT")
    p.add_argument(
        "--hottest", type=float, default=40, metavar="CELSIUS", help="greatest battery temperature at the start of a run (default %(default)s)"
    )
    p.add_argument("--timeout-s", type=float, default=4 * 3600)
    p.add_argument("--poll-s", type=float, default=5, help="time between two readings of battery and temperatures (default %(default)s)")
    p.add_argument("--settle-s", type=float, default=3, help="time after the app's start in which clocks may change (default %(default)s)")
    p.add_argument("--wait-s", type=float, default=60, help="time to wait for a headset that was unplugged (default %(default)s)")
    p.add_argument("--adb", help="path of adb; default: from PATH or $ANDROID_HOME")
    p.add_argument("--clothbench", default=os.path.join(ROOT, "build", "release", "clothbench"), help="path of clothbench, which imports the results")
    p.add_argument("--state", default=default_folder(), help="folder for the settings to restore")
    p.add_argument(
        "--restore", action="store_true", help="only restore the settings of a headset after a run that was cut off"
    )
    return p.parse_args(words)


def look(adb, a):
    """Model and state of the headset. Raises Problem if a run would not be valid or its results would not fit on it."""

    def prop(name):
        return adb.shell("getprop " + name).strip()

    seen = {
        "serial": adb.serial,
        "model": prop("ro.product.model"),
        "android": prop("ro.build.version.release"),
        "build": prop("ro.build.display.id"),
        "system": prop("ro.build.version.incremental"),
    }
    seen.update(
        formats.battery(adb.shell("dumpsys battery")),
        thermal_status=formats.thermal_status(adb.shell("dumpsys thermalservice", check=False)),
        free_B=formats.free_B(adb.shell("df -k /sdcard", check=False)),
    )
    if seen["model"] != "Quest 3" and not a.any_model:
        raise BadInput(
            f"{adb.serial} is a {seen['model'] or 'device without a model'}, not a Quest 3 (--any-model accepts it)"
        )
    if not (seen["level"] is not None and seen["level"] >= a.least_charge):
        raise Problem(f"battery at {seen['level']} %: at least {a.least_charge:g} % are needed (--least-charge)")
    if not (seen["temperature_C"] is not None and seen["temperature_C"] <= a.hottest):
        raise Problem(f"battery at {seen['temperature_C']} °C: let it cool to {a.hottest:g} °C (--hottest)")
    if seen["thermal_status"] not in (0, None):
        raise Problem(f"thermal status {seen['thermal_status']}: let the headset cool")
    if seen["free_B"] is not None and seen["free_B"] < 500e6:
        raise Problem(f"the headset's storage is full: {seen['free_B'] / 1e6:.0f} MB free, 500 MB are needed")
    return seen


def clock_offset_s(adb):
    """How far the device's clock is ahead of this computer's: the best of three, each good to half its own duration."""
    best = None
    for _ in range(3):
        before = time.time()
        reported = formats.number(adb.shell("date +%s.%N").strip())
        took = time.time() - before
        if reported is not None and (best is None or took < best[0]):
            best = (took, reported - (before + took / 2))
    return best[1] if best else 0.0


def listing(adb, folder):
    return {n for n in adb.shell(f"ls {folder}", check=False).splitlines() if n.endswith(".csv")}


def follow_app(adb, a, follower):
    """Starts the app and stays until it reported its result. Returns when it was started, by the device's clock."""
    adb.shell(f"am force-stop {PACKAGE}")
    follower.start_streams()
    started = time.time() + follower.offset_s
    reported = adb.shell(
        f"am start -W -n {PACKAGE}/android.app.NativeActivity -a android.intent.action.MAIN "
        f"-c android.intent.category.LAUNCHER --es args {shlex.quote(a.command)}",
        timeout=60,
    )
    if "Error" in reported:
        raise AppFailed("the app did not start: " + next(line for line in reported.splitlines() if "Error" in line))
    follower.until_result(started)
    return started


def pull(adb, source, into):
    os.makedirs(into, exist_ok=True)
    adb.call("pull", source, into, timeout=1800)
    return os.path.join(into, posixpath.basename(source.rstrip("/")))


def fetch(adb, a, follower, csv_before):
    """Results and OVR Metrics files -> (result folders, texts of the files)."""
    found, sources = [], []
    try:
        ledger = pull(adb, DEVICE_FILES + "/session.json", a.out)
        with open(ledger, encoding="utf-8") as text:
            sources = [c.get("out") for c in json.load(text)["commands"] if c.get("out")]
    except (Gone, OSError):
        raise
    except (Problem, ValueError, KeyError, AttributeError):  # a session that ended before it wrote one
        pass
    if not sources and follower.result and follower.result[1].rstrip("/") != DEVICE_FILES:
        sources = [follower.result[1]]
    for source in sources:
        found.append(pull(adb, source, os.path.join(a.out, "runs")))
    texts = []
    for name in sorted(listing(adb, METRICS_FOLDER) - csv_before):
        with open(
            pull(adb, f"{METRICS_FOLDER}/{name}", os.path.join(a.out, "ovr-metrics")),
            encoding="utf-8",
            errors="replace",
            newline="",
        ) as text:
            texts.append(text.read())
    return found, texts


def merge(a, seen, asked, follower, started, ended, enabled, texts, notes):
    """Writes samples.json; returns the reasons against the run."""
    vrapi = samples.vrapi_group(follower.vrapi)
    groups = [vrapi, samples.profiler_group(follower.profiler_samples()), samples.battery_group(follower.battery)]
    if follower.metrics and not follower.profiler_samples():
        notes.append("ovrgpuprofiler offered counters and reported none")
    # The longest is this run's: the tool may leave a stump of what ran before.
    groups += [samples.ovr_group(max(texts, key=len), enabled, not vrapi["time_unix_s"])] if texts else []
    reasons = judge.judge(groups, asked, started + a.settle_s, ended, follower.gaps)
    samples.write(os.path.join(a.out, "samples.json"), dict(seen, notes=notes), asked, groups, reasons)
    with open(os.path.join(a.out, "logcat.txt"), "w", encoding="utf-8") as out:
        out.write("".join(line + "\n" for line in follower.log))
    return reasons


def import_results(a, folders):
    if not (os.path.isfile(a.clothbench) and os.access(a.clothbench, os.X_OK)):
        print(
            f"no {a.clothbench}: turn the raw files into HDF5 with: clothbench import {' '.join(folders)} --samples {a.out}/samples.json"
        )
        return
    done = subprocess.run(
        [a.clothbench, "import", *folders, "--samples", os.path.join(a.out, "samples.json")], check=False
    )
    if done.returncode != 0:
        raise Problem(f"the import failed (exit status {done.returncode}); the raw files are in {', '.join(folders)}")


def metrics_offered(adb):
    """What ovrgpuprofiler can tell here, and what is missed."""
    ids = formats.metric_ids(adb.shell("ovrgpuprofiler -m", check=False))
    notes = []
    if not ids:
        notes.append("ovrgpuprofiler reported no metrics: no memory traffic")
    else:
        notes += [
            f"ovrgpuprofiler has no {name!r} here"
            for name in (formats.READ_TOTAL, formats.WRITE_TOTAL)
            if name not in ids
        ]
        if len(notes) == 2:
            notes.append(
                "only the share of time in which the bus was busy stands in for memory traffic"
                if "GPU % Bus Busy" in ids
                else "nothing tells of memory traffic"
            )
    for note in notes:
        print(f"  note: {note}")
    return ids, notes


def measure(adb, a, pins):
    """One run, from looking at the headset to the merged results. Returns the exit code."""
    seen = look(adb, a)
    print(
        f"{seen['model']} ({adb.serial}), {seen['build'] or seen['android']}, battery {seen['level']:g} %, {seen['temperature_C']:g} °C",
        flush=True,
    )
    if a.apk:
        adb.call("install", "-r", a.apk, timeout=300)
    if not adb.shell(f"pm path {PACKAGE}", check=False).strip():
        raise BadInput(f"{PACKAGE} is not installed: give --apk build/android-arm64/clothbench.apk")
    ids, notes = metrics_offered(adb)
    offset, csv_before = clock_offset_s(adb), listing(adb, METRICS_FOLDER)
    asked = {"cpu_level": a.cpu_level, "gpu_level": a.gpu_level, "refresh_hz": a.refresh_hz, "command": a.command}
    follower = Follower(adb, a, offset, ids)
    try:
        pins.apply(a.cpu_level, a.gpu_level, a.refresh_hz)
        enabled = time.time() + offset
        started = follow_app(adb, a, follower)
        ended = time.time() + offset
    except BaseException:
        try:
            adb.shell(
                f"am force-stop {PACKAGE}", check=False
            )  # what it finished is kept; the same command goes on with it
        except Gone:
            pass
        raise
    finally:
        stubbornly(lambda: (follower.stop_streams(), pins.restore(a.wait_s)))
    try:
        folders, texts = fetch(adb, a, follower, csv_before)
    except Problem:
        merge(a, seen, asked, follower, started, ended, enabled, [], notes)  # what was sampled is not on the headset
        raise
    if not texts:
        notes.append("no OVR Metrics file: the tool is not installed or wrote nothing")
        print(f"  note: {notes[-1]}")
    reasons = merge(a, seen, asked, follower, started, ended, enabled, texts, notes)
    if folders:
        import_results(a, folders)
    for reason in reasons:
        print(f"NOT VALID: {reason}")
    passed = follower.result[0]
    print(f"{'passed' if passed else 'FAILED'}{'' if not reasons else ', not valid'}: {a.out}")
    return 0 if passed and folders and not reasons else 1


def stubbornly(work):
    """Not to be interrupted: Ctrl-C is heard again afterwards."""
    before = {s: signal.signal(s, signal.SIG_IGN) for s in SIGNALS}
    try:
        work()
    finally:
        for s, handler in before.items():
            signal.signal(s, handler)


def interrupted(*_):
    # From here on only the way back matters, and it must not be cut off; each of its steps has a time limit.
    for s in SIGNALS:
        signal.signal(s, signal.SIG_IGN)
    print("quest_run: interrupted; putting the headset back as it was", file=sys.stderr, flush=True)
    raise KeyboardInterrupt


def run(a):
    adb = Adb(find_adb(a.adb), a.serial)
    adb.choose()
    pins = Pins(adb, a.state)
    if pins.pending():
        print(f"putting {adb.serial} back as it was before a run that was cut off", flush=True)
        stubbornly(lambda: pins.restore(a.wait_s))
    elif a.restore:
        print(f"nothing to restore on {adb.serial}")
    if a.restore:
        return 0
    stamp = datetime.datetime.now(datetime.timezone.utc).strftime("%Y%m%dT%H%M%SZ")
    a.out = a.out or os.path.join("results", "runs", "quest-" + stamp)
    if a.apk and not os.path.isfile(a.apk):
        raise BadInput(f"--apk {a.apk}: no such file")
    if os.path.exists(a.out) and os.listdir(a.out):
        raise BadInput(f"--out {a.out}: expected a new or empty folder")
    os.makedirs(a.out, exist_ok=True)
    if shutil.disk_usage(a.out).free < 500e6:
        raise Problem(f"--out {a.out}: expected 500 MB of free space")
    return measure(adb, a, pins)


def main(words=None):
    a = arguments(words)
    for s in SIGNALS:
        signal.signal(s, interrupted)
    try:
        return run(a)
    except KeyboardInterrupt:
        print("quest_run: interrupted. The app keeps every finished trial: the same command goes on", file=sys.stderr)
        return 130
    except Problem as e:
        print(f"quest_run: {e}", file=sys.stderr)
        return e.code
    except OSError as e:
        print(f"quest_run: {e.filename or ''}: {e.strerror or e}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())

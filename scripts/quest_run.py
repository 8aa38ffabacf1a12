#!/usr/bin/env python3
"""Runs clothbench's app on a Quest from a computer, and fetches and imports its results. See scripts/quest/README.md.

  scripts/quest_run.py run "study table3" | pull | restore

Exit codes: 0 ok, 1 the run failed or is not valid, 2 bad input, 3 no headset, 130 interrupted.
"""
import argparse
import base64
import contextlib
import datetime
import os
import pathlib
import re
import shlex
import shutil
import signal
import subprocess
import sys
import time

from quest import perfetto, samples

PACKAGE = "org.clothbench.quest"
FILES = f"/sdcard/Android/data/{PACKAGE}/files"
ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PROPERTIES = ("debug.oculus.cpuLevel", "debug.oculus.gpuLevel", "debug.oculus.refreshRate", "debug.oculus.clockStateLogLevel")
LOG = ("logcat", "-v", "epoch", "-T", "1", "-s", "clothbench", "VrApi", "XrPerformanceManager")
STAMP = datetime.datetime.now(datetime.timezone.utc).strftime("%Y%m%dT%H%M%SZ")
TRACE = "/data/misc/perfetto-traces/clothbench.pftrace"
TRACE_TIMEOUT_S = 300  # to write the rest of a trace, or to fetch it
# Output of adb if the headset is missing; a command that fails prints other text.
NO_ANSWER = re.compile("no devices|device offline|device ('.*' )?not found|error: closed|protocol fault|connection reset|cannot connect")


class Problem(Exception):
    """Ends the program with its text and this exit code; 3: the headset does not answer."""

    def __init__(self, text, code=1):
        super().__init__(text)
        self.code = code


class Stream:
    """A command that prints continuously."""

    def __init__(self, words):
        self.process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True)
        os.set_blocking(self.process.stdout.fileno(), False)
        self._rest = b""

    def take(self):
        """Returns the whole lines since the last call, with plain ends: `adb shell -tt` ends them in \\r\\r\\n."""
        *lines, self._rest = (self._rest + (self.process.stdout.read() or b"")).split(b"\n")
        return [line.decode("utf-8", "replace").replace("\r", "") for line in lines]

    def stop(self):
        self.process.kill()
        self.process.wait()


class Adb:
    """Runs adb commands on one headset."""

    def __init__(self, serial):
        self.program, self.serial = shutil.which("adb"), None
        if not self.program:
            raise Problem("adb: no such program on PATH; install the Android platform tools (Debian: adb)", 2)
        listed = samples.devices(self.call("devices", "-l"))
        ready = [d[0] for d in listed if d[1] == "device" and serial in (None, d[0])]
        if not ready:
            raise Problem(f"no headset {serial or ''} is ready; adb lists: {', '.join(f'{d[0]} {d[1]}' for d in listed) or 'nothing'}. Plug it in, enable developer mode, allow USB debugging", 3)
        if len(ready) > 1:
            raise Problem(f"several devices are ready; choose one with --serial: {', '.join(ready)}", 2)
        self.serial = ready[0]

    def words(self, *words):
        return [self.program, *(["-s", self.serial] if self.serial else []), *words]

    def call(self, *words, timeout=30, check=True):
        """What the command printed, with plain line ends. Raises Problem if the headset does not answer, or if the command fails and `check`."""
        try:  # a separate process group, so that Ctrl-C is handled here, not by adb
            done = subprocess.run(self.words(*words), stdin=subprocess.DEVNULL, capture_output=True, timeout=timeout, start_new_session=True, check=False)
        except subprocess.TimeoutExpired:
            raise Problem(f"adb {words[0]}: no answer in {timeout} s", 3) from None
        text, errors = (b.decode("utf-8", "replace").replace("\r", "") for b in (done.stdout, done.stderr))
        if done.returncode != 0 and NO_ANSWER.search(errors):
            raise Problem(f"the headset does not answer: {errors.strip()}", 3)
        if done.returncode != 0 and check:
            raise Problem(f"adb {' '.join(words)}: exit status {done.returncode}: {(errors + text).strip()}")
        return text

    def shell(self, command, timeout=30, check=True):
        return self.call("shell", command, timeout=timeout, check=check)


def listen(handler):
    for s in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(s, handler)


def set_properties(adb, values):
    for name, value in values.items():
        adb.shell(f"setprop {name} {shlex.quote(value)}")
        if (got := adb.shell("getprop " + name).strip()) != value:
            raise Problem(f"{name}: set to '{value}', reads '{got}'")


def restore(adb, before):
    adb.shell("am broadcast -a com.oculus.vrpowermanager.automation_disable")
    set_properties(adb, before)


@contextlib.contextmanager
def fixed_settings(adb, a):
    """Fixes clock levels and refresh rate while the block runs, and restores them, also after Ctrl-C."""
    before = {name: adb.shell("getprop " + name).strip() for name in PROPERTIES}
    try:
        set_properties(adb, dict(zip(PROPERTIES, (str(a.cpu_level), str(a.gpu_level), f"{a.refresh_hz:g}", "1"))))
        # Makes the headset count as worn while it lies on a desk.
        adb.shell("am broadcast -a com.oculus.vrpowermanager.prox_close")
        yield
    finally:
        listen(signal.SIG_IGN)  # each step below has a time limit
        try:
            adb.shell(f"am force-stop {PACKAGE}", check=False)
            restore(adb, before)
        except Problem as e:
            print(f"quest_run: the headset's settings are not restored ({e}); `quest_run.py restore` or a reboot of the headset resets them", file=sys.stderr)
        listen(signal.default_int_handler)


def start_hzdb(adb, into):
    """Starts a capture by Meta's hzdb. Returns two functions, which end the capture and fetch its file; None if hzdb is not installed or does not start. Its documentation does not say where `stop` puts the file, so several folders are searched."""
    program, name = shutil.which("hzdb"), f"clothbench-{STAMP}"
    if not program:
        return None

    def call(*words, timeout):
        words = [program, "--device", adb.serial, "perf", *words]
        return subprocess.run(words, cwd=into.parent, stdin=subprocess.DEVNULL, capture_output=True, timeout=timeout, check=False, start_new_session=True).stdout.decode("utf-8", "replace")

    try:
        pid = re.search(r"\bpid\b\W*(\d+)", call("start", "--mode", "custom", "--app", PACKAGE, "--output", name, timeout=30), re.I)
    except (OSError, subprocess.SubprocessError) as e:
        return print(f"quest_run: hzdb is not used: {e}", file=sys.stderr)

    def fetch():
        folders = [into.parent, *(pathlib.Path.home() / f for f in ("Documents", "Downloads"))]
        for file in [file for folder in folders for file in folder.glob(name + "*.pftrace")][:1]:
            shutil.move(file, into)

    return pid and (lambda: call("stop", pid[1], name, timeout=TRACE_TIMEOUT_S), fetch)


def start_perfetto(adb, into):
    """Starts a capture by the device's perfetto. Returns two functions like start_hzdb; None if perfetto offers no GPU counters or does not start."""
    try:
        source, ids = perfetto.offered(base64.b64decode(adb.shell("perfetto --query-raw | base64", check=False)))
    except ValueError:  # an old or different perfetto
        return None
    chosen = [ids[name] for name in samples.WANTED if name in ids]
    start = f"echo {shlex.quote(perfetto.config(source, chosen))} | perfetto --txt -c - --background -o {TRACE}"
    pid = "".join(re.findall(r"^\d+$", adb.shell(start, check=False), re.M)[:1]) if chosen else ""

    def fetch():
        adb.call("pull", TRACE, str(into), timeout=TRACE_TIMEOUT_S)
        adb.shell(f"rm -f {TRACE}")

    # The process writes the rest of the trace before it ends.
    return (lambda: adb.shell(f"kill {pid}; while kill -0 {pid} 2>/dev/null; do sleep 0.1; done", timeout=TRACE_TIMEOUT_S), fetch) if pid else None


@contextlib.contextmanager
def traced(adb, into):
    """Captures GPU counters while the block runs, as a Perfetto trace in the file `into`. Yields whether any are captured."""
    capture = start_hzdb(adb, into) or start_perfetto(adb, into)
    try:
        yield bool(capture)
    finally:
        listen(signal.SIG_IGN)  # each step has a time limit, and a capture that goes on would disturb the next run
        for step in capture or ():
            try:
                step()
            except (Problem, OSError, subprocess.SubprocessError) as e:  # the run's results do not depend on it
                print(f"quest_run: no counters: {e}", file=sys.stderr)
        listen(signal.default_int_handler)


class Run:
    """One run of the app. Collects its log and counters, with times of the device's clock."""

    def __init__(self, adb, command, timeout_s):
        self.adb, self.command, self.timeout_s = adb, command, timeout_s
        before = time.time()
        reported = samples.number(adb.shell("date +%s.%N").strip())
        if reported is None:
            raise Problem("the headset does not report its time (date +%s.%N)")
        # The device's clock minus this computer's, accurate to half the duration of the command.
        self.offset_s = reported - (before + time.time()) / 2
        self.vrapi, self.changes, self.log, self.counters, self.result = [], [], [], samples.Counters(), None

    def follow(self, is_traced):
        """Starts the app and returns when it has logged its result. Counters come from ovrgpuprofiler if nothing else traces them."""
        ids = {} if is_traced else samples.counter_ids(self.adb.shell("ovrgpuprofiler -m", check=False))
        chosen = ",".join(str(ids[name]) for name in samples.WANTED if name in ids)
        self.adb.shell(f"am force-stop {PACKAGE}")
        log = Stream(self.adb.words(*LOG))
        # -tt: a terminal, so that the profiler ends when the connection does.
        profiler = Stream(self.adb.words("shell", "-tt", f'ovrgpuprofiler -r"{chosen}"')) if chosen else None
        try:
            self.started = time.time() + self.offset_s
            said = self.adb.shell(f"am start -W -n {PACKAGE}/android.app.NativeActivity -a android.intent.action.MAIN --es args {shlex.quote(self.command)}", timeout=60)
            if "Error" in said:
                raise Problem(f"the app did not start: {said.strip()}")
            self._until_result(log, profiler)
        finally:
            [stream.stop() for stream in (log, profiler) if stream]

    def _until_result(self, log, profiler):
        missing, end, next_poll = 0, time.monotonic() + self.timeout_s, 0
        while self.result is None:
            if time.monotonic() > end:
                raise Problem(f"the app did not end within {self.timeout_s:g} s (--timeout-s)")
            if log.process.poll() is not None:
                raise Problem("the log ended: the headset was unplugged. The app goes on without the cable; fetch its results with `quest_run.py pull`", 3)
            if time.monotonic() >= next_poll:
                # The process may end shortly before its last log line arrives.
                missing = 0 if self.adb.shell(f"pidof {PACKAGE}", check=False).strip() else missing + 1
                next_poll = time.monotonic() + 1
            self._take(log, profiler)
            if self.result is None and missing >= 3:
                raise Problem("the app ended without a result: it crashed or was closed\n" + self.adb.call("logcat", "-b", "crash", "-d", "-t", "40", check=False))
            time.sleep(0.05)

    def _take(self, log, profiler):
        for line in log.take():
            stamp, tag, message = samples.logcat(line) or (0, "", "")
            self.log.append(line)
            if tag == "XrPerformanceManager" and (change := samples.level_change(message)):
                self.changes.append(change)
            if tag == "VrApi" and (values := samples.vrapi(message)):
                self.vrapi.append((stamp, {**values, "changes": self.changes}))
                self.changes = []
            if tag == "clothbench" and stamp >= self.started:
                print(f"  {message}", flush=True)
                self.result = samples.result(message) or self.result
        for line in profiler.take() if profiler else ():
            self.counters.feed(time.time() + self.offset_s, line)


def pull(adb, a, source, several=False):
    """Fetches a result folder, or a folder of `several`, and imports them as HDF5 files. Returns whether all trials are valid."""
    os.makedirs(a.out, exist_ok=True)
    adb.call("pull", source, a.out, timeout=1800)
    fetched = os.path.join(a.out, os.path.basename(source.rstrip("/")))
    folders = [entry.path for entry in os.scandir(fetched)] if several else [fetched]
    readings = os.path.join(a.out, "samples.json")
    options = ["--samples", readings] if os.path.exists(readings) else []
    code = subprocess.run([a.clothbench, "import", *folders, *options], check=False).returncode
    if code not in (0, 1):
        raise Problem(f"clothbench import failed; the CBOR files are in {fetched}")
    return code == 0


def run(adb, a):
    if not adb.shell(f"pm path {PACKAGE}", check=False).strip():
        raise Problem(f"{PACKAGE} is not installed: adb install build/android-arm64/clothbench.apk", 2)
    if a.gpu_level == 5:
        why = "CPU level 5 and GPU level 5 exclude each other" if a.cpu_level == 5 else "the headset grants it only with dynamic resolution, which this app lacks"
        raise Problem(f"--gpu-level 5: {why}; use 4", 2)
    if os.path.exists(a.out) and os.listdir(a.out):
        raise Problem(f"--out {a.out}: expected a new or empty folder", 2)
    os.makedirs(a.out, exist_ok=True)
    requested = {"cpu_level": a.cpu_level, "gpu_level": a.gpu_level, "refresh_rate": a.refresh_hz}
    device = {"serial": adb.serial, "asked": {**requested, "command": a.command}, "model": adb.shell("getprop ro.product.model").strip(), "build": adb.shell("getprop ro.build.display.id").strip()}
    folder = f"{FILES}/runs/{re.sub('[^A-Za-z0-9]+', '-', a.command)[:40]}-{STAMP}"
    one = Run(adb, f"{a.command} --out {folder}", a.timeout_s)
    trace = pathlib.Path(a.out, "counters.pftrace")
    with fixed_settings(adb, a), traced(adb, trace) as is_traced:
        one.follow(is_traced)
    try:
        counters = perfetto.samples(trace.read_bytes()) if is_traced else one.counters.samples
    except (OSError, ValueError) as e:
        counters = print(f"quest_run: no counters: {trace}: {e}", file=sys.stderr) or []
    samples.write(os.path.join(a.out, "samples.json"), device, samples.groups(one.vrapi, counters, "perfetto" if is_traced else "ovrgpuprofiler", requested))
    pathlib.Path(a.out, "logcat.txt").write_text("\n".join(one.log), encoding="utf-8")
    valid = pull(adb, a, folder)
    print(f"{one.result}{'' if valid else ', not valid'}: {a.out}")
    return 0 if one.result == "PASS" and valid else 1


def positive(text):
    value = samples.number(text)
    if not value or value < 0:
        raise argparse.ArgumentTypeError(f"'{text}': expected a number above 0")
    return value


def arguments():
    p = argparse.ArgumentParser(prog="quest_run.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--serial", help="serial number of the headset, if several are plugged in")
    p.add_argument("--clothbench", default=os.path.join(ROOT, "build/release/clothbench"), help="the program that imports the results")
    actions = p.add_subparsers(dest="action", required=True)
    actions.add_parser("restore", help="reset clock levels, refresh rate and proximity sensor to the headset's own")
    for name, what in (("run", "run one command, sample the headset, fetch and import the results"), ("pull", "fetch and import all results on the headset")):
        action = actions.add_parser(name, help=what)
        action.add_argument("--out", default=f"results/runs/quest-{STAMP}", help="folder for what is fetched (default results/runs/quest-<UTC>)")
    action = actions.choices["run"]
    action.add_argument("command", help="study, run or xr with its arguments: 'study table3'")
    action.add_argument("--cpu-level", type=int, default=4, choices=range(6), help="default %(default)s")
    action.add_argument("--gpu-level", type=int, default=4, choices=range(6), help="default %(default)s")
    action.add_argument("--refresh-hz", type=positive, default=72)
    action.add_argument("--timeout-s", type=positive, default=4 * 3600)
    return p.parse_args()


def main():
    a = arguments()
    listen(signal.default_int_handler)
    try:
        adb = Adb(a.serial)
        return {
            "pull": lambda: 0 if pull(adb, a, FILES + "/runs", several=True) else 1,
            "restore": lambda: restore(adb, dict.fromkeys(PROPERTIES, "")),
            "run": lambda: run(adb, a),
        }[a.action]() or 0
    except KeyboardInterrupt:
        print("quest_run: interrupted. The app keeps every finished trial: its log prints the command that continues", file=sys.stderr)
        return 130
    except Problem as e:
        print(f"quest_run: {e}", file=sys.stderr)
        return e.code


if __name__ == "__main__":
    sys.exit(main())

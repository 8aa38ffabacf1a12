"""Parsers of what a headset's tools print, and samples.json, which `clothbench import --samples` reads. Sources of the formats: README.md."""
import json
import math
import os
import re
import statistics

READ, WRITE = "Read Total (Bytes/sec)", "Write Total (Bytes/sec)"
# Counters of ovrgpuprofiler by name: their numbers are list positions, which differ between devices and systems.
WANTED = (READ, WRITE, "Clocks / Second", "GPU Frequency", "GPU % Bus Busy", "GPU % Utilization", "% Stalled on System Memory")
CLOCK_TOLERANCE = 0.02  # relative to the median: steps between clock levels are 8 % and more
# VrApi's line of every second: series -> (pattern, units, role in the summary, factor to the role's SI unit).
VRAPI = {
    "fps": (r"FPS=(\d+)/", "s-1", "fps", 1),
    "refresh_rate": (r"FPS=\d+/(\d+)", "s-1", "", 1),
    "cpu_level": (r"CPU\d*/GPU=(\d+)/", "1", "", 1),
    "gpu_level": (r"CPU\d*/GPU=\d+/(\d+)", "1", "", 1),
    "cpu_clock_MHz": (r",(\d+)/\d+MHz", "MHz", "cpu_clock", 1e6),
    "gpu_clock_MHz": (r",\d+/(\d+)MHz", "MHz", "gpu_clock", 1e6),
    "memory_clock_MHz": (r"Mem=(\d+)MHz", "MHz", "", 1),
    "power_level_state": (r"PLS=(\d+)", "1", "", 1),
    "temperature_C": (r"Temp=(-?[\d.]+)C", "degC", "temperature", 1),
    "stale_frames": (r"Stale=(\d+)", "1", "", 1),
    "app_gpu_time_ms": (r"App=(-?[\d.]+)ms", "ms", "", 1),
    "gpu_utilization": (r"GPU%=([\d.]+)", "1", "", 1),
}


def number(text):
    """A finite number, else None."""
    try:
        value = float(text)
    except (TypeError, ValueError):
        return None
    return value if math.isfinite(value) else None


def devices(text):
    """`adb devices -l` -> [(serial, state)]."""
    rows = [line.split() for line in text.splitlines()[1:] if not line.startswith("*")]
    return [tuple(row[:2]) for row in rows if len(row) >= 2]


def counter_ids(text):
    """`ovrgpuprofiler -m` -> {name: number}."""
    return {name: int(at) for at, name in re.findall(r"^[ \t]*(\d+)[ \t]+(\S.*?)[ \t]*$", text, re.M) if not name.endswith("supported:")}


class Counters:
    """`ovrgpuprofiler -r…`: one block of `name : value` lines per second, separated by empty lines."""

    def __init__(self):
        self.samples = []  # (time, {name: value})
        self._block = {}

    def feed(self, when, line):
        found = re.match(r"^\s*(\S.*?)\s+:\s*(\S+)\s*$", line)
        if self._block and (found[1] in self._block if found else not line.strip()):
            self.samples.append((when, self._block))
            self._block = {}
        if found:
            self._block[found[1]] = number(found[2])


def logcat(line):
    """A line of `logcat -v epoch` -> (seconds since 1970, tag, message); None for anything else."""
    found = re.match(r"^\s*(\d+\.\d+)\s+\d+\s+\d+\s+[VDIWEF]\s+(.*?)\s*:\s(.*)$", line)
    return (float(found[1]), found[2], found[3]) if found else None


def vrapi(message):
    """VrApi's line -> {series: value, None where not reported}; None for its other lines."""
    if not message.startswith("FPS="):
        return None
    return {name: number((re.findall(pattern, message) or [None])[0]) for name, (pattern, *_) in VRAPI.items()}


def result(message):
    """The app's last line -> (passed, folder on the device); None for its other lines."""
    found = re.match(r"^RESULT (PASS|FAIL) (.+?)\s*$", message)
    return (found[1] == "PASS", found[2]) if found else None


def dataset_name(name):
    """"Read Total (Bytes/sec)" -> "Read_Total_Bytes_per_sec"."""
    return re.sub(r"\W+", "_", name.replace("/", " per ").replace("%", " percent "), flags=re.ASCII).strip("_")


def group(name, source, rows, described):
    """One group of samples.json. rows: [(time [s], {series: value})] in any order; described: {series: (units, role, factor)}."""
    kept = sorted({when: values for when, values in rows}.items())
    times = [when for when, _ in kept]
    steps = [b - a for a, b in zip(times, times[1:])]
    series = []
    for key, (units, role, factor) in described.items():
        values = [row.get(key) for _, row in kept]
        if any(v is not None for v in values):
            series.append({"name": dataset_name(key), "units": units, "long_name": key.replace("_", " "), "values": values, **({"role": role, "scale": factor} if role else {})})
    return {"name": name, "source": source, "period_s": statistics.median(steps) if steps else 1.0, "time_unix_s": times, "series": series}


def groups(vrapi_rows, counter_rows):
    names = sorted({name for _, values in counter_rows for name in values})
    counters = {n: ("B s-1" if "Bytes/sec" in n else "%" if "%" in n else "1", {READ: "read", WRITE: "write"}.get(n, ""), 1) for n in names}
    out = [group("vrapi", "VrApi lines of logcat", vrapi_rows, {name: rest for name, (_, *rest) in VRAPI.items()}),
           group("ovrgpuprofiler", "ovrgpuprofiler -r, the computer's time of arrival moved to the device's clock", counter_rows, counters)]
    return [g for g in out if g["series"]]


def reasons_against(vrapi_rows, requested, since, until):
    """Why the run is not valid, in words; empty if it is. `requested`: {series: value}; times in seconds since 1970."""
    inside = [values for when, values in vrapi_rows if since <= when <= until]
    of = lambda name: [row[name] for row in inside if row.get(name) is not None]
    shown = lambda values: " to ".join(f"{v:g}" for v in sorted({min(values), max(values)}))
    out = []
    for name, wanted in {**requested, "power_level_state": 0}.items():
        values, what = of(name), name.replace("_", " ")
        if not values:
            out.append(f"{what}: the device did not report it; {wanted:g} was requested")
        elif any(v != wanted for v in values):
            out.append(f"{what}: {shown(values)}; {wanted:g} was requested")
    for name in ("cpu_clock_MHz", "gpu_clock_MHz"):
        values = of(name)
        if values and not max(values) - min(values) <= CLOCK_TOLERANCE * statistics.median(values):
            out.append(f"{name.replace('_', ' ')}: {shown(values)}; expected within {CLOCK_TOLERANCE:.0%} of the median")
    return out


def write(path, device, reasons, found):
    record = {"format": "clothbench-device-samples", "format_version": 1, "valid": not reasons, "reasons": reasons, "device": device, "groups": found}
    with open(path + ".tmp", "w", encoding="utf-8") as out:
        json.dump(record, out, allow_nan=False, indent=0)
    os.replace(path + ".tmp", path)  # whole or not at all
